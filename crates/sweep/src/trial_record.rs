//! Records the observations of trials until all trials of a block are complete.

use std::ops::Range;

use crate::cell::Trial;
use crate::column::Column;
use crate::simd_sums::are_sound;
use crate::summary::{NEGATIVE_STD, NOT_FINITE, UNKNOWN_QUANTITY};

/// Estimate of one quantity in one trial, together with the true value. Both are in the quantity's unit.
///
/// ```
/// use palpate_sweep::{Cell, Observation, Record, RunOptions, Runner, Trial};
///
/// /// Reports its own intervals. The 95 % interval misses the true value in one trial of four, the others in two of
/// /// four.
/// struct Intervals;
/// impl Trial for Intervals {
///     fn quantities(&self) -> usize { 1 }
///     fn run(&self, trial: u64, record: &mut Record) -> Result<(), &'static str> {
///         let interval_holds = Some([trial % 2 != 0, trial % 2 != 0, trial % 4 != 0]);
///         record.observe(0, Observation { estimate: 1.0, truth: 1.0, std: None, interval_holds });
///         Ok(())
///     }
/// }
/// let runner = Runner::new(&RunOptions::default())?;
/// let statistics = runner.run(&[Cell { trials: 8, trial: &Intervals }], &|_| ());
/// let summary = statistics[0].quantities[0];
/// assert_eq!([summary.coverage50, summary.coverage80, summary.coverage95], [0.5, 0.5, 0.75].map(Some));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// The estimated value.
    pub estimate: f64,
    /// The true value. It may differ between observations of the same quantity.
    pub truth: f64,
    /// Standard error that the estimator reports, at least 0; `None` if it reports none.
    pub std: Option<f64>,
    /// Whether the estimator's own 50, 80 and 95 % intervals contain the true value. `None` if the estimator states no
    /// intervals; the estimate ± 0.67, 1.28 and 1.96 `std` are then used instead.
    pub interval_holds: Option<[bool; 3]>,
}

impl Observation {
    /// An estimate without a standard error. If the quantity is computed exactly instead of estimated, `estimate` and
    /// `truth` are equal.
    #[inline]
    pub const fn plain(estimate: f64, truth: f64) -> Self {
        Self {
            estimate,
            truth,
            std: None,
            interval_holds: None,
        }
    }

    /// Whether the observation is valid: its error is finite, and its standard error is missing, or finite and at least
    /// 0.
    #[inline]
    pub(crate) fn is_sound(&self) -> bool {
        let sound_std = |std| (0.0..f64::INFINITY).contains(&std);
        (self.estimate - self.truth).is_finite() && self.std.is_none_or(sound_std)
    }
}

/// Observations of one quantity in trials that were run together, with one [`Observation`] per trial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observations<'a> {
    /// The estimates, one per trial.
    pub estimates: &'a [f64],
    /// The true value, which is the same in all trials.
    pub truth: f64,
    /// Standard errors that the estimator reports for its estimates, one per trial; `None` if the estimator reports no
    /// standard errors.
    pub stds: Option<&'a [f64]>,
}

impl Observations<'_> {
    pub(crate) fn len(&self) -> usize {
        let stds = self.stds.map_or(usize::MAX, <[f64]>::len);
        self.estimates.len().min(stds)
    }

    /// Among the first `count` observations, the number of observations before the first invalid one.
    pub(crate) fn sound(&self, count: usize) -> usize {
        let estimates = &self.estimates[..count];
        let stds = self.stds.map_or(&[][..], |stds| &stds[..count]);
        if are_sound(estimates, self.truth, stds) {
            return count;
        }
        let is_sound = |&place: &usize| {
            let observation = Observation {
                estimate: estimates[place],
                truth: self.truth,
                std: stds.get(place).copied(),
                interval_holds: None,
            };
            observation.is_sound()
        };
        (0..count).take_while(is_sound).count()
    }
}

/// Collects the observations of trials. Each [`Trial`](crate::Trial) adds the observations that it makes.
#[derive(Debug, Default)]
pub struct Record {
    columns: Vec<Column>,
    rejection: Option<&'static str>,
}

/// Observations of all quantities in one successful trial.
#[derive(Debug)]
pub struct TrialObservations<'a> {
    columns: &'a [Column],
    /// For each quantity, the indices of the observations that the trial recorded.
    places: Vec<Range<usize>>,
}

