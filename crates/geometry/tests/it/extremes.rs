//! Sizes, ratios and questions at and past the end of what numbers hold: a right answer or an error.

mod asked;
mod closest;
mod curvature;
mod formula;
mod made;
mod meridian;
mod places;
mod posed;

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI};

use approx::assert_relative_eq;
use nalgebra::{Point3, Vector3};
use palpate_geometry::formula::Formula;
use palpate_geometry::surfaces::{Cylinder, Dish, Ellipsoid, Graph, Plane, Sphere, Torus};
use palpate_geometry::{
    CurvatureForm, InvalidShape, Parameters, Posed, Shape, Surface, SurfaceError,
};
use proptest::prelude::*;

use crate::specimens;

#[test]
fn constructors_refuse_what_makes_no_surface() {
    fn refuses<T: std::fmt::Debug>(made: Result<T, InvalidShape>, parameter: &str, value: f64) {
        let refused = made.unwrap_err();
        assert_eq!(refused.parameter, parameter);
        assert!(refused.value == value || value.is_nan() && refused.value.is_nan());
    }
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -0.0, -1.0] {
        refuses(Sphere::new(bad), "radius", bad);
        refuses(Dish::new(bad), "radius", bad);
        refuses(Cylinder::new(bad, 0.0), "radius", bad);
        refuses(Torus::new(bad, 1.0), "major_radius", bad);
        refuses(Torus::new(1.0, bad), "minor_radius", bad);
        refuses(Ellipsoid::new([bad, 1.0, 1.0]), "semi_axes", bad);
        refuses(Ellipsoid::new([1.0, bad, 1.0]), "semi_axes", bad);
        refuses(Ellipsoid::new([1.0, 1.0, bad]), "semi_axes", bad);
    }
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        refuses(Cylinder::new(1.0, bad), "direction", bad);
        refuses(Graph::paraboloid(bad), "c", bad);
        refuses(Graph::saddle(bad), "a", bad);
    }
    refuses(Torus::new(1.0, 1.0), "minor_radius", 1.0);
    refuses(Torus::new(1.0, 2.0), "minor_radius", 2.0);
    refuses(Torus::new(1e200, 1.0), "major_radius", 1e200);
    refuses(Sphere::new(1e-200), "radius", 1e-200);
}

/// Surfaces of ordinary and of absurd size.
fn shapes() -> Vec<Shape> {
    let mut shapes: Vec<_> = specimens::all()
        .into_iter()
        .map(|specimen| specimen.shape)
        .collect();
    for size in [1e-145, 1e-100, 1e-80, 1e-70, 1e70, 1e80, 1e100, 1e145] {
        shapes.extend([
            Shape::Sphere(Sphere::new(size).unwrap()),
            Shape::Dish(Dish::new(size).unwrap()),
            Shape::Cylinder(Cylinder::new(size, 0.4).unwrap()),
            Shape::Ellipsoid(Ellipsoid::new([size, 1.0, 2.0]).unwrap()),
            Shape::Ellipsoid(Ellipsoid::new([size, size, 0.5 * size]).unwrap()),
            Shape::Ellipsoid(Ellipsoid::new([1.0, size, 1.0 / size]).unwrap()),
            Shape::Torus(Torus::new(size, 1e-3 * size).unwrap()),
            Shape::Torus(Torus::new(size.max(1.0), 0.5 * size.min(1.0)).unwrap()),
            Shape::Paraboloid(Graph::paraboloid(size).unwrap()),
            Shape::Saddle(Graph::saddle(-size).unwrap()),
        ]);
    }
    for curvature in [1e-308, 1e-200, 1e-160, 1e160, 1e200, 1e308, 0.0] {
        shapes.push(Shape::Paraboloid(Graph::paraboloid(curvature).unwrap()));
        shapes.push(Shape::Saddle(Graph::saddle(curvature).unwrap()));
    }
    // It would not notice what x and y are.
    let constant = Formula::parse("0.5", &BTreeMap::new()).unwrap();
    shapes.push(Shape::HeightField(Graph::of_formula(constant)));
    shapes
}

const EXTREMES: [f64; 17] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    f64::MIN,
    1e200,
    -1e155,
    1e100,
    -1e16,
    -1.0,
    0.7,
    0.0,
    -0.0,
    1e-9,
    1e-100,
    -1e-165,
    5e-324,
];

fn finite(values: &[f64]) -> bool {
    values.iter().all(|value| value.is_finite())
}

