//! `extremes.csv`: how many cases of each entry point ended how, and the worst error.

use crate::group::distinct;
use crate::records::Records;
use crate::{Files, ReportError};
use minijinja::context;
use minijinja::value::Value;
use palpate_study::number;

/// A case at the extremes.
struct Case<'a> {
    entry: &'a str,
    verdict: &'a str,
    /// Error and bound, where both are known.
    error: Option<(f64, f64)>,
}

/// Cases of each entry point by verdict, and its worst error; entry points and verdicts in the order in which they
/// appear.
pub(super) fn section(folder: &Files) -> Result<Value, ReportError> {
    let columns = ["entry", "verdict", "error", "bound"];
    let table = Records::read(folder, "extremes.csv", &columns)?.filled()?;
    let cases: Vec<Case<'_>> = (0..table.rows())
        .map(|row| case(&table, row))
        .collect::<Result<_, _>>()?;
    let verdicts = distinct(cases.iter().map(|case| case.verdict));
    let counts = |wanted: &dyn Fn(&Case<'_>) -> bool| -> Vec<String> {
        let of = |verdict: &&str| {
            let found = cases
                .iter()
                .filter(|case| case.verdict == *verdict && wanted(case));
            match found.count() {
                0 => String::new(),
                count => number::grouped(count as u64),
            }
        };
        verdicts.iter().map(of).collect()
    };
    let entries: Vec<Value> = distinct(cases.iter().map(|case| case.entry))
        .into_iter()
        .map(|name| {
            let is_mine = |case: &Case<'_>| case.entry == name;
            let worst = worst(cases.iter().filter(|case| is_mine(case)));
            let [error, bound] = worst.map_or([const { String::new() }; 2], |(error, bound)| {
                [error, bound].map(|error| number::significant(error, 2))
            });
            context! { name, counts => counts(&is_mine), error, bound }
        })
        .collect();
    let totals = counts(&|_| true);
    let all = number::grouped(cases.len() as u64);
    let verdicts: Vec<String> = verdicts.iter().map(|&name| name.to_owned()).collect();
    Ok(context! { verdicts, entries, totals, all })
}

fn case(table: &Records, row: usize) -> Result<Case<'_>, ReportError> {
    Ok(Case {
        entry: table.text(row, 0),
        verdict: table.text(row, 1),
        error: table
            .number_or_none(row, 2)?
            .zip(table.number_or_none(row, 3)?),
    })
}

/// The error that is largest beside its bound.
fn worst<'a>(cases: impl Iterator<Item = &'a Case<'a>>) -> Option<(f64, f64)> {
    let share = |(error, bound): (f64, f64)| if error == 0.0 { 0.0 } else { error / bound };
    let errors = cases.filter_map(|case| case.error);
    errors.reduce(|worst, one| {
        if share(one) > share(worst) {
            one
        } else {
            worst
        }
    })
}
