//! Squared errors by trial, from which follows how exact an rms error is.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::scale::{exponent_of_squares, power_of_two, sum};

/// Means and scatter of the number of observations of a trial and of the sum of their squared errors.
///
/// The observations of one trial are not independent, so that a mean of squares is as exact as its trials differ, however
/// many observations each has. Squares are in units of a power of two where their squares would overflow or vanish.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Serialize)]
pub(crate) struct TrialSquares {
    /// Trials that made an observation.
    trials: u64,
    /// Exponent of the unit 2^exponent of errors.
    exponent: i32,
    /// Mean sum of squared errors of a trial.
    square: f64,
    /// Mean number of observations of a trial.
    count: f64,
    /// Sums over trials of the products of the differences to these means.
    square_square: f64,
    square_count: f64,
    count_count: f64,
}

impl TrialSquares {
    /// Squares of finite errors of which each is of a trial of its own, none larger in magnitude than `largest`. `plain`
    /// are the sums of the differences of the squares to that of the first, and of their squares, which may be beyond the
    /// floats.
    pub(crate) fn of_each(errors: &[f64], largest: f64, plain: [f64; 2]) -> Self {
        let Some(&first) = errors.first() else {
            return Self::default();
        };
        let exponent = exponent_of_squares(largest);
        let per_unit = power_of_two(-exponent);
        let origin = (first * per_unit) * (first * per_unit);
        let [differences, fourths] = match exponent {
            0 => plain,
            _ => {
                let difference = |error: f64| (error * per_unit) * (error * per_unit) - origin;
                [
                    sum(errors, difference),
                    sum(errors, |error| difference(error) * difference(error)),
                ]
            }
        };
        let trials = errors.len() as f64;
        let mean = differences / trials;
        Self {
            trials: errors.len() as u64,
            exponent,
            square: origin + mean,
            count: 1.0,
            square_square: (fourths - differences * mean).max(0.0),
            square_count: 0.0,
            count_count: 0.0,
        }
    }

    /// Squares of finite errors of which those at the places `several` are of one trial each, the others of a trial of
    /// their own.
    pub(crate) fn of(errors: &[f64], several: &[Range<usize>]) -> Self {
        let largest = errors
            .iter()
            .fold(0.0, |most: f64, error| most.max(error.abs()));
        let exponent = exponent_of_squares(largest);
        let per_unit = power_of_two(-exponent);
        let mut squares = Self {
            exponent,
            ..Self::default()
        };
        let mut add = |errors: &[f64]| {
            squares.merge(&Self {
                trials: 1,
                exponent,
                square: sum(errors, |error| (error * per_unit) * (error * per_unit)),
                count: errors.len() as f64,
                ..Self::default()
            });
        };
        let mut at = 0;
        for places in several {
            errors[at..places.start].chunks(1).for_each(&mut add);
            add(&errors[places.clone()]);
            at = places.end;
        }
        errors[at..].chunks(1).for_each(add);
        squares
    }

    /// Adds the trials of `other`, which come after those summed so far.
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

    /// Changes the unit to 2^exponent, which must be no smaller than the present one.
    fn rescale(&mut self, exponent: i32) {
        let factor = power_of_two(self.exponent - exponent);
        let squared = factor * factor;
        self.exponent = exponent;
        self.square *= squared;
        self.square_square *= squared * squared;
        self.square_count *= squared;
    }

    /// Standard deviation of the root of the mean square, to first order (that of a ratio of two means); `None` of fewer
    /// than two trials.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::moments::Moments;
    use approx::assert_relative_eq;

    fn each(errors: &[f64]) -> TrialSquares {
        Moments::with_magnitude(errors).2
    }

    #[test]
    fn squares_of_zeros_and_ones_are_binomial() {
        // 3 of 12 are 1: the mean square is 1/4, its variance p (1 − p)/(n − 1).
        let errors: Vec<f64> = (0..12).map(|i| f64::from(u8::from(i % 4 == 1))).collect();
        let std = (0.25f64 * 0.75 / 11.0).sqrt() / (2.0 * 0.5);
        assert_relative_eq!(
            each(&errors).std_of_rms().unwrap(),
            std,
            max_relative = 1e-14
        );
        for exponent in [-990, -300, 300, 990] {
            let unit = 2f64.powi(exponent);
            let scaled: Vec<f64> = errors.iter().map(|error| error * unit).collect();
            let found = each(&scaled).std_of_rms().unwrap();
            assert_relative_eq!(found, std * unit, max_relative = 1e-14);
            let pairs: Vec<_> = (0..6).map(|pair| 2 * pair..2 * pair + 2).collect();
            let [scaled, plain] = [&scaled, &errors].map(|it| TrialSquares::of(it, &pairs));
            let plain = plain.std_of_rms().unwrap();
            assert_relative_eq!(
                scaled.std_of_rms().unwrap(),
                plain * unit,
                max_relative = 1e-14
            );
        }
    }

    #[test]
    fn a_trial_counts_once_however_many_observations_it_has() {
        let errors = [0.3, -1.0, 2.0, 0.7, -0.2];
        let thrice: Vec<f64> = errors.iter().flat_map(|&error| [error; 3]).collect();
        let places: Vec<_> = (0..errors.len()).map(|at| 3 * at..3 * at + 3).collect();
        let once = each(&errors).std_of_rms().unwrap();
        let together = TrialSquares::of(&thrice, &places).std_of_rms().unwrap();
        assert_relative_eq!(together, once, max_relative = 1e-14);
        assert!(each(&thrice).std_of_rms().unwrap() < 0.6 * once);
        // Of trials that differ in nothing but how much they observe, the mean square is exact.
        let alike = TrialSquares::of(&[2.0; 9], &[1..4, 5..9]);
        assert!(alike.std_of_rms().unwrap() < 1e-15, "{alike:?}");
    }

    #[test]
    fn parts_are_the_whole() {
        let errors: Vec<f64> = (0..60).map(|i| f64::from(i * i % 37) / 7.0 - 2.0).collect();
        let whole = each(&errors).std_of_rms().unwrap();
        for cut in [0, 1, 8, 59, 60] {
            let (left, right) = errors.split_at(cut);
            let mut merged = each(left);
            merged.merge(&each(right));
            assert_relative_eq!(merged.std_of_rms().unwrap(), whole, max_relative = 1e-13);
        }
        assert_relative_eq!(
            TrialSquares::of(&errors, &[]).std_of_rms().unwrap(),
            whole,
            max_relative = 1e-13
        );
    }

    #[test]
    fn few_or_equal_errors_have_their_bounds() {
        assert_eq!(each(&[]).std_of_rms(), None);
        assert_eq!(each(&[3.0]).std_of_rms(), None);
        let both = std::slice::from_ref(&(0..2));
        assert_eq!(TrialSquares::of(&[3.0, 4.0], both).std_of_rms(), None);
        for errors in [[0.0; 9], [1e-300; 9], [0.1; 9], [f64::MAX; 9]] {
            assert_eq!(each(&errors).std_of_rms(), Some(0.0));
        }
    }
}
