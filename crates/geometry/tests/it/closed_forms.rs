//! Compares each surface with formulas from textbooks.

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use approx::{assert_abs_diff_eq, assert_relative_eq};
use nalgebra::{Matrix2, Point3, RowVector2, Vector3};
use palpate_geometry::formula::Formula;
use palpate_geometry::surfaces::{Cylinder, Dish, Ellipsoid, Graph, Plane, Sphere, Torus};
use palpate_geometry::{ChartGeometry, CurvatureForm, Parameters, Surface};

/// Calls `check` at several points of a chart whose two parameters are angles, with the first angle and the geometry at
/// the point.
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
        assert_relative_eq!(found.frame.normal, found.point.coords / r, epsilon = 1e-15);
    });
    over_angles(&dish, |u, found| {
        assert_forms(
            &found,
            [r, r * libm::cos(u)],
            [-1.0 / r, -1.0 / r],
            torsion(u),
        );
        assert_relative_eq!(found.frame.normal, -found.point.coords / r, epsilon = 1e-15);
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
        assert_eq!(found.frame.x, cylinder.axis());
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
fn triaxial_ellipsoid() {
    let semi_axes = Vector3::new(1.3, 0.4, 2.1);
    let squares = semi_axes.component_mul(&semi_axes);
    over_angles(&Ellipsoid::new(semi_axes.into()).unwrap(), |_, found| {
        // Let a, b and c be the semi-axes, and p the distance of the tangent plane from the centre. The Gaussian
        // curvature is K = p⁴/(abc)², and the mean curvature is H = p³ (a² + b² + c² − |x|²)/(2 (abc)²).
        let p = 1.0 / found.point.coords.component_div(&squares).norm();
        let product = semi_axes.product().powi(2);
        let mean = p.powi(3) * (squares.sum() - found.point.coords.norm_squared());
        let form = found.curvature;
        assert_relative_eq!(
            form.gaussian_curvature(),
            p.powi(4) / product,
            max_relative = 1e-12
        );
        assert_relative_eq!(
            form.mean_curvature(),
            mean / (2.0 * product),
            max_relative = 1e-12
        );
    });
}

#[test]
fn torus_is_a_saddle_on_its_inner_side() {
    let (major, minor) = (2.0, 0.7);
    let torus = Torus::new(major, minor).unwrap();
    over_angles(&torus, |u, found| {
        let rho = major + minor * libm::sin(u);
        let curvature = [1.0 / minor, libm::sin(u) / rho];
        assert_forms(&found, [minor, rho], curvature, [0.0, libm::cos(u) / rho]);
    });
    let gaussian = |u| {
        let geometry = torus.chart_geometry(Parameters::new(u, 0.3)).unwrap();
        geometry.curvature.gaussian_curvature()
    };
    assert_relative_eq!(gaussian(FRAC_PI_2), 1.0 / (0.7 * 2.7), epsilon = 1e-14);
    assert_relative_eq!(gaussian(-FRAC_PI_2), -1.0 / (0.7 * 1.3), epsilon = 1e-14);
    assert_abs_diff_eq!(gaussian(0.0), 0.0);
    assert_abs_diff_eq!(gaussian(PI), 0.0, epsilon = 1e-15);
}

fn at_origin(graph: &impl Surface) -> CurvatureForm {
    let here = graph.chart_geometry(Parameters::new(0.0, 0.0)).unwrap();
    assert_eq!(here.frame.normal, Vector3::z());
    assert_eq!(here.frame.x, Vector3::x());
    here.curvature
}

#[test]
fn paraboloid_and_saddle_at_the_origin() {
    for c in [5.0, 0.01, -0.3] {
        let form = at_origin(&Graph::paraboloid(c).unwrap());
        assert_eq!(form, CurvatureForm::isotropic(2.0 * c));
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
fn paraboloid_away_from_its_apex() {
    let c = 0.8;
    let paraboloid = Graph::paraboloid(c).unwrap();
    for r in [0.0, 0.1, 1.0, 30.0] {
        let here = paraboloid.chart_geometry(Parameters::new(r, 0.0)).unwrap();
        let stretch = (1.0 + (2.0 * c * r).powi(2)).sqrt();
        assert_relative_eq!(
            here.curvature.k_uu,
            2.0 * c / stretch.powi(3),
            max_relative = 1e-14
        );
        assert_relative_eq!(here.curvature.k_vv, 2.0 * c / stretch, max_relative = 1e-14);
        assert_eq!(here.curvature.k_uv, 0.0);
    }
}

#[test]
fn forms_of_a_skewed_graph() {
    let formula = Formula::parse("0.4*x^2*y - 0.3*x*y + sin(y)", &BTreeMap::new()).unwrap();
    let graph = Graph::of_formula(formula);
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
fn a_formula_of_a_sphere_is_a_sphere() {
    for (text, curvature) in [
        ("sqrt(25 - x^2 - y^2)", 0.2),
        ("-sqrt(25 - x^2 - y^2)", -0.2),
    ] {
        let formula = Formula::parse(text, &BTreeMap::new()).unwrap();
        let graph = Graph::of_formula(formula);
        for (x, y) in [(0.0, 0.0), (3.0, 1.0), (-2.0, 4.0), (0.1, -4.9)] {
            let form = graph
                .chart_geometry(Parameters::new(x, y))
                .unwrap()
                .curvature;
            let expected = Matrix2::from_diagonal_element(curvature);
            assert_relative_eq!(form.matrix(), expected, epsilon = 1e-13);
        }
    }
}

#[test]
fn which_surfaces_are_homogeneous() {
    assert!(Sphere::new(1.0).unwrap().is_homogeneous());
    assert!(Dish::new(1.0).unwrap().is_homogeneous());
    assert!(Plane.is_homogeneous());
    assert!(Cylinder::new(1.0, 0.3).unwrap().is_homogeneous());
    assert!(!Torus::new(2.0, 1.0).unwrap().is_homogeneous());
    assert!(!Graph::paraboloid(1.0).unwrap().is_homogeneous());
}

#[test]
fn contacts_end_at_the_rim() {
    let touches = |surface: &dyn Fn(f64, f64) -> bool, inside: [f64; 2], outside: [f64; 2]| {
        assert!(surface(inside[0], inside[1]) && !surface(outside[0], outside[1]));
    };
    let sphere = Sphere::new(2.0).unwrap();
    touches(
        &|x, y| sphere.contact_at(x, y).is_ok(),
        [1.2, -1.6],
        [1.2, -1.61],
    );
    let dish = Dish::new(2.0).unwrap();
    assert_eq!(dish.contact_at(0.0, 0.0), Ok(Point3::new(0.0, 0.0, -2.0)));
    touches(
        &|x, y| dish.contact_at(x, y).is_ok(),
        [0.0, 2.0],
        [0.0, 2.001],
    );
    let cylinder = Cylinder::new(0.5, FRAC_PI_2).unwrap();
    touches(
        &|x, y| cylinder.contact_at(x, y).is_ok(),
        [0.49, 1e3],
        [-0.51, 0.0],
    );
    let ellipsoid = Ellipsoid::new([3.0, 2.0, 1.0]).unwrap();
    touches(
        &|x, y| ellipsoid.contact_at(x, y).is_ok(),
        [3.0, 0.0],
        [2.2, 1.4],
    );
    let torus = Torus::new(2.0, 0.5).unwrap();
    touches(
        &|x, y| torus.contact_at(x, y).is_ok(),
        [1.5, 0.0],
        [1.49, 0.0],
    );
    touches(
        &|x, y| torus.contact_at(x, y).is_ok(),
        [0.0, -2.5],
        [0.0, -2.51],
    );
}