impl TrialObservations<'_> {
    /// Observations of a quantity, in the order in which the trial recorded them; empty if the trial recorded none.
    pub fn of(&self, quantity: usize) -> impl Iterator<Item = Observation> {
        let column = self.columns.get(quantity).zip(self.places.get(quantity));
        let observations =
            |(column, places): (_, &Range<usize>)| Column::observations(column, places.clone());
        column.into_iter().flat_map(observations)
    }
}

impl Record {
    /// Records an observation of a quantity, whose index must be below `Trial::quantities()`. A trial may record any
    /// number of observations.
    ///
    /// An invalid observation makes the trial fail. The kind of failure is `not-finite` if the error or the standard
    /// deviation is not finite, `negative-std` if the standard deviation is negative, and `unknown-quantity` if the
    /// index of the quantity is too large.
    ///
    /// ```
    /// use palpate_sweep::{Cell, Observation, Record, RunOptions, Runner, Trial};
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
    /// let runner = Runner::new(&RunOptions::default())?;
    /// let statistics = runner.run(&[Cell { trials: 5, trial: &Overflow }], &|_| ());
    /// assert_eq!(statistics[0].quantities[0].observations, 0);
    /// assert_eq!((statistics[0].failures[0].kind, statistics[0].failures[0].count), ("not-finite", 5));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline]
    pub fn observe(&mut self, quantity: usize, observation: Observation) {
        match self.columns.get_mut(quantity) {
            Some(column) if observation.is_sound() => column.push(&observation),
            column => self.rejection = Some(rejection(column.is_some(), &observation)),
        }
    }

    /// Records the observations of successful trials that were run together. Each trial has one observation of each of
    /// the first `Q` quantities.
    ///
    /// Returns the number of trials that were recorded. Recording ends before the first trial with an invalid or
    /// missing observation.
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

    /// Prepares the record for trials that observe `quantities` quantities. The record must not contain earlier
    /// observations.
    pub(crate) fn set_quantities(&mut self, quantities: usize) {
        self.columns.resize_with(quantities, Column::default);
    }

    /// Result of the trial that has just run. It is an error if the trial failed or recorded an invalid observation.
    pub(crate) fn verdict(&mut self, result: Result<(), &'static str>) -> Result<(), &'static str> {
        let rejection = self.rejection.take();
        result.and_then(|()| rejection.map_or(Ok(()), Err))
    }

    #[inline]
    pub(crate) fn keep(&mut self) {
        self.columns.iter_mut().for_each(Column::keep);
    }

    pub(crate) fn forget(&mut self) {
        self.columns.iter_mut().for_each(Column::forget);
    }

    /// Runs one trial, passes its observations to `read`, and then drops them. The record must be empty before.
    pub(crate) fn single_trial<T>(
        &mut self,
        trial: &dyn Trial,
        number: u64,
        read: impl FnOnce(&TrialObservations<'_>) -> T,
    ) -> Result<T, &'static str> {
        self.set_quantities(trial.quantities());
        let result = trial.run(number, self);
        let value = self.verdict(result).map(|()| {
            let places = self.columns.iter().map(|column| 0..column.len());
            read(&TrialObservations {
                columns: &self.columns,
                places: places.collect(),
            })
        });
        self.forget();
        value
    }

    pub(crate) fn lengths(&self) -> Vec<usize> {
        self.columns.iter().map(Column::len).collect()
    }

    /// Passes the observations of each trial in `trials` to `read`. `before` contains the number of observations of
    /// each quantity before the first of these trials. All of these trials must have made the same number of
    /// observations.
    pub(crate) fn pass_on(
        &self,
        trials: Range<u64>,
        before: &[usize],
        read: &mut dyn FnMut(u64, &TrialObservations<'_>),
    ) {
        let count = (trials.end - trials.start) as usize;
        for (number, trial) in trials.enumerate() {
            let places = self.columns.iter().zip(before).map(|(column, before)| {
                let each = (column.len() - before) / count;
                before + number * each..before + (number + 1) * each
            });
            read(
                trial,
                &TrialObservations {
                    columns: &self.columns,
                    places: places.collect(),
                },
            );
        }
    }

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
    fn trials_together_record_the_same_as_one_by_one_up_to_the_first_unsound() {
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
}
