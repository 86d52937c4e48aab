//! Sums over trials, from which the spread of squared errors follows.

use crate::alone::alone;
use crate::record::Record;
use crate::trial::Trial;

/// Sums over the successful trials of one part of a pilot.
#[derive(Clone, Debug, Default)]
pub(super) struct Part {
    pub(super) successes: u64,
    pub(super) quantities: Vec<Spread>,
    /// Number of observations and sum of squared errors of each quantity in the running trial.
    trial: Vec<(f64, f64)>,
}

/// Sums over trials of n, the observations of a quantity in a trial, and s, the sum of their squared errors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Spread {
    /// Number of trials, including those without an observation of the quantity.
    pub(super) trials: f64,
    /// Σ n, Σ s, Σ n², Σ n s, Σ s².
    n: f64,
    s: f64,
    nn: f64,
    ns: f64,
    ss: f64,
}

impl Part {
    pub(super) fn of(quantities: usize) -> Self {
        Self {
            successes: 0,
            quantities: vec![Spread::default(); quantities],
            trial: Vec::with_capacity(quantities),
        }
    }

    /// Runs a trial and adds its observations, errors in units of `scales`, unless it fails.
    pub(super) fn add_trial(
        &mut self,
        trial: &dyn Trial,
        number: u64,
        scales: &[f64],
        record: &mut Record,
    ) {
        let sums = &mut self.trial;
        let done = alone(record, trial, number, |columns| {
            sums.clear();
            sums.extend(columns.iter().zip(scales).map(|(column, scale)| {
                column
                    .pairs()
                    .fold((0.0, 0.0), |(n, s), (estimate, truth)| {
                        let error = (estimate - truth) / scale;
                        (n + 1.0, s + error * error)
                    })
            }));
        });
        if done.is_err() || sums.iter().any(|(_, s)| !(s * s).is_finite()) {
            return;
        }
        self.successes += 1;
        for (spread, &(n, s)) in self.quantities.iter_mut().zip(&self.trial) {
            *spread = spread.plus(&Spread {
                trials: 0.0,
                n,
                s,
                nn: n * n,
                ns: n * s,
                ss: s * s,
            });
        }
    }
}

impl Spread {
    /// Replaces the number of trials by `trials`.
    pub(super) fn over(self, trials: u64) -> Self {
        Self {
            trials: trials as f64,
            ..self
        }
    }

    pub(super) fn plus(&self, other: &Self) -> Self {
        Self {
            trials: self.trials + other.trials,
            n: self.n + other.n,
            s: self.s + other.s,
            nn: self.nn + other.nn,
            ns: self.ns + other.ns,
            ss: self.ss + other.ss,
        }
    }

    /// Mean squared error; `None` without observations.
    pub(super) fn mean_square(&self) -> Option<f64> {
        (self.n > 0.0).then(|| self.s / self.n)
    }

    /// Variance of √N times the mean squared error over N trials, relative to the square of that mean; to first order
    /// in 1/N, with n and s correlated. `None` where no estimate errs.
    pub(super) fn relative_variance(&self) -> Option<f64> {
        let mean = self.mean_square()?;
        let squares = self.ss - 2.0 * mean * self.ns + mean * mean * self.nn;
        let variance = self.trials * squares / (self.s * self.s);
        (self.s > 0.0 && variance.is_finite()).then(|| variance.max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A trial with these errors.
    fn trial(errors: &[f64]) -> Spread {
        let n = errors.len() as f64;
        let s: f64 = errors.iter().map(|error| error * error).sum();
        Spread {
            trials: 1.0,
            n,
            s,
            nn: n * n,
            ns: n * s,
            ss: s * s,
        }
    }

    fn all(trials: &[&[f64]]) -> Spread {
        let spreads = trials.iter().map(|errors| trial(errors));
        spreads.fold(Spread::default(), |all, one| all.plus(&one))
    }

    #[test]
    fn one_error_per_trial_gives_the_kurtosis() {
        // m2 = (1 + 1 + 9 + 9)/4 = 5, m4 = (1 + 1 + 81 + 81)/4 = 41: 41/25 − 1.
        let spread = all(&[&[1.0], &[-1.0], &[3.0], &[-3.0]]);
        assert_eq!(spread.mean_square(), Some(5.0));
        let variance = spread.relative_variance().unwrap_or_default();
        assert!((variance - 0.64).abs() < 1e-15);
    }

    #[test]
    fn errors_of_one_trial_go_together() {
        let alone = all(&[&[1.0], &[3.0]]);
        let together = all(&[&[1.0; 9], &[3.0; 9]]);
        assert_eq!(alone.relative_variance(), together.relative_variance());
    }

    #[test]
    fn a_trial_with_more_of_the_same_errors_adds_no_spread() {
        let spread = all(&[&[2.0], &[2.0, 2.0, 2.0]]);
        assert_eq!(spread.relative_variance(), Some(0.0));
    }

    #[test]
    fn nothing_errs() {
        assert_eq!(all(&[&[0.0], &[0.0]]).relative_variance(), None);
        assert_eq!(Spread::default().mean_square(), None);
    }
}
