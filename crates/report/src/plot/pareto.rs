//! Figures of Pareto fronts: the error of models over their cost, with one panel per scene. Models on the front are
//! labelled; other models are labelled only if there is space.

use super::chart::{Panel, Place, bar, mesh};
use super::drawing::Figure;
use super::label_placement::{self, NAME};
use super::scale::{Scale, Spacing};
use super::sheet::{
    self, Drawn, EDGE, HAIR, Key, LINE, Point, Sample, Sheet, TEXT, TICK_GAP, WIDTH, Words, letters,
};
use super::style::{FRAME, INK, QUIET, Style, pale};
use super::symbol::{Placed, Symbol};
use super::uncertainty::{self, normal};
use crate::records::distinct;
use crate::tradeoff::{Ladder, LadderScene, Rung, Tradeoff};
use crate::{Files, ReportError, phrases};
use palpate_study::number;
use plotters::element::Polygon;
use plotters::style::Color;
use plotters::style::text_anchor::HPos;

const PANEL_HEIGHT: i32 = 705;
const MARKER: f64 = 15.0;
const OTHER: f64 = 12.0;
const STROKE: u32 = 6;
/// Length of the symbol beside each text of the key (legend), in drawing units (1/3 px).
const SAMPLE: i32 = 36;
/// Upper end of the axis of relative errors (no unit). The exact size of a larger error does not matter, because the
/// model is useless. The point of such a model is drawn at this end of the axis, with an arrow above it.
const MAX_ERROR: f64 = 10.0;

/// Draws one Pareto figure for each comparison of models in a folder that `cargo xtask tradeoff` wrote.
///
/// # Errors
/// [`ReportError`] if a table is missing or malformed.
pub fn tradeoff_figures(files: &Files) -> Result<Vec<Figure>, ReportError> {
    figures(&Tradeoff::read(files)?)
}

pub(crate) fn figures(tradeoff: &Tradeoff) -> Result<Vec<Figure>, ReportError> {
    let ladders = tradeoff.ladders.iter();
    ladders
        .map(|ladder| figure(ladder, tradeoff.unit()))
        .collect()
}

/// Draws the Pareto figure of one comparison of models. `unit` is the unit of the models' costs.
fn figure(ladder: &Ladder, unit: &str) -> Result<Figure, ReportError> {
    let rungs = || ladder.scenes.iter().flat_map(|scene| &scene.rungs);
    let x = Scale::around(Spacing::Log, rungs().map(|rung| rung.cost)).with_ticks(8);
    let y = Scale::around(Spacing::Log, rungs().map(drawn_error));
    let y = y.with_ticks(5).without_minor();
    // `error_of` consists of parts that are separated by semicolons. The first part names the quantity whose error is
    // plotted; the other parts are remarks.
    let mut parts = ladder.error_of.split("; ");
    let error_of = parts.next().unwrap_or_default();
    let remarks = parts.map(|remark| phrases::sentence(&[], remark));
    let has_bars = rungs().any(|rung| rung.error_std > 0.0);
    let bars = has_bars.then(|| uncertainty::BARS.to_owned());
    let off_scale = rungs().any(is_off_scale).then(|| {
        format!("Points below an arrow are off the scale: they err by more than {MAX_ERROR}.")
    });
    let subtitle =
        "The line joins choices that no other beats in both error and cost; pale ones are beaten.";
    let words = Words {
        name: ladder.name.clone(),
        title: ladder.title.clone(),
        subtitle: subtitle.to_owned(),
        notes: remarks.chain(bars).chain(off_scale).collect(),
    };
    let families: Vec<String> = rungs().map(|rung| family(&rung.name)).collect();
    let families = distinct(families.iter().map(String::as_str));
    let choices = distinct(rungs().map(|rung| rung.name.as_str())).len();
    let entries = families.iter().enumerate();
    let key: Key = entries
        .map(|(place, family)| {
            let symbol = Symbol::new(Style::of(place), MARKER);
            (Sample::symbol(symbol), (*family).to_owned())
        })
        .collect();
    let style_of = |rung: &Rung| {
        let family = family(&rung.name);
        let place = families.iter().position(|known| *known == family);
        Style::of(place.unwrap_or_default())
    };
    let left = EDGE + y.widest() + TICK_GAP;
    let size = (WIDTH - EDGE - left, PANEL_HEIGHT);
    sheet::figure(words, WIDTH, |sheet| {
        // Models of a family differ only in settings and have the same colour. The figure needs a legend only if there
        // are several families and one of them has several models. Otherwise, the labels of the points suffice.
        if (2..choices).contains(&families.len()) {
            sheet.key(SAMPLE, &key)?;
        }
        sheet.top += 24;
        sheet.heading(&format!("{error_of} (no unit)"), EDGE, WIDTH - 2 * EDGE)?;
        sheet.top += 18;
        for (at, scene) in ladder.scenes.iter().enumerate() {
            let heading = format!("{}: {}", scene.ease, scene.what);
            sheet.heading(&heading, left, size.0)?;
            let place = Place {
                corner: (left, sheet.top + 6),
                size,
                labelled: [at + 1 == ladder.scenes.len(), true],
            };
            front(sheet, &mut place.panel(sheet, &x, &y)?, scene, style_of)?;
            sheet.top += PANEL_HEIGHT + 42;
        }
        // Leave space for the tick labels of the last panel.
        sheet.top += TICK_GAP + LINE - 36;
        let label = format!("cost of {} ({unit})", ladder.evaluation);
        let place = (left + size.0 / 2, sheet.top + TEXT / 2);
        sheet.text(&label, place, HPos::Center, INK)?;
        sheet.top += LINE;
        Ok(())
    })
}

