//! Bar charts: one horizontal bar per named item, with its 95 % interval.

use super::drawing::Figure;
use super::scale::{Scale, Spacing};
use super::series::{self, Content, Line, Mark, Plot};
use super::sheet::{HAIR, Words};
use super::style::{INK, Style, pale};
use crate::ReportError;
use plotters::style::Color;

/// Content of a bar chart. The first item is drawn at the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Bars {
    /// Name of the figure's files, without extension.
    pub name: String,
    /// Title of the chart.
    pub title: String,
    /// Line of text below the title.
    pub subtitle: String,
    /// Label of the horizontal axis, along which the numbers are drawn as bars.
    pub axis: String,
    /// Name, number and standard error of each item. The number is the length of the item's bar.
    pub bars: Vec<(String, f64, f64)>,
    /// Lines of text below the chart.
    pub notes: Vec<String>,
}

/// Half the height of a bar, relative to the distance between bars.
const HALF_WIDTH: f64 = 0.32;
const NORMAL_95: f64 = 1.96;

/// Draws a bar from 0 to each number, with its 95 % interval as a line.
///
/// ```
/// use palpate_report::{Bars, bar_figure};
///
/// let figure = bar_figure(&Bars {
///     name: "sensitivity".to_owned(),
///     title: "What changes the error?".to_owned(),
///     subtitle: String::new(),
///     axis: "change of the error (%)".to_owned(),
///     bars: vec![("noise".to_owned(), 1.0, 0.1), ("roll length".to_owned(), -0.9, 0.1)],
///     notes: Vec::new(),
/// })?;
/// assert!(figure.svg.contains("roll length"));
/// # Ok::<(), palpate_report::ReportError>(())
/// ```
///
/// # Errors
/// The figure is too large.
pub fn bar_figure(chart: &Bars) -> Result<Figure, ReportError> {
    let style = Style::of(0);
    let mut content = Content::default();
    let mut ends = vec![0.0];
    for (place, (_, number, std)) in chart.bars.iter().enumerate() {
        let y = place as f64;
        let [low, high] = [number - NORMAL_95 * std, number + NORMAL_95 * std];
        let corners = [
            (0.0, y - HALF_WIDTH),
            (*number, y - HALF_WIDTH),
            (*number, y + HALF_WIDTH),
            (0.0, y + HALF_WIDTH),
        ];
        content.grounds.push((corners.to_vec(), pale(style.colour)));
        let interval = vec![(low, y), (high, y)];
        content.lines.push(Line::new(style, false, vec![interval]));
        ends.extend([low, high]);
    }
    let names: Vec<String> = chart.bars.iter().map(|(name, ..)| name.clone()).collect();
    let x = Scale::around(Spacing::log(false), ends.into_iter());
    let labels = [chart.axis.clone(), String::new()];
    let plot = Plot {
        marks: vec![Mark {
            on_x: true,
            at: 0.0,
            label: String::new(),
            style: INK.stroke_width(HAIR),
        }],
        marker: 0.0,
        ..Plot::new(
            labels,
            [x, Scale::of_names(names).reversed()],
            vec![content],
        )
    };
    let words = Words::new(&chart.name, &chart.title, &chart.subtitle, &chart.notes);
    series::figure(words, vec![plot])
}
