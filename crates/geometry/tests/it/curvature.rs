//! Curvature forms: principal curvatures, shape index and classes.

use std::f64::consts::FRAC_PI_2;

use approx::assert_relative_eq;
use palpate_geometry::{CurvatureForm, InvalidThresholds, ShapeThresholds};

#[test]
fn principal_directions_carry_the_principal_curvatures() {
    let form = CurvatureForm {
        k_uu: 0.3,
        k_uv: 0.4,
        k_vv: 0.9,
    };
    let p = form.principal();
    assert_relative_eq!(
        form.normal_curvature(p.angle_of_max_rad),
        p.k_max,
        epsilon = 1e-15
    );
    let across = p.angle_of_max_rad + FRAC_PI_2;
    assert_relative_eq!(form.normal_curvature(across), p.k_min, epsilon = 1e-15);
    assert_relative_eq!(
        p.k_min * p.k_max,
        form.gaussian_curvature(),
        epsilon = 1e-15
    );
    assert!(p.k_min <= p.k_max);
}

#[test]
fn shape_index_of_known_shapes() {
    let index = |k_uu, k_vv| {
        CurvatureForm {
            k_uu,
            k_uv: 0.0,
            k_vv,
        }
        .principal()
        .shape_index()
    };
    assert_relative_eq!(index(0.2, 0.2).unwrap(), 1.0);
    assert_relative_eq!(index(0.2, 0.0).unwrap(), 0.5);
    assert_relative_eq!(index(0.2, -0.2).unwrap(), 0.0);
    assert_relative_eq!(index(-0.2, 0.0).unwrap(), -0.5);
    assert_relative_eq!(index(-0.2, -0.2).unwrap(), -1.0);
    assert_eq!(index(0.0, 0.0), None);
}

#[test]
fn eight_classes() {
    let thresholds = ShapeThresholds::new(0.01, 0.1).unwrap();
    let class = |k, h| thresholds.classify(k, h).name();
    assert_eq!(class(1.0, 1.0), "peak");
    assert_eq!(class(0.0, 1.0), "ridge");
    assert_eq!(class(-1.0, 1.0), "saddle-ridge");
    assert_eq!(class(0.0, 0.0), "flat");
    assert_eq!(class(-1.0, 0.0), "minimal");
    assert_eq!(class(1.0, -1.0), "pit");
    assert_eq!(class(0.0, -1.0), "valley");
    assert_eq!(class(-1.0, -1.0), "saddle-valley");
    // A Gaussian curvature K above the squared mean curvature H² is impossible except by noise. `classify` then uses K
    // = H², which is 0 here.
    assert_eq!(class(1.0, 0.0), "flat");
}

#[test]
fn thresholds_that_would_admit_the_impossible_class_are_refused() {
    assert!(ShapeThresholds::new(0.005, 0.03).is_ok());
    let refused = ShapeThresholds::new(0.005, 0.1).unwrap_err();
    assert!(matches!(refused, InvalidThresholds::ImpossibleClass { .. }));
    for bad in [f64::NAN, f64::INFINITY, -1.0] {
        assert!(ShapeThresholds::new(bad, 0.0).is_err());
        assert!(ShapeThresholds::new(1.0, bad).is_err());
    }
}
