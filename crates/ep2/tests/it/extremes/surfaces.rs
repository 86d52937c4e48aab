//! Patches of known curvature, of any size and at any place.

use nalgebra::{Point3, Rotation3, Vector3};
use palpate_ep2::{
    Contact, Ep2Error, Fit, MapPoint, Method, Noise, Patch, Penalised, Quadric, regions,
};
use palpate_geometry::ShapeThresholds;
use palpate_verdict::{Answer, rows};

use super::fits::{FITS, METHOD, consistent, methods, numbers};

const MAP: &str = "ep2::Fit::map";
const CURVATURES: &str = "ep2::Fit::curvatures";
const POINTS_AT: &str = "ep2::Fit::points_at";
/// Relative error that the documentation of `Fit::curvature_at` allows for contacts on a paraboloid.
const EXACT: f64 = 1e-11;
const TURNS: [[f64; 3]; 3] = [[3.0, 0.0, 0.0], [1e-9, 1.0, 2.0], [1.57, 1e-6, 3.1]];
const STDS: [f64; 4] = [f64::from_bits(1), 1e-300, 1e-12, 1e12];
const NOWHERE: [f64; 5] = [1e50, 1e300, f64::MAX, f64::INFINITY, f64::NAN];

rows! {
    METHOD, "{name}, patch of {size:e}" => Paraboloid { size, ..PLAIN }.judged(&*method),
        for (name, method) in exact(), for size in [1e-100, 1e-9, 1e-3, 1e3, 1e9, 1e100];
    METHOD, "{name}, patch {offset:e} of its size away" => Paraboloid { offset, ..PLAIN }.judged(&*method),
        for (name, method) in exact(), for offset in [1e3, 1e6, 1e9];
    METHOD, "{name}, bends of {bends:?}" => Paraboloid { bends, ..PLAIN }.judged(&*method),
        for (name, method) in exact(), for bend in [1e-12, 1e-9, 1e-3],
        for bends in [[bend, bend], [bend, -bend], [-bend, 0.0]];
    METHOD, "{name}, turned by {turn:?}" => Paraboloid { turn, ..PLAIN }.judged(&*method),
        for (name, method) in exact(), for turn in TURNS;
    METHOD, "{name}, errors of {noise:e} of the patch's size: as of one 2^20 times as large" => noisy(&*method, noise),
        for (name, method) in methods(), for noise in [1e-12, 1e-3, 0.1, 1.0, 10.0];
    MAP, "{name}, grid of {side} × {side}; finite" => mapped(&*method, side),
        for (name, method) in methods(), for side in [0, 1, 2, 300];
    MAP, "{name}, grid of {side} × {side}", "bad-setting" => PLAIN.fit(&*method).unwrap().map(side),
        for (name, method) in methods(), for side in [1 << 20, usize::MAX];
    CURVATURES, "{name}, grid of {side} × {side}: of the principal curvatures on the map" => as_mapped(&*method, side),
        for (name, method) in methods(), for side in [1, 2, 300];
    CURVATURES, "{name}, grid of {side} × {side}", "bad-setting" => PLAIN.fit(&*method).unwrap().curvatures(side),
        for (name, method) in methods(), for side in [1 << 20, usize::MAX];
    POINTS_AT, "{name}, a place 1e3 from a patch of size 1: whether its numbers fit together" =>
        at(&*method, 1e3).map(|points| consistent(&points[0])), for (name, method) in methods();
    POINTS_AT, "{name}, a place {far:e} from a patch of size 1", "out-of-range" => at(&*method, far),
        for (name, method) in methods(), for far in NOWHERE;
    "ep2::Quadric::fit", "noise that is {name}", "bad-setting" =>
        Quadric { noise: noise(std, None) }.fit(&PLAIN.patch().unwrap()),
        for (name, std) in [("NaN", f64::NAN), ("0", 0.0), ("-1", -1.0), ("infinite", f64::INFINITY)];
    METHOD, "quadric, noise stated as {std:e}: the curvature all the same" =>
        stated(&Quadric { noise: noise(std, Some(std)) }), for std in STDS;
    METHOD, "quadric, noise stated as {std:e}", "out-of-range" => stated(&Quadric { noise: noise(std, Some(std)) }),
        for std in [f64::MAX];
    METHOD, "penalised, noise stated as {std:e}: the curvature all the same" =>
        stated(&Penalised { noise: noise(std, Some(std)), ..Penalised::default() }), for std in STDS;
    METHOD, "penalised, noise stated as {std:e}", "out-of-range" =>
        stated(&Penalised { noise: noise(std, Some(std)), ..Penalised::default() }), for std in [f64::MAX];
}

