//! Claim 15: a Gaussian on what a layer of skin filters (2020 paper, section IV.B, Fig. 8a).

use super::evidence::{range, short, span};
use super::finding::Finding;
use super::presses::{kind, label, rows_of};
use crate::Study;

const PUBLISHED: f64 = 0.96;
/// Allowed difference from the published R², which has two digits.
const TOLERANCE: f64 = 0.01;

/// Claim 15.
pub(super) fn fits_the_filtered_profile(study: &Study) -> Result<Finding, String> {
    let table = study.cells();
    // A press without noise is tried once.
    let noiseless = |row: &usize| table.statistic(*row, "trials") == Some(1.0);
    let gaussian = |row: &usize| kind(study, *row, "scene.estimator") == Some("gaussian");
    let filtered = |row: &usize| kind(study, *row, "scene.model") == Some("half-space");
    let rows: Vec<usize> = rows_of(study, "r_squared")
        .into_iter()
        .filter(|row| noiseless(row) && gaussian(row) && filtered(row))
        .collect();
    let mut estimators: Vec<&str> = Vec::new();
    for row in &rows {
        estimators
            .extend(label(study, *row, "scene.estimator").filter(|e| !estimators.contains(e)));
    }
    // How the samples are spread weighs them; which samples are fitted is the estimator's choice.
    let mut weightings: Vec<(String, Vec<f64>)> = Vec::new();
    for row in rows {
        let Some(found) = table.statistic(row, "mean") else {
            continue;
        };
        let layout = label(study, row, "scene.probe.layout").unwrap_or("the only layout");
        let name = match label(study, row, "scene.estimator") {
            Some(estimator) if estimators.len() > 1 => format!("{layout}, {estimator}"),
            _ => layout.to_owned(),
        };
        match weightings.iter_mut().find(|(known, _)| *known == name) {
            Some((_, all)) => all.push(found),
            None => weightings.push((name, vec![found])),
        }
    }
    if weightings.is_empty() {
        return Err(
            "the table has no r_squared of a gaussian on a half-space press without noise"
                .to_owned(),
        );
    }
    let close = |found: &f64| (found - PUBLISHED).abs() <= TOLERANCE * (1.0 + 1e-9);
    let told = weightings.iter().filter_map(|(name, found)| {
        let range = range(found.iter().copied())?;
        Some(format!("{} ({name})", span(range, short)))
    });
    Ok(Finding {
        holds: weightings.iter().any(|(_, found)| found.iter().all(close)),
        measured: format!(
            "R² of the Gaussian on the profile of the half-space, by how the samples are spread: {}.",
            told.collect::<Vec<_>>().join(", ")
        ),
        why: format!(
            "Holds if for some spread of the samples every R² is within {TOLERANCE} of {PUBLISHED}: the paper does not say how it weighs them."
        ),
    })
}
