//! Warnings if stated values disagree with the readings.

use std::fmt::Display;

use palpate_press::{Doubt, Measured, PressError, PressEstimate};
use palpate_statistics::{Number, normal_tail};

use super::misfit::Misfit;
use super::press_report::Row;
use super::source::ReadingSource;
use palpate_study::Warning;

/// Version of the JSON format of estimates from recorded readings. It increases when a key is removed or changes its
/// meaning, not when a key is added.
pub const FORMAT_VERSION: u32 = 2;

/// Standard deviation that is assumed for a stated indentation, as a share of it.
pub const INDENTATION_SHARE: f64 = 0.02;

/// Largest difference between the stated and the fitted indentation, in standard deviations. With normal errors,
/// 2.4 % of indentations that are 0.5 standard deviations off give a warning, and 0.6 % of those that are 5 off give
/// none. If the fitted indentation is too large, it is less exact, and these are up to 4.5 % and 2 %.
const APART: f64 = 2.5;

/// Ratio of the residuals to the stated noise, or its inverse, above which the intervals are wrong.
pub(super) const LARGE_RESIDUALS: f64 = 1.5;

/// Fewest degrees of freedom for a warning of small residuals: with fewer, they may be chance.
const MANY: usize = 20;

/// The stated indentation with its standard deviation, and a warning if the latter is assumed.
pub(super) fn indentation(value: f64, std: f64, unit: &str) -> (Measured, Option<Warning>) {
    if std > 0.0 {
        return (Measured { value, std }, None);
    }
    let std = INDENTATION_SHARE * value;
    let percent = 100.0 * INDENTATION_SHARE;
    let text = format!(
        "the indentation is stated without a standard deviation: {percent} % of it, {} {unit}, is assumed (setting `indentation_std`)",
        Number::rounded(std)
    );
    let warning = Warning::new("assumed-indentation-std", text, [("std", std)]);
    (Measured { value, std }, Some(warning))
}

/// StatedMismatch of a stated indentation by the readings alone, or the reason why they cannot check it.
pub(super) struct StatedMismatch {
    /// The warning.
    pub(super) words: String,
    /// Probability of a difference at least as large by chance; `None` if the readings cannot check it.
    p_value: Option<f64>,
}

impl StatedMismatch {
    /// The contradiction, if the stated indentation differs from the estimate `alone`, which does not use it.
    pub(super) fn of(
        alone: Result<PressEstimate, PressError>,
        told: Measured,
        unit: &str,
    ) -> Option<Self> {
        let unchecked = |why: &dyn Display| {
            let words = format!(
                "the readings alone tell no indentation, so the stated one cannot be checked: {why}"
            );
            let p_value = None;
            Some(Self { words, p_value })
        };
        let found = match alone {
            Ok(estimate) if estimate.only_marker.is_some() => {
                return unchecked(&"only one marker moved");
            }
            Ok(estimate) => estimate.indentation,
            Err(error) => return unchecked(&error),
        };
        let off = (told.value - found.value).abs() / libm::hypot(told.std, found.std);
        if off <= APART {
            return None;
        }
        let [value, fitted, std] = [told.value, found.value, found.std].map(Number::rounded);
        let (words, p_value) = match off.is_finite() {
            true => (
                format!(
                    "the indentation is stated as {value} {unit}, but the readings alone say {fitted} +- {std} {unit}: they differ by {off:.1} standard deviations, and the curvature is not to be trusted"
                ),
                Some(2.0 * normal_tail(off)),
            ),
            false => (
                format!(
                    "the readings alone do not bound the indentation: the stated one, {value} {unit}, cannot be checked"
                ),
                None,
            ),
        };
        Some(Self { words, p_value })
    }

    pub(super) fn warning(self) -> Warning {
        let code = match self.is_told() {
            true => "other-indentation",
            false => "unchecked-indentation",
        };
        let p_value = self.p_value.map(|p_value| ("p_value", p_value));
        Warning::new(code, self.words, p_value)
    }

    /// Whether the readings alone determine an indentation.
    pub(super) const fn is_told(&self) -> bool {
        self.p_value.is_some()
    }

