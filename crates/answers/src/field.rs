//! A varied field of a question. Its values are available as numbers, and as TOML values for the config.

use palpate_study::config::{Study, Takes, Varied, Vary};
use palpate_study::{Label, number};

use crate::error::AnswerError;
use crate::search::{SearchRange, Span};

/// A field that a question varies.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Path of the field in the config.
    pub path: String,
    /// Name of the field's column in tables: the path, with the unit appended if there is one.
    pub column: String,
    /// Name of the field in words, and the field's unit.
    pub label: Label,
    /// Values that the question lists for the field; empty if the question gives a range of numbers.
    pub listed: Vec<toml::Value>,
    /// Range of the field's values. If the question lists the values, this is the range of their indices in the list.
    pub(crate) span: Span,
}

impl Field {
    /// Creates the varied field that `vary` describes. In the study, each field in `fixed` has one fixed value.
    ///
    /// # Errors
    /// [`AnswerError`] if the field does not exist or does not accept these values.
    pub(crate) fn new(
        study: &Study,
        fixed: &[(String, Vec<toml::Value>)],
        vary: &Vary,
    ) -> Result<Self, AnswerError> {
        let path = vary.path.clone();
        // Set the fixed fields first, because their values can determine whether the varied field accepts numbers,
        // texts or tables.
        let takes = study.varied(fixed)?.takes(&path);
        let no_range = |why| {
            let path = path.clone();
            Err(AnswerError::NoRange { path, why })
        };
        let (listed, span) = match (&vary.values, takes) {
            (Varied::Listed(values), _) => {
                let last = values.len().saturating_sub(1) as f64;
                (values.clone(), Span::new(0.0, last, true))
            }
            (Varied::Range { .. }, Some(Takes::Other)) => {
                return no_range(
                    "is not a numeric field, so it has no range: list its values as PATH=A,B,C",
                );
            }
            (Varied::Range { from, to }, takes) => {
                let is_whole = takes == Some(Takes::Whole);
                let [from, to] = match is_whole {
                    true => [from.ceil(), to.floor()],
                    false => [*from, *to],
                };
                if from > to {
                    return no_range("needs whole numbers, but the range contains none");
                }
                (Vec::new(), Span::new(from, to, is_whole))
            }
        };
        let mut field = Self {
            column: String::new(),
            label: Label::of_field(&path),
            path,
            listed,
            span,
        };
        // `Study::varied` returns an error if the path is unknown, or if the field does not accept the first value of
        // the range.
        let varied = study.varied(&[fixed, &[field.fixed_at(field.first())]].concat())?;
        field.column = varied.columns.last().cloned().unwrap_or_default();
        field.label = Label::of_field(&field.column);
        Ok(field)
    }

    pub(crate) fn among(&self) -> SearchRange {
        match self.listed.len() {
            0 => SearchRange::Span(self.span),
            count => SearchRange::Listed(count),
        }
    }

    pub(crate) fn first(&self) -> f64 {
        match self.is_listed() {
            true => 0.0,
            false => self.span.from,
        }
    }

    /// The path of the field, and a list that contains only `value`, converted to TOML.
    pub(crate) fn fixed_at(&self, value: f64) -> (String, Vec<toml::Value>) {
        let value = match self.listed.get(value as usize) {
            Some(listed) => listed.clone(),
            None if self.span.is_whole => toml::Value::Integer(value as i64),
            None => toml::Value::Float(value),
        };
        (self.path.clone(), vec![value])
    }

    /// The value as a number. If the field has listed values, `value` is an index in the list, and the result is the
    /// listed number. `None` if the listed value is not a number.
    pub(crate) fn number(&self, value: f64) -> Option<f64> {
        match self.listed.get(value as usize) {
            Some(toml::Value::Float(number)) => Some(*number),
            Some(toml::Value::Integer(number)) => Some(*number as f64),
            Some(_) => None,
            None => Some(value),
        }
    }

    pub(crate) fn is_listed(&self) -> bool {
        !self.listed.is_empty()
    }

    pub(crate) fn value(&self, value: f64) -> String {
        self.label.value(&self.text(value))
    }

    pub(crate) fn named_value(&self, value: f64) -> String {
        format!("{} {}", self.label.words, self.value(value))
    }

    pub(crate) fn between(&self, from: f64, to: f64) -> String {
        match from == to {
            true => self.value(from),
            false => {
                let from = self.label.bare_value(&self.text(from));
                format!("{from} to {}", self.value(to))
            }
        }
    }

    pub(crate) fn text(&self, value: f64) -> String {
        match self.listed.get(value as usize) {
            Some(toml::Value::String(text)) => text.clone(),
            Some(toml::Value::Table(table)) => {
                let label = table.get("label").and_then(toml::Value::as_str);
                label.map_or_else(|| table.to_string(), str::to_owned)
            }
            Some(toml::Value::Float(number)) => number::shortest(*number),
            Some(other) => other.to_string(),
            None => number::shortest(value),
        }
    }
}