fn front(
    sheet: &Sheet,
    panel: &mut Panel<'_>,
    scene: &LadderScene,
    style_of: impl Fn(&Rung) -> Style,
) -> Drawn {
    mesh(panel)?;
    let place = |rung: &Rung| panel.backend_coord(&(rung.cost, drawn_error(rung)));
    let (mut front, beaten): (Vec<&Rung>, Vec<&Rung>) =
        scene.rungs.iter().partition(|rung| rung.on_front);
    front.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let called = |rungs: &[&Rung]| -> Vec<(String, Point)> {
        let called = rungs.iter().map(|rung| (named(rung), place(rung)));
        called.collect()
    };
    let (across, down) = panel.plotting_area().get_pixel_range();
    let frame = [across.start, down.start, across.end, down.end];
    let measured = scene.rungs.iter().filter(|rung| !is_off_scale(rung));
    let bars: Vec<[Point; 2]> = measured
        .map(|rung| {
            let ends = interval(rung).map(|end| panel.backend_coord(&(rung.cost, end)));
            ends.map(|(x, y)| (x, y.clamp(down.start, down.end)))
        })
        .collect();
    let names = label_placement::place(&called(&front), &called(&beaten), &bars, frame);
    if front.len() > 1 {
        let places = front.iter().map(|rung| place(rung)).collect();
        sheet.path(places, QUIET.stroke_width(STROKE))?;
    }
    let rung = |rung: &Rung, style: Style, size: f64| {
        if is_off_scale(rung) {
            let arrow = arrow(place(rung)).to_vec();
            sheet.area.draw(&Polygon::new(arrow, style.colour))?;
        } else {
            bar(
                panel,
                rung.cost,
                interval(rung),
                2 * MARKER as i32,
                style.colour,
            )?;
        }
        sheet
            .area
            .draw(&Placed(place(rung), Symbol::new(style, size)))
    };
    for beaten in beaten {
        let style = style_of(beaten);
        let colour = pale(style.colour);
        rung(beaten, Style { colour, ..style }, OTHER)?;
        // The tooltip shows the name of the model, even if there is no space for a label.
        sheet.title(&named(beaten));
    }
    for leader in names.iter().filter_map(|name| name.leader) {
        sheet.path(leader.to_vec(), FRAME.stroke_width(HAIR))?;
    }
    for best in front {
        rung(best, style_of(best), MARKER)?;
    }
    for name in &names {
        let colour = if name.of_front { INK } else { QUIET };
        let style = letters(NAME, colour, HPos::Left);
        sheet.area.draw_text(&name.text, &style, name.place)?;
    }
    Ok(())
}

fn interval(rung: &Rung) -> [f64; 2] {
    normal(rung.error, rung.error_std).map(|end| Spacing::Log.nearest(end))
}

/// Label of a model: its name, and its error if the error is beyond the axis.
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
    rung.error > MAX_ERROR
}

/// Corners of an arrowhead that is above a marker and points upwards.
fn arrow((x, y): Point) -> [Point; 3] {
    let (size, bottom) = (OTHER as i32, y - MARKER as i32 - 9);
    [(x - size, bottom), (x + size, bottom), (x, bottom - 16)]
}

/// Name of the family of a model: the name of the model without its settings. Settings are the numbers in the name with
/// the words that follow them, and the parts that contain `=`. Models of a family differ only in settings.
fn family(name: &str) -> String {
    let is_number = |word: &&str| word.starts_with(|letter: char| letter.is_ascii_digit());
    let kept = name.split(", ").map(|part| {
        let words = part.split(' ').take_while(|word| !is_number(word));
        let words: Vec<&str> = words.filter(|word| !["×", "="].contains(word)).collect();
        words.join(" ")
    });
    let mut kept = kept.zip(name.split(", "));
    let first = kept.next().map_or(String::new(), |(words, _)| words);
    // Keep the first part of the name. Of the other parts, drop those that begin with a number or contain `=`, because
    // they are settings.
    let others = kept.filter(|(words, part)| !words.is_empty() && !part.contains('='));
    let others = others.map(|(words, _)| words);
    std::iter::once(first)
        .chain(others)
        .collect::<Vec<_>>()
        .join(", ")
}

fn drawn_error(rung: &Rung) -> f64 {
    rung.error.min(MAX_ERROR)
}
