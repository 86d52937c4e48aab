//! Questions that a design answers.

use std::time::Duration;

use palpate_study::Target;
use palpate_study::config::{Varied, Vary};

use crate::error::AnswerError;
use crate::search::Span;

/// Question: which values of one or several fields, taken together, meet a target?
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// Target that all cells of the study must meet.
    pub target: Target,
    /// Field that is searched at each combination of the grid's values. Its values, like those of the other varied and set
    /// fields, replace the values in the config and its sweeps.
    pub searched: Vary,
    /// The other varied fields. Each takes some values of its range, or all listed values.
    pub grid: Vec<Vary>,
    /// Field whose best value the answer names: the searched field or a field of the grid.
    pub sought: Option<Sought>,
    /// Fields with one value each.
    pub set: Vec<(String, toml::Value)>,
    /// Largest share of the trials that may fail, above 0 and at most 1. With 1, failures do not count.
    pub max_failures: f64,
    /// Largest gap between values that meet the target and values that miss it: relative to the value if values are
    /// spaced by ratios, else to half the range.
    pub gap: f64,
    /// Largest number of trials of a cell at one value.
    pub most_trials: u64,
    /// Time after which no new value is tried. The first scan and the verification are always finished.
    pub budget: Option<Duration>,
    /// Probability that the whole answer is right, above 0 and below 1.
    pub confidence: f64,
}

/// Field whose largest or smallest value that meets the target is wanted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sought {
    /// Its path.
    pub path: String,
    /// Which of its values is best.
    pub extreme: Extreme,
}

/// Which of several values is best.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extreme {
    /// The largest.
    Largest,
    /// The smallest.
    Smallest,
}

impl Question {
    /// Question about these fields with at most 5 % of failures, a gap of 5 %, at most 4,194,304 trials of a cell at one
    /// value, no time limit, and a confidence of 95 %.
    ///
    /// The sought field is searched if it has a range, else the last field with a range, else the last field. The others
    /// make the grid, in their order.
    ///
    /// # Errors
    /// If no field is varied, or if the sought field is not varied.
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

    /// Rejects settings that are out of their ranges, and a field with two roles.
    pub(crate) fn check(&self) -> Result<(), AnswerError> {
        let (failures, gap) = (self.max_failures, self.gap);
        let expected = "above 0, for no number of trials shows that none fails, and at most 1";
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
        match paths.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(AnswerError::Twice(pair[0].clone())),
            None => Ok(()),
        }
    }
}

impl Extreme {
    /// Whether `one` is better than `other`.
    pub(crate) fn prefers(self, one: f64, other: f64) -> bool {
        match self {
            Self::Largest => one > other,
            Self::Smallest => one < other,
        }
    }

    /// End of a range that is best.
    pub(crate) const fn end_of(self, span: Span) -> f64 {
        match self {
            Self::Largest => span.to,
            Self::Smallest => span.from,
        }
    }

    /// The word for it, and the word for values beyond the best one.
    pub(crate) const fn words(self) -> [&'static str; 2] {
        match self {
            Self::Largest => ["largest", "more"],
            Self::Smallest => ["smallest", "less"],
        }
    }
}
