//! The integrators: across the poles of charts, at every tolerance, for many turns.

use std::f64::consts::{FRAC_PI_2, TAU};

use palpate_geometry::Shape;
use palpate_geometry::surfaces::{Ellipsoid, Sphere};
use palpate_rolling::{Chart, HeldAxis, Model, Motion};

use super::super::answer::Named;
use super::super::{Answer, Case};
use super::{MADE, numbers, roll, roller};

const CHARTS: [(&str, Chart); 3] = [
    ("chart-free", Chart::Free),
    (
        "in charts, axis transported",
        Chart::Montana(HeldAxis::Transported),
    ),
    ("in charts, axis held", Chart::Montana(HeldAxis::Chart)),
];

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for tolerance in [0.1, 1e-3, 1e-6, 1e-9, 1e-12, 1e-14] {
        let input = format!("DOP853 on a sphere, tolerance {tolerance:e}, 6 rad");
        cases.push(Case::value("rolling::Roller::roll", input, move || {
            on_sphere((0.3, 0.2), 0.4, 6.0, free(tolerance), tolerance)
        }));
    }
    for turns in [1e-300, 1e-12, 1e-6, 1.0, 100.0, 1000.0] {
        let input = format!("DOP853 on a sphere, {turns:e} turns");
        cases.push(Case::value("rolling::Roller::roll", input, move || {
            on_sphere(
                (0.3, 0.2),
                0.4,
                turns * TAU,
                free(1e-9),
                1e-9 * turns.max(1.0),
            )
        }));
    }
    cases.push(Case::refusal(
        "rolling::Roller::roll",
        "DOP853 on a sphere, 1e9 turns: more steps than it takes",
        || on_sphere((0.3, 0.2), 0.4, 1e9 * TAU, free(1e-9), 1e-9),
    ));
    for steps in [1, 2, 64, 100_000] {
        let input = format!("RK4 of {steps} steps on an ellipsoid: off by the order of steps^-4");
        cases.push(Case::value("rolling::Roller::roll", input, move || {
            rk4(steps)
        }));
    }
    for steps in [0, 100_001, usize::MAX] {
        let input = format!("RK4 of {steps} steps");
        cases.push(Case::refusal("rolling::Roller::new", input, move || {
            rk4(steps)
        }));
    }
    cases.extend(poles());
    cases
}

fn free(tolerance: f64) -> Model {
    let chart = Chart::Free;
    Model::Dop853 { tolerance, chart }
}

/// Rolls that start at, cross, or just miss the pole of the Gauss map at +x.
fn poles() -> Vec<Case> {
    let mut cases = Vec::new();
    for (name, chart) in CHARTS {
        let model = Model::Dop853 {
            tolerance: 1e-9,
            chart,
        };
        // Along x the pole is met after 0.8 rad of the probe's turn.
        let short = 2.0 * libm::sin(FRAC_PI_2 - 0.8 / 3.0);
        for (input, place, direction, theta) in [
            ("starts at a pole", (2.0, 0.0), 0.0, 1.0),
            ("ends at a pole", (short, 0.0), 0.0, 0.8),
            ("crosses a pole", (short, 0.0), 0.0, 1.6),
            ("misses a pole by 1e-9", (short, 1e-9), 0.0, 1.6),
            ("misses a pole by 1e-3", (short, 1e-3), 0.0, 1.6),
        ] {
            let attempt = move || on_sphere(place, direction, theta, model, 1e-9);
            let (entry, input) = ("rolling::Roller::roll", format!("{name}: {input}"));
            cases.push(if chart == Chart::Free {
                Case::value(entry, input, attempt)
            } else {
                // Held in a chart an axis turns with it, and the way is another, but as long.
                let held = chart == Chart::Montana(HeldAxis::Chart);
                Case::new(entry, input, move || {
                    if held {
                        as_long(place, theta, model).into()
                    } else {
                        attempt().into()
                    }
                })
            });
        }
    }
    cases
}

/// A probe of radius 1 on a sphere of radius 2: from p the contact runs along a great circle to
/// `p cos φ + 2 t sin φ`, `φ = θ/3`.
fn on_sphere(
    start: (f64, f64),
    direction: f64,
    theta: f64,
    model: Model,
    bound: f64,
) -> Result<Answer, Named> {
    let sphere = Shape::Sphere(Sphere::new(2.0).expect(MADE));
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

/// However it turns, the contact stays on the sphere and runs 2/3 per radian.
fn as_long(start: (f64, f64), theta: f64, model: Model) -> Result<Answer, Named> {
    let sphere = Shape::Sphere(Sphere::new(2.0).expect(MADE));
    let motion = Motion::rolling(0.0, 1.0, theta);
    let contact = roll(&roller(1.0, sphere, start, model, motion)?, motion)?;
    let pairs = [
        (contact.arc_length, theta * 2.0 / 3.0),
        (contact.on_object.coords.norm(), 2.0),
    ];
    let answer = Answer::all_near(pairs).within(1e-9);
    Ok(answer.also(numbers(&contact)))
}

fn rk4(steps: usize) -> Result<Answer, Named> {
    let ellipsoid = Shape::Ellipsoid(Ellipsoid::new([3.0, 2.0, 1.0]).expect(MADE));
    let chart = Chart::Free;
    let motion = Motion::rolling(0.4, 1.0, 1.0);
    let by = |model| {
        let roller = roller(1.0, ellipsoid.clone(), (0.3, 0.2), model, motion)?;
        roll(&roller, motion)
    };
    let found = by(Model::Rk4 { steps, chart })?;
    let truth = by(free(1e-13))?;
    let pairs = (0..3)
        .map(|axis| (found.on_object[axis], truth.on_object[axis]))
        .chain([(found.arc_length, truth.arc_length)]);
    Ok(Answer::all_at_scale(pairs, 1.0)
        .within(1e-11 + (steps as f64).powi(-4))
        .also(numbers(&found)))
}
