//! The reading of one rolling probe, and its noise.

use nalgebra::Vector2;

/// The reading of one probe, in the probe's first contact frame (`z₁` out of the probe).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProbeReading {
    /// `(Δθ_x, Δθ_y)`: rotation summed in the contact frame, rad. A contact moving to +u has
    /// `Δθ_y < 0`.
    pub rotation: Vector2<f64>,
    /// `(Δp_u, Δp_v)`: great-circle displacement of the contact on the probe, length.
    pub shift: Vector2<f64>,
}

/// Noise and resolution of readings, from which covariances and bounds follow.
///
/// The errors are taken as independent between probes and components, each of the stated standard
/// deviation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReadingNoise {
    /// Standard deviation of each component of a rotation, as a fraction of its magnitude.
    pub relative_rotation_std: f64,
    /// Standard deviation of each component of a rotation, rad.
    pub rotation_std_rad: f64,
    /// Standard deviation of each component of a shift, length.
    pub shift_std: f64,
    /// Resolution of shifts, length: a shorter one may read as zero; 0 if the sensor resolves any.
    pub shift_resolution: f64,
}

impl ReadingNoise {
    /// Whether any error is stated.
    pub fn is_stated(&self) -> bool {
        self.relative_rotation_std > 0.0 || self.rotation_std_rad > 0.0 || self.shift_std > 0.0
    }

    /// Variance of each component of a rotation of squared magnitude `square`.
    #[inline]
    pub(crate) fn rotation_variance(&self, square: f64) -> f64 {
        self.relative_rotation_std * self.relative_rotation_std * square
            + self.rotation_std_rad * self.rotation_std_rad
    }
}
