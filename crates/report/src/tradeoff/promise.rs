//! `promise.csv`: whether `auto` takes a rung that errs within the tolerance and costs little more than the cheapest.

use crate::records::Records;
use crate::{Files, ReportError};

/// Verdict on `auto` over random scenes of one kind.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Promise {
    pub(crate) kind: String,
    pub(crate) scenes: usize,
    /// Scenes on which the promise is kept.
    pub(crate) kept: usize,
    /// Scenes for which another rung would do.
    pub(crate) with_rivals: usize,
    /// The largest ratio of instructions, taken over cheapest.
    pub(crate) dearest: Option<f64>,
}

/// Reads the table; kinds in the order in which they appear.
///
/// # Errors
/// The table is malformed.
pub(super) fn read(files: &Files) -> Result<Vec<Promise>, ReportError> {
    let columns = ["kind", "competitors", "ratio", "kept"];
    let table = Records::read(files, "promise.csv", &columns)?.filled()?;
    let is_kept = |row: usize| match table.text(row, 3) {
        "yes" => Ok(true),
        "no" => Ok(false),
        _ => Err(table.bad(row, 3, "yes or no")),
    };
    let promise = |(kind, rows): (&str, Vec<usize>)| -> Result<Promise, ReportError> {
        let mut promise = Promise {
            kind: kind.to_owned(),
            scenes: rows.len(),
            kept: 0,
            with_rivals: 0,
            dearest: None,
        };
        for row in rows {
            promise.with_rivals += usize::from(table.number(row, 1)? > 0.0);
            promise.kept += usize::from(is_kept(row)?);
            let ratio = table.number_or_none(row, 2)?;
            promise.dearest = promise.dearest.into_iter().chain(ratio).reduce(f64::max);
        }
        Ok(promise)
    };
    table.by_text(0).into_iter().map(promise).collect()
}
