//! Figures of answers. The figure of `palpate design` shows the values of the searched field that meet the target. If
//! only one field is varied, the target's statistic is plotted over this field. If several fields are varied, the
//! searched field is plotted over another field.

use super::drawing::Figure;
use super::heat::HeatPanel;
use super::scale::{Scale, Spacing};
use super::series::{self, Content, Line, Mark, Plot, PointSet};
use super::sheet::{Key, MARKER, STROKE, Sample, Words};
use super::style::{Colour, INK, Marker, Style, WHITE};
use super::symbol::Symbol;
use super::uncertainty::normal;
use super::{bars, heat};
use crate::ReportError;
use palpate_study::Label;
use plotters::style::Color;

/// Figure of an answer, in the form that [`answer_figure`] draws.
#[derive(Debug, Clone, PartialEq)]
pub struct AnswerFigure {
    /// Name of the figure's files, without extension.
    pub name: String,
    /// Title of the figure.
    pub title: String,
    /// Line of text below the title, which explains what the figure shows.
    pub subtitle: String,
    /// Lines of text below the image.
    pub notes: Vec<String>,
    /// The image.
    pub chart: AnswerChart,
}

/// Axis that shows the values of a field.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldAxis {
    /// Label of the axis: name and unit of the field.
    pub label: Label,
    /// Whether the axis is logarithmic.
    pub is_log: bool,
    /// Ends of the axis: smallest and largest value of the field's range.
    pub ends: (f64, f64),
    /// Names of the field's values, if the field has a list of values; empty if it has a range. If there are names, a
    /// value on the axis is an index into this list.
    pub names: Vec<String>,
}

/// The image in the figure of an answer.
#[derive(Debug, Clone, PartialEq)]
pub enum AnswerChart {
    /// Horizontal bar from 0 to each number, with its 95 % interval as a line. The first bar is at the top.
    Bars {
        /// Label of the horizontal axis, along which the numbers are drawn as bars.
        axis: String,
        /// Name, number and standard error of each item. The number is the length of the item's bar.
        bars: Vec<(String, f64, f64)>,
    },
    /// Heat map: each pair of items is a square. The larger the share of the pair, the darker is its square. If there
    /// are few items, each square also contains the share in percent.
    Heat {
        /// Label of the horizontal and the vertical axis: the field whose values name the items.
        axis: String,
        /// The panels of the heat map.
        panels: Vec<HeatPanel>,
    },
    /// Answer of `palpate design` with one varied field: the target's statistic over the searched field, with 95 %
    /// intervals, and the limit as a dashed line. The background is blue at values of the searched field that meet the
    /// target, and white at values that miss it. It is grey where neither is certain.
    Curve {
        /// Axis of the searched field.
        searched: FieldAxis,
        /// Label of the target's statistic, with its unit.
        statistic: Label,
        /// Limit of the target's statistic, and the label of the line that shows the limit.
        limit: (f64, String),
        /// One line per cell of the study, which shows the target's statistic of this cell.
        lines: Vec<CurveLine>,
        /// Ranges of values of the searched field that meet the target, and ranges of values that miss it, in ascending
        /// order. Values between these ranges are undecided.
        runs: Vec<Stretch>,
    },
    /// Answer of `palpate design` with several varied fields: the searched field over another field. The background has
    /// the same colours as in [`Self::Curve`], and a contour connects the values at which the target is just met.
    Map {
        /// Axis of the searched field.
        searched: FieldAxis,
        /// Axis of the other varied field.
        other: FieldAxis,
        /// Panels of the map. There is at least one panel.
        panels: Vec<MapPanel>,
        /// Label of the point with the best value of the searched field; `None` if no point is marked.
        best: Option<String>,
    },
}

/// The target's statistic of one cell of the study over the searched field.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveLine {
    /// Name of the study's cell to which the line belongs; empty if there is only one cell.
    pub label: String,
    /// Points of the line, sorted by x.
    pub points: Vec<CurvePoint>,
}

/// Value of the target's statistic at one value of the searched field. Both values are in the units of the tables.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint {
    /// Value of the searched field.
    pub x: f64,
    /// Value of the target's statistic.
    pub y: f64,
    /// Standard error of the target's statistic.
    pub std: f64,
    /// Whether too many trials failed. The statistic then describes only the successful trials.
    pub is_of_survivors: bool,
}

