//! Observations of trials, kept until a block of trials is summed up.

use crate::column::Column;
use crate::failures::{NEGATIVE_STD, NOT_FINITE, UNKNOWN_QUANTITY};
use crate::observation::{Observation, Observations};

/// Collector of the observations of trials, handed to each [`Trial`](crate::Trial).
#[derive(Debug, Default)]
pub struct Record {
    columns: Vec<Column>,
    rejection: Option<&'static str>,
}

impl Record {
    /// Records an observation of a quantity in `0..Trial::quantities()`; any number of each in a trial.
    ///
    /// An observation whose error or standard deviation is not a finite number fails the trial as [`NOT_FINITE`], a
    /// negative standard deviation as [`NEGATIVE_STD`], a quantity out of range as [`UNKNOWN_QUANTITY`].
    ///
    /// ```
    /// use palpate_sweep::{Cell, NOT_FINITE, Observation, Record, RunOptions, Trial, run};
    ///
    /// struct Overflow;
    /// impl Trial for Overflow {
    ///     fn quantities(&self) -> usize { 1 }
    ///     fn run(&self, _trial: u64, record: &mut Record) -> Result<(), &'static str> {
    ///         let estimate = f64::INFINITY;
    ///         record.observe(0, Observation { estimate, truth: 1.0, std: None, interval_holds: None });
    ///         Ok(())
    ///     }
    /// }
    /// let statistics = run(&[Cell { trials: 5, trial: &Overflow }], &RunOptions::default(), &|_| ())?;
    /// assert_eq!(statistics[0].quantities[0].observations, 0);
    /// assert_eq!((statistics[0].failures[0].kind, statistics[0].failures[0].count), (NOT_FINITE, 5));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline]
    pub fn observe(&mut self, quantity: usize, observation: Observation) {
        match self.columns.get_mut(quantity) {
            Some(column) if observation.is_sound() => column.push(&observation),
            column => self.rejection = Some(rejection(column.is_some(), &observation)),
        }
    }

    /// Records one observation of each of the first `N` quantities, as [`Record::observe`] would.
    #[inline]
    pub fn observe_each<const N: usize>(&mut self, observations: [Observation; N]) {
        // A sum is finite only if all its terms are: one test for what nearly always holds.
        let (mut sum, mut lowest) = (0.0, 0.0);
        for observation in &observations {
            let std = observation.std.unwrap_or(0.0);
            sum += (observation.estimate - observation.truth).abs() + std;
            lowest = if std < lowest { std } else { lowest };
        }
        match self.columns.get_mut(..N) {
            Some(columns) if sum < f64::INFINITY && lowest == 0.0 => {
                for (column, observation) in columns.iter_mut().zip(&observations) {
                    column.push(observation);
                }
            }
            _ => {
                for (quantity, observation) in observations.into_iter().enumerate() {
                    self.observe(quantity, observation);
                }
            }
        }
    }

    /// Records what trials that ran together and succeeded say of the first `Q` quantities: one observation of each in
    /// every trial.
    ///
    /// Returns how many of the first trials were recorded: those before the first that [`Record::observe`] would fail,
    /// or that some quantity lacks.
    pub fn observe_together<const Q: usize>(
        &mut self,
        observations: &[Observations<'_>; Q],
    ) -> usize {
        let Some(columns) = self.columns.get_mut(..Q) else {
            return 0;
        };
        let told = observations.iter().map(Observations::len).min();
        let sound = |count, observations: &Observations<'_>| observations.sound(count);
        let count = observations.iter().fold(told.unwrap_or(0), sound);
        for (column, observations) in columns.iter_mut().zip(observations) {
            column.extend(observations, count);
        }
        self.columns.iter_mut().for_each(Column::keep_each);
        count
    }

    /// Prepares for a block of trials that observe `quantities` quantities; the observations of the block before must
    /// have been cleared.
    pub(crate) fn set_quantities(&mut self, quantities: usize) {
        self.columns.resize_with(quantities, Column::default);
    }

    /// Runs one trial and keeps its observations if it succeeds. Of a failed one nothing remains but the kind of
    /// failure.
    #[inline]
    pub(crate) fn take(
        &mut self,
        run: impl FnOnce(&mut Record) -> Result<(), &'static str>,
    ) -> Result<(), &'static str> {
        match (run(self), self.rejection) {
            (Ok(()), None) => {
                self.columns.iter_mut().for_each(Column::keep);
                Ok(())
            }
            (result, rejection) => Err(self.forget_trial(result.err().or(rejection))),
        }
    }

    #[cold]
    fn forget_trial(&mut self, kind: Option<&'static str>) -> &'static str {
        self.rejection = None;
        self.columns.iter_mut().for_each(Column::forget);
        kind.unwrap_or(NOT_FINITE)
    }

    /// Number of observations of each quantity.
    pub(crate) fn lengths(&self) -> Vec<usize> {
        self.columns.iter().map(Column::len).collect()
    }

    /// Kind of failure of the trial that runs, if it recorded what cannot be.
    pub(crate) fn rejected(&self) -> Option<&'static str> {
        self.rejection
    }

    /// The observations of each quantity.
    pub(crate) fn columns(&mut self) -> &mut [Column] {
        &mut self.columns
    }
}

