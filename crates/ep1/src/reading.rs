//! The reading of one rolling probe, and its noise.

use nalgebra::{Matrix3, RowVector3, Vector2, Vector3};

use crate::Ep1Error;

/// Largest allowed ratio of the error variance of the measured rotations to the mean squared rotation, in any
/// direction. For a simulated scene, the ratio is computed with the true rotations. It is then larger than with
/// measured rotations, because errors would increase the mean square of measured rotations. Therefore the limit is
/// stricter for simulated scenes.
const MAX_NOISE_SHARE: f64 = 0.5;

/// The reading of one probe, in the contact frame at the start of its roll. The z axis of this frame points out of the
/// probe.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProbeReading {
    /// `(Δθ_x, Δθ_y)`: rotation of the probe, summed in the contact frame (rad). If the contact moves to +u, `Δθ_y` is
    /// negative.
    pub rotation: Vector2<f64>,
    /// `(Δp_u, Δp_v)`: great-circle displacement of the contact on the probe (length).
    pub shift: Vector2<f64>,
}

/// Position on a pad at which the rolls start. Pads round the contact to the centre of a pad. The start determines
/// which of these rounding errors are equal in several rolls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PadStart {
    /// Each roll starts at its own random place, so the errors of different rolls are independent.
    #[default]
    PerRoll,
    /// All rolls start at the same random place on a pad, so they share the error of the start. Rolls that end at
    /// similar places relative to their pads also share the error of the end.
    PerTrial,
    /// All rolls start at the centre of a pad. Rolls that end at similar places relative to their pads share the error
    /// of the end. Rolls in opposite directions have opposite errors.
    Centred,
}

/// Noise and resolution of readings, from which covariances and bounds are computed.
///
/// Errors of different probes and components are independent and have the stated standard deviation. On pads, the
/// shifts of different rolls share errors as described for [`PadStart`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReadingNoise {
    /// Standard deviation of the error of each component of a rotation, divided by the magnitude of the rotation.
    pub relative_rotation_std: f64,
    /// Standard deviation (rad) of the part of a rotation's error that does not depend on the rotation's magnitude. It
    /// applies to each component of the rotation.
    pub rotation_std_rad: f64,
    /// Standard deviation (length) of the error of each component of a shift.
    pub shift_std: f64,
    /// Resolution of shifts (length): the sensor may report a shorter shift as zero. It is 0 if the sensor has no such
    /// limit.
    pub shift_resolution: f64,
    /// Place on the pads at which the rolls start. This field has no effect without pads.
    pub pad_start: PadStart,
    /// Whether the relative errors are errors of the measured rotations. If not, they are deviations of the motion from
    /// the commanded rotations, which do not bias a fit.
    pub is_rotation_measured: bool,
}

impl ReadingNoise {
    /// Noise of pads with the pitch `pitch` (length). Pads report the centre of the active pad, so the position error
    /// at the last contact is uniform over a pad. The error at the first contact is uniform too, unless rolls start at
    /// the centre of a pad.
    ///
    /// ```
    /// use palpate_ep1::{PadStart, ReadingNoise};
    ///
    /// let noise = ReadingNoise::of_pads(0.6, PadStart::PerRoll);
    /// assert!((noise.shift_std - 0.6 / 6.0_f64.sqrt()).abs() < 1e-15);
    /// assert_eq!(ReadingNoise::of_pads(0.6, PadStart::Centred).shift_resolution, 0.3);
    /// ```
    pub fn of_pads(pitch: f64, pad_start: PadStart) -> Self {
        let (rounded_ends, shift_resolution) = match pad_start {
            PadStart::Centred => (1.0, 0.5 * pitch),
            PadStart::PerRoll | PadStart::PerTrial => (2.0, pitch),
        };
        Self {
            shift_std: pitch * (rounded_ends / 12.0_f64).sqrt(),
            shift_resolution,
            pad_start,
            ..Self::default()
        }
    }

