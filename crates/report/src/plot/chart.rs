//! Charts: lines and points in panels on the same scales, with a legend.

mod content;
mod legend;
mod panel;
mod room;

use super::canvas::Anchor;
use super::figure::Figure;
use super::frame::{Axes, EDGE, Frame, LINE, TEXT, Words};
use super::style::INK;
use crate::ReportError;
use panel::Placed;
use room::{GAP, Room};

pub(crate) use content::{Chart, Legend, Line, Mark, Panel, PointSet, Runs, scales};

/// Figure of charts below each other, at least one.
pub(crate) fn figure(words: Words, charts: &[Chart]) -> Result<Figure, ReportError> {
    let rooms = Room::for_all(charts);
    let total = rooms.iter().map(|room| room.total).fold(0.0, f64::max);
    let mut frame = Frame::new(words, total);
    for (at, (chart, room)) in charts.iter().zip(&rooms).enumerate() {
        if at > 0 {
            frame.top += EDGE - 6.0;
        }
        draw(&mut frame, chart, room);
    }
    frame.finish()
}

fn draw(frame: &mut Frame, chart: &Chart, room: &Room) {
    let canvas = &mut frame.canvas;
    let (left, right) = room.margins;
    let y_label = (EDGE, frame.top + 14.0 + TEXT / 2.0);
    canvas.text(&chart.y_label, y_label, TEXT, Anchor::Left, INK);
    let top = frame.top + 14.0 + LINE + 6.0;
    for (at, panel) in chart.panels.iter().enumerate() {
        let (row, column) = ((at / room.columns) as f64, (at % room.columns) as f64);
        let axes = Axes {
            x: &chart.x,
            y: &chart.y,
            corner: (
                left + column * (room.panel.0 + GAP),
                top + row * room.row + room.heading,
            ),
            size: room.panel,
        };
        let placed = Placed {
            chart,
            room,
            panel,
            axes,
            at,
        };
        placed.draw(canvas);
    }
    let corner = (room.total - right + GAP, top + room.heading);
    let legend = legend::draw(canvas, chart, &room.legend, corner);
    let mut bottom = top + chart.panels.len().div_ceil(room.columns) as f64 * room.row;
    if !chart.x_label.is_empty() {
        let middle = left + (room.total - right - left) / 2.0;
        let place = (middle, bottom + TEXT / 2.0 - 2.0);
        canvas.text(&chart.x_label, place, TEXT, Anchor::Middle, INK);
        bottom += LINE;
    }
    frame.top = bottom.max(legend);
}
