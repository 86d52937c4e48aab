//! A panel of a chart in its place.

use super::content::{Chart, Line, Mark, Panel, PointSet};
use super::room::Room;
use crate::plot::canvas::{Anchor, Canvas, Point};
use crate::plot::frame::{Axes, TEXT};
use crate::plot::lettering::width;
use crate::plot::style::{FAINT, FRAME, GRID, INK, MARKER, OPEN_MARKER, QUIET, STROKE, WHITE};

/// Lines of more points than this get small markers.
const MANY_POINTS: usize = 25;
/// Width of the circle around a marker.
const CIRCLE: f64 = 1.5;

/// Panel in its place.
pub(super) struct Placed<'a> {
    pub(super) chart: &'a Chart,
    pub(super) room: &'a Room,
    pub(super) panel: &'a Panel,
    pub(super) axes: Axes<'a>,
    /// Number of the panel.
    pub(super) at: usize,
}

impl Placed<'_> {
    pub(super) fn draw(&self, canvas: &mut Canvas) {
        self.grid(canvas);
        self.labels(canvas);
        for mark in &self.chart.marks {
            self.mark(mark, canvas);
        }
        for line in &self.panel.lines {
            self.stroke(line, canvas);
        }
        // Markers last, so that no line crosses one.
        let marked = |line: &&Line| self.chart.markers && !line.dashed;
        let marked: Vec<&Line> = self.panel.lines.iter().filter(marked).collect();
        let size = |line: &Line| {
            let crowded = line.runs.iter().map(Vec::len).sum::<usize>() > MANY_POINTS;
            if crowded { 0.6 * MARKER } else { MARKER }
        };
        for (width, colour) in [(CIRCLE, INK), (0.0, WHITE)] {
            for &line in &marked {
                for place in &line.circled {
                    canvas.disc(self.axes.at(*place), 1.7 * size(line) + width, colour);
                }
            }
        }
        for &line in &marked {
            self.bars(line, size(line), canvas);
        }
        for line in marked {
            for place in line.runs.iter().flatten() {
                let place = self.axes.at(*place);
                canvas.marker(line.style.marker, place, size(line), line.style.colour);
            }
        }
        for PointSet { style, at, .. } in &self.panel.points {
            for place in at {
                let place = self.axes.at(*place);
                canvas.open_marker(style.marker, place, OPEN_MARKER, style.colour);
            }
        }
    }

    fn grid(&self, canvas: &mut Canvas) {
        let Chart { x, y, .. } = self.chart;
        let Room {
            x_ticks, y_ticks, ..
        } = self.room;
        self.axes.rule(
            canvas,
            x.minor(x_ticks.len()),
            y.minor(y_ticks.len()),
            FAINT,
        );
        let xs = x_ticks.iter().map(|(at, _)| *at);
        self.axes
            .rule(canvas, xs, y_ticks.iter().map(|tick| tick.at), GRID);
        self.axes.outline(canvas);
    }

    fn labels(&self, canvas: &mut Canvas) {
        for (at, lines) in &self.room.x_ticks {
            self.axes.label_x(canvas, *at, lines);
        }
        if self.at.is_multiple_of(self.room.columns) {
            let ticks = self.room.y_ticks.iter();
            ticks.for_each(|tick| self.axes.label_y(canvas, tick));
        }
        if let Some(title) = &self.panel.title {
            let (left, right, top, _) = self.axes.edges();
            let place = ((left + right) / 2.0, top - TEXT / 2.0 - 6.0);
            canvas.text(title, place, TEXT, Anchor::Middle, INK);
        }
    }

    fn places(&self, run: &[(f64, f64)]) -> Vec<Point> {
        run.iter().map(|place| self.axes.at(*place)).collect()
    }

    fn stroke(&self, line: &Line, canvas: &mut Canvas) {
        for run in &line.runs {
            let points = self.places(run);
            match points.as_slice() {
                [point] if line.dashed => canvas.disc(*point, STROKE, line.style.colour),
                [] | [_] => {}
                _ if line.dashed => canvas.dashes(&points, line.style.colour, STROKE),
                // Beside a dashed companion the line steps back, so that both are seen where they coincide.
                _ if self.chart.legend.compared.is_some() => {
                    canvas.line(&points, line.style.pale(), STROKE);
                }
                _ => canvas.line(&points, line.style.colour, STROKE),
            }
        }
    }

    /// Bars of points, as far as they are longer than the marker and within the panel.
    fn bars(&self, line: &Line, marker: f64, canvas: &mut Canvas) {
        for (x, ends) in &line.bars {
            let colour = line.style.colour;
            self.axes.bar(canvas, *x, *ends, 2.0 * marker, colour);
        }
    }

    /// A reference line, and in the first panel its label, where it hides the least.
    fn mark(&self, mark: &Mark, canvas: &mut Canvas) {
        let (left, right, top, bottom) = self.axes.edges();
        let (wide, half) = (width(&mark.label, TEXT), 0.6 * TEXT);
        // The ends of the line, and where its label may stand.
        let (ends, places): ([Point; 2], Vec<Point>) = if mark.on_x {
            let x = self.axes.across(mark.at);
            let sides = [x + 6.0, x - 6.0 - wide];
            let at = |share: f64| {
                sides.map(|side| (side, top + half + share * (bottom - top - 2.0 * half)))
            };
            let places = [0.03, 0.97, 0.25, 0.5, 0.75].into_iter().flat_map(at);
            ([(x, bottom), (x, top)], places.collect())
        } else {
            let y = self.axes.down(mark.at);
            let sides = [y - half - 2.0, y + half + 2.0];
            let at = |share: f64| sides.map(|side| (left + share * (right - left - wide), side));
            let places = [0.98, 0.02, 0.5, 0.25, 0.75].into_iter().flat_map(at);
            ([(left, y), (right, y)], places.collect())
        };
        canvas.dashes(&ends, FRAME, 1.5);
        if self.at > 0 || mark.label.is_empty() {
            return;
        }
        let inside = |(x, y): &Point| {
            *x >= left && x + wide <= right && y - half >= top && y + half <= bottom
        };
        let hidden =
            |(x, y): &Point| self.crossings((x - 4.0, x + wide + 4.0), (y - half, y + half));
        let Some((x, y)) = places.into_iter().filter(inside).min_by_key(hidden) else {
            return;
        };
        let (right, top, bottom) = (x + wide, y - half, y + half);
        let ground = [
            (x - 3.0, top),
            (right, top),
            (right, bottom),
            (x - 3.0, bottom),
        ];
        canvas.polygon(&ground, WHITE);
        canvas.text(&mark.label, (x, y), TEXT, Anchor::Left, QUIET);
    }

    /// Share of the panel's lines and points within a box, as a count: places along the lines, twenty to a segment.
    fn crossings(&self, x: (f64, f64), y: (f64, f64)) -> usize {
        let within = |&(px, py): &Point| px >= x.0 && px <= x.1 && py >= y.0 && py <= y.1;
        let points = self
            .panel
            .points
            .iter()
            .flat_map(|set| self.places(&set.at));
        let mut count = 3 * points.filter(within).count();
        for run in self.panel.lines.iter().flat_map(|line| &line.runs) {
            let points = self.places(run);
            count += 3 * points.iter().filter(|point| within(point)).count();
            for pair in points.windows(2) {
                let [from, to] = [pair[0], pair[1]];
                let along = |k: u8| {
                    let share = f64::from(k) / 20.0;
                    (
                        from.0 + share * (to.0 - from.0),
                        from.1 + share * (to.1 - from.1),
                    )
                };
                count += (0..=20).filter(|k| within(&along(*k))).count();
            }
        }
        count
    }
}
