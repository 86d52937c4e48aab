//! Shares of every two of some things, as squares.

use super::canvas::{Anchor, Canvas};
use super::figure::Figure;
use super::frame::{EDGE, Frame, LINE, TEXT, TICK_GAP, WIDTH, Words, outline};
use super::lettering::{width, wrap};
use super::style::{Colour, INK, WHITE};
use crate::ReportError;

/// Squares of shares, as they are drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Heat {
    /// Name of the figure's files, without an ending.
    pub name: String,
    /// Title.
    pub title: String,
    /// Line below the title, on that of which the shares are.
    pub subtitle: String,
    /// Field to which the names along both sides belong.
    pub axis: String,
    /// The panels.
    pub panels: Vec<HeatPanel>,
    /// Lines below the picture.
    pub notes: Vec<String>,
}

/// Shares of every two of some things.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatPanel {
    /// Settings that are alike in all of them; may be empty.
    pub title: String,
    /// Names of the things.
    pub names: Vec<String>,
    /// Shares from 0 to 1, row by row; `None` where there is none.
    pub shares: Vec<Vec<Option<f64>>>,
}

/// Most things of a panel, and most panels, that make a picture.
const MOST: usize = 40;
const MOST_PANELS: usize = 24;
/// Sides of squares, pixels: with their number in them, and without.
const LARGE: f64 = 74.0;
const SMALL: f64 = 22.0;
/// Panel of more things than this has no numbers in its squares.
const MOST_NUMBERED: usize = 12;
/// Widest name, pixels.
const NAME: f64 = 170.0;
const GAP: f64 = 34.0;
/// Share from which on a square is so dark that its number is white.
const DARK: f64 = 0.6;

/// Draws shares as squares, darker the larger, with their number in percent where there are few.
///
/// ```
/// use palpate_report::{Heat, HeatPanel, heat_figure};
///
/// let panel = HeatPanel {
///     title: String::new(),
///     names: vec!["20 mm".to_owned(), "25 mm".to_owned()],
///     shares: vec![vec![None, Some(0.84)], vec![Some(0.84), None]],
/// };
/// let figure = heat_figure(&Heat {
///     name: "told".to_owned(),
///     title: "Which balls are told apart?".to_owned(),
///     subtitle: String::new(),
///     axis: "object radius".to_owned(),
///     panels: vec![panel],
///     notes: Vec::new(),
/// })?;
/// assert!(figure.svg.contains("84 %") && figure.svg.contains("25 mm"));
/// # Ok::<(), palpate_report::ReportError>(())
/// ```
///
/// # Errors
/// The picture is too large.
pub fn heat_figure(heat: &Heat) -> Result<Figure, ReportError> {
    let most = heat
        .panels
        .iter()
        .map(|panel| panel.names.len())
        .max()
        .unwrap_or(0);
    if most > MOST || heat.panels.len() > MOST_PANELS {
        return Err(ReportError::Draw {
            path: format!("{}.svg", heat.name).into(),
            message: format!(
                "{} panels of up to {most} things are no picture; at most {MOST_PANELS} of {MOST} are",
                heat.panels.len()
            ),
        });
    }
    let side = if most > MOST_NUMBERED { SMALL } else { LARGE };
    let names = heat.panels.iter().flat_map(|panel| &panel.names);
    let widest = names
        .map(|name| width(name, TEXT).min(NAME))
        .fold(0.0, f64::max);
    let wide = widest + TICK_GAP + side * most.max(1) as f64;
    let columns = (((WIDTH - 2.0 * EDGE + GAP) / (wide + GAP)) as usize).max(1);
    let columns = columns.min(heat.panels.len().max(1));
    let total = (2.0 * EDGE + columns as f64 * (wide + GAP) - GAP).max(WIDTH);
    let words = Words {
        name: heat.name.clone(),
        title: heat.title.clone(),
        subtitle: heat.subtitle.clone(),
        notes: heat.notes.clone(),
    };
    let mut frame = Frame::new(words, total);
    let shades = [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| (share, format!("{} %", 100.0 * share)));
    frame.key(26.0, &shades, |canvas, (x, y), share| {
        square(canvas, (x, y - 9.0), (26.0, 18.0), Some(*share));
    });
    frame.heading(&heat.axis, EDGE, total - 2.0 * EDGE);
    frame.top += 6.0;
    for row in heat.panels.chunks(columns) {
        let top = frame.top;
        let mut lowest = top;
        for (column, panel) in row.iter().enumerate() {
            let left = EDGE + column as f64 * (wide + GAP);
            frame.top = top;
            if !panel.title.is_empty() {
                frame.heading(&panel.title, left, wide);
                frame.top += 4.0;
            }
            let corner = (left + widest + TICK_GAP, frame.top);
            let lines = draw(panel, &mut frame.canvas, corner, side);
            let high = side * panel.names.len() as f64;
            lowest = lowest.max(corner.1 + high + TICK_GAP + lines as f64 * LINE);
        }
        frame.top = lowest + 14.0;
    }
    frame.finish()
}

