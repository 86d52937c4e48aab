//! Figures of kind `lines`: statistics of `cells.csv` as lines.

use super::captions::{self, full_value, short_value};
use super::drawing::Figure;
use super::reference_lines::{self, AxisScale, Points};
use super::scale::{Scale, Spacing};
use super::selection::{Column, Request, Selection, nearest};
use super::series::{self, Content, Line, Mark, Plot, Runs, SeriesKey, scales};
use super::style::Style;
use super::uncertainty;
use crate::table::{Axis, same};
use crate::{ReportError, phrases};
use palpate_study::{Label, config, number};
use std::collections::BTreeMap;

pub(crate) fn figure(of: Request<'_>) -> Result<Figure, ReportError> {
    let selection = Selection::new(of)?;
    Lines::new(&selection)?.figure()
}

/// A point is circled if more than this share of its trials failed, because its statistics describe only the successful
/// trials.
const MAX_FAILED: f64 = 0.05;

/// Points that cannot be drawn. The key is the reason. The value contains the number of points with this reason, and
/// the series to which they belong.
type Skipped<'a> = BTreeMap<&'static str, (usize, Vec<&'a str>)>;

struct Lines<'a> {
    of: &'a Selection<'a>,
    x: Label,
    y: Label,
    spacing: [Spacing; 2],
    /// Names along the x axis; `None` if the values of x are numbers.
    categories: Option<Vec<&'a str>>,
}

impl<'a> Lines<'a> {
    fn new(of: &'a Selection<'a>) -> Result<Self, ReportError> {
        let y = label(of, of.y)?;
        if let Some(compare) = &of.of.plot.compare {
            let unit = label(of, compare)?.unit;
            if unit != y.unit {
                return Err(of.of.bad(format!(
                    "compare = {compare:?} (in {unit:?}) must have the same unit as y = {:?} (in {:?})",
                    of.y, y.unit
                )));
            }
        }
        let (x, categories) = match of.x {
            Column::Statistic(name) => (label(of, name)?, None),
            Column::Axis(axis) => {
                let names = (!axis.is_numeric()).then(|| axis.among(&of.rows));
                (Label::of_field(&axis.header), names)
            }
        };
        let scale = of.of.plot.scale;
        let logs = [
            matches!(scale, config::Scale::LogX | config::Scale::LogLog),
            matches!(scale, config::Scale::LogY | config::Scale::LogLog),
        ];
        if logs[0]
            && let Some(names) = &categories
        {
            let mut names = names.iter();
            let label = names.find(|name| number::finite(name).is_none());
            return Err(of.of.bad(format!(
                "x = {:?} cannot be logarithmic: it contains {:?}",
                of.of.plot.x.as_deref().unwrap_or_default(),
                label.unwrap_or(&"")
            )));
        }
        Ok(Self {
            of,
            x,
            y,
            spacing: logs.map(Spacing::log),
            categories,
        })
    }

