//! Drawing a laid-out figure.

use super::canvas::{Anchor, Canvas, Drawn, Point};
use super::figure::{Figure, Line, Mark, Panel, PointSet};
use super::layout::{EDGE, LEADING, Layout, SAMPLE, Sample, TEXT, TICK_GAP, TITLE};
use super::lettering::width;
use plotters::prelude::{DrawingBackend, RGBColor};

pub(crate) const INK: RGBColor = RGBColor(34, 34, 34);
pub(crate) const QUIET: RGBColor = RGBColor(90, 90, 90);
pub(crate) const FRAME: RGBColor = RGBColor(120, 120, 120);
pub(crate) const GRID: RGBColor = RGBColor(210, 210, 210);
pub(crate) const FAINT: RGBColor = RGBColor(238, 238, 238);
pub(crate) const WHITE: RGBColor = RGBColor(255, 255, 255);

const STROKE: f64 = 2.5;
const MARKER: f64 = 6.0;
const OPEN_MARKER: f64 = 7.0;
/// Lines of more points than this get small markers.
const MANY_POINTS: usize = 25;

/// Draws the figure on a white ground.
pub(crate) fn draw<B: DrawingBackend>(
    figure: &Figure,
    layout: &Layout,
    canvas: &Canvas<B>,
) -> Drawn {
    let y = paragraph(canvas, &layout.title, layout.top, TITLE, INK)?;
    paragraph(canvas, &layout.subtitle, y, TEXT, QUIET)?;
    paragraph(canvas, &layout.notes, layout.notes_at, TEXT, QUIET)?;
    canvas.text(&figure.y_label, layout.y_label_at, TEXT, Anchor::Left, INK)?;
    canvas.text(
        &figure.x_label,
        layout.x_label_at,
        TEXT,
        Anchor::Middle,
        INK,
    )?;
    for (at, (panel, corner)) in figure.panels.iter().zip(&layout.panels).enumerate() {
        Frame {
            figure,
            layout,
            panel,
            corner: *corner,
            at,
        }
        .draw(canvas)?;
    }
    legend(figure, layout, canvas)
}

/// Lines of text at the left edge from `top` down; returns where the next would begin.
pub(crate) fn paragraph<B: DrawingBackend>(
    canvas: &Canvas<B>,
    lines: &[String],
    top: f64,
    size: f64,
    colour: RGBColor,
) -> Result<f64, String> {
    let mut y = top;
    for line in lines {
        canvas.text(line, (EDGE, y + size / 2.0), size, Anchor::Left, colour)?;
        y += size * LEADING;
    }
    Ok(y)
}

fn legend<B: DrawingBackend>(figure: &Figure, layout: &Layout, canvas: &Canvas<B>) -> Drawn {
    let (left, top) = layout.legend_at;
    let mut y = top + TEXT / 2.0;
    for entry in &layout.legend {
        let ends = [(left, y), (left + SAMPLE, y)];
        let middle = (left + SAMPLE / 2.0, y);
        match entry.sample {
            Sample::Heading | Sample::Continued => {}
            Sample::Solid => {
                canvas.line(&ends, QUIET, STROKE)?;
                if figure.markers {
                    canvas.disc(middle, MARKER - 1.0, QUIET)?;
                }
            }
            Sample::Dashed => canvas.dashes(&ends, QUIET, STROKE)?,
            Sample::Series(at) => {
                let style = figure.legend.entries[at].1;
                canvas.line(&ends, style.colour, STROKE)?;
                if figure.markers {
                    canvas.marker(style.marker, middle, MARKER, style.colour)?;
                }
            }
            Sample::Points(at) => {
                let style = figure.legend.points[at].1;
                canvas.open_marker(style.marker, middle, OPEN_MARKER, style.colour)?;
            }
        }
        canvas.text(
            &entry.text,
            (left + entry.indent(), y),
            TEXT,
            Anchor::Left,
            INK,
        )?;
        y += TEXT * LEADING;
    }
    Ok(())
}

