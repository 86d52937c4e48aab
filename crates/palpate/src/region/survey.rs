//! Question of a survey of several fields.

use palpate_study::Target;
use palpate_study::config::{Varied, Vary};

use crate::design::{DesignError, Question};

/// Question which values of several fields, taken together, meet a target.
#[derive(Clone, Debug, PartialEq)]
pub struct Survey {
    /// Question of every combination of the grid's values; the field that it varies is the one that is searched.
    pub question: Question,
    /// The other fields. Each takes some values of its range, or all that are listed.
    pub grid: Vec<Vary>,
    /// Field whose best value is asked for, one of the others or the one that is searched.
    pub sought: Option<Sought>,
}

/// Field whose largest or smallest value that meets the target is asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sought {
    /// Its path.
    pub path: String,
    /// Which of its values is best.
    pub extreme: Extreme,
}

/// Best of some values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extreme {
    /// The largest.
    Largest,
    /// The smallest.
    Smallest,
}

impl Survey {
    /// Survey of these fields with the settings of [`Question::new`]. What is sought is searched where it has a range, else
    /// the last field that has one, else the last field; the others make the grid, in their order.
    ///
    /// # Errors
    /// No field is varied, or the one that is sought is not.
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
        let vary = fields.remove(searched);
        Ok(Self {
            question: Question::new(target, vary),
            grid: fields,
            sought,
        })
    }
}

impl Extreme {
    /// Whether one value is better than another.
    pub(super) fn prefers(self, one: f64, other: f64) -> bool {
        match self {
            Self::Largest => one > other,
            Self::Smallest => one < other,
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
