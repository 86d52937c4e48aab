//! The integrators: across the poles of charts, at every tolerance, for many turns.

use std::f64::consts::{FRAC_PI_2, TAU};

use palpate_rolling::{Chart, HeldAxis, Model, Motion};
use palpate_verdict::{Answer, rows};

use super::rolled::{NEW, ROLL, dop853, numbers, roll, roller};
use crate::scenes::{ellipsoid, sphere};

const START: (f64, f64) = (0.3, 0.2);
const CHARTS: [(&str, HeldAxis); 2] = [
    ("in charts, axis transported", HeldAxis::Transported),
    ("in charts, axis held", HeldAxis::Chart),
];

rows! {
    ROLL, "DOP853 on a sphere, tolerance {tolerance:e}, 6 rad" =>
        on_sphere(START, 0.4, 6.0, dop853(tolerance), tolerance),
        for tolerance in [0.1, 1e-3, 1e-6, 1e-9, 1e-12, 1e-14];
    ROLL, "DOP853 on a sphere, {turns:e} turns" =>
        on_sphere(START, 0.4, turns * TAU, dop853(1e-9), 1e-9 * turns.max(1.0)),
        for turns in [1e-300, 1e-12, 1e-6, 1.0, 100.0, 1000.0];
    ROLL, "DOP853 on a sphere, 1e9 turns: more steps than it takes", "too-many-steps" =>
        on_sphere(START, 0.4, 1e9 * TAU, dop853(1e-9), 1e-9);
    ROLL, "RK4 of {steps} steps on an ellipsoid: off by the order of steps^-4" => rk4(steps),
        for steps in [1, 2, 64, 100_000];
    NEW, "RK4 of {steps} steps", "unsupported" => rk4(steps), for steps in [0, 100_001, usize::MAX];
    ROLL, "chart-free: {input}" => on_sphere(place, 0.0, theta, dop853(1e-9), 1e-9),
        for (input, place, theta) in poles();
    ROLL, "{name}: {input}", "chart-singular" => on_sphere(place, 0.0, theta, in_charts(axis), 1e-9),
        for (name, axis) in CHARTS, for (input, place, theta) in poles();
}

const fn in_charts(axis: HeldAxis) -> Model {
    let chart = Chart::Montana(axis);
    Model::Dop853 {
        tolerance: 1e-9,
        chart,
    }
}

/// Rolls along x that start at, cross, or just miss the pole of the Gauss map at +x, where no chart holds.
fn poles() -> [(&'static str, (f64, f64), f64); 5] {
    // The pole is met after 0.8 rad of the probe's turn.
    let short = 2.0 * libm::sin(FRAC_PI_2 - 0.8 / 3.0);
    [
        ("starts at a pole", (2.0, 0.0), 1.0),
        ("ends at a pole", (short, 0.0), 0.8),
        ("crosses a pole", (short, 0.0), 1.6),
        ("misses a pole by 1e-9", (short, 1e-9), 1.6),
        ("misses a pole by 1e-3", (short, 1e-3), 1.6),
    ]
}

/// A probe of radius 1 on a sphere of radius 2: from p the contact runs along a great circle to
/// `p cos φ + 2 t sin φ`, `φ = θ/3`.
fn on_sphere(
    start: (f64, f64),
    direction: f64,
    theta: f64,
    model: Model,
    bound: f64,
) -> Result<Answer, &'static str> {
    let sphere = sphere(2.0);
    let motion = Motion::rolling(direction, 1.0, theta);
    let roller = roller(1.0, sphere, start, model, motion)?;
    let first = *roller.first_contact();
    let contact = roll(&roller, motion)?;
    let along = first.x_axis * libm::cos(direction)
        + first.normal.cross(&first.x_axis) * libm::sin(direction);
    let (sin, cos) = libm::sincos(theta / 3.0);
    let truth = first.on_object.coords * cos + along * (2.0 * sin);
    let pairs = (0..3)
        .map(|axis| (contact.on_object[axis], truth[axis]))
        .chain([(contact.arc_length, theta * 2.0 / 3.0)]);
    Ok(Answer::all_at_scale(pairs, 2.0 / 3.0)
        .within(bound)
        .conditioned(3.0 * theta.max(1.0))
        .also(numbers(&contact)))
}

fn rk4(steps: usize) -> Result<Answer, &'static str> {
    let ellipsoid = ellipsoid(3.0, 2.0, 1.0);
    let chart = Chart::Free;
    let motion = Motion::rolling(0.4, 1.0, 1.0);
    let by = |model| {
        let roller = roller(1.0, ellipsoid.clone(), (0.3, 0.2), model, motion)?;
        roll(&roller, motion)
    };
    let found = by(Model::Rk4 { steps, chart })?;
    let truth = by(dop853(1e-13))?;
    let pairs = (0..3)
        .map(|axis| (found.on_object[axis], truth.on_object[axis]))
        .chain([(found.arc_length, truth.arc_length)]);
    Ok(Answer::all_at_scale(pairs, 1.0)
        .within(1e-11 + (steps as f64).powi(-4))
        .also(numbers(&found)))
}
