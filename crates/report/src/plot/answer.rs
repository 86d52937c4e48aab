//! Figure of the answer of `palpate design`: a statistic over a field, its limit, and the values that meet it.

use super::drawing::Figure;
use super::scale::{Scale, Spacing};
use super::series::{self, Content, Line, Mark, Plot};
use super::sheet::{Key, MARKER, STROKE, Sample, Words};
use super::style::{Colour, INK, Style, WHITE};
use super::symbol::Symbol;
use super::uncertainty::normal;
use crate::ReportError;
use palpate_study::Label;
use plotters::coord::ranged1d::Ranged;
use plotters::style::Color;
use std::ops::Range;

/// Answer of a design to draw.
#[derive(Debug, Clone, PartialEq)]
pub struct AnswerCurve {
    /// Name of the figure's files, without extension.
    pub name: String,
    /// Title.
    pub title: String,
    /// Line below the title, about the target.
    pub subtitle: String,
    /// Lines below the picture.
    pub notes: Vec<String>,
    /// Label and unit of the field.
    pub x: Label,
    /// Whether the field is on a logarithmic axis.
    pub is_log: bool,
    /// Names of values that are not numbers; then x is an index into them.
    pub names: Vec<String>,
    /// Label and unit of the statistic.
    pub y: Label,
    /// Limit of the statistic.
    pub limit: f64,
    /// Text beside the line of the limit.
    pub limit_label: String,
    /// The statistic in each cell.
    pub lines: Vec<CurveLine>,
    /// Ranges of values that meet or miss the target, ascending; values between them are undecided.
    pub runs: Vec<Stretch>,
}

/// Statistic of a cell over the field.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveLine {
    /// Name of the cell; empty if it is the only one.
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
    /// Whether the value represents only the successful trials, because too many trials failed.
    pub is_of_survivors: bool,
}

/// Range of values on one side of the target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// Lower end.
    pub from: f64,
    /// Upper end.
    pub to: f64,
    /// Whether the values meet the target; otherwise they miss it.
    pub meets: bool,
}

/// Background of values that meet the target (blue) and of undecided values (grey, with another lightness).
pub(crate) const MEETS: Colour = Colour(190, 220, 242);
pub(crate) const OPEN: Colour = Colour(226, 226, 226);
/// Background of values that miss the target.
pub(crate) const MISSES: Colour = WHITE;
/// Width of the limit line.
const LIMIT: u32 = 6;
/// Share of the panel's width by which a single value is widened to each side, so that it is visible.
const HALF_WIDTH: f64 = 0.003;
/// Ratio of the values above which the axis of the statistic is logarithmic.
const MIN_LOG_RATIO: f64 = 8.0;

/// Draws the answer of a design: the statistic with 95 % bars, the limit as a dashed line, a blue background where values
/// meet the target, and a grey one where they are undecided.
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
    let axes = Axes::of(curve);
    let words = Words::new(&curve.name, &curve.title, &curve.subtitle, &curve.notes);
    let limit = curve.limit * axes.factors[1];
    let limit = axes.spacing[1].refusal(limit).is_none().then(|| Mark {
        on_x: false,
        at: limit,
        label: curve.limit_label.clone(),
        style: INK.stroke_width(LIMIT),
    });
    let lines = curve.lines.iter().enumerate();
    let content = Content {
        grounds: axes.grounds(curve),
        lines: lines
            .map(|(at, line)| axes.line(line, Style::of(at)))
            .collect(),
        ..Content::default()
    };
    let labels = [curve.x.text(), curve.y.text()];
    let plot = Plot {
        key: key(curve),
        marks: limit.into_iter().collect(),
        marker: 0.8 * MARKER,
        ..Plot::new(labels, [axes.x, axes.y], vec![content])
    };
    series::figure(words, vec![plot])
}

