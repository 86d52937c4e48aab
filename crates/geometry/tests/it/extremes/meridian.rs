//! Meridians, far from the apex and hardly curved.

use std::f64::consts::TAU;

use palpate_geometry::{Meridian, MeridianSlope};
use palpate_verdict::{Answer, Precise, rows};

const SLOPE: &str = "geometry::Meridian::slope";
const AT: &str = "geometry::Meridian::at";
const POWERS: [f64; 13] = [
    1e-300, 1e-150, 1e-12, 1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9, 1e12, 1e150, 1e290,
];
const TURNS: [f64; 5] = [1e-12, 1e-3, 0.25, 1.0, 1000.0];
const ASPECTS: [f64; 5] = [1e-12, 1e-6, 1.0, 1e6, 1e12];

rows! {
    "geometry::Meridian::arc_length", "paraboloid c = {c:e}, t = 0.7" => arc_length(c, 0.7), for c in POWERS;
    SLOPE, "paraboloid c = {c:e}, t = 0.7" => told(Meridian::Paraboloid { c }.slope(0.7), slope_of(c, 0.7).atan()),
        for c in POWERS;
    AT, "paraboloid c = {c:e}, t = 0.7: its normal" =>
        normal(Meridian::Paraboloid { c }, 0.7, [slope_of(c, 0.7), Precise::new(1.0)]), for c in POWERS;
    SLOPE, "spheroid of aspect {aspect:e}, after {turns:e} turns" => spheroid_slope(aspect, turns * TAU),
        for turns in TURNS, for aspect in ASPECTS;
    AT, "spheroid of aspect {aspect:e}, after {turns:e} turns: its normal" => spheroid_normal(aspect, turns * TAU),
        for turns in TURNS, for aspect in ASPECTS;
}

/// `s = t/2 (√(1 + q²) + asinh(q)/q)` with `q = 2 c t`.
fn arc_length(c: f64, t: f64) -> Option<Answer> {
    let q = slope_of(c, t);
    let root = (q.squared() + 1.0).sqrt();
    let truth = (root + q.asinh() / &q) * t * 0.5;
    let found = Meridian::Paraboloid { c }.arc_length(t)?;
    Some(Answer::near(found, truth.to_f64()).within(1e-15))
}

/// `dz/dr = 2 c t`.
fn slope_of(c: f64, t: f64) -> Precise {
    2.0 * Precise::new(c) * t
}

fn told(found: MeridianSlope, truth: Precise) -> Answer {
    Answer::near(found.slope_rad, truth.to_f64())
        .within(1e-15)
        .also([found.arc_per_parameter, found.slope_per_parameter])
}

/// The normal by its direction.
fn normal(meridian: Meridian, t: f64, direction: [Precise; 2]) -> Answer {
    let length = (direction[0].squared() + direction[1].squared()).sqrt();
    let truth = direction.map(|component| (component / &length).to_f64());
    let found = meridian.at(t);
    Answer::all_near(found.normal.into_iter().zip(truth))
        .within(1e-15)
        .also([found.r, found.height])
}

/// `(c sin φ, a cos φ)`.
fn spheroid_normal(aspect: f64, t: f64) -> Answer {
    let (sin, cos) = (Precise::new(t).sin(), Precise::new(t).cos());
    normal(
        Meridian::Spheroid { a: 1.0, c: aspect },
        t,
        [sin * aspect, cos],
    )
}

/// `tan α = (c/a) tan φ`, in the turn of φ.
fn spheroid_slope(aspect: f64, t: f64) -> Answer {
    let turns = Precise::pi() * 2.0 * (t / TAU).round();
    let (sin, cos) = (Precise::new(t).sin(), Precise::new(t).cos());
    let within = (sin * aspect / &cos).atan();
    // Between a quarter and three quarters of a turn the tangent repeats itself.
    let half = match cos.is_negative() {
        true if libm::sin(t) < 0.0 => -1.0,
        true => 1.0,
        false => 0.0,
    };
    let truth = within + turns + Precise::pi() * half;
    told(Meridian::Spheroid { a: 1.0, c: aspect }.slope(t), truth)
}
