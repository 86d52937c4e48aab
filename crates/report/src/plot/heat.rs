//! Heat maps. A heat map shows a number from 0 to 1, such as a probability, for every pair of items. This number is
//! called the share of the pair.

use super::chart::{Place, mesh};
use super::drawing::Figure;
use super::lettering::width;
use super::scale::Scale;
use super::sheet::{
    self, Drawn, EDGE, HAIR, LINE, Point, Sample, Sheet, TEXT, TICK_GAP, WIDTH, Words,
};
use super::style::{Colour, FRAME, INK, WHITE, mixed};
use crate::ReportError;
use plotters::element::Rectangle;
use plotters::style::Color;
use plotters::style::text_anchor::HPos;

/// One panel of a heat map: its items, and the share of every pair of items.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatPanel {
    /// Text with the settings that all items of the panel share; may be empty.
    pub title: String,
    /// Names of the items. Each item is a row and a column of the panel.
    pub names: Vec<String>,
    /// Share of each pair of items from 0 to 1, row by row; `None` if a pair has no share.
    pub shares: Vec<Vec<Option<f64>>>,
}

/// Largest number of items (rows and columns) in a panel of a heat map.
const MAX_THINGS: usize = 40;
const MAX_PANELS: usize = 24;
/// Side of a square with a number, in drawing units (1/3 px).
const LARGE: i32 = 222;
/// Side of a square without a number, in drawing units (1/3 px).
const SMALL: i32 = 66;
/// Largest number of items (rows and columns) in a panel whose squares contain numbers.
const MAX_NUMBERED: usize = 12;
/// Largest width of the name of an item, in drawing units (1/3 px).
const NAME: i32 = 510;
/// Gap between panels, in drawing units (1/3 px).
const GAP: i32 = 102;
const BESIDE: i32 = 12;
/// Width of the symbol beside each text of the key (legend), in drawing units (1/3 px).
const SAMPLE: i32 = 78;
/// If the share of a pair is above this value, its square is so dark that the number in it is written in white.
const MIN_DARK: f64 = 0.6;
/// Fill colour of the squares of pairs without a share.
const NONE: Colour = Colour(236, 236, 236);
/// Fill colour of the squares of pairs with the share 1. Colour-blind readers can distinguish this dark blue from the
/// lighter squares, even if the figure is printed in grey.
const ALL: Colour = Colour(8, 48, 107);

/// Draws a heat map; see [`AnswerChart::Heat`](super::answer_figure::AnswerChart::Heat).
pub(super) fn figure(
    words: Words,
    axis: &str,
    panels: &[HeatPanel],
) -> Result<Figure, ReportError> {
    let counts = panels.iter().map(|panel| panel.names.len());
    let most = counts.max().unwrap_or(0);
    if most > MAX_THINGS || panels.len() > MAX_PANELS {
        return Err(ReportError::Draw {
            path: format!("{}.svg", words.name).into(),
            message: format!(
                "{} panels of up to {most} items are too many; at most {MAX_PANELS} of {MAX_THINGS} are allowed",
                panels.len()
            ),
        });
    }
    let side = if most > MAX_NUMBERED { SMALL } else { LARGE };
    let names = panels.iter().flat_map(|panel| &panel.names);
    let widest = names.map(|name| width(name, TEXT).min(NAME)).max();
    let beside = widest.unwrap_or(0) + TICK_GAP;
    let wide = beside + side * most.max(1) as i32;
    let columns = ((WIDTH - 2 * EDGE + GAP) / (wide + GAP)).max(1);
    let columns = columns.min(panels.len().max(1) as i32);
    let total = (2 * EDGE + columns * (wide + GAP) - GAP).max(WIDTH);
    let shades = [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| {
        let sample = Sample::ground(shade(Some(share)));
        (sample, format!("{} %", 100.0 * share))
    });
    sheet::figure(words, total, |sheet| {
        sheet.key(SAMPLE, &shades.to_vec())?;
        sheet.heading(axis, EDGE, total - 2 * EDGE)?;
        sheet.top += 18;
        for row in panels.chunks(columns as usize) {
            let top = sheet.top;
            let mut lowest = top;
            for (column, panel) in row.iter().enumerate() {
                let left = EDGE + column as i32 * (wide + GAP);
                sheet.top = top;
                sheet.heading(&panel.title, left, wide)?;
                let corner = (left + beside, sheet.top + 12);
                lowest = lowest.max(draw(panel, sheet, corner, side)?);
            }
            sheet.top = lowest + 42;
        }
        Ok(())
    })
}

/// Draws a panel whose squares begin at the upper left `corner`. Returns the vertical position of the lower edge of the
/// panel's labels.
fn draw(panel: &HeatPanel, sheet: &Sheet, corner: Point, side: i32) -> Drawn<i32> {
    let mut names = panel.names.clone();
    // If the squares are smaller than the text, keep only every second, third, … name, so that the names do not
    // overlap.
    let every = (LINE as usize).div_ceil(side as usize);
    for (place, name) in names.iter_mut().enumerate() {
        if place % every > 0 {
            name.clear();
        }
    }
    let high = side * names.len() as i32;
    let x = Scale::of_names(names.clone()).fitted(high, BESIDE);
    let place = Place {
        corner,
        size: (high, high),
        labelled: [side == LARGE, true],
    };
    let mut squares = place.panel(sheet, &x, &Scale::of_names(names).reversed())?;
    mesh(&mut squares)?;
    for (row, shares) in panel.shares.iter().enumerate() {
        for (column, share) in shares.iter().enumerate() {
            let (x, y) = (column as f64, row as f64);
            let corners = [(x - 0.5, y - 0.5), (x + 0.5, y + 0.5)];
            squares.draw_series([
                Rectangle::new(corners, shade(*share).filled()),
                Rectangle::new(corners, FRAME.stroke_width(HAIR)),
            ])?;
            if let Some(share) = share.filter(|_| side == LARGE) {
                let colour = if share >= MIN_DARK { WHITE } else { INK };
                let middle = squares.backend_coord(&(x, y));
                sheet.text(&in_percent(share), middle, HPos::Center, colour)?;
            }
        }
    }
    let below = match side == LARGE {
        true => TICK_GAP + x.lines() * LINE,
        false => TICK_GAP,
    };
    Ok(corner.1 + high + below)
}

/// A share as text in percent. A share below 1 is never rounded to 100 %.
fn in_percent(share: f64) -> String {
    match 100.0 * share {
        percent if percent < 99.5 => format!("{percent:.0} %"),
        percent if percent < 100.0 => format!("{:.1} %", percent.min(99.9)),
        _ => "100 %".to_owned(),
    }
}

fn shade(share: Option<f64>) -> Colour {
    share.map_or(NONE, |share| mixed(WHITE, ALL, share))
}