#[cold]
fn rejection(known_quantity: bool, observation: &Observation) -> &'static str {
    let finite_error = (observation.estimate - observation.truth).is_finite();
    if !known_quantity {
        UNKNOWN_QUANTITY
    } else if finite_error
        && observation
            .std
            .is_some_and(|std| std < 0.0 && std.is_finite())
    {
        NEGATIVE_STD
    } else {
        NOT_FINITE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(quantities: usize) -> Record {
        let mut record = Record::default();
        record.set_quantities(quantities);
        record
    }

    fn lengths(record: &mut Record) -> Vec<usize> {
        record.columns().iter().map(Column::len).collect()
    }

    fn observation(estimate: f64, truth: f64, std: Option<f64>) -> Observation {
        Observation {
            estimate,
            truth,
            std,
            interval_holds: None,
        }
    }

    #[test]
    fn a_failed_trial_leaves_nothing_and_does_not_fail_the_next() {
        let mut record = record(2);
        let good = observation(1.0, 1.0, None);
        let once = record.take(|record| {
            record.observe(0, good);
            record.observe(0, good);
            record.observe(1, good);
            Ok(())
        });
        assert_eq!(once, Ok(()));
        let failed = record.take(|record| {
            record.observe(1, good);
            record.observe(0, good);
            record.observe_each([good, good]);
            record.observe(0, observation(f64::NAN, 1.0, None));
            Err("rank")
        });
        assert_eq!(failed, Err("rank"));
        assert_eq!(lengths(&mut record), [2, 1]);
        assert_eq!(record.take(|_| Ok(())), Ok(()));
    }

    #[test]
    fn each_is_one_after_the_other() {
        let (first, second) = (
            observation(1.0, 2.0, None),
            Observation {
                interval_holds: Some([true; 3]),
                ..observation(3.0, 4.0, Some(0.5))
            },
        );
        let (mut each, mut one_by_one) = (record(3), record(3));
        each.observe_each([first, second]);
        one_by_one.observe(0, first);
        one_by_one.observe(1, second);
        assert_eq!(each.columns(), one_by_one.columns());
    }

    #[test]
    fn together_is_one_after_the_other_up_to_what_is_unsound() {
        let together = |estimates, stds| Observations {
            estimates,
            truth: 2.0,
            stds,
        };
        let good = together(&[1.0, 3.0], Some(&[0.5, 0.0]));
        let (mut at_once, mut one_by_one) = (record(3), record(3));
        assert_eq!(
            at_once.observe_together(&[good, together(&[5.0, 6.0], None)]),
            2
        );
        for (first, std, second) in [(1.0, 0.5, 5.0), (3.0, 0.0, 6.0)] {
            let observations = [
                observation(first, 2.0, Some(std)),
                observation(second, 2.0, None),
            ];
            let result = one_by_one.take(|record| {
                record.observe_each(observations);
                Ok(())
            });
            assert_eq!(result, Ok(()));
        }
        assert_eq!(at_once.columns(), one_by_one.columns());

        for (unsound, count) in [
            (together(&[1.0, f64::NAN], None), 1),
            (together(&[f64::INFINITY, 1.0], None), 0),
            (together(&[1.0, 1.0], Some(&[0.0, -1e-300])), 1),
            (together(&[1.0, 1.0], Some(&[f64::NAN, 0.0])), 0),
            (together(&[1.0, 1.0], Some(&[0.0, f64::INFINITY])), 1),
            (together(&[1.0], None), 1),
            (together(&[1.0, 2.0], Some(&[])), 0),
        ] {
            let mut record = record(2);
            assert_eq!(
                record.observe_together(&[good, unsound]),
                count,
                "{unsound:?}"
            );
            assert_eq!(lengths(&mut record), [count; 2]);
        }
        assert_eq!(at_once.observe_together(&[good; 4]), 0, "unknown quantity");
        assert_eq!(at_once.observe_together(&[]), 0);
        assert_eq!(at_once.columns(), one_by_one.columns());
    }

    #[test]
    fn unsound_observations_fail_the_trial_by_kind() {
        for (quantity, observation, kind) in [
            (0, observation(f64::NAN, 0.0, None), NOT_FINITE),
            (0, observation(0.0, f64::INFINITY, None), NOT_FINITE),
            (
                0,
                observation(f64::INFINITY, f64::INFINITY, None),
                NOT_FINITE,
            ),
            (0, observation(1.5e308, -1.5e308, None), NOT_FINITE),
            (0, observation(0.0, 0.0, Some(f64::NAN)), NOT_FINITE),
            (0, observation(0.0, 0.0, Some(f64::INFINITY)), NOT_FINITE),
            (
                0,
                observation(0.0, 0.0, Some(f64::NEG_INFINITY)),
                NOT_FINITE,
            ),
            (0, observation(0.0, 0.0, Some(-1e-300)), NEGATIVE_STD),
            (1, observation(0.0, 0.0, None), UNKNOWN_QUANTITY),
        ] {
            let mut record = record(1);
            let result = record.take(|record| {
                record.observe(quantity, observation);
                Ok(())
            });
            assert_eq!(result, Err(kind), "{observation:?}");
            assert_eq!(lengths(&mut record), [0]);

            let mut record = self::record(1);
            let good = self::observation(0.0, 0.0, None);
            let result = record.take(|record| {
                match quantity {
                    0 => record.observe_each([observation]),
                    _ => record.observe_each([good, observation]),
                }
                Ok(())
            });
            assert_eq!(result, Err(kind), "{observation:?}");
            assert_eq!(lengths(&mut record), [0]);
        }
    }
}