fn key(curve: &AnswerCurve) -> Key {
    let mut key = vec![(
        Sample::dashed(INK.stroke_width(LIMIT)),
        format!("limit, {}", curve.limit_label),
    )];
    let is_there = |meets: bool| curve.runs.iter().any(|run| run.meets == meets);
    let grounds = [
        (is_there(true), MEETS, "meets the target"),
        (is_there(false), MISSES, "misses it"),
        (!undecided(curve).is_empty(), OPEN, "undecided"),
    ];
    let grounds = grounds.into_iter().filter(|(is_there, ..)| *is_there);
    key.extend(grounds.map(|(_, colour, words)| (Sample::ground(colour), words.to_owned())));
    let named = curve.lines.iter().enumerate();
    key.extend(
        named
            .filter(|(_, line)| !line.label.is_empty())
            .map(|(at, line)| {
                let style = Style::of(at);
                let sample = Sample::line(style.colour.stroke_width(STROKE));
                (sample.with(Symbol::new(style, MARKER)), line.label.clone())
            }),
    );
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

/// Scales of the figure, in displayed units.
struct Axes {
    x: Scale,
    y: Scale,
    factors: [f64; 2],
    spacing: [Spacing; 2],
    is_named: bool,
}

impl Axes {
    fn of(curve: &AnswerCurve) -> Self {
        let is_named = !curve.names.is_empty();
        let factors = [if is_named { 1.0 } else { curve.x.factor }, curve.y.factor];
        let points = || curve.lines.iter().flat_map(|line| &line.points);
        let values = || points().map(|point| point.y).chain([curve.limit]);
        let least = values().fold(f64::INFINITY, f64::min);
        let most = values().fold(f64::NEG_INFINITY, f64::max);
        let is_log = least > 0.0 && most / least > MIN_LOG_RATIO;
        let spacing = [curve.is_log && !is_named, is_log].map(Spacing::log);
        let scale = |axis: usize, values: &mut dyn Iterator<Item = f64>| {
            let places = values.map(|value| value * factors[axis]);
            let places = places.filter(|place| spacing[axis].refusal(*place).is_none());
            Scale::around(spacing[axis], places)
        };
        let bars = points().flat_map(|point| {
            let [low, high] = normal(point.y, point.std);
            [low, point.y, high]
        });
        // A log axis is not extended for bars that end far below all points.
        let ys = bars
            .chain([curve.limit])
            .filter(|y| !is_log || *y >= 0.5 * least);
        let runs = curve.runs.iter().flat_map(|run| [run.from, run.to]);
        Self {
            x: match is_named {
                true => Scale::of_names(curve.names.clone()),
                false => scale(0, &mut points().map(|point| point.x).chain(runs)),
            },
            y: scale(1, &mut ys.into_iter()),
            factors,
            spacing,
            is_named,
        }
    }

    /// Background areas of the undecided values, and of the values that meet the target.
    fn grounds(&self, curve: &AnswerCurve) -> Vec<(Vec<(f64, f64)>, Colour)> {
        let half = if self.is_named { 0.5 } else { 0.0 };
        let Range { start, end } = self.y.range();
        let ground = |(from, to): (f64, f64), colour: Colour| {
            let place = |x: f64| self.x.place(x * self.factors[0]);
            let (from, to) = (place(from - half), place(to + half));
            let wider = if to - from < HALF_WIDTH {
                HALF_WIDTH
            } else {
                0.0
            };
            let [left, right] =
                [from - wider, to + wider].map(|at| self.x.value(at.clamp(0.0, 1.0)));
            let corners = vec![(left, start), (right, start), (right, end), (left, end)];
            (corners, colour)
        };
        let open = undecided(curve).into_iter().map(|run| ground(run, OPEN));
        let meets = curve.runs.iter().filter(|run| run.meets);
        open.chain(meets.map(|run| ground((run.from, run.to), MEETS)))
            .collect()
    }

    /// The points with their error bars. A line joins the points unless the values of x are names.
    fn line(&self, line: &CurveLine, style: Style) -> Line {
        let [x_factor, y_factor] = self.factors;
        let place = |point: &CurvePoint| (point.x * x_factor, point.y * y_factor);
        let is_drawn = |point: &&CurvePoint| {
            let (x, y) = place(point);
            self.spacing[0].refusal(x).is_none() && self.spacing[1].refusal(y).is_none()
        };
        let drawn: Vec<&CurvePoint> = line.points.iter().filter(is_drawn).collect();
        let places: Vec<(f64, f64)> = drawn.iter().map(|point| place(point)).collect();
        let survivors = drawn.iter().filter(|point| point.is_of_survivors);
        let bars = drawn.iter().map(|point| {
            let ends = normal(point.y, point.std);
            (
                point.x * x_factor,
                ends.map(|end| self.spacing[1].nearest(end * y_factor)),
            )
        });
        let runs = match self.is_named {
            true => places.into_iter().map(|place| vec![place]).collect(),
            false => vec![places],
        };
        Line {
            circled: survivors.map(|point| place(point)).collect(),
            bars: bars.collect(),
            ..Line::new(style, false, runs)
        }
    }
}
