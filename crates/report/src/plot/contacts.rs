//! The contacts of gliding fingers in space: their paths, normals and readings.

mod draw;
mod table;
mod view;

use super::canvas::Point;
use super::captions;
use super::layout::{EDGE, LEADING, TEXT, TITLE};
use super::lettering::{width, wrap};
use super::scale::{Scale, Spacing};
use super::spec::Heading;
use crate::{ReportError, Study, words};
use table::{Contacts, Vector};
use view::View;

pub(crate) use draw::draw;

const WIDTH: f64 = 960.0;
/// Room for the labels of the axes, to the left and right of the box and below it.
const BESIDE: f64 = 66.0;
const BELOW: f64 = 16.0;
/// Height that the box may take.
const TALLEST: f64 = 620.0;
/// Length of a stroke along a normal, as a share of the larger horizontal side of the contacts.
const STROKE: f64 = 0.09;
/// Length of a sample in the key.
const SAMPLE: f64 = 34.0;

/// The picture with the place of everything.
pub(crate) struct Layout {
    /// File stem.
    pub(crate) name: String,
    /// Its title in one piece.
    pub(crate) title_text: String,
    pub(crate) size: (f64, f64),
    title: Vec<String>,
    subtitle: Vec<String>,
    /// Sample and words, from the left end of the sample at its middle height.
    key: Vec<(Point, Sample, String)>,
    contacts: Contacts,
    view: View,
    /// Length of a stroke along a normal.
    stroke: f64,
}

/// Sample before an entry of the key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sample {
    /// Path and contacts of a finger.
    Finger(usize),
    Normal,
    Reading,
    Tip,
}

/// Lays out the contacts in the study's `trace.csv` and `readings.csv`.
pub(crate) fn layout(study: &Study, heading: &Heading) -> Result<Layout, ReportError> {
    let contacts = table::read(study.dir())?;
    let title_text = heading.title.as_deref().unwrap_or(study.title());
    let title = wrap(title_text, TITLE, WIDTH - 2.0 * EDGE);
    let subtitle = wrap(&subtitle(study, &contacts), TEXT, WIDTH - 2.0 * EDGE);
    let line = TEXT * LEADING;
    let top = EDGE + title.len() as f64 * TITLE * LEADING + subtitle.len() as f64 * line + 12.0;
    let key = key(&contacts, top);
    let top = key.last().map_or(top, |(place, ..)| place.1) + line;

    let (axes, stroke) = axes(&contacts);
    let room = (WIDTH - 2.0 * (EDGE + BESIDE), TALLEST);
    let view = View::new(axes, (EDGE + BESIDE, top), room);
    let bottom = top + view.extent().1 + BELOW;
    Ok(Layout {
        name: heading.name.clone(),
        title_text: title_text.to_owned(),
        size: (WIDTH, (bottom + EDGE - 6.0).ceil()),
        title,
        subtitle,
        key,
        contacts,
        view,
        stroke,
    })
}

/// Axes that hold everything drawn, and the length of the strokes along normals.
fn axes(contacts: &Contacts) -> ([Scale; 3], f64) {
    let mut places: Vec<Vector> = Vec::new();
    for finger in &contacts.fingers {
        places.extend(finger.touches.iter().map(|touch| touch.place));
    }
    let side = |axis: usize| {
        let (low, high) = around(&places, axis).ends();
        high - low
    };
    let stroke = STROKE * side(0).max(side(1));
    for finger in &contacts.fingers {
        places.extend(&finger.readings);
        for touch in &finger.touches {
            if contacts.tips_apart {
                places.push(touch.tip);
            }
            if let Some(normal) = touch.normal {
                places.push([0, 1, 2].map(|k| touch.place[k] + stroke * normal[k]));
            }
        }
    }
    ([0, 1, 2].map(|axis| around(&places, axis)), stroke)
}

fn around(places: &[Vector], axis: usize) -> Scale {
    Scale::around(Spacing::Linear, places.iter().map(|place| place[axis]))
}

/// Subtitle of the plot: the object, the numbers of fingers and contacts, and the error of the readings.
fn subtitle(study: &Study, contacts: &Contacts) -> String {
    let mut parts: Vec<String> = captions::object(study).into_iter().collect();
    let fingers = contacts.fingers.len();
    let mut counts: Vec<usize> = contacts.fingers.iter().map(|f| f.touches.len()).collect();
    counts.sort_unstable();
    counts.dedup();
    let each = match counts.as_slice() {
        [one] => format!("{} each", plural(*one, "contact")),
        [least, .., most] => format!("{least} to {most} contacts each"),
        [] => String::new(),
    };
    parts.push(format!("{}, {each}", plural(fingers, "finger")));
    if let Some(off) = contacts.off {
        let unit = words::unit(&contacts.unit);
        let off = format!("{} {unit}", words::significant(off, 3));
        parts.push(format!("readings off by {} rms", off.trim_end()));
    }
    parts.join(" · ")
}

fn plural(count: usize, of: &str) -> String {
    format!("{count} {of}{}", if count == 1 { "" } else { "s" })
}

fn key(contacts: &Contacts, top: f64) -> Vec<(Point, Sample, String)> {
    let fingers = contacts.fingers.iter().enumerate();
    let mut entries: Vec<(Sample, String)> = fingers
        .map(|(at, finger)| (Sample::Finger(at), format!("finger {}", finger.name)))
        .collect();
    entries.push((Sample::Normal, "normal".to_owned()));
    if contacts
        .fingers
        .iter()
        .any(|finger| !finger.readings.is_empty())
    {
        entries.push((Sample::Reading, "reading".to_owned()));
    }
    if contacts.tips_apart {
        entries.push((Sample::Tip, "tip centre".to_owned()));
    }
    let (mut x, mut y) = (EDGE, top + TEXT / 2.0);
    let mut placed = Vec::new();
    for (sample, text) in entries {
        let wide = SAMPLE + 8.0 + width(&text, TEXT);
        if x > EDGE && x + wide > WIDTH - EDGE {
            (x, y) = (EDGE, y + TEXT * LEADING);
        }
        placed.push(((x, y), sample, text));
        x += wide + 26.0;
    }
    placed
}
