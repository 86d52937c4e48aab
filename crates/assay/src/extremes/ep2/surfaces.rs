//! Patches of known curvature, of any size and at any place.

use nalgebra::{Point3, Rotation3, Vector3};
use palpate_ep2::{
    Contact, Ep2Error, Fit, MapPoint, Method, Noise, Patch, Penalised, Quadric, TwoPass, regions,
};
use palpate_geometry::ShapeThresholds;

use super::{FITS, consistent, numbers};
use crate::extremes::{Answer, Case};

/// Relative error that the documentation of `Fit::curvature_at` allows for contacts on a paraboloid.
const EXACT: f64 = 1e-11;

/// The paraboloid w = (b₁ u² + b₂ v²)/2 around its apex, turned and moved: K = b₁ b₂ and H = −(b₁ + b₂)/2 there.
#[derive(Clone, Copy)]
struct Paraboloid {
    /// Half the side of the patch, length.
    size: f64,
    /// b₁ and b₂ times the size.
    bends: [f64; 2],
    /// Each coordinate of the apex, in sizes.
    offset: f64,
    turn: [f64; 3],
}

impl Paraboloid {
    const PLAIN: Self = Self {
        size: 1.0,
        bends: [-0.2, -0.2],
        offset: 0.0,
        turn: [0.0; 3],
    };

    fn turned(&self) -> Rotation3<f64> {
        let [x, y, z] = self.turn;
        Rotation3::from_euler_angles(x, y, z)
    }

    /// `side` × `side` contacts.
    fn contacts(&self, side: usize, with_normals: bool) -> Vec<Contact> {
        let [bend, other] = self.bends;
        let at = |step: usize| 2.0 * step as f64 / (side - 1) as f64 - 1.0;
        let turned = self.turned();
        let contact = |index: usize| {
            let (u, v) = (at(index % side), at(index / side));
            let place = Vector3::new(u, v, 0.5 * (bend * u * u + other * v * v));
            let normal = turned * Vector3::new(-bend * u, -other * v, 1.0);
            let place = (turned * place).add_scalar(self.offset) * self.size;
            Contact::new(
                index / side,
                Point3::from(place),
                with_normals.then_some(normal),
            )
        };
        (0..side * side).map(contact).collect()
    }

    fn fit(&self, method: &str) -> Result<Fit, Ep2Error> {
        let patch = Patch::new(&self.contacts(9, true), &(self.turned() * Vector3::z()))?;
        fitted(method, &patch)
    }

    /// Errors of the curvatures over the apex, relative to the sharper bend; [value, truth] of each.
    fn judged(&self, method: &str) -> Result<Answer, Ep2Error> {
        let fit = self.fit(method)?;
        let apex = Point3::from(Vector3::repeat(self.offset * self.size));
        let curvature = fit.curvature_at(&apex)?;
        let [bend, other] = self.bends;
        let sharpest = bend.abs().max(other.abs());
        let scaled = [
            (
                curvature.mean * self.size / sharpest,
                -0.5 * (bend + other) / sharpest,
            ),
            (
                curvature.gaussian * self.size / sharpest * (self.size / sharpest),
                bend / sharpest * (other / sharpest),
            ),
        ];
        let stated = curvature.uncertainty;
        let stated = stated
            .iter()
            .flat_map(|one| [one.gaussian_std, one.mean_std]);
        // Rounding of the places is seen as bending.
        let condition = (1.0 + self.offset.abs()) / sharpest;
        Ok(Answer::all_at_scale(scaled, 1.0)
            .also(stated)
            .within(EXACT)
            .conditioned(100.0 * condition))
    }
}

