//! Tests which shapes and positions are rejected, and the names of the errors.

use palpate_statistics::BadSetting;
use std::collections::BTreeMap;

use nalgebra::{Point3, Vector3};
use palpate_geometry::{
    Cylinder, Dish, Ellipsoid, Formula, Graph, Parameters, Shape, Sphere, Surface, SurfaceError,
    Torus,
};

#[test]
fn constructors_refuse_what_makes_no_surface() {
    fn refuses<T: std::fmt::Debug>(made: Result<T, BadSetting>, parameter: &str, value: f64) {
        let refused = made.unwrap_err();
        assert_eq!(refused.setting, parameter);
        assert!(refused.value == value || value.is_nan() && refused.value.is_nan());
    }
    for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0, 1e-200, 1e200] {
        refuses(Sphere::new(bad), "radius", bad);
        refuses(Dish::new(bad), "radius", bad);
        refuses(Cylinder::new(bad, 0.0), "radius", bad);
        refuses(Torus::new(bad, 1.0), "major_radius", bad);
        refuses(Torus::new(1.0, bad), "minor_radius", bad);
        refuses(Ellipsoid::new([bad, 1.0, 1.0]), "semi_axes", bad);
        refuses(Ellipsoid::new([1.0, bad, 1.0]), "semi_axes", bad);
        refuses(Ellipsoid::new([1.0, 1.0, bad]), "semi_axes", bad);
    }
    for bad in [f64::NAN, f64::NEG_INFINITY] {
        refuses(Cylinder::new(1.0, bad), "direction", bad);
        refuses(Graph::paraboloid(bad), "c", bad);
        refuses(Graph::saddle(bad), "a", bad);
    }
    refuses(Torus::new(1.0, 1.0), "minor_radius", 1.0);
}

#[test]
fn places_that_are_no_numbers_have_their_errors() {
    let (chart, domain, closest) = ("chart-singular", "off-domain", "no-closest-point");
    for (shape, expected) in [
        (
            Shape::Sphere(Sphere::new(1.0).unwrap()),
            [chart, chart, domain, domain, closest, domain],
        ),
        (
            Shape::Paraboloid(Graph::paraboloid(0.5).unwrap()),
            [domain; 6],
        ),
    ] {
        for bad in [f64::NAN, f64::INFINITY] {
            let (at, place) = (Parameters::new(bad, bad), Point3::new(bad, bad, bad));
            let found = [
                shape.chart(at).map(drop),
                shape.chart_geometry(at).map(drop),
                shape.level_set(&place).map(drop),
                shape.curvature_along(&place, &Vector3::x()).map(drop),
                shape.closest_point(&place).map(drop),
                shape.contact_at(bad, bad).map(drop),
            ]
            .map(|answer| <&str>::from(answer.unwrap_err()));
            assert_eq!(found, expected, "{shape:?} at {bad}");
        }
    }
}

#[test]
fn places_without_a_normal_are_off_domain() {
    let off_domain = |surface: &dyn Fn(&Point3<f64>) -> Option<SurfaceError>, z| {
        let found = surface(&Point3::new(0.0, 0.0, z));
        assert_eq!(found, Some(SurfaceError::OffDomain { x: 0.0, y: 0.0 }));
    };
    let ellipsoid = Ellipsoid::new([1.0, 2.0, 3.0]).unwrap();
    off_domain(&|place| ellipsoid.level_set(place).err(), 0.0);
    let torus = Torus::new(1.0, 0.3).unwrap();
    off_domain(&|place| torus.level_set(place).err(), 0.1);
    let no_tangent = Vector3::repeat(f64::NAN);
    off_domain(
        &|place| ellipsoid.curvature_along(place, &no_tangent).err(),
        3.0,
    );
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
        let graph = Graph::from(formula);
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
        ("sqrt(1 - x^2 - y^2)", 1.0, 0.0),
        ("1/(x*y)", 0.0, 2.0),
        ("abs(x)", 0.0, 2.0),
        ("exp(x)", 800.0, 0.0),
        ("x + y", f64::NAN, 0.0),
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
