//! The values that a search has tested, with the scores of all cells of the study at each of these values.

use palpate_report::Stretch;

use super::limits::Rules;
use super::{ScoreRequest, Scores};

/// Whether a value of the searched field meets the target or misses it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    /// At this value, all cells of the study meet the target.
    Meets,
    /// At this value, at least one cell of the study misses the target.
    Misses,
}

impl From<&Stretch> for Side {
    fn from(run: &Stretch) -> Self {
        match run.meets {
            true => Self::Meets,
            false => Self::Misses,
        }
    }
}

#[derive(Clone, Debug, Default)]
pub(super) struct Points {
    pub(super) points: Vec<Point>,
    /// Number of tests so far. All requests for one value in the same round of trials count as one test.
    pub(super) looks: usize,
}

#[derive(Clone, Debug)]
pub(super) struct Point {
    pub(super) value: f64,
    pub(super) cells: Vec<CellScores>,
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CellScores {
    pub(super) trials: u64,
    scores: Scores,
}

impl CellScores {
    fn score(&self) -> f64 {
        self.scores[0].min(self.scores[1])
    }
}

impl Point {
    /// Finds the smallest score at this value. Returns the index of the cell of the study that has this score, and the
    /// index of the condition to which it belongs: 0 for the limit on the statistic, 1 for the limit on the share of
    /// failed trials.
    pub(super) fn worst(&self) -> (usize, usize) {
        let all = self.cells.iter().enumerate().flat_map(|(cell, look)| {
            let scores = look.scores.into_iter().enumerate();
            scores.map(move |(condition, score)| ((cell, condition), score))
        });
        let least = all.min_by(|one, other| one.1.total_cmp(&other.1));
        least.map_or((0, 0), |(place, _)| place)
    }

    pub(super) fn score(&self) -> f64 {
        let scores = self.cells.iter().map(CellScores::score);
        scores.fold(f64::INFINITY, f64::min)
    }

    pub(super) fn side(&self, rules: &Rules) -> Option<Side> {
        match self.score() {
            score if score >= rules.meets => Some(Side::Meets),
            score if score <= rules.misses => Some(Side::Misses),
            _ => None,
        }
    }

    pub(super) fn trials(&self) -> u64 {
        let trials = self.cells.iter().map(|cell| cell.trials);
        trials.max().unwrap_or(0)
    }

    /// Adds requests for more trials to `asks`. Each cell of the study whose scores do not yet show that it meets the
    /// target at this value gets `factor` times as many trials, at most `most_trials`.
    pub(super) fn grown(&self, factor: f64, rules: &Rules, asks: &mut Vec<ScoreRequest>) {
        for (cell, look) in self.cells.iter().enumerate() {
            if look.score() < rules.meets && look.trials < rules.most_trials {
                let trials = (look.trials as f64 * factor).ceil() as u64;
                asks.push(ScoreRequest {
                    value: self.value,
                    cell,
                    trials: trials.min(rules.most_trials),
                    fresh: false,
                });
            }
        }
    }
}

impl Points {
    pub(super) fn added(&self, asks: &[ScoreRequest]) -> u64 {
        let added = asks.iter().map(|ask| {
            let known = self.points.iter().find(|point| point.value == ask.value);
            let known = known.and_then(|point| point.cells.get(ask.cell));
            ask.trials
                .saturating_sub(known.map_or(0, |cell| cell.trials))
        });
        added.fold(0, u64::saturating_add)
    }

    pub(super) fn store(&mut self, asks: &[ScoreRequest], scores: &[Scores], cells: usize) {
        let mut last = None;
        for (ask, scores) in asks.iter().zip(scores) {
            if last != Some(ask.value) {
                self.looks += 1;
                last = Some(ask.value);
            }
            let place = self.points.partition_point(|point| point.value < ask.value);
            let is_known = self
                .points
                .get(place)
                .is_some_and(|point| point.value == ask.value);
            if !is_known {
                let cells = vec![CellScores::default(); cells];
                self.points.insert(
                    place,
                    Point {
                        value: ask.value,
                        cells,
                    },
                );
            }
            // Replace a score of NaN by 0. A score of 0 means that it is undecided whether the value meets the target.
            let scores = scores.map(|score| if score.is_nan() { 0.0 } else { score });
            if let Some(cell) = self.points[place].cells.get_mut(ask.cell) {
                *cell = CellScores {
                    trials: ask.trials,
                    scores,
                };
            }
        }
    }

    pub(super) fn sides(&self, rules: &Rules) -> Vec<Option<Side>> {
        self.points.iter().map(|point| point.side(rules)).collect()
    }
}
