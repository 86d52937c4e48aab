//! Reasons why a question has no answer.

use palpate_study::Quantity;
use palpate_study::config::ConfigError;
use thiserror::Error;

use crate::grid::MAX_COLUMNS;

/// Largest number of cells of a study.
pub(crate) const MAX_CELLS: usize = 1000;

/// Reason why a question has no answer.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum AnswerError {
    /// Config that is invalid, or invalid with the values of a field.
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
    #[error("{0} is not varied, so it has no best value: vary it over a range, such as {0}=1..2")]
    NotVaried(String),
    /// Sought field whose values are not numbers.
    #[error("{path} has no largest or smallest value, because {text:?} is no number")]
    NoOrder {
        /// Path of the field.
        path: String,
        /// Value that is no number.
        text: String,
    },
    /// No object is swept.
    #[error(
        "no field of `scene.object` is swept, so there are no objects to compare: vary one, such as \
         scene.object.radius=20,25,30"
    )]
    NoObjects,
    /// Scene without the quantity of the question.
    #[error("a {scene} has no quantity {name:?} (known: {known})")]
    NoQuantity {
        /// Kind of the scene.
        scene: &'static str,
        /// Name of the quantity.
        name: String,
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
    /// Trials without an error that could change.
    #[error("the scene has no error that could change: {0}")]
    NoError(&'static str),
    /// Too many combinations of values.
    #[error(
        "{0} combinations of values would each be searched, and at most {MAX_COLUMNS} are: list fewer values, or vary fewer fields"
    )]
    TooManyColumns(usize),
    /// Too many cells.
    #[error(
        "the study has {0} cells, and at most {MAX_CELLS} are possible: set some of the swept fields"
    )]
    TooManyCells(usize),
}

impl AnswerError {
    /// Error for a scene of this kind that has only these quantities.
    pub(crate) fn no_quantity(scene: &'static str, name: &str, quantities: &[Quantity]) -> Self {
        let known: Vec<&str> = quantities.iter().map(|one| one.name).collect();
        Self::NoQuantity {
            scene,
            name: name.to_owned(),
            known: known.join(", "),
        }
    }

    /// Checks that a confidence is above 0 and below 1.
    pub(crate) fn unless_confidence(value: f64) -> Result<(), Self> {
        Self::unless(
            value > 0.0 && value < 1.0,
            "confidence",
            value,
            "above 0 and below 1",
        )
    }

    /// Error for the value of a setting, unless it is in its range.
    pub(crate) fn unless(
        is_in_range: bool,
        setting: &'static str,
        value: f64,
        expected: &'static str,
    ) -> Result<(), Self> {
        match is_in_range {
            true => Ok(()),
            false => Err(Self::OutOfRange {
                setting,
                value,
                expected,
            }),
        }
    }
}
