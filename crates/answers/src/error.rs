//! Errors: the reasons why a question has no answer.

use palpate_study::Quantity;
use palpate_study::config::ConfigError;
use thiserror::Error;

use crate::grid::MAX_COLUMNS;

pub(crate) const MAX_CELLS: usize = 1000;

/// Reason why a question about a study has no answer.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum AnswerError {
    /// The config of the study is invalid, or becomes invalid with some values of a varied field.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// A setting of the question is out of its range.
    #[error("{setting} is {value}; it must be {expected}")]
    OutOfRange {
        /// Name of the setting that is out of its range.
        setting: &'static str,
        /// Value of the setting that is out of range.
        value: f64,
        /// Values that the setting may have, as text.
        expected: &'static str,
    },
    /// The question states a range for a field that cannot have this range. Either the values of the field are not
    /// numbers, or they are whole numbers and the range contains no whole number.
    #[error("{path} {why}")]
    NoRange {
        /// Path of the varied field.
        path: String,
        /// Reason why the field cannot have this range, and what would be right, as text.
        why: &'static str,
    },
    /// The question sets or varies the same field twice.
    #[error("{0} is given twice")]
    Twice(String),
    /// The question varies no field, so there are no values to compare.
    #[error("no field is varied")]
    NothingVaried,
    /// The question requests the best value of a field, but the field is not varied.
    #[error("{0} is not varied, so it has no best value: vary it over a range, such as {0}=1..2")]
    NotVaried(String),
    /// The question requests the best value of a field, but the values of the field are not numbers.
    #[error("{path} has no largest or smallest value, because {text:?} is not a number")]
    NoOrder {
        /// Path of the field whose best value is requested.
        path: String,
        /// Text of a value of this field. The value is not a number.
        text: String,
    },
    /// No field of the object is swept, so there are no objects to distinguish.
    #[error(
        "no field of `scene.object` is swept, so there are no objects to compare: vary one, such as \
         scene.object.radius=20,25,30"
    )]
    NoObjects,
    /// The question names a quantity that this kind of scene does not have.
    #[error("a {scene} has no quantity {name:?} (known: {known})")]
    NoQuantity {
        /// Kind of the scene: `roll`, `glide` or `press`.
        scene: &'static str,
        /// Name of the quantity in the question.
        name: String,
        /// Names of the quantities that the scene has.
        known: String,
    },
    /// The statistic of the target is undefined, although some trials succeed.
    #[error("{statistic} of {quantity} has no value where {place}: {why}")]
    Undefined {
        /// Name of the target's statistic.
        statistic: &'static str,
        /// Name of the target's quantity.
        quantity: &'static str,
        /// Values of the swept fields for which the statistic is undefined, as text.
        place: String,
        /// Reason why the statistic is undefined, and what would be right, as text.
        why: &'static str,
    },
    /// No field can change the error of the estimates, because every trial fails or every estimate is exact.
    #[error("the scene has no error that could change: {0}")]
    NoError(&'static str),
    /// The varied fields have too many combinations of values.
    #[error(
        "{0} combinations of values would each be searched; at most {MAX_COLUMNS} are allowed: \
         list fewer values, or vary fewer fields"
    )]
    TooManyColumns(usize),
    /// The study has too many cells, that is, combinations of swept values.
    #[error(
        "the study has {0} cells; at most {MAX_CELLS} are possible: set some of the swept fields"
    )]
    TooManyCells(usize),
}

impl AnswerError {
    pub(crate) fn no_quantity(scene: &'static str, name: &str, quantities: &[Quantity]) -> Self {
        let mut known: Vec<&str> = quantities.iter().map(|one| one.name).collect();
        let is_principal = Quantity::PRINCIPAL.iter().any(|one| one.name == name);
        let with_key = format!("and {name} if the config sets `scene.principal_curvatures = true`");
        known.extend((is_principal && scene != "press").then_some(with_key.as_str()));
        Self::NoQuantity {
            scene,
            name: name.to_owned(),
            known: known.join(", "),
        }
    }

    pub(crate) fn unless_confidence(value: f64) -> Result<(), Self> {
        Self::unless(
            value > 0.0 && value < 1.0,
            "confidence",
            value,
            "above 0 and below 1",
        )
    }

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
