//! Questions that a design answers, and the reasons why it cannot answer one.

use std::time::Duration;

use palpate_study::Target;
use palpate_study::config::{ConfigError, Varied, Vary};
use palpate_sweep::Span;
use thiserror::Error;

/// Largest number of combinations of the grid's values.
pub(crate) const MAX_COLUMNS: usize = 64;
/// Largest number of cells that must meet a target together.
pub(crate) const MAX_CELLS: usize = 1000;

/// Question: which values of a field meet a target?
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// Target that all cells of the study must meet.
    pub target: Target,
    /// Largest share of the trials that may fail, above 0 and at most 1. With 1, failures do not count.
    pub max_failures: f64,
    /// The searched field and its values. They replace the values in the config and its sweeps.
    pub vary: Vary,
    /// Fields with one value each, which replaces the values in the config and its sweeps.
    pub set: Vec<(String, toml::Value)>,
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

/// Question: which values of several fields, taken together, meet a target?
#[derive(Clone, Debug, PartialEq)]
pub struct Survey {
    /// Question at each combination of the grid's values. The field that it varies is the searched one.
    pub question: Question,
    /// The other varied fields. Each takes some values of its range, or all listed values.
    pub grid: Vec<Vary>,
    /// Field whose best value is wanted: the searched one or one of the grid.
    pub sought: Option<Sought>,
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

impl Survey {
    /// Survey of these fields with at most 5 % of failures, a gap of 5 %, at most 4,194,304 trials of a cell at one value,
    /// no time limit, and a confidence of 95 %.
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
    ) -> Result<Self, DesignError> {
        let is_range = |field: &Vary| matches!(field.values, Varied::Range { .. });
        let place = match &sought {
            Some(sought) => {
                let place = fields.iter().position(|field| field.path == sought.path);
                Some(place.ok_or_else(|| DesignError::NotVaried(sought.path.clone()))?)
            }
            None => None,
        };
        let searched = place
            .filter(|&place| is_range(&fields[place]))
            .or_else(|| fields.iter().rposition(is_range))
            .or(place)
            .or_else(|| fields.len().checked_sub(1))
            .ok_or(DesignError::NothingVaried)?;
        let question = Question {
            target,
            max_failures: 0.05,
            vary: fields.remove(searched),
            set: Vec::new(),
            gap: 0.05,
            most_trials: 1 << 22,
            budget: None,
            confidence: 0.95,
        };
        Ok(Self {
            question,
            grid: fields,
            sought,
        })
    }

    /// Rejects settings that are out of their ranges, and a field with two roles.
    pub(super) fn check(&self) -> Result<(), DesignError> {
        let Question {
            target,
            max_failures,
            vary,
            set,
            gap,
            most_trials,
            confidence,
            ..
        } = &self.question;
        let out_of_range = |setting, value, expected| {
            Err(DesignError::OutOfRange {
                setting,
                value,
                expected,
            })
        };
        if !(*max_failures > 0.0 && *max_failures <= 1.0) {
            let expected = "above 0, for no number of trials shows that none fails, and at most 1";
            return out_of_range("max_failures", *max_failures, expected);
        }
        if !(*gap > 0.0 && *gap <= 1.0) {
            return out_of_range("gap", *gap, "above 0 and at most 1");
        }
        if *most_trials == 0 {
            return out_of_range("most_trials", 0.0, "at least 1");
        }
        if !(*confidence > 0.0 && *confidence < 1.0) {
            return out_of_range("confidence", *confidence, "above 0 and below 1");
        }
        if !target.limit.is_finite() || target.statistic.is_size() && target.limit <= 0.0 {
            let expected = match target.statistic.is_size() {
                true => "finite and above 0",
                false => "finite",
            };
            return out_of_range("limit", target.limit, expected);
        }
        let set = set.iter().map(|(path, _)| path);
        let varied = self.grid.iter().chain([vary]).map(|vary| &vary.path);
        let mut paths: Vec<&String> = set.chain(varied).collect();
        paths.sort_unstable();
        match paths.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(DesignError::Twice(pair[0].clone())),
            None => Ok(()),
        }
    }
}

impl Extreme {
    /// Whether `one` is better than `other`.
    pub(super) fn prefers(self, one: f64, other: f64) -> bool {
        match self {
            Self::Largest => one > other,
            Self::Smallest => one < other,
        }
    }

    /// End of a range that is best.
    pub(super) const fn end_of(self, span: Span) -> f64 {
        match self {
            Self::Largest => span.to,
            Self::Smallest => span.from,
        }
    }

    /// The word for it.
    pub(super) const fn word(self) -> &'static str {
        match self {
            Self::Largest => "largest",
            Self::Smallest => "smallest",
        }
    }
}

/// Reason why a question has no answer.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum DesignError {
    /// Config that is invalid with the values of a field.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// Setting that is out of its range.
    #[error("{setting} is {value}; it must be {expected}")]
    OutOfRange {
        /// Name of the setting.
        setting: &'static str,
        /// Its value.
        value: f64,
        /// Allowed values.
        expected: &'static str,
    },
    /// Range for a field that is no number, or a range without a whole number for a field of whole numbers.
    #[error("{path} {why}")]
    NoRange {
        /// Path of the field.
        path: String,
        /// Reason, and what would be right.
        why: &'static str,
    },
    /// Field that is set or varied twice.
    #[error("{0} is given twice")]
    Twice(String),
    /// No field is varied.
    #[error("no field is varied")]
    NothingVaried,
    /// Sought field that is not varied.
    #[error("{0} is not varied, so that it has no best value: add --vary {0}=LO..HI")]
    NotVaried(String),
    /// Sought field whose values are not numbers.
    #[error("{path} has no largest or smallest value, for {text:?} is no number")]
    NoOrder {
        /// Path of the field.
        path: String,
        /// Value that is no number.
        text: String,
    },
    /// Too many combinations of values.
    #[error(
        "{0} combinations of values would each be searched, and at most {MAX_COLUMNS} are: list fewer values, or vary fewer fields"
    )]
    TooManyColumns(usize),
    /// Scene without the quantity of the target.
    #[error("a {scene} has no quantity {name:?} (known: {known})")]
    NoQuantity {
        /// Kind of the scene.
        scene: &'static str,
        /// Name of the quantity.
        name: &'static str,
        /// Quantities of the scene.
        known: String,
    },
    /// Statistic that has no value although trials succeed.
    #[error("{statistic} of {quantity} has no value where {place}: {why}")]
    Undefined {
        /// Name of the statistic.
        statistic: &'static str,
        /// Name of the quantity.
        quantity: &'static str,
        /// Swept values of the cell.
        place: String,
        /// Reason, and what would be right.
        why: &'static str,
    },
    /// Too many cells that must meet the target together.
    #[error(
        "the target is to hold in all of {0} cells, and at most {MAX_CELLS} are looked at: set some of the swept fields"
    )]
    TooManyCells(usize),
}