    /// Whether the standard deviation of at least one error is stated.
    pub fn is_stated(&self) -> bool {
        self.relative_rotation_std > 0.0 || self.rotation_std_rad > 0.0 || self.shift_std > 0.0
    }

    /// Part of the sum Σ x² that comes from errors. Here, x is the component of a measured rotation in one direction,
    /// and the sum is over `count` rotations. `squares` is the sum of the squared magnitudes of the rotations. `least`
    /// is the smallest sum Σ x² of all directions that the fit uses.
    ///
    /// # Errors
    /// [`Ep1Error::NoisyRotations`] if the result exceeds half of `least`.
    pub fn squared_errors(&self, count: usize, squares: f64, least: f64) -> Result<f64, Ep1Error> {
        let relative = self.relative_rotation_std * self.relative_rotation_std;
        let mut added = self.rotation_std_rad * self.rotation_std_rad * count as f64;
        if self.is_rotation_measured {
            added += squares * relative / (1.0 + 2.0 * relative);
        }
        let share = added / least;
        if share > MAX_NOISE_SHARE {
            return Err(Ep1Error::NoisyRotations { share });
        }
        Ok(added)
    }

    /// Variance of each component of a rotation. `square` is the squared magnitude of the rotation.
    #[inline]
    pub(crate) fn rotation_variance(&self, square: f64) -> f64 {
        self.relative_rotation_std * self.relative_rotation_std * square
            + self.rotation_std_rad * self.rotation_std_rad
    }

    /// Covariance of the right-hand side of the normal equations, for shift errors with variance 1 that are correlated
    /// between rolls because of the pads. It is the sum `Σ A₁ᵀ C A₂` over all pairs of rolls. A₁ and A₂ are the
    /// matrices of the two rolls' equations for the curvature, and C contains the correlations between their shift
    /// errors. `None` if each roll starts at its own place, because the errors are then independent.
    ///
    /// The contact is rounded to the centre of a pad, so its error is uniform over the pad. If the ends of two rolls
    /// differ by a fraction f of a pad, their errors have the correlation 1 − 6 f (1 − f). This formula is used only
    /// for small f. Larger distances between the ends depend on the curvature of the object, so the correlation is then
    /// assumed to be 0.
    pub(crate) fn shared_errors(
        &self,
        radius: f64,
        rotations: &[Vector2<f64>],
    ) -> Option<Matrix3<f64>> {
        let pitch = match self.pad_start {
            _ if self.shift_resolution == 0.0 => return None,
            PadStart::PerRoll => return None,
            PadStart::PerTrial => self.shift_resolution,
            PadStart::Centred => 2.0 * self.shift_resolution,
        };
        let alike = |length: f64| {
            let share = length.abs() / pitch;
            if share < 0.5 {
                (1.0 - 6.0 * share * (1.0 - share)).max(0.0)
            } else {
                0.0
            }
        };
        let correlation = |one: f64, other: f64| match self.pad_start {
            // If rolls start at the centre of a pad, opposite shifts have opposite rounding errors. Therefore the
            // correlation of the errors must change its sign if one of the two shifts changes its sign.
            PadStart::Centred => alike(one - other) - alike(one + other),
            _ => 0.5 * (1.0 - alike(one) - alike(other) + alike(one - other)),
        };
        let mut sum = Matrix3::zeros();
        for one in rotations {
            for other in rotations {
                let ([u, v], [other_u, other_v]) = ([-one.y, one.x], [-other.y, other.x]);
                let of_u = correlation(radius * u, radius * other_u);
                let of_v = correlation(radius * v, radius * other_v);
                sum += Vector3::new(u, 0.0, v) * RowVector3::new(other_u, 0.0, other_v) * of_u;
                sum += Vector3::new(0.0, v, u) * RowVector3::new(0.0, other_v, other_u) * of_v;
            }
        }
        Some(sum)
    }
}
