//! Estimates of the object's curvature at the contact.

use nalgebra::{Matrix2, Vector2};
use palpate_geometry::CurvatureForm;

/// A value with its standard error. The standard error is computed to first order from the stated noise.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measured {
    /// The estimated value.
    pub value: f64,
    /// Standard error, in the same unit as the value; `None` if no noise was stated.
    pub std: Option<f64>,
}

/// The object's curvature at the contact, in the contact frame (u, v) at the start of the rolls.
///
/// ```
/// use nalgebra::Vector2;
/// use palpate_ep1::{LeastSquares, ProbeReading, ReadingNoise};
///
/// // Probes of radius 2 on a plane: the contact moves by 2 per radian.
/// let readings = [
///     ProbeReading { rotation: Vector2::new(0.0, -0.1), shift: Vector2::new(0.2, 0.0) },
///     ProbeReading { rotation: Vector2::new(0.1, 0.0), shift: Vector2::new(0.0, 0.2) },
/// ];
/// let estimate = LeastSquares::of(2.0, ReadingNoise::default(), &readings)?;
/// assert_eq!(estimate.gaussian_curvature.value, 0.0);
/// assert_eq!(estimate.amplification(0.0), None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The object's curvature form (1/length); positive where the object is convex.
    pub curvature: CurvatureForm,
    /// Normal curvature (1/length) of the object along u.
    pub normal_curvature_u: Measured,
    /// Normal curvature (1/length) of the object along v.
    pub normal_curvature_v: Measured,
    /// Gaussian curvature (1/length²) of the object.
    pub gaussian_curvature: Measured,
    /// Mean curvature (1/length) of the object.
    pub mean_curvature: Measured,
    /// Mean length of the shifts of the contact, in the length unit of the readings.
    pub arc_length: f64,
    pub(crate) probe_curvature: f64,
    /// Mobility: the distance (length) that the contact moves on the probe per radian of the probe's rotation. It is
    /// `(K₁ + K₂)⁻¹`, where K₁ and K₂ are the curvature forms of probe and object.
    pub(crate) mobility: Matrix2<f64>,
}

impl Estimate {
    /// The shift of the contact (length) that this estimate predicts for a roll by `rotation` (rad).
    pub fn shift(&self, rotation: &Vector2<f64>) -> Vector2<f64> {
        self.mobility * Vector2::new(-rotation.y, rotation.x)
    }

    /// Amplification of errors: the relative error of the object's normal curvature at `angle_rad` from u, divided by a
    /// small relative error of the readings. It is `1 + 1/RCR`, where RCR is the object's normal curvature divided by
    /// the probe's (Charlebois, Gupta and Payandeh 1996, equation 7). `None` where the object is flat, because the
    /// ratio is infinite there.
    pub fn amplification(&self, angle_rad: f64) -> Option<f64> {
        let growth = 1.0 + self.probe_curvature / self.curvature.normal_curvature(angle_rad);
        growth.is_finite().then_some(growth)
    }
}