    fn figure(&self) -> Result<Figure, ReportError> {
        let Selection { of, rows, .. } = self.of;
        let mut skipped = Skipped::new();
        let points = self.points()?;
        let values: Vec<Option<&str>> = match self.of.panels {
            None => vec![None],
            Some(axis) => axis.among(rows).into_iter().map(Some).collect(),
        };
        let panel = |value: Option<&'a str>| {
            let value = self.of.panels.zip(value);
            let here = value.map_or(rows.clone(), |(axis, value)| with(rows, axis, value));
            let title = value.map(|(axis, value)| full_value(axis, value));
            Content {
                title: title.unwrap_or_default(),
                lines: self.lines(&here, &mut skipped),
                points: points.of_panel(value.map(|(_, value)| value)),
                ..Content::default()
            }
        };
        let panels: Vec<Content> = values.into_iter().map(panel).collect();
        let marks =
            reference_lines::marks(&of.plot.marks, self.along()).map_err(|why| of.bad(why))?;
        let [x, y] = self.scales(&panels, &marks);
        let mut lines = panels.iter().flat_map(|panel| &panel.lines);
        let is_circled = lines.clone().any(|line| !line.circled.is_empty());
        let has_bars = lines.any(|line| !line.bars.is_empty());
        let words = of.words(self.subtitle(), self.notes(skipped, is_circled, has_bars));
        let series = SeriesKey {
            points: points.legend(),
            ..self.key()
        };
        let plot = Plot {
            series,
            marks,
            ..Plot::new([self.x.to_string(), self.y.to_string()], [x, y], panels)
        };
        series::figure(words, vec![plot])
    }

    fn scales(&self, panels: &[Content], marks: &[Mark]) -> [Scale; 2] {
        let bars = || {
            let lines = panels.iter().flat_map(|panel| &panel.lines);
            lines.flat_map(|line| line.bars.iter().flat_map(|(_, ends)| *ends))
        };
        let [x, y] = scales(panels, marks, |axis, places| {
            let mut places: Vec<f64> = places.collect();
            if axis == 1 {
                let [least, most] = [
                    places.iter().copied().fold(f64::INFINITY, f64::min),
                    places.iter().copied().fold(f64::NEG_INFINITY, f64::max),
                ];
                // Extend the axis to the ends of the error bars. Ignore ends that are far beyond all points.
                let is_near = |end: &f64| match self.spacing[axis] {
                    Spacing::Log => (0.5 * least..=2.0 * most).contains(end),
                    Spacing::Linear => (least - (most - least)..=2.0 * most - least).contains(end),
                };
                places.extend(bars().filter(is_near));
            }
            Scale::around(self.spacing[axis], places.into_iter())
        });
        let named = self
            .categories
            .as_ref()
            .map(|names| Scale::of_names(names.iter().map(|name| (*name).to_owned()).collect()));
        [named.unwrap_or(x), y]
    }

    /// The lines of one panel, in the order of the legend. A solid line may be followed by a dashed line with a second
    /// statistic of the same series.
    fn lines(&self, rows: &[usize], skipped: &mut Skipped<'a>) -> Vec<Line> {
        let series: Vec<(Style, Vec<usize>)> = match self.of.series {
            None => vec![(Style::of(0), rows.to_vec())],
            Some(axis) => axis
                .among(rows)
                .into_iter()
                .map(|value| (style(axis, value), with(rows, axis, value)))
                .collect(),
        };
        let statistics = [Some(self.of.y), self.of.of.plot.compare.as_deref()];
        let mut lines = Vec::new();
        for (style, rows) in series {
            for (statistic, dashed) in statistics.into_iter().flatten().zip([false, true]) {
                let survivors = |row: &usize| !dashed && self.is_of_survivors(*row);
                let survivors: Vec<usize> = rows.iter().copied().filter(survivors).collect();
                let circled = self.runs(&survivors, statistic, &mut Skipped::new());
                lines.push(Line {
                    style,
                    dashed,
                    runs: self.runs(&rows, statistic, skipped),
                    circled: circled.concat(),
                    bars: match dashed {
                        true => Vec::new(),
                        false => self.bars(&rows),
                    },
                });
            }
        }
        lines
    }

    fn runs(&self, rows: &[usize], statistic: &str, skipped: &mut Skipped<'a>) -> Runs {
        let mut points: Vec<(f64, Option<f64>)> = Vec::new();
        for &row in rows {
            let x = self.across(row);
            let y = self
                .of
                .table
                .statistic(row, statistic)
                .map(|y| y * self.y.factor);
            let refused = match (x, y) {
                (None, _) => Some("without a defined x"),
                (_, None) => Some("undefined in the table"),
                (Some(x), Some(y)) => {
                    let [across, up] = self.spacing;
                    across.refusal(x).or_else(|| up.refusal(y))
                }
            };
            if let Some(why) = refused {
                let (count, series) = skipped.entry(why).or_default();
                *count += 1;
                let name = self.of.series.map(|axis| axis.text(row));
                series.extend(name.filter(|name| !series.contains(name)));
            }
            if let Some(x) = x {
                points.push((x, y.filter(|_| refused.is_none())));
            }
        }
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let runs = points.split(|(_, y)| y.is_none());
        let drawn = |run: &[(f64, Option<f64>)]| {
            let places = run.iter().filter_map(|(x, y)| Some((*x, (*y)?)));
            places.collect::<Vec<_>>()
        };
        runs.map(drawn).filter(|run| !run.is_empty()).collect()
    }

    /// Error bars of those points in `rows` that can be drawn. Each entry contains the x of the point and the ends of
    /// its 95 % interval, which are computed from the Monte Carlo error of the plotted statistic.
    fn bars(&self, rows: &[usize]) -> Vec<(f64, [f64; 2])> {
        let [across, up] = self.spacing;
        let bar = |&row: &usize| {
            let x = self.across(row).filter(|x| across.refusal(*x).is_none())?;
            let y = self.of.table.statistic(row, self.of.y)? * self.y.factor;
            up.refusal(y).is_none().then_some(())?;
            let ends = uncertainty::interval(self.of.table, row, self.of.y)?;
            Some((x, ends.map(|end| up.nearest(end * self.y.factor))))
        };
        rows.iter().filter_map(bar).collect()
    }

    /// Whether more than [`MAX_FAILED`] of the trials of `row` failed.
    fn is_of_survivors(&self, row: usize) -> bool {
        let count = |name| self.of.table.statistic(row, name).unwrap_or(0.0);
        let is_of_trials = !["failures", "trials"].contains(&self.of.y);
        is_of_trials && count("failures") > MAX_FAILED * count("trials")
    }

    fn across(&self, row: usize) -> Option<f64> {
        match (self.of.x, &self.categories) {
            (Column::Axis(axis), Some(names)) => {
                let mut names = names.iter();
                let at = names.position(|name| *name == axis.text(row))?;
                Some(at as f64)
            }
            (Column::Axis(axis), None) => Some(axis.number(row)? * self.x.factor),
            (Column::Statistic(name), _) => {
                Some(self.of.table.statistic(row, name)? * self.x.factor)
            }
        }
    }

    fn along(&self) -> [AxisScale; 2] {
        let axis = |name, spacing, label: &Label| AxisScale {
            name,
            spacing,
            factor: label.factor,
        };
        let [x, y] = self.spacing;
        [axis('x', x, &self.x), axis('y', y, &self.y)]
    }

    fn points(&self) -> Result<Points, ReportError> {
        let of = self.of.of;
        if self.categories.is_some() && !of.plot.points.is_empty() {
            let x = of.plot.x.as_deref().unwrap_or_default();
            return Err(of.bad(format!(
                "points need numbers along x, and {x:?} holds labels"
            )));
        }
        let (panels, rows) = (self.of.panels, &self.of.rows);
        let panels = panels.map_or(Vec::new(), |axis| axis.among(rows));
        let style_of = |name: &str| {
            let axis = self.of.series.ok_or("the plot has no `series`")?;
            let values = || axis.values().iter().map(String::as_str);
            let found = values().find(|value| same(value, name));
            found.map(|value| style(axis, value)).ok_or_else(|| {
                let known = nearest(name, values()).join(", ");
                format!("no series {name:?}; known: {known}")
            })
        };
        Points::of(&of.plot.points, self.along(), &panels, style_of).map_err(|why| of.bad(why))
    }

    fn key(&self) -> SeriesKey {
        let compare = self.of.of.plot.compare.as_deref();
        let compared = compare.map(|name| [self.of.y, name].map(phrases::short_statistic).into());
        let Some(axis) = self.of.series else {
            return SeriesKey {
                compared,
                ..SeriesKey::default()
            };
        };
        let entry = |value| (short_value(axis, value), style(axis, value));
        SeriesKey {
            title: Label::of_field(&axis.header).to_string(),
            entries: axis.among(&self.of.rows).into_iter().map(entry).collect(),
            compared,
            ..SeriesKey::default()
        }
    }

    /// Subtitle with the settings that all points share and with the number of trials per point.
    fn subtitle(&self) -> String {
        let Selection {
            of, table, rows, ..
        } = self.of;
        let fixed = of.plot.filters().filter_map(|(path, values)| {
            let axis = table.axis(path)?;
            match values.as_slice() {
                [value] => Some(full_value(axis, value)),
                _ => None,
            }
        });
        let fixed: Vec<String> = fixed.collect();
        let trials = rows
            .iter()
            .filter_map(|row| table.statistic(*row, "trials"));
        phrases::sentence(&fixed, &phrases::sample(trials, "point"))
    }

    /// Notes below the figure: about points that are not drawn, circled points, error bars and failed trials.
    /// `is_circled` and `has_bars` state whether the figure has circled points and error bars.
    fn notes(&self, skipped: Skipped<'_>, is_circled: bool, has_bars: bool) -> Vec<String> {
        let note = |(why, (count, series)): (&str, (usize, Vec<&str>))| {
            let points = match count {
                1 => "1 point is".to_owned(),
                n => format!("{} points are", number::grouped(n as u64)),
            };
            let of_which = match (self.of.series, series.len()) {
                (Some(axis), 1..=6) => {
                    let values = series.iter().map(|value| short_value(axis, value));
                    let values = values.collect::<Vec<_>>().join(", ");
                    format!(" ({} {values})", Label::of_field(&axis.header).words)
                }
                _ => String::new(),
            };
            format!("Not drawn: {points} {why}{of_which}.")
        };
        let failed = captions::failed(self.of.of.study, &self.of.rows);
        let survivors = is_circled
            .then(|| "Circled: points at which more than 5 % of the trials failed.".to_owned());
        let bars = has_bars.then(|| uncertainty::BARS.to_owned());
        let notes = skipped.into_iter().map(note).chain(survivors);
        let notes = notes.chain(bars).chain(failed);
        notes.chain(captions::absent(&self.of.absent)).collect()
    }
}

fn label(of: &Selection<'_>, name: &str) -> Result<Label, ReportError> {
    let table = of.table;
    let of_row = |row: &usize| phrases::statistic(name, &[table.quantity(*row)], table.unit(*row));
    let first = of_row(&of.rows[0]);
    let mut others = of.rows.iter().map(of_row);
    match others.find(|other| other.unit != first.unit) {
        None => {
            let quantities = table.quantities().among(&of.rows);
            Ok(phrases::statistic(
                name,
                &quantities,
                table.unit(of.rows[0]),
            ))
        }
        Some(other) => Err(of.of.bad(format!(
            "{name} is in {} and in {}; choose one quantity",
            first.unit, other.unit
        ))),
    }
}

/// The rows of `rows` in which the field `axis` has the value `value`.
fn with(rows: &[usize], axis: &Axis, value: &str) -> Vec<usize> {
    let rows = rows.iter().copied();
    rows.filter(|row| axis.text(*row) == value).collect()
}

/// Colour and marker for a value of a swept field. They depend only on the index of the value in the study, so a value
/// has the same style in all plots of the study.
fn style(axis: &Axis, value: &str) -> Style {
    let place = axis.values().iter().position(|known| known == value);
    Style::of(place.unwrap_or(0))
}
