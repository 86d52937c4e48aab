//! Intervals stated and measured, one panel per estimator.

use super::drawing::Figure;
use super::scale::Scale;
use super::series::{self, Content, Line, Plot, SeriesKey};
use super::sheet::{MARKER, Words};
use super::style::{FRAME, Marker, Style};
use crate::ReportError;
use crate::calibration::{Estimator, STATED};

/// Range of stated shares, percent.
const STATED_RANGE: [f64; 2] = [45.0, 99.0];

/// Figure of the shares of intervals that hold the true value: the median of an estimator's cells, and the range in which
/// nine of ten of them lie.
pub(crate) fn figure(estimators: &[Estimator]) -> Result<Figure, ReportError> {
    let words = Words {
        name: "calibration-of-intervals".to_owned(),
        title: "Do intervals hold the truth as often as they say?".to_owned(),
        subtitle:
            "Each panel is of one estimator and sensor, over the cells of all studies. Below the \
                   dashed line intervals are too narrow, above it too wide."
                .to_owned(),
        notes: Vec::new(),
    };
    let plot = Plot {
        x_label: "stated share of intervals that hold the true value (%)".to_owned(),
        y_label: "measured share (%)".to_owned(),
        x: Scale::exactly(STATED_RANGE[0], STATED_RANGE[1]),
        y: Scale::exactly(0.0, 100.0),
        panels: estimators.iter().map(panel).collect(),
        series: SeriesKey {
            compared: Some((
                "median cell; bars: nine of ten cells".to_owned(),
                "as stated".to_owned(),
            )),
            ..SeriesKey::default()
        },
        marks: Vec::new(),
        marker: MARKER,
        key: Vec::new(),
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
    let line = |style: Style, dashed: bool| Line {
        style,
        dashed,
        runs: Vec::new(),
        circled: Vec::new(),
        bars: Vec::new(),
    };
    let neutral = Style {
        colour: FRAME,
        marker: Marker::Dot,
    };
    Content {
        title: estimator.name.clone(),
        lines: vec![
            Line {
                runs: vec![STATED_RANGE.map(|share| (share, share)).to_vec()],
                ..line(neutral, true)
            },
            Line {
                runs: vec![points],
                bars,
                ..line(Style::of(0), false)
            },
        ],
        ..Content::default()
    }
}

/// Quantile of sorted numbers, linear between neighbours; 0 of none.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else {
        return 0.0;
    };
    let place = share * last as f64;
    let below = place as usize;
    let above = sorted[last.min(below + 1)];
    sorted[below] + (place - below as f64) * (above - sorted[below])
}

#[cfg(test)]
mod tests {
    use super::quantile;

    #[test]
    fn quantiles_lie_between_neighbours() {
        let sorted = [1.0, 2.0, 4.0];
        for (share, expected) in [(0.0, 1.0), (0.25, 1.5), (0.5, 2.0), (0.75, 3.0), (1.0, 4.0)] {
            assert_eq!(quantile(&sorted, share), expected);
        }
        assert_eq!(quantile(&[3.0], 0.95), 3.0);
        assert_eq!(quantile(&[], 0.5), 0.0);
    }
}
