//! Probes, motions and tolerances that nobody means.

use nalgebra::{Vector2, Vector3};
use palpate_geometry::Shape;
use palpate_geometry::surfaces::{Graph, Plane, Sphere};
use palpate_rolling::{Chart, Model, Motion, Probe};

use super::super::answer::Named;
use super::super::hostile::{EXTREME, NO_LENGTHS, NOT_FINITE};
use super::super::{Answer, Case, Outcome};
use super::{MADE, ended, numbers, roll, roller};

const AUTO: Model = Model::Auto {
    tolerance: 1e-6,
    chart: Chart::Free,
};
const STILL: Motion = Motion {
    angular_velocity: Vector3::new(0.0, 1.0, 0.0),
    sliding: Vector2::new(0.0, 0.0),
    duration_s: 0.1,
};

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for bad in NO_LENGTHS {
        let input = format!("radius {bad:e}");
        cases.push(Case::refusal("rolling::Probe::new", input, move || {
            Probe::new(bad)
        }));
    }
    for tolerance in [f64::NAN, f64::INFINITY, -1.0, 0.0, 1e-15, 0.11] {
        for (name, model) in [
            (
                "auto",
                Model::Auto {
                    tolerance,
                    chart: Chart::Free,
                },
            ),
            (
                "DOP853",
                Model::Dop853 {
                    tolerance,
                    chart: Chart::Free,
                },
            ),
        ] {
            let input = format!("{name}, tolerance {tolerance:e}");
            cases.push(Case::refusal("rolling::Roller::new", input, move || {
                roller(1.0, objects()[0].clone(), (0.0, 0.0), model, STILL)
            }));
        }
    }
    for bad in NOT_FINITE {
        let input = format!("first contact at {bad:e}");
        cases.push(Case::refusal("rolling::Roller::new", input, move || {
            let made = objects().map(|object| roller(1.0, object, (bad, 0.0), AUTO, STILL));
            made.into_iter()
                .find(Result::is_ok)
                .unwrap_or(Err(Named("off-domain")))
        }));
        for (part, motion) in broken(bad) {
            let input = format!("{part} {bad:e}, on plane, sphere, paraboloid and saddle");
            cases.push(Case::refusal("rolling::Roller::roll", input, move || {
                first_answer(motion)
            }));
        }
        let input = format!("arc {bad:e}");
        cases.push(Case::refusal(
            "rolling::Roller::duration_for_arc",
            input,
            move || duration(bad),
        ));
    }
    cases.push(Case::refusal(
        "rolling::Roller::duration_for_arc",
        "of a motion that stands still",
        || {
            let still = Motion::rolling(0.0, 0.0, 1.0);
            let roller = roller(1.0, objects()[1].clone(), (0.0, 0.0), AUTO, still)?;
            roller.duration_for_arc(&still, 1.0).map_err(ended)
        },
    ));
    for direction in [1e-300, 1.5, 1e6, 1e15, 1e20, 1e300] {
        let input = format!("direction {direction:e} rad: a rate of 1 all the same");
        cases.push(Case::new("rolling::Motion::rolling", input, move || {
            let rotation = Motion::rolling(direction, 1.0, 1.0).rotation();
            Answer::near(rotation.norm(), 1.0).within(1e-15).into()
        }));
    }
    for (index, object) in objects().into_iter().enumerate() {
        let input = format!(
            "{} at 256 pairs of extreme rates and durations",
            object.name()
        );
        cases.push(Case::new("rolling::Roller::roll", input, move || {
            extreme_motions(index)
        }));
    }
    cases
}

fn objects() -> [Shape; 4] {
    [
        Shape::Plane(Plane),
        Shape::Sphere(Sphere::new(2.0).expect(MADE)),
        Shape::Paraboloid(Graph::paraboloid(0.5).expect(MADE)),
        Shape::Saddle(Graph::saddle(0.2).expect(MADE)),
    ]
}

fn broken(bad: f64) -> [(&'static str, Motion); 4] {
    [
        (
            "rate",
            Motion {
                angular_velocity: Vector3::new(bad, 1.0, 0.0),
                ..STILL
            },
        ),
        (
            "spin",
            Motion {
                angular_velocity: Vector3::new(0.0, 1.0, bad),
                ..STILL
            },
        ),
        (
            "sliding",
            Motion {
                sliding: Vector2::new(0.0, bad),
                ..STILL
            },
        ),
        (
            "duration",
            Motion {
                duration_s: bad,
                ..STILL
            },
        ),
    ]
}

fn first_answer(motion: Motion) -> Result<(), Named> {
    let rolls = objects().map(|object| {
        let roller = roller(1.0, object, (0.0, 0.0), AUTO, motion)?;
        let shift = roller.shift(&[motion]).map_err(ended);
        roll(&roller, motion).map(|_| ()).or(shift.map(|_| ()))
    });
    let first = rolls.iter().find(|roll| roll.is_ok());
    first.map_or(Err(Named("not-finite")), |_| Ok(()))
}

fn duration(arc: f64) -> Result<f64, Named> {
    let roller = roller(1.0, objects()[1].clone(), (0.0, 0.0), AUTO, STILL)?;
    roller.duration_for_arc(&STILL, arc).map_err(ended)
}

fn extreme_motions(object: usize) -> Outcome {
    let mut found = vec![0.0];
    for rate in EXTREME {
        for duration_s in EXTREME {
            let motion = Motion::rolling(0.3, rate, duration_s);
            let object = objects()[object].clone();
            let Ok(roller) = roller(1.0, object, (0.0, 0.0), AUTO, STILL) else {
                continue;
            };
            found.extend(roll(&roller, motion).iter().flat_map(numbers));
            if let Ok(shift) = roller.shift(&[motion]) {
                let [u, v] = shift.displacement.into();
                found.extend([u, v, shift.arc_length]);
            }
        }
    }
    Answer::finite(found).into()
}
