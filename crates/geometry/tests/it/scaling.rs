//! If all lengths of a surface are multiplied by 2^k, its curvatures are multiplied by exactly 2^−k.

use palpate_geometry::surfaces::{Cylinder, Dish, Ellipsoid, Graph, Sphere, Torus};
use palpate_geometry::{CurvatureForm, Parameters, Surface};

/// Compares surfaces of several sizes with the surface of size 1. `lengths` states which of the two chart parameters
/// are lengths.
fn scales_exactly<S: Surface>(of_size: impl Fn(f64) -> S, lengths: [bool; 2]) {
    let unit = of_size(1.0);
    for k in -40..=40 {
        let size = 2.0_f64.powi(k);
        let surface = of_size(size);
        for (u, v) in [
            (0.0, 0.0),
            (0.3, -0.2),
            (-1.1, 2.7),
            (1.4, 0.9),
            (0.7, -1.3),
        ] {
            let at = Parameters::new(u, v);
            let [scale_u, scale_v] = lengths.map(|is_length| if is_length { size } else { 1.0 });
            let here = surface
                .chart_geometry(Parameters::new(u * scale_u, v * scale_v))
                .unwrap();
            let there = unit.chart_geometry(at).unwrap();
            assert_eq!(here.frame, there.frame);
            assert_eq!(here.point, there.point * size);
            assert_eq!(here.torsion * size, there.torsion);
            assert_same(here.curvature, there.curvature, size);

            let (x, y) = (here.frame.x, here.frame.y);
            let local = surface.level_set(&here.point).unwrap();
            let reference = unit.level_set(&there.point).unwrap();
            assert_eq!(local.normal, reference.normal);
            assert_same(local.curvature(&x, &y), reference.curvature(&x, &y), size);
            assert_eq!(local.shape_operator() * size, reference.shape_operator());

            let (_, form) = surface.curvature_along(&here.point, &x).unwrap();
            let (_, expected) = unit.curvature_along(&there.point, &x).unwrap();
            assert_same(form, expected, size);
            let (a, b) = (form.principal(), expected.principal());
            assert_eq!(a.k_min * size, b.k_min);
            assert_eq!(a.k_max * size, b.k_max);
            assert_eq!(
                form.gaussian_curvature() * size * size,
                expected.gaussian_curvature()
            );
            assert_eq!(form.mean_curvature() * size, expected.mean_curvature());
            assert_eq!(
                form.principal().shape_index(),
                expected.principal().shape_index()
            );
        }
    }
}

fn assert_same(form: CurvatureForm, expected: CurvatureForm, size: f64) {
    assert_eq!(form.matrix() * size, expected.matrix());
}

#[test]
fn sphere_and_dish() {
    scales_exactly(|size| Sphere::new(1.3 * size).unwrap(), [false, false]);
    scales_exactly(|size| Dish::new(0.7 * size).unwrap(), [false, false]);
}

#[test]
fn cylinder() {
    scales_exactly(
        |size| Cylinder::new(1.3 * size, 0.6).unwrap(),
        [true, false],
    );
}

#[test]
fn ellipsoid() {
    let of_size = |size| Ellipsoid::new([1.3, 0.4, 2.1].map(|axis| axis * size)).unwrap();
    scales_exactly(of_size, [false, false]);
}

#[test]
fn torus() {
    scales_exactly(
        |size| Torus::new(1.7 * size, 0.6 * size).unwrap(),
        [false, false],
    );
}

#[test]
fn paraboloid_and_saddle() {
    scales_exactly(|size| Graph::paraboloid(0.9 / size).unwrap(), [true, true]);
    scales_exactly(|size| Graph::paraboloid(-0.3 / size).unwrap(), [true, true]);
    scales_exactly(|size| Graph::saddle(0.4 / size).unwrap(), [true, true]);
}
