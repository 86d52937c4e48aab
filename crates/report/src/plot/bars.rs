//! Bar charts: one horizontal bar per named item, with its 95 % interval.

use super::scale::{Scale, Spacing};
use super::series::{Content, Line, Mark, Plot};
use super::sheet::HAIR;
use super::style::{INK, Style, pale};
use plotters::style::Color;

/// Half the height of a bar, relative to the distance between bars.
const HALF_WIDTH: f64 = 0.32;
const NORMAL_95: f64 = 1.96;

/// Plot with a bar from 0 to each number of `bars`, and its 95 % interval as a line; see
/// [`AnswerChart::Bars`](super::answer_figure::AnswerChart::Bars).
pub(super) fn plot(axis: &str, bars: &[(String, f64, f64)]) -> Plot {
    let style = Style::of(0);
    let mut content = Content::default();
    let mut ends = vec![0.0];
    for (place, (_, number, std)) in bars.iter().enumerate() {
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
    let names: Vec<String> = bars.iter().map(|(name, ..)| name.clone()).collect();
    let x = Scale::around(Spacing::log(false), ends.into_iter());
    let labels = [axis.to_owned(), String::new()];
    Plot {
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
    }
}
