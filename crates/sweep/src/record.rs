//! What trials say, kept until a block of them is summed up.

use crate::column::Column;
use crate::failures::{NEGATIVE_STD, NOT_FINITE, UNKNOWN_QUANTITY};

/// What one trial says of one quantity, in the quantity's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// The estimate.
    pub estimate: f64,
    /// The true value; may differ from one observation to the next.
    pub truth: f64,
    /// The standard deviation the estimator claims, at least 0; `None` where it claims none.
    pub std: Option<f64>,
}

impl Observation {
    /// What was observed of the error is a number, and the standard deviation is one.
    #[inline]
    fn is_sound(&self) -> bool {
        let sound_std = |std| (0.0..f64::INFINITY).contains(&std);
        (self.estimate - self.truth).is_finite() && self.std.is_none_or(sound_std)
    }
}

/// Takes the observations of a trial.
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
        let sound = sum < f64::INFINITY && lowest == 0.0;
        match self.columns.get_mut(..N) {
            Some(columns) if sound => {
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

    /// Prepares for a block of trials of so many quantities; nothing may be left from another.
    pub(crate) fn set_quantities(&mut self, quantities: usize) {
        self.columns.resize_with(quantities, Column::default);
    }

    /// Runs one trial; a failed one leaves nothing but its kind.
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
            observation(3.0, 4.0, Some(0.5)),
        );
        let (mut each, mut one_by_one) = (record(3), record(3));
        each.observe_each([first, second]);
        one_by_one.observe(0, first);
        one_by_one.observe(1, second);
        assert_eq!(each.columns(), one_by_one.columns());
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
