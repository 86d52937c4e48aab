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
            first_answered(objects().map(|object| roller(1.0, object, (bad, 0.0), AUTO, STILL)))
        }));
        for (part, motion) in broken(bad) {
            let input = format!("{part} {bad:e}, on plane, sphere, paraboloid and saddle");
            cases.push(Case::refusal("rolling::Roller::roll", input, move || {
                rolled(motion)
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

fn rolled(motion: Motion) -> Result<(), Named> {
    first_answered(objects().map(|object| {
        let roller = roller(1.0, object, (0.0, 0.0), AUTO, motion)?;
        let shift = roller.shift(&[motion]).map_err(ended);
        roll(&roller, motion).map(|_| ()).or(shift.map(|_| ()))
    }))
}

/// The first answer, or why there is none to the last.
fn first_answered<T, const N: usize>(attempts: [Result<T, Named>; N]) -> Result<T, Named> {
    let answered = attempts.into_iter().reduce(Result::or);
    answered.expect("one attempt at least")
}

fn duration(arc: f64) -> Result<f64, Named> {
    let roller = roller(1.0, objects()[1].clone(), (0.0, 0.0), AUTO, STILL)?;
    roller.duration_for_arc(&STILL, arc).map_err(ended)
}

fn extreme_motions(object: usize) -> Outcome {
    let pairs = EXTREME
        .into_iter()
        .flat_map(|rate| EXTREME.map(|duration| (rate, duration)));
    Outcome::of_all(pairs.flat_map(|(rate, duration_s)| {
        let motion = Motion::rolling(0.3, rate, duration_s);
        let object = objects()[object].clone();
        match roller(1.0, object, (0.0, 0.0), AUTO, STILL) {
            Err(error) => vec![Err(error)],
            Ok(roller) => vec![
                roll(&roller, motion).map(|contact| numbers(&contact)),
                roller.shift(&[motion]).map_err(ended).map(|shift| {
                    let [u, v] = shift.displacement.into();
                    vec![u, v, shift.arc_length]
                }),
            ],
        }
    }))
}
