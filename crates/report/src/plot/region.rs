//! Feasible region of two fields: which values of one meet a target, over the values of the other.

use super::answer::{MEETS, MISSES, OPEN, Stretch, draw_axes};
use super::canvas::{Anchor, Canvas, Point};
use super::figure::Figure;
use super::frame::{Axes, EDGE, Frame, LINE, TEXT, TICK_GAP, WIDTH, Words, bar, outline, widest};
use super::scale::{Scale, Spacing};
use super::style::{Colour, INK, MARKER, Marker, STROKE, WHITE};
use crate::ReportError;
use palpate_study::Label;

/// Feasible region, as it is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionMap {
    /// Name of the figure's files, without an ending.
    pub name: String,
    /// Title.
    pub title: String,
    /// Target, and what is sought.
    pub subtitle: String,
    /// Lines below the picture.
    pub notes: Vec<String>,
    /// Field across.
    pub x: RegionAxis,
    /// Field up, which was searched.
    pub y: RegionAxis,
    /// Panels, at least one.
    pub panels: Vec<RegionPanel>,
    /// Words for the value that is marked in a panel, if one is.
    pub best: Option<String>,
}

/// Field along an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionAxis {
    /// Words and unit.
    pub label: Label,
    /// Whether the axis is logarithmic.
    pub is_log: bool,
    /// Least and largest value of the range.
    pub ends: (f64, f64),
    /// Names of values that are listed; then values count them from 0.
    pub names: Vec<String>,
}

/// Region at some values of further fields.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionPanel {
    /// The further fields; may be empty.
    pub title: String,
    /// Columns in the order of x.
    pub columns: Vec<RegionStrip>,
    /// Place of the best value, if it is here.
    pub best: Option<(f64, f64)>,
}

/// Values that meet the target at one value of x.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionStrip {
    /// The value.
    pub x: f64,
    /// Values of y that meet the target, and those that miss it, ascending; what is between them is undecided.
    pub runs: Vec<Stretch>,
}

const HEIGHT: f64 = 390.0;
/// Height of a panel where there are several.
const LOW: f64 = 270.0;
const GAP: f64 = 34.0;
/// Side of a sample in the key.
const SAMPLE: f64 = 26.0;
/// Half the width of a column that has no neighbour, pixels.
const ALONE: f64 = 24.0;

/// Draws a feasible region: what meets the target on a blue ground, what is undecided on a grey one, and the target's
/// contour, which is between them.
///
/// ```
/// use palpate_report::{RegionAxis, RegionMap, RegionPanel, RegionStrip, Stretch, region_figure};
/// use palpate_study::Label;
///
/// let axis = |column: &str| RegionAxis {
///     label: Label::of_field(column),
///     is_log: false,
///     ends: (0.0, 2.0),
///     names: Vec::new(),
/// };
/// let column = |x: f64| RegionStrip {
///     x,
///     runs: vec![
///         Stretch { from: 0.0, to: 0.5 * x, meets: true },
///         Stretch { from: 0.6 * x, to: 2.0, meets: false },
///     ],
/// };
/// let figure = region_figure(&RegionMap {
///     name: "region".to_owned(),
///     title: "Which pads, which roll?".to_owned(),
///     subtitle: "at most 5 %".to_owned(),
///     notes: Vec::new(),
///     x: axis("scene.motion.duration_s"),
///     y: axis("scene.sensor.pitch_mm"),
///     panels: vec![RegionPanel { title: String::new(), columns: [1.0, 2.0].map(column).to_vec(), best: None }],
///     best: None,
/// })?;
/// assert!(figure.svg.contains("sensor pitch (mm)") && figure.svg.contains("meets the target"));
/// # Ok::<(), palpate_report::ReportError>(())
/// ```
///
/// # Errors
/// The picture is too large.
pub fn region_figure(map: &RegionMap) -> Result<Figure, ReportError> {
    let [x, y] = [&map.x, &map.y].map(scale);
    let words = Words {
        name: map.name.clone(),
        title: map.title.clone(),
        subtitle: map.subtitle.clone(),
        notes: map.notes.clone(),
    };
    let mut frame = Frame::new(words, WIDTH);
    frame.key(SAMPLE, &key(map), sample);
    let (columns, high) = match map.panels.len() {
        0 | 1 => (1, HEIGHT),
        _ => (2, LOW),
    };
    let room = EDGE + widest(&y.ticks(6)) + TICK_GAP + 2.0;
    let wide = (WIDTH - 2.0 * EDGE - GAP * (columns - 1) as f64) / columns as f64;
    for row in map.panels.chunks(columns) {
        let titles = row.iter().any(|panel| !panel.title.is_empty());
        let y_label = (EDGE, frame.top + TEXT / 2.0 - 4.0);
        let canvas = &mut frame.canvas;
        canvas.text(&map.y.label.text(), y_label, TEXT, Anchor::Left, INK);
        let top = frame.top + LINE + 6.0 + if titles { LINE } else { 0.0 };
        let mut deepest = 1;
        for (column, panel) in row.iter().enumerate() {
            let left = column as f64 * (wide + GAP);
            let axes = Axes {
                x: &x,
                y: &y,
                corner: (left + room, top),
                size: (wide + EDGE - room - 10.0, high),
            };
            let middle = axes.corner.0 + axes.size.0 / 2.0;
            let title = (middle, top - TEXT / 2.0 - 6.0);
            canvas.text(&panel.title, title, TEXT, Anchor::Middle, INK);
            let placed = Placed { map, panel, axes };
            placed.grounds(canvas);
            deepest = deepest.max(draw_axes(&axes, canvas));
            placed.contours(canvas);
            let below = top + high + TICK_GAP + deepest as f64 * LINE + 10.0 + TEXT / 2.0 - 2.0;
            canvas.text(
                &map.x.label.text(),
                (middle, below),
                TEXT,
                Anchor::Middle,
                INK,
            );
        }
        frame.top = top + high + TICK_GAP + deepest as f64 * LINE + 10.0 + 1.6 * LINE;
    }
    frame.finish()
}

