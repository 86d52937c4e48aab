//! Section of the page on how often intervals hold the truth.

use super::size::least;
use crate::calibration::{Estimator, Measured, means};
use crate::{ReportError, Study, plot};
use minijinja::context;
use minijinja::value::Value;
use palpate_study::label;
use palpate_study::number::grouped;

/// Share below which an interval of 95 % falls short.
const SHORT: f64 = 0.90;

/// Measurements of the intervals of each estimator by the studies; `None` where they measure none.
///
/// # Errors
/// The figure cannot be drawn.
pub(super) fn section(studies: &[Study]) -> Result<Option<Value>, ReportError> {
    let estimators = Estimator::all(studies);
    if estimators.is_empty() {
        return Ok(None);
    }
    let figure = plot::calibration(&estimators)?;
    let least = least(&figure);
    let svg = Value::from_safe_string(figure.svg);
    let estimators: Vec<Value> = estimators.iter().map(|it| estimator(it, studies)).collect();
    Ok(Some(
        context! { svg, least, estimators, short => percent(SHORT) },
    ))
}

fn estimator(estimator: &Estimator, studies: &[Study]) -> Value {
    let rows: Vec<&Measured> = estimator.rows().collect();
    let of_studies: Vec<Value> = estimator
        .studies
        .iter()
        .map(|(place, rows)| {
            let study = &studies[*place];
            let lowest = rows
                .iter()
                .min_by(|a, b| a.shares[2].total_cmp(&b.shares[2]));
            let lowest = lowest.map(|row| (percent(row.shares[2]), words(study, row.row)));
            context! {
                section => place + 1,
                name => study.name(),
                lowest,
                ..counted(&rows.iter().collect::<Vec<_>>())
            }
        })
        .collect();
    context! { name => &estimator.name, studies => of_studies, ..counted(&rows) }
}

/// Number of rows, their mean shares, and how many fall short.
fn counted(rows: &[&Measured]) -> Value {
    let shares = means(rows.iter().copied()).map(percent);
    let short = rows.iter().filter(|row| row.shares[2] < SHORT).count();
    context! { rows => grouped(rows.len() as u64), shares, short => grouped(short as u64) }
}

/// Quantity and swept values of a row.
fn words(study: &Study, row: usize) -> String {
    let table = study.cells();
    let quantity = label::quantity(table.quantity(row));
    let values = plot::swept_values(table, row);
    std::iter::once(quantity)
        .chain(values)
        .collect::<Vec<_>>()
        .join(", ")
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}
