//! Range of values that a search explores, and positions of values in this range.

/// A range of a field's values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span {
    /// Smallest value of the field in the range.
    pub(crate) from: f64,
    /// Largest value of the field in the range.
    pub(crate) to: f64,
    /// Whether the values that are tested in the range are spaced evenly on a logarithmic scale. This is the case if
    /// both ends are positive and their ratio exceeds 8.
    pub(crate) is_log: bool,
    /// Whether all values of the range must be whole numbers.
    pub(crate) is_whole: bool,
}

/// Values are spaced logarithmically if the ratio of the two ends of the range exceeds this number.
const MIN_LOG_RATIO: f64 = 8.0;
/// Approximate ratio of the allowed gap to the step to which tested values are rounded. The allowed gap is the largest
/// gap that may remain between a value that meets the target and a value that misses it.
const STEPS_PER_GAP: f64 = 8.0;

impl Span {
    /// The range from `from` to `to`, which must be finite with `from` ≤ `to`. If `is_whole` is true, the range
    /// contains only whole numbers.
    pub(crate) fn new(from: f64, to: f64, is_whole: bool) -> Self {
        Self {
            from,
            to,
            is_log: from > 0.0 && to / from > MIN_LOG_RATIO,
            is_whole,
        }
    }

    /// Relative distance between two values, where `low` ≤ `high`. On a logarithmic range, the distance is divided by
    /// `low`; otherwise, it is divided by half the width of the range.
    pub(crate) fn gap(&self, low: f64, high: f64) -> f64 {
        let gap = match self.is_log {
            true => high / low - 1.0,
            false => 2.0 * (high - low) / (self.to - self.from),
        };
        if gap.is_nan() { 0.0 } else { gap }
    }

    /// Position of a value in the range, from 0 (lower end) to 1 (upper end). On a logarithmic range, the position
    /// depends linearly on the logarithm of the value.
    pub(super) fn share(&self, value: f64) -> f64 {
        let share = match self.is_log {
            true => libm::log(value / self.from) / libm::log(self.to / self.from),
            // Halve the numbers first: the difference of two large numbers may overflow, but the difference of their
            // halves does not.
            false => (0.5 * value - 0.5 * self.from) / (0.5 * self.to - 0.5 * self.from),
        };
        if share.is_nan() {
            0.0
        } else {
            share.clamp(0.0, 1.0)
        }
    }

    /// Value at the position `share` in the range, from 0 (lower end) to 1 (upper end). The value is rounded to a step
    /// that is small compared with a gap of size `gap`.
    pub(super) fn at(&self, share: f64, gap: f64) -> f64 {
        let mix = |a: f64, b: f64| a * (1.0 - share) + b * share;
        let value = match self.is_log {
            true => libm::exp(mix(libm::log(self.from), libm::log(self.to))),
            false => mix(self.from, self.to),
        };
        if self.is_whole {
            return value.round().min(self.to.floor()).max(self.from.ceil());
        }
        let size = match self.is_log {
            true => gap * value,
            false => gap * (0.5 * self.to - 0.5 * self.from),
        };
        rounded(value, size / STEPS_PER_GAP).clamp(self.from, self.to)
    }

    /// Returns `count` values that are spread evenly over the range, including both ends. The values between the ends
    /// are rounded; the rounding step is at most an eighth of a gap of size `gap`.
    ///
    /// If only whole numbers are allowed, the values are rounded to whole numbers. A range that contains at most
    /// `2 * count` whole numbers returns all of them, and a range that contains none returns an empty list.
    pub(crate) fn spread(&self, count: usize, gap: f64) -> Vec<f64> {
        let (first, last) = (self.from.ceil(), self.to.floor());
        if self.is_whole && first > last {
            return Vec::new();
        }
        if self.is_whole && last - first < 2.0 * count as f64 {
            let steps = 0..=(last - first) as usize;
            return steps.map(|step| first + step as f64).collect();
        }
        let last = count.max(2) - 1;
        let mut values: Vec<f64> = (0..=last)
            .map(|step| match step {
                0 if !self.is_whole => self.from,
                step if step == last && !self.is_whole => self.to,
                step => self.at(step as f64 / last as f64, gap),
            })
            .collect();
        values.dedup();
        values
    }

    /// A rounded value in the middle between `low` and `high`. The rounding step is small compared with a gap of size
    /// `gap`. `None` if no rounded value lies between `low` and `high`.
    pub(crate) fn between(&self, low: f64, high: f64, gap: f64) -> Option<f64> {
        let middle = 0.5 * self.share(low) + 0.5 * self.share(high);
        Some(self.at(middle, gap)).filter(|value| low < *value && *value < high)
    }
}

/// Rounds `value` to a multiple of a power of ten. The power is the largest one that is not larger than `step`.
fn rounded(value: f64, step: f64) -> f64 {
    let place = |number: f64| {
        let text = format!("{:e}", number.abs());
        let exponent = text
            .split_once('e')
            .map(|(_, exponent)| exponent.parse::<i32>());
        exponent.and_then(Result::ok).unwrap_or(0)
    };
    if value == 0.0 || !(step > 0.0 && step.is_finite()) {
        return value;
    }
    match usize::try_from(place(value) - place(step)) {
        Ok(digits) => format!("{value:.digits$e}").parse().unwrap_or(value),
        Err(_) => 0.0,
    }
}
