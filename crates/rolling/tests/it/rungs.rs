//! Compares all models that can compute the same roll with each other and with exact solutions.

use approx::assert_relative_eq;
use nalgebra::{Vector2, Vector3};
use palpate_geometry::{Shape, Sphere};
use palpate_rolling::{Chart, HeldAxis, Model, Motion, Roller, Rolls};

use crate::scenes::{
    DOP853, auto, cylinder, difference, dish, dop853, ellipsoid, height_field, paraboloid, plane,
    roll, roller, saddle, sphere, torus,
};

fn homogeneous() -> [(Shape, (f64, f64)); 6] {
    [
        (plane(), (0.3, -2.0)),
        (sphere(5.0), (1.0, -2.0)),
        (sphere(0.2), (0.0, 0.0)),
        (dish(3.0), (0.5, 0.2)),
        (cylinder(0.7, 30.0), (0.2, 0.1)),
        (cylinder(4.0, 0.0), (1.0, 1.0)),
    ]
}

#[test]
fn closed_form_is_the_integrated_law() {
    let sliding = Motion {
        sliding: Vector2::new(0.05, -0.03),
        ..Motion::rolling(0.3, 0.5, 1.5)
    };
    let rolling = [0.0_f64, 0.4, 2.0, -1.2].map(|direction| Motion::rolling(direction, 0.7, 2.0));
    for (object, start) in homogeneous() {
        for motion in rolling.into_iter().chain([sliding]) {
            let closed = roll(1.0, &object, start, Model::ClosedForm, motion);
            let integrated = roll(1.0, &object, start, DOP853, motion);
            let off = difference(&closed, &integrated, 1.0);
            assert!(off < 1e-12, "{} {motion:?}: {off:e}", object.name());
        }
    }
}

#[test]
fn meridian_is_the_integrated_law() {
    let objects = [
        paraboloid(1.0),
        paraboloid(5.0),
        paraboloid(0.01),
        paraboloid(200.0),
        paraboloid(1e-9),
        paraboloid(-0.3),
        paraboloid(-0.499),
        paraboloid(0.0),
        ellipsoid(2.0, 2.0, 1.0),
        ellipsoid(1.0, 1.0, 3.0),
        ellipsoid(1.0, 1.0, 0.02),
        ellipsoid(0.05, 0.05, 5.0),
        height_field("0.3*exp(-x^2 - y^2)", &[]),
        height_field("0.1*sqrt(1 + (y*y + x*x)^2) - 0.4*(x^2 + y^2)", &[]),
        height_field("cos(3*(x^2 + y^2))/1000", &[]),
    ];
    for object in objects {
        for theta in [1e-6, 0.1, 1.0, 4.0] {
            let motion = Motion::rolling(2.3, 1.0, theta);
            let meridian = roll(1.0, &object, (0.0, 0.0), Model::Meridian, motion);
            let integrated = roll(1.0, &object, (0.0, 0.0), DOP853, motion);
            let off = difference(&meridian, &integrated, 1.0);
            assert!(off < 1e-11, "{:?} {theta}: {off:e}", object);
        }
    }
}

