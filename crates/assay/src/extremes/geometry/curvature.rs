//! Curvature forms of extreme ratios.

use palpate_geometry::{CurvatureForm, ShapeClass, ShapeThresholds};

use super::super::hostile::EXTREME;
use super::super::precise::Precise;
use super::super::{Answer, Case, Outcome};

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for exponent in [-300, -100, -12, -9, -6, -3, 0, 3, 6, 9, 12, 100, 150] {
        for sign in [1.0, -1.0] {
            let form = CurvatureForm {
                k_uu: 0.3,
                k_uv: 0.0,
                k_vv: sign * 10f64.powi(exponent),
            };
            let input = format!("k_uu = 0.3, k_vv = {:e}, turned by 0.5", form.k_vv);
            cases.push(Case::new(
                "geometry::CurvatureForm::principal",
                input,
                move || principal(form.rotated(0.5)),
            ));
        }
    }
    for off in [1e-15, 1e-9, 1e-3, 1.0] {
        let form = CurvatureForm {
            k_uu: 1.0,
            k_uv: off,
            k_vv: 1.0,
        };
        cases.push(Case::new(
            "geometry::CurvatureForm::principal",
            format!("{off:e} from an umbilic"),
            move || principal(form),
        ));
        cases.push(Case::new(
            "geometry::CurvatureForm::shape_index",
            format!("{off:e} from an umbilic"),
            move || shape_index(form),
        ));
    }
    for exponent in [-12, -6, 0, 6, 12] {
        let k = 10f64.powi(exponent);
        let form = CurvatureForm {
            k_uu: k,
            k_uv: 0.0,
            k_vv: -1.0,
        };
        cases.push(Case::new(
            "geometry::CurvatureForm::shape_index",
            format!("saddle of ratio {k:e}"),
            move || shape_index(form),
        ));
        let object = CurvatureForm::isotropic(k);
        cases.push(Case::new(
            "geometry::CurvatureForm::relative_curvature_ratio",
            format!("{k:e} of the probe's"),
            move || {
                let probe = CurvatureForm::isotropic(1.0);
                let found = object.relative_curvature_ratio(&probe, 0.3);
                found
                    .ok_or(NoRatio)
                    .map(|ratio| Answer::near(ratio, k).within(4e-16))
                    .into()
            },
        ));
        cases.push(Case::new(
            "geometry::CurvatureForm::seen_from_other_body",
            format!("there and back at ratio {k:e}"),
            move || {
                let back = form.seen_from_other_body(0.7).seen_from_other_body(0.7);
                let pairs = [(back.k_uu, form.k_uu), (back.k_vv, -1.0), (back.k_uv, 0.0)];
                Answer::all_at_scale(pairs, k.max(1.0)).within(2e-15).into()
            },
        ));
    }
    cases.push(Case::refusal(
        "geometry::CurvatureForm::shape_index",
        "flat, NaN and infinite",
        || {
            let asked =
                [0.0, f64::NAN, f64::INFINITY].map(|k| CurvatureForm::isotropic(k).shape_index());
            asked.into_iter().flatten().next().ok_or(NoRatio)
        },
    ));
    cases.push(Case::refusal(
        "geometry::CurvatureForm::relative_curvature_ratio",
        "over a flat probe; of NaN and infinity",
        || {
            let ratio = |object: f64, probe: f64| {
                let probe = CurvatureForm::isotropic(probe);
                CurvatureForm::isotropic(object).relative_curvature_ratio(&probe, 0.3)
            };
            let asked = [
                (1.0, 0.0),
                (0.0, 0.0),
                (f64::NAN, 1.0),
                (f64::INFINITY, 1.0),
            ];
            let found = asked
                .into_iter()
                .find_map(|(object, probe)| ratio(object, probe));
            found.ok_or(NoRatio)
        },
    ));
    cases.push(Case::new(
        "geometry::ShapeThresholds::classify",
        "196 pairs of extreme numbers: 1 where H of the other sign is the same inside out",
        || {
            let thresholds = ShapeThresholds::new(1e-4, 1e-2).expect("good thresholds");
            let finite = || EXTREME.into_iter().filter(|number| number.is_finite());
            let pairs = finite().flat_map(|k| finite().map(move |h| (k, h)));
            let is_inside_out = pairs.map(|(k, h)| {
                let [class, other] = [h, -h].map(|h| thresholds.classify(k, h));
                (f64::from(u8::from(inside_out(class) == other)), 1.0)
            });
            Answer::all_near(is_inside_out).into()
        },
    ));
    cases
}

/// The class of the same surface seen from the other side.
const fn inside_out(class: ShapeClass) -> ShapeClass {
    match class {
        ShapeClass::Peak => ShapeClass::Pit,
        ShapeClass::Pit => ShapeClass::Peak,
        ShapeClass::Ridge => ShapeClass::Valley,
        ShapeClass::Valley => ShapeClass::Ridge,
        ShapeClass::SaddleRidge => ShapeClass::SaddleValley,
        ShapeClass::SaddleValley => ShapeClass::SaddleRidge,
        ShapeClass::Flat | ShapeClass::Minimal => class,
    }
}

/// There is no ratio to tell.
#[derive(Debug)]
struct NoRatio;

/// `H ∓ √((k_uu − k_vv)²/4 + k_uv²)`, relative to the larger one.
fn principal(form: CurvatureForm) -> Outcome {
    let CurvatureForm { k_uu, k_uv, k_vv } = form;
    let mean = (Precise::new(k_uu) + k_vv) * 0.5;
    let half = (Precise::new(k_uu) - k_vv) * 0.5;
    let spread = (half.squared() + Precise::new(k_uv).squared()).sqrt();
    let (least, most) = ((&mean - &spread).to_f64(), (&mean + &spread).to_f64());
    let found = form.principal();
    let pairs = [(found.k_min, least), (found.k_max, most)];
    Answer::all_at_scale(pairs, least.abs().max(most.abs()))
        .within(1e-15)
        .also([found.angle_of_max_rad])
        .into()
}

/// `(2/π) atan(H/√(…))`, on the scale of its range.
fn shape_index(form: CurvatureForm) -> Outcome {
    let CurvatureForm { k_uu, k_uv, k_vv } = form;
    let mean = (Precise::new(k_uu) + k_vv) * 0.5;
    let half = (Precise::new(k_uu) - k_vv) * 0.5;
    let spread = (half.squared() + Precise::new(k_uv).squared()).sqrt();
    let truth = (mean / spread).atan() / Precise::pi() * 2.0;
    let found = form.shape_index().ok_or(NoRatio);
    found
        .map(|index| Answer::at_scale(index, truth.to_f64(), 1.0).within(1e-15))
        .into()
}
