//! Spheres on planes, spheres and cylinders, where rolls have closed forms.

use std::f64::consts::TAU;

use palpate_geometry::Shape;
use palpate_rolling::{Model, Motion};
use palpate_verdict::{Answer, Precise, decades, rows};

use super::rolled::{DURATION, ROLL, SHIFT, auto, dop853, ended, numbers, roll, roller};
use crate::scenes::{cylinder, plane, sphere};

const PROBES: [f64; 3] = [1e-9, 1.0, 1e9];
const TURNS: [f64; 7] = [1e-300, 1e-12, 1e-6, 0.1, 1.0, 1000.0, 1e9];

rows! {
    SHIFT, "probe {probe:e}, sphere {ratio:e} times as large, 0.1 rad" =>
        shift(probe, sphere(probe * ratio), 1.0 / (probe * ratio), 0.3, 0.1),
        for ratio in decades(-12, 12, 3), for probe in PROBES;
    ROLL, "probe {probe:e}, sphere {ratio:e} times as large, 0.1 rad" =>
        place(probe, probe * ratio, 0.1, Model::ClosedForm), for ratio in decades(-12, 12, 3), for probe in PROBES;
    ROLL, "DOP853, sphere {ratio:e} times as large, {theta:e} rad" => as_far(ratio, theta),
        for ratio in decades(-12, 12, 1), for theta in [0.1, 1e-12];
    ROLL, "DOP853, plane, 1000 turns" => along_plane(1000.0 * TAU);
    SHIFT, "plane, {turns:e} turns" => shift(1.0, plane(), 0.0, 1.0, turns * TAU), for turns in TURNS;
    SHIFT, "sphere, {turns:e} turns" => shift(1.0, sphere(3.0), 1.0 / 3.0, 0.3, turns * TAU), for turns in TURNS;
    // Along its axis, where it is flat.
    SHIFT, "cylinder, {turns:e} turns" => shift(1.0, cylinder(0.5, 1f64.to_degrees()), 0.0, 1.0, turns * TAU),
        for turns in TURNS;
    ROLL, "sphere of radius 3, {turns:e} turns" => place(1.0, 3.0, turns * TAU, auto(1e-9)), for turns in TURNS;
    DURATION, "sphere of radius 3, arc {arc:e}" => duration(arc), for arc in [0.0, 1e-300, 1e-12, 1e-3, 1.0, 1e6];
}

/// The path on the probe is `θ/(1/R₁ + k₂)` long, and the shift what is left of it in half a turn.
fn shift(
    probe: f64,
    object: Shape,
    curvature: f64,
    direction: f64,
    theta: f64,
) -> Result<Answer, &'static str> {
    let relative = 1.0 / Precise::new(probe) + curvature;
    let path = Precise::new(theta) / &relative;
    let turn = Precise::pi() * 2.0 * probe;
    let turns = (path.to_f64() / turn.to_f64()).round();
    let rest = (&path - turn * turns).to_f64().abs();
    let motion = Motion::rolling(direction, 1.0, theta);
    let found = roller(probe, object, (0.0, 0.0), auto(1e-9), motion)?
        .shift(&[motion])
        .map_err(ended)?;
    let scale = (1.0 / relative).to_f64() * theta.clamp(1e-150, 1.0);
    let pairs = [
        (found.arc_length, path.to_f64()),
        (found.displacement.norm(), rest),
    ];
    Ok(Answer::all_at_scale(pairs, scale)
        .within(1e-14)
        .conditioned(theta.max(1.0)))
}

/// After the path s the contact is at the angle `s/R₂` from the top.
fn place(probe: f64, radius: f64, theta: f64, model: Model) -> Result<Answer, &'static str> {
    let relative = 1.0 / Precise::new(probe) + 1.0 / Precise::new(radius);
    let path = Precise::new(theta) / &relative;
    let angle = &path / radius;
    let motion = Motion::rolling(0.0, 1.0, theta);
    let contact = roll(
        &roller(probe, sphere(radius), (0.0, 0.0), model, motion)?,
        motion,
    )?;
    let scale = (1.0 / &relative).to_f64();
    let pairs = [
        (contact.on_object.x, (angle.sin() * radius).to_f64()),
        (contact.on_object.z, (angle.cos() * radius).to_f64()),
        (contact.arc_length, path.to_f64()),
    ];
    // Coordinates have no more digits than the object's size leaves them.
    let condition = (radius / scale).max(1.0) * theta.max(1.0);
    Ok(Answer::all_at_scale(pairs, scale)
        .within(1e-14)
        .conditioned(condition)
        .also(numbers(&contact)))
}

/// `s (1/R₁ + 1/R₂)/ω`.
fn duration(arc: f64) -> Result<Answer, &'static str> {
    let truth = (Precise::new(arc) * 4.0 / 3.0 / 0.7).to_f64();
    let motion = Motion::rolling(0.3, 0.7, 1.0);
    let roller = roller(1.0, sphere(3.0), (0.0, 0.0), auto(1e-9), motion)?;
    let found = roller.duration_for_arc(&motion, arc).map_err(ended)?;
    Ok(Answer::near(found, truth).within(1e-14))
}

/// Length of the path by the integrator.
fn as_far(radius: f64, theta: f64) -> Result<Answer, &'static str> {
    let motion = Motion::rolling(0.0, 1.0, theta);
    let roller = roller(1.0, sphere(radius), (0.0, 0.0), dop853(1e-13), motion)?;
    let contact = roll(&roller, motion)?;
    let answer = Answer::near(contact.arc_length, theta / (1.0 + 1.0 / radius));
    Ok(answer.within(1e-11).also(numbers(&contact)))
}

fn along_plane(theta: f64) -> Result<Answer, &'static str> {
    let motion = Motion::rolling(0.3, 1.0, theta);
    let roller = roller(1.0, plane(), (0.0, 0.0), dop853(1e-9), motion)?;
    let contact = roll(&roller, motion)?;
    Ok(Answer::near(contact.arc_length, theta).within(1e-9))
}
