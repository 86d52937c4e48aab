//! Rolls that all have the same direction. Such rolls determine the object's normal curvature along the path of the
//! contact, but not across this path.

use nalgebra::{Matrix2, SymmetricEigen, Vector2};
use palpate_ep1::{Ep1Error, Estimate, ProbeReading, ReadingNoise};
use palpate_statistics::Number;
use palpate_study::config::LengthUnit;
use palpate_study::{Unit, Warning};
use serde::Serialize;

use super::value::Value;

/// Rolls have a single direction if the rms rotation across this direction, divided by the rms rotation along it, is
/// below this value.
const MAX_SPREAD: f64 = 0.05;
/// Rotation of the artificial roll that [`single_direction`] adds to the recorded rolls. The artificial roll is
/// perpendicular to them. Its rotation is this value times the rms rotation of the recorded rolls.
const ACROSS_SHARE: f64 = 0.1;

/// Normal curvature along the path of the contact.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DirectedCurvature {
    /// Normal curvature of the object along the path, > 0 if convex.
    pub curvature_along: Value,
    /// Direction of the path, degrees, from +u towards +v of the readings.
    pub direction_deg: f64,
}

/// If all rolls have one direction, returns the angle of the contact's path (from u towards v), readings for a fit, and
/// the noise of these readings.
///
/// The recorded rolls alone do not determine the fit, so the readings also contain an artificial roll. It is
/// perpendicular to the recorded rolls. Its shift in its own direction is that of a roll on a plane. The other
/// component of its shift follows from the recorded rolls, because the mobility (the contact's travel per radian) is a
/// symmetric matrix.
///
/// Let g be the unit vector in the direction of rolling (perpendicular to the rotation axis), and b the displacement of
/// the contact per radian. The relative curvature along b is b·g/|b|². It does not depend on the curvature across b, so
/// the artificial roll has no effect on it.
///
/// The artificial roll has no rotation noise, so the fit itself must not correct the bias from the rotation noise.
/// Instead, the recorded rotations are multiplied by 1 − s, where s is the share of noise in the sum of their squares.
/// In the returned noise, the standard deviation of the shifts includes the effect of the rotation noise.
///
/// # Errors
/// [`Ep1Error::NoisyRotations`] if the rotations are hardly longer than their noise.
pub(super) fn single_direction(
    readings: &[ProbeReading],
    probe_radius: f64,
    noise: &ReadingNoise,
) -> Result<Option<(f64, Vec<ProbeReading>, ReadingNoise)>, Ep1Error> {
    let drive = |rotation: &Vector2<f64>| Vector2::new(-rotation.y, rotation.x);
    let largest = readings.iter().map(|one| one.rotation.amax());
    let largest = largest.fold(f64::MIN_POSITIVE, f64::max);
    let mut moment = Matrix2::zeros();
    for reading in readings {
        let drive = drive(&(reading.rotation / largest));
        moment += drive * drive.transpose();
    }
    // The rolls have a single direction if the ratio q of the smaller to the larger eigenvalue of `moment` is below
    // `RATIO`. For a 2 × 2 matrix, the determinant divided by the squared trace is q/(1 + q)².
    const RATIO: f64 = MAX_SPREAD * MAX_SPREAD;
    let (trace, determinant) = (moment.trace(), moment.determinant());
    let is_single = determinant * (1.0 + RATIO) * (1.0 + RATIO) < RATIO * trace * trace;
    if !is_single || readings.len() < 2 {
        return Ok(None);
    }
    let eigen = SymmetricEigen::new(moment);
    let (place, square) = eigen.eigenvalues.argmax();
    let along: Vector2<f64> = eigen.eigenvectors.column(place).into();
    let across = Vector2::new(-along.y, along.x);
    let rolled = |reading: &ProbeReading| drive(&reading.rotation).dot(&along) / largest;
    let shifts = readings.iter().map(|one| one.shift * rolled(one));
    let squares = square * largest * largest;
    let share = noise.squared_errors(readings.len(), squares, squares)? / squares;
    let path = shifts.sum::<Vector2<f64>>() / (square * largest * (1.0 - share));
    let fourth_powers = readings.iter().map(|one| rolled(one).powi(4));
    let turn = largest * (fourth_powers.sum::<f64>() / square).sqrt();
    let rotation_std = libm::hypot(noise.rotation_std_rad, noise.relative_rotation_std * turn);
    let noise = ReadingNoise {
        relative_rotation_std: 0.0,
        rotation_std_rad: 0.0,
        shift_std: libm::hypot(noise.shift_std, rotation_std * path.norm()),
        ..*noise
    };
    let turned = |drive: Vector2<f64>| Vector2::new(drive.y, -drive.x);
    let mut fitted: Vec<ProbeReading> = readings
        .iter()
        .map(|reading| ProbeReading {
            rotation: turned(along * rolled(reading) * largest * (1.0 - share)),
            ..*reading
        })
        .collect();
    let size = ACROSS_SHARE * largest * (square / readings.len() as f64).sqrt();
    fitted.push(ProbeReading {
        rotation: turned(across * size),
        shift: (along * path.dot(&across) + across * probe_radius) * size,
    });
    let angle = libm::atan(path.y / path.x);
    Ok(angle.is_finite().then_some((angle, fitted, noise)))
}

impl DirectedCurvature {
    /// The curvature along a path with the direction `angle` (rad, from u towards v). `estimate` must be computed from
    /// the readings that [`single_direction`] returns.
    pub(super) fn new(
        angle: f64,
        estimate: &Estimate,
        covariance: Option<&[[f64; 3]; 3]>,
        half_width: f64,
        unit: LengthUnit,
    ) -> Self {
        let (sin, cos) = libm::sincos(angle);
        let weights = [cos * cos, sin * sin, 2.0 * sin * cos];
        let variance = |covariance: &[[f64; 3]; 3]| {
            let rows = covariance.iter().zip(weights);
            let sums = rows.map(|(row, weight)| {
                weight * row.iter().zip(weights).map(|(a, b)| a * b).sum::<f64>()
            });
            sums.sum::<f64>()
        };
        let std = covariance.map(|covariance| variance(covariance).max(0.0).sqrt());
        let value = estimate.curvature.normal_curvature(angle);
        Self {
            curvature_along: Value::within(value, std, half_width, Unit::PerLength, unit),
            direction_deg: angle.to_degrees(),
        }
    }

    pub(super) fn warning(&self) -> Warning {
        let angle = Number::rounded(self.direction_deg);
        let text = format!(
            "all rolls are in one direction: they determine the curvature along {angle} deg from u, and not across it"
        );
        Warning::new(
            "not-resolved-across",
            text,
            [("direction_deg", self.direction_deg)],
        )
    }
}
