//! Objects and rolls that several tests use.

use std::collections::BTreeMap;

use palpate_geometry::{Cylinder, Dish, Ellipsoid, Formula, Graph, Plane, Shape, Sphere, Torus};
use palpate_rolling::{Chart, Contact, Model, Motion, Roller, Rolls};

pub(crate) fn sphere(radius: f64) -> Shape {
    Shape::Sphere(Sphere::new(radius).unwrap())
}

pub(crate) fn dish(radius: f64) -> Shape {
    Shape::Dish(Dish::new(radius).unwrap())
}

pub(crate) fn plane() -> Shape {
    Shape::Plane(Plane)
}

pub(crate) fn cylinder(radius: f64, direction_deg: f64) -> Shape {
    Shape::Cylinder(Cylinder::new(radius, direction_deg.to_radians()).unwrap())
}

pub(crate) fn ellipsoid(a: f64, b: f64, c: f64) -> Shape {
    Shape::Ellipsoid(Ellipsoid::new([a, b, c]).unwrap())
}

pub(crate) fn torus(major: f64, minor: f64) -> Shape {
    Shape::Torus(Torus::new(major, minor).unwrap())
}

pub(crate) fn paraboloid(c: f64) -> Shape {
    Shape::Paraboloid(Graph::paraboloid(c).unwrap())
}

pub(crate) fn saddle(a: f64) -> Shape {
    Shape::Saddle(Graph::saddle(a).unwrap())
}

pub(crate) fn height_field(formula: &str, parameters: &[(&str, f64)]) -> Shape {
    let parameters: BTreeMap<String, f64> = parameters
        .iter()
        .map(|&(name, value)| (name.to_owned(), value))
        .collect();
    let formula = Formula::parse(formula, &parameters).unwrap();
    Shape::HeightField(Graph::from(formula))
}

pub(crate) const DOP853: Model = dop853(1e-13, Chart::Free);

pub(crate) const fn dop853(tolerance: f64, chart: Chart) -> Model {
    Model::Dop853 { tolerance, chart }
}

pub(crate) const fn auto(tolerance: f64) -> Model {
    let chart = Chart::Free;
    Model::Auto { tolerance, chart }
}

pub(crate) fn roller(
    radius: f64,
    object: &Shape,
    start: (f64, f64),
    model: Model,
    motion: Motion,
) -> Roller {
    let rolls = vec![vec![motion]];
    let probe = Sphere::new(radius).unwrap();
    Roller::new(probe, object.clone(), start, model, Rolls::exact(&rolls)).unwrap()
}

pub(crate) fn roll(
    radius: f64,
    object: &Shape,
    start: (f64, f64),
    model: Model,
    motion: Motion,
) -> Contact {
    roller(radius, object, start, model, motion)
        .roll(&[motion])
        .unwrap()
}

pub(crate) fn difference(a: &Contact, b: &Contact, radius: f64) -> f64 {
    [
        (a.on_object - b.on_object).norm(),
        (a.on_probe(radius) - b.on_probe(radius)).norm(),
        (a.normal - b.normal).norm(),
        (a.object_from_probe().matrix() - b.object_from_probe().matrix()).norm(),
        (a.arc_length - b.arc_length).abs(),
    ]
    .into_iter()
    .fold(0.0, f64::max)
}
