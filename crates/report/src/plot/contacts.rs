//! The contacts of gliding fingers in space: their paths, normals and readings.

mod table;
mod view;

use super::canvas::{Anchor, Canvas, Point};
use super::captions;
use super::figure::Figure;
use super::frame::{EDGE, Frame, TEXT, WIDTH};
use super::request::Request;
use super::scale::{Scale, Spacing, Tick};
use super::style::{Colour, FAINT, FLOOR, FRAME, GRID, INK, QUIET, Style};
use crate::{ReportError, words};
use palpate_study::label::{spoken_unit, with_unit};
use palpate_study::number;
use table::{Contacts, Finger, Touch, Vector};
use view::View;

/// Room for the labels of the axes, to the left and right of the box and below it.
const BESIDE: f64 = 66.0;
const BELOW: f64 = 16.0;
/// Height that the box may take.
const TALLEST: f64 = 620.0;
/// Length of a stroke along a normal, as a share of the larger horizontal side of the contacts.
const STROKE: f64 = 0.09;
/// Length of a sample in the key.
const SAMPLE: f64 = 34.0;
const PATH: f64 = 2.5;
const DOT: f64 = 5.0;
/// Pixels per tick.
const APART: f64 = 64.0;

/// The figure that a plot asks for.
pub(crate) fn figure(of: Request<'_>) -> Result<Figure, ReportError> {
    let contacts = table::read(of.study.files())?;
    let words = of.words(subtitle(of, &contacts), Vec::new());
    let mut frame = Frame::new(words, WIDTH);
    frame.key(SAMPLE, &key(&contacts), sample);
    let (axes, stroke) = axes(&contacts);
    let room = (WIDTH - 2.0 * (EDGE + BESIDE), TALLEST);
    let scene = Scene {
        view: View::new(axes, (EDGE + BESIDE, frame.top), room),
        contacts: &contacts,
        stroke,
    };
    scene.draw(&mut frame.canvas);
    frame.top += scene.view.extent().1 + BELOW;
    frame.finish()
}

/// Axes that hold everything drawn, and the length of the strokes along normals.
fn axes(contacts: &Contacts) -> ([Scale; 3], f64) {
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

fn around(places: &[Vector], axis: usize) -> Scale {
    Scale::around(Spacing::Linear, places.iter().map(|place| place[axis]))
}

/// Subtitle of the plot: the object, the numbers of fingers and contacts, and the error of the readings.
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
    let mut seen = format!("{} with {each}", plural(fingers, "finger"));
    if let Some(off) = contacts.off {
        let unit = spoken_unit(&contacts.unit);
        let off = format!("{} {unit}", number::significant(off, 3));
        seen += &format!("; the readings are off by {} (rms)", off.trim_end());
    }
    words::sentence(&object, &seen)
}

fn plural(count: usize, of: &str) -> String {
    format!("{count} {of}{}", if count == 1 { "" } else { "s" })
}

/// Sample before an entry of the key.
enum Sample {
    /// Path and contacts of a finger.
    Finger(usize),
    Normal,
    Reading,
    Tip,
}

fn key(contacts: &Contacts) -> Vec<(Sample, String)> {
    let fingers = contacts.fingers.iter().enumerate();
    let mut entries: Vec<(Sample, String)> = fingers
        .map(|(at, finger)| (Sample::Finger(at), format!("finger {}", finger.name)))
        .collect();
    entries.push((Sample::Normal, "normal".to_owned()));
    let mut fingers = contacts.fingers.iter();
    if fingers.any(|finger| !finger.readings.is_empty()) {
        entries.push((Sample::Reading, "reading".to_owned()));
    }
    if contacts.tips_apart {
        entries.push((Sample::Tip, "tip centre".to_owned()));
    }
    entries
}

fn sample(canvas: &mut Canvas, (x, y): Point, sample: &Sample) {
    let (ends, middle) = ([(x, y), (x + SAMPLE, y)], (x + SAMPLE / 2.0, y));
    match sample {
        Sample::Finger(at) => {
            let Style { colour, .. } = Style::of(*at);
            canvas.line(&ends, colour, PATH);
            canvas.disc(middle, DOT, colour);
        }
        Sample::Normal => canvas.line(&ends, QUIET, 1.5),
        Sample::Reading => reading(canvas, middle, QUIET, GRID),
        Sample::Tip => canvas.dashes(&ends, QUIET, 1.5),
    }
}

fn reading(canvas: &mut Canvas, place: Point, rim: Colour, fill: Colour) {
    canvas.disc(place, DOT, rim);
    canvas.disc(place, DOT - 1.4, fill);
}

/// The contacts as they are seen.
struct Scene<'a> {
    contacts: &'a Contacts,
    view: View,
    /// Length of a stroke along a normal.
    stroke: f64,
}

