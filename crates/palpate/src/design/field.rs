//! The field that is varied: its values as numbers, and as the config writes them.

use palpate_study::config::{Study, Takes, Varied, Vary};
use palpate_study::{Label, number};
use palpate_sweep::{SearchRange, Span};

use super::question::DesignError;

/// Field that is varied.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Its path.
    pub path: String,
    /// Its column: the path with the unit, if it has one.
    pub column: String,
    /// Its words and its unit.
    pub label: Label,
    /// Values that are listed; none where they are the numbers of `span`.
    pub listed: Vec<toml::Value>,
    /// Numbers from one end to another; of listed values, their places.
    pub span: Span,
}

impl Field {
    /// Field of a study as it is to be varied.
    ///
    /// # Errors
    /// [`DesignError`] where there is no such field, or it takes no such values.
    pub(crate) fn of(
        study: &Study,
        set: &[(String, toml::Value)],
        vary: &Vary,
    ) -> Result<Self, DesignError> {
        let path = vary.path.clone();
        let first = match &vary.values {
            Varied::Range { from, .. } => toml::Value::Float(*from),
            Varied::Listed(values) => values.first().cloned().unwrap_or(false.into()),
        };
        let set: Vec<_> = set
            .iter()
            .map(|(path, value)| (path.clone(), vec![value.clone()]))
            .collect();
        // The study without the field, in whose tables the field is looked up.
        let takes = study.varied(&set)?.takes(&path);
        let refused = |why| {
            let path = path.clone();
            Err(DesignError::NoRange { path, why })
        };
        let (listed, span) = match (&vary.values, takes) {
            (Varied::Listed(values), _) => {
                let last = values.len().saturating_sub(1) as f64;
                (values.clone(), Span::new(0.0, last, true))
            }
            (Varied::Range { .. }, Some(Takes::Other)) => {
                return refused("takes no numbers: list its values, as PATH=A,B,C");
            }
            (Varied::Range { from, to }, takes) => {
                let is_whole = takes == Some(Takes::Whole);
                let [from, to] = match is_whole {
                    true => [from.ceil(), to.floor()],
                    false => [*from, *to],
                };
                if from > to {
                    return refused("takes whole numbers, and the range has none");
                }
                (Vec::new(), Span::new(from, to, is_whole))
            }
        };
        // A path that names nothing, or a value that the field does not take, is told by the config.
        let first = match (takes, span.is_whole && listed.is_empty()) {
            (_, true) => toml::Value::Integer(span.from as i64),
            _ => first,
        };
        let varied = study.varied(&[set, vec![(path.clone(), vec![first])]].concat())?;
        let column = varied.columns.last().cloned().unwrap_or_default();
        Ok(Self {
            label: Label::of_field(&column),
            path,
            column,
            listed,
            span,
        })
    }

    /// Values among which is searched.
    pub(crate) fn among(&self) -> SearchRange {
        match self.listed.len() {
            0 => SearchRange::Span(self.span),
            count => SearchRange::Listed(count),
        }
    }

    /// Value as the config has it.
    pub(crate) fn written(&self, value: f64) -> toml::Value {
        match self.listed.get(value as usize) {
            Some(listed) => listed.clone(),
            None if self.span.is_whole => toml::Value::Integer(value as i64),
            None => toml::Value::Float(value),
        }
    }

    /// Value as a number; `None` of a listed one that is none.
    pub fn number(&self, value: f64) -> Option<f64> {
        match self.listed.get(value as usize) {
            Some(toml::Value::Float(number)) => Some(*number),
            Some(toml::Value::Integer(number)) => Some(*number as f64),
            Some(_) => None,
            None => Some(value),
        }
    }

    /// Whether values are listed rather than numbers of a range.
    pub fn is_listed(&self) -> bool {
        !self.listed.is_empty()
    }

    /// Value with its unit.
    pub fn value(&self, value: f64) -> String {
        self.label.value(&self.text(value))
    }

    /// Values from one to another with their unit.
    pub(crate) fn between(&self, from: f64, to: f64) -> String {
        match from == to {
            true => self.value(from),
            false => {
                let from = self.label.bare_value(&self.text(from));
                format!("{from} to {}", self.value(to))
            }
        }
    }

    /// Value as results show it.
    pub fn text(&self, value: f64) -> String {
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
