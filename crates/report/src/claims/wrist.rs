//! Claim 21: a wrist force sensor against pads (1996 paper, section 4.1.3).

use super::evidence::{convex_rows, groups, range, short, span};
use super::finding::Finding;
use crate::Study;

/// "Acts like" is within this factor.
const ALIKE: f64 = 1.5;

/// Claim 21.
pub(super) fn acts_like_pads(study: &Study) -> Result<Finding, String> {
    let table = study.cells();
    let sensor = table
        .axis("scene.sensor")
        .ok_or("the table has no axis scene.sensor with labels")?;
    let rows = convex_rows(study, "normal_curvature_u")?;
    let size_of = |row: usize, kind: &str| {
        let mut tokens = sensor.text(row).strip_prefix(kind)?.split_whitespace();
        tokens
            .next()?
            .parse::<f64>()
            .ok()
            .filter(|size| *size > 0.0)
    };
    let (mut ratios, mut alike) = (Vec::new(), Vec::new());
    let mut names = None;
    for group in groups(study, &rows, &["scene.sensor"]) {
        let error = |row: &usize| {
            table
                .statistic(*row, "relative_rms_error")
                .filter(|error| *error > 0.0)
        };
        let Some((wrist, size, wrist_error)) = group
            .iter()
            .find_map(|row| Some((*row, size_of(*row, "wrist ")?, error(row)?)))
        else {
            continue;
        };
        let mut pads: Vec<(f64, f64, usize)> = group
            .iter()
            .filter_map(|row| Some((size_of(*row, "pads ")?, error(row)?, *row)))
            .collect();
        pads.sort_by(|a, b| a.0.total_cmp(&b.0));
        let apart = |pad: &(f64, f64, usize)| libm::log(pad.0 / size).abs();
        let Some(nearest) = pads.iter().min_by(|a, b| apart(a).total_cmp(&apart(b))) else {
            continue;
        };
        if apart(nearest) > libm::log(ALIKE) / 2.0 {
            continue;
        }
        names = Some((sensor.text(wrist), sensor.text(nearest.2)));
        ratios.push(wrist_error / nearest.1);
        alike.extend(equal_size(&pads, wrist_error));
    }
    let (Some(ratio), Some((wrist, pads))) = (range(ratios.iter().copied()), names) else {
        return Err(
            "no rows labelled \"wrist SIZE\" beside \"pads SIZE\" of that size with an rms error"
                .to_owned(),
        );
    };
    let like = match range(alike.iter().copied()) {
        None => "Its error is outside what the pads span everywhere.".to_owned(),
        Some(sizes) => format!(
            "It acts like pads of {} mm at {} of them; elsewhere its error is outside what the pads span.",
            span(sizes, short),
            alike.len()
        ),
    };
    Ok(Finding {
        holds: ratio.0 >= 1.0 / ALIKE && ratio.1 <= ALIKE,
        measured: format!(
            "The rms error of \"{wrist}\" is {} × that of \"{pads}\", over {} objects. {like}",
            span(ratio, short),
            ratios.len()
        ),
        why: format!(
            "Holds if it is within a factor of {ALIKE} at every object; pad sizes are interpolated between logarithms. A mean distance of 0.54 mm is a standard deviation of 0.43 mm along each axis, more than that of the rounding of 0.54 mm pads (0.54/√12 = 0.16 mm)."
        ),
    })
}

/// The pad size whose error is `error`, between neighbours of `pads` (size, error, row) in order of size; none
/// if the error is outside what they span.
fn equal_size(pads: &[(f64, f64, usize)], error: f64) -> Option<f64> {
    pads.windows(2).find_map(|pair| {
        let ((x0, y0, _), (x1, y1, _)) = (pair[0], pair[1]);
        (y0 < y1 && (y0..=y1).contains(&error))
            .then(|| x0 * libm::pow(x1 / x0, libm::log(error / y0) / libm::log(y1 / y0)))
    })
}
