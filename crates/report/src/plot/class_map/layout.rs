//! Room for the panels of a class map and the words around them, in pixels.

use super::Words;
use super::arrange::Row;
use super::squares::{Band, bands, boundaries};
use super::table::{CellMap, Class};
use crate::plot::canvas::Point;
use crate::plot::layout::{EDGE, LEADING, TEXT, TICK_GAP, TITLE};
use crate::plot::lettering::{width, wrap};
use crate::plot::scale::{Scale, Tick};
use crate::plot::style::CLASSES;
use crate::words;

const LINE: f64 = TEXT * LEADING;
/// Gap between panels of a row, and between rows, pixels.
const GAP: f64 = 22.0;
/// Side of a sample in the key.
pub(crate) const SAMPLE: f64 = 18.0;
const SMALLEST_WIDTH: f64 = 960.0;
/// Width of a panel.
const NARROWEST: f64 = 196.0;
const WIDEST: f64 = 290.0;
/// Largest ratio of the sides of a panel.
const SLIMMEST: f64 = 3.0;

/// A class map with the place of everything.
pub(crate) struct Layout {
    /// File stem.
    pub(crate) name: String,
    /// Its title in one piece.
    pub(crate) title_text: String,
    pub(crate) size: (f64, f64),
    pub(crate) title: Vec<String>,
    pub(crate) subtitle: Vec<String>,
    pub(crate) notes: Vec<String>,
    pub(crate) notes_at: f64,
    /// Sample and words, from the left end of the sample at its middle height.
    pub(crate) key: Vec<(Point, Sample, String)>,
    /// Headings of rows, from their left ends.
    pub(crate) headings: Vec<(Point, String)>,
    pub(crate) panels: Vec<Panel>,
    /// Width and height of each panel.
    pub(crate) panel: (f64, f64),
    pub(crate) x: Scale,
    pub(crate) y: Scale,
    pub(crate) x_label: (Point, String),
    pub(crate) y_label: String,
}

/// Sample before an entry of the key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sample {
    Class(Class),
    Boundary,
}

/// One map in its place.
pub(crate) struct Panel {
    /// Upper left corner.
    pub(crate) corner: Point,
    /// Lines above the panel, the last next to it.
    pub(crate) title: Vec<String>,
    /// A quieter line between title and panel; may be empty.
    pub(crate) share: String,
    /// The ends of the squares along x and y.
    pub(crate) x: Vec<f64>,
    pub(crate) y: Vec<f64>,
    pub(crate) bands: Vec<Band>,
    /// Boundaries of the true classes.
    pub(crate) boundaries: Vec<[(usize, usize); 2]>,
    /// Ticks with labels below, and to the left; empty where a neighbour has them.
    pub(crate) x_ticks: Vec<Tick>,
    pub(crate) y_ticks: Vec<Tick>,
}

/// A row of panels while it is being placed: column, title and map of each, and whether it is the truth.
struct Line<'a> {
    heading: String,
    panels: Vec<(usize, String, &'a CellMap, bool)>,
}