fn finite_form(form: &CurvatureForm) -> bool {
    finite(&[form.k_uu, form.k_uv, form.k_vv])
}

fn unit(vector: &Vector3<f64>) -> bool {
    (vector.norm() - 1.0).abs() < 1e-9
}

/// Asks everything at one triple; what comes is finite, and an error if the question is not.
fn ask(surface: &impl Surface, [a, b, c]: [f64; 3]) {
    let (at, p) = (Parameters::new(a, b), Point3::new(a, b, c));
    let reachable = finite(&[a, b]);

    let chart = surface.chart(at);
    assert!(reachable || chart.is_err(), "{chart:?} at {p}");
    if let Ok(jet) = chart {
        for part in [jet.point.coords, jet.du, jet.dv, jet.duu, jet.duv, jet.dvv] {
            assert!(finite(part.as_slice()), "{jet:?} at {p}");
        }
    }
    if let Ok(found) = surface.chart_geometry(at) {
        let frame = found.frame;
        let is_frame = unit(&frame.x) && unit(&frame.y) && unit(&frame.normal);
        let forms = [found.metric.as_slice(), found.torsion.as_slice()].concat();
        let are_finite = finite_form(&found.curvature) && finite(&forms);
        assert!(is_frame && are_finite, "{found:?} at {p}");
    }

    if let Ok(found) = surface.level_set(&p) {
        let is_finite = finite(found.second_form.as_slice());
        assert!(unit(&found.normal) && is_finite, "{found:?} at {p}");
    }
    for x in [Vector3::x(), Vector3::y(), Vector3::new(0.6, 0.0, 0.8)] {
        // Only on the surface is the normal promised to be a unit.
        if let Ok((normal, form)) = surface.curvature_along(&p, &x) {
            let is_finite = finite(normal.as_slice()) && finite_form(&form);
            assert!(is_finite, "{normal:?}, {form:?} at {p}");
        }
    }

    let (closest, touched) = (surface.closest_point(&p), surface.contact_at(a, b));
    assert!(finite(&[a, b, c]) || closest.is_err(), "{closest:?} at {p}");
    assert!(reachable || touched.is_err(), "{touched:?} at {p}");
    for found in [closest, touched].into_iter().flatten() {
        assert!(finite(found.coords.as_slice()), "{found:?} at {p}");
    }
    // No promise beyond returning.
    let _ = surface.parameters(&p);
    let _ = surface.meridian(&p);
}

#[test]
fn every_answer_is_finite_or_an_error() {
    let pose = specimens::poses()[1];
    for shape in shapes() {
        println!("{shape:?}");
        let posed = Posed::new(shape.clone(), pose).unwrap();
        for a in EXTREMES {
            for b in EXTREMES {
                for c in [0.3, a, f64::NAN] {
                    ask(&shape, [a, b, c]);
                }
                ask(&posed, [a, b, 0.3]);
            }
        }
    }
}

#[test]
fn a_chart_ends_at_its_poles() {
    fn ends(surface: &impl Surface, size: f64) {
        for (u, side) in [(FRAC_PI_2, 1.0), (-FRAC_PI_2, -1.0)] {
            for v in [0.0, 1.0, -3.0] {
                let at = Parameters::new(u, v);
                let singular = Err(SurfaceError::ChartSingular { u, v });
                assert_eq!(surface.chart_geometry(at), singular);
                // The surface goes on.
                let pole = surface.chart(at).unwrap().point;
                assert!((pole.x.abs() - size).abs() <= f64::EPSILON * size);
                let level_set = surface.level_set(&pole).unwrap();
                assert_relative_eq!(level_set.normal.x.abs(), 1.0);

                let past = if side > 0.0 {
                    u.next_up()
                } else {
                    u.next_down()
                };
                let beyond = Parameters::new(past, v);
                let singular = SurfaceError::ChartSingular { u: beyond.u, v };
                assert_eq!(surface.chart(beyond), Err(singular));
                assert_eq!(surface.chart_geometry(beyond), Err(singular));

                for short in [1e-3, 1e-8, 1e-13] {
                    let near = Parameters::new(u - side * short, v);
                    let here = surface.chart_geometry(near).unwrap();
                    let level_set = surface.level_set(&here.point).unwrap();
                    assert_relative_eq!(here.frame.normal, level_set.normal, epsilon = 1e-14);
                    let form = level_set.curvature(&here.frame.x, &here.frame.y).matrix();
                    let epsilon = 1e-13 * form.norm();
                    assert_relative_eq!(here.curvature.matrix(), form, epsilon = epsilon);
                }
            }
        }
    }
    for size in [1e-9, 1.0, 1e9] {
        ends(&Sphere::new(size).unwrap(), size);
        ends(&Dish::new(size).unwrap(), size);
        ends(
            &Ellipsoid::new([size, 2.0 * size, 0.5 * size]).unwrap(),
            size,
        );
    }
    // A cylinder and a torus have none.
    for (u, v) in [(FRAC_PI_2, FRAC_PI_2), (-PI, PI), (1e3, 1e4)] {
        let at = Parameters::new(u, v);
        assert!(Cylinder::new(1e-9, 0.3).unwrap().chart_geometry(at).is_ok());
        assert!(Torus::new(1e9, 1e-3).unwrap().chart_geometry(at).is_ok());
    }
}

