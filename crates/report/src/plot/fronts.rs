//! Pareto fronts of a ladder: error against cost, one panel per scene; the rungs on the front named, the others as far as
//! there is room.

mod names;

use super::canvas::{Anchor, Canvas, Point};
use super::figure::Figure;
use super::frame::{Axes, EDGE, Frame, LINE, TEXT, TICK_GAP, WIDTH, Words, widest};
use super::scale::{Scale, Spacing};
use super::style::{Colour, FAINT, FRAME, GRID, INK, QUIET, Style};
use super::uncertainty::normal;
use crate::group::distinct;
use crate::tradeoff::{Ladder, LadderScene, Rung, Tradeoff};
use crate::{Files, ReportError, words};
use names::NAME;
use palpate_study::number;

const PANEL_HEIGHT: f64 = 235.0;
const MARKER: f64 = 5.0;
const OTHER: f64 = 4.0;
const STROKE: f64 = 2.0;
/// Length of a sample in the key.
const SAMPLE: f64 = 2.4 * MARKER;
/// Ten times the truth; no answer that errs by more is worth telling apart. Such a rung is drawn as high as this, and
/// as off the scale.
const WORST: f64 = 10.0;

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
    // What errs, then remarks on it.
    let mut told = ladder.error_of.split("; ");
    let error_of = told.next().unwrap_or_default();
    let remarks = told.map(|remark| words::sentence(&[], remark));
    let has_bars = rungs().any(|rung| rung.error_std > 0.0);
    let bars = has_bars.then(|| {
        "Bars, where longer than their marker: 95 % intervals by the number of trials.".to_owned()
    });
    let off_scale = rungs().any(is_off_scale).then(|| {
        format!("Points below an arrow are off the scale: they err by more than {WORST}.")
    });
    let subtitle =
        "The line joins choices that no other beats in both error and cost; pale ones are beaten.";
    let words = Words {
        name: ladder.name.clone(),
        title: ladder.title.clone(),
        subtitle: subtitle.to_owned(),
        notes: remarks.chain(bars).chain(off_scale).collect(),
    };
    let mut frame = Frame::new(words, WIDTH);
    let families: Vec<String> = rungs().map(|rung| family(&rung.name)).collect();
    let families = distinct(families.iter().map(String::as_str));
    let choices = distinct(rungs().map(|rung| rung.name.as_str())).len();
    // One choice of each family has its name beside it.
    if (2..choices).contains(&families.len()) {
        let entries = families.iter().enumerate();
        let entries: Vec<(Style, String)> = entries
            .map(|(place, family)| (Style::of(place), (*family).to_owned()))
            .collect();
        frame.key(SAMPLE, &entries, |canvas, (x, y), style| {
            canvas.marker(style.marker, (x + SAMPLE / 2.0, y), MARKER, style.colour);
        });
    }
    frame.top += 8.0;
    frame.heading(&format!("{error_of} (no unit)"), EDGE, WIDTH - 2.0 * EDGE);
    let style_of = |rung: &Rung| {
        let family = family(&rung.name);
        let place = families.iter().position(|known| *known == family);
        Style::of(place.unwrap_or_default())
    };
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
        panel(axes, scene, style_of, &mut frame.canvas);
        frame.top = axes.corner.1 + PANEL_HEIGHT + 12.0;
    }
    for tick in x.ticks(8) {
        axes.label_x(&mut frame.canvas, tick.at, &[tick.label]);
    }
    // Below the ticks of the last panel.
    frame.top += TICK_GAP + 2.0 * LINE - 12.0;
    let label = format!("cost of {} ({unit})", ladder.evaluation);
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
fn panel(
    axes: Axes<'_>,
    scene: &LadderScene,
    style_of: impl Fn(&Rung) -> Style,
    canvas: &mut Canvas,
) {
    let place = |rung: &Rung| axes.at((rung.cost, shown(rung)));
    let (mut front, beaten): (Vec<&Rung>, Vec<&Rung>) =
        scene.rungs.iter().partition(|rung| rung.on_front);
    front.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let called = |rungs: &[&Rung]| -> Vec<(String, Point)> {
        let called = rungs.iter().map(|rung| (named(rung), place(rung)));
        called.collect()
    };
    let (left, right, top, bottom) = axes.edges();
    let frame = [left, top, right, bottom];
    let bars: Vec<[Point; 2]> = scene
        .rungs
        .iter()
        .filter(|rung| !is_off_scale(rung))
        .map(|rung| axes.upright(rung.cost, interval(rung)))
        .collect();
    let names = names::place(&called(&front), &called(&beaten), &bars, frame);
    if front.len() > 1 {
        let places: Vec<Point> = front.iter().map(|rung| place(rung)).collect();
        canvas.line(&places, QUIET, STROKE);
    }
    for rung in beaten {
        let style = style_of(rung);
        bar(axes, rung, style.pale(), canvas);
        if is_off_scale(rung) {
            canvas.polygon(&arrow(place(rung)), style.pale());
        }
        canvas.marker(style.marker, place(rung), OTHER, style.pale());
        // Where there is no room for its name.
        canvas.title(&named(rung));
    }
    for leader in names.iter().filter_map(|name| name.leader) {
        canvas.line(&leader, FRAME, 1.0);
    }
    for rung in front {
        let Style { colour, marker } = style_of(rung);
        bar(axes, rung, colour, canvas);
        if is_off_scale(rung) {
            canvas.polygon(&arrow(place(rung)), colour);
        }
        canvas.marker(marker, place(rung), MARKER, colour);
    }
    for name in &names {
        let colour = if name.of_front { INK } else { QUIET };
        canvas.text(&name.text, name.place, NAME, Anchor::Left, colour);
    }
}

