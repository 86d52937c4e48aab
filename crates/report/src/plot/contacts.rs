//! Figures of kind `contacts`: paths, normals and readings of gliding fingers in three dimensions.

use super::captions;
use super::contact_table::{self, Contacts, Finger, Touch};
use super::drawing::Figure;
use super::scale::Scale;
use super::selection::Request;
use super::sheet::{self, Drawn, HAIR, Key, Sample, WIDTH, dashed};
use super::space::{BELOW, Space, Vector, View, around, at};
use super::style::{GRID, Marker, QUIET, Style, pale};
use super::symbol::Symbol;
use crate::{ReportError, phrases};
use palpate_study::label::spoken_unit;
use palpate_study::number;
use plotters::element::{Circle, PathElement};
use plotters::style::Color;

/// Length of the lines that show normals, relative to the longer horizontal side of the box around all contacts.
const STROKE: f64 = 0.09;
/// Length of the symbol beside each text of the key (legend), in drawing units (1/3 px).
const SAMPLE: i32 = 102;
const PATH: u32 = 8;
const FINE: u32 = 4;
const DOT: u32 = 15;
pub(crate) fn figure(of: Request<'_>) -> Result<Figure, ReportError> {
    let contacts = contact_table::read(of.study.files())?;
    let words = of.words(subtitle(of, &contacts), Vec::new());
    sheet::figure(words, WIDTH, |sheet| {
        sheet.key(SAMPLE, &key(&contacts))?;
        let (scales, stroke) = scales(&contacts);
        let view = View::of(&scales);
        let scene = Scene {
            space: view.space(sheet, &scales)?,
            contacts: &contacts,
            floor: scales[2].ends().0,
            stroke,
        };
        view.name_axes(&scene.space, sheet, &spoken_unit(&contacts.unit), &scales)?;
        scene.draw()?;
        sheet.top += view.high + BELOW;
        Ok(())
    })
}

fn scales(contacts: &Contacts) -> ([Scale; 3], f64) {
    let touches = || contacts.fingers.iter().flat_map(|finger| &finger.touches);
    let mut places: Vec<Vector> = touches().map(|touch| touch.place).collect();
    let side = |axis: usize| {
        let (low, high) = around(&places, axis).ends();
        high - low
    };
    let stroke = STROKE * side(0).max(side(1));
    for finger in &contacts.fingers {
        places.extend(&finger.readings);
    }
    for touch in touches() {
        places.extend(contacts.tips_apart.then_some(touch.tip));
        places.extend(touch.along_normal(stroke));
    }
    ([0, 1, 2].map(|axis| around(&places, axis)), stroke)
}

fn subtitle(of: Request<'_>, contacts: &Contacts) -> String {
    let object: Vec<String> = captions::object(of.study).into_iter().collect();
    let fingers = contacts.fingers.len();
    let mut counts: Vec<usize> = contacts.fingers.iter().map(|f| f.touches.len()).collect();
    counts.sort_unstable();
    counts.dedup();
    let each = match counts.as_slice() {
        [one] => format!("{} each", plural(*one, "contact")),
        [least, .., most] => format!("{least} to {most} contacts each"),
        [] => String::new(),
    };
    let mut sample = format!("{} with {each}", plural(fingers, "finger"));
    if let Some(off) = contacts.off {
        let unit = spoken_unit(&contacts.unit);
        let off = format!("{} {unit}", number::significant(off, 3));
        sample += &format!("; the readings are off by {} (rms)", off.trim_end());
    }
    phrases::sentence(&object, &sample)
}

fn plural(count: usize, of: &str) -> String {
    format!("{count} {of}{}", if count == 1 { "" } else { "s" })
}

