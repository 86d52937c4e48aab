//! Tests all methods of surfaces. Near the default contact of a surface, they succeed. For arguments with any bit
//! pattern, they return finite numbers or an error, and returned points lie on the surface.

use nalgebra::{Point3, Vector3};
use palpate_geometry::{
    CurvatureForm, Cylinder, Dish, Ellipsoid, Formula, Graph, InvalidThresholds, Meridian,
    Parameters, Plane, Shape, ShapeThresholds, Sphere, Surface, Torus,
};
use proptest::prelude::*;

/// Numbers at the limits of doubles, and numbers whose squares overflow or underflow.
const EXTREMES: [f64; 12] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    -1e155,
    1e149,
    -1e16,
    0.0,
    -0.0,
    1e-150,
    -1e-165,
    5e-324,
];

/// An extreme number, any double, or a number of either sign with a magnitude between 1e-12 and 1e12.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        proptest::sample::select(&EXTREMES[..]),
        any::<u64>().prop_map(f64::from_bits),
        (-12.0..12.0_f64, any::<bool>()).prop_map(|(exponent, negative)| {
            let size = libm::pow(10.0_f64, exponent);
            if negative { -size } else { size }
        }),
    ]
}

fn surfaces(a: f64, b: f64, c: f64) -> Vec<Shape> {
    let parameters = [("a".to_owned(), a), ("b".to_owned(), b)];
    let wavy = Formula::parse("a*sin(b*x)*exp(y)", &parameters.into());
    [
        Sphere::new(a).map(Shape::Sphere).ok(),
        Dish::new(a).map(Shape::Dish).ok(),
        Some(Shape::Plane(Plane)),
        Cylinder::new(a, b).map(Shape::Cylinder).ok(),
        Ellipsoid::new([a, b, c]).map(Shape::Ellipsoid).ok(),
        Torus::new(a, b).map(Shape::Torus).ok(),
        Graph::paraboloid(a).map(Shape::Paraboloid).ok(),
        Graph::saddle(a).map(Shape::Saddle).ok(),
        wavy.map(|wavy| Shape::HeightField(Graph::from(wavy))).ok(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn is_finite<'a>(numbers: impl IntoIterator<Item = &'a f64>) -> bool {
    numbers.into_iter().all(|number| number.is_finite())
}

/// Calls six methods of a surface at a position. Returns whether each call succeeds, and checks that the results are
/// finite.
fn answers(surface: &impl Surface, x: f64, y: f64, z: f64) -> Result<[bool; 6], TestCaseError> {
    let (at, place) = (Parameters::new(x, y), Point3::new(x, y, z));
    let is_unit = |vector: &Vector3<f64>| (vector.norm() - 1.0).abs() < 1e-9;
    let chart = surface.chart(at);
    if let Ok(jet) = &chart {
        let parts = [jet.point.coords, jet.du, jet.dv, jet.duu, jet.duv, jet.dvv];
        prop_assert!(is_finite(parts.iter().flatten()), "{jet:?}");
    }
    let geometry = surface.chart_geometry(at);
    if let Ok(found) = &geometry {
        let form = found.curvature;
        prop_assert!(is_finite(&[form.k_uu, form.k_uv, form.k_vv]), "{found:?}");
        let matrices = found.metric.iter().chain(found.torsion.iter());
        prop_assert!(is_finite(matrices), "{found:?}");
        let frame = [found.x_axis, found.y_axis, found.normal];
        prop_assert!(frame.iter().all(is_unit), "{found:?}");
    }
    let level_set = surface.level_set(&place);
    if let Ok(found) = &level_set {
        let numbers = found.normal.iter().chain(found.second_form.iter());
        prop_assert!(is_finite(numbers), "{found:?}");
        prop_assert!(is_unit(&found.normal), "{found:?}");
    }
    let along = surface.curvature_along(&place, &Vector3::x());
    if let Ok((normal, form)) = &along {
        prop_assert!(is_finite(&[form.k_uu, form.k_uv, form.k_vv]), "{form:?}");
        prop_assert!(is_finite(normal.iter()), "{normal:?}");
    }
    let [closest, contact] = [surface.closest_point(&place), surface.contact_at(x, y)];
    for found in [&closest, &contact].into_iter().flatten() {
        prop_assert!(is_finite(found.iter()), "{found:?}");
    }
    let is_place = is_finite(&[x, y]);
    prop_assert!(is_place || chart.is_err() && contact.is_err() && closest.is_err());
    // The following calls may return anything, but must not panic.
    let _ = (
        surface.parameters(&place),
        surface.meridian(&place, &Vector3::x()),
    );
    Ok([
        chart.is_ok(),
        geometry.is_ok(),
        level_set.is_ok(),
        along.is_ok(),
        closest.is_ok(),
        contact.is_ok(),
    ])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..Default::default() })]

    #[test]
    fn surfaces_of_any_size_answer_near_their_default_contact(
        power in -9.0..9.0_f64,
        (x, y, above) in (0.01..0.2_f64, 0.01..0.2_f64, 0.01..0.1_f64),
    ) {
        let size = libm::pow(10.0, power);
        let shapes = surfaces(size, 0.4 * size, 0.7 * size);
        let graphs = [0.3 / size, -0.3 / size].map(|bend| Graph::paraboloid(bend).map(Shape::Paraboloid));
        let saddle = Graph::saddle(0.3 / size).map(Shape::Saddle);
        let height_field = Formula::parse("h*sin(x/s)*cos(y/s)", &[("h".to_owned(), 0.2 * size), ("s".to_owned(), size)].into());
        let height_field = height_field.map(|formula| Shape::HeightField(Graph::from(formula))).unwrap();
        let is_round = |shape: &Shape| !["paraboloid", "saddle", "height-field"].contains(&shape.name());
        let shapes: Vec<Shape> = (shapes.into_iter().filter(is_round))
            .chain(graphs.into_iter().chain([saddle]).map(Result::unwrap))
            .chain([height_field])
            .collect();
        prop_assert_eq!(shapes.len(), 10);
        for shape in shapes {
            let (x_0, y_0) = shape.default_contact();
            let foot = shape.contact_at(x_0 + x * size, y_0 + y * size).unwrap();
            let at = shape.parameters(&foot);
            prop_assert!(answers(&shape, at.u, at.v, 0.0)?[..2] == [true; 2], "{shape:?} at {at:?}");
            let place = foot + shape.level_set(&foot).unwrap().normal * (above * size);
            let given = answers(&shape, place.x, place.y, foot.z)?;
            prop_assert!(given[4..] == [true; 2], "{shape:?} at {place}");
            let given = answers(&shape, foot.x, foot.y, foot.z)?;
            prop_assert!(given[2..] == [true; 4], "{shape:?} at {foot}: {given:?}");
        }
    }

    #[test]
    fn surfaces_answer_in_numbers_or_in_errors(
        made in [number(), number(), number()],
        asked in [number(), number(), number()],
    ) {
        let [x, y, z] = asked;
        for shape in surfaces(made[0], made[1], made[2]) {
            let _ = answers(&shape, x, y, z)?;
        }
    }

    #[test]
    fn a_closest_point_lies_on_the_surface(
        size in (-9.0..9.0_f64).prop_map(|exponent| libm::pow(10.0_f64, exponent)),
        direction in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0],
        distance in (-6.0..1.0_f64).prop_map(|exponent| libm::pow(10.0_f64, exponent)),
    ) {
        for shape in surfaces(size, 0.4 * size, 0.7 * size) {
            let place = Point3::from(Vector3::from(direction) * (distance * size));
            if shape.name() == "height-field" {
                continue;
            }
            let foot = shape.closest_point(&place);
            // Inside of an ellipsoid, and beyond the centres of curvature of a graph, two points of the surface may be
            // equally close. Then no single point is closest, and the call returns an error.
            let may_have_none = ["ellipsoid", "paraboloid", "saddle"].contains(&shape.name());
            prop_assert!(foot.is_ok() || may_have_none, "{shape:?} at {place}: {foot:?}");
            if let Ok(foot) = foot {
                let on_surface = shape.chart(shape.parameters(&foot)).unwrap().point;
                let off = (foot - on_surface).norm() / (size + foot.coords.norm());
                prop_assert!(off < 1e-14, "{shape:?} at {place}: {foot}, off by {off:e}");
                let again = shape.closest_point(&foot).unwrap();
                let off = (foot - again).norm() / (size + foot.coords.norm());
                prop_assert!(off < 1e-14, "{shape:?} at {place}: {foot}, then {again}");
            }
        }
    }

    #[test]
    fn curvature_of_any_numbers(a in number(), b in number(), c in number(), angle in number()) {
        let form = CurvatureForm { k_uu: a, k_uv: b, k_vv: c };
        if let Some(index) = form.principal().shape_index() {
            prop_assert!(index.abs() <= 1.0 + 1e-15, "{index}");
        }
        let are_thresholds = [a, b].iter().all(|size| *size >= 0.0 && size.is_finite());
        match ShapeThresholds::new(a, b) {
            Ok(thresholds) => {
                prop_assert!(are_thresholds && b * b * (1.0 - 1e-15) <= a);
                thresholds.classify(c, angle);
            }
            Err(InvalidThresholds::OutOfRange { .. }) => prop_assert!(!are_thresholds),
            Err(InvalidThresholds::ImpossibleClass { .. }) => prop_assert!(are_thresholds && b * b > a),
        }
        let tame = |value: f64| value.abs() < 1e150;
        if tame(a) && tame(b) && tame(c) {
            let principal = form.principal();
            let numbers = [principal.k_min, principal.k_max, principal.angle_of_max_rad];
            prop_assert!(is_finite(&numbers), "{principal:?}");
            prop_assert!(principal.k_min <= principal.k_max);
            prop_assert!(is_finite(&[form.gaussian_curvature(), form.mean_curvature()]));
        }
    }

    #[test]
    fn meridians_of_any_size(
        c in -300.0..150.0_f64,
        t in -300.0..1.0_f64,
        aspect in -12.0..12.0_f64,
        phi in -1e6..1e6_f64,
    ) {
        let [c, t, aspect] = [c, t, aspect].map(|exponent| libm::pow(10.0_f64, exponent));
        let paraboloid = Meridian::Paraboloid { c };
        let spheroid = Meridian::Spheroid { a: 1.0, c: aspect };
        for (meridian, t) in [(paraboloid, t), (spheroid, phi)] {
            let (point, slope) = (meridian.at(t), meridian.slope(t));
            let [outward, along] = point.normal;
            prop_assert!(is_finite(&[point.r, point.height, outward, along]), "{point:?}");
            let numbers = [slope.slope_rad, slope.arc_per_parameter, slope.slope_per_parameter];
            prop_assert!(is_finite(&numbers), "{slope:?}");
        }
    }
}

#[test]
fn a_point_on_a_needle_is_its_own_foot() {
    // This paraboloid is so thin that the rounding error of its height exceeds its width.
    let needle = Graph::paraboloid(1.1e8).unwrap();
    let place = needle.contact_at(1.24, -0.5).unwrap();
    assert_eq!(needle.closest_point(&place).unwrap(), place);
}
