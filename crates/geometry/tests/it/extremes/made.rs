//! Constructors, with what makes no surface.

use palpate_geometry::ShapeThresholds;
use palpate_geometry::surfaces::{Cylinder, Dish, Ellipsoid, Graph, Sphere, Torus};
use palpate_verdict::{NO_LENGTHS, NOT_FINITE, rows};

const THRESHOLDS: &str = "geometry::ShapeThresholds::new";
const REFUSED: &str = "invalid-shape";

rows! {
    "geometry::Sphere::new", "radius {bad:e}", REFUSED => Sphere::new(bad), for bad in NO_LENGTHS;
    "geometry::Dish::new", "radius {bad:e}", REFUSED => Dish::new(bad), for bad in NO_LENGTHS;
    "geometry::Cylinder::new", "radius {bad:e}", REFUSED => Cylinder::new(bad, 0.0), for bad in NO_LENGTHS;
    "geometry::Cylinder::new", "direction {bad:e}", REFUSED => Cylinder::new(1.0, bad), for bad in NOT_FINITE;
    "geometry::Torus::new", "radius {bad:e}", REFUSED => Torus::new(bad, 1e-3), for bad in NO_LENGTHS;
    "geometry::Torus::new", "radius of the tube {bad:e}", REFUSED => Torus::new(1e3, bad), for bad in NO_LENGTHS;
    "geometry::Ellipsoid::new", "radius {bad:e} along x", REFUSED => Ellipsoid::new([bad, 1.0, 1.0]),
        for bad in NO_LENGTHS;
    "geometry::Ellipsoid::new", "radius {bad:e} along y", REFUSED => Ellipsoid::new([1.0, bad, 1.0]),
        for bad in NO_LENGTHS;
    "geometry::Ellipsoid::new", "radius {bad:e} along z", REFUSED => Ellipsoid::new([1.0, 1.0, bad]),
        for bad in NO_LENGTHS;
    "geometry::Graph::paraboloid", "{bad:e}", REFUSED => Graph::paraboloid(bad), for bad in NOT_FINITE;
    "geometry::Graph::saddle", "{bad:e}", REFUSED => Graph::saddle(bad), for bad in NOT_FINITE;
    THRESHOLDS, "gaussian {bad:e}, mean 0e0", "out-of-range" => ShapeThresholds::new(bad, 0.0),
        for bad in [f64::NAN, f64::INFINITY, -1e-310];
    THRESHOLDS, "gaussian {gaussian:e}, mean {bad:e}", "out-of-range" => ShapeThresholds::new(gaussian, bad),
        for (gaussian, bad) in [(0.0, f64::NAN), (1.0, f64::INFINITY)];
    THRESHOLDS, "gaussian {gaussian:e}, mean {mean:e}", "impossible-class" => ShapeThresholds::new(gaussian, mean),
        for (gaussian, mean) in [(0.0, 1e-9), (1e300, 1e200)];
}
