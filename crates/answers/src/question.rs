//! The questions that [`design`](crate::design) answers.

use std::time::Duration;

use palpate_study::Target;
use palpate_study::config::{Varied, Vary};

use crate::error::AnswerError;
use crate::search::Span;

/// A question for [`design`](crate::design): which values of a field, or which combinations of values of several
/// fields, meet a target?
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// Target that all cells of the study (combinations of its swept values) must meet.
    pub target: Target,
    /// Field that is searched at each combination of values of the other varied fields (`grid`). Its values in this
    /// question replace its values in the config.
    pub searched: Vary,
    /// The other varied fields, which form the grid. The grid contains all values of a field with listed values, and
    /// some values of a field with a range.
    pub grid: Vec<Vary>,
    /// Field whose best value the answer states: `searched` or a field of `grid`.
    pub sought: Option<Sought>,
    /// Fields that have one fixed value in all trials of the question. Each field is stored with its value.
    pub set: Vec<(String, toml::Value)>,
    /// Largest allowed share of failed trials, above 0 and at most 1. A value with more failures misses the target. If
    /// the share is 1, failed trials are ignored.
    pub max_failures: f64,
    /// Largest undecided gap that the answer may contain between a value that meets the target and a value that misses
    /// it. The gap is relative. If the values of the range are spaced logarithmically, it is the difference of the two
    /// values divided by the lower value. Otherwise, it is the difference divided by half the width of the range.
    pub gap: f64,
    /// Largest number of trials of one cell of the study at one value of the searched field.
    pub most_trials: u64,
    /// Time limit, after which the search tests no more values. The first scan (17 values in the range) and the
    /// verification of the answer run in any case.
    pub budget: Option<Duration>,
    /// Probability that the whole answer is right, above 0 and below 1.
    pub confidence: f64,
}

/// The optimised field of a question. The answer is the largest or the smallest of its values that meet the target.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sought {
    /// Path of the optimised field in the config.
    pub path: String,
    /// Whether the answer is the largest or the smallest value that meets the target.
    pub extreme: Extreme,
}

/// Whether the best value of a field is the largest or the smallest of the values that meet the target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extreme {
    /// The best value of the field is the largest value that meets the target.
    Largest,
    /// The best value of the field is the smallest value that meets the target.
    Smallest,
}

impl Question {
    /// A question about these fields with the default settings. The defaults are at most 5 % failed trials, a gap of
    /// 5 %, at most 4,194,304 trials per cell and tested value, no time limit, and a confidence of 95 %.
    ///
    /// If the optimised field has a range, it is the searched field. Otherwise, the last field with a range is
    /// searched. If no field has a range, the optimised field is searched or, if there is none, the last field. The
    /// other fields form the grid, in the order of `fields`.
    ///
    /// # Errors
    /// [`AnswerError`] if no field is varied, or if the optimised field is not varied.
    pub fn new(
        target: Target,
        mut fields: Vec<Vary>,
        sought: Option<Sought>,
    ) -> Result<Self, AnswerError> {
        let is_range = |field: &Vary| matches!(field.values, Varied::Range { .. });
        let place_of = |sought: &Sought| {
            let place = fields.iter().position(|field| field.path == sought.path);
            place.ok_or_else(|| AnswerError::NotVaried(sought.path.clone()))
        };
        let place = sought.as_ref().map(place_of).transpose()?;
        let searched = place
            .filter(|&place| is_range(&fields[place]))
            .or_else(|| fields.iter().rposition(is_range))
            .or(place)
            .or_else(|| fields.len().checked_sub(1))
            .ok_or(AnswerError::NothingVaried)?;
        Ok(Self {
            target,
            searched: fields.remove(searched),
            grid: fields,
            sought,
            set: Vec::new(),
            max_failures: 0.05,
            gap: 0.05,
            most_trials: 1 << 22,
            budget: None,
            confidence: 0.95,
        })
    }

    pub(crate) fn check(&self) -> Result<(), AnswerError> {
        let (failures, gap) = (self.max_failures, self.gap);
        let expected = "above 0 and at most 1 (0 cannot be verified with any number of trials)";
        AnswerError::unless(
            failures > 0.0 && failures <= 1.0,
            "max_failures",
            failures,
            expected,
        )?;
        AnswerError::unless(gap > 0.0 && gap <= 1.0, "gap", gap, "above 0 and at most 1")?;
        AnswerError::unless(self.most_trials > 0, "most_trials", 0.0, "at least 1")?;
        AnswerError::unless_confidence(self.confidence)?;
        let set = self.set.iter().map(|(path, _)| path);
        let varied = self.grid.iter().chain([&self.searched]);
        let mut paths: Vec<&String> = set.chain(varied.map(|vary| &vary.path)).collect();
        paths.sort_unstable();
        let twice = paths.windows(2).find(|pair| pair[0] == pair[1]);
        twice.map_or(Ok(()), |pair| Err(AnswerError::Twice(pair[0].clone())))
    }
}

impl Extreme {
    pub(crate) fn prefers(self, one: f64, other: f64) -> bool {
        match self {
            Self::Largest => one > other,
            Self::Smallest => one < other,
        }
    }

    pub(crate) const fn end_of(self, span: Span) -> f64 {
        match self {
            Self::Largest => span.to,
            Self::Smallest => span.from,
        }
    }

    /// Two words for sentences. The first is the adjective for the best value, such as `largest`. The second is for
    /// values beyond the best value, which miss the target, such as `more`.
    pub(crate) const fn words(self) -> [&'static str; 2] {
        match self {
            Self::Largest => ["largest", "more"],
            Self::Smallest => ["smallest", "less"],
        }
    }
}
