//! Scales from 1e-9 to 1e9, ratios from 1e-12 to 1e12, many turns, no turn.

mod asked;
mod conforming;
mod glide;
mod integrated;
mod meridian;
mod rolled;
mod round;
mod touch_model;

use nalgebra::{Matrix3, Rotation3, Vector2, Vector3};
use palpate_geometry::Shape;
use palpate_rolling::{
    Chart, Contact, HeldAxis, InvalidRoll, Model, Motion, Probe, RollError, RollFault, Roller,
    Rolls,
};
use proptest::prelude::*;

use crate::scenes::{
    DOP853, cylinder, difference, dish, ellipsoid, height_field, paraboloid, plane, roll, roller,
    saddle, sphere, torus,
};

#[test]
fn nothing_moves_without_a_motion() {
    for object in [sphere(2.0), paraboloid(1.0), saddle(0.2), dish(4.0)] {
        for motion in [
            Motion::rolling(0.0, 0.0, 1.0),
            Motion::rolling(0.0, 1.0, 0.0),
        ] {
            let model = Model::Auto {
                tolerance: 1e-9,
                chart: Chart::Free,
            };
            let end = roll(1.0, &object, (0.0, 0.0), model, motion);
            assert_eq!(end.arc_length, 0.0, "{}", object.name());
        }
    }
}

/// Nothing but numbers: unit axes on the object, or an error that says where.
fn assert_sound(result: &Result<Contact, RollError>, what: &str) {
    match result {
        Ok(end) => {
            assert!(
                end.on_object.iter().all(|x| x.is_finite()),
                "{what}: {end:?}"
            );
            assert!(
                end.arc_length.is_finite() && end.arc_length >= 0.0,
                "{what}"
            );
            for (value, expected) in [
                (end.normal.norm(), 1.0),
                (end.x_axis.norm(), 1.0),
                (end.x_axis.dot(&end.normal), 0.0),
                (end.probe_direction().norm(), 1.0),
            ] {
                assert!((value - expected).abs() < 1e-9, "{what}: {end:?}");
            }
        }
        Err(error) => {
            assert!(
                error.time_s >= 0.0 && error.time_s.is_finite(),
                "{what}: {error}"
            );
            assert!(
                error.on_object.iter().all(|x| x.is_finite()),
                "{what}: {error}"
            );
            if let RollFault::Conforming { relative_curvature } = error.fault {
                assert!(relative_curvature.is_finite(), "{what}: {error}");
            }
        }
    }
}

/// An object of every kind, of about this size, with places on it to start from.
fn objects(size: f64) -> Vec<(Shape, Vec<(f64, f64)>)> {
    let inside = vec![(0.0, 0.0), (0.3 * size, -0.4 * size)];
    let rim = [(size, 0.0), (0.0, -size)];
    vec![
        (sphere(size), [&inside[..], &rim].concat()),
        (dish(size), inside.clone()),
        (plane(), inside.clone()),
        (cylinder(size, 25.0), inside.clone()),
        (
            ellipsoid(size, 0.9 * size, 0.5 * size),
            [&inside[..], &rim[..1]].concat(),
        ),
        (
            torus(2.0 * size, 0.7 * size),
            vec![(1.7 * size, 0.9 * size), (2.6 * size, 0.0)],
        ),
        (paraboloid(0.5 / size), inside.clone()),
        (paraboloid(-0.1 / size), inside.clone()),
        (saddle(0.2 / size), inside.clone()),
        (
            height_field("h*sin(x/s)*cos(y/s)", &[("h", 0.2 * size), ("s", size)]),
            inside,
        ),
    ]
}

const CHARTS: [Chart; 3] = [
    Chart::Free,
    Chart::Montana(HeldAxis::Transported),
    Chart::Montana(HeldAxis::Chart),
];

