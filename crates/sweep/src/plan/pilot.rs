//! Prediction, from a pilot of some trials, of how many trials tell the error figures to a given accuracy.
//!
//! The root mean square of N errors has the relative standard error √(v / N) / 2, where v is the relative variance of a
//! trial's squared error: m₄/m₂² − 1 where a trial has one error (from the fourth and second moments), 2 where that is
//! Gaussian. The errors of one trial (those at all places of a patch) are dependent, and count as one.
//!
//! The result of a pilot depends on nothing but the numbers of its trials.

use std::ops::Range;

use rayon::prelude::*;

use super::spread::{Part, Spread};
use crate::alone::alone;
use crate::record::Record;
use crate::runner::Runner;
use crate::trial::Trial;

/// Number of parts of a pilot; each is left out in turn to find the standard error of v.
const PARTS: usize = 16;
/// Standard errors of v that are added to v, for caution.
const MARGIN: f64 = 2.0;
/// Relative standard error of v above which v is called doubtful: a few trials decide it.
const DOUBTFUL: f64 = 0.5;
/// Least share of the trials needed that the final pilot has.
const SHARE: f64 = 1.0 / 16.0;
/// Fewest and most trials of a first pilot.
const FEWEST: u64 = 64;
const FIRST: u64 = 1024;

/// Results of a pilot, cell by cell.
#[derive(Debug)]
pub(super) struct Pilot {
    pub(super) cells: Vec<CellPilot>,
}

/// Results of a pilot for one cell.
#[derive(Debug)]
pub(super) struct CellPilot {
    /// Share of the trials that succeeded.
    pub(super) success: f64,
    /// Trials run.
    pub(super) trials: u64,
    /// Error figures of each quantity; `None` where none was observed.
    pub(super) figures: Vec<Option<Figure>>,
}

/// The error figures of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Figure {
    /// Root mean square of the errors, in the quantity's unit.
    pub(super) rms_error: f64,
    /// The relative variance v of a trial's squared error, increased by [`MARGIN`] of its own standard errors.
    variance: f64,
    /// Whether a few trials decide v, as with errors of heavy tails.
    pub(super) is_doubtful: bool,
}

/// Error figure that needs the most trials, and how many.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Need {
    /// Index of the cell among those of the pilot.
    pub(super) cell: usize,
    pub(super) quantity: usize,
    /// Trials needed, those included that will fail.
    pub(super) trials: f64,
    pub(super) is_doubtful: bool,
}

impl Pilot {
    /// Runs a pilot for error figures with a relative standard error of `target`. At first each cell has twice the
    /// trials that Gaussian errors need, between 64 and 1,024. A cell that turns out to need many trials gets more, up
    /// to one in sixteen of its need; but at most `most`, and none where the need is above `hopeless`.
    pub(super) fn for_error(
        runner: &Runner,
        cells: &[&dyn Trial],
        target: f64,
        most: u64,
        hopeless: f64,
    ) -> Self {
        let first = (1.0 / (target * target)).ceil();
        let first = (first as u64).clamp(FEWEST, FIRST).min(most);
        let mut parts = vec![CellParts::default(); cells.len()];
        let mut until = vec![first; cells.len()];
        loop {
            runner.install(|| run(cells, &mut parts, &until));
            let pilot = Self {
                cells: parts.iter().map(CellParts::pilot).collect(),
            };
            let mut grows = false;
            for (until, cell) in until.iter_mut().zip(&pilot.cells) {
                let need = cell.need(target).map_or(0.0, |(_, trials)| trials);
                let wanted = (SHARE * need).ceil();
                if need <= hopeless && wanted > *until as f64 && *until < most {
                    *until = (wanted as u64).max(2 * *until).min(most);
                    grows = true;
                }
            }
            if !grows {
                return pilot;
            }
        }
    }

    /// Figure that needs the most trials for all figures to have a relative standard error of at most `target`; `None`
    /// where no estimate errs.
    pub(super) fn need(&self, target: f64) -> Option<Need> {
        let needs = self.cells.iter().enumerate().filter_map(|(cell, pilot)| {
            let (quantity, trials) = pilot.need(target)?;
            let figure = pilot.figures[quantity]?;
            Some(Need {
                cell,
                quantity,
                trials,
                is_doubtful: figure.is_doubtful,
            })
        });
        needs.reduce(|most, one| if one.trials > most.trials { one } else { most })
    }

    /// Largest relative standard error of an error figure to be expected after `trials` trials; `None` where no
    /// estimate errs.
    pub(super) fn expected_error(&self, trials: u64) -> Option<f64> {
        // Needs go as 1/target².
        self.need(1.0)
            .map(|need| (need.trials / trials as f64).sqrt())
    }
}