/// Interval of a rung's error, where it is longer than the marker.
fn bar(axes: Axes<'_>, rung: &Rung, colour: Colour, canvas: &mut Canvas) {
    if !is_off_scale(rung) {
        axes.bar(canvas, rung.cost, interval(rung), 2.0 * MARKER, colour);
    }
}

/// Ends of the 95 % interval of a rung's error.
fn interval(rung: &Rung) -> [f64; 2] {
    normal(rung.error, rung.error_std).map(|end| Spacing::Log.nearest(end))
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

/// Head of an arrow that points upwards, above a marker.
fn arrow((x, y): Point) -> [Point; 3] {
    let bottom = y - MARKER - 3.0;
    [
        (x - OTHER, bottom),
        (x + OTHER, bottom),
        (x, bottom - 1.3 * OTHER),
    ]
}

/// Name of a rung without its numbers: what rungs that differ in a setting have in common.
fn family(name: &str) -> String {
    let is_number = |word: &&str| word.starts_with(|letter: char| letter.is_ascii_digit());
    let kept = name.split(", ").map(|part| {
        let words = part.split(' ').take_while(|word| !is_number(word));
        let words: Vec<&str> = words.filter(|word| !["×", "="].contains(word)).collect();
        words.join(" ")
    });
    let mut kept = kept.zip(name.split(", "));
    let first = kept.next().map_or(String::new(), |(words, _)| words);
    // Of what follows, only what is no setting.
    let others = kept.filter(|(words, part)| !words.is_empty() && !part.contains('='));
    let others = others.map(|(words, _)| words);
    std::iter::once(first)
        .chain(others)
        .collect::<Vec<_>>()
        .join(", ")
}

/// The error as drawn: what errs by more is drawn as high as this.
fn shown(rung: &Rung) -> f64 {
    rung.error.min(WORST)
}

#[cfg(test)]
mod tests {
    use super::family;

    #[test]
    fn a_family_is_what_the_numbers_leave() {
        for (name, expected) in [
            ("closed form", "closed form"),
            ("RK4 × 16", "RK4"),
            ("DOP853 1e-3, Montana", "DOP853, Montana"),
            ("two-pass, S = 3000, 30 points", "two-pass"),
            ("layer, solved × 3/8", "layer, solved"),
            ("layer, first table", "layer, first table"),
            ("16 × 0.2 rad", ""),
            ("", ""),
        ] {
            assert_eq!(family(name), expected);
        }
    }
}
