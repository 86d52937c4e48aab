//! What trials say, kept until a block of them is summed up.

use crate::failures::{NEGATIVE_STD, NOT_FINITE, UNKNOWN_QUANTITY};
use crate::run::BLOCK;

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

/// In place of a standard deviation.
const UNREPORTED: f64 = -1.0;

/// An observation as it is stored.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    pub(crate) estimate: f64,
    /// Never −0.
    pub(crate) truth: f64,
    /// −1 where none was reported; never −0.
    pub(crate) std: f64,
    trial: u64,
}

impl Entry {
    /// Estimate − truth; finite.
    pub(crate) fn error(&self) -> f64 {
        self.estimate - self.truth
    }
}

/// Takes the observations of a trial.
#[derive(Debug, Default)]
pub struct Record {
    /// Entries by quantity, in the order of the trials.
    columns: Vec<Vec<Entry>>,
    trial: u64,
    rejection: Option<&'static str>,
}

impl Record {
    /// Records an observation of a quantity in `0..Trial::quantities()`; any number of each in a trial.
    ///
    /// An observation whose error or standard deviation is not a finite number fails the trial as [`NOT_FINITE`], a
    /// negative standard deviation as [`NEGATIVE_STD`], a quantity out of range as [`UNKNOWN_QUANTITY`].
    #[inline]
    pub fn observe(&mut self, quantity: usize, observation: Observation) {
        let Observation {
            estimate,
            truth,
            std,
        } = observation;
        let finite_error = (estimate - truth).is_finite();
        let sound_std = std.is_none_or(|std| (0.0..f64::INFINITY).contains(&std));
        match self.columns.get_mut(quantity) {
            Some(column) if finite_error && sound_std => column.push(Entry {
                estimate,
                truth: truth + 0.0,
                std: std.map_or(UNREPORTED, |std| std + 0.0),
                trial: self.trial,
            }),
            column => self.rejection = Some(rejection(column.is_some(), finite_error, std)),
        }
    }

    /// Prepares for a block of trials of so many quantities; nothing may be left from another.
    pub(crate) fn set_quantities(&mut self, quantities: usize) {
        self.columns
            .resize_with(quantities, || Vec::with_capacity(BLOCK as usize));
    }

    /// Runs one trial by its number; a failed one leaves nothing but its kind.
    #[inline]
    pub(crate) fn take(
        &mut self,
        trial: u64,
        run: impl FnOnce(&mut Record) -> Result<(), &'static str>,
    ) -> Result<(), &'static str> {
        self.trial = trial;
        match (run(self), self.rejection) {
            (Ok(()), None) => Ok(()),
            (result, rejection) => Err(self.forget_trial(result.err().or(rejection))),
        }
    }

    #[cold]
    fn forget_trial(&mut self, kind: Option<&'static str>) -> &'static str {
        self.rejection = None;
        for column in &mut self.columns {
            while column.pop_if(|entry| entry.trial == self.trial).is_some() {}
        }
        kind.unwrap_or(NOT_FINITE)
    }

    /// The entries of each quantity, in the order of the trials.
    pub(crate) fn columns(&mut self) -> &mut [Vec<Entry>] {
        &mut self.columns
    }
}

#[cold]
fn rejection(known_quantity: bool, finite_error: bool, std: Option<f64>) -> &'static str {
    if !known_quantity {
        UNKNOWN_QUANTITY
    } else if finite_error && std.is_some_and(|std| std < 0.0 && std.is_finite()) {
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
        record.columns().iter().map(Vec::len).collect()
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
        let once = record.take(0, |record| {
            record.observe(0, good);
            record.observe(0, good);
            record.observe(1, good);
            Ok(())
        });
        assert_eq!(once, Ok(()));
        let failed = record.take(1, |record| {
            record.observe(1, good);
            record.observe(0, good);
            record.observe(0, observation(f64::NAN, 1.0, None));
            Err("rank")
        });
        assert_eq!(failed, Err("rank"));
        assert_eq!(lengths(&mut record), [2, 1]);
        assert_eq!(record.take(2, |_| Ok(())), Ok(()));
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
            let result = record.take(7, |record| {
                record.observe(quantity, observation);
                Ok(())
            });
            assert_eq!(result, Err(kind), "{observation:?}");
            assert_eq!(lengths(&mut record), [0]);
        }
    }
}
