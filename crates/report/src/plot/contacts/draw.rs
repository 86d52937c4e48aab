//! Drawing the contacts.

use super::table::{Finger, Vector};
use super::{Layout, SAMPLE, Sample};
use crate::plot::canvas::{Anchor, Canvas, Drawn, Point};
use crate::plot::draw::{FAINT, FRAME, GRID, INK, QUIET, WHITE, paragraph};
use crate::plot::layout::{EDGE, TEXT, TITLE};
use crate::plot::scale::Tick;
use crate::plot::style::Style;
use crate::words;
use plotters::prelude::DrawingBackend;

const PATH: f64 = 2.5;
const DOT: f64 = 5.0;
/// Pixels per tick.
const APART: f64 = 64.0;

/// Draws the picture.
pub(crate) fn draw<B: DrawingBackend>(layout: &Layout, canvas: &Canvas<B>) -> Drawn {
    canvas.fill(WHITE)?;
    let y = paragraph(canvas, &layout.title, EDGE, TITLE, INK)?;
    paragraph(canvas, &layout.subtitle, y, TEXT, QUIET)?;
    for (place, sample, text) in &layout.key {
        key(*place, *sample, canvas)?;
        let place = (place.0 + SAMPLE + 8.0, place.1);
        canvas.text(text, place, TEXT, Anchor::Left, INK)?;
    }
    layout.walls(canvas)?;
    layout.shadows(canvas)?;
    layout.links(canvas)?;
    // What is near covers what is far.
    let mut order: Vec<(usize, &Finger)> = layout.contacts.fingers.iter().enumerate().collect();
    let nearness = |finger: &Finger| {
        let all = finger
            .touches
            .iter()
            .map(|touch| layout.view.nearness(touch.place));
        all.sum::<f64>() / finger.touches.len().max(1) as f64
    };
    order.sort_by(|a, b| nearness(a.1).total_cmp(&nearness(b.1)));
    for (at, finger) in order {
        layout.finger(finger, Style::of(at), canvas)?;
    }
    Ok(())
}

fn key<B: DrawingBackend>((x, y): Point, sample: Sample, canvas: &Canvas<B>) -> Drawn {
    let (ends, middle) = ([(x, y), (x + SAMPLE, y)], (x + SAMPLE / 2.0, y));
    match sample {
        Sample::Finger(at) => {
            canvas.line(&ends, Style::of(at).colour, PATH)?;
            canvas.disc(middle, DOT, Style::of(at).colour)
        }
        Sample::Normal => canvas.line(&ends, QUIET, 1.5),
        Sample::Reading => reading(middle, QUIET, GRID, canvas),
        Sample::Tip => canvas.dashes(&ends, QUIET, 1.5),
    }
}

fn reading<B: DrawingBackend>(
    place: Point,
    rim: plotters::prelude::RGBColor,
    fill: plotters::prelude::RGBColor,
    canvas: &Canvas<B>,
) -> Drawn {
    canvas.disc(place, DOT, rim)?;
    canvas.disc(place, DOT - 1.4, fill)
}

impl Layout {
    fn at(&self, place: Vector) -> Point {
        self.view.at(place)
    }

    /// The place at these shares of the sides of the box.
    fn inside(&self, shares: Vector) -> Point {
        self.at(self.view.inside(shares))
    }

    fn ticks(&self, axis: usize) -> Vec<Tick> {
        let about = (self.view.side(axis) / APART).clamp(2.0, 6.0) as usize;
        self.view.axes[axis].ticks(about)
    }

