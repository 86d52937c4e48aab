//! Maps of the classes of shape, as small multiples: the true map, then that of each cell.

mod arrange;
mod squares;
mod table;

use super::canvas::{Anchor, Canvas, Point};
use super::cells::{self, Chosen};
use super::figure::Figure;
use super::frame::{Axes, EDGE, Frame, LINE, TEXT, TICK_GAP, WIDTH, outline, widest};
use super::lettering::{width, wrap};
use super::request::Request;
use super::scale::{Scale, Tick};
use super::style::{CLASSES, Colour, FRAME, INK, OUTLINE, QUIET, WHITE};
use crate::{ReportError, words};
use arrange::{Row, Shown};
use palpate_study::{label, number};
use squares::{Band, bands, boundaries};
use table::{CellMap, Class};

/// More panels than this are no picture.
const MOST_CELLS: usize = 60;
/// Gap between panels of a row, and between rows, pixels.
const GAP: f64 = 22.0;
/// Side of a sample in the key.
const SAMPLE: f64 = 18.0;
/// Width of a panel.
const NARROWEST: f64 = 196.0;
const WIDEST: f64 = 290.0;
/// Largest ratio of the sides of a panel.
const SLIMMEST: f64 = 3.0;
/// Bands reach this far under those painted later, so that no seam shows between them.
const OVERLAP: f64 = 1.0;
const BOUNDARY: f64 = 1.6;
/// Ground of the sample of a boundary, as light on every page.
const PALE: Colour = Colour(243, 243, 243);

/// The figure that a plot asks for.
pub(crate) fn figure(of: Request<'_>) -> Result<Figure, ReportError> {
    let maps = table::read(of)?;
    let mapped: Vec<u64> = maps.cells.iter().map(|map| map.cell).collect();
    let Chosen { rows, notes } = cells::choose(of, &mapped)?;
    if rows.len() > MOST_CELLS {
        let count = rows.len();
        return Err(of.bad(format!(
            "{count} maps are no picture; choose at most {MOST_CELLS} by `where`"
        )));
    }
    let cells = of.study.cells();
    let shown = rows.iter().filter_map(|&row| {
        let map = maps.cells.iter().find(|map| map.cell == cells.cell(row))?;
        Some(Shown { map, row })
    });
    let shown: Vec<Shown<'_>> = shown.collect();
    let arranged = arrange::rows(cells, &shown);
    let lines: Vec<Line<'_>> = arranged.iter().map(line).collect();
    let sheet = Sheet::of(&lines, &label::spoken_unit(&maps.unit));
    let mut frame = Frame::new(of.words(subtitle(of, &shown), notes), sheet.total);
    frame.key(SAMPLE, &key(&lines), sample);
    sheet.draw(&mut frame, &lines);
    frame.finish()
}

/// Subtitle of the maps: the settings that all panels share.
fn subtitle(of: Request<'_>, shown: &[Shown<'_>]) -> String {
    let rows: Vec<usize> = shown.iter().map(|cell| cell.row).collect();
    let parts = cells::in_common(of.study, &rows);
    let mut shown_of = "one trial per panel".to_owned();
    let mut sides: Vec<usize> = shown.iter().map(|cell| cell.map.side).collect();
    sides.sort_unstable();
    sides.dedup();
    if let [side] = sides.as_slice() {
        shown_of = format!("{side} × {side} points of {shown_of}");
    }
    words::sentence(&parts, &shown_of)
}

/// Row of panels.
struct Line<'a> {
    heading: &'a str,
    panels: Vec<Panel<'a>>,
}

/// Map, and where it stands.
struct Panel<'a> {
    column: usize,
    title: &'a str,
    map: &'a CellMap,
    /// Whether it shows the true classes.
    is_truth: bool,
}

/// The true map stands in the first column, which is empty where the row has none.
fn line<'a>(row: &'a Row<'a>) -> Line<'a> {
    let truth = row.truth.map(|map| Panel {
        column: 0,
        title: "truth",
        map,
        is_truth: true,
    });
    let cells = row.cells.iter().enumerate();
    let cells = cells.map(|(at, (title, map))| Panel {
        column: at + 1,
        title,
        map,
        is_truth: false,
    });
    Line {
        heading: &row.heading,
        panels: truth.into_iter().chain(cells).collect(),
    }
}

/// Sample before an entry of the key.
enum Sample {
    Class(Class),
    Boundary,
}