fn fitted(method: &str, patch: &Patch) -> Result<Fit, Ep2Error> {
    match method {
        "quadric" => Quadric::default().fit(patch),
        "penalised" => Penalised::default().fit(patch),
        _ => TwoPass::default().fit(patch),
    }
}

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for method in ["quadric", "penalised"] {
        let mut add = |input: String, paraboloid: Paraboloid| {
            cases.push(Case::value(
                "ep2::Method::fit",
                format!("{method}, {input}"),
                move || paraboloid.judged(method),
            ));
        };
        for size in [1e-100, 1e-9, 1e-3, 1e3, 1e9, 1e100] {
            add(
                format!("patch of {size:e}"),
                Paraboloid {
                    size,
                    ..Paraboloid::PLAIN
                },
            );
        }
        for offset in [1e3, 1e6, 1e9] {
            add(
                format!("patch {offset:e} of its size away"),
                Paraboloid {
                    offset,
                    ..Paraboloid::PLAIN
                },
            );
        }
        for bend in [1e-12, 1e-9, 1e-3] {
            for signs in [[1.0, 1.0], [1.0, -1.0], [-1.0, 0.0]] {
                let bends = signs.map(|sign: f64| sign * bend);
                add(
                    format!("bends of {bends:?}"),
                    Paraboloid {
                        bends,
                        ..Paraboloid::PLAIN
                    },
                );
            }
        }
        for turn in [[3.0, 0.0, 0.0], [1e-9, 1.0, 2.0], [1.57, 1e-6, 3.1]] {
            add(
                format!("turned by {turn:?}"),
                Paraboloid {
                    turn,
                    ..Paraboloid::PLAIN
                },
            );
        }
    }
    for method in ["quadric", "penalised", "two-pass"] {
        for noise in [1e-12, 1e-3, 0.1, 1.0, 10.0] {
            cases.push(Case::new(
                "ep2::Method::fit",
                format!("{method}, errors of {noise:e} of the patch's size: as of one 2^20 times as large"),
                move || noisy(method, noise).into(),
            ));
        }
        for side in [0, 1, 2, 300] {
            cases.push(Case::value(
                "ep2::Fit::map",
                format!("{method}, grid of {side} × {side}; finite"),
                move || mapped(method, side),
            ));
        }
        for side in [1, 2, 300] {
            cases.push(Case::value(
                "ep2::Fit::curvatures",
                format!(
                    "{method}, grid of {side} × {side}: of the principal curvatures on the map"
                ),
                move || {
                    let fit = Paraboloid::PLAIN.fit(method)?;
                    let (found, map) = (fit.curvatures(side)?, fit.map(side)?);
                    let pairs = found.iter().zip(&map).flat_map(|(found, point)| {
                        [
                            (found.gaussian, point.k_min * point.k_max),
                            (found.mean, 0.5 * (point.k_min + point.k_max)),
                        ]
                    });
                    Ok::<_, Ep2Error>(
                        Answer::all_at_scale(pairs.collect::<Vec<_>>(), 1.0).within(1e-12),
                    )
                },
            ));
        }
        for side in [1 << 20, usize::MAX] {
            cases.push(Case::refusal(
                "ep2::Fit::map",
                format!("{method}, grid of {side} × {side}"),
                move || Paraboloid::PLAIN.fit(method)?.map(side),
            ));
            cases.push(Case::refusal(
                "ep2::Fit::curvatures",
                format!("{method}, grid of {side} × {side}"),
                move || Paraboloid::PLAIN.fit(method)?.curvatures(side),
            ));
        }
        for far in [1e3, 1e50, 1e300, f64::MAX, f64::INFINITY, f64::NAN] {
            cases.push(Case::new(
                "ep2::Fit::points_at",
                format!("{method}, a place {far:e} from a patch of size 1: whether its numbers fit together"),
                move || {
                    let at = [Point3::new(far, far, 0.0)];
                    Paraboloid::PLAIN
                        .fit(method)
                        .and_then(|fit| fit.points_at(&at))
                        .map(|points| consistent(&points[0]))
                        .into()
                },
            ));
        }
    }
    for (name, value) in [
        ("NaN", f64::NAN),
        ("0", 0.0),
        ("-1", -1.0),
        ("infinite", f64::INFINITY),
    ] {
        cases.push(Case::refusal(
            "ep2::Quadric::fit",
            format!("noise that is {name}"),
            move || {
                let noise = Noise {
                    position_std: Some(value),
                    normal_std_rad: None,
                };
                let contacts = Paraboloid::PLAIN.contacts(9, true);
                Quadric { noise }.fit(&Patch::new(&contacts, &Vector3::z())?)
            },
        ));
    }
    for std in [f64::from_bits(1), 1e-300, 1e-12, 1e12, f64::MAX] {
        for method in ["quadric", "penalised"] {
            cases.push(Case::new(
                "ep2::Method::fit",
                format!("{method}, noise stated as {std:e}: the curvature all the same"),
                move || stated(method, std).into(),
            ));
        }
    }
    cases
}

fn mapped(method: &str, side: usize) -> Result<Answer, Ep2Error> {
    let points = Paraboloid::PLAIN.fit(method)?.map(side)?;
    let thresholds = ShapeThresholds::new(1e-3, 1e-3).map_err(|_| Ep2Error::OutOfRange)?;
    let found = regions(side, &points, &thresholds)?;
    let held: usize = found.regions.iter().map(|region| region.points).sum();
    Ok(Answer::at_scale(held as f64, (side * side) as f64, 1.0)
        .also(points.iter().flat_map(numbers))
        .also(found.regions.iter().flat_map(|region| {
            [
                region.area,
                region.gaussian_curvature,
                region.mean_curvature,
                region.coherence,
            ]
        })))
}

/// Numbers in [-1, 1], the same each time.
fn shaken(index: usize) -> f64 {
    libm::sin(78.233 * (index as f64 + 1.0))
}

/// A power of two as a unit of length changes no digit.
fn noisy(method: &str, noise: f64) -> Result<Answer, Ep2Error> {
    let unit = 2f64.powi(20);
    let [here, there] = [1.0, unit].map(|unit| noisy_centre(method, noise, unit));
    let (here, there) = (here?, there?);
    let scale = here.k_min.abs().max(here.k_max.abs());
    let pairs = [
        (there.k_min * unit, here.k_min),
        (there.k_max * unit, here.k_max),
    ];
    let answer = Answer::all_at_scale(pairs, scale).within(FITS);
    Ok(answer.also(numbers(&here)).also(numbers(&there)))
}

fn noisy_centre(method: &str, noise: f64, unit: f64) -> Result<MapPoint, Ep2Error> {
    let mut contacts = Paraboloid::PLAIN.contacts(6, true);
    for (index, contact) in contacts.iter_mut().enumerate() {
        let off = [0, 1, 2].map(|axis| noise * shaken(3 * index + axis));
        contact.position = (contact.position + Vector3::from(off)) * unit;
    }
    fitted(method, &Patch::new(&contacts, &Vector3::z())?)?.centre()
}

fn stated(method: &str, std: f64) -> Result<Answer, Ep2Error> {
    let noise = Noise {
        position_std: Some(std),
        normal_std_rad: Some(std),
    };
    let patch = Patch::new(&Paraboloid::PLAIN.contacts(9, true), &Vector3::z())?;
    let fit = match method {
        "quadric" => Quadric { noise }.fit(&patch)?,
        _ => Penalised {
            noise,
            ..Penalised::default()
        }
        .fit(&patch)?,
    };
    let curvature = fit.centre()?.curvature;
    let stated = curvature.uncertainty.iter();
    let pairs = [(curvature.gaussian, 0.04), (curvature.mean, 0.2)];
    Ok(Answer::all_near(pairs)
        .within(EXACT)
        .also(stated.flat_map(|one| [one.gaussian_std, one.mean_std, one.correlation])))
}
