//! Noise of a patch's contacts: stated or estimated.

use nalgebra::Vector3;
use palpate_statistics::evenly_spaced;

use crate::patch::FingerMap;
use crate::{Contact, Ep2Error, Patch, PatchFrame};

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

/// Largest number of contacts from which the steps of rounded coordinates are determined.
const MAX_CONTACTS: usize = 5000;
/// Coordinates count as equal if they differ by less than this share of their range.
const LEVEL_TOLERANCE: f64 = 1e-6;
/// A coordinate counts as rounded only if all differences between its values are multiples of one step. This constant is
/// the largest accepted deviation from a multiple, divided by the step.
const MAX_LEVEL_ERROR: f64 = 0.02;
/// The smallest difference between values of a rounded coordinate may be a multiple of the step. This constant is the
/// largest multiple that is tried.
const MAX_MULTIPLE: u8 = 10;
/// With at most this number of different values, all differences may be multiples of the step, because the values are
/// those of a few strokes.
const MAX_FEW_LEVELS: usize = 8;
/// Coordinates with more decimals do not count as rounded.
const MAX_DECIMALS: u8 = 9;
/// Largest difference of a coordinate from its rounded value, divided by the unit of its last decimal.
const MAX_DECIMAL_ERROR: f64 = 1e-3;
/// Contacts face one axis if the mean magnitude of their normals' components along this axis exceeds this value.
const MIN_FACING: f64 = 0.7;

/// Contacts with rounded coordinates are outliers only if their distance from the surface exceeds this multiple of the
/// step.
pub(crate) const MIN_OUTLIER_STEPS: f64 = 1.5;

/// How the coordinates of contacts are rounded.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Resolution {
    /// For each coordinate, the step between its values if they are rounded; otherwise 0.
    found: Vector3<f64>,
    /// For each coordinate, the unit of the last decimal of its values, such as 0.01 for two decimals; 0 if a value has
    /// more than [`MAX_DECIMALS`] decimals.
    pub(crate) decimals: Vector3<f64>,
}

impl Resolution {
    pub(crate) fn new<'a>(contacts: impl Iterator<Item = &'a Contact> + Clone) -> Self {
        Self {
            found: Vector3::from_fn(|axis, _| step(contacts.clone(), axis)),
            decimals: Vector3::from_fn(|axis, _| last_decimal(contacts.clone(), axis)),
        }
    }

    /// The resolution after all coordinates are divided by `unit`.
    pub(crate) fn in_unit(self, unit: f64) -> Self {
        Self {
            found: self.found / unit,
            decimals: self.decimals / unit,
        }
    }

    /// The steps that are assumed for contacts whose normals have components of the mean magnitudes `facing`. A
    /// coordinate along the surface may be commanded exactly, such as the spacing of strokes. Its values then seem to be
    /// rounded to large steps. Therefore the step of the coordinate that the contacts face is a limit for the others.
    pub(crate) fn steps(&self, facing: &Vector3<f64>) -> Vector3<f64> {
        let axis = facing.imax();
        let mut sorted: [f64; 3] = self.found.into();
        sorted.sort_unstable_by(f64::total_cmp);
        let limit = match facing[axis] > MIN_FACING {
            true => self.found[axis],
            false => sorted[1],
        };
        self.found.map(|step| step.min(limit))
    }
}

/// The unit of the last decimal of a coordinate, such as 0.01 for two decimals; 0 if a value has more than
/// [`MAX_DECIMALS`] decimals.
fn last_decimal<'a>(contacts: impl Iterator<Item = &'a Contact> + Clone, axis: usize) -> f64 {
    let is_multiple = |unit: &f64| {
        contacts.clone().all(|contact| {
            let number = contact.position[axis] / unit;
            (number - libm::round(number)).abs() < MAX_DECIMAL_ERROR
        })
    };
    let mut units = (0..=MAX_DECIMALS).map(|decimals| libm::pow(10.0, -f64::from(decimals)));
    units.find(is_multiple).unwrap_or(0.0)
}

/// The step whose multiples are the differences between the values of a rounded coordinate; 0 if the coordinate is not
/// rounded, or if all its values are equal.
fn step<'a>(contacts: impl Iterator<Item = &'a Contact> + Clone, axis: usize) -> f64 {
    let values = contacts.clone().map(|contact| contact.position[axis]);
    let values: Vec<f64> = values.collect();
    let selection = evenly_spaced(values.len(), MAX_CONTACTS);
    let mut levels: Vec<f64> = selection.map(|contact| values[contact]).collect();
    levels.sort_unstable_by(f64::total_cmp);
    let [Some(&low), Some(&high)] = [levels.first(), levels.last()] else {
        return 0.0;
    };
    levels.dedup_by(|one, other| (*one - *other).abs() <= LEVEL_TOLERANCE * (high - low));
    let differences = levels.windows(2).map(|pair| pair[1] - pair[0]);
    let least = differences.fold(f64::INFINITY, f64::min);
    let is_step = |step: &f64| {
        let mut numbers = levels.iter().map(|level| (level - low) / step);
        numbers.all(|number| (number - libm::round(number)).abs() < MAX_LEVEL_ERROR)
    };
    let steps = (1..=MAX_MULTIPLE).map(|multiple| least / f64::from(multiple));
    let Some(step) = steps.filter(|step| step.is_finite()).find(is_step) else {
        return 0.0;
    };
    // If the coordinate is constant along each stroke, it changes only between strokes. All these changes may be
    // multiples of a number larger than the true step, and `step` is then too large. So find this case, and reduce
    // `step` to a round number.
    let mut last: FingerMap<Option<f64>> = FingerMap::default();
    let [mut pairs, mut changes] = [0, 0];
    for contact in contacts {
        let value = contact.position[axis];
        if let Some(before) = last.entry(contact.finger).replace(value) {
            pairs += 1;
            changes += usize::from(libm::round((value - before) / step).abs() == 1.0);
        }
    }
    let are_strokes = 2 * pairs > values.len() && changes <= levels.len();
    match are_strokes && levels.len() <= MAX_FEW_LEVELS {
        true => round_step(step, low),
        false => step,
    }
}

/// The largest step of the form 1, 2.5 or 5 times a power of ten that divides both `difference` and `value`. Steps that
/// are far smaller than `difference` are not tried: if no larger step divides `value`, then `value` has an offset, and
/// the step must divide `difference` alone. The result is 0 if there is no such step.
fn round_step(difference: f64, value: f64) -> f64 {
    let power = libm::floor(libm::log10(difference)) as i32;
    let is_multiple = |value: f64, unit: f64| {
        let ratio = value.abs() / unit;
        (ratio - libm::round(ratio)).abs() < 1e-4 * ratio.max(1.0)
    };
    let find = |value: f64| {
        let numbers = (0..3).flat_map(|lower| {
            let unit = libm::pow(10.0, f64::from(power - lower));
            [5.0, 2.5, 1.0].map(|number| number * unit)
        });
        let is_step = |&unit: &f64| {
            unit < 1.01 * difference && is_multiple(difference, unit) && is_multiple(value, unit)
        };
        numbers.into_iter().find(is_step)
    };
    find(value).or_else(|| find(0.0)).unwrap_or(0.0)
}

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