#[test]
fn a_slope_too_steep_to_square_is_a_wall() {
    let (x, y) = (1e149, 0.0);
    let needle = Graph::paraboloid(1e10).unwrap();
    assert_eq!(
        needle.contact_at(x, y),
        Err(SurfaceError::OffDomain { x, y })
    );
    assert!(needle.contact_at(1e100, y).is_ok());
}

#[test]
fn formulas_end_where_they_are_undefined() {
    let asks = |text: &str, x: f64, y: f64| {
        let formula = Formula::parse(text, &BTreeMap::new()).unwrap();
        let graph = Graph::of_formula(formula);
        let above = Point3::new(x, y, 0.5);
        let at = Parameters::new(x, y);
        [
            graph.contact_at(x, y).map(|_| ()),
            graph.chart(at).map(|_| ()),
            graph.chart_geometry(at).map(|_| ()),
            graph.level_set(&above).map(|_| ()),
            graph.curvature_along(&above, &Vector3::x()).map(|_| ()),
            graph.closest_point(&above).map(|_| ()),
        ]
    };
    for (text, x, y) in [
        ("ln(x)", 0.0, 1.0),
        ("ln(x)", -1.0, 1.0),
        ("sqrt(1 - x^2 - y^2)", 0.9, 0.9),
        ("sqrt(1 - x^2 - y^2)", 1.0, 0.0),
        ("1/(x*y)", 0.0, 2.0),
        ("abs(x)", 0.0, 2.0),
        ("exp(x)", 800.0, 0.0),
        ("x + y", f64::NAN, 0.0),
        ("x + y", 0.0, f64::INFINITY),
    ] {
        for answer in asks(text, x, y) {
            match answer {
                Err(SurfaceError::OffDomain { x: at_x, y: at_y }) => {
                    assert!(at_x.to_bits() == x.to_bits() && at_y.to_bits() == y.to_bits());
                }
                other => panic!("{text} at {x}, {y}: {other:?}"),
            }
        }
        assert!(asks(text, 0.4, 0.3).iter().all(Result::is_ok), "{text}");
    }
}

#[test]
fn principal_directions_lie_in_their_half_turn() {
    for tiny in [0.0, -0.0, 1e-300, -1e-300, 5e-324, -5e-324] {
        let form = CurvatureForm {
            k_uu: -1.0,
            k_uv: tiny,
            k_vv: 1.0,
        };
        let angle = form.principal().angle_of_max_rad;
        assert!(
            angle > -FRAC_PI_2 && angle <= FRAC_PI_2,
            "{angle} for {tiny}"
        );
    }
}

