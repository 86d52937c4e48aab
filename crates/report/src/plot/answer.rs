//! The answer of a design: a statistic over a field, its limit, and the values that keep it.

use super::canvas::{Anchor, Canvas};
use super::figure::Figure;
use super::frame::{Axes, EDGE, Frame, LINE, TEXT, TICK_GAP, WIDTH, Words, widest};
use super::lettering::{width, wrap};
use super::scale::{Scale, Spacing};
use super::style::{Colour, FAINT, GRID, INK, MARKER, STROKE, Style, WHITE};
use super::uncertainty::normal;
use crate::ReportError;
use palpate_study::Label;

/// Answer of a design, as it is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct AnswerCurve {
    /// Name of the figure's files, without an ending.
    pub name: String,
    /// Title.
    pub title: String,
    /// Line below the title, on the target.
    pub subtitle: String,
    /// Lines below the picture.
    pub notes: Vec<String>,
    /// Words and unit of the field.
    pub x: Label,
    /// Whether the field is on a logarithmic axis.
    pub is_log: bool,
    /// Names of values that are no numbers; then x counts them from 0.
    pub names: Vec<String>,
    /// Words and unit of the statistic.
    pub y: Label,
    /// Limit of the statistic.
    pub limit: f64,
    /// Text beside the line of the limit.
    pub limit_label: String,
    /// The statistic in each of some cells.
    pub lines: Vec<CurveLine>,
    /// Values that meet the target, and those that miss it, ascending; what is between them is undecided.
    pub runs: Vec<Stretch>,
}

/// Statistic in a cell over the field.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveLine {
    /// Name of the cell; empty where it is the only one.
    pub label: String,
    /// Points in the order of x.
    pub points: Vec<CurvePoint>,
}

/// Value of a statistic, in the unit of the tables.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint {
    /// Value of the field.
    pub x: f64,
    /// Value of the statistic.
    pub y: f64,
    /// Its standard error.
    pub std: f64,
    /// Whether so many trials failed that it is of the others alone.
    pub is_of_survivors: bool,
}

/// Values from one to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// Least of them.
    pub from: f64,
    /// Largest of them.
    pub to: f64,
    /// Whether they meet the target, rather than miss it.
    pub meets: bool,
}

/// Ground of values that meet the target, and of those that are undecided: blue and grey, of different lightness.
pub(crate) const MEETS: Colour = Colour(190, 220, 242);
pub(crate) const OPEN: Colour = Colour(226, 226, 226);
/// Outline of what misses it in a key.
pub(crate) const MISSES: Colour = WHITE;
const HEIGHT: f64 = 390.0;
/// Side of a sample of a ground in the key.
const SAMPLE: f64 = 26.0;
/// Ratio of values above which the statistic is on a logarithmic axis.
const FAR: f64 = 8.0;

