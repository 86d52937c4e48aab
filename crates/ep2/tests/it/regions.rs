//! Divides maps into regions.

use approx::assert_relative_eq;
use nalgebra::{Point3, Vector3};
use palpate_ep2::{Curvature, MapPoint, Regions, regions};
use palpate_geometry::{ShapeClass, ShapeThresholds};

/// A plane map of 5 × 5 points with a curvature for each row: the Gaussian and the mean curvature.
fn map(of_row: impl Fn(usize) -> [f64; 2]) -> Vec<MapPoint> {
    let point = |index: usize| {
        let [x, y] = [index / 5, index % 5].map(|place| place as f64 * 0.5);
        let [gaussian, mean] = of_row(index / 5);
        let spread = (mean * mean - gaussian).max(0.0).sqrt();
        MapPoint {
            position: Point3::new(x, y, 0.0),
            normal: Vector3::z(),
            curvature: Curvature {
                gaussian,
                mean,
                uncertainty: None,
            },
            k_min: mean - spread,
            k_max: mean + spread,
            direction_of_min: Vector3::x(),
            direction_of_max: Vector3::y(),
            shape_index: None,
        }
    };
    (0..25).map(point).collect()
}

#[test]
fn corners_do_not_connect_and_areas_add_up() {
    // The map is a plane that a ridge divides into two separate regions.
    let points = map(|row| [0.0, if row == 2 { 0.2 } else { 0.0 }]);
    let thresholds = ShapeThresholds::new(0.01, 0.1).unwrap();
    let Regions { of_point, regions } = regions(5, &points, &thresholds).expect("finite points");
    assert_eq!(regions.len(), 3);
    let count: usize = regions.iter().map(|region| region.points).sum();
    assert_eq!(count, 25);
    let whole: f64 = regions.iter().map(|region| region.area).sum();
    assert_relative_eq!(whole, 4.0, epsilon = 1e-12);
    let ridge = of_point[12];
    assert_eq!(regions[ridge].class, ShapeClass::Ridge);
    assert_eq!(regions[ridge].points, 5);
    assert_relative_eq!(regions[ridge].mean_curvature, 0.2, epsilon = 1e-15);
    let direction = regions[ridge].direction_of_max.unwrap();
    assert_relative_eq!(direction.y.abs(), 1.0, epsilon = 1e-12);
    assert_relative_eq!(regions[ridge].coherence, 1.0, epsilon = 1e-12);
    let mut directions = regions.iter().map(|region| region.direction_of_max);
    assert!(directions.any(|one| one.is_none()));
}
