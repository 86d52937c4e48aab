//! Compares meridians with the charts of their surfaces, and with finite differences.

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI};

use approx::{assert_abs_diff_eq, assert_relative_eq};
use nalgebra::{Point3, Vector3};
use palpate_geometry::{Ellipsoid, Formula, Graph, Meridian, Shape, Sphere, Surface, Torus};

const PARABOLOIDS: [f64; 4] = [5.0, 0.5, 0.01, -0.3];
const SPHEROIDS: [[f64; 2]; 4] = [[1.0, 2.0], [2.0, 0.5], [1.0, 1.0], [0.3, 30.0]];

/// The meridian of a surface in the plane y = 0, and its apex, which lies on the z axis.
fn from_apex(surface: &impl Surface) -> (Meridian, Point3<f64>) {
    let apex = surface.contact_at(0.0, 0.0).unwrap();
    (surface.meridian(&apex, &Vector3::x()).unwrap(), apex)
}

/// Compares the meridian with the chart, in which the meridian is the line along u in the plane y = 0.
fn follows_the_chart(surface: &impl Surface, t: f64) {
    let (meridian, apex) = from_apex(surface);
    let (found, slope) = (meridian.at(t), meridian.slope(t));
    let expected = apex + Vector3::new(found.r, 0.0, found.height);
    let there = surface
        .chart_geometry(surface.parameters(&expected))
        .unwrap();
    assert_relative_eq!(there.point, expected, epsilon = 1e-14, max_relative = 1e-14);
    let [sin, cos] = found.normal;
    assert_relative_eq!(there.normal, Vector3::new(sin, 0.0, cos), epsilon = 1e-13);
    let (sine, cosine) = libm::sincos(slope.slope_rad);
    assert_abs_diff_eq!(sin, sine, epsilon = 1e-15);
    assert_abs_diff_eq!(cos, cosine, epsilon = 1e-15);
    assert_relative_eq!(
        there.metric.m11,
        slope.arc_per_parameter,
        max_relative = 1e-14
    );
    let curvature = slope.slope_per_parameter / slope.arc_per_parameter;
    assert_relative_eq!(there.curvature.k_uu, curvature, max_relative = 1e-12);
}

#[test]
fn paraboloids_and_spheroids_follow_their_charts() {
    for c in PARABOLOIDS {
        for t in [0.0, 1e-6, 0.1, 1.0, 7.0] {
            follows_the_chart(&Graph::paraboloid(c).unwrap(), t);
        }
    }
    for [a, c] in SPHEROIDS {
        // The poles of the chart, at the parameters t = π/2 and t = 3π/2, are left out.
        for t in [0.0, 1e-6, 0.1, 1.0, 1.5, 2.0, 3.0, PI, 4.0, 6.0] {
            follows_the_chart(&Ellipsoid::new([a, a, c]).unwrap(), t);
        }
    }
}

#[test]
fn formulas_of_degree_two_have_sections_along_their_axes() {
    let section = |text: &str, [x, y]: [f64; 2], direction: [f64; 2]| {
        let surface = Graph::from(Formula::parse(text, &BTreeMap::new()).unwrap());
        let apex = surface.contact_at(x, y).unwrap();
        let [x, y] = direction;
        surface.meridian(&apex, &Vector3::new(x, y, 0.0))
    };
    let parabola = |c| Some(Meridian::Paraboloid { c });
    for (text, at, along_x, along_y) in [
        (
            "-0.5*x^2 - y*y/4 + 3",
            [0.0, 0.0],
            parabola(0.5),
            parabola(0.25),
        ),
        ("-(x^2 + y^2)/4", [0.0, 0.0], parabola(0.25), parabola(0.25)),
        (
            "(x - 1)^2 - 2*abs(y)^2",
            [1.0, 0.0],
            parabola(-1.0),
            parabola(2.0),
        ),
        ("(x - 1)^2 - 2*y^2", [0.5, 0.0], None, None),
        ("x^2 + x*y", [0.0, 0.0], None, None),
    ] {
        assert_eq!(section(text, at, [1.0, 0.0]), along_x, "{text}");
        assert_eq!(section(text, at, [0.0, 1.0]), along_y, "{text}");
        let is_revolved = along_x.is_some() && along_x == along_y;
        assert_eq!(
            section(text, at, [0.6, 0.8]).is_some(),
            is_revolved,
            "{text}"
        );
    }
    let text = "-0.5*x^2 - y*y/4";
    let formula = Formula::parse(text, &BTreeMap::new()).unwrap();
    for t in [0.0, 1e-6, 0.1, 1.0, 7.0] {
        follows_the_chart(&Graph::from(formula.clone()), t);
    }
}