/// One panel in its place.
struct Frame<'a> {
    figure: &'a Figure,
    layout: &'a Layout,
    panel: &'a Panel,
    corner: Point,
    at: usize,
}

impl Frame<'_> {
    fn x(&self, value: f64) -> f64 {
        self.corner.0 + self.figure.x.place(value) * self.layout.panel.0
    }

    fn y(&self, value: f64) -> f64 {
        self.corner.1 + (1.0 - self.figure.y.place(value)) * self.layout.panel.1
    }

    /// Left, right, top and bottom.
    fn edges(&self) -> (f64, f64, f64, f64) {
        let (left, top) = self.corner;
        (
            left,
            left + self.layout.panel.0,
            top,
            top + self.layout.panel.1,
        )
    }

    fn draw<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Drawn {
        self.grid(canvas)?;
        self.labels(canvas)?;
        for mark in &self.figure.marks {
            self.mark(mark, canvas)?;
        }
        for line in &self.panel.lines {
            self.stroke(line, canvas)?;
        }
        // Markers last, so that no line crosses one.
        let marked = |line: &&Line| self.figure.markers && !line.dashed;
        for line in self.panel.lines.iter().filter(marked) {
            let crowded = line.runs.iter().map(Vec::len).sum::<usize>() > MANY_POINTS;
            let size = if crowded { 0.6 * MARKER } else { MARKER };
            for (x, y) in line.runs.iter().flatten() {
                canvas.marker(
                    line.style.marker,
                    (self.x(*x), self.y(*y)),
                    size,
                    line.style.colour,
                )?;
            }
        }
        for PointSet { style, at, .. } in &self.panel.points {
            for (x, y) in at {
                let place = (self.x(*x), self.y(*y));
                canvas.open_marker(style.marker, place, OPEN_MARKER, style.colour)?;
            }
        }
        Ok(())
    }

    fn grid<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Drawn {
        let (left, right, top, bottom) = self.edges();
        let up = |x: f64, colour| canvas.line(&[(x, top), (x, bottom)], colour, 1.0);
        let across = |y: f64, colour| canvas.line(&[(left, y), (right, y)], colour, 1.0);
        for value in self.figure.x.minor(self.layout.x_ticks.len()) {
            up(self.x(value), FAINT)?;
        }
        for value in self.figure.y.minor(self.layout.y_ticks.len()) {
            across(self.y(value), FAINT)?;
        }
        for (value, _) in &self.layout.x_ticks {
            up(self.x(*value), GRID)?;
        }
        for tick in &self.layout.y_ticks {
            across(self.y(tick.at), GRID)?;
        }
        canvas.line(
            &[
                (left, top),
                (right, top),
                (right, bottom),
                (left, bottom),
                (left, top),
            ],
            FRAME,
            1.0,
        )
    }

    fn labels<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Drawn {
        let (left, right, top, bottom) = self.edges();
        for (value, lines) in &self.layout.x_ticks {
            for (at, line) in lines.iter().enumerate() {
                let y = bottom + TICK_GAP + TEXT / 2.0 + at as f64 * TEXT * LEADING;
                canvas.text(line, (self.x(*value), y), TEXT, Anchor::Middle, INK)?;
            }
        }
        if self.at.is_multiple_of(self.layout.columns) {
            for tick in &self.layout.y_ticks {
                canvas.text(
                    &tick.label,
                    (left - TICK_GAP, self.y(tick.at)),
                    TEXT,
                    Anchor::Right,
                    INK,
                )?;
            }
        }
        match &self.panel.title {
            Some(title) => canvas.text(
                title,
                ((left + right) / 2.0, top - TEXT / 2.0 - 6.0),
                TEXT,
                Anchor::Middle,
                INK,
            ),
            None => Ok(()),
        }
    }

    fn stroke<B: DrawingBackend>(&self, line: &Line, canvas: &Canvas<B>) -> Drawn {
        for run in &line.runs {
            let points: Vec<Point> = run.iter().map(|(x, y)| (self.x(*x), self.y(*y))).collect();
            match points.as_slice() {
                [point] if line.dashed => canvas.disc(*point, STROKE, line.style.colour)?,
                [] | [_] => {}
                _ if line.dashed => canvas.dashes(&points, line.style.colour, STROKE)?,
                // Beside a dashed companion the line steps back, so that both are seen where they coincide.
                _ if self.figure.legend.compared.is_some() => {
                    canvas.line(&points, line.style.pale(), STROKE)?
                }
                _ => canvas.line(&points, line.style.colour, STROKE)?,
            }
        }
        Ok(())
    }

    /// A reference line, and in the first panel its label, where it hides the least.
    fn mark<B: DrawingBackend>(&self, mark: &Mark, canvas: &Canvas<B>) -> Drawn {
        let (left, right, top, bottom) = self.edges();
        let (x, y) = (self.x(mark.at), self.y(mark.at));
        let ends = if mark.on_x {
            [(x, bottom), (x, top)]
        } else {
            [(left, y), (right, y)]
        };
        canvas.dashes(&ends, FRAME, 1.5)?;
        if self.at > 0 || mark.label.is_empty() {
            return Ok(());
        }
        let (wide, half) = (width(&mark.label, TEXT), 0.6 * TEXT);
        let places: Vec<Point> = if mark.on_x {
            let sides = [x + 6.0, x - 6.0 - wide];
            [0.03, 0.97, 0.25, 0.5, 0.75]
                .iter()
                .flat_map(|share| {
                    sides.map(|side| (side, top + half + share * (bottom - top - 2.0 * half)))
                })
                .collect()
        } else {
            let sides = [y - half - 2.0, y + half + 2.0];
            [0.98, 0.02, 0.5, 0.25, 0.75]
                .iter()
                .flat_map(|share| sides.map(|side| (left + share * (right - left - wide), side)))
                .collect()
        };
        let inside = |(x, y): &Point| {
            *x >= left && x + wide <= right && y - half >= top && y + half <= bottom
        };
        let hidden =
            |(x, y): &Point| self.crossings((x - 4.0, x + wide + 4.0), (y - half, y + half));
        let Some((x, y)) = places.into_iter().filter(inside).min_by_key(hidden) else {
            return Ok(());
        };
        let ground = [
            (x - 3.0, y - half),
            (x + wide, y - half),
            (x + wide, y + half),
            (x - 3.0, y + half),
        ];
        canvas.polygon(&ground, WHITE)?;
        canvas.text(&mark.label, (x, y), TEXT, Anchor::Left, QUIET)
    }

    /// How much of the panel's lines and points lies within a box: places along the lines, ten to a segment.
    fn crossings(&self, x: (f64, f64), y: (f64, f64)) -> usize {
        let within = |(px, py): Point| px >= x.0 && px <= x.1 && py >= y.0 && py <= y.1;
        let points = self.panel.points.iter().flat_map(|set| &set.at);
        let mut count = 3 * points
            .filter(|(x, y)| within((self.x(*x), self.y(*y))))
            .count();
        for run in self.panel.lines.iter().flat_map(|line| &line.runs) {
            let points: Vec<Point> = run.iter().map(|(x, y)| (self.x(*x), self.y(*y))).collect();
            count += 3 * points.iter().filter(|point| within(**point)).count();
            for pair in points.windows(2) {
                let along = |k: u8| {
                    let share = f64::from(k) / 20.0;
                    (
                        pair[0].0 + share * (pair[1].0 - pair[0].0),
                        pair[0].1 + share * (pair[1].1 - pair[0].1),
                    )
                };
                count += (0..=20).filter(|k| within(along(*k))).count();
            }
        }
        count
    }
}
