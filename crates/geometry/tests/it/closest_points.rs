//! Closest points in cases that the general tests do not contain: far away, inside the solid, and where several points
//! are equally close.

use nalgebra::{Point3, Vector3};
use palpate_geometry::{Cylinder, Dish, Ellipsoid, Graph, Sphere, Surface, SurfaceError, Torus};
use proptest::prelude::*;

fn assert_none(surface: &impl Surface, x: f64, y: f64, z: f64) {
    let found = surface.closest_point(&Point3::new(x, y, z));
    assert_eq!(found, Err(SurfaceError::NoClosestPoint { x, y, z }));
}

#[test]
fn centres_and_axes_have_no_closest_point() {
    assert_none(&Sphere::new(2.0).unwrap(), 0.0, 0.0, 0.0);
    assert_none(&Dish::new(2.0).unwrap(), 0.0, -0.0, 0.0);
    for direction in [0.0_f64, 0.7, 2.0, -1.3] {
        let cylinder = Cylinder::new(0.5, direction).unwrap();
        for along in [0.0, 1.0, -3.7, 1e6] {
            let on_axis = cylinder.axis() * along;
            assert_none(&cylinder, on_axis.x, on_axis.y, on_axis.z);
        }
    }
    let torus = Torus::new(2.0, 0.5).unwrap();
    for height in [0.0, 0.3, -5.0] {
        assert_none(&torus, 0.0, 0.0, height);
    }
    for around in 0..40 {
        let (sin, cos) = libm::sincos(f64::from(around) * 0.157);
        assert_none(&torus, 2.0 * cos, 2.0 * sin, 0.0);
    }
}

#[test]
fn the_middle_of_an_ellipsoid_has_no_closest_point_and_its_outer_part_has() {
    // For a point in the symmetry plane across the shortest axis (z), two points of the ellipsoid, above and below, are
    // equally close. On the x axis, this is true for all points between the origin and the centre of curvature of the
    // ellipsoid's tip. This centre is at x = a − c²/a, where a is the longest and c the shortest semi-axis.
    let ellipsoid = Ellipsoid::new([3.0, 2.0, 1.0]).unwrap();
    assert_none(&ellipsoid, 0.0, 0.0, 0.0);
    assert_none(&ellipsoid, 1.0, 0.5, 0.0);
    assert_none(&ellipsoid, 2.66, 0.0, 0.0);
    let closest = |x, y, z| ellipsoid.closest_point(&Point3::new(x, y, z)).unwrap();
    assert_eq!(closest(2.67, 0.0, 0.0), Point3::new(3.0, 0.0, 0.0));
    assert_eq!(closest(0.0, -1.6, 0.0), Point3::new(0.0, -2.0, 0.0));
    assert_eq!(closest(0.0, 0.0, 1e-300), Point3::new(0.0, 0.0, 1.0));
    assert_eq!(closest(0.0, 0.0, -0.2), Point3::new(0.0, 0.0, -1.0));
    // On the axis of a prolate spheroid, between the centres of curvature of the tips, no single point is closest.
    let spindle = Ellipsoid::new([1.0, 1.0, 2.0]).unwrap();
    assert_none(&spindle, 0.0, 0.0, 1.49);
    let tip = spindle.closest_point(&Point3::new(0.0, 0.0, 1.51)).unwrap();
    assert_eq!(tip, Point3::new(0.0, 0.0, 2.0));
    assert_none(&Ellipsoid::new([2.0; 3]).unwrap(), 0.0, 0.0, 0.0);
}

#[test]
fn a_bowl_seen_from_beyond_its_centre_of_curvature_has_no_closest_point() {
    let bowl = Graph::paraboloid(-0.5).unwrap();
    assert_none(&bowl, 0.0, 0.0, 1.1);
    let apex = bowl.closest_point(&Point3::new(0.0, 0.0, 0.9)).unwrap();
    assert_eq!(apex, Point3::origin());
    // For a point on the axis inside of a hill, no single point of the hill is closest. For a point beside the axis,
    // the closest point is on the same side of the axis.
    let hill = Graph::paraboloid(0.5).unwrap();
    assert_none(&hill, 0.0, 0.0, -1.1);
    let inside = hill.closest_point(&Point3::new(0.2, 0.0, -3.0)).unwrap();
    assert!(inside.x > 1.0 && inside.y == 0.0);
}

/// Asserts that `found` is the closest point of an ellipsoid to `from`. The closest point is the only point of the
/// ellipsoid with `from = found + t ∇F/2` and `t >= −(shortest semi-axis)²`, where `F = x²/a² + y²/b² + z²/c²` with the
/// semi-axes a, b and c.
fn assert_closest(semi_axes: [f64; 3], from: Point3<f64>, found: Point3<f64>) {
    let axes = Vector3::from(semi_axes);
    let smallest = axes.min();
    let unit = found.coords.component_div(&axes);
    assert!(
        (unit.norm() - 1.0).abs() < 1e-14,
        "{found} is off the ellipsoid {semi_axes:?}"
    );
    let normal = unit.component_div(&axes).normalize();
    let gap = from - found;
    let along = gap.dot(&normal);
    let aside = (gap - normal * along).norm();
    let scale = axes.max() + from.coords.norm();
    assert!(
        aside <= 1e-11 * scale,
        "{aside} aside at {found} from {from}, {semi_axes:?}"
    );
    let lowest = -smallest * smallest * unit.component_div(&axes).norm();
    assert!(
        along >= lowest - 1e-11 * scale,
        "{found} lies on the far side of {from}"
    );
    for axis in 0..3 {
        assert!(
            found[axis] * from[axis] >= 0.0,
            "{found} lies across from {from}"
        );
    }
}

fn decades(exponents: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    prop_oneof![
        1 => Just(0.0),
        12 => (exponents, any::<bool>()).prop_map(|(exponent, negative)| {
            let size = libm::pow(10.0_f64, exponent);
            if negative { -size } else { size }
        }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..Default::default() })]

    #[test]
    fn of_an_ellipsoid_from_far_inside_and_near_its_planes_of_symmetry(
        exponents in [-6.0..6.0_f64, -6.0..6.0, -6.0..6.0],
        share in [decades(-20.0..6.0), decades(-20.0..6.0), decades(-20.0..6.0)],
    ) {
        let semi_axes = exponents.map(|exponent| libm::pow(10.0_f64, exponent));
        let from = Point3::from(Vector3::from(semi_axes).component_mul(&Vector3::from(share)));
        match Ellipsoid::new(semi_axes).unwrap().closest_point(&from) {
            Ok(found) => assert_closest(semi_axes, from, found),
            // Only points inside of the ellipsoid, in the symmetry plane across its shortest axis, have several closest
            // points and return an error.
            Err(_) => {
                let axis = Vector3::from(semi_axes).imin();
                prop_assert!(from[axis] == 0.0 && Vector3::from(share).norm() < 1.0);
            }
        }
    }
}
