//! Texts for the captions of figures: swept values, the object of a study, and failed trials.

use crate::table::{Axis, Table};
use crate::{Study, study};
use palpate_study::{Label, label, number};
use std::collections::BTreeMap;

/// Text of a swept value without the name and the unit of its field, because a heading already states them.
pub(crate) fn short_value(axis: &Axis, value: &str) -> String {
    match axis.header.as_str() {
        "quantity" => label::quantity(value),
        header => Label::of_field(header).bare_value(value),
    }
}

/// Text of a swept value, with the name and the unit of its field. If the value is a label that is clear by itself, the
/// text is the label alone.
pub(crate) fn full_value(axis: &Axis, value: &str) -> String {
    let field = Label::of_field(&axis.header);
    match (axis.header.as_str(), number::finite(value)) {
        ("quantity", _) => label::quantity(value),
        (_, Some(_)) => format!("{} {}", field.words, field.value(value)),
        // Print the label of an object or of an estimator, and any label of several words, without the name of the
        // field: such labels are clear by themselves.
        ("scene.object" | "scene.estimator", None) => value.to_owned(),
        (_, None) if !value.contains(' ') => format!("{} {value}", field.words),
        (_, None) => value.to_owned(),
    }
}

pub(crate) fn swept_values(table: &Table, row: usize) -> Vec<String> {
    let axes = table.axes().iter();
    axes.map(|axis| full_value(axis, axis.text(row))).collect()
}

pub(crate) fn object(study: &Study) -> Option<String> {
    let table = study.setting("scene.object")?.as_table()?;
    let kind = table.get("kind")?.as_str()?.replace('-', " ");
    let numbers = table.iter().filter_map(|(key, value)| {
        let value = number::rounded(study::number(value)?);
        Some(format!("{} = {value}", key.replace('_', " ")))
    });
    let parts: Vec<String> = std::iter::once(kind).chain(numbers).collect();
    Some(parts.join(", "))
}

/// Text with the number of failed trials in the cells of `rows`, for each kind of failure; `None` if no trial failed.
pub(crate) fn failed(study: &Study, rows: &[usize]) -> Option<String> {
    let table = study.cells();
    // Count each cell only once, because the rows of its quantities describe the same trials.
    let cells: BTreeMap<u64, usize> = rows.iter().map(|row| (table.cell(*row), *row)).collect();
    let sum = |name: &str| {
        let counts = cells.values();
        let counts = counts.filter_map(|row| table.statistic(*row, name));
        counts.sum::<f64>() as u64
    };
    let failed = sum("failures");
    if failed == 0 {
        return None;
    }
    let mut kinds: BTreeMap<&str, u64> = BTreeMap::new();
    let failures = study.failures().iter();
    for failure in failures.filter(|failure| cells.contains_key(&failure.cell)) {
        let count = kinds.entry(&failure.kind).or_default();
        *count = count.saturating_add(failure.count);
    }
    let text = |(kind, count): (&&str, &u64)| format!("{kind} {}", number::grouped(*count));
    let kinds = match kinds.iter().map(text).collect::<Vec<_>>().join(", ") {
        none if none.is_empty() => none,
        kinds => format!(" ({kinds})"),
    };
    let (failed, trials) = (number::grouped(failed), number::grouped(sum("trials")));
    Some(format!(
        "Left out of every average: failed trials, {failed} of {trials}{kinds}."
    ))
}

/// Text that lists the values `absent`, which the key `where` of a plot names but the table does not contain; `None` if
/// there are no such values.
pub(crate) fn absent(absent: &[String]) -> Option<String> {
    let none = absent.is_empty();
    (!none).then(|| format!("Not in the table: {}.", absent.join(", ")))
}

/// End of an error message that lists the values `absent`, which the key `where` of a plot names but the table does not
/// contain.
pub(crate) fn lost(absent: &[String]) -> String {
    let lost = absent
        .iter()
        .map(|lost| format!("; the table has no {lost}"));
    lost.collect()
}