/// Methods by which a paraboloid's contacts tell its curvature exactly.
fn exact() -> impl Iterator<Item = (&'static str, Box<dyn Method>)> {
    methods().into_iter().take(2)
}

const fn noise(std: f64, normal_std_rad: Option<f64>) -> Noise {
    Noise {
        position_std: Some(std),
        normal_std_rad,
    }
}

const PLAIN: Paraboloid = Paraboloid {
    size: 1.0,
    bends: [-0.2, -0.2],
    offset: 0.0,
    turn: [0.0; 3],
};

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
    fn turned(&self) -> Rotation3<f64> {
        let [x, y, z] = self.turn;
        Rotation3::from_euler_angles(x, y, z)
    }

    /// `side` × `side` contacts.
    fn contacts(&self, side: usize) -> Vec<Contact> {
        let [bend, other] = self.bends;
        let at = |step: usize| 2.0 * step as f64 / (side - 1) as f64 - 1.0;
        let turned = self.turned();
        let contact = |index: usize| {
            let (u, v) = (at(index % side), at(index / side));
            let place = Vector3::new(u, v, 0.5 * (bend * u * u + other * v * v));
            let normal = turned * Vector3::new(-bend * u, -other * v, 1.0);
            let place = (turned * place).add_scalar(self.offset) * self.size;
            Contact::new(index / side, Point3::from(place), Some(normal))
        };
        (0..side * side).map(contact).collect()
    }

    fn patch(&self) -> Result<Patch, Ep2Error> {
        Patch::new(&self.contacts(9), &(self.turned() * Vector3::z()))
    }

    fn fit(&self, method: &dyn Method) -> Result<Fit, Ep2Error> {
        method.fit(&self.patch()?)
    }

    /// Errors of the curvatures over the apex, relative to the sharper bend; [value, truth] of each.
    fn judged(&self, method: &dyn Method) -> Result<Answer, Ep2Error> {
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

fn mapped(method: &dyn Method, side: usize) -> Result<Answer, Ep2Error> {
    let points = PLAIN.fit(method)?.map(side)?;
    let thresholds = ShapeThresholds::new(1e-3, 1e-3).unwrap();
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
fn noisy(method: &dyn Method, noise: f64) -> Result<Answer, Ep2Error> {
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

fn noisy_centre(method: &dyn Method, noise: f64, unit: f64) -> Result<MapPoint, Ep2Error> {
    let mut contacts = PLAIN.contacts(6);
    for (index, contact) in contacts.iter_mut().enumerate() {
        let off = [0, 1, 2].map(|axis| noise * shaken(3 * index + axis));
        contact.position = (contact.position + Vector3::from(off)) * unit;
    }
    method.fit(&Patch::new(&contacts, &Vector3::z())?)?.centre()
}

fn stated(method: &dyn Method) -> Result<Answer, Ep2Error> {
    let curvature = PLAIN.fit(method)?.centre()?.curvature;
    let stated = curvature.uncertainty.iter();
    let pairs = [(curvature.gaussian, 0.04), (curvature.mean, 0.2)];
    Ok(Answer::all_near(pairs)
        .within(EXACT)
        .also(stated.flat_map(|one| [one.gaussian_std, one.mean_std, one.correlation])))
}

fn at(method: &dyn Method, far: f64) -> Result<Vec<MapPoint>, Ep2Error> {
    PLAIN.fit(method)?.points_at(&[Point3::new(far, far, 0.0)])
}

fn as_mapped(method: &dyn Method, side: usize) -> Result<Answer, Ep2Error> {
    let fit = PLAIN.fit(method)?;
    let (found, map) = (fit.curvatures(side)?, fit.map(side)?);
    let pairs = found.iter().zip(&map).flat_map(|(found, point)| {
        [
            (found.gaussian, point.k_min * point.k_max),
            (found.mean, 0.5 * (point.k_min + point.k_max)),
        ]
    });
    Ok(Answer::all_at_scale(pairs, 1.0).within(1e-12))
}
