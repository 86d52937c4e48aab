//! Tests lengths from 1e-9 to 1e9, ratios of radii from 1e-12 to 1e12, many turns, zero rotation, and poles of charts.

use std::f64::consts::{FRAC_PI_2, TAU};

use approx::{assert_abs_diff_eq, assert_relative_eq};
use nalgebra::{Matrix3, Rotation3, Vector2, Vector3};
use palpate_geometry::Shape;
use palpate_rolling::{Chart, Fingertip, Glider, HeldAxis, Model, Motion, RollFault};
use proptest::prelude::*;

use crate::scenes::{
    DOP853, auto, cylinder, difference, dish, dop853, ellipsoid, paraboloid, plane, roll, roller,
    saddle, sphere, torus,
};

#[test]
fn nothing_moves_without_a_motion() {
    for object in [sphere(2.0), paraboloid(1.0), saddle(0.2), dish(4.0)] {
        for motion in [
            Motion::rolling(0.0, 0.0, 1.0),
            Motion::rolling(0.0, 1.0, 0.0),
        ] {
            let model = auto(1e-9);
            let end = roll(1.0, &object, (0.0, 0.0), model, motion);
            assert_eq!(end.arc_length, 0.0, "{}", object.name());
        }
    }
}

const CHARTS: [Chart; 3] = [
    Chart::Free,
    Chart::Montana(HeldAxis::Transported),
    Chart::Montana(HeldAxis::Chart),
];

