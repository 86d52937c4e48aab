//! Converts the results of a fit to the unit of the contacts: sizes, position and direction, with their standard
//! errors.

use nalgebra::{Matrix3, SMatrix, Vector3};

use super::cells::Rounding;
use super::intervals::{CurvatureInterval, curvature_interval};
use super::pose::{CURVATURE, Cloud, Pose, UNKNOWNS};
use super::robust_fit::slope;
use super::{Candidate, Scaled, Shape, ShapeFit, ShapeSettings, SizeEstimate, start};
use crate::NoiseEstimate;
use crate::effective_readings::EffectiveReadings;

/// An object counts as touched all around if the mean of the shape's unit normals at the contacts is shorter than this
/// value. Such an object is assumed to be convex.
const MIN_MEAN_NORMAL: f64 = 0.5;
/// The outward direction determines the outside of the shape only if it is not nearly perpendicular to the mean normal.
/// This constant is the smallest absolute cosine of the angle between them.
const MIN_OUTWARD_COSINE: f64 = 0.1;

impl ShapeSettings {
    pub(super) fn reported(
        &self,
        candidate: &Candidate,
        scaled: &Scaled,
        used: &Cloud,
        rounding: &Rounding,
        outward: Vector3<f64>,
    ) -> Option<ShapeFit> {
        let Candidate { solution, lack } = candidate;
        let scale = scaled.scale;
        let interval = curvature_interval(solution, used, lack, rounding);
        let outside = match used.normals.is_empty() {
            true => outside(&solution.pose, used, &outward),
            false => Some(true),
        };
        let is_reversed = outside.map_or(solution.pose.curvature < 0.0, |is_out| !is_out);
        let pose = if is_reversed {
            solution.pose.reversed()
        } else {
            solution.pose
        };
        let shape = pose.shape;
        let is_plane = shape == Shape::Plane;
        let sign = if is_reversed { -1.0 } else { 1.0 };
        let is_resolved = !is_plane && interval.is_some_and(|interval| interval.is_resolved);
        // The fit has the curvature of the surface on which the centres of the fingertip lie. `of_object` converts it
        // to the curvature of the object.
        let of_object = |curvature: f64| curvature / (1.0 - curvature * self.tip_radius);
        let centres = pose.curvature / scale;
        let ends = interval.map(|interval| {
            let [low, high] = interval.ends.map(|end| sign * end / scale);
            [low.min(high), low.max(high)]
        });
        let std = interval.map(|interval| interval.std / scale);
        let is_tip_smaller = |curvature: f64| curvature * self.tip_radius < 1.0;
        let ends_of_object = ends.map_or([None; 2], |ends| {
            ends.map(|end| is_tip_smaller(end).then(|| of_object(end)))
        });
        let stretch = (1.0 - centres * self.tip_radius).powi(-2);
        let curvature = match is_plane {
            true => SizeEstimate {
                value: Some(0.0),
                std: None,
                interval95: [Some(0.0); 2],
            },
            false => SizeEstimate {
                value: is_tip_smaller(centres).then(|| of_object(centres)),
                std: std
                    .filter(|_| is_tip_smaller(centres))
                    .map(|std| std * stretch),
                interval95: ends_of_object,
            },
        };
        let radius = radius(&curvature, is_resolved, ends_of_object);
        let variance = |row: &SMatrix<f64, 3, UNKNOWNS>, interval: &CurvatureInterval| {
            let spread: Matrix3<f64> = row * interval.covariance * row.transpose();
            spread.diagonal().map(|x| x.max(0.0).sqrt() * scale).into()
        };
        let place = place(&solution.pose, is_resolved);
        let foot = pose.based_at(&start::middle(used));
        let tip = foot.axis(2) * self.tip_radius;
        let place_std = place
            .and(interval)
            .map(|interval| variance(&place_derivative(&solution.pose), &interval));
        let direction = match shape {
            Shape::Plane => Some(pose.axis(2)),
            Shape::Cylinder => Some(pose.axis(0)),
            Shape::Sphere => None,
        };
        let direction_std_rad = direction.and(interval).map(|interval| {
            let angles: [usize; 2] = if is_plane { [0, 1] } else { [1, 2] };
            let [one, other] = angles.map(|angle| interval.covariance[(angle, angle)]);
            one.max(other).max(0.0).sqrt()
        });
        let distances = used.places.iter().map(|place| pose.distance(place).powi(2));
        let rms_misfit = scale * (distances.sum::<f64>() / used.places.len() as f64).sqrt();
        let [position, normal] = solution.variances;
        let bending = pose.curvature * pose.curvature * slope(shape, position);
        let noise = solution.freedom.map(|_| NoiseEstimate {
            position_std: position.sqrt() * scale,
            normal_std_rad: (!used.normals.is_empty()).then(|| (normal - bending).max(0.0).sqrt()),
        });
        let place = place.map(|place| match shape {
            Shape::Plane => scaled.point(&place) - tip,
            Shape::Sphere | Shape::Cylinder => scaled.point(&place),
        });
        let foot = (scaled.point(&foot.point) - tip, foot.axis(2));
        let numbers = [rms_misfit, foot.0.coords.sum(), foot.1.sum(), centres];
        numbers
            .iter()
            .all(|number| number.is_finite())
            .then_some(ShapeFit {
                shape,
                probabilities: None,
                curvature,
                radius,
                place,
                place_std,
                foot,
                direction,
                direction_std_rad,
                rms_misfit,
                p_value: if lack.is_negligible {
                    1.0
                } else {
                    lack.p_value
                },
                noise,
                readings: EffectiveReadings {
                    contacts: 0,
                    distinct: 0,
                    position_correlation: 1.0,
                    normal_correlation: 1.0,
                },
                outliers: Vec::new(),
                is_side_assumed: outside.is_none() && !is_plane,
            })
    }
}