impl Layout {
    /// Finds room for everything; `rows` are not empty.
    pub(crate) fn of(around: &Words<'_>, rows: &[Row<'_>]) -> Self {
        let lines: Vec<Line<'_>> = rows.iter().map(line).collect();
        let maps = || lines.iter().flat_map(|line| line.panels.iter());
        let (x, y) = (
            range(maps().map(|panel| &panel.2.x)),
            range(maps().map(|panel| &panel.2.y)),
        );
        let columns = 1 + maps().map(|panel| panel.0).max().unwrap_or(0);
        let y_label = words::with_unit("y", &around.unit);
        let y_ticks = y.ticks(2);
        let ticks_width = y_ticks.iter().map(|tick| width(&tick.label, TEXT));
        let left = EDGE + TICK_GAP + ticks_width.fold(width(&y_label, TEXT), f64::max);
        let gaps = GAP * (columns - 1) as f64;
        let wide =
            ((SMALLEST_WIDTH - left - EDGE - gaps) / columns as f64).clamp(NARROWEST, WIDEST);
        let total = (left + columns as f64 * wide + gaps + EDGE).max(SMALLEST_WIDTH);
        let ratio = (y.ends().1 - y.ends().0) / (x.ends().1 - x.ends().0);
        let ratio = if ratio.is_finite() {
            ratio.clamp(1.0 / SLIMMEST, SLIMMEST)
        } else {
            1.0
        };
        let panel = (wide, (wide * ratio).round());

        let wrapped = |text: &str, size| wrap(text, size, total - 2.0 * EDGE);
        let (title, subtitle) = (
            wrapped(around.title, TITLE),
            wrapped(&around.subtitle, TEXT),
        );
        let notes: Vec<String> = around
            .notes
            .iter()
            .flat_map(|note| wrapped(note, TEXT))
            .collect();
        let mut top =
            EDGE + title.len() as f64 * TITLE * LEADING + subtitle.len() as f64 * LINE + 12.0;
        let key = key(&lines, top, total);
        top = key.last().map_or(top, |(place, ..)| place.1 + 1.3 * LINE);

        let column_at = |column: usize| left + column as f64 * (wide + GAP);
        let (mut headings, mut panels) = (Vec::new(), Vec::new());
        for (at, line) in lines.iter().enumerate() {
            if !line.heading.is_empty() {
                let first = column_at(1.min(columns - 1));
                for text in wrap(&line.heading, TEXT, total - first - EDGE) {
                    headings.push(((first, top + TEXT / 2.0), text));
                    top += LINE;
                }
            }
            let titles: Vec<Vec<String>> = line
                .panels
                .iter()
                .map(|(_, title, ..)| wrap(title, TEXT, wide + GAP - 10.0))
                .collect();
            let tallest = titles.iter().map(Vec::len).max().unwrap_or(0) as f64;
            top += (tallest + 1.0) * LINE + 4.0;
            let mut deep = false;
            for (order, ((column, _, map, is_truth), title)) in
                line.panels.iter().zip(titles).enumerate()
            {
                let below = lines
                    .get(at + 1)
                    .is_some_and(|next| next.panels.iter().any(|panel| panel.0 == *column));
                deep |= !below;
                panels.push(Panel {
                    corner: (column_at(*column), top),
                    title,
                    share: share(map, *is_truth),
                    x: ends(&map.x),
                    y: ends(&map.y),
                    bands: bands(
                        map.side,
                        if *is_truth {
                            &map.truth
                        } else {
                            &map.estimated
                        },
                    ),
                    boundaries: boundaries(map.side, &map.truth),
                    x_ticks: if below { Vec::new() } else { x.ticks(2) },
                    y_ticks: if order == 0 {
                        y_ticks.clone()
                    } else {
                        Vec::new()
                    },
                });
            }
            top += panel.1 + GAP * 1.4 + if deep { TICK_GAP + LINE } else { 0.0 };
        }
        let middle = left + (columns as f64 * (wide + GAP) - GAP) / 2.0;
        let x_label = (
            (middle, top - 0.7 * GAP),
            words::with_unit("x", &around.unit),
        );
        let notes_at = x_label.0.1 + 1.2 * LINE;
        let bottom = if notes.is_empty() {
            x_label.0.1 + 0.6 * TEXT
        } else {
            notes_at + notes.len() as f64 * LINE
        };
        Self {
            name: around.name.to_owned(),
            title_text: around.title.to_owned(),
            size: (total.ceil(), (bottom + EDGE - 6.0).ceil()),
            title,
            subtitle,
            notes,
            notes_at,
            key,
            headings,
            panels,
            panel,
            x,
            y,
            x_label,
            y_label,
        }
    }
}

/// The true map stands in the first column, which is empty where the row has none.
fn line<'a>(row: &Row<'a>) -> Line<'a> {
    let truth = row.truth.map(|map| (0, "truth".to_owned(), map, true));
    let cells = row.cells.iter().enumerate();
    let cells = cells.map(|(at, (title, map))| (at + 1, title.clone(), *map, false));
    Line {
        heading: row.heading.clone(),
        panels: truth.into_iter().chain(cells).collect(),
    }
}

fn share(map: &CellMap, is_truth: bool) -> String {
    match map.share_correct() {
        Some(share) if !is_truth => format!("{} % correct", words::significant(100.0 * share, 3)),
        _ => String::new(),
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

/// The classes that occur, in the order of their table, and the boundary if there is one; in as many lines as
/// they need from `top` down.
fn key(lines: &[Line<'_>], top: f64, total: f64) -> Vec<(Point, Sample, String)> {
    let maps = || {
        lines
            .iter()
            .flat_map(|line| line.panels.iter().map(|panel| panel.2))
    };
    let occurs = |class: Class| {
        maps().any(|map| map.truth.contains(&class) || map.estimated.contains(&class))
    };
    let named = CLASSES
        .iter()
        .enumerate()
        .map(|(at, (name, _))| (Some(at), name.replace('-', " ")));
    let mut entries: Vec<(Sample, String)> = named
        .chain([(None, "not classified".to_owned())])
        .filter(|(class, _)| occurs(*class))
        .map(|(class, name)| (Sample::Class(class), name))
        .collect();
    if maps().any(|map| map.truth.iter().any(|class| *class != map.truth[0])) {
        entries.push((Sample::Boundary, "true boundary".to_owned()));
    }
    let (mut x, mut y) = (EDGE, top + TEXT / 2.0);
    let mut placed = Vec::new();
    for (sample, text) in entries {
        let wide = SAMPLE + 8.0 + width(&text, TEXT);
        if x > EDGE && x + wide > total - EDGE {
            (x, y) = (EDGE, y + LINE + 4.0);
        }
        placed.push(((x, y), sample, text));
        x += wide + 24.0;
    }
    placed
}
