//! Mean of magnitudes, mergeable.

use serde::{Deserialize, Serialize};

use crate::scale::{exponent, power_of_two, sum};

/// Count and sum of the magnitudes of some finite numbers, in units of 2^exponent so that the sum cannot overflow.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Serialize)]
pub(crate) struct MeanMagnitude {
    count: u64,
    exponent: i32,
    sum: f64,
}

impl MeanMagnitude {
    /// Mean magnitude of finite `values`, none of which is larger in magnitude than `largest`, and whose magnitudes add up
    /// to `plain`, which may be beyond the floats.
    pub(crate) fn of(values: &[f64], largest: f64, plain: f64) -> MeanMagnitude {
        let exponent = exponent(largest);
        let per_unit = power_of_two(-exponent);
        MeanMagnitude {
            count: values.len() as u64,
            exponent,
            sum: match exponent {
                0 => plain,
                _ => sum(values, |x| x.abs() * per_unit),
            },
        }
    }

    /// Adds the numbers of `other`, which come after those summed so far.
    pub(crate) fn merge(&mut self, other: &MeanMagnitude) {
        let exponent = self.exponent.max(other.exponent);
        let in_new_units = |mean: &MeanMagnitude| mean.sum * power_of_two(mean.exponent - exponent);
        self.sum = in_new_units(self) + in_new_units(other);
        self.count += other.count;
        self.exponent = exponent;
    }

    /// Number of values summed.
    pub(crate) fn count(&self) -> u64 {
        self.count
    }

    /// Mean magnitude; `None` without values.
    pub(crate) fn mean(&self) -> Option<f64> {
        let mean = self.sum / self.count as f64 * power_of_two(self.exponent);
        (self.count > 0).then_some(mean)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn of(values: &[f64]) -> MeanMagnitude {
        MeanMagnitude::of(
            values,
            values.iter().fold(0.0, |largest, x| largest.max(x.abs())),
            sum(values, f64::abs),
        )
    }

    #[test]
    fn the_mean_of_an_alternating_sequence_is_that_of_its_magnitudes() {
        let values: Vec<f64> = (1..=1025)
            .map(|i| f64::from(if i % 2 == 0 { i } else { -i }))
            .collect();
        assert_relative_eq!(of(&values).mean().unwrap(), 513.0, max_relative = 1e-15);

        let mut merged = MeanMagnitude::default();
        values.chunks(10).for_each(|part| merged.merge(&of(part)));
        assert_eq!(merged.count(), 1025);
        assert_relative_eq!(merged.mean().unwrap(), 513.0, max_relative = 1e-15);
    }

    #[test]
    fn sums_beyond_the_floats_have_a_mean() {
        let mut mean = of(&[1e308; 100]);
        mean.merge(&of(&[-1e308; 100]));
        assert_relative_eq!(mean.mean().unwrap(), 1e308, max_relative = 1e-14);
        let mut tiny = of(&[5e-324]);
        assert_eq!(tiny.mean(), Some(5e-324));
        tiny.merge(&of(&[0.0, -0.0, -1e-300]));
        assert_relative_eq!(tiny.mean().unwrap(), 0.25e-300, max_relative = 1e-15);
    }

    #[test]
    fn nothing_has_no_mean() {
        assert_eq!(of(&[]).mean(), None);
    }
}