impl CellPilot {
    /// Quantity that needs the most trials, and their number.
    fn need(&self, target: f64) -> Option<(usize, f64)> {
        let needs = self
            .figures
            .iter()
            .enumerate()
            .filter_map(|(quantity, figure)| {
                let variance = (*figure)?.variance;
                let trials = variance / (4.0 * target * target) / self.success;
                (trials > 0.0).then_some((quantity, trials))
            });
        needs.reduce(|most, one| if one.1 > most.1 { one } else { most })
    }
}

/// Sums over the trials of a cell, in [`PARTS`] parts.
#[derive(Clone, Default)]
struct CellParts {
    /// Trials run so far.
    trials: u64,
    /// Unit in which the errors of each quantity are counted, so that no square overflows or vanishes.
    scales: Vec<f64>,
    parts: Vec<Part>,
}

impl CellParts {
    fn pilot(&self) -> CellPilot {
        let successes: u64 = self.parts.iter().map(|part| part.successes).sum();
        let figures = (0..self.scales.len())
            .map(|quantity| self.figure(quantity))
            .collect();
        CellPilot {
            success: successes as f64 / self.trials.max(1) as f64,
            trials: self.trials,
            figures,
        }
    }

    fn figure(&self, quantity: usize) -> Option<Figure> {
        let of_part = |part: &Part| {
            let sums = part.quantities.get(quantity).copied().unwrap_or_default();
            sums.over(part.successes)
        };
        let parts: Vec<Spread> = self.parts.iter().map(of_part).collect();
        let all = parts
            .iter()
            .fold(Spread::default(), |all, part| all.plus(part));
        let rms_error = self.scales[quantity] * all.mean_square()?.sqrt();
        let variance = all.relative_variance().unwrap_or(0.0);
        // Grouped jackknife: the figures without each part tell the error of the whole.
        let without: Vec<f64> = (0..parts.len())
            .filter(|&part| parts[part].trials > 0.0)
            .map(|part| {
                let rest = parts[..part].iter().chain(&parts[part + 1..]);
                let rest = rest.fold(Spread::default(), |all, part| all.plus(part));
                rest.relative_variance().unwrap_or(0.0)
            })
            .collect();
        let count = without.len() as f64;
        let mean = without.iter().sum::<f64>() / count;
        let squares: f64 = without.iter().map(|one| (one - mean).powi(2)).sum();
        let std = ((count - 1.0) / count * squares).sqrt();
        Some(Figure {
            rms_error,
            variance: variance + MARGIN * std,
            is_doubtful: std > DOUBTFUL * variance,
        })
    }
}

/// Trials of one part of a cell, run in the order of their numbers.
struct Job<'a> {
    trial: &'a dyn Trial,
    scales: &'a [f64],
    trials: Range<u64>,
    part: u64,
    sums: &'a mut Part,
}

impl Job<'_> {
    fn run(self) {
        let mut record = Record::default();
        let of_part = |number: &u64| number % PARTS as u64 == self.part;
        for number in self.trials.filter(of_part) {
            let sums = &mut *self.sums;
            sums.add_trial(self.trial, number, self.scales, &mut record);
        }
    }
}

/// Runs the trials of each cell that have not been run and whose number is below its entry in `until`.
fn run(cells: &[&dyn Trial], parts: &mut [CellParts], until: &[u64]) {
    for ((trial, cell), &until) in cells.iter().zip(parts.iter_mut()).zip(until) {
        if cell.scales.is_empty() {
            cell.scales = scales(*trial, until);
            cell.parts = vec![Part::of(cell.scales.len()); PARTS];
        }
    }
    let jobs: Vec<Job<'_>> = cells
        .iter()
        .zip(parts.iter_mut().zip(until))
        .flat_map(|(&trial, (cell, &until))| {
            let trials = cell.trials..until.max(cell.trials);
            cell.trials = trials.end;
            let scales = cell.scales.as_slice();
            let parts = cell.parts.iter_mut().enumerate();
            parts.map(move |(part, sums)| Job {
                trial,
                scales,
                trials: trials.clone(),
                part: part as u64,
                sums,
            })
        })
        .collect();
    jobs.into_par_iter().with_max_len(1).for_each(Job::run);
}

/// Units for the errors of each quantity: the largest magnitude of truth or estimate in the first trial that succeeds,
/// among the first 64; 1 where that is 0, or none succeeds.
fn scales(trial: &dyn Trial, until: u64) -> Vec<f64> {
    let mut record = Record::default();
    let mut scales_of = |number| {
        alone(&mut record, trial, number, |columns| {
            let magnitudes = columns.iter().map(|column| {
                let pairs = column.pairs();
                pairs.fold(0.0, |largest: f64, (estimate, truth)| {
                    largest.max(truth.abs()).max(estimate.abs())
                })
            });
            magnitudes.collect::<Vec<f64>>()
        })
    };
    let scales = (0..until.min(FEWEST)).find_map(|number| scales_of(number).ok());
    let mut scales = scales.unwrap_or_else(|| vec![0.0; trial.quantities()]);
    for scale in &mut scales {
        if !(*scale > 0.0 && scale.is_finite()) {
            *scale = 1.0;
        }
    }
    scales
}