/// Draws a panel with its squares from `corner` on; gives the number of lines of the names below.
fn draw(panel: &HeatPanel, canvas: &mut Canvas, corner: (f64, f64), side: f64) -> usize {
    let count = panel.names.len();
    for (row, shares) in panel.shares.iter().enumerate() {
        for (column, share) in shares.iter().enumerate() {
            let place = (
                corner.0 + column as f64 * side,
                corner.1 + row as f64 * side,
            );
            square(canvas, place, (side, side), *share);
            let Some(share) = share.filter(|_| side == LARGE) else {
                continue;
            };
            let colour = if share >= DARK { WHITE } else { INK };
            let middle = (place.0 + side / 2.0, place.1 + side / 2.0);
            canvas.text(&in_percent(share), middle, TEXT, Anchor::Middle, colour);
        }
    }
    outline(canvas, corner, (side * count as f64, side * count as f64));
    let mut lines = 0;
    // Small squares have room for some of the names only.
    let every = ((LINE / side).ceil() as usize).max(1);
    for (place, name) in panel.names.iter().enumerate().step_by(every) {
        let along = (place as f64 + 0.5) * side;
        let left = (corner.0 - TICK_GAP, corner.1 + along);
        canvas.text(name, left, TEXT, Anchor::Right, INK);
        if side == LARGE {
            let wrapped = wrap(name, TEXT, side - 4.0);
            for (line, text) in wrapped.iter().enumerate() {
                let y = corner.1 + side * count as f64 + TICK_GAP + TEXT / 2.0 + line as f64 * LINE;
                canvas.text(text, (corner.0 + along, y), TEXT, Anchor::Middle, INK);
            }
            lines = lines.max(wrapped.len());
        }
    }
    lines
}

/// Share in percent, which is 100 % only where it is 1.
fn in_percent(share: f64) -> String {
    match 100.0 * share {
        percent if percent < 99.5 => format!("{percent:.0} %"),
        percent if percent < 100.0 => format!("{:.1} %", percent.min(99.9)),
        _ => "100 %".to_owned(),
    }
}

fn square(canvas: &mut Canvas, (x, y): (f64, f64), (wide, high): (f64, f64), share: Option<f64>) {
    let colour = share.map_or(Colour(236, 236, 236), shade);
    canvas.polygon(
        &[(x, y), (x + wide, y), (x + wide, y + high), (x, y + high)],
        colour,
    );
    outline(canvas, (x, y), (wide, high));
}

/// Blue, from white for 0 to nearly black for 1: seen alike by all eyes, and in grey.
fn shade(share: f64) -> Colour {
    let share = share.clamp(0.0, 1.0);
    let mix = |from: f64, to: f64| (from + (to - from) * share).round() as u8;
    Colour(mix(255.0, 8.0), mix(255.0, 48.0), mix(255.0, 107.0))
}
