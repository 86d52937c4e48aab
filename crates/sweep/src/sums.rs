//! Sums of one quantity over a run of trials.

use serde::{Deserialize, Serialize};

use crate::column::{Column, Truths, UNREPORTED};
use crate::histogram::Histogram;
use crate::magnitude::MeanMagnitude;
use crate::moments::Moments;
use crate::pass::{StdTotals, fill_errors, is_covered};
use crate::scale::sum;
use crate::squares::TrialSquares;

/// Truth of all observations of a quantity.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Serialize)]
pub(crate) enum Truth {
    /// No observation, so no truth.
    #[default]
    Unknown,
    /// One truth shared by all observations.
    Same(f64),
    /// Truths that differ, so that the moments of the estimates do not follow from those of the errors and are kept as
    /// well.
    Varies { estimates: Moments },
}

impl Truth {
    /// Truth of estimates, from the truth of each of them.
    fn of(truths: &[f64], estimates: &[f64]) -> Truth {
        match truths {
            [first, rest @ ..] if rest.iter().all(|truth| truth == first) => Truth::Same(*first),
            _ => Truth::Varies {
                estimates: Moments::of(estimates),
            },
        }
    }
}

/// Sums over the observations of one quantity, from which its statistics follow. They are merged in the order of the
/// trials.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Serialize)]
pub(crate) struct Sums {
    pub(crate) truth: Truth,
    pub(crate) errors: Moments,
    pub(crate) error_magnitude: MeanMagnitude,
    pub(crate) reported_std: MeanMagnitude,
    pub(crate) squares: TrialSquares,
    /// Observations that have intervals.
    pub(crate) judged: u64,
    /// Observations whose intervals of 50, 80 and 95 % hold the truth.
    pub(crate) covered: [u64; 3],
}

/// Buffers that are used again for each quantity.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    errors: Vec<f64>,
    reported: Vec<f64>,
}

impl Sums {
    /// Sums over the observations of `column`. Their errors are also counted in `histogram`.
    pub(crate) fn of(column: &Column, histogram: &mut Histogram, scratch: &mut Scratch) -> Sums {
        let (estimates, stds) = (column.estimates(), column.stds());
        let Scratch { errors, reported } = scratch;
        let truth = match column.truths() {
            Truths::None => return Sums::default(),
            &Truths::Same(truth) => {
                fill_errors(errors, estimates, truth);
                Truth::Same(truth)
            }
            Truths::Varied(truths) => {
                errors.clear();
                let pairs = estimates.iter().zip(truths);
                errors.extend(pairs.map(|(estimate, truth)| estimate - truth));
                Truth::of(truths, estimates)
            }
        };
        histogram.add_all(errors);
        let (moments, error_magnitude, each) = Moments::with_magnitude(errors);
        let squares = match column.several() {
            [] => each,
            several => TrialSquares::of(errors, several),
        };

        // None where no standard deviation was reported.
        let StdTotals {
            lowest,
            largest,
            sum: plain,
            mut covered,
        } = StdTotals::of(stds, errors);
        let reported_std = if lowest < 0.0 {
            reported.clear();
            reported.extend(stds.iter().filter(|&&std| std != UNREPORTED));
            MeanMagnitude::of(reported, largest, sum(reported, f64::abs))
        } else {
            MeanMagnitude::of(stds, largest, plain)
        };
        let mut judged = reported_std.count();
        for (place, interval_holds) in column.judgements().iter().enumerate() {
            if let Some(holds) = *interval_holds {
                let std = stds.get(place).copied().unwrap_or(UNREPORTED);
                judged += u64::from(std == UNREPORTED);
                let verdicts = holds.into_iter().zip(is_covered(errors[place], std));
                for (covered, (holds, would)) in covered.iter_mut().zip(verdicts) {
                    *covered += u64::from(holds);
                    *covered -= u64::from(would);
                }
            }
        }
        Sums {
            truth,
            errors: moments,
            error_magnitude,
            reported_std,
            squares,
            judged,
            covered,
        }
    }

    /// Adds sums over the trials that follow.
    pub(crate) fn merge(&mut self, other: &Sums) {
        self.truth = match (self.truth, other.truth) {
            (Truth::Unknown, truth) | (truth, Truth::Unknown) => truth,
            (Truth::Same(truth), Truth::Same(same)) if truth == same => Truth::Same(truth),
            _ => {
                let mut estimates = self.estimates();
                estimates.merge(&other.estimates());
                Truth::Varies { estimates }
            }
        };
        self.errors.merge(&other.errors);
        self.error_magnitude.merge(&other.error_magnitude);
        self.reported_std.merge(&other.reported_std);
        self.squares.merge(&other.squares);
        self.judged += other.judged;
        for (own, more) in self.covered.iter_mut().zip(other.covered) {
            *own += more;
        }
    }

    /// Moments of the estimates.
    pub(crate) fn estimates(&self) -> Moments {
        match self.truth {
            Truth::Unknown => Moments::default(),
            Truth::Same(truth) => self.errors.shifted(truth),
            Truth::Varies { estimates } => estimates,
        }
    }
}
