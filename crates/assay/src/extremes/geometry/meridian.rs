//! Meridians, far from the apex and hardly curved.

use std::convert::Infallible;

use palpate_geometry::Meridian;

use super::super::precise::Precise;
use super::super::{Answer, Case, Outcome};

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for exponent in [-300, -150, -12, -9, -6, -3, 0, 3, 6, 9, 12, 150, 290] {
        let c = 10f64.powi(exponent);
        cases.push(Case::new(
            "geometry::Meridian::arc_length",
            format!("paraboloid c = {c:e}, t = 0.7"),
            move || arc_length(c, 0.7),
        ));
        cases.push(Case::new(
            "geometry::Meridian::slope",
            format!("paraboloid c = {c:e}, t = 0.7"),
            move || slope(c, 0.7),
        ));
        cases.push(Case::value(
            "geometry::Meridian::at",
            format!("paraboloid c = {c:e}, t = 0.7: its normal"),
            move || {
                let direction = [&slope_of(c, 0.7), &Precise::new(1.0)];
                normal(Meridian::Paraboloid { c }, 0.7, direction)
            },
        ));
    }
    for turns in [1e-12, 1e-3, 0.25, 1.0, 1000.0] {
        for aspect in [1e-12, 1e-6, 1.0, 1e6, 1e12] {
            cases.push(Case::new(
                "geometry::Meridian::slope",
                format!("spheroid of aspect {aspect:e}, after {turns:e} turns"),
                move || spheroid_slope(aspect, turns * std::f64::consts::TAU),
            ));
            cases.push(Case::value(
                "geometry::Meridian::at",
                format!("spheroid of aspect {aspect:e}, after {turns:e} turns: its normal"),
                move || spheroid_normal(aspect, turns * std::f64::consts::TAU),
            ));
        }
    }
    cases
}

/// `s = t/2 (√(1 + q²) + asinh(q)/q)` with `q = 2 c t`.
fn arc_length(c: f64, t: f64) -> Outcome {
    let q = slope_of(c, t);
    let root = (q.squared() + 1.0).sqrt();
    let truth = (root + q.asinh() / &q) * t * 0.5;
    let found = Meridian::Paraboloid { c }.arc_length(t);
    let found = found.expect("a paraboloid's arc has a closed form");
    Answer::near(found, truth.to_f64()).within(1e-15).into()
}

fn slope(c: f64, t: f64) -> Outcome {
    let truth = slope_of(c, t).atan().to_f64();
    let found = Meridian::Paraboloid { c }.slope(t);
    Answer::near(found.slope_rad, truth)
        .within(1e-15)
        .also([found.arc_per_parameter, found.slope_per_parameter])
        .into()
}

/// `dz/dr = 2 c t`.
fn slope_of(c: f64, t: f64) -> Precise {
    Precise::new(2.0) * c * t
}

/// The normal by its direction.
fn normal(
    meridian: Meridian,
    t: f64,
    [outward, along]: [&Precise; 2],
) -> Result<Answer, Infallible> {
    let length = (outward.squared() + along.squared()).sqrt();
    let truth = [outward, along].map(|component| (component / &length).to_f64());
    let found = meridian.at(t);
    Ok(Answer::all_near(found.normal.into_iter().zip(truth))
        .within(1e-15)
        .also([found.r, found.height]))
}

/// `(c sin φ, a cos φ)`.
fn spheroid_normal(aspect: f64, t: f64) -> Result<Answer, Infallible> {
    let (sin, cos) = ((Precise::new(t)).sin(), (Precise::new(t)).cos());
    let meridian = Meridian::Spheroid { a: 1.0, c: aspect };
    normal(meridian, t, [&(sin * aspect), &cos])
}

/// `tan α = (c/a) tan φ`, in the turn of φ.
fn spheroid_slope(aspect: f64, t: f64) -> Outcome {
    let turn = Precise::pi() * 2.0;
    let turns = (t / std::f64::consts::TAU).round();
    let (sin, cos) = ((Precise::new(t)).sin(), (Precise::new(t)).cos());
    let within = (sin * aspect / &cos).atan();
    // Between a quarter and three quarters of a turn the tangent repeats itself.
    let truth = if cos.is_negative() {
        let half = if libm::sin(t) < 0.0 { -0.5 } else { 0.5 };
        within + &turn * (turns + half)
    } else {
        within + &turn * turns
    };
    let found = Meridian::Spheroid { a: 1.0, c: aspect }.slope(t);
    Answer::near(found.slope_rad, truth.to_f64())
        .within(1e-15)
        .also([found.arc_per_parameter, found.slope_per_parameter])
        .into()
}
