//! The reading of one rolling probe, and its noise.

use std::collections::BTreeMap;

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

/// Rotations that differ by less than this share of the longest are alike: directions are rounded.
const ALIKE: f64 = 1e-9;

/// Where on the pads of a fingertip rolls start: it decides which errors they share.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PadStart {
    /// Each roll starts at a place of its own: errors are independent.
    #[default]
    PerRoll,
    /// All rolls start at the same place, anywhere on a pad: they share the error of the start, and rolls that turn alike
    /// share that of the end.
    PerTrial,
    /// All rolls start at a pad's centre: rolls that turn alike read alike, and opposite ones read opposite shifts.
    Centred,
}

/// Noise and resolution of readings, from which covariances and bounds follow.
///
/// The errors are independent between probes and components, each of the stated standard deviation; of pads, shifts share
/// errors as [`PadStart`] says.
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
    /// Where on the pads the rolls start; of no effect without pads.
    pub pad_start: PadStart,
}

impl ReadingNoise {
    /// Noise of pads of a pitch, length. A shift's error is uniform over a pad at the last contact and, unless that is
    /// centred, at the first.
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

    /// Sums of the drives `g` (rad) over rolls whose shifts have the same error, each with the share of the variance of a
    /// shift that this error has; `None` where each roll has its own.
    pub(crate) fn shared_errors(
        &self,
        rotations: &[Vector2<f64>],
    ) -> Option<Vec<(Vector2<f64>, f64)>> {
        let is_centred = match self.pad_start {
            _ if self.shift_resolution == 0.0 => return None,
            PadStart::PerRoll => return None,
            PadStart::PerTrial => false,
            PadStart::Centred => true,
        };
        let longest = rotations.iter().map(|one| one.norm()).fold(0.0, f64::max);
        let mut alike: BTreeMap<[i64; 2], Vector2<f64>> = BTreeMap::new();
        for rotation in rotations {
            let drive = Vector2::new(-rotation.y, rotation.x);
            let [u, v] = (drive / (ALIKE * longest))
                .map(|part| part.round() as i64)
                .into();
            // The error of an opposite roll is the opposite error.
            let is_opposite = is_centred && (u < 0 || (u == 0 && v < 0));
            let sign = if is_opposite { -1 } else { 1 };
            *alike.entry([sign * u, sign * v]).or_default() += drive * sign as f64;
        }
        let groups = alike.into_values();
        Some(match is_centred {
            true => groups.map(|sum| (sum, 1.0)).collect(),
            false => {
                let all: Vector2<f64> = rotations
                    .iter()
                    .map(|one| Vector2::new(-one.y, one.x))
                    .sum();
                groups.chain([all]).map(|sum| (sum, 0.5)).collect()
            }
        })
    }
}
