//! Tests rolls that end early, and rolls that cannot begin.

use nalgebra::Point3;
use palpate_geometry::{Shape, Sphere, SurfaceError};
use palpate_rolling::{Chart, InvalidRoll, Model, Motion, RollError, RollFault, Roller, Rolls};

use crate::scenes::{
    DOP853, auto, dish, dop853, height_field, paraboloid, plane, roll, roller, saddle, sphere,
};

fn refused(radius: f64, object: Shape, model: Model, motion: Motion) -> InvalidRoll {
    let rolls = vec![vec![motion]];
    let probe = Sphere::new(radius).unwrap();
    Roller::new(probe, object, (0.0, 0.0), model, Rolls::exact(&rolls)).unwrap_err()
}

#[test]
fn a_dish_as_tight_as_the_probe_conforms() {
    let motion = Motion::rolling(0.0, 0.1, 1.0);
    for object in [
        dish(1.0),
        dish(0.5),
        dish(1.0 + f64::EPSILON),
        paraboloid(-0.5 * (1.0 + 1e-12)),
    ] {
        let error = refused(1.0, object, DOP853, motion);
        assert!(
            matches!(error, InvalidRoll::Fault(RollFault::Conforming { .. })),
            "{error}"
        );
    }
    // In a dish that is slightly wider than the probe, the path length is θ/(1/R₁ − 1/R₂). Here θ is the roll angle, R₁
    // = 1 is the radius of the probe, and R₂ is the radius of the dish. The angle is chosen such that the length is 1.
    for gap in [1.0, 1e-6, 1e-12] {
        let radius = 1.0 + gap;
        let motion = Motion::rolling(0.0, 1.0, (radius - 1.0) / radius);
        for (model, bound) in [(Model::ClosedForm, 1e-14), (DOP853, 1e-9)] {
            let end = roll(1.0, &dish(radius), (0.0, 0.0), model, motion);
            let off = (end.arc_length - 1.0).abs();
            // A small difference `gap` of the two radii causes a loss of digits in the difference of the curvatures.
            // Therefore, the bound increases with 1/gap.
            assert!(off < bound + 5e-16 / gap, "{model:?}, {gap:e}: {off:e}");
        }
    }
}

#[test]
fn conforming_on_the_way_is_located() {
    // The object is a wave whose trough has a smaller radius of curvature than the probe.
    let object = height_field("0.5*cos(2*x)", &[]);
    let motion = Motion::rolling(0.0, 1.0, 10.0);
    let roller = roller(1.0, &object, (0.0, 0.0), DOP853, motion);
    let error = roller.roll(&[motion]).unwrap_err();
    assert!(
        matches!(error.fault, RollFault::Conforming { .. }),
        "{error}"
    );
    // The roll ends where the object is as concave as the probe (radius 1) is convex: its curvature is −1, so 2 cos(2x)
    // = −(1 + sin²(2x))^{3/2}. Near this point, the speed of the contact grows without limit. So the position has only
    // half as many correct digits as the time.
    let x = error.on_object.x;
    let curvature = 2.0 * libm::cos(2.0 * x) / libm::pow(1.0 + libm::sin(2.0 * x).powi(2), 1.5);
    assert!(
        (curvature + 1.0).abs() < 1e-5,
        "x = {x}, curvature {curvature}"
    );
    assert!(error.time_s > 0.0 && error.time_s < 10.0);
}

/// Errors of a roll that ends at a wall, one error for each form of the contact equations.
fn errors_at_wall(object: &Shape, motion: Motion) -> [RollError; 2] {
    [Chart::Free, Chart::Montana(Default::default())].map(|chart| {
        let model = dop853(1e-12, chart);
        let roller = roller(1.0, object, (0.0, 0.0), model, motion);
        let error = roller.roll(&[motion]).unwrap_err();
        let is_wall = matches!(
            error.fault,
            RollFault::Surface(SurfaceError::OffDomain { .. })
        );
        assert!(is_wall, "{error}");
        error
    })
}

