//! Figure of a feasible region: the values of two fields that meet a target together.

use super::answer::{MEETS, MISSES, OPEN, Stretch};
use super::drawing::Figure;
use super::scale::{Scale, Spacing};
use super::series::{self, Content, Line, Plot, PointSet};
use super::sheet::{Key, MARKER, STROKE, Sample, Words};
use super::style::{Colour, INK, Marker, Style};
use super::symbol::Symbol;
use crate::ReportError;
use palpate_study::Label;
use plotters::style::Color;

/// Feasible region to draw.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionMap {
    /// Name of the figure's files, without extension.
    pub name: String,
    /// Title.
    pub title: String,
    /// Line below the title, about the target and the aim.
    pub subtitle: String,
    /// Lines below the picture.
    pub notes: Vec<String>,
    /// Field along x.
    pub x: RegionAxis,
    /// Field along y, which was searched.
    pub y: RegionAxis,
    /// Panels, at least one.
    pub panels: Vec<RegionPanel>,
    /// Label of the best value, if one is marked.
    pub best: Option<String>,
}

/// Field along an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionAxis {
    /// Label and unit.
    pub label: Label,
    /// Whether the axis is logarithmic.
    pub is_log: bool,
    /// Smallest and largest value of the range.
    pub ends: (f64, f64),
    /// Names of listed values; then a value is an index into them.
    pub names: Vec<String>,
}

/// Region at some values of further fields.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionPanel {
    /// Values of the further fields; may be empty.
    pub title: String,
    /// Columns in the order of x.
    pub columns: Vec<RegionStrip>,
    /// Place of the best value, if it is in this panel.
    pub best: Option<(f64, f64)>,
}

/// Values that meet the target at one value of x.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionStrip {
    /// The value.
    pub x: f64,
    /// Ranges of y that meet or miss the target, ascending; values between them are undecided.
    pub runs: Vec<Stretch>,
}

/// Marker of a point on the boundary of the target, and marker of the best value.
const CROSSING: Style = Style {
    colour: INK,
    marker: Marker::Circle,
};
const BEST: Style = Style {
    colour: INK,
    marker: Marker::Diamond,
};
const BEST_SIZE: f64 = 36.0;
/// Half the width of a column without neighbours, as a share of the panel's width.
const ALONE: f64 = 0.03;
/// Share of the panel's height by which a single value is widened to both sides, so that it is visible.
const HALF_HEIGHT: f64 = 0.002;

/// Draws a feasible region: a blue background where values meet the target, a grey one where they are undecided, and the
/// contour of the target between them.
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
    let words = Words::new(&map.name, &map.title, &map.subtitle, &map.notes);
    let [x, y] = [&map.x, &map.y].map(scale);
    let panel = |panel: &RegionPanel| {
        let columns = panel.columns.iter();
        let columns = columns.map(|strip| Column {
            at: x.place(strip.x * map.x.factor()),
            sides: strip.runs.iter().map(|run| run.meets).collect(),
            runs: strip
                .runs
                .iter()
                .map(|run| map.y.places(&y, (run.from, run.to)))
                .collect(),
        });
        let region = Region {
            x: &x,
            y: &y,
            is_named: [&map.x, &map.y].map(|axis| !axis.names.is_empty()),
            range: match map.y.names.len() {
                0 => map.y.places(&y, map.y.ends),
                count => map.y.places(&y, (0.0, count as f64 - 1.0)),
            },
            columns: columns.collect(),
        };
        let best = panel.best.map(|(x, y)| PointSet {
            label: String::new(),
            style: BEST,
            size: BEST_SIZE,
            at: vec![(x * map.x.factor(), y * map.y.factor())],
        });
        Content {
            title: panel.title.clone(),
            grounds: region.grounds(),
            lines: region.contours(),
            points: best.into_iter().collect(),
        }
    };
    let labels = [&map.x, &map.y].map(|axis| axis.label.text());
    let panels = map.panels.iter().map(panel).collect();
    let plot = Plot {
        key: key(map),
        marker: 0.7 * MARKER,
        ..Plot::new(labels, [x.clone(), y.clone()], panels)
    };
    series::figure(words, vec![plot])
}

fn scale(axis: &RegionAxis) -> Scale {
    if !axis.names.is_empty() {
        return Scale::of_names(axis.names.clone());
    }
    let ends = [axis.ends.0, axis.ends.1].map(|end| end * axis.label.factor);
    let is_positive = ends.iter().all(|end| *end > 0.0);
    Scale::around(Spacing::log(axis.is_log && is_positive), ends.into_iter())
}

