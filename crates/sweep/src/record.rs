//! Observations of trials, until a block of trials is summed up.

use std::ops::Range;

use crate::column::Column;
use crate::failures::{NEGATIVE_STD, NOT_FINITE, UNKNOWN_QUANTITY};
use crate::observation::{Observation, Observations};
use crate::trial::Trial;

/// Collector of the observations of trials, handed to each [`Trial`](crate::Trial).
#[derive(Debug, Default)]
pub struct Record {
    columns: Vec<Column>,
    rejection: Option<&'static str>,
}

/// Observations of one trial that succeeded.
#[derive(Debug)]
pub struct TrialObservations<'a> {
    columns: &'a [Column],
    /// Places of its observations in each column.
    places: Vec<Range<usize>>,
}

impl TrialObservations<'_> {
    /// Observations of a quantity, in the order of recording; empty if the quantity was not observed.
    pub fn of(&self, quantity: usize) -> impl Iterator<Item = Observation> {
        let column = self.columns.get(quantity).zip(self.places.get(quantity));
        let observations =
            |(column, places): (_, &Range<usize>)| Column::observations(column, places.clone());
        column.into_iter().flat_map(observations)
    }
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
        let count = observations.iter().map(Observations::len).min();
        let sound = |count, observations: &Observations<'_>| observations.sound(count);
        let count = observations.iter().fold(count.unwrap_or(0), sound);
        for (column, observations) in columns.iter_mut().zip(observations) {
            column.extend(observations, count);
            column.keep_each();
        }
        count
    }

    /// Prepares for trials that observe this many quantities. Earlier observations must have been summed up.
    pub(crate) fn set_quantities(&mut self, quantities: usize) {
        self.columns.resize_with(quantities, Column::default);
    }

    /// Result of the trial that ran. It is also an error if the trial recorded an impossible value.
    pub(crate) fn verdict(&mut self, result: Result<(), &'static str>) -> Result<(), &'static str> {
        let rejection = self.rejection.take();
        result.and_then(|()| rejection.map_or(Ok(()), Err))
    }

    /// Keeps the observations of the trial that ran.
    #[inline]
    pub(crate) fn keep(&mut self) {
        self.columns.iter_mut().for_each(Column::keep);
    }

    /// Drops the observations of the trial that ran.
    pub(crate) fn forget(&mut self) {
        self.columns.iter_mut().for_each(Column::forget);
    }

    /// Runs one trial, passes its observations to `show`, and drops them. The record is empty before and after.
    pub(crate) fn alone<T>(
        &mut self,
        trial: &dyn Trial,
        number: u64,
        show: impl FnOnce(&TrialObservations<'_>) -> T,
    ) -> Result<T, &'static str> {
        self.set_quantities(trial.quantities());
        let result = trial.run(number, self);
        let shown = self.verdict(result).map(|()| {
            let places = self.columns.iter().map(|column| 0..column.len());
            show(&TrialObservations {
                columns: &self.columns,
                places: places.collect(),
            })
        });
        self.forget();
        shown
    }

    /// Number of observations of each quantity.
    pub(crate) fn lengths(&self) -> Vec<usize> {
        self.columns.iter().map(Column::len).collect()
    }

    /// Passes the observations of each trial to `note`. `before` holds the lengths of the columns before these trials,
    /// each of which made the same number of observations.
    pub(crate) fn tell(
        &self,
        trials: Range<u64>,
        before: &[usize],
        note: &mut dyn FnMut(u64, &TrialObservations<'_>),
    ) {
        let count = (trials.end - trials.start) as usize;
        for (number, trial) in trials.enumerate() {
            let places = self.columns.iter().zip(before).map(|(column, before)| {
                let each = (column.len() - before) / count;
                before + number * each..before + (number + 1) * each
            });
            note(
                trial,
                &TrialObservations {
                    columns: &self.columns,
                    places: places.collect(),
                },
            );
        }
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
    use crate::histogram::Histogram;

    fn record(quantities: usize) -> Record {
        let mut record = Record::default();
        record.set_quantities(quantities);
        record
    }

    fn trial(
        record: &mut Record,
        run: impl FnOnce(&mut Record) -> Result<(), &'static str>,
    ) -> Result<(), &'static str> {
        let result = run(record);
        let result = record.verdict(result);
        match result {
            Ok(()) => record.keep(),
            Err(_) => record.forget(),
        }
        result
    }

    /// Sums up the observations, and returns their number for each quantity.
    fn counts(record: &mut Record) -> Vec<u64> {
        let sums = |column: &mut Column| column.sum_up(&mut Histogram::default());
        let counts = record.columns().iter_mut().map(sums);
        counts.map(|sums| sums.errors.count()).collect()
    }

    fn columns(record: &Record) -> String {
        format!("{:?}", record.columns)
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
        let once = trial(&mut record, |record| {
            record.observe(0, good);
            record.observe(0, good);
            record.observe(1, good);
            Ok(())
        });
        assert_eq!(once, Ok(()));
        let failed = trial(&mut record, |record| {
            record.observe(1, good);
            record.observe(0, good);
            record.observe(0, observation(f64::NAN, 1.0, None));
            Err("rank")
        });
        assert_eq!(failed, Err("rank"));
        assert_eq!(trial(&mut record, |_| Ok(())), Ok(()));
        assert_eq!(counts(&mut record), [2, 1]);
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
            let result = trial(&mut one_by_one, |record| {
                for (quantity, observation) in observations.into_iter().enumerate() {
                    record.observe(quantity, observation);
                }
                Ok(())
            });
            assert_eq!(result, Ok(()));
        }
        assert_eq!(columns(&at_once), columns(&one_by_one));

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
            assert_eq!(counts(&mut record), [count as u64; 2]);
        }
        assert_eq!(at_once.observe_together(&[good; 4]), 0, "unknown quantity");
        assert_eq!(at_once.observe_together(&[]), 0);
        assert_eq!(columns(&at_once), columns(&one_by_one));
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
            let result = trial(&mut record, |record| {
                record.observe(quantity, observation);
                Ok(())
            });
            assert_eq!(result, Err(kind), "{observation:?}");
            assert_eq!(counts(&mut record), [0]);
        }
    }
}