/// Map of the searched field over one other field. All further varied fields have fixed values in the panel.
#[derive(Debug, Clone, PartialEq)]
pub struct MapPanel {
    /// Text with the panel's values of the further varied fields; may be empty.
    pub title: String,
    /// Each value of the other field, in ascending order, with the ranges of the searched field that meet or miss the
    /// target at this value.
    pub columns: Vec<(f64, Vec<Stretch>)>,
    /// Point with the best value of the searched field: first the value of the other field, then the best value. `None`
    /// if the best value belongs to another panel, or if there is none.
    pub best: Option<(f64, f64)>,
}

/// A range of values that all meet the target, or all miss it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// Smallest value of the searched field in the range.
    pub from: f64,
    /// Largest value of the searched field in the range.
    pub to: f64,
    /// Whether the values meet the target (true) or miss it.
    pub meets: bool,
}

const MEETS: Colour = Colour(190, 220, 242);
/// Background colour where it is undecided whether values meet the target. This grey is darker than the white of values
/// that miss the target, and lighter than the blue of values that meet it. So readers can distinguish the three colours
/// even in a grey print.
const OPEN: Colour = Colour(226, 226, 226);
const MISSES: Colour = WHITE;
/// Width of the line that shows the target's limit, in drawing units (1/3 px).
const LIMIT: u32 = 6;
/// Marker of the values of the searched field at which the target is just met.
const CROSSING: Style = Style::new(INK, Marker::Circle);
const BEST: Style = Style::new(INK, Marker::Diamond);
const BEST_SIZE: f64 = 36.0;
/// Half the width of the background area of a single tested value, relative to the width of the panel. An area without
/// width would not be visible.
const HALF_WIDTH: f64 = 0.003;
/// Half the width, relative to the width of the panel, of the background area at one value of the field that is plotted
/// beside the searched field. It is used if this other field has only one value, or if its values are names.
const ALONE: f64 = 0.03;
/// The axis of the statistic is logarithmic if the ratio of its largest to its smallest value exceeds this number.
const MIN_LOG_RATIO: f64 = 8.0;

/// Draws the figure of an answer.
///
/// ```
/// use palpate_report::{
///     AnswerChart, AnswerFigure, CurveLine, CurvePoint, FieldAxis, HeatPanel, MapPanel, Stretch, answer_figure,
/// };
/// use palpate_study::Label;
///
/// let bars = vec![("noise".to_owned(), 1.0, 0.1), ("roll length".to_owned(), -0.9, 0.1)];
/// let heat = HeatPanel {
///     title: String::new(),
///     names: vec!["20 mm".to_owned(), "25 mm".to_owned()],
///     shares: vec![vec![None, Some(0.84)], vec![Some(0.84), None]],
/// };
/// let axis = |column: &str| FieldAxis {
///     label: Label::of_field(column),
///     is_log: false,
///     ends: (0.1, 1.0),
///     names: Vec::new(),
/// };
/// let runs = |limit: f64| vec![
///     Stretch { from: 0.1, to: 0.48 * limit, meets: true },
///     Stretch { from: 0.52 * limit, to: 1.0, meets: false },
/// ];
/// let point = |x: f64| CurvePoint { x, y: 0.1 * x, std: 0.001, is_of_survivors: false };
/// let curve = AnswerChart::Curve {
///     searched: axis("scene.sensor.pitch_mm"),
///     statistic: Label { words: "rms relative error".to_owned(), unit: "%".to_owned(), factor: 100.0 },
///     limit: (0.05, "5 %".to_owned()),
///     lines: vec![CurveLine { label: String::new(), points: [0.1, 0.2, 0.5, 1.0].map(point).to_vec() }],
///     runs: runs(1.0),
/// };
/// let map = AnswerChart::Map {
///     searched: axis("scene.sensor.pitch_mm"),
///     other: axis("scene.motion.duration_s"),
///     panels: vec![MapPanel { title: String::new(), columns: [0.5, 1.0].map(|x| (x, runs(x))).to_vec(), best: None }],
///     best: None,
/// };
/// for (chart, words) in [
///     (AnswerChart::Bars { axis: "change of the error (%)".to_owned(), bars }, ["roll length", "change"]),
///     (AnswerChart::Heat { axis: "object radius".to_owned(), panels: vec![heat] }, ["84 %", "25 mm"]),
///     (curve, ["sensor pitch (mm)", "undecided"]),
///     (map, ["sensor pitch (mm)", "undecided"]),
/// ] {
///     let figure = answer_figure(&AnswerFigure {
///         name: "answer".to_owned(),
///         title: "Which pads?".to_owned(),
///         subtitle: "at most 5 %".to_owned(),
///         notes: Vec::new(),
///         chart,
///     })?;
///     assert!(words.iter().all(|word| figure.svg.contains(word)), "{words:?}");
/// }
/// # Ok::<(), palpate_report::ReportError>(())
/// ```
///
/// # Errors
/// [`ReportError`] if the image is too large.
pub fn answer_figure(answer: &AnswerFigure) -> Result<Figure, ReportError> {
    let words = Words::new(&answer.name, &answer.title, &answer.subtitle, &answer.notes);
    let plot = match &answer.chart {
        AnswerChart::Bars { axis, bars } => bars::plot(axis, bars),
        AnswerChart::Heat { axis, panels } => return heat::figure(words, axis, panels),
        AnswerChart::Curve {
            searched,
            statistic,
            limit,
            lines,
            runs,
        } => curve_plot(searched, statistic, limit, lines, runs),
        AnswerChart::Map {
            searched,
            other,
            panels,
            best,
        } => map_plot(searched, other, panels, best.as_deref()),
    };
    series::figure(words, vec![plot])
}