#[test]
fn symmetric_formulas_have_sections_at_the_origin() {
    for (text, is_even, is_revolved) in [
        ("0.3*exp(-x^2 - y^2)", true, true),
        ("2^(1 - (y*y + x*x))/3 + cosh(x^2 + y^2)", true, true),
        ("0.3*exp(-x^2 - 2*y^2)", true, false),
        ("x^4 - cos(y)", true, false),
        ("sin(x)*tan(x) - abs(y)^3", true, false),
        ("sin(x*y)^2 + x*x^3", true, false),
        ("hypot(x, sinh(y) + 1e-9) - 1", false, false),
        ("x^3 - y^2", false, false),
        ("cos(x) + sin(y)", false, false),
        ("sin(x)*sin(y)", false, false),
        ("cos(x)^2 + abs(y)^2.5 + atan2(x^2, 1 + y^2)", true, false),
        ("(x^2 + y^2 + 1e-9*x)^2", false, false),
        ("exp(x - 0.5*x^2)*cos(y)", false, false),
    ] {
        let surface = Graph::from(Formula::parse(text, &BTreeMap::new()).unwrap());
        let section = |x: f64, direction: [f64; 2]| {
            let [dx, dy] = direction;
            surface.meridian(&Point3::new(x, 0.0, 0.0), &Vector3::new(dx, dy, 0.0))
        };
        let found = [[1.0, 0.0], [0.0, 1.0], [0.6, 0.8]].map(|along| section(0.0, along).is_some());
        assert_eq!(found, [is_even, is_even, is_revolved], "{text}");
        assert_eq!(section(0.1, [1.0, 0.0]), None, "{text}");
        for t in [1e-6, 0.1, 1.0] {
            if is_even {
                follows_the_chart(&surface, t);
            }
        }
    }
}

#[test]
fn derivatives_are_those_of_the_meridian() {
    let spheroids = SPHEROIDS.map(|[a, c]| Meridian::Spheroid { a, c });
    for meridian in PARABOLOIDS
        .map(|c| Meridian::Paraboloid { c })
        .into_iter()
        .chain(spheroids)
    {
        for t in [0.01, 0.4, 1.0, FRAC_PI_2, 2.2, PI, 4.5, 9.0] {
            let h = 1e-5;
            let [before, here, after] = [t - h, t, t + h].map(|t| meridian.slope(t));
            let slope = (after.slope_rad - before.slope_rad) / (2.0 * h);
            assert_relative_eq!(
                slope,
                here.slope_per_parameter,
                epsilon = 1e-8,
                max_relative = 1e-5
            );
            let [before, after] = [t - h, t + h].map(|t| meridian.at(t));
            let arc = libm::hypot(after.r - before.r, after.height - before.height) / (2.0 * h);
            assert_relative_eq!(arc, here.arc_per_parameter, max_relative = 1e-5);
        }
    }
}

#[test]
fn the_slope_of_a_spheroid_turns_on_through_the_equator() {
    for [a, c] in SPHEROIDS.into_iter().chain([[1.0, 1e-9], [1e-9, 1.0]]) {
        let meridian = Meridian::Spheroid { a, c };
        // The slope angle equals the parameter t at every quarter turn. Between two quarter turns, the slope angle
        // differs from t by less than a quarter turn.
        for step in 0..4000 {
            let t = f64::from(step) * 0.01;
            let slope = meridian.slope(t).slope_rad;
            assert!((slope - t).abs() < FRAC_PI_2, "{slope} at {t}");
        }
        for quarter in 0..24 {
            let t = f64::from(quarter) * FRAC_PI_2;
            for t in [t.next_down(), t, t.next_up()] {
                let unresolved = 4.0 * f64::EPSILON * t.max(1.0) * (a / c).max(c / a);
                let slope = meridian.slope(t).slope_rad;
                let tolerance = unresolved.min(FRAC_PI_2) + 1e-14;
                assert_abs_diff_eq!(slope, t, epsilon = tolerance);
            }
        }
    }
}

#[test]
fn only_an_apex_has_a_meridian() {
    let aslant = Vector3::new(0.6, 0.8, 0.0);
    let (top, origin) = (Point3::new(0.0, 0.0, 2.0), Point3::origin());
    let ellipsoid = |a, b| Shape::Ellipsoid(Ellipsoid::new([a, b, 2.0]).unwrap());
    let hill = Shape::Paraboloid(Graph::paraboloid(0.5).unwrap());
    let saddle = Shape::Saddle(Graph::saddle(0.5).unwrap());
    let sphere = Shape::Sphere(Sphere::new(2.0).unwrap());
    let torus = Shape::Torus(Torus::new(2.0, 1.0).unwrap());
    let beside = Point3::new(0.1, 0.0, -0.005);
    let spheroid = |a| Some(Meridian::Spheroid { a, c: 2.0 });
    for (surface, place, direction, expected) in [
        (ellipsoid(1.0, 1.0), top, aslant, spheroid(1.0)),
        (
            ellipsoid(1.0, 1.0),
            Point3::new(1.0, 0.0, 0.0),
            aslant,
            None,
        ),
        (ellipsoid(1.0, 1.0), -top, aslant, None),
        (ellipsoid(1.0, 1.5), top, aslant, None),
        (ellipsoid(1.0, 1.5), top, -Vector3::x(), spheroid(1.0)),
        (ellipsoid(1.0, 1.5), top, Vector3::y(), spheroid(1.5)),
        (
            hill.clone(),
            origin,
            aslant,
            Some(Meridian::Paraboloid { c: 0.5 }),
        ),
        (hill, beside, aslant, None),
        (saddle, origin, aslant, None),
        (sphere, top, aslant, None),
        (torus, top, aslant, None),
    ] {
        let found = surface.meridian(&place, &direction);
        assert_eq!(found, expected, "{surface:?} at {place}");
    }
}