#[test]
fn any_probe_on_any_object() {
    let motions = |length: f64| {
        [
            Motion::rolling(0.4, 1.0, 0.7),
            Motion {
                angular_velocity: Vector3::new(0.3, -0.2, 2.0),
                sliding: Vector2::new(-0.1, 0.2) * length,
                duration_s: 1.5,
            },
        ]
    };
    // Up to a hundred times blunter than the object, or any times sharper.
    for (probe, size) in [
        (1e-9, 1e9),
        (1e-9, 1e-9),
        (1e9, 1e9),
        (1e9, 1e7),
        (1e-7, 1e-9),
        (1e-6, 1.0),
    ] {
        for (object, places) in objects(size) {
            for place in places {
                for chart in CHARTS {
                    for model in [
                        Model::Auto {
                            tolerance: 1e-6,
                            chart,
                        },
                        Model::Dop853 {
                            tolerance: 1e-6,
                            chart,
                        },
                        Model::Rk4 { steps: 3, chart },
                    ] {
                        let motions = motions(f64::min(probe, size));
                        let rolls = [motions.to_vec()];
                        let what = format!("{probe:e} on {object:?} at {place:?}, {model:?}");
                        let rolls = Rolls { rolls: &rolls };
                        let made = Probe::new(probe).unwrap();
                        match Roller::new(made, object.clone(), place, model, rolls) {
                            Ok(roller) => assert_sound(&roller.roll(&motions), &what),
                            // A dish or a trough too small for the probe; a chart's pole.
                            Err(InvalidRoll::Fault(RollFault::Conforming { .. })) => {
                                assert!(probe >= 0.9 * size, "{what}");
                            }
                            Err(error) => panic!("{what}: {error}"),
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn a_start_on_a_wall_facing_x() {
    // +x has no projection on the tangent plane; x₁ starts along +y.
    for (object, place) in [
        (sphere(2.0), (2.0, 0.0)),
        (ellipsoid(2.0, 3.0, 1.0), (2.0, 0.0)),
        (cylinder(2.0, 90.0), (2.0, 0.0)),
        (torus(3.0, 1.0), (4.0, 0.0)),
    ] {
        let motion = Motion::rolling(0.0, 1.0, 0.5);
        let roller = roller(1.0, &object, place, DOP853, motion);
        let first = roller.first_contact();
        assert!(
            (first.normal - Vector3::x()).norm() < 1e-12,
            "{}",
            object.name()
        );
        assert!(
            (first.x_axis - Vector3::y()).norm() < 1e-12,
            "{}",
            object.name()
        );
        let end = roller.roll(&[motion]).unwrap();
        assert!(
            end.on_object.y > 0.1,
            "{}: {}",
            object.name(),
            end.on_object
        );
        assert!(
            end.on_object.z.abs() < 1e-12,
            "{}: {}",
            object.name(),
            end.on_object
        );
    }
}

#[test]
fn spinning_and_sliding_on_the_spot() {
    for (object, place) in [
        (plane(), (0.3, 0.2)),
        (sphere(2.0), (0.5, 0.1)),
        (saddle(0.2), (0.3, -0.1)),
        (ellipsoid(3.0, 2.0, 1.0), (0.4, 0.3)),
    ] {
        let still = Motion::rolling(0.0, 0.0, 1.0);
        let spin = Motion {
            angular_velocity: Vector3::z() * 0.8,
            ..still
        };
        for chart in CHARTS {
            let model = Model::Dop853 {
                tolerance: 1e-12,
                chart,
            };
            let roller = roller(1.0, &object, place, model, spin);
            let (first, end) = (roller.first_contact(), roller.roll(&[spin]).unwrap());
            assert!(
                (end.on_object - first.on_object).norm() < 1e-12,
                "{}",
                object.name()
            );
            assert!((end.on_probe(1.0) - first.on_probe(1.0)).norm() < 1e-12);
            assert!(end.arc_length < 1e-12);
            // About z₁, which points into the object.
            let turned = end.object_from_probe() * Rotation3::from_scaled_axis(first.normal * 0.8);
            assert!(
                (turned.matrix() - Matrix3::identity()).norm() < 1e-11,
                "{}",
                object.name()
            );
        }
        // Slipping wheels: the object stands, the probe turns as fast as it slides back.
        let slide = Motion {
            sliding: Vector2::new(0.1, -0.2),
            ..still
        };
        for model in [
            DOP853,
            Model::Auto {
                tolerance: 1e-9,
                chart: Chart::Free,
            },
        ] {
            let roller = roller(1.0, &object, place, model, slide);
            let (first, end) = (roller.first_contact(), roller.roll(&[slide]).unwrap());
            assert!(
                (end.on_object - first.on_object).norm() > 0.05,
                "{}",
                object.name()
            );
            let turned = end.object_from_probe().matrix() - Matrix3::identity();
            assert!(turned.norm() < 1e-9, "{}: {turned}", object.name());
        }
    }
}

#[test]
fn a_thousand_motions_are_one() {
    for (object, place, model) in [
        (sphere(2.0), (0.5, 0.1), Model::ClosedForm),
        (paraboloid(1.0), (0.0, 0.0), Model::Meridian),
        (saddle(0.2), (0.3, -0.1), DOP853),
        (
            saddle(0.2),
            (0.3, -0.1),
            Model::Rk4 {
                steps: 1,
                chart: Chart::Free,
            },
        ),
    ] {
        let whole = Motion::rolling(0.6, 1.0, 2.0);
        let part = Motion {
            duration_s: 0.002,
            ..whole
        };
        let roller = roller(1.0, &object, place, model, whole);
        let (parts, whole) = (
            roller.roll(&[part; 1000]),
            roll(1.0, &object, place, DOP853, whole),
        );
        let off = difference(&parts.unwrap(), &whole, 1.0);
        assert!(off < 1e-11, "{} {model:?}: {off:e}", object.name());
    }
}

#[test]
fn slow_motions_that_last() {
    // Squares of such rates vanish, those of such durations overflow.
    for rate in [1e-200, 1e200] {
        let motion = Motion::rolling(0.3, rate, 2.0 / rate);
        let end = roll(1.0, &saddle(0.2), (0.3, 0.1), DOP853, motion);
        let usual = roll(
            1.0,
            &saddle(0.2),
            (0.3, 0.1),
            DOP853,
            Motion::rolling(0.3, 1.0, 2.0),
        );
        assert!(difference(&end, &usual, 1.0) < 1e-12, "{rate:e}");
    }
}

/// A copy of the object with all lengths times `scale`.
fn scaled(scale: f64) -> [Shape; 4] {
    [
        sphere(5.0 * scale),
        paraboloid(0.5 / scale),
        saddle(0.1 / scale),
        dish(3.0 * scale),
    ]
}

proptest! {
    #[test]
    fn scaling_all_lengths_scales_the_roll(
        exponent in -30_i32..30,
        direction in -3.0..3.0_f64,
        theta in 0.001..2.0_f64,
        x in -0.5..0.5_f64,
    ) {
        // By powers of two nothing but the exponents changes.
        let scale = 2.0_f64.powi(exponent);
        let motion = Motion::rolling(direction, 1.0, theta);
        for (unit, object) in scaled(1.0).iter().zip(&scaled(scale)) {
            let reference = roll(1.0, unit, (x, 0.1), DOP853, motion);
            let end = roll(scale, object, (x * scale, 0.1 * scale), DOP853, motion);
            prop_assert_eq!(reference.on_object * scale, end.on_object);
            prop_assert_eq!(reference.on_probe(1.0) * scale, end.on_probe(scale));
        }
    }
}
