//! Through the apex of paraboloids from flat to sharp, and of spheroids.

use std::f64::consts::TAU;

use palpate_rolling::{Model, Motion};
use palpate_verdict::{Answer, Precise, decades, rows};

use super::rolled::{ROLL, SHIFT, auto, dop853, ended, numbers, roll, roller};
use crate::scenes::{ellipsoid, paraboloid};

const ASPECTS: [f64; 6] = [1e-12, 1e-3, 0.1, 9.0, 1e3, 1e12];

rows! {
    SHIFT, "meridian of a paraboloid, c = {c:e}, {theta:e} rad" => over_hill(c, theta),
        for c in decades(-12, 12, 3), for theta in [1e-12, 0.1, 3.0];
    SHIFT, "meridian of a bowl, c = {c:e}, 0.1 rad" => over_hill(c, 0.1),
        for c in [-1e-12, -1e-6, -0.1, -0.499, -0.499_999_5];
    SHIFT, "meridian of a paraboloid, c = 0.5, {theta:e} rad" => over_hill(0.5, theta), for theta in [1e3, 1e6, 1e9];
    ROLL, "meridian of a spheroid that is a sphere, {turns:e} turns" => round_spheroid(turns * TAU),
        for turns in [1e-12, 0.1, 1.0, 1000.0];
    ROLL, "meridian of a spheroid of aspect {aspect:e}: as DOP853 has it" => as_dop853(aspect, Model::Meridian, 1e-11),
        for aspect in ASPECTS;
    ROLL, "auto on a spheroid of aspect {aspect:e}: as DOP853 has it" => as_dop853(aspect, auto(1e-6), 1e-6),
        for aspect in ASPECTS;
}

fn on_spheroid(aspect: f64, model: Model) -> Result<palpate_rolling::Contact, &'static str> {
    let motion = Motion::rolling(0.0, 1.0, 0.1);
    let spheroid = ellipsoid(1.0, 1.0, aspect);
    roll(&roller(1.0, spheroid, (0.0, 0.0), model, motion)?, motion)
}

fn as_dop853(aspect: f64, model: Model, bound: f64) -> Result<Answer, &'static str> {
    let found = on_spheroid(aspect, model)?;
    let truth = on_spheroid(aspect, dop853(1e-13))?;
    let pairs = [
        (found.on_object.x, truth.on_object.x),
        (found.arc_length, truth.arc_length),
    ];
    Ok(Answer::all_near(pairs).within(bound).also(numbers(&found)))
}

/// `θ = α + s` with `tan α = q` and `4 c s = q √(1 + q²) + asinh q`: Newton's method from what was
/// found, and on until nothing changes.
fn over_hill(c: f64, theta: f64) -> Result<Answer, &'static str> {
    let hill = paraboloid(c);
    let motion = Motion::rolling(0.0, 1.0, theta);
    let roller = roller(1.0, hill, (0.0, 0.0), Model::Meridian, motion)?;
    let found = roller.shift(&[motion]).map_err(ended)?;
    let contact = roll(&roller, motion)?;
    let mut q = 2.0 * Precise::new(c) * contact.on_object.x;
    let mut arc = Precise::new(0.0);
    for _ in 0..6 {
        let root = (q.squared() + 1.0).sqrt();
        arc = (&q * &root + q.asinh()) / 4.0 / c;
        let excess = q.atan() + &arc - theta;
        let slope = 1.0 / root.squared() + &root / 2.0 / c;
        let step = excess / slope;
        arc = &arc - &step * &root / 2.0 / c;
        q = q - step;
    }
    let arc = arc.to_f64();
    let scale = 1.0 / (1.0 + 2.0 * c.abs());
    let pairs = [(found.arc_length, arc), (contact.arc_length, arc)];
    // A bowl that hardly fits magnifies, and a long path is no better known than its length.
    let condition = (1.0 / (1.0 + 2.0 * c.min(0.0))).max(1.0) * (arc / scale).max(1.0);
    Ok(Answer::all_at_scale(pairs, scale)
        .within(1e-13)
        .conditioned(condition)
        .also(numbers(&contact)))
}

/// A sphere of radius 3 in a spheroid's guise.
fn round_spheroid(theta: f64) -> Result<Answer, &'static str> {
    let path = Precise::new(theta) * 3.0 / 4.0;
    let angle = &path / 3.0;
    let sphere = ellipsoid(3.0, 3.0, 3.0);
    let motion = Motion::rolling(0.0, 1.0, theta);
    let roller = roller(1.0, sphere, (0.0, 0.0), Model::Meridian, motion)?;
    let contact = roll(&roller, motion)?;
    let pairs = [
        (contact.arc_length, path.to_f64()),
        (contact.on_object.x, (angle.sin() * 3.0).to_f64()),
        (contact.on_object.z, (angle.cos() * 3.0).to_f64()),
    ];
    Ok(Answer::all_at_scale(pairs, 0.75)
        .within(1e-13)
        .conditioned(theta.max(1.0))
        .also(numbers(&contact)))
}
