//! Compares each surface with formulas from textbooks.

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use approx::{assert_abs_diff_eq, assert_relative_eq};
use nalgebra::{Matrix2, Point3, RowVector2, Vector3};
use palpate_geometry::{
    ChartGeometry, CurvatureForm, Cylinder, Dish, Ellipsoid, Formula, Graph, Parameters, Plane,
    Shape, Sphere, Surface, Torus,
};

/// Calls `check` at several points of a chart whose two parameters are angles. `check` receives the first angle and the
/// geometry at the point.
fn over_angles(surface: &impl Surface, check: impl Fn(f64, ChartGeometry)) {
    for i in -7..=7 {
        for j in -7..=7 {
            let (u, v) = (0.21 * f64::from(i), 0.43 * f64::from(j) + 0.1);
            check(u, surface.chart_geometry(Parameters::new(u, v)).unwrap());
        }
    }
}

fn assert_forms(found: &ChartGeometry, metric: [f64; 2], curvature: [f64; 2], torsion: [f64; 2]) {
    let diagonal = |[a, b]: [f64; 2]| Matrix2::new(a, 0.0, 0.0, b);
    let turn = RowVector2::from(torsion);
    assert_relative_eq!(found.metric, diagonal(metric), epsilon = 1e-14);
    assert_relative_eq!(
        found.curvature.matrix(),
        diagonal(curvature),
        epsilon = 1e-14
    );
    assert_relative_eq!(found.torsion, turn, epsilon = 1e-14, max_relative = 1e-14);
}

#[test]
fn sphere_and_dish() {
    let r = 1.7;
    let (sphere, dish) = (Sphere::new(r).unwrap(), Dish::new(r).unwrap());
    assert_eq!([sphere.radius(), dish.radius()], [r; 2]);
    let torsion = |u: f64| [0.0, -libm::tan(u) / r];
    over_angles(&sphere, |u, found| {
        assert_forms(
            &found,
            [r, r * libm::cos(u)],
            [1.0 / r, 1.0 / r],
            torsion(u),
        );
        assert_relative_eq!(found.normal, found.point.coords / r, epsilon = 1e-15);
    });
    over_angles(&dish, |u, found| {
        assert_forms(
            &found,
            [r, r * libm::cos(u)],
            [-1.0 / r, -1.0 / r],
            torsion(u),
        );
        assert_relative_eq!(found.normal, -found.point.coords / r, epsilon = 1e-15);
    });
}

#[test]
fn plane_and_cylinder_do_not_turn_their_frames() {
    over_angles(&Plane, |_, found| {
        assert_forms(&found, [1.0; 2], [0.0; 2], [0.0; 2])
    });
    let cylinder = Cylinder::new(0.4, 1.1).unwrap();
    over_angles(&cylinder, |_, found| {
        assert_forms(&found, [1.0, 0.4], [0.0, 2.5], [0.0; 2]);
        assert_eq!(found.x_axis, cylinder.axis());
    });
}

#[test]
fn spheroid_about_the_axis_of_its_chart() {
    let (a, c) = (1.2, 0.5);
    over_angles(&Ellipsoid::new([c, a, a]).unwrap(), |u, found| {
        let w = libm::hypot(a * libm::sin(u), c * libm::cos(u));
        let curvature = [a * c / w.powi(3), c / (a * w)];
        assert_forms(
            &found,
            [w, a * libm::cos(u)],
            curvature,
            [0.0, -libm::tan(u) / w],
        );
    });
}

#[test]
fn torus() {
    let (major, minor) = (2.0, 0.7);
    over_angles(&Torus::new(major, minor).unwrap(), |u, found| {
        let rho = major + minor * libm::sin(u);
        let curvature = [1.0 / minor, libm::sin(u) / rho];
        assert_forms(&found, [minor, rho], curvature, [0.0, libm::cos(u) / rho]);
    });
}

fn at_origin(graph: &impl Surface) -> CurvatureForm {
    let here = graph.chart_geometry(Parameters::new(0.0, 0.0)).unwrap();
    assert_eq!(here.normal, Vector3::z());
    assert_eq!(here.x_axis, Vector3::x());
    here.curvature
}