/// Between ten to the −9 and to the 9.
fn lengths() -> impl Strategy<Value = f64> {
    (-9.0..9.0_f64).prop_map(|exponent| libm::pow(10.0_f64, exponent))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..Default::default() })]

    #[test]
    fn round_surfaces_of_any_size(radius in lengths(), u in -1.57..1.57_f64, v in -3.1..3.1_f64) {
        let signed = [
            (Shape::Sphere(Sphere::new(radius).unwrap()), 1.0, [1.0, 1.0]),
            (Shape::Dish(Dish::new(radius).unwrap()), 1.0, [-1.0, -1.0]),
            (Shape::Cylinder(Cylinder::new(radius, 0.3).unwrap()), radius, [0.0, 1.0]),
            (Shape::Plane(Plane), 1.0, [0.0, 0.0]),
        ];
        for (shape, unit_u, [k_uu, k_vv]) in signed {
            let here = shape.chart_geometry(Parameters::new(u * unit_u, v)).unwrap();
            let (_, form) = shape.curvature_along(&here.point, &here.frame.x).unwrap();
            for form in [here.curvature, form] {
                assert_relative_eq!(form.k_uu * radius, k_uu, epsilon = 1e-14);
                assert_relative_eq!(form.k_vv * radius, k_vv, epsilon = 1e-14);
                assert_relative_eq!(form.k_uv * radius, 0.0, epsilon = 1e-14);
            }
            let foot = shape.closest_point(&(here.point + here.frame.normal * radius * 0.5));
            assert_relative_eq!(foot.unwrap(), here.point, epsilon = 1e-14 * (radius + 2.0));
        }
    }

    #[test]
    fn tori_of_any_ratio(
        minor in lengths(),
        ratio in (0.001..12.0_f64).prop_map(|exponent| libm::pow(10.0_f64, exponent)),
        u in -3.1..3.1_f64,
        v in -3.1..3.1_f64,
    ) {
        let major = minor * ratio;
        let torus = Torus::new(major, minor).unwrap();
        let here = torus.chart_geometry(Parameters::new(u, v)).unwrap();
        let rho = major + minor * libm::sin(u);
        let across = libm::sin(u) / rho;
        assert_relative_eq!(here.curvature.k_uu, 1.0 / minor, max_relative = 1e-13);
        assert_relative_eq!(here.curvature.k_vv, across, max_relative = 1e-13);
        // A point is no finer than its coordinates, and the tube is thin.
        let blur = 1e-14 * ratio / (ratio - 1.0) + 1e-15 * ratio;
        let local = torus.level_set(&here.point).unwrap();
        let form = local.curvature(&here.frame.x, &here.frame.y);
        assert_relative_eq!(local.normal, here.frame.normal, epsilon = blur);
        assert_relative_eq!(form.k_uu * minor, 1.0, epsilon = blur);
        assert_relative_eq!(form.k_vv * minor, across * minor, epsilon = blur);
        let offset = here.frame.normal * (0.5 * minor.min(major - minor));
        let foot = torus.closest_point(&(here.point + offset)).unwrap();
        prop_assert!((foot - here.point).norm() < blur * minor);
    }

    #[test]
    fn ellipsoids_of_any_ratio(
        exponents in [-6.0..6.0_f64, -6.0..6.0, -6.0..6.0],
        u in -1.57..1.57_f64,
        v in -3.1..3.1_f64,
    ) {
        let semi_axes = exponents.map(|exponent| libm::pow(10.0_f64, exponent));
        let ellipsoid = Ellipsoid::new(semi_axes).unwrap();
        let here = ellipsoid.chart_geometry(Parameters::new(u, v)).unwrap();
        let frame = here.frame;
        assert_relative_eq!(frame.x.cross(&frame.y), frame.normal, epsilon = 1e-14);
        let local = ellipsoid.level_set(&here.point).unwrap();
        assert_relative_eq!(local.normal, frame.normal, epsilon = 1e-13, max_relative = 1e-13);

        // K = p⁴/(abc)², H = p³ (Σa² − |x|²)/(2 (abc)²) with p the distance of the tangent plane, and
        // a² − x² = a² (1 − x²/a²), of which the other two coordinates tell the bracket.
        let axes = Vector3::from(semi_axes);
        let unit = here.point.coords.component_div(&axes);
        let p = 1.0 / unit.component_div(&axes).norm();
        let shares = unit.component_mul(&unit);
        let others = Vector3::new(shares.y + shares.z, shares.z + shares.x, shares.x + shares.y);
        let rest = axes.component_mul(&axes).component_mul(&others);
        let product = axes.product();
        let mean = 0.5 * (p / product).powi(2) * p * rest.sum();
        let gaussian = (p * p / product).powi(2);
        for form in [here.curvature, local.curvature(&frame.x, &frame.y)] {
            assert_relative_eq!(form.mean_curvature(), mean, max_relative = 1e-12);
            // K is a difference of products of the size of H².
            let epsilon = 1e-12 * mean * mean;
            assert_relative_eq!(form.gaussian_curvature(), gaussian, epsilon = epsilon);
        }
        let difference = local.shape_operator() - here.shape_operator();
        prop_assert!(difference.norm() <= 1e-12 * mean, "{difference}");
    }
}