    /// Floor and the two walls behind, ruled at the ticks; then the edges with their labels.
    fn walls<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Drawn {
        let share = |axis: usize, tick: &Tick| self.view.axes[axis].place(tick.at);
        let rule = |ends: [Vector; 3]| canvas.line(&ends.map(|end| self.inside(end)), FAINT, 1.0);
        let floor = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
        ];
        canvas.polygon(
            &floor.map(|corner| self.inside(corner)),
            plotters::prelude::RGBColor(248, 248, 246),
        )?;
        let (xs, ys, zs) = (self.ticks(0), self.ticks(1), self.ticks(2));
        for tick in &xs {
            let x = share(0, tick);
            rule([[x, 0.0, 0.0], [x, 1.0, 0.0], [x, 1.0, 1.0]])?;
        }
        for tick in &ys {
            let y = share(1, tick);
            rule([[1.0, y, 0.0], [0.0, y, 0.0], [0.0, y, 1.0]])?;
        }
        for tick in &zs {
            let z = share(2, tick);
            rule([[0.0, 0.0, z], [0.0, 1.0, z], [1.0, 1.0, z]])?;
        }
        let edges: [&[Vector]; 4] = [
            &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]],
            &[[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]],
            &[
                [0.0, 0.0, 0.0],
                [0.0, 0.0, 1.0],
                [0.0, 1.0, 1.0],
                [1.0, 1.0, 1.0],
                [1.0, 1.0, 0.0],
            ],
            &[[0.0, 1.0, 0.0], [0.0, 1.0, 1.0]],
        ];
        for (at, edge) in edges.iter().enumerate() {
            let points: Vec<Point> = edge.iter().map(|corner| self.inside(*corner)).collect();
            canvas.line(&points, if at == 0 { FRAME } else { GRID }, 1.0)?;
        }
        canvas.line(
            &[[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]].map(|end| self.inside(end)),
            FRAME,
            1.0,
        )?;
        self.labels(&xs, &ys, &zs, canvas)
    }

    fn labels<B: DrawingBackend>(
        &self,
        xs: &[Tick],
        ys: &[Tick],
        zs: &[Tick],
        canvas: &Canvas<B>,
    ) -> Drawn {
        let share = |axis: usize, tick: &Tick| self.view.axes[axis].place(tick.at);
        let name = |axis: &str| words::with_unit(axis, &words::unit(&self.contacts.unit));
        let moved = |(x, y): Point, dx: f64, dy: f64| (x + dx, y + dy);
        for tick in xs {
            let place = moved(self.inside([share(0, tick), 0.0, 0.0]), -7.0, 17.0);
            canvas.text(&tick.label, place, TEXT, Anchor::Middle, INK)?;
        }
        for tick in ys {
            let place = moved(self.inside([1.0, share(1, tick), 0.0]), 10.0, 11.0);
            canvas.text(&tick.label, place, TEXT, Anchor::Left, INK)?;
        }
        for tick in zs {
            let place = moved(self.inside([0.0, 0.0, share(2, tick)]), -10.0, 0.0);
            canvas.text(&tick.label, place, TEXT, Anchor::Right, INK)?;
        }
        let x = moved(self.inside([0.5, 0.0, 0.0]), -36.0, 44.0);
        canvas.text(&name("x"), x, TEXT, Anchor::Middle, INK)?;
        let y = moved(self.inside([1.0, 0.5, 0.0]), 52.0, 34.0);
        canvas.text(&name("y"), y, TEXT, Anchor::Left, INK)?;
        let z = moved(self.inside([0.0, 0.0, 1.0]), -10.0, -14.0);
        canvas.text(&name("z"), z, TEXT, Anchor::Right, INK)
    }

    /// The paths on the floor.
    fn shadows<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Drawn {
        let floor = self.view.axes[2].ends().0;
        for finger in &self.contacts.fingers {
            let down = finger
                .touches
                .iter()
                .map(|touch| [touch.place[0], touch.place[1], floor]);
            let points: Vec<Point> = down.map(|place| self.at(place)).collect();
            canvas.line(&points, GRID, 1.8)?;
        }
        Ok(())
    }

    /// Lines from finger to finger through contacts made at one time, which show the surface between them.
    fn links<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Drawn {
        let fingers = &self.contacts.fingers;
        let count = fingers
            .iter()
            .map(|finger| finger.touches.len())
            .min()
            .unwrap_or(0);
        if fingers.iter().any(|finger| finger.touches.len() != count) {
            return Ok(());
        }
        for at in 0..count {
            let across = fingers
                .iter()
                .map(|finger| self.at(finger.touches[at].place));
            canvas.line(&across.collect::<Vec<_>>(), GRID, 1.2)?;
        }
        Ok(())
    }

    fn finger<B: DrawingBackend>(
        &self,
        finger: &Finger,
        style: Style,
        canvas: &Canvas<B>,
    ) -> Drawn {
        let places = |pick: fn(&super::table::Touch) -> Vector| {
            finger
                .touches
                .iter()
                .map(|touch| self.at(pick(touch)))
                .collect::<Vec<Point>>()
        };
        if self.contacts.tips_apart {
            canvas.dashes(&places(|touch| touch.tip), style.pale(), 1.5)?;
        }
        if finger.readings.len() == finger.touches.len() {
            for (touch, read) in finger.touches.iter().zip(&finger.readings) {
                canvas.line(&[self.at(touch.place), self.at(*read)], style.pale(), 1.0)?;
            }
        }
        let path = places(|touch| touch.place);
        canvas.line(&path, style.colour, PATH)?;
        for touch in &finger.touches {
            if let Some(normal) = touch.normal {
                let end = [0, 1, 2].map(|k| touch.place[k] + self.stroke * normal[k]);
                canvas.line(&[self.at(touch.place), self.at(end)], QUIET, 1.5)?;
            }
        }
        for place in path {
            canvas.disc(place, DOT, style.colour)?;
        }
        for read in &finger.readings {
            reading(self.at(*read), style.colour, style.pale(), canvas)?;
        }
        Ok(())
    }
}
