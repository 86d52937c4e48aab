//! The legend to the right of a chart's panels.

use super::content::{Chart, Legend};
use crate::plot::canvas::{Anchor, Canvas, Point};
use crate::plot::frame::{LINE, SAMPLE_GAP, TEXT};
use crate::plot::lettering::{width, wrap};
use crate::plot::style::{INK, MARKER, OPEN_MARKER, QUIET, STROKE, Style};

/// Length of a line's sample.
const SAMPLE: f64 = 40.0;
const LIMIT: f64 = 250.0;

/// Line of the legend: a text, and the sample before it.
pub(super) struct Entry {
    text: String,
    sample: Sample,
}

/// Sample before a line of the legend.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Sample {
    /// None, and no room for one: the line is a heading.
    Heading,
    /// None, but room for one: the line continues the one above.
    Continued,
    /// Line and marker of a series.
    Series(Style),
    /// A solid line, for the first of two statistics.
    Solid,
    /// A dashed line, for the second of two statistics.
    Dashed,
    /// An open marker.
    Points(Style),
}

impl Entry {
    /// Distance from the legend's left edge to the text, pixels.
    fn indent(&self) -> f64 {
        match self.sample {
            Sample::Heading => 0.0,
            _ => SAMPLE + SAMPLE_GAP,
        }
    }

    pub(super) fn width(&self) -> f64 {
        self.indent() + width(&self.text, TEXT)
    }
}

/// Lines of the legend, from the top.
pub(super) fn entries(legend: &Legend) -> Vec<Entry> {
    let series = |(text, style): &(String, Style)| (text.clone(), Sample::Series(*style));
    let points = |(text, style): &(String, Style)| (text.clone(), Sample::Points(*style));
    let compared = legend.compared.iter();
    let compared = compared.flat_map(|(solid, dashed)| {
        [
            (solid.clone(), Sample::Solid),
            (dashed.clone(), Sample::Dashed),
        ]
    });
    let heading = (legend.title.clone(), Sample::Heading);
    let all = std::iter::once(heading)
        .chain(legend.entries.iter().map(series))
        .chain(compared)
        .chain(legend.points.iter().map(points));
    let wrapped = |(text, sample): (String, Sample)| {
        let (limit, next) = match sample {
            Sample::Heading => (LIMIT, Sample::Heading),
            _ => (LIMIT - SAMPLE, Sample::Continued),
        };
        let samples = std::iter::once(sample).chain(std::iter::repeat(next));
        let lines = wrap(&text, TEXT, limit).into_iter().zip(samples);
        lines.map(|(text, sample)| Entry { text, sample })
    };
    all.flat_map(wrapped).collect()
}

/// Draws the legend from its upper left corner on; returns how far down it reaches.
pub(super) fn draw(
    canvas: &mut Canvas,
    chart: &Chart,
    entries: &[Entry],
    (left, top): Point,
) -> f64 {
    let mut y = top + TEXT / 2.0;
    for entry in entries {
        let (ends, middle) = ([(left, y), (left + SAMPLE, y)], (left + SAMPLE / 2.0, y));
        match entry.sample {
            Sample::Heading | Sample::Continued => {}
            Sample::Solid => {
                canvas.line(&ends, QUIET, STROKE);
                if chart.markers {
                    canvas.disc(middle, MARKER - 1.0, QUIET);
                }
            }
            Sample::Dashed => canvas.dashes(&ends, QUIET, STROKE),
            Sample::Series(style) => {
                canvas.line(&ends, style.colour, STROKE);
                if chart.markers {
                    canvas.marker(style.marker, middle, MARKER, style.colour);
                }
            }
            Sample::Points(style) => {
                canvas.open_marker(style.marker, middle, OPEN_MARKER, style.colour);
            }
        }
        let place = (left + entry.indent(), y);
        canvas.text(&entry.text, place, TEXT, Anchor::Left, INK);
        y += LINE;
    }
    y - TEXT / 2.0
}
