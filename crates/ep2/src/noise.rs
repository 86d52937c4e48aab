//! Noise of the contacts, as known and as found.

use crate::{Ep2Error, Patch, PatchFrame};

/// Known standard deviations of the contacts' errors; one that is `None` is found from the contacts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    /// Standard deviation of a position along each axis, length.
    pub position_std: Option<f64>,
    /// Standard deviation of a normal's tilt about each tangent axis, rad.
    pub normal_std_rad: Option<f64>,
}

/// Standard deviations of the contacts' errors, as known or as found from the distances to the fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseEstimate {
    /// Standard deviation of a position along the surface's normal, length.
    pub position_std: f64,
    /// Standard deviation of a normal's tilt about each tangent axis, rad; what an error of the
    /// position makes of it on a curved surface is in it. `None` without normals.
    pub normal_std_rad: Option<f64>,
}

/// Smallest standard deviation that is told from rounding, in the patch's unit.
const ROUNDING: f64 = 1e-12;
/// Heights that are found so much more exact than slopes (or the other way round) are fitted
/// exactly by chance: the variances are kept within this factor of each other.
const LARGEST_RATIO: f64 = 1e8;

impl Noise {
    /// Whether this tells all noise of a patch.
    pub(crate) fn is_all_of(&self, patch: &Patch) -> bool {
        self.position_std.is_some() && (self.normal_std_rad.is_some() || !patch.has_normals())
    }

    /// This noise in the unit of a patch.
    ///
    /// # Errors
    /// [`Ep2Error::BadSetting`] unless each is finite and > 0.
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

/// A pair of values, one for the heights and one for the slopes, whose errors differ.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Kinds<T> {
    pub(crate) heights: T,
    pub(crate) slopes: T,
}

/// Variances of a height and of a slope on level ground, in the patch's unit.
pub(crate) type Variances = Kinds<f64>;

impl Variances {
    /// Variances to start from, before anything is known.
    pub(crate) const START: Self = Self {
        heights: 1.0,
        slopes: 1.0,
    };

    /// The variances that explain weighted sums of squared residuals, of which the fit has taken
    /// up so many unknowns; what is known stays. `bending` is the mean square of the slope's
    /// change per length: on a curved surface an error of the place is one of the slope.
    ///
    /// Returns whether they could be told: one residual must be left.
    pub(crate) fn update(
        &mut self,
        known: &Noise,
        bending: f64,
        patch: &Patch,
        residuals: &Kinds<f64>,
        taken: &Kinds<f64>,
    ) -> bool {
        let floor = ROUNDING * ROUNDING;
        let contacts = patch.samples.len() as f64;
        let left = Kinds {
            heights: contacts - taken.heights,
            slopes: 2.0 * contacts - taken.slopes,
        };
        let mut told = true;
        match known.position_std {
            Some(std) => self.heights = (std * std).max(floor),
            None if left.heights >= 1.0 => {
                self.heights = (residuals.heights / left.heights).max(floor);
            }
            None => told = false,
        }
        if patch.has_normals() {
            match known.normal_std_rad {
                Some(std) => self.slopes = (std * std + bending * self.heights).max(floor),
                None if left.slopes >= 1.0 => {
                    self.slopes = (residuals.slopes / left.slopes).max(floor);
                }
                None => told = false,
            }
            let (heights, slopes) = (self.heights, self.slopes);
            if known.position_std.is_none() {
                self.heights = heights.max(slopes / LARGEST_RATIO);
            }
            if known.normal_std_rad.is_none() {
                self.slopes = slopes.max(heights / LARGEST_RATIO);
            }
        }
        told
    }

    /// The smallest factor by which residuals may shrink the variances: what is left is rounding.
    pub(crate) fn least_scale(&self) -> f64 {
        ROUNDING * ROUNDING / self.heights
    }

    /// Standard deviations in the unit of the world, from these variances.
    pub(crate) fn estimate(&self, patch: &Patch) -> NoiseEstimate {
        NoiseEstimate {
            position_std: self.heights.sqrt() * patch.frame.scale(),
            normal_std_rad: patch.has_normals().then(|| self.slopes.sqrt()),
        }
    }
}
