//! Warnings if stated values disagree with the readings.

use palpate_press::{Measured, PressError};
use palpate_statistics::{Misfit, Number};

use super::misfit_warning::ReadingWords;
use super::press_report::Row;
use super::source::ReadingSource;
use palpate_study::Warning;

/// Version of the JSON format of estimates from recorded readings. It increases when a key is removed or changes its
/// meaning, not when a key is added.
pub const FORMAT_VERSION: u32 = 2;

/// Standard deviation that is assumed for a stated indentation, as a share of it.
pub const INDENTATION_SHARE: f64 = 0.02;

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

/// Warning of a stated indentation that the readings alone cannot check, for this reason.
pub(super) fn unchecked_indentation(reason: PressError) -> Warning {
    let text = format!(
        "the readings alone give no indentation, so the stated one cannot be checked: {reason}"
    );
    Warning::new("unchecked-indentation", text, [])
}

/// Warning of a misfit of a press; lengths are in `unit`.
pub(super) fn warning(misfit: &Misfit, origin: &ReadingSource, unit: &str) -> Warning {
    let words = ReadingWords {
        reading: &|marker| format!("the marker of {}", row(marker, origin)),
        noise_of: "displacements",
        unit,
    };
    words.warning(misfit)
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
