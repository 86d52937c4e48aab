//! The words around a plot: what is held fixed, how large the sample is, what is not drawn.

use super::compose::Skipped;
use super::select::Selection;
use crate::table::{Axis, finite};
use crate::{Study, study, words};
use std::collections::BTreeMap;

/// Subtitle of a plot: the settings held fixed, and the number of trials behind a point.
pub(crate) fn subtitle(of: &Selection) -> String {
    let table = of.study.cells();
    let fixed = of.spec.filters.iter().filter_map(|(path, values)| {
        let axis = table.axis(path)?;
        if let [value] = values.as_slice() {
            Some(full_value(axis, value))
        } else {
            None
        }
    });
    let mut parts: Vec<String> = fixed.collect();
    let trials = of
        .rows
        .iter()
        .filter_map(|row| table.statistic(*row, "trials"));
    parts.push(words::sample(trials, "point"));
    parts.join(" · ")
}

/// Notes below a plot on the points that are not drawn or not counted, with reasons.
pub(crate) fn notes(of: &Selection, skipped: Skipped) -> Vec<String> {
    let mut notes = Vec::new();
    for (why, (count, series)) in skipped {
        let points = match count {
            1 => "1 point is".to_owned(),
            n => format!("{} points are", words::count(n as u64)),
        };
        let mut note = format!("Not drawn: {points} {why}");
        if let (Some(axis), 1..=6) = (of.series, series.len()) {
            let values: Vec<String> = series
                .iter()
                .map(|value| short_value(axis, value))
                .collect();
            note += &format!(
                " ({} {})",
                words::path(&axis.header).words,
                values.join(", ")
            );
        }
        notes.push(note + ".");
    }
    notes.extend(failed(of));
    if !of.absent.is_empty() {
        notes.push(format!("Not in the table: {}.", of.absent.join(", ")));
    }
    notes
}

/// How many trials failed and of what, if any did.
fn failed(of: &Selection) -> Option<String> {
    let table = of.study.cells();
    // Rows of several quantities share the trials of their cell.
    let cells: BTreeMap<u64, usize> = of.rows.iter().map(|row| (table.cell(*row), *row)).collect();
    let sum = |name: &str| {
        cells
            .values()
            .filter_map(|row| table.statistic(*row, name))
            .sum::<f64>() as u64
    };
    let failed = sum("failures");
    if failed == 0 {
        return None;
    }
    let mut kinds: BTreeMap<&str, u64> = BTreeMap::new();
    for failure in of
        .study
        .failures()
        .iter()
        .filter(|f| cells.contains_key(&f.cell))
    {
        let count = kinds.entry(&failure.kind).or_default();
        *count = count.saturating_add(failure.count);
    }
    let kinds: Vec<String> = kinds
        .iter()
        .map(|(kind, count)| format!("{kind} {}", words::count(*count)))
        .collect();
    let kinds = if kinds.is_empty() {
        String::new()
    } else {
        format!(" ({})", kinds.join(", "))
    };
    let (failed, trials) = (words::count(failed), words::count(sum("trials")));
    Some(format!(
        "Left out of every average: {failed} failed trials of {trials}{kinds}."
    ))
}

/// A value below a heading that names its axis and unit.
pub(crate) fn short_value(axis: &Axis, value: &str) -> String {
    match axis.header.as_str() {
        "quantity" => words::quantity(value),
        header => words::path(header).bare_value(value),
    }
}

/// A value that stands alone: with the name of its axis and its unit, unless it is a label.
pub(crate) fn full_value(axis: &Axis, value: &str) -> String {
    let meaning = words::path(&axis.header);
    match (axis.header.as_str(), finite(value)) {
        ("quantity", _) => words::quantity(value),
        (_, Some(_)) => format!("{} {}", meaning.words, meaning.value(value)),
        // A shape or a method is called by its name; another keyword needs its key; a label of several words
        // speaks for itself.
        ("scene.object" | "scene.estimator", None) => value.to_owned(),
        (_, None) if !value.contains(' ') => format!("{} {value}", meaning.words),
        (_, None) => value.to_owned(),
    }
}

/// The object of the config in words: its kind and its numbers.
pub(crate) fn object(study: &Study) -> Option<String> {
    let table = study.setting("scene.object")?.as_table()?;
    let kind = table.get("kind")?.as_str()?.replace('-', " ");
    let numbers = table.iter().filter_map(|(key, value)| {
        let number = words::number(study::number(value)?);
        Some(format!("{} = {number}", key.replace('_', " ")))
    });
    let parts: Vec<String> = std::iter::once(kind).chain(numbers).collect();
    Some(parts.join(", "))
}
