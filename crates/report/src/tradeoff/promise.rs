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
    let table = Records::read(
        files,
        "promise.csv",
        &["kind", "competitors", "ratio", "kept"],
    )?
    .filled()?;
    let mut promises: Vec<Promise> = Vec::new();
    for row in 0..table.rows() {
        let kind = table.text(row, 0);
        let known = promises.iter().position(|promise| promise.kind == kind);
        let place = known.unwrap_or(promises.len());
        if known.is_none() {
            promises.push(Promise {
                kind: kind.to_owned(),
                scenes: 0,
                kept: 0,
                with_rivals: 0,
                dearest: None,
            });
        }
        let promise = &mut promises[place];
        promise.scenes += 1;
        promise.with_rivals += usize::from(table.number(row, 1)? > 0.0);
        promise.kept += match table.text(row, 3) {
            "yes" => 1,
            "no" => 0,
            _ => return Err(table.bad(row, 3, "yes or no")),
        };
        let ratio = table.number_or_none(row, 2)?;
        promise.dearest = promise.dearest.into_iter().chain(ratio).reduce(f64::max);
    }
    Ok(promises)
}