fn scale(axis: &RegionAxis) -> Scale {
    if !axis.names.is_empty() {
        return Scale::of_categories(axis.names.clone());
    }
    let ends = [axis.ends.0, axis.ends.1].map(|end| end * axis.label.factor);
    let is_positive = ends.iter().all(|end| *end > 0.0);
    let spacing = match axis.is_log && is_positive {
        true => Spacing::Log,
        false => Spacing::Linear,
    };
    Scale::around(spacing, ends.into_iter())
}

/// Sample before an entry of the key.
enum Sample {
    Ground(Colour),
    Contour,
    Best,
}

fn key(map: &RegionMap) -> Vec<(Sample, String)> {
    let mut key = vec![
        (Sample::Ground(MEETS), "meets the target".to_owned()),
        (Sample::Ground(MISSES), "misses it".to_owned()),
        (Sample::Ground(OPEN), "undecided".to_owned()),
        (Sample::Contour, "just meets it".to_owned()),
    ];
    key.extend(map.best.iter().map(|words| (Sample::Best, words.clone())));
    key
}

fn sample(canvas: &mut Canvas, (x, y): Point, sample: &Sample) {
    match sample {
        Sample::Ground(colour) => {
            let (top, bottom) = (y - 0.35 * SAMPLE, y + 0.35 * SAMPLE);
            let right = x + SAMPLE;
            canvas.polygon(
                &[(x, top), (right, top), (right, bottom), (x, bottom)],
                *colour,
            );
            outline(canvas, (x, top), (SAMPLE, 0.7 * SAMPLE));
        }
        Sample::Contour => {
            canvas.line(&[(x, y), (x + SAMPLE, y)], INK, STROKE);
            canvas.marker(Marker::Circle, (x + SAMPLE / 2.0, y), 0.7 * MARKER, INK);
        }
        Sample::Best => best(canvas, (x + SAMPLE / 2.0, y)),
    }
}

fn best(canvas: &mut Canvas, place: Point) {
    canvas.marker(Marker::Diamond, place, 1.9 * MARKER, INK);
    canvas.marker(Marker::Diamond, place, 1.2 * MARKER, WHITE);
}

/// Panel in its place.
struct Placed<'a> {
    map: &'a RegionMap,
    panel: &'a RegionPanel,
    axes: Axes<'a>,
}

