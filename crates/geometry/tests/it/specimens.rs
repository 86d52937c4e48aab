//! One or more surfaces of each kind, with the data that the tests of the mathematical laws need.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use nalgebra::{Point3, Vector3};
use palpate_geometry::{
    Cylinder, Dish, Ellipsoid, Formula, Graph, Parameters, Plane, Shape, Sphere, Surface, Torus,
};

pub(crate) type Solid = Box<dyn Fn(&Point3<f64>) -> bool>;

pub(crate) struct Specimen {
    pub(crate) name: String,
    pub(crate) shape: Shape,
    /// Chart parameters of test points, which are not close to the poles of the chart.
    pub(crate) at: Vec<Parameters>,
    /// Scale of each chart parameter: 1 for an angle, a typical length of the surface for a length. The step sizes of
    /// finite differences are multiples of this scale.
    pub(crate) unit: [f64; 2],
    /// A length of the same order of magnitude as the surface.
    pub(crate) size: f64,
    /// Distance from the surface within which every point has exactly one closest point.
    pub(crate) reach: f64,
    /// Whether a point is inside of the solid. The function uses the definition of the solid, not the code of the
    /// surface.
    pub(crate) solid: Solid,
}

/// Chart parameters on a grid of 9 by 9 points that avoids round numbers.
fn grid([u0, u1]: [f64; 2], [v0, v1]: [f64; 2]) -> Vec<Parameters> {
    let along = |from: f64, to: f64, i: i32| from + (to - from) * (f64::from(i) + 0.43) / 9.0;
    let pairs = (0..9).flat_map(|i| (0..9).map(move |j| (i, j)));
    pairs
        .map(|(i, j)| Parameters::new(along(u0, u1, i), along(v0, v1, j)))
        .collect()
}

pub(crate) fn sphere(radius: f64) -> Specimen {
    Specimen {
        name: format!("sphere {radius}"),
        shape: Shape::Sphere(Sphere::new(radius).unwrap()),
        at: grid([-1.5, 1.5], [-PI, PI]),
        unit: [1.0, 1.0],
        size: radius,
        reach: radius,
        solid: Box::new(move |p| p.coords.norm() < radius),
    }
}

pub(crate) fn dish(radius: f64) -> Specimen {
    Specimen {
        name: format!("dish {radius}"),
        shape: Shape::Dish(Dish::new(radius).unwrap()),
        solid: Box::new(move |p| p.coords.norm() > radius),
        ..sphere(radius)
    }
}

pub(crate) fn plane() -> Specimen {
    Specimen {
        name: "plane".into(),
        shape: Shape::Plane(Plane),
        at: grid([-2.0, 2.0], [-3.0, 3.0]),
        unit: [1.0, 1.0],
        size: 1.0,
        reach: 1e3,
        solid: Box::new(|p| p.z < 0.0),
    }
}

pub(crate) fn cylinder(radius: f64, direction: f64) -> Specimen {
    let axis = Vector3::new(libm::cos(direction), libm::sin(direction), 0.0);
    Specimen {
        name: format!("cylinder {radius} at {direction} rad"),
        shape: Shape::Cylinder(Cylinder::new(radius, direction).unwrap()),
        at: grid([-2.0 * radius, 3.0 * radius], [-PI, PI]),
        unit: [radius, 1.0],
        size: radius,
        reach: radius,
        solid: Box::new(move |p| p.coords.cross(&axis).norm() < radius),
    }
}

pub(crate) fn ellipsoid(semi_axes: [f64; 3]) -> Specimen {
    let [a, b, c] = semi_axes;
    let (smallest, largest) = (a.min(b).min(c), a.max(b).max(c));
    Specimen {
        name: format!("ellipsoid {semi_axes:?}"),
        shape: Shape::Ellipsoid(Ellipsoid::new(semi_axes).unwrap()),
        at: grid([-1.5, 1.5], [-PI, PI]),
        unit: [1.0, 1.0],
        size: largest,
        reach: smallest * smallest / largest,
        solid: Box::new(move |p| (p.x / a).powi(2) + (p.y / b).powi(2) + (p.z / c).powi(2) < 1.0),
    }
}

pub(crate) fn torus(major: f64, minor: f64) -> Specimen {
    Specimen {
        name: format!("torus {major}, {minor}"),
        shape: Shape::Torus(Torus::new(major, minor).unwrap()),
        at: grid([-PI, PI], [-PI, PI]),
        unit: [1.0, 1.0],
        size: major,
        reach: minor.min(major - minor),
        solid: Box::new(move |p| libm::hypot(libm::hypot(p.x, p.y) - major, p.z) < minor),
    }
}

pub(crate) fn paraboloid(c: f64) -> Specimen {
    let radius = 0.5 / c.abs();
    let shape = Shape::Paraboloid(Graph::paraboloid(c).unwrap());
    graph(format!("paraboloid {c}"), shape, radius, move |x, y| {
        -c * (x * x + y * y)
    })
}

pub(crate) fn saddle(a: f64) -> Specimen {
    let radius = 0.5 / a.abs();
    let shape = Shape::Saddle(Graph::saddle(a).unwrap());
    graph(format!("saddle {a}"), shape, radius, move |x, y| {
        a * (x * x - y * y)
    })
}

pub(crate) fn height_field(
    formula: &str,
    radius: f64,
    height: impl Fn(f64, f64) -> f64 + 'static,
) -> Specimen {
    let parsed = Formula::parse(formula, &BTreeMap::new()).unwrap();
    let shape = Shape::HeightField(Graph::from(parsed));
    graph(format!("height field {formula}"), shape, radius, height)
}

fn graph(
    name: String,
    shape: Shape,
    radius: f64,
    height: impl Fn(f64, f64) -> f64 + 'static,
) -> Specimen {
    Specimen {
        name,
        shape,
        at: grid([-1.3 * radius, 1.1 * radius], [-1.2 * radius, 1.4 * radius]),
        unit: [radius, radius],
        size: radius,
        reach: radius,
        solid: Box::new(move |p| p.z < height(p.x, p.y)),
    }
}

pub(crate) fn all() -> Vec<Specimen> {
    vec![
        sphere(1.0),
        dish(2.5),
        plane(),
        cylinder(0.3, 0.7),
        cylinder(40.0, -2.0),
        ellipsoid([3.0, 2.0, 1.0]),
        ellipsoid([0.7, 2.0, 1.3]),
        ellipsoid([1.0, 1.0, 2.0]),
        ellipsoid([0.6, 1.2, 1.2]),
        torus(2.0, 0.5),
        torus(1.0, 0.9),
        paraboloid(0.5),
        paraboloid(-0.2),
        saddle(0.1),
        saddle(-2.0),
        height_field("0.15*sin(0.7*x)*cos(0.7*y)", 3.0, |x, y| {
            0.15 * libm::sin(0.7 * x) * libm::cos(0.7 * y)
        }),
        height_field("sqrt(25 - x^2 - y^2) - 5", 2.0, |x, y| {
            (25.0 - x * x - y * y).sqrt() - 5.0
        }),
        height_field("0.1*x^3 - 0.2*x*y + atan2(y, x + 9)", 0.7, |x, y| {
            0.1 * x * x * x - 0.2 * x * y + libm::atan2(y, x + 9.0)
        }),
    ]
}

pub(crate) fn point(surface: &impl Surface, at: Parameters) -> Point3<f64> {
    surface.chart(at).unwrap().point
}
