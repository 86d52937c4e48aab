//! Figure with one panel per estimator. It shows the measured coverage of the estimator's intervals (the share that
//! contains the true value) over their stated coverage.

use super::drawing::Figure;
use super::scale::Scale;
use super::series::{self, Content, Line, Plot, SeriesKey};
use super::sheet::Words;
use super::style::{FRAME, Marker, Style};
use crate::ReportError;
use crate::interval_coverage::{Estimator, STATED};

/// Range of the x axis, which shows the stated coverage in percent.
const STATED_RANGE: [f64; 2] = [45.0, 99.0];

/// Draws, for each estimator, the measured coverage: the share of intervals that contain the true value. Each point is
/// the median coverage over the cells of all studies with this estimator. The bar of the point extends from the 5 % to
/// the 95 % quantile over these cells.
pub(crate) fn figure(estimators: &[Estimator]) -> Result<Figure, ReportError> {
    let words = Words::new(
        "calibration-of-intervals",
        "Do intervals contain the true value as often as stated?",
        "Each panel is of one estimator and sensor, over the cells of all studies. Below the dashed line intervals are \
         too narrow, above it too wide.",
        &[],
    );
    let labels = [
        "stated share of intervals that contain the true value (%)",
        "measured share (%)",
    ];
    let scales = [STATED_RANGE, [0.0, 100.0]].map(|[low, high]| Scale::exactly(low, high));
    let panels = estimators.iter().map(panel).collect();
    let compared = ["median cell; bars: nine of ten cells", "as stated"];
    let plot = Plot {
        series: SeriesKey {
            compared: Some(compared.map(str::to_owned).into()),
            ..SeriesKey::default()
        },
        ..Plot::new(labels.map(str::to_owned), scales, panels)
    };
    series::figure(words, vec![plot])
}

fn panel(estimator: &Estimator) -> Content {
    let mut points = Vec::new();
    let mut bars = Vec::new();
    for (at, (_, stated)) in STATED.into_iter().enumerate() {
        let mut shares: Vec<f64> = estimator.rows().map(|row| row.shares[at]).collect();
        shares.sort_by(f64::total_cmp);
        let [low, median, high] = [0.05, 0.5, 0.95].map(|share| 100.0 * quantile(&shares, share));
        points.push((100.0 * stated, median));
        bars.push((100.0 * stated, [low, high]));
    }
    let neutral = Style::new(FRAME, Marker::Dot);
    Content {
        title: estimator.name.clone(),
        lines: vec![
            Line::new(
                neutral,
                true,
                vec![STATED_RANGE.map(|share| (share, share)).to_vec()],
            ),
            Line {
                bars,
                ..Line::new(Style::of(0), false, vec![points])
            },
        ],
        ..Content::default()
    }
}

/// Quantile of the numbers `sorted`, interpolated linearly. `share` is the probability of the quantile. The result is 0
/// if there are no numbers.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else {
        return 0.0;
    };
    let place = share * last as f64;
    let below = place as usize;
    let above = sorted[last.min(below + 1)];
    sorted[below] + (place - below as f64) * (above - sorted[below])
}