#[test]
fn paraboloid_and_saddle_at_the_origin() {
    for c in [5.0, 0.01, -0.3] {
        let form = at_origin(&Graph::paraboloid(c).unwrap());
        assert_eq!(
            form,
            CurvatureForm {
                k_uu: 2.0 * c,
                k_uv: 0.0,
                k_vv: 2.0 * c
            }
        );
    }
    for a in [0.1, -2.0] {
        let form = at_origin(&Graph::saddle(a).unwrap());
        assert_eq!((form.k_uu, form.k_vv), (-2.0 * a, 2.0 * a));
        assert_eq!(form.k_uv, 0.0);
        assert_eq!(form.principal().shape_index(), Some(0.0));
        assert_abs_diff_eq!(form.normal_curvature(FRAC_PI_4), 0.0, epsilon = 1e-15);
        let steepest = if a > 0.0 { FRAC_PI_2 } else { 0.0 };
        assert_eq!(form.principal().angle_of_max_rad, steepest);
    }
}

#[test]
fn forms_of_a_skewed_graph() {
    let formula = Formula::parse("0.4*x^2*y - 0.3*x*y + sin(y)", &BTreeMap::new()).unwrap();
    let graph = Graph::from(formula);
    for (x, y) in [(0.3_f64, -0.7_f64), (1.1, 0.4), (-0.8, 2.0)] {
        let (fx, fy) = (0.8 * x * y - 0.3 * y, 0.4 * x * x - 0.3 * x + libm::cos(y));
        let (fxx, fxy, fyy) = (0.8 * y, 0.8 * x - 0.3, -libm::sin(y));
        let (p, w) = ((1.0 + fx * fx).sqrt(), (1.0 + fx * fx + fy * fy).sqrt());
        let s = fx * fy / (p * p);
        let here = graph.chart_geometry(Parameters::new(x, y)).unwrap();
        let metric = Matrix2::new(p, p * s, 0.0, w / p);
        assert_relative_eq!(here.metric, metric, epsilon = 1e-14);
        let k_uu = -fxx / (p * p * w);
        let k_uv = -(fxy - s * fxx) / (w * w);
        let k_vv = -(fyy - 2.0 * s * fxy + s * s * fxx) * p * p / w.powi(3);
        let expected = Matrix2::new(k_uu, k_uv, k_uv, k_vv);
        assert_relative_eq!(here.curvature.matrix(), expected, epsilon = 1e-14);
        let along_y = fy * (fxy - s * fxx) / (p * w * w);
        let torsion = RowVector2::new(fy * fxx / (p.powi(3) * w), along_y);
        assert_relative_eq!(here.torsion, torsion, epsilon = 1e-14);
    }
}

#[test]
fn contacts_end_at_the_rim() {
    let dish = Dish::new(2.0).unwrap();
    assert_eq!(dish.contact_at(0.0, 0.0), Ok(Point3::new(0.0, 0.0, -2.0)));
    let torus = Shape::Torus(Torus::new(2.0, 0.5).unwrap());
    let cylinder = Cylinder::new(0.5, FRAC_PI_2).unwrap();
    let ellipsoid = Ellipsoid::new([3.0, 2.0, 1.0]).unwrap();
    let sphere = Sphere::new(2.0).unwrap();
    for (surface, inside, outside) in [
        (Shape::Sphere(sphere), [1.2, -1.6], [1.2, -1.61]),
        (Shape::Dish(dish), [0.0, 2.0], [0.0, 2.001]),
        (Shape::Cylinder(cylinder), [0.49, 1e3], [-0.51, 0.0]),
        (Shape::Ellipsoid(ellipsoid), [3.0, 0.0], [2.2, 1.4]),
        (torus.clone(), [1.5, 0.0], [1.49, 0.0]),
        (torus, [0.0, -2.5], [0.0, -2.51]),
    ] {
        let touches = |[x, y]: [f64; 2]| surface.contact_at(x, y).is_ok();
        assert!(touches(inside) && !touches(outside), "{surface:?}");
    }
}