fn key(contacts: &Contacts) -> Key {
    let disc = |style: Style| {
        Symbol::new(
            Style {
                marker: Marker::Circle,
                ..style
            },
            DOT.into(),
        )
    };
    let fingers = contacts.fingers.iter().enumerate();
    let mut entries: Key = fingers
        .map(|(at, finger)| {
            let line = Sample::line(Style::of(at).colour.stroke_width(PATH));
            (
                line.with(disc(Style::of(at))),
                format!("finger {}", finger.name),
            )
        })
        .collect();
    let normal = Sample::line(QUIET.stroke_width(FINE));
    entries.push((normal, "normal".to_owned()));
    let mut fingers = contacts.fingers.iter();
    if fingers.any(|finger| !finger.readings.is_empty()) {
        let reading = disc(Style::new(QUIET, Marker::Circle)).open();
        entries.push((Sample::symbol(reading), "reading".to_owned()));
    }
    if contacts.tips_apart {
        let tip = Sample::dashed(QUIET.stroke_width(FINE));
        entries.push((tip, "tip centre".to_owned()));
    }
    entries
}

struct Scene<'a> {
    space: Space<'a>,
    contacts: &'a Contacts,
    floor: f64,
    stroke: f64,
}

impl Scene<'_> {
    fn draw(&self) -> Drawn {
        let area = self.space.plotting_area();
        // Draw the projections of the fingers' paths onto the floor of the chart first, so that they are behind
        // everything else.
        for finger in &self.contacts.fingers {
            let places = finger.touches.iter().map(|touch| touch.place);
            let down = places.map(|[x, y, _]| at([x, y, self.floor]));
            let down: Vec<_> = down.collect();
            area.draw(&PathElement::new(down, GRID.stroke_width(FINE)))?;
        }
        self.links()?;
        // Distant fingers are drawn first, so that near fingers cover them.
        let mut order: Vec<(usize, &Finger)> = self.contacts.fingers.iter().enumerate().collect();
        let depth = |finger: &Finger| {
            let depths = finger.touches.iter().map(|touch| {
                let (x, y, z) = at(touch.place);
                f64::from(area.as_coord_spec().projected_depth(&x, &y, &z))
            });
            depths.sum::<f64>() / finger.touches.len().max(1) as f64
        };
        order.sort_by(|a, b| depth(b.1).total_cmp(&depth(a.1)));
        let mut order = order.into_iter();
        order.try_for_each(|(number, finger)| self.finger(finger, Style::of(number)))
    }

    /// Draws lines that connect the first contacts of all fingers, then the second contacts, and so on. They show the
    /// shape of the surface between the fingers. If the fingers have different numbers of contacts, no lines are drawn.
    fn links(&self) -> Drawn {
        let fingers = &self.contacts.fingers;
        let counts = fingers.iter().map(|finger| finger.touches.len());
        let count = counts.clone().min().unwrap_or(0);
        if counts.max() != Some(count) {
            return Ok(());
        }
        for number in 0..count {
            let touches = fingers
                .iter()
                .map(|finger| at(finger.touches[number].place));
            let across: Vec<_> = touches.collect();
            let link = PathElement::new(across, GRID.stroke_width(FINE));
            self.space.plotting_area().draw(&link)?;
        }
        Ok(())
    }

    fn finger(&self, finger: &Finger, style: Style) -> Drawn {
        let area = self.space.plotting_area();
        let (colour, faint) = (style.colour, pale(style.colour));
        let places = |pick: fn(&Touch) -> Vector| {
            let touches = finger.touches.iter();
            touches.map(|touch| at(pick(touch))).collect::<Vec<_>>()
        };
        if self.contacts.tips_apart {
            area.draw(&dashed(places(|touch| touch.tip), faint.stroke_width(FINE)))?;
        }
        let path = places(|touch| touch.place);
        if finger.readings.len() == finger.touches.len() {
            for (place, read) in path.iter().zip(&finger.readings) {
                let error = [*place, at(*read)];
                area.draw(&PathElement::new(error, faint.stroke_width(HAIR)))?;
            }
        }
        area.draw(&PathElement::new(path.clone(), colour.stroke_width(PATH)))?;
        for touch in &finger.touches {
            if let Some(end) = touch.along_normal(self.stroke) {
                let normal = [at(touch.place), at(end)];
                area.draw(&PathElement::new(normal, QUIET.stroke_width(FINE)))?;
            }
        }
        for place in path {
            area.draw(&Circle::new(place, DOT, colour.filled()))?;
        }
        for read in &finger.readings {
            for (radius, colour) in [(DOT, colour), (DOT - 4, faint)] {
                area.draw(&Circle::new(at(*read), radius, colour.filled()))?;
            }
        }
        Ok(())
    }
}