#[test]
fn walls_are_located() {
    // The first object is a tilted plane that ends at x = 1, because the logarithm in its formula is undefined for
    // x ≥ 1. On the second object, the probe rolls on the parabola x = 1 − z² from z = 1 to its vertex. The roll angle θ
    // is the turn of the normal plus the arc length, because the radius of the probe is 1. The second tolerance is
    // large, because the parabola is vertical at its vertex, and near a vertical wall the slope has only half as many
    // correct digits as the height.
    let theta = libm::atan(2.0_f64) + 0.5 * 5.0_f64.sqrt() + 0.25 * libm::asinh(2.0_f64);
    for (formula, time_s, height, bound) in [
        ("x + 0*ln(1 - x)", 2.0_f64.sqrt(), 1.0, 1e-11),
        ("sqrt(1 - x)", theta, 0.0, 1e-5),
    ] {
        let object = height_field(formula, &[]);
        for error in errors_at_wall(&object, Motion::rolling(0.0, 1.0, 10.0)) {
            let off = error.on_object - Point3::new(1.0, 0.0, height);
            assert!((error.time_s - time_s).abs() < bound, "{error}");
            assert!(off.xy().norm() < 1e-11 && off.z.abs() < bound, "{error}");
        }
    }
}

#[test]
fn a_start_off_the_object_is_refused() {
    let rolls = vec![vec![Motion::rolling(0.0, 1.0, 1.0)]];
    let probe = Sphere::new(1.0).unwrap();
    for place in [(4.0, 4.0), (f64::NAN, 0.0)] {
        let rolls = Rolls::exact(&rolls);
        let error = Roller::new(probe, sphere(5.0), place, DOP853, rolls);
        assert!(matches!(error, Err(InvalidRoll::FirstContact(_))));
    }
}

#[test]
fn forced_rungs_say_why_not() {
    let rolling = Motion::rolling(0.0, 0.1, 1.0);
    let text = |object, model, motion| refused(1.0, object, model, motion).to_string();
    assert_eq!(
        text(saddle(0.1), Model::ClosedForm, rolling),
        "the model `closed form` cannot compute this: a saddle has no closed form"
    );
    let aslant = Motion::rolling(0.3, 0.1, 1.0);
    assert_eq!(
        text(saddle(0.1), Model::Meridian, aslant),
        "the model `meridian` cannot compute this: the first contact is not the apex of a surface of \
         revolution, nor of a line of symmetry along the motion"
    );
    let spinning = Motion {
        angular_velocity: nalgebra::Vector3::new(0.0, 0.1, 0.1),
        ..rolling
    };
    assert_eq!(
        text(plane(), Model::ClosedForm, spinning),
        "the model `closed form` cannot compute this: the motion spins"
    );
    for steps in [0, usize::MAX] {
        let model = Model::Rk4 {
            steps,
            chart: Chart::Free,
        };
        assert_eq!(
            text(plane(), model, rolling),
            format!("the model `RK4` cannot compute this: {steps} steps are not from 1 to 100000")
        );
    }
    let chart = Chart::Free;
    for tolerance in [0.0, 1e-15, 0.11, f64::NAN] {
        for model in [Model::Auto { tolerance, chart }, dop853(tolerance, chart)] {
            let error = refused(1.0, paraboloid(1.0), model, rolling);
            assert!(matches!(error, InvalidRoll::Tolerance(_)));
        }
    }
}

#[test]
fn motions_that_are_not_numbers_are_errors() {
    let motion = Motion::rolling(0.0, 0.1, 1.0);
    for object in [plane(), paraboloid(1.0), saddle(0.1)] {
        let model = auto(1e-9);
        let roller = roller(1.0, &object, (0.0, 0.0), model, motion);
        for bad in [f64::NAN, f64::INFINITY] {
            let lasting = Motion {
                duration_s: bad,
                ..motion
            };
            for motion in [lasting, Motion::rolling(0.0, bad, 1e10)] {
                let (end, shift) = (roller.roll(&[motion]), roller.shift(&[motion]));
                let error = end.unwrap_err();
                assert_eq!(error.fault, RollFault::NotFinite);
                assert_eq!(shift, Err(error));
            }
            assert!(roller.duration_for_arc(&motion, -bad).is_err());
        }
        for part in 0..3 {
            let mut broken = motion;
            broken.angular_velocity[part] = f64::NAN;
            assert_eq!(
                roller.roll(&[broken]).unwrap_err().fault,
                RollFault::NotFinite
            );
            let mut broken = motion;
            broken.sliding[part % 2] = f64::INFINITY;
            assert_eq!(
                roller.shift(&[broken]).unwrap_err().fault,
                RollFault::NotFinite
            );
        }
        let still = Motion::rolling(0.0, 0.0, 1.0);
        let error = roller.duration_for_arc(&still, 1.0).unwrap_err();
        assert_eq!(error.fault, RollFault::NotFinite);
        assert!(roller.roll(&[]).unwrap().arc_length == 0.0);
        assert!(roller.shift(&[]).unwrap().arc_length == 0.0);
        let backwards = Motion {
            duration_s: -1.0,
            ..motion
        };
        assert!(roller.shift(&[backwards]).unwrap().arc_length == 0.0);
    }
}