    /// Adds the doubt about the indentation, if the fit with the stated indentation does not report it.
    pub(super) fn doubts(&self, doubts: Vec<Doubt>) -> Vec<Doubt> {
        let is_told = |doubt: &Doubt| matches!(doubt, Doubt::OtherIndentation { .. });
        let more = self
            .p_value
            .filter(|&p_value| p_value < Doubt::LEVEL && !doubts.iter().any(is_told))
            .map(|p_value| Doubt::OtherIndentation { p_value });
        more.into_iter().chain(doubts).collect()
    }
}

/// Warning of markers that were left out as outliers. `distances` are from the contact to all markers; `is_told` is
/// whether an indentation is stated.
pub(super) fn left_out(
    wrong: &[Row],
    distances: &[f64],
    contact_radius: f64,
    is_told: bool,
) -> Option<Warning> {
    let stated = if is_told {
        "the indentation or the sensor"
    } else {
        "the sensor"
    };
    if wrong.is_empty() {
        return None;
    }
    let nearest = distances.iter().copied().fold(f64::INFINITY, f64::min);
    let distance = |row: &Row| distances.get(row.row - 1).copied().unwrap_or(f64::INFINITY);
    let of_contact = |row: &&Row| {
        let distance = distance(row);
        distance <= nearest || distance < contact_radius
    };
    let (count, all) = (wrong.len(), distances.len());
    let left = format!("{count} of {all} markers contradict the others and are left out");
    let text = match wrong.iter().find(of_contact) {
        Some(row) => {
            let line = row
                .line
                .map_or(String::new(), |line| format!(", line {line}"));
            format!(
                "{left}, among them one of the contact itself (row {}{line}): what is stated of {stated} may be wrong instead",
                row.row
            )
        }
        None => left,
    };
    let numbers = [("left_out", count as f64), ("markers", all as f64)];
    Some(Warning::new("wrong-markers", text, numbers))
}

/// Warning if only the stated indentation implies a contact.
pub(super) const UNSEEN: &str = "the displacements do not show a contact of themselves: the interval is that of all objects that they leave to one of the stated indentation somewhere on the markers, whose place is not known";

/// Warning if only one marker shows the contact.
pub(super) fn alone(marker: usize, origin: &ReadingSource) -> String {
    let row = row(marker, origin);
    format!(
        "only the marker of {row} moved: it is wrong, or the object presses where no other marker feels it"
    )
}

/// Name of a reading's row in messages.
pub(super) fn row(reading: usize, origin: &ReadingSource) -> String {
    let line = origin.line(reading);
    let line = line.map_or(String::new(), |line| format!(", line {line}"));
    format!("row {}{line}", reading + 1)
}

/// Warnings of doubts, except about the indentation and large residuals where other warnings give their size.
pub(super) fn doubts(
    doubts: &[Doubt],
    is_contradicted: bool,
    origin: &ReadingSource,
) -> impl Iterator<Item = Warning> {
    doubts.iter().filter_map(move |doubt| match doubt {
        Doubt::OtherIndentation { .. } if is_contradicted => None,
        Doubt::LargeResiduals { .. } => None,
        Doubt::SlippedMarker { marker, .. } => {
            let row = row(*marker, origin);
            Some(Warning {
                text: format!(
                    "the marker of {row} contradicts the others, by too little to be left out"
                ),
                ..doubt.warning()
            })
        }
        _ => Some(doubt.warning()),
    })
}

/// Warning if the residuals are larger or much smaller than the stated noise. `freedom` is the approximate number of
/// degrees of freedom.
pub(super) fn noise(estimate: &PressEstimate, freedom: usize) -> Option<Warning> {
    let ratio = estimate.reduced_chi_squared.sqrt();
    // If some of the noise is estimated, the ratio varies by about 1/√(2 freedom) by chance.
    let chance = 1.0 + 3.0 / (2.0 * freedom.max(1) as f64).sqrt();
    let is_large = match estimate.goodness {
        Some(goodness) => goodness.is_doubted(),
        None => ratio > LARGE_RESIDUALS.max(chance),
    };
    if is_large {
        let times = Number::rounded(ratio);
        let text = format!(
            "the residuals are {times} times the noise that is given: intervals are too narrow"
        );
        return Some(Warning::new("large-residuals", text, [("ratio", ratio)]));
    }
    (ratio * LARGE_RESIDUALS < 1.0 && freedom >= MANY).then(|| {
        let times = Number::rounded(ratio.recip());
        let text = format!(
            "the noise that is given is {times} times the residuals: intervals are too wide"
        );
        Warning::new("small-residuals", text, [("ratio", ratio)])
    })
}
