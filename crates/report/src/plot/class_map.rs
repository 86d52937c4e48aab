//! Figures of kind `class-map`: a map of the true shape classes beside maps of the estimated classes. There is one map
//! of estimated classes for each cell.

use super::captions::full_value;
use super::chart::{Panel, Place, mesh, outline};
use super::class_grid::{self, CellMap, Class, bands, boundaries};
use super::drawing::Figure;
use super::lettering::{width, wrap};
use super::scale::Scale;
use super::selection::{self, CellSelection, Request};
use super::sheet::{self, Drawn, EDGE, Key, LINE, Sample, Sheet, TEXT, TICK_GAP, WIDTH};
use super::style::{CLASSES, Colour, INK, OUTLINE, QUIET, WHITE};
use crate::phrases::with_unit;
use crate::records::by_key;
use crate::table::Axis;
use crate::{ReportError, Table, phrases};
use palpate_study::{label, number};
use plotters::element::{PathElement, Rectangle};
use plotters::style::Color;
use plotters::style::text_anchor::HPos;

const MAX_CELLS: usize = 60;
/// Gap between panels, in drawing units (1/3 px).
const GAP: i32 = 66;
/// Side length of the coloured squares in the key (legend), in drawing units (1/3 px).
const SAMPLE: i32 = 54;
const NARROWEST: i32 = 588;
const WIDEST: i32 = 870;
/// Largest ratio of the longer to the shorter side of a panel.
const SLIMMEST: f64 = 3.0;
/// Overlap of neighbouring coloured rectangles, relative to the panel's size. Without an overlap, thin gaps would be
/// visible between them.
const OVERLAP: f64 = 0.004;
/// Width of the boundaries between regions of different classes, in drawing units (1/3 px).
const BOUNDARY: u32 = 5;
const PALE: Colour = Colour(243, 243, 243);

pub(crate) fn figure(of: Request<'_>) -> Result<Figure, ReportError> {
    let maps = class_grid::read(of)?;
    let mapped: Vec<u64> = maps.cells.iter().map(|map| map.cell).collect();
    let CellSelection { rows, notes } = selection::choose_cells(of, &mapped)?;
    if rows.len() > MAX_CELLS {
        let count = rows.len();
        return Err(of.bad(format!(
            "a figure of {count} maps is too large; choose at most {MAX_CELLS} by `where`"
        )));
    }
    let cells = of.study.cells();
    let shown = rows.iter().filter_map(|&row| {
        let map = maps.cells.iter().find(|map| map.cell == cells.cell(row))?;
        Some(Shown { map, row })
    });
    let shown: Vec<Shown<'_>> = shown.collect();
    let cell_rows = cell_rows(cells, &shown);
    let lines: Vec<PanelRow<'_>> = cell_rows.iter().map(panels).collect();
    let layout = MapLayout::of(&lines, &label::spoken_unit(&maps.unit));
    sheet::figure(
        of.words(subtitle(of, &shown), notes),
        layout.total,
        |sheet| {
            sheet.key(SAMPLE, &key(&lines))?;
            layout.draw(sheet, &lines)
        },
    )
}

fn subtitle(of: Request<'_>, shown: &[Shown<'_>]) -> String {
    let rows: Vec<usize> = shown.iter().map(|cell| cell.row).collect();
    let parts = selection::in_common(of.study, &rows);
    let mut shown_of = "one trial per panel".to_owned();
    let mut sides: Vec<usize> = shown.iter().map(|cell| cell.map.side).collect();
    sides.sort_unstable();
    sides.dedup();
    if let [side] = sides.as_slice() {
        shown_of = format!("{side} × {side} points of {shown_of}");
    }
    phrases::sentence(&parts, &shown_of)
}

struct PanelRow<'a> {
    heading: &'a str,
    panels: Vec<MapPanel<'a>>,
}

/// A map, and the column in which it is drawn.
struct MapPanel<'a> {
    column: usize,
    title: &'a str,
    map: &'a CellMap,
    /// Whether the map shows the true classes instead of the estimated classes.
    is_truth: bool,
}

/// The panels of a row of the figure. The first column of the row shows the map of the true classes; this column is
/// empty if the row has no such map.
fn panels<'a>(row: &'a CellRow<'a>) -> PanelRow<'a> {
    let truth = row.truth.map(|map| MapPanel {
        column: 0,
        title: "truth",
        map,
        is_truth: true,
    });
    let cells = row.cells.iter().enumerate();
    let cells = cells.map(|(at, (title, map))| MapPanel {
        column: at + 1,
        title,
        map,
        is_truth: false,
    });
    PanelRow {
        heading: &row.heading,
        panels: truth.into_iter().chain(cells).collect(),
    }
}

