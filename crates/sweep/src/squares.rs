//! Sums of the squared errors of each trial, from which the standard error of an rms error is computed.

use crate::moments::{exponent, is_ordinary, largest, power_of_two, sum};

/// Means and scatter, over the trials, of two numbers: the number of observations of a trial, and the sum of the
/// squared errors of these observations.
///
/// The observations of one trial are not independent, so the standard error of a mean square is computed from the
/// scatter between trials. If the fourth powers of errors would overflow or underflow, errors are stored in units of a
/// power of two.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct TrialSquares {
    /// Number of trials that made an observation.
    trials: u64,
    /// Exponent of the unit 2^exponent in which errors are stored.
    exponent: i32,
    /// Mean over the trials of the sum of squared errors.
    square: f64,
    /// Mean over the trials of the number of observations.
    count: f64,
    /// Sum of a² over the trials. Here a is the deviation of a trial's sum of squared errors from the mean `square`.
    /// `square_count` is the sum of a·b, and `count_count` is the sum of b², where b is the deviation of a trial's
    /// number of observations from the mean `count`.
    square_square: f64,
    square_count: f64,
    count_count: f64,
}

impl TrialSquares {
    /// Sums for observations that are each from a different trial. The errors must be finite. `plain` contains two sums
    /// over the observations: the sum of (error² − first error²), and the sum of the squares of these differences.
    pub(crate) fn of_each(errors: &[f64], plain: [f64; 2]) -> Self {
        let Some(&first) = errors.first() else {
            return Self::default();
        };
        let exponent = match is_ordinary(plain[1]) {
            true => 0,
            false => exponent(largest(errors)),
        };
        let per_unit = power_of_two(-exponent);
        let origin = (first * per_unit) * (first * per_unit);
        let difference = |error: f64| (error * per_unit) * (error * per_unit) - origin;
        let [differences, fourths] = match is_ordinary(plain[1]) {
            true => plain,
            false => [
                sum(errors, difference),
                sum(errors, |error| difference(error) * difference(error)),
            ],
        };
        let mean = differences / errors.len() as f64;
        Self {
            trials: errors.len() as u64,
            exponent,
            square: origin + mean,
            count: 1.0,
            square_square: (fourths - differences * mean).max(0.0),
            ..Self::default()
        }
    }

    /// Sums for a single trial with `count` observations and the root mean square error `rms`.
    pub(crate) fn of_trial(count: u64, rms: f64) -> Self {
        let exponent = exponent(rms);
        let rms = rms * power_of_two(-exponent);
        let count = count as f64;
        Self {
            trials: 1,
            exponent,
            square: rms * rms * count,
            count,
            ..Self::default()
        }
    }

    pub(crate) fn merge(&mut self, other: &Self) {
        if other.trials == 0 {
            return;
        }
        if self.trials == 0 {
            *self = *other;
            return;
        }
        let mut other = *other;
        let exponent = self.exponent.max(other.exponent);
        self.rescale(exponent);
        other.rescale(exponent);

        let trials = self.trials + other.trials;
        let share = other.trials as f64 / trials as f64;
        let weight = share * self.trials as f64;
        let (square, count) = (other.square - self.square, other.count - self.count);
        self.square += square * share;
        self.count += count * share;
        self.square_square += other.square_square + square * square * weight;
        self.square_count += other.square_count + square * count * weight;
        self.count_count += other.count_count + count * count * weight;
        self.trials = trials;
    }

    /// Changes the unit to 2^exponent, which must not be smaller than the current unit.
    fn rescale(&mut self, exponent: i32) {
        let factor = power_of_two(self.exponent - exponent);
        let squared = factor * factor;
        self.exponent = exponent;
        self.square *= squared;
        self.square_square *= squared * squared;
        self.square_count *= squared;
    }

    /// Standard error of the rms error, to first order; `None` for fewer than two trials. The mean square error is the
    /// mean sum of squared errors of a trial, divided by the mean number of observations of a trial. So the formula for
    /// the standard error of a ratio of two means is used.
    pub(crate) fn std_of_rms(&self) -> Option<f64> {
        let freedom = self.trials.checked_sub(1).filter(|&freedom| freedom > 0)?;
        let mean_square = self.square / self.count;
        if mean_square == 0.0 {
            return Some(0.0);
        }
        let scatter = self.square_square - 2.0 * mean_square * self.square_count
            + mean_square * mean_square * self.count_count;
        let variance = scatter.max(0.0) / (freedom as f64 * self.trials as f64);
        let of_mean_square = variance.sqrt() / self.count;
        Some(of_mean_square / (2.0 * mean_square.sqrt()) * power_of_two(self.exponent))
    }
}
