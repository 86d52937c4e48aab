//! Curvature forms of extreme ratios.

use palpate_geometry::{CurvatureForm, ShapeClass, ShapeThresholds};
use palpate_verdict::{Answer, EXTREME, Precise, decades, rows};

const PRINCIPAL: &str = "geometry::CurvatureForm::principal";
const SHAPE_INDEX: &str = "geometry::CurvatureForm::shape_index";
const RATIO: &str = "geometry::CurvatureForm::relative_curvature_ratio";
const TURNED: &str = "geometry::CurvatureForm::seen_from_other_body";
const CLASSIFY: &str = "geometry::ShapeThresholds::classify";
const POWERS: [f64; 13] = [
    1e-300, 1e-100, 1e-12, 1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9, 1e12, 1e100, 1e150,
];

rows! {
    PRINCIPAL, "k_uu = 0.3, k_vv = {k_vv:e}, turned by 0.5" => principal(form(0.3, 0.0, k_vv).rotated(0.5)),
        for power in POWERS, for k_vv in [power, -power];
    PRINCIPAL, "{off:e} from an umbilic" => principal(form(1.0, off, 1.0)), for off in [1e-15, 1e-9, 1e-3, 1.0];
    SHAPE_INDEX, "{off:e} from an umbilic" => shape_index(form(1.0, off, 1.0)), for off in [1e-15, 1e-9, 1e-3, 1.0];
    SHAPE_INDEX, "saddle of ratio {k:e}" => shape_index(form(k, 0.0, -1.0)), for k in decades(-12, 12, 6);
    SHAPE_INDEX, "isotropic {k:e}", "none" => CurvatureForm::isotropic(k).shape_index(),
        for k in [0.0, f64::NAN, f64::INFINITY];
    RATIO, "{k:e} of the probe's" => ratio(k, 1.0).map(|ratio| Answer::near(ratio, k).within(4e-16)),
        for k in decades(-12, 12, 6);
    RATIO, "{object:e} of a probe of {probe:e}", "none" => ratio(object, probe),
        for (object, probe) in [(1.0, 0.0), (0.0, 0.0), (f64::NAN, 1.0), (f64::INFINITY, 1.0)];
    TURNED, "there and back at ratio {k:e}" => there_and_back(k), for k in decades(-12, 12, 6);
    CLASSIFY, "196 pairs of extreme numbers: 1 where H of the other sign is the same inside out" => both_sides();
}

const fn form(k_uu: f64, k_uv: f64, k_vv: f64) -> CurvatureForm {
    CurvatureForm { k_uu, k_uv, k_vv }
}

fn ratio(object: f64, probe: f64) -> Option<f64> {
    let probe = CurvatureForm::isotropic(probe);
    CurvatureForm::isotropic(object).relative_curvature_ratio(&probe, 0.3)
}

fn there_and_back(k: f64) -> Answer {
    let turned = form(k, 0.0, -1.0).seen_from_other_body(0.7);
    let back = turned.seen_from_other_body(0.7);
    let pairs = [(back.k_uu, k), (back.k_vv, -1.0), (back.k_uv, 0.0)];
    Answer::all_at_scale(pairs, k.max(1.0)).within(2e-15)
}

/// Mean of the principal curvatures, and half of what they differ by.
fn mean_and_spread(CurvatureForm { k_uu, k_uv, k_vv }: CurvatureForm) -> (Precise, Precise) {
    let half = (Precise::new(k_uu) - k_vv) * 0.5;
    let spread = (half.squared() + Precise::new(k_uv).squared()).sqrt();
    ((Precise::new(k_uu) + k_vv) * 0.5, spread)
}

/// `H ∓ √((k_uu − k_vv)²/4 + k_uv²)`, relative to the larger one.
fn principal(form: CurvatureForm) -> Answer {
    let (mean, spread) = mean_and_spread(form);
    let (least, most) = ((&mean - &spread).to_f64(), (&mean + &spread).to_f64());
    let found = form.principal();
    let pairs = [(found.k_min, least), (found.k_max, most)];
    Answer::all_at_scale(pairs, least.abs().max(most.abs()))
        .within(1e-15)
        .also([found.angle_of_max_rad])
}

/// `(2/π) atan(H/√(…))`, on the scale of its range.
fn shape_index(form: CurvatureForm) -> Option<Answer> {
    let (mean, spread) = mean_and_spread(form);
    let truth = (mean / spread).atan() / Precise::pi() * 2.0;
    let found = form.shape_index()?;
    Some(Answer::at_scale(found, truth.to_f64(), 1.0).within(1e-15))
}

fn both_sides() -> Answer {
    let thresholds = ShapeThresholds::new(1e-4, 1e-2).unwrap();
    let finite = || EXTREME.into_iter().filter(|number| number.is_finite());
    let pairs = finite().flat_map(|k| finite().map(move |h| (k, h)));
    let is_inside_out = pairs.map(|(k, h)| {
        let [class, other] = [h, -h].map(|h| thresholds.classify(k, h));
        (f64::from(u8::from(inside_out(class) == other)), 1.0)
    });
    Answer::all_near(is_inside_out)
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