#[test]
fn lines_of_symmetry_are_meridians_unless_noise_leaves_them() {
    use std::f64::consts::FRAC_PI_2;

    let auto = auto(1e-9);
    let formulas = [
        "1 - 0.3*x^2 + y*y/20",
        "0.1*cos(2*x)*cosh(y/2)",
        "abs(x)^3/-9 - y*sin(y)/20",
    ];
    let objects = [saddle(0.3), saddle(-0.1), ellipsoid(3.0, 2.0, 1.0)];
    let formulas = formulas.map(|formula| height_field(formula, &[]));
    for object in objects.into_iter().chain(formulas) {
        for quarter in 0..4 {
            let motion = Motion::rolling(f64::from(quarter) * FRAC_PI_2, 1.0, 0.8);
            let rolled = roller(1.0, &object, (0.0, 0.0), auto, motion);
            assert_eq!(rolled.choice().model, Model::Meridian, "{object:?}");
            let integrated = roll(1.0, &object, (0.0, 0.0), DOP853, motion);
            let off = difference(&rolled.roll(&[motion]).unwrap(), &integrated, 1.0);
            assert!(off < 1e-11, "{object:?} {quarter}: {off:e}");
            // This motion is not along a meridian, so its path is computed by the integrator.
            let aslant = Motion::rolling(1.0, 1.0, 0.8);
            let integrated = roll(1.0, &object, (0.0, 0.0), DOP853, aslant);
            let off = difference(&rolled.roll(&[aslant]).unwrap(), &integrated, 1.0);
            assert!(off < 1e-11, "{object:?}: {off:e}");
            let shift = rolled.shift(&[aslant]).unwrap();
            assert!((shift.arc_length - integrated.arc_length).abs() < 1e-11);
            // If the scene has noise, the meridian model is rejected, because noise would move the probe off the
            // meridian.
            let noisy = Rolls {
                rolls: &[vec![motion]],
                has_noise: true,
            };
            let choice = rolled.on(auto, noisy).unwrap();
            assert_ne!(choice.choice().model, Model::Meridian, "{object:?}");
        }
        let aslant = roller(
            1.0,
            &object,
            (0.0, 0.0),
            auto,
            Motion::rolling(1.0, 1.0, 0.8),
        );
        assert_ne!(aslant.choice().model, Model::Meridian, "{object:?}");
    }
}

#[test]
fn charts_agree_with_the_chart_free_form_under_spin_and_sliding() {
    let objects = [
        (saddle(0.1), (0.3, -0.2)),
        (ellipsoid(5.0, 3.0, 2.0), (1.0, 0.5)),
        (torus(3.0, 1.5), (3.0, 0.4)),
        (
            height_field("0.1*x*x - 0.05*x*y + 0.02*y^3", &[]),
            (0.2, 0.1),
        ),
        (cylinder(2.0, 30.0), (0.1, 0.2)),
    ];
    let motion = Motion {
        angular_velocity: Vector3::new(0.3, -0.4, 0.6),
        sliding: Vector2::new(0.1, -0.05),
        duration_s: 1.5,
    };
    let montana = dop853(1e-13, Chart::Montana(HeldAxis::Transported));
    for (object, start) in objects {
        let free = roll(1.0, &object, start, DOP853, motion);
        let charts = roll(1.0, &object, start, montana, motion);
        let off = difference(&free, &charts, 1.0);
        assert!(off < 1e-10, "{}: {off:e}", object.name());
    }
}

#[test]
fn an_axis_held_in_the_chart_agrees_along_a_line_of_symmetry_only() {
    let held = dop853(1e-12, Chart::Montana(HeldAxis::Chart));
    let along_symmetry = Motion::rolling(0.0, 1.0, 1.0);
    let off = difference(
        &roll(1.0, &saddle(0.1), (0.0, 0.0), held, along_symmetry),
        &roll(1.0, &saddle(0.1), (0.0, 0.0), DOP853, along_symmetry),
        1.0,
    );
    assert!(off < 1e-10, "{off:e}");
    let oblique = Motion::rolling(0.6, 1.0, 2.0);
    let off = difference(
        &roll(1.0, &saddle(0.1), (0.4, -0.2), held, oblique),
        &roll(1.0, &saddle(0.1), (0.4, -0.2), DOP853, oblique),
        1.0,
    );
    assert!(off > 1e-3, "{off:e}");
}