/// Draws the answer of a design: the statistic with 95 % bars, the limit as a dashed line, and the values that meet the
/// target on a blue ground, those that are undecided on a grey one.
///
/// ```
/// use palpate_report::{AnswerCurve, CurveLine, CurvePoint, Stretch, answer_figure};
/// use palpate_study::Label;
///
/// let point = |x: f64| CurvePoint { x, y: 0.1 * x, std: 0.001, is_of_survivors: false };
/// let figure = answer_figure(&AnswerCurve {
///     name: "answer".to_owned(),
///     title: "Which pads?".to_owned(),
///     subtitle: "at most 5 %".to_owned(),
///     notes: Vec::new(),
///     x: Label::of_field("scene.sensor.pitch_mm"),
///     is_log: true,
///     names: Vec::new(),
///     y: Label::in_percent("rms relative error", "%"),
///     limit: 0.05,
///     limit_label: "5 %".to_owned(),
///     lines: vec![CurveLine { label: String::new(), points: [0.1, 0.2, 0.5, 1.0].map(point).to_vec() }],
///     runs: vec![Stretch { from: 0.1, to: 0.48, meets: true }, Stretch { from: 0.52, to: 1.0, meets: false }],
/// })?;
/// assert!(figure.svg.contains("sensor pitch (mm)") && figure.svg.contains("undecided"));
/// # Ok::<(), palpate_report::ReportError>(())
/// ```
///
/// # Errors
/// The picture is too large.
pub fn answer_figure(curve: &AnswerCurve) -> Result<Figure, ReportError> {
    let shown = Shown::of(curve);
    let words = Words {
        name: curve.name.clone(),
        title: curve.title.clone(),
        subtitle: curve.subtitle.clone(),
        notes: curve.notes.clone(),
    };
    let y_ticks = shown.y.ticks(6);
    let left = EDGE + widest(&y_ticks) + TICK_GAP + 2.0;
    let mut frame = Frame::new(words, WIDTH);
    frame.key(SAMPLE, &key(curve), |canvas, (x, y), sample| match sample {
        Sample::Ground(colour) => {
            let (top, bottom) = (y - 0.35 * SAMPLE, y + 0.35 * SAMPLE);
            let corners = [
                (x, top),
                (x + SAMPLE, top),
                (x + SAMPLE, bottom),
                (x, bottom),
            ];
            canvas.polygon(&corners, *colour);
            super::frame::outline(canvas, (x, top), (SAMPLE, 0.7 * SAMPLE));
        }
        Sample::Line(style) => {
            canvas.line(&[(x, y), (x + SAMPLE, y)], style.colour, STROKE);
            canvas.marker(style.marker, (x + SAMPLE / 2.0, y), MARKER, style.colour);
        }
        Sample::Limit => canvas.dashes(&[(x, y), (x + SAMPLE, y)], INK, 2.0),
    });
    let top = frame.top + LINE + 6.0;
    let axes = Axes {
        x: &shown.x,
        y: &shown.y,
        corner: (left, top),
        size: (WIDTH - left - EDGE - 10.0, HEIGHT),
    };
    let y_label = (EDGE, frame.top + TEXT / 2.0 - 4.0);
    let canvas = &mut frame.canvas;
    canvas.text(&curve.y.text(), y_label, TEXT, Anchor::Left, INK);
    shown.grounds(curve, &axes, canvas);
    let lines = draw_axes(&axes, canvas);
    for (number, line) in curve.lines.iter().enumerate() {
        shown.line(line, Style::of(number), &axes, canvas);
    }
    let bottom = top + HEIGHT + TICK_GAP + lines as f64 * LINE + 10.0;
    let middle = (axes.corner.0 + axes.size.0 / 2.0, bottom + TEXT / 2.0 - 2.0);
    canvas.text(&curve.x.text(), middle, TEXT, Anchor::Middle, INK);
    frame.top = bottom + LINE;
    frame.finish()
}

/// Grid, ticks and outline; gives the number of lines of the labels below.
pub(crate) fn draw_axes(axes: &Axes<'_>, canvas: &mut Canvas) -> usize {
    let (x_ticks, y_ticks) = (axes.x.ticks(6), axes.y.ticks(6));
    axes.rule(canvas, axes.x.minor(6), axes.y.minor(6), FAINT);
    let places =
        |ticks: &[super::scale::Tick]| ticks.iter().map(|tick| tick.at).collect::<Vec<_>>();
    axes.rule(canvas, places(&x_ticks), places(&y_ticks), GRID);
    axes.outline(canvas);
    let room = axes.size.0 / x_ticks.len().max(1) as f64 - 12.0;
    let labels: Vec<Vec<String>> = x_ticks
        .iter()
        .map(|tick| wrap(&tick.label, TEXT, room))
        .collect();
    for (tick, lines) in x_ticks.iter().zip(&labels) {
        axes.label_x(canvas, tick.at, lines);
    }
    y_ticks.iter().for_each(|tick| axes.label_y(canvas, tick));
    labels.iter().map(Vec::len).max().unwrap_or(1)
}