/// Key (legend) of the figure: the classes that occur in the maps, in the order of [`CLASSES`], and the boundary
/// between true classes if a map has one.
fn key(lines: &[PanelRow<'_>]) -> Key {
    let maps = || {
        let panels = lines.iter().flat_map(|line| &line.panels);
        panels.map(|panel| panel.map)
    };
    let occurs = |class: &Class| {
        maps().any(|map| map.truth.contains(class) || map.estimated.contains(class))
    };
    let named = CLASSES.iter().enumerate();
    let named = named.map(|(at, (name, _))| (Some(at), name.replace('-', " ")));
    let mut entries: Key = named
        .chain([(None, "not classified".to_owned())])
        .filter(|(class, _)| occurs(class))
        .map(|(class, name)| (Sample::ground(colour(class)), name))
        .collect();
    if maps().any(|map| map.truth.iter().any(|class| *class != map.truth[0])) {
        let boundary = Sample {
            ground: Some(PALE),
            ..Sample::line(OUTLINE.stroke_width(BOUNDARY))
        };
        entries.push((boundary, "true boundary".to_owned()));
    }
    entries
}

pub(super) fn colour(class: Class) -> Colour {
    let known = class.and_then(|at| CLASSES.get(at));
    known.map_or(WHITE, |(_, colour)| *colour)
}

struct MapLayout {
    total: i32,
    columns: i32,
    left: i32,
    panel: (i32, i32),
    x: Scale,
    y: Scale,
    x_label: String,
    y_label: String,
}

impl MapLayout {
    /// Computes the layout of the figure from all its rows of panels; `lines` is not empty. `unit` is the unit of x and
    /// y.
    fn of(lines: &[PanelRow<'_>], unit: &str) -> Self {
        let panels = || lines.iter().flat_map(|line| &line.panels);
        let x = range(panels().map(|panel| &panel.map.x));
        let y = range(panels().map(|panel| &panel.map.y));
        let columns = 1 + panels().map(|panel| panel.column).max().unwrap_or(0) as i32;
        let [x_label, y_label] = ["x", "y"].map(|name| with_unit(name, unit));
        let left = EDGE + TICK_GAP + y.widest().max(width(&y_label, TEXT));
        let gaps = GAP * (columns - 1);
        let wide = ((WIDTH - left - EDGE - gaps) / columns).clamp(NARROWEST, WIDEST);
        let ratio = (y.ends().1 - y.ends().0) / (x.ends().1 - x.ends().0);
        let ratio = match ratio.is_finite() {
            true => ratio.clamp(1.0 / SLIMMEST, SLIMMEST),
            false => 1.0,
        };
        let total = left + columns * wide + gaps + EDGE;
        Self {
            total: total.max(WIDTH),
            columns,
            left,
            panel: (wide, (f64::from(wide) * ratio) as i32),
            x,
            y,
            x_label,
            y_label,
        }
    }

    fn draw(&self, sheet: &mut Sheet, lines: &[PanelRow<'_>]) -> Drawn {
        let (wide, high) = self.panel;
        let column = |at: i32| self.left + at * (wide + GAP);
        for (at, line) in lines.iter().enumerate() {
            let first = column(1.min(self.columns - 1));
            sheet.heading(line.heading, first, self.total - first - EDGE)?;
            let titles = line.panels.iter();
            let titles = titles.map(|panel| wrap(panel.title, TEXT, wide + GAP - 30));
            let titles: Vec<Vec<String>> = titles.collect();
            let tallest = titles.iter().map(Vec::len).max().unwrap_or(0) as i32;
            sheet.top += (tallest + 1) * LINE + 12;
            let below = lines.get(at + 1).map_or(&[][..], |next| &next.panels);
            let mut deep = false;
            for (order, (map, title)) in line.panels.iter().zip(&titles).enumerate() {
                // Only the lowest panel of a column has labels along x, and only the first panel of a row has labels
                // along y.
                let is_lowest = below.iter().all(|next| next.column != map.column);
                deep |= is_lowest;
                let place = Place {
                    corner: (column(map.column as i32), sheet.top),
                    size: self.panel,
                    labelled: [is_lowest, order == 0],
                };
                squares(&mut place.panel(sheet, &self.x, &self.y)?, map)?;
                self.label(sheet, &place, map, title)?;
            }
            let labels = if deep { TICK_GAP + LINE } else { 0 };
            sheet.top += high + GAP * 7 / 5 + labels;
        }
        let middle = (self.left + column(self.columns) - GAP) / 2;
        sheet.top -= GAP * 7 / 10;
        sheet.text(&self.x_label, (middle, sheet.top), HPos::Center, INK)?;
        sheet.top += TEXT * 3 / 5;
        Ok(())
    }

    /// Writes the title above the panel of a map, with the share of correctly classified points.
    fn label(&self, sheet: &Sheet, place: &Place, map: &MapPanel<'_>, title: &[String]) -> Drawn {
        let (left, top) = place.corner;
        let mut y = top - TEXT / 2 - 18;
        if place.labelled[1] {
            sheet.text(&self.y_label, (left - TICK_GAP, y), HPos::Right, INK)?;
        }
        let middle = left + self.panel.0 / 2;
        if let Some(share) = map.map.share_correct().filter(|_| !map.is_truth) {
            let share = format!("{} % correct", number::significant(100.0 * share, 3));
            sheet.text(&share, (middle, y), HPos::Center, QUIET)?;
            y -= LINE;
        }
        for text in title.iter().rev() {
            sheet.text(text, (middle, y), HPos::Center, INK)?;
            y -= LINE;
        }
        Ok(())
    }
}

fn squares(panel: &mut Panel<'_>, map: &MapPanel<'_>) -> Drawn {
    let CellMap { side, truth, .. } = map.map;
    mesh(panel)?;
    let [x, y] = [&map.map.x, &map.map.y].map(|lines| ends(lines));
    let corner = |(i, j): (usize, usize)| (x[i], y[j]);
    let classes = if map.is_truth {
        truth
    } else {
        &map.map.estimated
    };
    let reach = [panel.x_range(), panel.y_range()].map(|range| OVERLAP * (range.end - range.start));
    // Neighbouring rectangles overlap. Draw them in the order of increasing x and y, so that each rectangle covers its
    // overlap with the previous one.
    panel.draw_series(bands(*side, classes).into_iter().map(|band| {
        let (x, y) = corner((band.x.1, band.y.1));
        let corners = [corner((band.x.0, band.y.0)), (x + reach[0], y + reach[1])];
        Rectangle::new(corners, colour(band.class).filled())
    }))?;
    panel.draw_series(
        boundaries(*side, truth)
            .into_iter()
            .map(|edge| PathElement::new(edge.map(corner), OUTLINE.stroke_width(BOUNDARY))),
    )?;
    outline(panel)
}

/// Coordinates of the edges of the grid squares. `lines` are the coordinates of the centres of the squares. Each inner
/// edge is halfway between two neighbouring centres.
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

fn range<'a>(maps: impl Iterator<Item = &'a Vec<f64>>) -> Scale {
    let all: Vec<f64> = maps.flat_map(|lines| ends(lines)).collect();
    let low = all.iter().copied().fold(f64::INFINITY, f64::min);
    let high = all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    Scale::exactly(low, high).with_ticks(2)
}

/// Largest number of the study's cells in a row of panels.
const MAX_PER_ROW: usize = 5;
/// Number of the study's cells in a row of panels, if every swept field has too many values for one row.
const DEFAULT_PER_ROW: usize = 4;

#[derive(Clone, Copy)]
struct Shown<'a> {
    map: &'a CellMap,
    row: usize,
}

struct CellRow<'a> {
    heading: String,
    /// Map of the true classes; `None` if an earlier row of panels already shows the same map.
    truth: Option<&'a CellMap>,
    /// Title and map of each cell. The title states the swept values in which the cells of this row differ.
    cells: Vec<(String, &'a CellMap)>,
}

fn cell_rows<'a>(table: &Table, shown: &[Shown<'a>]) -> Vec<CellRow<'a>> {
    let rows: Vec<usize> = shown.iter().map(|cell| cell.row).collect();
    let varying: Vec<&Axis> = table
        .axes()
        .iter()
        .filter(|axis| axis.among(&rows).len() > 1)
        .collect();
    let across = across(&varying, &rows);
    let down: Vec<&Axis> = varying
        .iter()
        .filter(|axis| across.is_none_or(|across| across.header != axis.header))
        .copied()
        .collect();
    let per_row = across
        .map(|axis| axis.among(&rows).len())
        .filter(|count| *count <= MAX_PER_ROW)
        .unwrap_or(DEFAULT_PER_ROW);
    let words = |axes: &[&Axis], row: usize| {
        let values = axes.iter().map(|axis| full_value(axis, axis.text(row)));
        values.collect::<Vec<_>>().join(" · ")
    };

    // Cells with the same object have the same true map, so the true map is drawn only once for each object.
    let mut axes = table.axes().iter();
    let object = axes.find(|axis| axis.header.starts_with("scene.object"));
    let truth = |cell: &Shown<'a>| (&cell.map.truth, object.map(|axis| axis.text(cell.row)));
    let mut rows_of_cells = Vec::new();
    for (_, cells) in by_key(shown.iter().map(|cell| (truth(cell), *cell))) {
        let mut truth = Some(cells[0].map);
        for (heading, cells) in by_key(cells.iter().map(|cell| (words(&down, cell.row), *cell))) {
            for chunk in cells.chunks(per_row) {
                let title = |cell: &Shown<'a>| (words(across.as_slice(), cell.row), cell.map);
                rows_of_cells.push(CellRow {
                    heading: heading.clone(),
                    truth: truth.take(),
                    cells: chunk.iter().map(title).collect(),
                });
            }
        }
    }
    rows_of_cells
}

/// Returns the swept field whose values are side by side in a row of panels. It is the field with the most values,
/// among the fields with at most [`MAX_PER_ROW`] values; if several fields have the same number of values, it is the
/// last of them. If all fields have more than [`MAX_PER_ROW`] values, the last field is returned. `None` if no field
/// varies.
fn across<'a>(varying: &[&'a Axis], rows: &[usize]) -> Option<&'a Axis> {
    let count = |axis: &&&Axis| axis.among(rows).len();
    let fitting = varying.iter().filter(|axis| count(axis) <= MAX_PER_ROW);
    fitting.max_by_key(count).or(varying.last()).copied()
}