fn curve_plot(
    field: &FieldAxis,
    statistic: &Label,
    (limit, limit_label): &(f64, String),
    lines: &[CurveLine],
    runs: &[Stretch],
) -> Plot {
    let points = || lines.iter().flat_map(|line| &line.points);
    let values = || points().map(|point| point.y).chain([*limit]);
    let least = values().fold(f64::INFINITY, f64::min);
    let most = values().fold(f64::NEG_INFINITY, f64::max);
    let is_log = least > 0.0 && most / least > MIN_LOG_RATIO;
    let spacings = [field.spacing(), Spacing::log(is_log)];
    let factors = [field.factor(), statistic.factor];
    // On a logarithmic axis, the lower end of an error bar may be far below all points. The axis is not extended to
    // such an end.
    let bars = points().flat_map(|point| normal(point.y, point.std));
    let ys = values()
        .chain(bars)
        .filter(|y| !is_log || *y >= 0.5 * least);
    let ys = ys.map(|y| y * factors[1]);
    let y = Scale::around(
        spacings[1],
        ys.filter(|y| spacings[1].refusal(*y).is_none()),
    );
    let bands = Bands {
        field,
        along: field.scale(),
        across: y.clone(),
        is_along_x: true,
    };
    let mut grounds = Vec::new();
    let column = bands.column(0.0, runs);
    bands.between((0.0, &column), (1.0, &column), &mut grounds);
    let place = |point: &CurvePoint| (point.x * factors[0], point.y * factors[1]);
    let line = |(number, line): (usize, &CurveLine)| {
        let is_drawn = |point: &&CurvePoint| {
            let (x, y) = place(point);
            spacings[0].refusal(x).is_none() && spacings[1].refusal(y).is_none()
        };
        let drawn: Vec<&CurvePoint> = line.points.iter().filter(is_drawn).collect();
        let places = drawn.iter().map(|point| place(point));
        let survivors = drawn.iter().filter(|point| point.is_of_survivors);
        let bars = drawn.iter().map(|point| {
            let ends = normal(point.y, point.std);
            let ends = ends.map(|end| spacings[1].nearest(end * factors[1]));
            (point.x * factors[0], ends)
        });
        // A line joins the points only if the values of x are numbers and not names.
        let runs = match field.names.is_empty() {
            true => vec![places.collect()],
            false => places.map(|place| vec![place]).collect(),
        };
        Line {
            circled: survivors.map(|point| place(point)).collect(),
            bars: bars.collect(),
            ..Line::new(Style::of(number), false, runs)
        }
    };
    let named = lines.iter().enumerate();
    let named = named.filter(|(_, line)| !line.label.is_empty());
    let entry = |(number, line): (usize, &CurveLine)| {
        let style = Style::of(number);
        let sample = Sample::line(style.colour.stroke_width(STROKE));
        (sample.with(Symbol::new(style, MARKER)), line.label.clone())
    };
    let of_limit = Sample::dashed(INK.stroke_width(LIMIT));
    let of_limit = (of_limit, format!("limit, {limit_label}"));
    let mark = Mark {
        on_x: false,
        at: limit * factors[1],
        label: limit_label.clone(),
        style: INK.stroke_width(LIMIT),
    };
    let is_drawn = spacings[1].refusal(mark.at).is_none();
    let content = Content {
        grounds,
        lines: lines.iter().enumerate().map(line).collect(),
        ..Content::default()
    };
    let labels = [field.label.to_string(), statistic.to_string()];
    Plot {
        key: [of_limit]
            .into_iter()
            .chain(ground_key())
            .chain(named.map(entry))
            .collect(),
        marks: is_drawn.then_some(mark).into_iter().collect(),
        marker: 0.8 * MARKER,
        ..Plot::new(labels, [bands.along, y], vec![content])
    }
}

