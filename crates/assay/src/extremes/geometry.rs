//! Surfaces of every kind.

use palpate_geometry::surfaces::{Cylinder, Dish, Ellipsoid, Graph, Plane, Sphere, Torus};
use palpate_geometry::{Shape, formula::Formula};

/// One surface of every kind, about as large as `size`.
pub(in crate::extremes) fn shapes(size: f64) -> [Shape; 9] {
    let made = "sizes between 1e-100 and 1e100 make surfaces";
    let parameters = [("h".to_owned(), 0.2 * size), ("s".to_owned(), size)];
    let wavy = Formula::parse("h*sin(x/s)*cos(y/s)", &parameters.into()).expect("a formula");
    [
        Shape::Sphere(Sphere::new(size).expect(made)),
        Shape::Dish(Dish::new(size).expect(made)),
        Shape::Plane(Plane),
        Shape::Cylinder(Cylinder::new(size, 0.4).expect(made)),
        Shape::Ellipsoid(Ellipsoid::new([size, 0.8 * size, 0.5 * size]).expect(made)),
        Shape::Torus(Torus::new(size, 0.3 * size).expect(made)),
        Shape::Paraboloid(Graph::paraboloid(0.5 / size).expect(made)),
        Shape::Saddle(Graph::saddle(0.2 / size).expect(made)),
        Shape::HeightField(Graph::of_formula(wavy)),
    ]
}
