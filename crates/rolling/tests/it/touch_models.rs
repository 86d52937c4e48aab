//! Compares the models of gliding fingertips with each other.

use palpate_geometry::Shape;
use palpate_rolling::{Fingertip, Glider, InvalidTouch, Model, TouchModel};

use crate::scenes::{
    cylinder, dish, ellipsoid, height_field, paraboloid, plane, saddle, sphere, torus,
};

fn on(object: &Shape, radius: f64, model: TouchModel) -> Glider {
    let glider = Glider::new(object.clone(), Fingertip::Sphere { radius }).unwrap();
    glider.on(model).unwrap()
}

fn newton(tolerance: f64) -> TouchModel {
    TouchModel::Newton { tolerance }
}

/// Positions in a square with the half-width `half_width`, none of them on a line of symmetry.
fn places(half_width: f64) -> impl Iterator<Item = (f64, f64)> {
    (0..49).map(move |index| {
        let [i, j] = [index / 7, index % 7].map(f64::from);
        (half_width * (i / 2.93 - 1.0), half_width * (j / 3.07 - 1.0))
    })
}

#[test]
fn closed_forms_are_what_newton_finds() {
    let objects = [
        sphere(2.0),
        dish(3.0),
        plane(),
        cylinder(2.0, 20.0),
        cylinder(0.1, 90.0),
    ];
    for object in objects {
        for radius in [1e-6, 0.1, 1.0, 2.7, 400.0] {
            let closed = on(&object, radius, TouchModel::ClosedForm);
            let searched = on(&object, radius, newton(Model::SMALLEST_TOLERANCE));
            for (x, y) in places(1.2 * (2.0 + radius)) {
                let what = format!("{} {radius} {x} {y}", object.name());
                match (closed.touch(x, y), searched.touch(x, y)) {
                    (Ok(closed), Ok(searched)) => {
                        let rim = 1.0 / closed.normal.z;
                        let off = (closed.point - searched.point).norm();
                        assert!(off < 1e-13 * rim * (2.0 + radius), "{what}: {off:e}");
                        let turned = (closed.normal - searched.normal).norm();
                        assert!(turned < 1e-12 * rim, "{what}: {turned:e}");
                        assert!(
                            (closed.curvature.mean_curvature()
                                - searched.curvature.mean_curvature())
                            .abs()
                                < 1e-10
                        );
                    }
                    (Err(closed), Err(searched)) => {
                        assert_eq!(<&str>::from(closed), <&str>::from(searched), "{what}");
                    }
                    (closed, searched) => panic!("{what}: {closed:?}, {searched:?}"),
                }
            }
        }
    }
}

#[test]
fn newton_stops_within_its_tolerance() {
    let objects = [
        (ellipsoid(3.0, 2.0, 1.0), 1.3),
        (torus(3.0, 1.0), 2.9),
        (paraboloid(0.5), 3.0),
        (paraboloid(-0.2), 3.0),
        (saddle(0.1), 3.0),
        (saddle(0.3), 2.0),
        (height_field("0.15*sin(2*x)*cos(y) + 0.3*x", &[]), 3.0),
        (height_field("0.3*sin(2*x)*cos(1.5*y) + 0.1*x", &[]), 3.0),
        (sphere(2.0), 2.0),
    ];
    for (object, half_width) in objects {
        for radius in [1.1, 2.3, 30.0] {
            let exact = on(&object, radius, newton(Model::SMALLEST_TOLERANCE));
            for tolerance in [0.1, 1e-6, 1e-12] {
                let quick = on(&object, radius, newton(tolerance));
                for (x, y) in places(half_width) {
                    let what = format!("{} {radius} {x} {y} {tolerance:e}", object.name());
                    match (quick.touch(x, y), exact.touch(x, y)) {
                        (Ok(quick), Ok(exact)) => {
                            let off = (quick.point - exact.point).norm() / radius;
                            assert!(off <= tolerance.max(1e-12), "{what}: {off:e}");
                        }
                        (Err(quick), Err(exact)) => {
                            assert_eq!(<&str>::from(quick), <&str>::from(exact), "{what}")
                        }
                        (quick, exact) => panic!("{what}: {quick:?}, {exact:?}"),
                    }
                }
            }
        }
    }
}

#[test]
fn what_auto_takes_and_what_models_refuse() {
    let auto = TouchModel::Auto { tolerance: 1e-6 };
    for object in [sphere(2.0), dish(2.0), plane(), cylinder(1.0, 0.0)] {
        assert_eq!(
            on(&object, 0.5, auto).choice().model,
            TouchModel::ClosedForm
        );
    }
    for object in [saddle(0.1), ellipsoid(1.0, 1.0, 1.0), torus(2.0, 1.0)] {
        assert_eq!(on(&object, 0.5, auto).choice().model, newton(1e-6));
        let glider = Glider::new(object, Fingertip::Sphere { radius: 0.5 }).unwrap();
        assert!(matches!(
            glider.on(TouchModel::ClosedForm),
            Err(InvalidTouch::Unsupported { .. })
        ));
    }
    let points = Glider::new(saddle(0.1), Fingertip::Point).unwrap();
    assert_eq!(points.choice().model, TouchModel::ClosedForm);
    assert!(matches!(
        points.on(newton(1e-9)),
        Err(InvalidTouch::Unsupported { .. })
    ));
    for tolerance in [0.0, 0.11, 1e-15, f64::NAN] {
        for model in [TouchModel::Auto { tolerance }, newton(tolerance)] {
            let refused = on(&sphere(2.0), 0.5, auto).on(model);
            assert!(matches!(refused, Err(InvalidTouch::Tolerance(_))));
        }
    }
}