fn map_plot(field: &FieldAxis, other: &FieldAxis, panels: &[MapPanel], best: Option<&str>) -> Plot {
    let bands = Bands {
        field,
        along: field.scale(),
        across: other.scale(),
        is_along_x: false,
    };
    let is_named = !other.names.is_empty();
    let panel = |panel: &MapPanel| {
        let columns = panel.columns.iter().map(|(at, runs)| {
            let at = bands.across.place(at * other.factor());
            bands.column(at, runs)
        });
        let columns: Vec<Column> = columns.collect();
        let best = panel.best.map(|(x, y)| PointSet {
            label: String::new(),
            style: BEST,
            size: BEST_SIZE,
            at: vec![(x * other.factor(), y * field.factor())],
        });
        Content {
            title: panel.title.clone(),
            grounds: bands.grounds(&columns, is_named),
            lines: bands.contours(&columns, is_named),
            points: best.into_iter().collect(),
        }
    };
    let contour = Sample::line(INK.stroke_width(STROKE)).with(Symbol::new(CROSSING, 0.7 * MARKER));
    let of_best = Sample::symbol(Symbol::new(BEST, BEST_SIZE).open());
    let best = best.map(|words| (of_best, words.to_owned()));
    Plot {
        key: ground_key()
            .into_iter()
            .chain([(contour, "just meets it".to_owned())])
            .chain(best)
            .collect(),
        marker: 0.7 * MARKER,
        ..Plot::new(
            [other.label.to_string(), field.label.to_string()],
            [bands.across.clone(), bands.along.clone()],
            panels.iter().map(panel).collect(),
        )
    }
}

fn ground_key() -> Key {
    let grounds = [
        (MEETS, "meets the target"),
        (MISSES, "misses it"),
        (OPEN, "undecided"),
    ];
    let entry = |(colour, words): (Colour, &str)| (Sample::ground(colour), words.to_owned());
    grounds.map(entry).into()
}

impl FieldAxis {
    fn spacing(&self) -> Spacing {
        Spacing::log(self.is_log && self.ends.0 > 0.0 && self.names.is_empty())
    }

    fn scale(&self) -> Scale {
        if !self.names.is_empty() {
            return Scale::of_names(self.names.clone());
        }
        let ends = [self.ends.0, self.ends.1].into_iter();
        let ends = ends.map(|end| self.spacing().nearest(end * self.factor()));
        Scale::around(self.spacing(), ends)
    }

    /// Factor from a value of the field in the tables to the number that the axis shows.
    fn factor(&self) -> f64 {
        match self.names.is_empty() {
            true => self.label.factor,
            false => 1.0,
        }
    }
}

/// Converts ranges of values of the searched field to areas and lines in a panel. `along` is the scale of the searched
/// field, and `across` is the scale of the other axis. Positions on both scales are from 0 to 1.
struct Bands<'a> {
    field: &'a FieldAxis,
    along: Scale,
    across: Scale,
    is_along_x: bool,
}

/// The ranges of the searched field at one position of the other axis. In a map, this is the position of one value of
/// the other field.
struct Column {
    /// Position on the other axis, from 0 to 1.
    at: f64,
    /// For each range, whether its values meet the target (true) or miss it.
    sides: Vec<bool>,
    /// For each range, the positions of its lower and upper end along the axis of the searched field, from 0 to 1.
    runs: Vec<[f64; 2]>,
}

