//! Closest points: the foot is chosen, and the question lies on its normal.

use nalgebra::{Point3, Vector3};
use palpate_geometry::surfaces::{Cylinder, Dish, Ellipsoid, Graph, Sphere, Torus};
use palpate_geometry::{Shape, Surface, SurfaceError};

use super::super::precise::Precise;
use super::super::{Answer, Case};
use super::{Place, against, point};

const MADE: &str = "sizes between 1e-100 and 1e100 make surfaces";

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for exponent in [-9, -6, -3, 0, 3, 6, 9] {
        let size = 10f64.powi(exponent);
        for distance in [1e-9, 1.0, 1e9] {
            let input = format!("radius {size:e}, {distance:e} radii above");
            cases.push(Case::value(
                "geometry::Sphere::closest_point",
                input,
                move || above_sphere(size, distance),
            ));
        }
        for above in [-0.4, 1e-3, 10.0] {
            let input = format!("c = {:e}, {above:e} radii of curvature above", 0.5 / size);
            cases.push(Case::value(
                "geometry::Graph::closest_point",
                input,
                move || above_paraboloid(size, above),
            ));
        }
        let input = format!("semi-axes 1, 1.5 and {size:e}, 1 above");
        cases.push(Case::value(
            "geometry::Ellipsoid::closest_point",
            input,
            move || above_ellipsoid([1.0, 1.5, size]),
        ));
        cases.push(Case::refusal(
            "geometry::Surface::closest_point",
            format!("size {size:e}: centres and axes"),
            move || nowhere(size),
        ));
    }
    cases
}

/// `R q/|q|` for a point q with coordinates that are doubles.
fn above_sphere(radius: f64, distance: f64) -> Result<Answer, SurfaceError> {
    let far = radius * (1.0 + distance);
    let asked = Point3::new(0.36 * far, -0.48 * far, 0.8 * far);
    let coordinates: Place = std::array::from_fn(|axis| Precise::new(asked[axis]));
    let norm = (coordinates.iter())
        .fold(Precise::new(0.0), |sum, x| sum + x.squared())
        .sqrt();
    let truth: Place = std::array::from_fn(|axis| &coordinates[axis] / &norm * radius);
    let sphere = Sphere::new(radius).expect(MADE);
    let found = sphere.closest_point(&asked)?;
    Ok(Answer::all_at_scale(against(&found.coords, &truth), radius).within(1e-15))
}

/// The foot at r = 1.5 radii of curvature, where the normal is `(2cr, 1)/w`.
fn above_paraboloid(radius: f64, above: f64) -> Result<Answer, SurfaceError> {
    let c = 0.5 / radius;
    let (x, y) = (0.9 * radius, 1.2 * radius);
    let slope = [x, y].map(|x| Precise::new(x) * c * 2.0);
    let w = (slope[0].squared() + slope[1].squared() + 1.0).sqrt();
    let height = -(Precise::new(x).squared() + Precise::new(y).squared()) * c;
    let foot: Place = [Precise::new(x), Precise::new(y), height];
    let normal: Place = [&slope[0] / &w, &slope[1] / &w, Precise::new(1.0) / &w];
    let distance = above * radius;
    let asked: Place = std::array::from_fn(|axis| &foot[axis] + &normal[axis] * distance);
    let asked = point(&asked);
    let found = Graph::paraboloid(c).expect(MADE).closest_point(&asked)?;
    // Where the question lies is only known to the last place of its coordinates.
    let sharpest = 2.0 * c / w.to_f64();
    let condition = asked.coords.norm() / radius / (1.0 + sharpest * distance);
    let answer = Answer::all_at_scale(against(&found.coords, &foot), radius).within(1e-14);
    Ok(answer.conditioned(condition))
}

/// The foot at `a_i w_i` with a unit vector w; the normal has the direction `w_i/a_i`.
fn above_ellipsoid(axes: [f64; 3]) -> Result<Answer, SurfaceError> {
    let unit = [0.36, 0.48, 0.8];
    let foot: Place = std::array::from_fn(|axis| Precise::new(unit[axis]) * axes[axis]);
    let gradient: Place = std::array::from_fn(|axis| Precise::new(unit[axis]) / axes[axis]);
    let norm = (gradient.iter())
        .fold(Precise::new(0.0), |sum, x| sum + x.squared())
        .sqrt();
    let asked: Place = std::array::from_fn(|axis| &foot[axis] + &gradient[axis] / &norm);
    let found = Ellipsoid::new(axes)
        .expect(MADE)
        .closest_point(&point(&asked))?;
    let largest = axes.into_iter().fold(1.0, f64::max);
    Ok(Answer::all_at_scale(against(&found.coords, &foot), largest).within(1e-14))
}

/// The first closest point that is none.
fn nowhere(size: f64) -> Result<Point3<f64>, SurfaceError> {
    let axis = Vector3::new(libm::cos(0.4f64), libm::sin(0.4f64), 0.0) * size;
    let asked: [(Shape, Vector3<f64>); 5] = [
        (
            Shape::Sphere(Sphere::new(size).expect(MADE)),
            Vector3::zeros(),
        ),
        (Shape::Dish(Dish::new(size).expect(MADE)), Vector3::zeros()),
        (Shape::Cylinder(Cylinder::new(size, 0.4).expect(MADE)), axis),
        (
            Shape::Ellipsoid(Ellipsoid::new([size, 2.0 * size, 3.0 * size]).expect(MADE)),
            Vector3::zeros(),
        ),
        (
            Shape::Torus(Torus::new(size, 0.3 * size).expect(MADE)),
            Vector3::new(0.6, 0.8, 0.0) * size,
        ),
    ];
    let answers = asked.map(|(shape, place)| shape.closest_point(&Point3::from(place)));
    let first = answers[0];
    answers.into_iter().find(Result::is_ok).unwrap_or(first)
}
