//! Questions of a design, and reasons for which it cannot answer.

use std::time::Duration;

use palpate_study::Target;
use palpate_study::config::{ConfigError, Vary};
use thiserror::Error;

/// Question which values of a field meet a target.
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// Target that all cells of the study are to meet.
    pub target: Target,
    /// Largest share of the trials that may fail, above 0 and at most 1; with 1 failures do not count.
    pub max_failures: f64,
    /// The field and its values. It is varied in place of what the config and its sweeps say of it.
    pub vary: Vary,
    /// Fields that have one value each, in place of what the config and its sweeps say of them.
    pub set: Vec<(String, toml::Value)>,
    /// Largest gap that is to stay between values that meet the target and values that miss it: a share of the value where
    /// ratios count, else of half the range.
    pub gap: f64,
    /// Most trials of a cell at one value.
    pub most_trials: u64,
    /// Time after which nothing more is explored; the scan and the verification are always done.
    pub budget: Option<Duration>,
    /// Probability that all of the answer is right; above 0 and below 1.
    pub confidence: f64,
}

impl Question {
    /// Question with at most 5 % of failures, a gap of 5 %, at most 4,194,304 trials of a cell at one value, no end by time,
    /// and an answer that is right with 95 %.
    pub fn new(target: Target, vary: Vary) -> Self {
        Self {
            target,
            max_failures: 0.05,
            vary,
            set: Vec::new(),
            gap: 0.05,
            most_trials: 1 << 22,
            budget: None,
            confidence: 0.95,
        }
    }
}

/// Question that has no answer.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum DesignError {
    /// Config that makes no scene with the values of a field.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// Setting that is out of its range.
    #[error("{setting} is {value}; it must be {expected}")]
    OutOfRange {
        /// Name of the setting.
        setting: &'static str,
        /// Its value.
        value: f64,
        /// Values that it may have.
        expected: &'static str,
    },
    /// A field that takes no numbers, or only whole ones, is given a range that has none.
    #[error("{path} {why}")]
    NoRange {
        /// Path of the field.
        path: String,
        /// Reason, and what would be right.
        why: &'static str,
    },
    /// Field that is given twice.
    #[error("{0} is given twice")]
    Twice(String),
    /// No field is varied.
    #[error("no field is varied")]
    NothingVaried,
    /// Field whose largest or smallest value is asked for, and which is not varied.
    #[error("{0} is not varied, so that it has no best value: add --vary {0}=LO..HI")]
    NotVaried(String),
    /// Field whose largest or smallest value is asked for, and whose values are no numbers.
    #[error("{path} has no largest or smallest value, for {text:?} is no number")]
    NoOrder {
        /// Path of the field.
        path: String,
        /// Value that is no number.
        text: String,
    },
    /// More combinations of values than are searched.
    #[error(
        "{0} combinations of values would each be searched, and at most {MOST_COLUMNS} are: list fewer values, or vary fewer fields"
    )]
    TooManyColumns(usize),
    /// Scene that has no such quantity.
    #[error("a {scene} has no quantity {name:?} (known: {known})")]
    NoQuantity {
        /// Kind of the scene.
        scene: &'static str,
        /// Name of the quantity.
        name: &'static str,
        /// Quantities that it has.
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
    /// More cells than are looked at.
    #[error(
        "the target is to hold in all of {0} cells, and at most {MOST_CELLS} are looked at: set some of the swept fields"
    )]
    TooManyCells(usize),
}

/// Most combinations of the values of a grid.
pub(crate) const MOST_COLUMNS: usize = 64;
/// Most cells that are to meet a target together.
pub(crate) const MOST_CELLS: usize = 1000;
