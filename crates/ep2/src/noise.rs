//! Noise of a patch's contacts: stated or estimated.

use crate::{Ep2Error, Patch, PatchFrame};

/// Stated standard deviations of the contacts' errors. `None` means that the fit estimates the value from the contacts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    /// Standard deviation of the error of a position along each axis (length).
    pub position_std: Option<f64>,
    /// Standard deviation of a normal's tilt along each tangent axis (rad).
    pub normal_std_rad: Option<f64>,
}

/// Standard deviations of the contacts' errors: stated by the user, or estimated from the contacts' distances to the
/// fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseEstimate {
    /// Standard deviation of the error of a position along the surface's normal (length).
    pub position_std: f64,
    /// Standard deviation of a normal's tilt along each tangent axis (rad); `None` without normals. If it was
    /// estimated, it includes the tilt that position errors cause on a curved surface.
    pub normal_std_rad: Option<f64>,
}

/// Smallest standard deviation that is assumed for the errors of heights (in the patch's unit of length) and of slopes.
/// A smaller estimate may be only a rounding error.
const MIN_STD: f64 = 1e-12;
/// Largest allowed ratio between the estimated variances of heights and of slopes, in either direction. If an estimated
/// ratio is larger, the fit follows the heights or the slopes almost exactly by chance.
const MAX_VARIANCE_RATIO: f64 = 1e8;

impl Noise {
    /// Whether the noise of all kinds of readings in the patch (positions, normals) is stated.
    pub(crate) fn is_complete_for(&self, patch: &Patch) -> bool {
        self.position_std.is_some() && (self.normal_std_rad.is_some() || !patch.has_normals())
    }

    /// This noise, converted to the unit of length of the patch with the frame `frame`.
    ///
    /// # Errors
    /// [`Ep2Error::BadSetting`] if a standard deviation is not finite or not > 0.
    pub(crate) fn in_patch(&self, frame: &PatchFrame) -> Result<Self, Ep2Error> {
        let settings = [
            ("position_std", self.position_std),
            ("normal_std", self.normal_std_rad),
        ];
        for (setting, value) in settings {
            let value = value.unwrap_or(1.0);
            let is_good = value > 0.0 && value.is_finite();
            Ep2Error::unless_good(setting, value, is_good, "finite and > 0")?;
        }
        Ok(Self {
            position_std: self.position_std.map(|std| std / frame.scale()),
            normal_std_rad: self.normal_std_rad,
        })
    }
}

/// A pair of values: one for heights and one for slopes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Kinds<T> {
    pub(crate) heights: T,
    pub(crate) slopes: T,
}

/// Variances of the errors of a height and of a slope, in the patch's unit of length, at places where the surface is
/// parallel to the plane of the patch.
pub(crate) type Variances = Kinds<f64>;

impl Variances {
    /// Start values of the iterative estimation of the noise.
    pub(crate) const START: Self = Self {
        heights: 1.0,
        slopes: 1.0,
    };

    /// Estimates the variances that are not stated, from the weighted sums of squared residuals. Stated variances do
    /// not change. `unknowns` are the effective degrees of freedom of the fit. `bending` is the mean square of the
    /// second derivatives. It determines the error of a slope that a position error causes on a curved surface.
    ///
    /// Returns whether the variances are determined, that is, whether the residuals have at least one degree of
    /// freedom.
    pub(crate) fn update(
        &mut self,
        known: &Noise,
        bending: f64,
        patch: &Patch,
        residuals: &Kinds<f64>,
        unknowns: &Kinds<f64>,
    ) -> bool {
        let floor = MIN_STD * MIN_STD;
        let contacts = patch.samples.len() as f64;
        let left = Kinds {
            heights: contacts - unknowns.heights,
            slopes: 2.0 * contacts - unknowns.slopes,
        };
        let mut is_determined = true;
        match known.position_std {
            Some(std) => self.heights = (std * std).max(floor),
            None if left.heights >= 1.0 => {
                self.heights = (residuals.heights / left.heights).max(floor);
            }
            None => is_determined = false,
        }
        if patch.has_normals() {
            match known.normal_std_rad {
                Some(std) => self.slopes = (std * std + bending * self.heights).max(floor),
                None if left.slopes >= 1.0 => {
                    self.slopes = (residuals.slopes / left.slopes).max(floor);
                }
                None => is_determined = false,
            }
            let (heights, slopes) = (self.heights, self.slopes);
            if known.position_std.is_none() {
                self.heights = heights.max(slopes / MAX_VARIANCE_RATIO);
            }
            if known.normal_std_rad.is_none() {
                self.slopes = slopes.max(heights / MAX_VARIANCE_RATIO);
            }
        }
        is_determined
    }

    /// The smallest allowed factor by which both variances may be multiplied. With a smaller factor, they would be
    /// below the variances of rounding errors.
    pub(crate) fn min_scale(&self) -> f64 {
        MIN_STD * MIN_STD / self.heights
    }

    pub(crate) fn estimate(&self, patch: &Patch, known: &Noise) -> NoiseEstimate {
        NoiseEstimate {
            position_std: self.heights.sqrt() * patch.frame.scale(),
            normal_std_rad: patch
                .has_normals()
                .then(|| known.normal_std_rad.unwrap_or(self.slopes.sqrt())),
        }
    }
}
