//! Pareto fronts of a ladder: error against cost, one panel per scene, the rungs on the front named.

mod names;

use super::canvas::{Anchor, Canvas, Point};
use super::figure::Figure;
use super::frame::{Axes, EDGE, Frame, LINE, TEXT, TICK_GAP, WIDTH, Words, widest};
use super::scale::{Scale, Spacing};
use super::style::{Colour, FAINT, FRAME, GRID, INK, Marker, Style};
use crate::tradeoff::{Ladder, LadderScene, Rung, Tradeoff};
use crate::{Files, ReportError};
use names::NAME;
use palpate_study::number;

const PANEL_HEIGHT: f64 = 235.0;
const MARKER: f64 = 5.0;
const OTHER: f64 = 3.0;
const STROKE: f64 = 2.0;
/// Ten times the truth; no answer that errs by more is worth telling apart. Such a rung is drawn as high as this, and
/// as off the scale.
const WORST: f64 = 10.0;
/// Rungs that another beats.
const BEATEN: Colour = Colour(178, 178, 178);

/// Draws the Pareto fronts of every ladder that `cargo xtask tradeoff` has measured into a folder.
///
/// # Errors
/// A table is absent or malformed.
pub fn tradeoff_figures(files: &Files) -> Result<Vec<Figure>, ReportError> {
    all(&Tradeoff::read(files)?)
}

/// The fronts of every ladder.
pub(crate) fn all(tradeoff: &Tradeoff) -> Result<Vec<Figure>, ReportError> {
    let ladders = tradeoff.ladders.iter();
    ladders
        .map(|ladder| figure(ladder, tradeoff.unit()))
        .collect()
}

/// The fronts of one ladder, whose costs are in `unit`.
fn figure(ladder: &Ladder, unit: &str) -> Result<Figure, ReportError> {
    let rungs = || ladder.scenes.iter().flat_map(|scene| &scene.rungs);
    let x = Scale::around(Spacing::Log, rungs().map(|rung| rung.cost));
    let y = Scale::around(Spacing::Log, rungs().map(shown));
    let off_scale = match rungs().any(is_off_scale) {
        true => format!("; triangles: off the scale, more than {WORST}"),
        false => String::new(),
    };
    let words = Words {
        name: ladder.name.clone(),
        title: ladder.title.clone(),
        subtitle: format!("up: {}{off_scale}", ladder.error_of),
        notes: Vec::new(),
    };
    let mut frame = Frame::new(words, WIDTH);
    let left = EDGE + widest(&y.ticks(5)) + TICK_GAP;
    let size = (WIDTH - EDGE - left, PANEL_HEIGHT);
    let mut axes = Axes {
        x: &x,
        y: &y,
        corner: (left, 0.0),
        size,
    };
    frame.top += 6.0;
    for scene in &ladder.scenes {
        let heading = format!("{}: {}", scene.ease, scene.what);
        frame.heading(&heading, left, size.0);
        axes.corner.1 = frame.top + 2.0;
        grid(axes, &mut frame.canvas);
        panel(axes, scene, &mut frame.canvas);
        frame.top = axes.corner.1 + PANEL_HEIGHT + 12.0;
    }
    for tick in x.ticks(8) {
        axes.label_x(&mut frame.canvas, tick.at, &[tick.label]);
    }
    // Below the ticks of the last panel.
    frame.top += TICK_GAP + 2.0 * LINE - 12.0;
    let label = format!("cost of {}, {unit}", ladder.evaluation);
    let place = (left + size.0 / 2.0, frame.top - LINE + TEXT / 2.0);
    frame.canvas.text(&label, place, TEXT, Anchor::Middle, INK);
    frame.finish()
}

fn grid(axes: Axes<'_>, canvas: &mut Canvas) {
    let Axes { x, y, .. } = axes;
    let [xs, ys] = [x.ticks(8), y.ticks(5)];
    axes.rule(canvas, x.minor(8), [], FAINT);
    let across = xs.iter().map(|tick| tick.at);
    axes.rule(canvas, across, ys.iter().map(|tick| tick.at), GRID);
    for tick in &ys {
        axes.label_y(canvas, tick);
    }
    axes.outline(canvas);
}

/// The rungs of one scene.
fn panel(axes: Axes<'_>, scene: &LadderScene, canvas: &mut Canvas) {
    let place = |rung: &Rung| axes.at((rung.cost, shown(rung)));
    let (mut front, beaten): (Vec<&Rung>, Vec<&Rung>) =
        scene.rungs.iter().partition(|rung| rung.on_front);
    front.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let named = front.iter().map(|rung| (named(rung), place(rung)));
    let named: Vec<(String, Point)> = named.collect();
    let hidden: Vec<Point> = beaten.iter().map(|rung| place(rung)).collect();
    let (left, right, top, bottom) = axes.edges();
    let names = names::place(&named, &hidden, [left, top, right, bottom]);
    // Those that another beats have no name beside them, but their titles.
    for rung in beaten {
        match is_off_scale(rung) {
            true => canvas.polygon(&triangle(place(rung)), BEATEN),
            false => canvas.disc(place(rung), OTHER, BEATEN),
        }
        canvas.title(&self::named(rung));
    }
    let Style { colour, marker } = Style::of(0);
    if front.len() > 1 {
        let places: Vec<Point> = named.iter().map(|(_, place)| *place).collect();
        canvas.line(&places, colour, STROKE);
    }
    for leader in names.iter().filter_map(|name| name.leader) {
        canvas.line(&leader, FRAME, 1.0);
    }
    for rung in front {
        let marker = if is_off_scale(rung) {
            Marker::Up
        } else {
            marker
        };
        canvas.marker(marker, place(rung), MARKER, colour);
    }
    for name in &names {
        canvas.text(&name.text, name.place, NAME, Anchor::Left, INK);
    }
}

/// Name of a rung, with its error where that is off the scale.
fn named(rung: &Rung) -> String {
    match is_off_scale(rung) {
        true => format!(
            "{}, errs by {}",
            rung.name,
            number::significant(rung.error, 2)
        ),
        false => rung.name.clone(),
    }
}

fn is_off_scale(rung: &Rung) -> bool {
    rung.error > WORST
}

/// Points upwards, about as large as a disc of a beaten rung.
fn triangle((x, y): Point) -> [Point; 3] {
    let half = 1.3 * OTHER;
    [(x - half, y + OTHER), (x + half, y + OTHER), (x, y - half)]
}

/// The error as drawn: what errs by more is drawn as high as this.
fn shown(rung: &Rung) -> f64 {
    rung.error.min(WORST)
}