#[test]
fn a_start_on_a_wall_facing_x() {
    // On these walls, the normal is parallel to x, so +x has no projection onto the tangent plane. Therefore the axis
    // x₁ of the contact frame is +y.
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
            let model = dop853(1e-12, chart);
            let roller = roller(1.0, &object, place, model, spin);
            let (first, end) = (roller.first_contact(), roller.roll(&[spin]).unwrap());
            assert!(
                (end.on_object - first.on_object).norm() < 1e-12,
                "{}",
                object.name()
            );
            assert!((end.on_probe(1.0) - first.on_probe(1.0)).norm() < 1e-12);
            assert!(end.arc_length < 1e-12);
            // The probe only spins: it turns about the z axis of the contact frame, which points into the object.
            let turned = end.object_from_probe() * Rotation3::from_scaled_axis(first.normal * 0.8);
            assert!(
                (turned.matrix() - Matrix3::identity()).norm() < 1e-11,
                "{}",
                object.name()
            );
        }
        // The probe slides back as fast as it rolls, so the contact on the object does not move.
        let slide = Motion {
            sliding: Vector2::new(0.1, -0.2),
            ..still
        };
        for model in [DOP853, auto(1e-9)] {
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
    // Rates that are so extreme that their squares, and the squares of the durations of the rolls, underflow or
    // overflow.
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

#[test]
fn rolls_of_any_length_on_a_sphere_and_a_plane() {
    let auto = auto(1e-9);
    for theta in [1e-300, 1e-12, 0.1, TAU, 1e3 * TAU, 1e9 * TAU] {
        let motion = Motion::rolling(0.0, 1.0, theta);
        // The rounding error of an angle grows with the number of turns.
        let blur = 5e-15 * theta.max(1.0);
        for (object, curvature) in [(plane(), 0.0), (sphere(3.0), 1.0 / 3.0)] {
            let roller = roller(1.0, &object, (0.0, 0.0), auto, motion);
            let shift = roller.shift(&[motion]).unwrap();
            let path = theta / (1.0 + curvature);
            assert_relative_eq!(shift.arc_length, path, max_relative = 1e-14);
            // `rest` is the length of the path that remains after whole turns of the probe.
            let rest = path - (path / TAU).round() * TAU;
            assert_abs_diff_eq!(shift.displacement.x, rest, epsilon = blur.min(1e-14 * path));
        }
        let end = roll(1.0, &sphere(3.0), (0.0, 0.0), auto, motion);
        let (sin, cos) = libm::sincos(theta / 4.0);
        assert_abs_diff_eq!(end.on_object.x, 3.0 * sin, epsilon = blur);
        assert_abs_diff_eq!(end.on_object.z, 3.0 * cos, epsilon = blur);
    }
}

/// Distance between the computed and the exact contact after a roll by the angle `theta`: a probe of radius 1 on a
/// sphere of radius 2. The exact contact moves by the angle `theta / 3` along a great circle.
fn off_great_circle(start: (f64, f64), direction: f64, theta: f64, model: Model) -> f64 {
    let motion = Motion::rolling(direction, 1.0, theta);
    let roller = roller(1.0, &sphere(2.0), start, model, motion);
    let (first, end) = (*roller.first_contact(), roller.roll(&[motion]).unwrap());
    let along = first.x_axis * libm::cos(direction)
        + first.normal.cross(&first.x_axis) * libm::sin(direction);
    let (sin, cos) = libm::sincos(theta / 3.0);
    let truth = first.on_object.coords * cos + along * (2.0 * sin);
    let off = (end.on_object.coords - truth).norm();
    off.max((end.arc_length - theta * 2.0 / 3.0).abs())
}

#[test]
fn dop853_keeps_every_tolerance_for_many_turns() {
    for (tolerance, theta) in [
        (0.1, 6.0),
        (1e-9, 6.0),
        (1e-14, 6.0),
        (1e-9, 1e-12),
        (1e-9, 1e3 * TAU),
    ] {
        let model = dop853(tolerance, Chart::Free);
        let off = off_great_circle((0.3, 0.2), 0.4, theta, model);
        // Errors add up over turns, so the bound of the error is proportional to the number of turns.
        let bound = tolerance * (theta / TAU).max(1.0) + 1e-14;
        assert!(off <= bound, "{tolerance:e}, {theta:e} rad: {off:e}");
    }
    let motion = Motion::rolling(0.4, 1.0, 1e9 * TAU);
    let roller = roller(1.0, &sphere(2.0), (0.3, 0.2), DOP853, motion);
    let fault = roller.roll(&[motion]).unwrap_err().fault;
    assert!(matches!(fault, RollFault::TooManySteps { .. }), "{fault}");
}

#[test]
fn charts_end_at_poles_and_chart_free_rolls_do_not() {
    // If the contact starts at x = `short`, it reaches the pole of the chart at +x when the probe has turned by 0.8
    // rad.
    let short = 2.0 * libm::sin(FRAC_PI_2 - 0.8 / 3.0);
    for (start, theta) in [
        ((2.0, 0.0), 1.0),
        ((short, 0.0), 0.8),
        ((short, 0.0), 1.6),
        ((short, 1e-9), 1.6),
    ] {
        assert!(off_great_circle(start, 0.0, theta, DOP853) < 1e-11);
        for chart in [CHARTS[1], CHARTS[2]] {
            let tolerance = 1e-9;
            let model = dop853(tolerance, chart);
            let motion = Motion::rolling(0.0, 1.0, theta);
            let roller = roller(1.0, &sphere(2.0), start, model, motion);
            let error = roller.roll(&[motion]).unwrap_err();
            assert_eq!(<&str>::from(error.fault), "chart-singular", "{start:?}");
        }
    }
}

/// Compares the meridian model with values that mpmath computed with 60 digits. A probe of radius 1 rolls from the apex
/// of the paraboloid `z = −c r²`. At the slope angle α and the arc length s, the probe has turned by `θ = α + s`. With
/// the slope q = tan α, the arc length satisfies `4 c s = q √(1 + q²) + asinh q`.
#[test]
fn meridians_from_flat_to_sharp() {
    for (c, theta, arc) in [
        (1e-12, 3.0, 2.999999999994),
        (1e-12, 1e-12, 9.99999999998e-13),
        (1e-3, 0.1, 0.09980039920556497),
        (1e12, 0.1, 5.0251382208526555e-14),
        (1e12, 3.0, 1.4292040914425157),
        // The first case is a bowl whose radius of curvature is only slightly larger than the probe's radius, which
        // amplifies errors. In the second case, the path is so long that the arc length is nearly equal to the roll
        // angle.
        (-0.4999995, 0.1, 0.650654102346358),
        (0.5, 1e9, 999999998.429226),
    ] {
        let motion = Motion::rolling(0.0, 1.0, theta);
        let roller = roller(1.0, &paraboloid(c), (0.0, 0.0), Model::Meridian, motion);
        let shift = roller.shift(&[motion]).unwrap();
        let end = roller.roll(&[motion]).unwrap();
        let bound = if c < 0.0 { 1e-9 } else { 1e-13 };
        assert_relative_eq!(shift.arc_length, arc, max_relative = bound);
        assert_relative_eq!(end.arc_length, arc, max_relative = bound);
    }
    for aspect in [1e-12, 1e12] {
        let object = ellipsoid(1.0, 1.0, aspect);
        let motion = Motion::rolling(0.0, 1.0, 0.1);
        let truth = roll(1.0, &object, (0.0, 0.0), DOP853, motion);
        let end = roll(1.0, &object, (0.0, 0.0), Model::Meridian, motion);
        assert_relative_eq!(end.arc_length, truth.arc_length, max_relative = 1e-11);
        assert_relative_eq!(end.on_object.x, truth.on_object.x, max_relative = 1e-11);
    }
}

/// Several objects to roll on, with all their lengths multiplied by `scale`.
fn scaled(scale: f64) -> [Shape; 4] {
    [
        sphere(5.0 * scale),
        paraboloid(0.5 / scale),
        saddle(0.1 / scale),
        dish(3.0 * scale),
    ]
}

fn decades(most: f64) -> impl Strategy<Value = f64> {
    (-most..most).prop_map(|exponent| libm::pow(10.0_f64, exponent))
}

proptest! {
    #[test]
    fn scaling_all_lengths_scales_the_roll(
        exponent in -30_i32..30,
        direction in -3.0..3.0_f64,
        theta in 0.001..2.0_f64,
        x in -0.5..0.5_f64,
    ) {
        // Scaling by a power of two changes only the exponents of floating-point numbers, so the results must scale
        // exactly.
        let scale = 2.0_f64.powi(exponent);
        let motion = Motion::rolling(direction, 1.0, theta);
        for (unit, object) in scaled(1.0).iter().zip(&scaled(scale)) {
            let reference = roll(1.0, unit, (x, 0.1), DOP853, motion);
            let end = roll(scale, object, (x * scale, 0.1 * scale), DOP853, motion);
            prop_assert_eq!(reference.on_object * scale, end.on_object);
            prop_assert_eq!(reference.on_probe(1.0) * scale, end.on_probe(scale));
        }
    }

    /// Compares the closed form and DOP853: the path lengths of a roll by 0.1 rad, for spheres with extreme ratios of
    /// the radii.
    #[test]
    fn spheres_of_any_ratio(probe in decades(9.0), ratio in decades(12.0)) {
        let radius = probe * ratio;
        let motion = Motion::rolling(0.0, 1.0, 0.1);
        let path = 0.1 / (1.0 / probe + 1.0 / radius);
        for (model, bound) in [(Model::ClosedForm, 1e-14), (DOP853, 1e-11)] {
            let end = roll(probe, &sphere(radius), (0.0, 0.0), model, motion);
            assert_relative_eq!(end.arc_length, path, max_relative = bound);
            let along = radius * libm::sin(path / radius);
            // The rounding error of a coordinate grows with the size of the object.
            let blur = bound * path + 1e-15 * radius;
            assert_abs_diff_eq!(end.on_object.x, along, epsilon = blur);
        }
    }

    /// Compares contacts of tips with exact solutions, for extreme radii of tip and object. If a tip of radius t
    /// touches the paraboloid `z = −c r²` at the distance r from its axis, the centre of the tip is at the distance `r
    /// + t 2cr/√(1 + (2cr)²)` from the axis. On a sphere, the contact is on the line between the centres of tip and
    /// sphere.
    #[test]
    fn tips_of_any_ratio(size in decades(9.0), ratio in decades(12.0), foot in decades(12.0)) {
        let touch = |object: Shape, radius: f64, at: f64| {
            let glider = Glider::new(object, Fingertip::Sphere { radius }).unwrap();
            glider.touch(0.6 * at, 0.8 * at).unwrap().point / size
        };
        let tip = ratio * size;
        let found = touch(sphere(size), tip, 0.6 * (size + tip));
        let blur = 1e-12 + 1e-15 * ratio;
        assert_abs_diff_eq!(found.x, 0.36, epsilon = blur);
        assert_abs_diff_eq!(found.y, 0.48, epsilon = blur);
        for (tip, foot) in [(ratio, 1.2), (0.7, foot)] {
            let centre = foot + tip * foot / libm::hypot(1.0, foot);
            let found = touch(paraboloid(0.5 / size), tip * size, centre * size);
            let blur = 1e-12 * (foot + tip);
            assert_abs_diff_eq!(found.x, 0.6 * foot, epsilon = blur);
            assert_abs_diff_eq!(found.y, 0.8 * foot, epsilon = blur);
        }
    }
}
