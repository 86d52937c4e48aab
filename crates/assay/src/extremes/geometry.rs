//! Surfaces, charts, closest points, curvature and formulas, at their extremes.

mod asked;
mod closest;
mod curvature;
mod formula;
mod made;
mod meridian;
mod places;
mod posed;

use nalgebra::{Point3, Vector3};
use palpate_geometry::surfaces::{Cylinder, Dish, Ellipsoid, Graph, Plane, Sphere, Torus};
use palpate_geometry::{Shape, formula::Formula};

use super::Case;
use super::precise::Precise;

pub(super) fn cases() -> Vec<Case> {
    let parts = [
        made::cases(),
        asked::cases(),
        places::cases(),
        posed::cases(),
        closest::cases(),
        curvature::cases(),
        meridian::cases(),
        formula::cases(),
    ];
    parts.into_iter().flatten().collect()
}

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

/// A vector of precise components.
type Place = [Precise; 3];

fn point([x, y, z]: &Place) -> Point3<f64> {
    Point3::new(x.to_f64(), y.to_f64(), z.to_f64())
}

/// The components of a vector with those that they should have.
fn against(found: &Vector3<f64>, truth: &Place) -> [(f64, f64); 3] {
    std::array::from_fn(|axis| (found[axis], truth[axis].to_f64()))
}