/// The classes that occur, in the order of their table, and the boundary if there is one.
fn key(lines: &[Line<'_>]) -> Vec<(Sample, String)> {
    let maps = || {
        let panels = lines.iter().flat_map(|line| &line.panels);
        panels.map(|panel| panel.map)
    };
    let occurs = |class: &Class| {
        maps().any(|map| map.truth.contains(class) || map.estimated.contains(class))
    };
    let named = CLASSES.iter().enumerate();
    let named = named.map(|(at, (name, _))| (Some(at), name.replace('-', " ")));
    let mut entries: Vec<(Sample, String)> = named
        .chain([(None, "not classified".to_owned())])
        .filter(|(class, _)| occurs(class))
        .map(|(class, name)| (Sample::Class(class), name))
        .collect();
    if maps().any(|map| map.truth.iter().any(|class| *class != map.truth[0])) {
        entries.push((Sample::Boundary, "true boundary".to_owned()));
    }
    entries
}

fn sample(canvas: &mut Canvas, (x, y): Point, sample: &Sample) {
    match sample {
        Sample::Class(class) => {
            let (top, bottom, right) = (y - SAMPLE / 2.0, y + SAMPLE / 2.0, x + SAMPLE);
            let square = [(x, top), (right, top), (right, bottom), (x, bottom)];
            canvas.polygon(&square, colour(*class));
            outline(canvas, (x, top), (SAMPLE, SAMPLE));
        }
        Sample::Boundary => {
            let ground = [-0.5, 0.5].map(|half| (x, y + half * SAMPLE));
            let right = |(x, y): Point| (x + SAMPLE, y);
            let [top, bottom] = ground;
            canvas.polygon(&[top, right(top), right(bottom), bottom], PALE);
            canvas.line(&[(x, y), (x + SAMPLE, y)], OUTLINE, BOUNDARY);
        }
    }
}

fn colour(class: Class) -> Colour {
    let known = class.and_then(|at| CLASSES.get(at));
    known.map_or(WHITE, |(_, colour)| *colour)
}

/// Room for the panels.
struct Sheet {
    /// Width of the picture.
    total: f64,
    columns: usize,
    /// Left edge of the first column.
    left: f64,
    /// Width and height of each panel.
    panel: (f64, f64),
    x: Scale,
    y: Scale,
    y_ticks: Vec<Tick>,
    x_label: String,
    y_label: String,
}

impl Sheet {
    /// Room for `lines`, of which there are some; `unit` is that of x and y.
    fn of(lines: &[Line<'_>], unit: &str) -> Self {
        let panels = || lines.iter().flat_map(|line| &line.panels);
        let (x, y) = (
            range(panels().map(|panel| &panel.map.x)),
            range(panels().map(|panel| &panel.map.y)),
        );
        let columns = 1 + panels().map(|panel| panel.column).max().unwrap_or(0);
        let [x_label, y_label] = ["x", "y"].map(|name| label::with_unit(name, unit));
        let y_ticks = y.ticks(2);
        let left = EDGE + TICK_GAP + widest(&y_ticks).max(width(&y_label, TEXT));
        let gaps = GAP * (columns - 1) as f64;
        let wide = ((WIDTH - left - EDGE - gaps) / columns as f64).clamp(NARROWEST, WIDEST);
        let ratio = (y.ends().1 - y.ends().0) / (x.ends().1 - x.ends().0);
        let ratio = match ratio.is_finite() {
            true => ratio.clamp(1.0 / SLIMMEST, SLIMMEST),
            false => 1.0,
        };
        Self {
            total: (left + columns as f64 * wide + gaps + EDGE).max(WIDTH),
            columns,
            left,
            panel: (wide, (wide * ratio).round()),
            x,
            y,
            y_ticks,
            x_label,
            y_label,
        }
    }

    /// Left edge of a column.
    fn column(&self, at: usize) -> f64 {
        self.left + at as f64 * (self.panel.0 + GAP)
    }

    fn draw(&self, frame: &mut Frame, lines: &[Line<'_>]) {
        for (at, line) in lines.iter().enumerate() {
            let first = self.column(1.min(self.columns - 1));
            frame.heading(line.heading, first, self.total - first - EDGE);
            let titles = line.panels.iter();
            let titles = titles.map(|panel| wrap(panel.title, TEXT, self.panel.0 + GAP - 10.0));
            let titles: Vec<Vec<String>> = titles.collect();
            let tallest = titles.iter().map(Vec::len).max().unwrap_or(0) as f64;
            frame.top += (tallest + 1.0) * LINE + 4.0;
            let below = lines.get(at + 1).map_or(&[][..], |next| &next.panels);
            let mut deep = false;
            for (order, (panel, title)) in line.panels.iter().zip(&titles).enumerate() {
                let is_lowest = below.iter().all(|next| next.column != panel.column);
                deep |= is_lowest;
                let placed = Placed {
                    sheet: self,
                    panel,
                    axes: Axes {
                        x: &self.x,
                        y: &self.y,
                        corner: (self.column(panel.column), frame.top),
                        size: self.panel,
                    },
                };
                placed.draw(&mut frame.canvas, title, is_lowest, order == 0);
            }
            let labels = if deep { TICK_GAP + LINE } else { 0.0 };
            frame.top += self.panel.1 + GAP * 1.4 + labels;
        }
        let middle = self.left + (self.columns as f64 * (self.panel.0 + GAP) - GAP) / 2.0;
        let place = (middle, frame.top - 0.7 * GAP);
        let canvas = &mut frame.canvas;
        canvas.text(&self.x_label, place, TEXT, Anchor::Middle, INK);
        frame.top = place.1 + 0.6 * TEXT;
    }
}

/// Panel in its place.
struct Placed<'a> {
    sheet: &'a Sheet,
    panel: &'a Panel<'a>,
    axes: Axes<'a>,
}

impl Placed<'_> {
    /// Draws the map with labels below and to the left, where no neighbour has them.
    fn draw(&self, canvas: &mut Canvas, title: &[String], below: bool, beside: bool) {
        let CellMap {
            side,
            truth,
            estimated,
            ..
        } = self.panel.map;
        let (_, right, top, _) = self.axes.edges();
        let [x, y] = [&self.panel.map.x, &self.panel.map.y].map(|lines| ends(lines));
        let corner = |(i, j): (usize, usize)| self.axes.at((x[i], y[j]));
        let classes = if self.panel.is_truth {
            truth
        } else {
            estimated
        };
        // In order of rising x and y: each covers what the one before reaches into it.
        for band in bands(*side, classes) {
            let Band { class, x, y } = band;
            let ((x0, y0), (x1, y1)) = (corner((x.0, y.0)), corner((x.1, y.1)));
            let (x1, y1) = ((x1 + OVERLAP).min(right), (y1 - OVERLAP).max(top));
            canvas.polygon(&[(x0, y0), (x1, y0), (x1, y1), (x0, y1)], colour(class));
        }
        for edge in boundaries(*side, truth) {
            canvas.line(&edge.map(corner), OUTLINE, BOUNDARY);
        }
        self.axes.outline(canvas);
        self.label(canvas, title, below, beside);
    }

    fn label(&self, canvas: &mut Canvas, title: &[String], below: bool, beside: bool) {
        let (left, right, top, bottom) = self.axes.edges();
        for tick in self.sheet.x.ticks(2).into_iter().filter(|_| below) {
            let x = self.axes.across(tick.at);
            canvas.line(&[(x, bottom), (x, bottom + 5.0)], FRAME, 1.0);
            self.axes.label_x(canvas, tick.at, &[tick.label]);
        }
        let mut y = top - TEXT / 2.0 - 6.0;
        if beside {
            for tick in &self.sheet.y_ticks {
                let y = self.axes.down(tick.at);
                canvas.line(&[(left - 5.0, y), (left, y)], FRAME, 1.0);
                self.axes.label_y(canvas, tick);
            }
            let place = (left - TICK_GAP, y);
            canvas.text(&self.sheet.y_label, place, TEXT, Anchor::Right, INK);
        }
        let middle = (left + right) / 2.0;
        if let Some(share) = self
            .panel
            .map
            .share_correct()
            .filter(|_| !self.panel.is_truth)
        {
            let share = format!("{} % correct", number::significant(100.0 * share, 3));
            canvas.text(&share, (middle, y), TEXT, Anchor::Middle, QUIET);
            y -= LINE;
        }
        for text in title.iter().rev() {
            canvas.text(text, (middle, y), TEXT, Anchor::Middle, INK);
            y -= LINE;
        }
    }
}

/// The ends of the squares around points on these lines, halfway between neighbours.
fn ends(lines: &[f64]) -> Vec<f64> {
    let [first, .., last] = lines else {
        let only = lines.first().copied().unwrap_or(0.0);
        let half = (only.abs() / 2.0).max(0.5);
        return vec![only - half, only + half];
    };
    let between = |pair: &[f64]| pair[0] + (pair[1] - pair[0]) / 2.0;
    let inner: Vec<f64> = lines.windows(2).map(between).collect();
    let before = first - (inner[0] - first);
    let after = last + (last - inner[inner.len() - 1]);
    [vec![before], inner, vec![after]].concat()
}

/// A scale over all squares.
fn range<'a>(maps: impl Iterator<Item = &'a Vec<f64>>) -> Scale {
    let all: Vec<f64> = maps.flat_map(|lines| ends(lines)).collect();
    let low = all.iter().copied().fold(f64::INFINITY, f64::min);
    let high = all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    Scale::exactly(low, high)
}
