//! Pareto fronts of a ladder: error against cost, one panel per scene, the rungs on the front named.

mod names;

use super::canvas::{self, Anchor, Canvas, Drawn, Point};
use super::draw::{FAINT, FRAME, GRID, INK, QUIET, WHITE, paragraph};
use super::layout::{EDGE, LEADING, TEXT, TICK_GAP, TITLE};
use super::lettering::{width, wrap};
use super::picture::Picture;
use super::scale::{Scale, Spacing};
use super::style::{Marker, Style};
use super::write;
use crate::tradeoff::{Ladder, LadderScene, Rung, Tradeoff};
use crate::{ReportError, words};
use names::Name;
use plotters::prelude::{DrawingBackend, RGBColor};
use std::path::{Path, PathBuf};

const WIDTH: f64 = 960.0;
const PANEL_HEIGHT: f64 = 235.0;
/// Size of the rungs' names.
pub(super) const NAME: f64 = 15.0;
const MARKER: f64 = 5.0;
const OTHER: f64 = 3.0;
const STROKE: f64 = 2.0;
/// Ten times the truth; no answer that errs by more is worth telling apart. Such a rung is drawn as high as this, and
/// as off the scale.
const WORST: f64 = 10.0;
/// Rungs that another beats.
const BEATEN: RGBColor = RGBColor(178, 178, 178);

/// Draws the Pareto fronts of every ladder of a folder that `cargo xtask tradeoff` has filled, as SVG and PNG beside
/// its tables, and returns the files written.
///
/// # Errors
/// A table is absent or malformed, or a picture cannot be written. Nothing is half-written.
pub fn draw_tradeoff(dir: &Path) -> Result<Vec<PathBuf>, ReportError> {
    let tradeoff = Tradeoff::read(dir)?;
    let mut written = Vec::new();
    for ladder in &tradeoff.ladders {
        let fronts = Fronts::of(ladder, tradeoff.unit());
        written.extend(write(&Picture::Fronts(Box::new(fronts)), dir)?);
    }
    Ok(written)
}

/// The pictures of all ladders as SVG text.
pub(crate) fn svgs(tradeoff: &Tradeoff, dir: &Path) -> Result<Vec<String>, ReportError> {
    let draw = |ladder: &Ladder| {
        let fronts = Picture::Fronts(Box::new(Fronts::of(ladder, tradeoff.unit())));
        canvas::svg(&fronts, &dir.join(format!("{}.svg", ladder.name)))
    };
    tradeoff.ladders.iter().map(draw).collect()
}

/// The picture with the place of everything.
pub(crate) struct Fronts {
    pub(crate) name: String,
    pub(crate) title_text: String,
    pub(crate) size: (f64, f64),
    title: Vec<String>,
    subtitle: Vec<String>,
    x: Scale,
    y: Scale,
    left: f64,
    x_label: String,
    panels: Vec<Panel>,
}

/// One scene.
struct Panel {
    heading: Vec<String>,
    /// Top of the heading.
    above: f64,
    /// Top of the frame.
    top: f64,
    beaten: Vec<Beaten>,
    /// Marks and places of the others, cheapest first.
    front: Vec<(Marker, Point)>,
    names: Vec<Name>,
}

/// A rung that another beats.
struct Beaten {
    place: Point,
    title: String,
    is_off_scale: bool,
}