impl Placed<'_> {
    fn across(&self, x: f64) -> f64 {
        let factor = match self.map.x.names.is_empty() {
            true => self.map.x.label.factor,
            false => 1.0,
        };
        self.axes.across(x * factor)
    }

    fn down(&self, y: f64) -> f64 {
        let factor = match self.map.y.names.is_empty() {
            true => self.map.y.label.factor,
            false => 1.0,
        };
        self.axes.down(y * factor)
    }

    /// Lower and upper edge of values of y.
    fn edges(&self, from: f64, to: f64) -> (f64, f64) {
        let half = if self.map.y.names.is_empty() {
            0.0
        } else {
            0.5
        };
        (self.down(from - half), self.down(to + half))
    }

    /// Whether the curve between two columns is known well enough to be drawn as one.
    fn are_alike(&self, one: &RegionStrip, other: &RegionStrip) -> bool {
        let sides =
            |strip: &RegionStrip| strip.runs.iter().map(|run| run.meets).collect::<Vec<_>>();
        self.map.x.names.is_empty() && self.map.y.names.is_empty() && sides(one) == sides(other)
    }

    fn grounds(&self, canvas: &mut Canvas) {
        let strips = &self.panel.columns;
        let xs: Vec<f64> = strips.iter().map(|strip| self.across(strip.x)).collect();
        let (first, last) = match self.map.y.names.len() {
            0 => self.map.y.ends,
            count => (0.0, count as f64 - 1.0),
        };
        let colour = |meets: bool| if meets { MEETS } else { MISSES };
        let mut strip = |strip: &RegionStrip, left: f64, right: f64| {
            let mut ground = |(from, to): (f64, f64), colour: Colour| {
                let (mut low, mut high) = self.edges(from, to);
                // A single value is seen, too.
                if low - high < 2.0 {
                    (low, high) = (low + 1.0, high - 1.0);
                }
                canvas.polygon(
                    &[(left, low), (right, low), (right, high), (left, high)],
                    colour,
                );
            };
            ground((first, last), OPEN);
            for run in &strip.runs {
                ground((run.from, run.to), colour(run.meets));
            }
        };
        for (place, one) in strips.iter().enumerate() {
            let x = xs[place];
            let is_joined =
                |other: Option<&RegionStrip>| other.is_some_and(|other| self.are_alike(one, other));
            let middle = |other: Option<&f64>| other.map(|other| 0.5 * (x + other));
            let before = place.checked_sub(1);
            let left = middle(before.and_then(|before| xs.get(before)));
            let right = middle(xs.get(place + 1));
            let alone = ALONE.min(
                [left.map(|left| x - left), right.map(|right| right - x)]
                    .into_iter()
                    .flatten()
                    .fold(f64::INFINITY, f64::min),
            );
            let is_named = !self.map.x.names.is_empty();
            let edge = |side: Option<f64>, sign: f64| match side {
                Some(side) if !is_named => side,
                Some(_) | None if is_named || strips.len() == 1 => x + sign * alone,
                _ => x,
            };
            let (from, to) = (
                if is_joined(before.and_then(|before| strips.get(before))) {
                    x
                } else {
                    edge(left, -1.0)
                },
                if is_joined(strips.get(place + 1)) {
                    x
                } else {
                    edge(right, 1.0)
                },
            );
            if to > from {
                strip(one, from, to);
            }
        }
        for (pair, x) in strips.windows(2).zip(xs.windows(2)) {
            let [one, other] = pair else { continue };
            if !self.are_alike(one, other) {
                continue;
            }
            let mut ground = |one: (f64, f64), other: (f64, f64), colour: Colour| {
                let ((low, high), (next_low, next_high)) =
                    (self.edges(one.0, one.1), self.edges(other.0, other.1));
                canvas.polygon(
                    &[
                        (x[0], low),
                        (x[1], next_low),
                        (x[1], next_high),
                        (x[0], high),
                    ],
                    colour,
                );
            };
            ground((first, last), (first, last), OPEN);
            for (one, other) in one.runs.iter().zip(&other.runs) {
                ground(
                    (one.from, one.to),
                    (other.from, other.to),
                    colour(one.meets),
                );
            }
        }
    }

    /// Lines between crossings of neighbours, and at each a bar over what is undecided.
    fn contours(&self, canvas: &mut Canvas) {
        let is_named = !self.map.y.names.is_empty();
        let crossings = |strip: &RegionStrip| -> Vec<(f64, f64)> {
            let pairs = strip.runs.windows(2);
            pairs
                .filter(|pair| !is_named && pair[0].meets != pair[1].meets)
                .map(|pair| (self.down(pair[0].to), self.down(pair[1].from)))
                .collect()
        };
        let strips = &self.panel.columns;
        let middle = |(low, high): (f64, f64)| 0.5 * (low + high);
        for pair in strips
            .windows(2)
            .filter(|pair| self.are_alike(&pair[0], &pair[1]))
        {
            let ends = pair
                .iter()
                .map(|strip| (self.across(strip.x), crossings(strip)));
            let ends: Vec<(f64, Vec<(f64, f64)>)> = ends.collect();
            for (one, other) in ends[0].1.iter().zip(&ends[1].1) {
                let line = [(ends[0].0, middle(*one)), (ends[1].0, middle(*other))];
                canvas.line(&line, INK, STROKE);
            }
        }
        for strip in strips {
            let x = self.across(strip.x);
            for (low, high) in crossings(strip) {
                if low - high > 2.0 * MARKER {
                    bar(canvas, x, [low, high], [true; 2], INK);
                }
                canvas.marker(Marker::Circle, (x, middle((low, high))), 0.7 * MARKER, INK);
            }
        }
        if let Some((x, y)) = self.panel.best {
            best(canvas, (self.across(x), self.down(y)));
        }
    }
}