fn radius(curvature: &SizeEstimate, is_resolved: bool, ends: [Option<f64>; 2]) -> SizeEstimate {
    let value = curvature.value.filter(|_| is_resolved);
    let size = |curvature: f64| curvature.abs().recip();
    // The radius is the inverse of the curvature's magnitude. Therefore the lower bound of the radius comes from the
    // end of the curvature's interval with the larger magnitude.
    let largest = match ends {
        [Some(low), Some(high)] => Some(low.abs().max(high.abs())),
        _ => None,
    };
    // With a round tip, the curvature may have no upper end. Then it may be infinite.
    let smallest = match (ends[0], ends[1].unwrap_or(f64::INFINITY)) {
        (Some(low), high) if is_resolved && low * high > 0.0 => Some(low.abs().min(high.abs())),
        _ => None,
    };
    let std = curvature
        .std
        .zip(value)
        .map(|(std, value)| std / (value * value));
    SizeEstimate {
        value: value.map(size),
        std,
        interval95: [
            largest.map(size).filter(|x| x.is_finite()),
            smallest.map(size),
        ],
    }
}

/// Whether the normals of a shape that was fitted without normals point outward. `None` if the outward direction does
/// not determine this, because it is nearly tangential to the shape, or because the contacts are all around the object.
fn outside(pose: &Pose, cloud: &Cloud, outward: &Vector3<f64>) -> Option<bool> {
    let normals = cloud.places.iter().map(|place| pose.normal_at(place));
    let mean = normals.sum::<Vector3<f64>>() / cloud.places.len() as f64;
    let cosine = mean.dot(outward);
    if mean.norm() < MIN_MEAN_NORMAL || cosine.abs() < MIN_OUTWARD_COSINE * mean.norm() {
        return None;
    }
    Some(cosine > 0.0)
}

/// Centre of a sphere, point on the axis of a cylinder, or point of a plane; `None` if the size is not determined.
fn place(pose: &Pose, is_resolved: bool) -> Option<Vector3<f64>> {
    match pose.shape {
        Shape::Plane => Some(pose.point),
        Shape::Sphere | Shape::Cylinder => {
            is_resolved.then(|| pose.point - pose.axis(2) / pose.curvature)
        }
    }
}

fn place_derivative(pose: &Pose) -> SMatrix<f64, 3, UNKNOWNS> {
    let mut all = SMatrix::<f64, 3, UNKNOWNS>::zeros();
    all.set_column(3, &pose.axis(2));
    if pose.shape != Shape::Plane {
        let radius = pose.curvature.recip();
        // If the pose rotates about its axis a, the normal moves by −b. If it rotates about its axis b, the normal
        // moves by a.
        all.set_column(0, &(pose.axis(1) * radius));
        all.set_column(1, &(-pose.axis(0) * radius));
        all.set_column(CURVATURE, &(pose.axis(2) * radius * radius));
    }
    if pose.shape == Shape::Cylinder {
        // The reported place of a cylinder does not move along the cylinder's axis, so remove the components of the
        // derivatives along this axis.
        let along = pose.axis(0);
        all -= along * (along.transpose() * all);
    }
    all
}