impl Fronts {
    pub(crate) fn of(ladder: &Ladder, unit: &str) -> Self {
        let rungs = || ladder.scenes.iter().flat_map(|scene| &scene.rungs);
        let x = Scale::around(Spacing::Log, rungs().map(|rung| rung.cost));
        let y = Scale::around(Spacing::Log, rungs().map(shown));
        let widest = y
            .ticks(5)
            .iter()
            .fold(0.0, |most: f64, tick| most.max(width(&tick.label, TEXT)));
        let off_scale = match rungs().any(is_off_scale) {
            true => format!("; triangles: off the scale, more than {WORST}"),
            false => String::new(),
        };
        let mut fronts = Self {
            name: ladder.name.clone(),
            title_text: ladder.title.clone(),
            size: (WIDTH, 0.0),
            title: wrap(&ladder.title, TITLE, WIDTH - 2.0 * EDGE),
            subtitle: wrap(
                &format!("up: {}{off_scale}", ladder.error_of),
                TEXT,
                WIDTH - 2.0 * EDGE,
            ),
            x,
            y,
            left: EDGE + widest + TICK_GAP,
            x_label: format!("cost of {}, {unit}", ladder.evaluation),
            panels: Vec::new(),
        };
        let line = TEXT * LEADING;
        let mut y = EDGE
            + fronts.title.len() as f64 * TITLE * LEADING
            + fronts.subtitle.len() as f64 * line
            + 6.0;
        for scene in &ladder.scenes {
            let heading = format!("{}: {}", scene.ease, scene.what);
            let heading = wrap(&heading, TEXT, WIDTH - EDGE - fronts.left);
            let top = y + heading.len() as f64 * line + 2.0;
            let panel = fronts.panel(scene, heading, (y, top));
            fronts.panels.push(panel);
            y = top + PANEL_HEIGHT + 12.0;
        }
        // Ticks and the label of the last panel.
        fronts.size.1 = (y - 12.0 + TICK_GAP + 2.0 * line + EDGE).ceil();
        fronts
    }

    fn panel(&self, scene: &LadderScene, heading: Vec<String>, (above, top): (f64, f64)) -> Panel {
        let place = |rung: &Rung| -> Point {
            (
                self.left + self.x.place(rung.cost) * self.wide(),
                top + (1.0 - self.y.place(shown(rung))) * PANEL_HEIGHT,
            )
        };
        let beaten = scene.rungs.iter().filter(|rung| !rung.on_front);
        let mut front: Vec<&Rung> = scene.rungs.iter().filter(|rung| rung.on_front).collect();
        front.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let names: Vec<(String, Point)> = front
            .iter()
            .map(|rung| (named(rung), place(rung)))
            .collect();
        let beaten: Vec<Beaten> = beaten
            .map(|rung| Beaten {
                place: place(rung),
                title: named(rung),
                is_off_scale: is_off_scale(rung),
            })
            .collect();
        let places: Vec<Point> = beaten.iter().map(|rung| rung.place).collect();
        let frame = [self.left, top, self.left + self.wide(), top + PANEL_HEIGHT];
        Panel {
            heading,
            above,
            top,
            names: names::place(&names, &places, frame),
            front: front
                .iter()
                .zip(names)
                .map(|(rung, (_, place))| (marker(is_off_scale(rung)), place))
                .collect(),
            beaten,
        }
    }

    /// The SVG with the names of the rungs that have none beside them, as titles of their marks.
    pub(crate) fn titled(&self, svg: &str) -> String {
        let RGBColor(red, green, blue) = BEATEN;
        let fill = format!("fill=\"#{red:02X}{green:02X}{blue:02X}\"");
        let mut titles = self.panels.iter().flat_map(|panel| &panel.beaten);
        let mut titled = String::with_capacity(svg.len());
        for line in svg.lines() {
            let mark = line.strip_suffix("/>").filter(|mark| mark.contains(&fill));
            match mark.and_then(|mark| Some((mark, titles.next()?))) {
                Some((mark, Beaten { title, .. })) => {
                    let (name, _) = mark[1..].split_once(' ').unwrap_or((&mark[1..], ""));
                    let title = canvas::escaped(title);
                    titled += &format!("{mark}><title>{title}</title></{name}>\n");
                }
                None => {
                    titled += line;
                    titled.push('\n');
                }
            }
        }
        titled
    }

    fn wide(&self) -> f64 {
        WIDTH - EDGE - self.left
    }

    pub(crate) fn draw<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Drawn {
        canvas.fill(WHITE)?;
        let y = paragraph(canvas, &self.title, EDGE, TITLE, INK)?;
        paragraph(canvas, &self.subtitle, y, TEXT, QUIET)?;
        for panel in &self.panels {
            self.grid(panel, canvas)?;
            panel.draw(self.left, canvas)?;
        }
        let bottom = self.size.1 - EDGE - 2.0 * TEXT * LEADING;
        for tick in self.x.ticks(8) {
            let at = (self.across(tick.at), bottom + TEXT / 2.0);
            canvas.text(&tick.label, at, TEXT, Anchor::Middle, INK)?;
        }
        let at = (
            self.left + self.wide() / 2.0,
            bottom + TEXT * LEADING + TEXT / 2.0,
        );
        canvas.text(&self.x_label, at, TEXT, Anchor::Middle, INK)
    }

