//! From numbers of a table to the places along an axis where they are shown.

use super::figure;
use super::scale::Spacing;
use super::spec::Mark;
use crate::words;

/// One axis of a plot.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Along {
    pub(crate) name: char,
    pub(crate) spacing: Spacing,
    /// Factor from the numbers in the table to those shown.
    pub(crate) factor: f64,
}

impl Along {
    /// Number shown for `value`; an error says why the `what` at it cannot be drawn.
    pub(crate) fn place(self, value: f64, what: &str) -> Result<f64, String> {
        let place = value * self.factor;
        match self.spacing.refusal(place) {
            None => Ok(place),
            Some(why) => Err(format!(
                "the {what} at {} = {} is {why}",
                self.name,
                words::exact(value)
            )),
        }
    }
}

/// Reference lines in their places, or what is wrong with one.
pub(crate) fn marks(marks: &[Mark], [x, y]: [Along; 2]) -> Result<Vec<figure::Mark>, String> {
    let place = |mark: &Mark| {
        let along = if mark.on_x { x } else { y };
        Ok(figure::Mark {
            on_x: mark.on_x,
            at: along.place(mark.value, "mark")?,
            label: mark.label.clone(),
        })
    };
    marks.iter().map(place).collect()
}