#[test]
fn motions_beyond_a_closed_form_or_a_meridian_are_integrated() {
    let rolling = Motion::rolling(0.4, 0.7, 1.0);
    let spinning = Motion {
        angular_velocity: rolling.angular_velocity + Vector3::z(),
        ..rolling
    };
    let sliding = Motion {
        sliding: Vector2::new(0.1, -0.2),
        ..rolling
    };
    for (object, model) in [
        (sphere(5.0), Model::ClosedForm),
        (dish(3.0), Model::ClosedForm),
        (paraboloid(1.0), Model::Meridian),
        (ellipsoid(2.0, 2.0, 1.0), Model::Meridian),
    ] {
        // The roller's model was chosen for rolling without spin and sliding, but it is used for other motions here.
        let quick = roller(1.0, &object, (0.0, 0.0), model, rolling);
        let integrated = roller(1.0, &object, (0.0, 0.0), DOP853, rolling);
        for motions in [
            vec![spinning],
            vec![sliding],
            vec![rolling, Motion::rolling(2.0, 0.3, 1.0), spinning],
        ] {
            let off = difference(
                &quick.roll(&motions).unwrap(),
                &integrated.roll(&motions).unwrap(),
                1.0,
            );
            assert!(off < 1e-12, "{}: {off:e}", object.name());
            let (a, b) = (
                quick.shift(&motions).unwrap(),
                integrated.shift(&motions).unwrap(),
            );
            assert!((a.displacement - b.displacement).norm() < 1e-12);
            assert!((a.arc_length - b.arc_length).abs() < 1e-12);
        }
    }
}

#[test]
fn a_meridian_takes_no_motion_that_changes_on_the_way() {
    let rolls = [vec![
        Motion::rolling(0.3, 0.6, 1.0),
        Motion::rolling(2.0, 0.3, 1.0),
    ]];
    let (probe, rolls) = (Sphere::new(1.0).unwrap(), Rolls::exact(&rolls));
    let made = Roller::new(probe, paraboloid(1.0), (0.0, 0.0), Model::Meridian, rolls);
    let error = made.err().unwrap().to_string();
    assert!(error.contains("the motion changes on the way"), "{error}");
}

#[test]
fn shift_is_the_displacement_of_the_contact() {
    let motion = Motion::rolling(0.7, 0.4, 1.0);
    for (object, model) in [
        (sphere(5.0), Model::ClosedForm),
        (paraboloid(0.5), Model::Meridian),
        (saddle(0.3), DOP853),
    ] {
        let roller = roller(1.0, &object, (0.0, 0.0), model, motion);
        let quick = roller.shift(&[motion]).unwrap();
        let full = roller
            .roll(&[motion])
            .unwrap()
            .shift_from(roller.first_contact(), 1.0);
        assert!((quick.displacement - full.displacement).norm() < 1e-14);
        assert!((quick.arc_length - full.arc_length).abs() < 1e-14);
    }
}

#[test]
fn duration_for_arc_inverts_the_arc_length() {
    for (object, start, model) in [
        (sphere(5.0), (0.0, 0.0), Model::ClosedForm),
        (paraboloid(5.0), (0.0, 0.0), Model::Meridian),
        (saddle(0.3), (0.2, 0.1), DOP853),
    ] {
        let motion = Motion::rolling(0.5, 0.3, 1.0);
        let roller = roller(1.0, &object, start, model, motion);
        for arc in [1e-6, 0.1, 1.0] {
            let duration_s = roller.duration_for_arc(&motion, arc).unwrap();
            let end = roller
                .roll(&[Motion {
                    duration_s,
                    ..motion
                }])
                .unwrap();
            assert_relative_eq!(end.arc_length, arc, max_relative = 1e-12);
        }
    }
    // The arc length in this test is so small that its square underflows.
    let motion = Motion::rolling(0.3, 0.7, 1.0);
    let roller = roller(1.0, &sphere(3.0), (0.0, 0.0), Model::ClosedForm, motion);
    let found = roller.duration_for_arc(&motion, 1e-300).unwrap();
    assert_relative_eq!(found, 1e-300 * 4.0 / 3.0 / 0.7, max_relative = 1e-15);
}