    fn across(&self, cost: f64) -> f64 {
        self.left + self.x.place(cost) * self.wide()
    }

    fn grid<B: DrawingBackend>(&self, panel: &Panel, canvas: &Canvas<B>) -> Drawn {
        let (top, bottom) = (panel.top, panel.top + PANEL_HEIGHT);
        let right = self.left + self.wide();
        for cost in self.x.minor(8) {
            let x = self.across(cost);
            canvas.line(&[(x, top), (x, bottom)], FAINT, 1.0)?;
        }
        for tick in self.x.ticks(8) {
            let x = self.across(tick.at);
            canvas.line(&[(x, top), (x, bottom)], GRID, 1.0)?;
        }
        for tick in self.y.ticks(5) {
            let y = top + (1.0 - self.y.place(tick.at)) * PANEL_HEIGHT;
            canvas.line(&[(self.left, y), (right, y)], GRID, 1.0)?;
            let at = (self.left - TICK_GAP, y);
            canvas.text(&tick.label, at, TEXT, Anchor::Right, INK)?;
        }
        let (left, bottom) = (self.left, bottom);
        let corners = [
            (left, top),
            (right, top),
            (right, bottom),
            (left, bottom),
            (left, top),
        ];
        canvas.line(&corners, FRAME, 1.0)
    }
}

impl Panel {
    fn draw<B: DrawingBackend>(&self, left: f64, canvas: &Canvas<B>) -> Drawn {
        let mut y = self.above + TEXT / 2.0;
        for line in &self.heading {
            canvas.text(line, (left, y), TEXT, Anchor::Left, INK)?;
            y += TEXT * LEADING;
        }
        for rung in &self.beaten {
            match rung.is_off_scale {
                true => canvas.polygon(&triangle(rung.place), BEATEN)?,
                false => canvas.disc(rung.place, OTHER, BEATEN)?,
            }
        }
        let Style { colour, .. } = Style::of(0);
        if self.front.len() > 1 {
            let places: Vec<Point> = self.front.iter().map(|(_, place)| *place).collect();
            canvas.line(&places, colour, STROKE)?;
        }
        for name in &self.names {
            if let Some(leader) = name.leader {
                canvas.line(&leader, FRAME, 1.0)?;
            }
        }
        for (marker, place) in &self.front {
            canvas.marker(*marker, *place, MARKER, colour)?;
        }
        for name in &self.names {
            canvas.text(&name.text, name.place, NAME, Anchor::Left, INK)?;
        }
        Ok(())
    }
}

/// Name of a rung, with its error where that is off the scale.
fn named(rung: &Rung) -> String {
    match is_off_scale(rung) {
        true => format!(
            "{}, errs by {}",
            rung.name,
            words::significant(rung.error, 2)
        ),
        false => rung.name.clone(),
    }
}

fn is_off_scale(rung: &Rung) -> bool {
    rung.error > WORST
}

/// The mark of a rung on the front.
fn marker(is_off_scale: bool) -> Marker {
    match is_off_scale {
        true => Marker::Up,
        false => Style::of(0).marker,
    }
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

/// Words for a cost in instructions or nanoseconds.
pub(crate) fn spoken_cost(instructions: Option<f64>, ns: Option<f64>) -> String {
    let time = ns.map(|ns| match ns {
        _ if ns < 1e3 => format!("{} ns", words::significant(ns, 2)),
        _ if ns < 1e6 => format!("{} µs", words::significant(ns / 1e3, 2)),
        _ if ns < 1e9 => format!("{} ms", words::significant(ns / 1e6, 2)),
        _ => format!("{} s", words::significant(ns / 1e9, 2)),
    });
    let counted = instructions.map(|count| match count {
        _ if count < 1e3 => format!("{count} instructions"),
        _ if count < 1e6 => format!("{} k instructions", words::significant(count / 1e3, 2)),
        _ => format!("{} M instructions", words::significant(count / 1e6, 2)),
    });
    let parts: Vec<String> = time.into_iter().chain(counted).collect();
    parts.join(", ")
}