impl Scene<'_> {
    fn draw(&self, canvas: &mut Canvas) {
        self.walls(canvas);
        self.shadows(canvas);
        self.links(canvas);
        // What is near covers what is far.
        let mut order: Vec<(usize, &Finger)> = self.contacts.fingers.iter().enumerate().collect();
        let nearness = |finger: &Finger| {
            let touches = finger.touches.iter();
            let all = touches.map(|touch| self.view.nearness(touch.place));
            all.sum::<f64>() / finger.touches.len().max(1) as f64
        };
        order.sort_by(|a, b| nearness(a.1).total_cmp(&nearness(b.1)));
        for (at, finger) in order {
            self.finger(finger, Style::of(at), canvas);
        }
    }

    fn at(&self, place: Vector) -> Point {
        self.view.at(place)
    }

    /// The place at these shares of the sides of the box.
    fn inside(&self, shares: Vector) -> Point {
        self.at(self.view.inside(shares))
    }

    /// Ticks along an axis, each with its share of the side.
    fn ticks(&self, axis: usize) -> Vec<(f64, Tick)> {
        let about = (self.view.side(axis) / APART).clamp(2.0, 6.0) as usize;
        let scale = &self.view.axes[axis];
        let ticks = scale.ticks(about).into_iter();
        ticks.map(|tick| (scale.place(tick.at), tick)).collect()
    }

    /// Floor and the two walls behind, ruled at the ticks; then the edges with their labels.
    fn walls(&self, canvas: &mut Canvas) {
        let [o, x, y, z] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let (xy, yz, xyz) = ([1.0, 1.0, 0.0], [0.0, 1.0, 1.0], [1.0; 3]);
        canvas.polygon(&[o, x, xy, y].map(|corner| self.inside(corner)), FLOOR);
        let ticks = [0, 1, 2].map(|axis| self.ticks(axis));
        let rules: [fn(f64) -> [Vector; 3]; 3] = [
            |x| [[x, 0.0, 0.0], [x, 1.0, 0.0], [x, 1.0, 1.0]],
            |y| [[1.0, y, 0.0], [0.0, y, 0.0], [0.0, y, 1.0]],
            |z| [[0.0, 0.0, z], [0.0, 1.0, z], [1.0, 1.0, z]],
        ];
        for (ticks, rule) in ticks.iter().zip(rules) {
            for (share, _) in ticks {
                let ends = rule(*share).map(|end| self.inside(end));
                canvas.line(&ends, FAINT, 1.0);
            }
        }
        let edges: [(&[Vector], Colour); 5] = [
            (&[o, x, xy], FRAME),
            (&[o, y, xy], GRID),
            (&[o, z, yz, xyz, xy], GRID),
            (&[y, yz], GRID),
            (&[o, z], FRAME),
        ];
        for (edge, colour) in edges {
            let points: Vec<Point> = edge.iter().map(|corner| self.inside(*corner)).collect();
            canvas.line(&points, colour, 1.0);
        }
        self.labels(&ticks, canvas);
    }

    fn labels(&self, [xs, ys, zs]: &[Vec<(f64, Tick)>; 3], canvas: &mut Canvas) {
        let mut label = |text: &str, shares: Vector, (dx, dy): Point, anchor: Anchor| {
            let (x, y) = self.inside(shares);
            canvas.text(text, (x + dx, y + dy), TEXT, anchor, INK);
        };
        for (x, tick) in xs {
            label(&tick.label, [*x, 0.0, 0.0], (-7.0, 17.0), Anchor::Middle);
        }
        for (y, tick) in ys {
            label(&tick.label, [1.0, *y, 0.0], (10.0, 11.0), Anchor::Left);
        }
        for (z, tick) in zs {
            label(&tick.label, [0.0, 0.0, *z], (-10.0, 0.0), Anchor::Right);
        }
        let unit = spoken_unit(&self.contacts.unit);
        let [x, y, z] = ["x", "y", "z"].map(|axis| with_unit(axis, &unit));
        label(&x, [0.5, 0.0, 0.0], (-36.0, 44.0), Anchor::Middle);
        label(&y, [1.0, 0.5, 0.0], (52.0, 34.0), Anchor::Left);
        label(&z, [0.0, 0.0, 1.0], (-10.0, -14.0), Anchor::Right);
    }

    /// The paths on the floor.
    fn shadows(&self, canvas: &mut Canvas) {
        let floor = self.view.axes[2].ends().0;
        for finger in &self.contacts.fingers {
            let places = finger.touches.iter().map(|touch| touch.place);
            let down = places.map(|[x, y, _]| self.at([x, y, floor]));
            canvas.line(&down.collect::<Vec<_>>(), GRID, 1.8);
        }
    }

    /// Lines from finger to finger through contacts made at one time, which show the surface between them.
    fn links(&self, canvas: &mut Canvas) {
        let fingers = &self.contacts.fingers;
        let counts = fingers.iter().map(|finger| finger.touches.len());
        let count = counts.clone().min().unwrap_or(0);
        if counts.max() != Some(count) {
            return;
        }
        for at in 0..count {
            let touches = fingers.iter().map(|finger| finger.touches[at]);
            let across = touches.map(|touch| self.at(touch.place));
            canvas.line(&across.collect::<Vec<_>>(), GRID, 1.2);
        }
    }

    fn finger(&self, finger: &Finger, style: Style, canvas: &mut Canvas) {
        let places = |pick: fn(&Touch) -> Vector| {
            let touches = finger.touches.iter();
            touches
                .map(|touch| self.at(pick(touch)))
                .collect::<Vec<Point>>()
        };
        if self.contacts.tips_apart {
            canvas.dashes(&places(|touch| touch.tip), style.pale(), 1.5);
        }
        let path = places(|touch| touch.place);
        if finger.readings.len() == finger.touches.len() {
            for (place, read) in path.iter().zip(&finger.readings) {
                canvas.line(&[*place, self.at(*read)], style.pale(), 1.0);
            }
        }
        canvas.line(&path, style.colour, PATH);
        for touch in &finger.touches {
            if let Some(end) = touch.along_normal(self.stroke) {
                canvas.line(&[self.at(touch.place), self.at(end)], QUIET, 1.5);
            }
        }
        for place in path {
            canvas.disc(place, DOT, style.colour);
        }
        for read in &finger.readings {
            reading(canvas, self.at(*read), style.colour, style.pale());
        }
    }
}