/// Sample before an entry of the key.
enum Sample {
    Ground(Colour),
    Line(Style),
    Limit,
}

fn key(curve: &AnswerCurve) -> Vec<(Sample, String)> {
    let mut key = vec![(Sample::Limit, format!("limit, {}", curve.limit_label))];
    if curve.runs.iter().any(|run| run.meets) {
        key.push((Sample::Ground(MEETS), "meets the target".to_owned()));
    }
    if curve.runs.iter().any(|run| !run.meets) {
        key.push((Sample::Ground(MISSES), "misses it".to_owned()));
    }
    if !undecided(curve).is_empty() {
        key.push((Sample::Ground(OPEN), "undecided".to_owned()));
    }
    let named = curve
        .lines
        .iter()
        .enumerate()
        .filter(|(_, line)| !line.label.is_empty());
    key.extend(named.map(|(number, line)| (Sample::Line(Style::of(number)), line.label.clone())));
    key
}

/// Values between the runs, and at the ends.
fn undecided(curve: &AnswerCurve) -> Vec<(f64, f64)> {
    let points = curve.lines.iter().flat_map(|line| &line.points);
    let xs = points.map(|point| point.x);
    let ends = curve.runs.iter().flat_map(|run| [run.from, run.to]);
    let (mut first, mut last) = (f64::INFINITY, f64::NEG_INFINITY);
    for x in xs.chain(ends) {
        (first, last) = (first.min(x), last.max(x));
    }
    if !curve.names.is_empty() {
        let count = curve.names.len();
        let is_open = |place: &usize| {
            let place = *place as f64;
            !curve
                .runs
                .iter()
                .any(|run| (run.from..=run.to).contains(&place))
        };
        return (0..count)
            .filter(is_open)
            .map(|place| (place as f64, place as f64))
            .collect();
    }
    let mut open = Vec::new();
    let mut end = first;
    for run in &curve.runs {
        if run.from > end {
            open.push((end, run.from));
        }
        end = end.max(run.to);
    }
    if last > end || curve.runs.is_empty() && last >= first {
        open.push((end, last));
    }
    open
}

/// Scales of a figure, in the units shown.
struct Shown {
    x: Scale,
    y: Scale,
    factors: (f64, f64),
    is_log: (bool, bool),
    is_named: bool,
}

impl Shown {
    fn of(curve: &AnswerCurve) -> Self {
        let is_named = !curve.names.is_empty();
        let factors = (if is_named { 1.0 } else { curve.x.factor }, curve.y.factor);
        let points = || curve.lines.iter().flat_map(|line| &line.points);
        let values = || points().map(|point| point.y).chain([curve.limit]);
        let least = values().fold(f64::INFINITY, f64::min);
        let most = values().fold(f64::NEG_INFINITY, f64::max);
        let is_log = (curve.is_log && !is_named, least > 0.0 && most / least > FAR);
        let spacing = |is_log: bool| {
            if is_log {
                Spacing::Log
            } else {
                Spacing::Linear
            }
        };
        let bars = points().flat_map(|point| {
            let [low, high] = normal(point.y, point.std);
            [low, point.y, high]
        });
        let places = |factor: f64, is_log: bool| {
            let spacing = spacing(is_log);
            move |value: &f64| spacing.refusal(value * factor).is_none()
        };
        let ys = bars
            .chain([curve.limit])
            .filter(places(factors.1, is_log.1));
        // A bar that reaches far below all points on a log axis does not stretch it.
        let ys = ys.filter(|y| !is_log.1 || *y >= 0.5 * least);
        let y = Scale::around(spacing(is_log.1), ys.map(|y| y * factors.1));
        let runs = curve.runs.iter().flat_map(|run| [run.from, run.to]);
        let xs = points().map(|point| point.x).chain(runs);
        let xs = xs
            .filter(places(factors.0, is_log.0))
            .map(|x| x * factors.0);
        let x = match is_named {
            true => Scale::of_categories(curve.names.clone()),
            false => Scale::around(spacing(is_log.0), xs),
        };
        Self {
            x,
            y,
            factors,
            is_log,
            is_named,
        }
    }

