//! Closest points: the foot is chosen, and the question lies on its normal.

use nalgebra::{Point3, Vector3};
use palpate_geometry::surfaces::{Cylinder, Dish, Ellipsoid, Graph, Sphere, Torus};
use palpate_geometry::{Shape, Surface, SurfaceError};
use palpate_verdict::{Answer, Precise, decades, rows};

const REFUSED: &str = "no-closest-point";

rows! {
    "geometry::Sphere::closest_point", "radius {size:e}, {distance:e} radii above" => above_sphere(size, distance),
        for size in sizes(), for distance in [1e-9, 1.0, 1e9];
    "geometry::Graph::closest_point", "c = {c:e}, {above:e} radii of curvature above" => above_paraboloid(size, above),
        for (size, c) in sizes().map(|size| (size, 0.5 / size)), for above in [-0.4, 1e-3, 10.0];
    "geometry::Ellipsoid::closest_point", "semi-axes 1, 1.5 and {size:e}, 1 above" => above_ellipsoid([1.0, 1.5, size]),
        for size in sizes();
    "geometry::Surface::closest_point", "{name} of size {size:e}: its centre or axis", REFUSED =>
        shape.closest_point(&place), for size in sizes(), for (name, shape, place) in centres(size);
}

fn sizes() -> impl Iterator<Item = f64> {
    decades(-9, 9, 3)
}

/// A vector of precise components.
type Place = [Precise; 3];

/// The components of a place with those that they should have.
fn against(found: &Point3<f64>, truth: &Place) -> [(f64, f64); 3] {
    [0, 1, 2].map(|axis| (found[axis], truth[axis].to_f64()))
}

fn norm(vector: &Place) -> Precise {
    let squares = vector.iter().map(Precise::squared);
    squares
        .fold(Precise::new(0.0), |sum, square| sum + square)
        .sqrt()
}

/// `R q/|q|` for a point q with coordinates that are doubles.
fn above_sphere(radius: f64, distance: f64) -> Result<Answer, SurfaceError> {
    let far = radius * (1.0 + distance);
    let asked = Point3::new(0.36 * far, -0.48 * far, 0.8 * far);
    let precise = [0, 1, 2].map(|axis| Precise::new(asked[axis]));
    let norm = norm(&precise);
    let truth = precise.map(|x| x / &norm * radius);
    let found = Sphere::new(radius).unwrap().closest_point(&asked)?;
    Ok(Answer::all_at_scale(against(&found, &truth), radius).within(1e-15))
}

/// The foot at r = 1.5 radii of curvature, where the normal is `(2cr, 1)/w`.
fn above_paraboloid(radius: f64, above: f64) -> Result<Answer, SurfaceError> {
    let c = 0.5 / radius;
    let [x, y] = [0.9 * radius, 1.2 * radius].map(Precise::new);
    let height = -(x.squared() + y.squared()) * c;
    let slope = [&x * c * 2.0, &y * c * 2.0, Precise::new(1.0)];
    let w = norm(&slope);
    let foot = [x, y, height];
    let distance = above * radius;
    let asked = [0, 1, 2].map(|axis| (&foot[axis] + &slope[axis] / &w * distance).to_f64());
    let asked = Point3::from(asked);
    let found = Graph::paraboloid(c).unwrap().closest_point(&asked)?;
    // Where the question lies is only known to the last place of its coordinates.
    let sharpest = 2.0 * c / w.to_f64();
    let condition = asked.coords.norm() / radius / (1.0 + sharpest * distance);
    let answer = Answer::all_at_scale(against(&found, &foot), radius).within(1e-14);
    Ok(answer.conditioned(condition))
}

/// The foot at `a_i w_i` with a unit vector w; the normal has the direction `w_i/a_i`.
fn above_ellipsoid(axes: [f64; 3]) -> Result<Answer, SurfaceError> {
    let unit = [0.36, 0.48, 0.8].map(Precise::new);
    let foot = [0, 1, 2].map(|axis| &unit[axis] * axes[axis]);
    let gradient = [0, 1, 2].map(|axis| &unit[axis] / axes[axis]);
    let norm = norm(&gradient);
    let asked = [0, 1, 2].map(|axis| (&foot[axis] + &gradient[axis] / &norm).to_f64());
    let ellipsoid = Ellipsoid::new(axes).unwrap();
    let found = ellipsoid.closest_point(&asked.into())?;
    let largest = axes.into_iter().fold(1.0, f64::max);
    Ok(Answer::all_at_scale(against(&found, &foot), largest).within(1e-14))
}

/// Surfaces about as large as `size`, each with a place that is as near to many of its points.
fn centres(size: f64) -> [(&'static str, Shape, Point3<f64>); 5] {
    let ellipsoid = Ellipsoid::new([size, 2.0 * size, 3.0 * size]).unwrap();
    let (sin, cos) = libm::sincos(0.4);
    let (centre, axis) = (Vector3::zeros(), Vector3::new(cos, sin, 0.0));
    [
        (Shape::Sphere(Sphere::new(size).unwrap()), centre),
        (Shape::Dish(Dish::new(size).unwrap()), centre),
        (Shape::Cylinder(Cylinder::new(size, 0.4).unwrap()), axis),
        (Shape::Ellipsoid(ellipsoid), centre),
        (
            Shape::Torus(Torus::new(size, 0.3 * size).unwrap()),
            Vector3::new(0.6, 0.8, 0.0),
        ),
    ]
    .map(|(shape, place)| (shape.name(), shape, (place * size).into()))
}
