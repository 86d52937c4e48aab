//! Computes maps of fitted shapes, that is, points of the shapes with their curvature.

use nalgebra::{Point3, Vector3};
use palpate_geometry::UNKNOWN_DIRECTION_STD;

use super::pose::Pose;
use crate::{Contact, Curvature, MapPoint, Shape, ShapeFit, Uncertainty};

/// Limits the extent of a map on a curved shape. Let θ be the angle between the shape's normal at a contact and its
/// normal in the middle of the contacts. This constant is the smallest cosine of θ; a larger θ is reduced to this
/// limit.
const MIN_COSINE: f64 = 0.2;

impl ShapeFit {
    /// The point of the shape that is nearest to a position.
    pub fn point_at(&self, place: &Point3<f64>) -> MapPoint {
        let pose = self.pose();
        let normal = pose.normal_at(&place.coords);
        let foot = place.coords - normal * pose.distance(&place.coords);
        self.point(foot, normal)
    }

    /// Standard errors of the principal curvatures k_min and k_max (1/length), and of the angle of their directions
    /// (rad). `None` if the curvature has no standard error.
    pub fn principal_stds(&self) -> Option<[f64; 3]> {
        let std = self.curvature.std?;
        let along = if self.shape == Shape::Cylinder {
            0.0
        } else {
            std
        };
        let [min, max] = match self.curvature.value? < 0.0 {
            true => [std, along],
            false => [along, std],
        };
        let angle = self.direction_std_rad.unwrap_or(UNKNOWN_DIRECTION_STD);
        Some([min, max, angle.min(UNKNOWN_DIRECTION_STD)])
    }

    /// Smallest and largest coordinates of the contacts in the plane that touches the shape in the middle of the
    /// contacts. The contacts are projected into this plane from the centre or the axis of the shape.
    pub fn domain(&self, contacts: &[Contact]) -> [[f64; 2]; 2] {
        let pose = self.pose();
        let mut domain = [[0.0_f64; 2]; 2];
        for contact in contacts {
            let place = pose.axes * (contact.position.coords - pose.point);
            let height = (1.0 + pose.curvature * place.z).max(MIN_COSINE);
            let across = place.y / height;
            let along = match self.shape {
                Shape::Cylinder => place.x,
                Shape::Plane | Shape::Sphere => place.x / height,
            };
            for ([low, high], place) in domain.iter_mut().zip([along, across]) {
                *low = low.min(place);
                *high = high.max(place);
            }
        }
        domain
    }

    /// A map of the shape on a grid of `side` × `side` points that extends over the contacts. The grid is evenly spaced
    /// in the plane of [`ShapeFit::domain`]. The coordinate along the axis of a cylinder varies slowest.
    pub fn map(&self, contacts: &[Contact], side: usize) -> Vec<MapPoint> {
        let (pose, domain) = (self.pose(), self.domain(contacts));
        let steps = side.saturating_sub(1).max(1) as f64;
        let place = |[low, high]: [f64; 2], index: usize| match side {
            1 => 0.5 * (low + high),
            _ => low + (high - low) * index as f64 / steps,
        };
        let points = (0..side * side).map(|index| {
            let along = pose.axis(0) * place(domain[0], index / side);
            let across = pose.axis(1) * place(domain[1], index % side);
            self.point_at(&(pose.point + along + across).into())
        });
        points.collect()
    }

    fn pose(&self) -> Pose {
        let axis = self.direction.unwrap_or_else(Vector3::x);
        let curvature = self.curvature.value.unwrap_or(0.0);
        Pose::new(self.shape, self.foot.0.coords, self.foot.1, axis, curvature)
    }

    fn point(&self, foot: Vector3<f64>, normal: Vector3<f64>) -> MapPoint {
        let bend = self.curvature.value.unwrap_or(0.0);
        let std = self.curvature.std;
        let frame = Pose::new(
            self.shape,
            foot,
            normal,
            self.direction.unwrap_or_else(Vector3::x),
            0.0,
        );
        let (along, across) = (frame.axis(0), frame.axis(1));
        let (gaussian, mean, [gaussian_std, mean_std]) = match self.shape {
            Shape::Plane => (0.0, 0.0, [0.0; 2]),
            Shape::Sphere => (bend * bend, bend, [2.0 * bend.abs(), 1.0]),
            Shape::Cylinder => (0.0, 0.5 * bend, [0.0, 0.5]),
        };
        let other = if self.shape == Shape::Sphere {
            bend
        } else {
            0.0
        };
        let is_across_larger = bend >= other;
        let [of_min, of_max] = if is_across_larger {
            [along, across]
        } else {
            [across, along]
        };
        let sum = bend.abs() + other.abs();
        let uncertainty = std.map(|std| Uncertainty {
            gaussian_std: gaussian_std * std,
            mean_std: mean_std * std,
            // For a sphere, the Gaussian and the mean curvature are computed from one value, so they are completely
            // correlated.
            correlation: if gaussian > 0.0 { bend.signum() } else { 0.0 },
        });
        MapPoint {
            position: foot.into(),
            normal,
            curvature: Curvature {
                gaussian,
                mean,
                uncertainty,
            },
            k_min: bend.min(other),
            k_max: bend.max(other),
            direction_of_min: of_min,
            direction_of_max: of_max,
            shape_index: (sum > 0.0).then(|| match self.shape {
                Shape::Sphere => bend.signum(),
                Shape::Plane | Shape::Cylinder => 0.5 * bend.signum(),
            }),
        }
    }
}