fn key(map: &RegionMap) -> Key {
    let contour = Sample::line(INK.stroke_width(STROKE)).with(Symbol::new(CROSSING, 0.7 * MARKER));
    let key = [
        (Sample::ground(MEETS), "meets the target"),
        (Sample::ground(MISSES), "misses it"),
        (Sample::ground(OPEN), "undecided"),
        (contour, "just meets it"),
    ];
    let best = Sample::symbol(Symbol::new(BEST, BEST_SIZE).open());
    let best = map.best.iter().map(|words| (best, words.as_str()));
    let all = key.into_iter().chain(best);
    all.map(|(sample, words)| (sample, words.to_owned()))
        .collect()
}

impl RegionAxis {
    /// Factor from values of the field to displayed numbers.
    fn factor(&self) -> f64 {
        match self.names.is_empty() {
            true => self.label.factor,
            false => 1.0,
        }
    }

    /// Positions along the scale of both ends of a range of values.
    fn places(&self, scale: &Scale, (from, to): (f64, f64)) -> [f64; 2] {
        let half = if self.names.is_empty() { 0.0 } else { 0.5 };
        [from - half, to + half].map(|value| scale.place(value * self.factor()))
    }
}

/// A panel; positions along its scales are from 0 to 1.
struct Region<'a> {
    x: &'a Scale,
    y: &'a Scale,
    is_named: [bool; 2],
    /// Ends of the range of y.
    range: [f64; 2],
    columns: Vec<Column>,
}

/// Ranges of y at one value of x; each range meets or misses the target throughout.
struct Column {
    at: f64,
    /// Whether each run meets the target.
    sides: Vec<bool>,
    /// Ends of each run.
    runs: Vec<[f64; 2]>,
}

impl Region<'_> {
    /// Whether the contour between two columns can be drawn as one line: both axes are numeric, and the runs of both
    /// columns meet and miss the target in the same order.
    fn are_alike(&self, one: &Column, other: &Column) -> bool {
        self.is_named == [false; 2] && one.sides == other.sides
    }

    /// Background areas: between two alike columns, the area between their runs; for other columns, strips up to the
    /// middle between neighbours.
    fn grounds(&self) -> Vec<(Vec<(f64, f64)>, Colour)> {
        let columns = &self.columns;
        let mut grounds = Vec::new();
        let pairs = columns.windows(2);
        let closest = pairs
            .map(|pair| pair[1].at - pair[0].at)
            .fold(f64::INFINITY, f64::min);
        let alone = ALONE.min(0.5 * closest);
        for (number, one) in columns.iter().enumerate() {
            let edge = |other: Option<&Column>, sign: f64| match other {
                _ if self.is_named[0] || columns.len() == 1 => one.at + sign * alone,
                Some(other) if !self.are_alike(one, other) => 0.5 * (one.at + other.at),
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
            .filter(|pair| self.are_alike(&pair[0], &pair[1]))
        {
            self.between((pair[0].at, &pair[0]), (pair[1].at, &pair[1]), &mut grounds);
        }
        grounds
    }

    /// Adds the background areas between the runs of column `one` at `left` and those of column `other` at `right`.
    fn between(
        &self,
        (left, one): (f64, &Column),
        (right, other): (f64, &Column),
        grounds: &mut Vec<(Vec<(f64, f64)>, Colour)>,
    ) {
        let mut ground =
            |[low, high]: [f64; 2], [next_low, next_high]: [f64; 2], colour: Colour| {
                let thin = if high - low < HALF_HEIGHT {
                    HALF_HEIGHT
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
        ground(self.range, self.range, OPEN);
        for ((run, next), meets) in one.runs.iter().zip(&other.runs).zip(&one.sides) {
            ground(*run, *next, if *meets { MEETS } else { MISSES });
        }
    }

    /// Contours through the crossings of alike neighbours, with a bar over the undecided range at each crossing.
    fn contours(&self) -> Vec<Line> {
        let crossings = |column: &Column| -> Vec<[f64; 2]> {
            let sides = column.sides.windows(2);
            let runs = column.runs.windows(2).zip(sides);
            let crossed = runs.filter(|(_, side)| !self.is_named[1] && side[0] != side[1]);
            crossed.map(|(pair, _)| [pair[0][1], pair[1][0]]).collect()
        };
        let mut contours = Vec::new();
        for chain in self
            .columns
            .chunk_by(|one, other| self.are_alike(one, other))
        {
            let crossed: Vec<_> = chain.iter().map(crossings).collect();
            for number in 0..crossed[0].len() {
                let ends = chain
                    .iter()
                    .zip(&crossed)
                    .map(|(column, all)| (column.at, all[number]));
                let middles = ends
                    .clone()
                    .map(|(at, [low, high])| self.at((at, 0.5 * (low + high))));
                let bars =
                    ends.map(|(at, ends)| (self.x.value(at), ends.map(|end| self.y.value(end))));
                contours.push(Line {
                    bars: bars.collect(),
                    ..Line::new(CROSSING, false, vec![middles.collect()])
                });
            }
        }
        contours
    }

    fn at(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (self.x.value(x), self.y.value(y))
    }
}
