//! Figures of kind `class-surface`: the fitted surface of a cell of the study in three dimensions, coloured by shape
//! class.

use super::captions::full_value;
use super::class_grid::{self, CellMap, Class};
use super::class_map::colour;
use super::drawing::Figure;
use super::selection::{self, CellSelection, Request};
use super::sheet::{self, Drawn, EDGE, HAIR, Key, Sample, WIDTH};
use super::space::{BELOW, Space, Vector, View, around, at};
use super::style::{CLASSES, INK, mixed};
use crate::records::Records;
use crate::{ReportError, phrases};
use palpate_study::{label, number};
use plotters::element::{PathElement, Polygon};
use plotters::style::Color;

/// Largest number of surfaces in a figure.
const MAX_SURFACES: usize = 6;
/// Side length of the coloured squares in the key (legend), in drawing units (1/3 px).
const SAMPLE: i32 = 54;
/// The lines between the squares of a surface have a mixture of two colours: the dark colour of text (ink), and the
/// colour of the square. This is the share of ink, from 0 to 1.
const LINE_INK: f64 = 0.25;

/// A fitted surface: the positions of the points in the map of one cell.
struct Surface<'a> {
    heading: String,
    map: &'a CellMap,
    places: Vec<Vector>,
}

pub(crate) fn figure(of: Request<'_>) -> Result<Figure, ReportError> {
    let maps = class_grid::read(of)?;
    let mapped: Vec<u64> = maps.cells.iter().map(|map| map.cell).collect();
    let CellSelection { rows, notes } = selection::choose_cells(of, &mapped)?;
    if rows.len() > MAX_SURFACES {
        let count = rows.len();
        return Err(of.bad(format!(
            "{count} surfaces are too many for a figure; choose at most {MAX_SURFACES} by `where`"
        )));
    }
    let places = places(of)?;
    let cells = of.study.cells();
    let varying = cells
        .axes()
        .iter()
        .filter(|axis| axis.among(&rows).len() > 1);
    let varying: Vec<_> = varying.collect();
    let surface = |&row: &usize| {
        let (map, (_, places)) =
            (maps.cells.iter().zip(&places)).find(|(map, _)| map.cell == cells.cell(row))?;
        let settings = varying.iter().map(|axis| full_value(axis, axis.text(row)));
        let share = map.share_correct();
        let share =
            share.map(|share| format!("{} % correct", number::significant(100.0 * share, 3)));
        let heading = settings.chain(share).collect::<Vec<_>>().join(" · ");
        let places = places.clone();
        Some(Surface {
            heading,
            map,
            places,
        })
    };
    let surfaces: Vec<Surface<'_>> = rows.iter().filter_map(surface).collect();
    let all: Vec<Vector> = surfaces
        .iter()
        .flat_map(|one| &one.places)
        .copied()
        .collect();
    let scales = [0, 1, 2].map(|axis| around(&all, axis));
    let words = of.words(subtitle(of, &rows), notes);
    sheet::figure(words, WIDTH, |sheet| {
        sheet.key(SAMPLE, &key(&surfaces))?;
        for surface in &surfaces {
            sheet.heading(&surface.heading, EDGE, WIDTH - 2 * EDGE)?;
            let view = View::of(&scales);
            let space = view.space(sheet, &scales)?;
            view.name_axes(&space, sheet, &label::spoken_unit(&maps.unit), &scales)?;
            draw(&space, surface)?;
            sheet.top += view.high + BELOW;
        }
        Ok(())
    })
}

fn places(of: Request<'_>) -> Result<Vec<(u64, Vec<Vector>)>, ReportError> {
    let table = Records::read(of.study.files(), "map.csv", &["cell", "x", "y", "z"])?;
    let table = table.filled()?;
    let place = |row: &usize| -> Result<Vector, ReportError> {
        Ok([
            table.number(*row, 1)?,
            table.number(*row, 2)?,
            table.number(*row, 3)?,
        ])
    };
    let cells = table.by_cell(0)?;
    let places = |(cell, rows): &(u64, Vec<usize>)| {
        let places = rows.iter().map(place).collect::<Result<_, _>>();
        places.map(|places| (*cell, places))
    };
    cells.iter().map(places).collect()
}

fn subtitle(of: Request<'_>, rows: &[usize]) -> String {
    let parts = selection::in_common(of.study, rows);
    phrases::sentence(&parts, "fit of one trial per surface")
}

fn key(surfaces: &[Surface<'_>]) -> Key {
    let named = CLASSES.iter().enumerate();
    let named = named.map(|(at, (name, _))| (Some(at), name.replace('-', " ")));
    let all = named.chain([(None, "not classified".to_owned())]);
    let occurs = |class: &Class| surfaces.iter().any(|one| one.map.estimated.contains(class));
    all.filter(|(class, _)| occurs(class))
        .map(|(class, name)| (Sample::ground(colour(class)), name))
        .collect()
}

/// Draws a square around each point of a surface. Distant squares are drawn first, so that near squares cover them.
fn draw(space: &Space<'_>, surface: &Surface<'_>) -> Drawn {
    let side = surface.map.side;
    // Each corner of a square is at the mean position of the grid points that surround the corner.
    let corner = |i: usize, j: usize| -> Vector {
        let near = |at: usize| [at.saturating_sub(1), at.min(side - 1)];
        let mut sum = [0.0; 3];
        for (i, j) in near(i).into_iter().flat_map(|i| near(j).map(|j| (i, j))) {
            let place = surface.places[i * side + j];
            sum = [0, 1, 2].map(|axis| sum[axis] + 0.25 * place[axis]);
        }
        sum
    };
    let area = space.plotting_area();
    let depth = |place: Vector| {
        let (x, y, z) = at(place);
        area.as_coord_spec().projected_depth(&x, &y, &z)
    };
    let mut squares: Vec<usize> = (0..side * side).collect();
    squares.sort_by_key(|&square| std::cmp::Reverse(depth(surface.places[square])));
    for square in squares {
        let (i, j) = (square / side, square % side);
        let colour = colour(surface.map.estimated[square]);
        let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1), (i, j)];
        let corners = corners.map(|(i, j)| at(corner(i, j)));
        area.draw(&Polygon::new(corners[..4].to_vec(), colour.filled()))?;
        let line = mixed(colour, INK, LINE_INK);
        area.draw(&PathElement::new(corners.to_vec(), line.stroke_width(HAIR)))?;
    }
    Ok(())
}