impl Bands<'_> {
    fn column(&self, at: f64, runs: &[Stretch]) -> Column {
        let ends = runs.iter().map(|run| self.ends((run.from, run.to)));
        Column {
            at,
            sides: runs.iter().map(|run| run.meets).collect(),
            runs: ends.collect(),
        }
    }

    /// Positions of the values `from` and `to` on the scale of the searched field.
    fn ends(&self, (from, to): (f64, f64)) -> [f64; 2] {
        let half = if self.field.names.is_empty() {
            0.0
        } else {
            0.5
        };
        [from - half, to + half].map(|value| self.along.place(value * self.field.factor()))
    }

    /// Whether areas and contours connect two neighbouring columns of the map. Two conditions must be met: the values
    /// of both fields are numbers, and both columns have the same sequence of ranges that meet and ranges that miss the
    /// target. `is_named` states whether the values of the other field are names.
    fn are_alike(&self, is_named: bool, one: &Column, other: &Column) -> bool {
        !is_named && self.field.names.is_empty() && one.sides == other.sides
    }

    /// Background areas of all columns of the map. If a column and its neighbour have the same sequence of ranges that
    /// meet and miss the target, the areas connect both columns. Otherwise, the areas of a column end halfway to its
    /// neighbour.
    fn grounds(&self, columns: &[Column], is_named: bool) -> Vec<(Vec<(f64, f64)>, Colour)> {
        let mut grounds = Vec::new();
        let pairs = columns.windows(2);
        let closest = pairs
            .map(|pair| pair[1].at - pair[0].at)
            .fold(f64::INFINITY, f64::min);
        let alone = ALONE.min(0.5 * closest);
        for (number, one) in columns.iter().enumerate() {
            let edge = |other: Option<&Column>, sign: f64| match other {
                _ if is_named || columns.len() == 1 => one.at + sign * alone,
                Some(other) if !self.are_alike(is_named, one, other) => 0.5 * (one.at + other.at),
                _ => one.at,
            };
            let before = number.checked_sub(1).and_then(|before| columns.get(before));
            let (left, right) = (edge(before, -1.0), edge(columns.get(number + 1), 1.0));
            if right > left {
                self.between((left, one), (right, one), &mut grounds);
            }
        }
        for pair in columns
            .windows(2)
            .filter(|pair| self.are_alike(is_named, &pair[0], &pair[1]))
        {
            self.between((pair[0].at, &pair[0]), (pair[1].at, &pair[1]), &mut grounds);
        }
        grounds
    }

    /// Adds the background areas between two columns. An area extends from a range of `one`, at the position `left`, to
    /// the same range of `other`, at the position `right`.
    fn between(
        &self,
        (left, one): (f64, &Column),
        (right, other): (f64, &Column),
        grounds: &mut Vec<(Vec<(f64, f64)>, Colour)>,
    ) {
        let mut ground =
            |[low, high]: [f64; 2], [next_low, next_high]: [f64; 2], colour: Colour| {
                let thin = if high - low < HALF_WIDTH {
                    HALF_WIDTH
                } else {
                    0.0
                };
                let corners = [
                    (left, low - thin),
                    (right, next_low - thin),
                    (right, next_high + thin),
                    (left, high + thin),
                ];
                grounds.push((corners.map(|corner| self.at(corner)).to_vec(), colour));
            };
        let whole = self.ends(match self.field.names.len() {
            0 => self.field.ends,
            count => (0.0, count as f64 - 1.0),
        });
        ground(whole, whole, OPEN);
        for ((run, next), meets) in one.runs.iter().zip(&other.runs).zip(&one.sides) {
            ground(*run, *next, if *meets { MEETS } else { MISSES });
        }
    }

    /// Contours on which the target is just met. A contour connects neighbouring columns if both have the same sequence
    /// of ranges that meet and ranges that miss the target. At each column, a bar shows the range of values for which
    /// this is undecided.
    fn contours(&self, columns: &[Column], is_named: bool) -> Vec<Line> {
        let crossings = |column: &Column| -> Vec<[f64; 2]> {
            let sides = column.sides.windows(2);
            let runs = column.runs.windows(2).zip(sides);
            let crossed =
                runs.filter(|(_, side)| self.field.names.is_empty() && side[0] != side[1]);
            crossed.map(|(pair, _)| [pair[0][1], pair[1][0]]).collect()
        };
        let mut contours = Vec::new();
        for chain in columns.chunk_by(|one, other| self.are_alike(is_named, one, other)) {
            let crossed: Vec<_> = chain.iter().map(crossings).collect();
            for number in 0..crossed[0].len() {
                let ends = chain
                    .iter()
                    .zip(&crossed)
                    .map(|(column, all)| (column.at, all[number]));
                let middles = ends
                    .clone()
                    .map(|(at, [low, high])| self.at((at, 0.5 * (low + high))));
                let bars = ends.map(|(at, ends)| {
                    (self.across.value(at), ends.map(|end| self.along.value(end)))
                });
                contours.push(Line {
                    bars: bars.collect(),
                    ..Line::new(CROSSING, false, vec![middles.collect()])
                });
            }
        }
        contours
    }

    fn at(&self, (across, along): (f64, f64)) -> (f64, f64) {
        let [across, along] = [(&self.across, across), (&self.along, along)]
            .map(|(scale, position)| scale.value(position.clamp(0.0, 1.0)));
        match self.is_along_x {
            true => (along, across),
            false => (across, along),
        }
    }
}