    /// Grounds of the values that meet the target and of those that are undecided, and the line of the limit.
    fn grounds(&self, curve: &AnswerCurve, axes: &Axes<'_>, canvas: &mut Canvas) {
        let (left, right, top, bottom) = axes.edges();
        let half = if self.is_named { 0.5 } else { 0.0 };
        let mut ground = |(from, to): (f64, f64), colour: Colour| {
            let across = |x: f64| axes.across(x * self.factors.0).clamp(left, right);
            let (mut from, mut to) = (across(from - half), across(to + half));
            // A single value is seen, too.
            if to - from < 2.0 {
                (from, to) = ((from - 2.0).max(left), (to + 2.0).min(right));
            }
            canvas.polygon(
                &[(from, top), (to, top), (to, bottom), (from, bottom)],
                colour,
            );
        };
        for stretch in undecided(curve) {
            ground(stretch, OPEN);
        }
        for run in curve.runs.iter().filter(|run| run.meets) {
            ground((run.from, run.to), MEETS);
        }
        let limit = curve.limit * self.factors.1;
        let spacing = if self.is_log.1 {
            Spacing::Log
        } else {
            Spacing::Linear
        };
        if spacing.refusal(limit).is_some() {
            return;
        }
        let y = axes.down(limit);
        canvas.dashes(&[(left, y), (right, y)], INK, 2.0);
        let wide = width(&curve.limit_label, TEXT);
        let place = (
            right - 8.0 - wide,
            if y - top > 2.0 * TEXT {
                y - 0.7 * TEXT
            } else {
                y + 0.8 * TEXT
            },
        );
        canvas.text(&curve.limit_label, place, TEXT, Anchor::Left, INK);
    }

    /// Bars, the line and its markers; circles around those of survivors.
    fn line(&self, line: &CurveLine, style: Style, axes: &Axes<'_>, canvas: &mut Canvas) {
        let [x_spacing, y_spacing] = [self.is_log.0, self.is_log.1].map(|is_log| {
            if is_log {
                Spacing::Log
            } else {
                Spacing::Linear
            }
        });
        let drawn = line.points.iter().filter(|point| {
            x_spacing.refusal(point.x * self.factors.0).is_none()
                && y_spacing.refusal(point.y * self.factors.1).is_none()
        });
        let drawn: Vec<&CurvePoint> = drawn.collect();
        let (_, _, top, bottom) = axes.edges();
        let down = |y: f64| match y_spacing.refusal(y * self.factors.1) {
            None => axes.down(y * self.factors.1).clamp(top, bottom),
            Some(_) => bottom,
        };
        let place = |point: &CurvePoint| (axes.across(point.x * self.factors.0), down(point.y));
        for point in &drawn {
            let ends =
                normal(point.y, point.std).map(|end| y_spacing.nearest(end * self.factors.1));
            axes.bar(canvas, point.x * self.factors.0, ends, 1.0, style.colour);
        }
        let places: Vec<_> = drawn.iter().map(|point| place(point)).collect();
        if places.len() > 1 && !self.is_named {
            canvas.line(&places, style.colour, STROKE);
        }
        for (point, place) in drawn.iter().zip(&places) {
            let size = if drawn.len() > 25 {
                0.6 * MARKER
            } else {
                0.8 * MARKER
            };
            if point.is_of_survivors {
                canvas.disc(*place, 1.7 * size + 1.5, INK);
                canvas.disc(*place, 1.7 * size, WHITE);
            }
            canvas.marker(style.marker, *place, size, style.colour);
        }
    }
}
