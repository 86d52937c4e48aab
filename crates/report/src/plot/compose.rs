//! From selected rows to a figure: points, legend and the words around them.

use super::along::{self, Along};
use super::captions::{self, full_value, short_value};
use super::figure::{Figure, Legend, Line, Panel};
use super::points::Placed;
use super::scale::{Scale, Spacing};
use super::select::{Column, Selection, present, same};
use super::spec::{Spec, nearest};
use super::style::Style;
use crate::table::{Axis, finite};
use crate::words::{self, Meaning};
use crate::{ReportError, Study};
use std::collections::BTreeMap;

/// The figure that `spec` asks for.
pub(crate) fn figure(study: &Study, spec: &Spec) -> Result<Figure, ReportError> {
    let selection = Selection::new(study, spec)?;
    Composer::new(&selection)?.figure()
}

/// Points left out, by reason: how many, and of which series.
pub(crate) type Skipped<'a> = BTreeMap<&'static str, (usize, Vec<&'a str>)>;

/// A selection with the meaning of its columns.
struct Composer<'a> {
    of: &'a Selection<'a>,
    x: Meaning,
    y: Meaning,
    /// Names along x, if it is not numeric.
    categories: Option<Vec<&'a str>>,
}

impl<'a> Composer<'a> {
    fn new(of: &'a Selection<'a>) -> Result<Self, ReportError> {
        let (table, spec) = (of.study.cells(), of.spec);
        let quantities = present(table.quantities(), &of.rows);
        let meaning = |name: &str| {
            let of_row =
                |row: &usize| words::statistic(name, table.quantity(*row), table.unit(*row));
            let first = of_row(&of.rows[0]);
            match of
                .rows
                .iter()
                .map(of_row)
                .find(|other| other.unit != first.unit)
            {
                None => Ok(words::statistic_of(
                    name,
                    &quantities,
                    table.unit(of.rows[0]),
                )),
                Some(other) => Err(of.bad(format!(
                    "{name} is in {} and in {}; choose one quantity",
                    first.unit, other.unit
                ))),
            }
        };
        let y = meaning(&spec.y)?;
        if let Some(compare) = &spec.compare {
            let unit = meaning(compare)?.unit;
            if unit != y.unit {
                return Err(of.bad(format!(
                    "compare = {compare:?} (in {unit:?}) has another unit than y = {:?} (in {:?})",
                    spec.y, y.unit
                )));
            }
        }
        let (x, categories) = match of.x {
            Column::Statistic(name) => (meaning(name)?, None),
            Column::Axis(axis) if axis.is_numeric() => (words::path(&axis.header), None),
            Column::Axis(axis) => (words::path(&axis.header), Some(present(axis, &of.rows))),
        };
        if spec.logs.x
            && let Some(names) = &categories
        {
            let label = names
                .iter()
                .find(|name| finite(name).is_none())
                .unwrap_or(&"");
            return Err(of.bad(format!(
                "x = {:?} cannot be logarithmic: it holds {label:?}",
                spec.x
            )));
        }
        Ok(Self {
            of,
            x,
            y,
            categories,
        })
    }

    fn figure(&self) -> Result<Figure, ReportError> {
        let Selection { study, spec, .. } = self.of;
        let mut skipped = Skipped::new();
        let placed = self.points()?;
        let panels: Vec<Panel> = match self.of.panels {
            None => vec![Panel {
                title: None,
                lines: self.lines(&self.of.rows, &mut skipped),
                points: placed.of_panel(None),
            }],
            Some(axis) => present(axis, &self.of.rows)
                .into_iter()
                .map(|value| {
                    let lines = self.lines(&with(&self.of.rows, axis, value), &mut skipped);
                    Panel {
                        title: Some(full_value(axis, value)),
                        lines,
                        points: placed.of_panel(Some(value)),
                    }
                })
                .collect(),
        };
        let marks = along::marks(&spec.marks, self.along()).map_err(|why| self.of.bad(why))?;
        let points: Vec<(f64, f64)> = panels.iter().flat_map(Panel::places).collect();
        let marked = |on_x: bool| {
            marks
                .iter()
                .filter(move |mark| mark.on_x == on_x)
                .map(|mark| mark.at)
        };
        let x = match &self.categories {
            Some(names) => {
                Scale::of_categories(names.iter().map(|name| (*name).to_owned()).collect())
            }
            None => Scale::around(
                spacing(spec.logs.x),
                points.iter().map(|p| p.0).chain(marked(true)),
            ),
        };
        let y = Scale::around(
            spacing(spec.logs.y),
            points.iter().map(|p| p.1).chain(marked(false)),
        );
        Ok(Figure {
            name: spec.name.clone(),
            title: spec
                .title
                .clone()
                .unwrap_or_else(|| study.title().to_owned()),
            subtitle: captions::subtitle(self.of),
            x_label: self.x.label(),
            y_label: self.y.label(),
            x,
            y,
            panels,
            legend: Legend {
                points: placed.legend(),
                ..self.legend()
            },
            marks,
            notes: captions::notes(self.of, skipped),
            markers: true,
        })
    }

    /// The lines of one panel in the order of the legend, each followed by its dashed companion.
    fn lines(&self, rows: &[usize], skipped: &mut Skipped<'a>) -> Vec<Line> {
        let spec = self.of.spec;
        let series: Vec<(Style, Vec<usize>)> = match self.of.series {
            None => vec![(Style::of(0), rows.to_vec())],
            Some(axis) => present(axis, rows)
                .into_iter()
                .map(|value| (style(axis, value), with(rows, axis, value)))
                .collect(),
        };
        let mut lines = Vec::new();
        for (style, rows) in series {
            lines.push(Line {
                style,
                dashed: false,
                runs: self.runs(&rows, &spec.y, skipped),
            });
            if let Some(compare) = &spec.compare {
                lines.push(Line {
                    style,
                    dashed: true,
                    runs: self.runs(&rows, compare, skipped),
                });
            }
        }
        lines
    }

    fn runs(
        &self,
        rows: &[usize],
        statistic: &str,
        skipped: &mut Skipped<'a>,
    ) -> Vec<Vec<(f64, f64)>> {
        let table = self.of.study.cells();
        let (x_spacing, y_spacing) = (spacing(self.of.spec.logs.x), spacing(self.of.spec.logs.y));
        let mut points: Vec<(f64, Option<f64>)> = Vec::new();
        for &row in rows {
            let x = self.across(row);
            let y = table.statistic(row, statistic).map(|y| y * self.y.factor);
            let refused = match (x, y) {
                (None, _) => Some("without a defined x"),
                (_, None) => Some("undefined in the table"),
                (Some(x), Some(y)) => x_spacing.refusal(x).or_else(|| y_spacing.refusal(y)),
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
        points
            .split(|(_, y)| y.is_none())
            .map(|run| {
                run.iter()
                    .filter_map(|(x, y)| Some((*x, (*y)?)))
                    .collect::<Vec<_>>()
            })
            .filter(|run| !run.is_empty())
            .collect()
    }

    /// Place of `row` along x.
    fn across(&self, row: usize) -> Option<f64> {
        match (self.of.x, &self.categories) {
            (Column::Axis(axis), Some(names)) => names
                .iter()
                .position(|name| *name == axis.text(row))
                .map(|at| at as f64),
            (Column::Axis(axis), None) => Some(axis.number(row)? * self.x.factor),
            (Column::Statistic(name), _) => {
                Some(self.of.study.cells().statistic(row, name)? * self.x.factor)
            }
        }
    }

    fn along(&self) -> [Along; 2] {
        let logs = self.of.spec.logs;
        let axis = |name, log, meaning: &Meaning| Along {
            name,
            spacing: spacing(log),
            factor: meaning.factor,
        };
        [axis('x', logs.x, &self.x), axis('y', logs.y, &self.y)]
    }

    /// The points of the config in their places.
    fn points(&self) -> Result<Placed, ReportError> {
        let Selection {
            spec,
            series,
            panels,
            rows,
            ..
        } = self.of;
        if self.categories.is_some() && !spec.points.is_empty() {
            let problem = format!("points need numbers along x, and {:?} holds labels", spec.x);
            return Err(self.of.bad(problem));
        }
        let panels = panels.map_or(Vec::new(), |axis| present(axis, rows));
        let style_of = |name: &str| {
            let axis = series.ok_or("the plot has no `series`")?;
            let values = || axis.values().iter().map(String::as_str);
            values().find(|value| same(value, name)).map_or_else(
                || {
                    let known = nearest(name, values()).join(", ");
                    Err(format!("no series {name:?}; known: {known}"))
                },
                |value| Ok(style(axis, value)),
            )
        };
        Placed::of(&spec.points, self.along(), &panels, style_of).map_err(|why| self.of.bad(why))
    }

    fn legend(&self) -> Legend {
        let spec = self.of.spec;
        let compared = spec.compare.as_ref().map(|compare| {
            (
                words::short_statistic(&spec.y),
                words::short_statistic(compare),
            )
        });
        let Some(axis) = self.of.series else {
            return Legend {
                compared,
                ..Legend::default()
            };
        };
        let entry = |value| (short_value(axis, value), style(axis, value));
        let entries = present(axis, &self.of.rows)
            .into_iter()
            .map(entry)
            .collect();
        Legend {
            title: words::path(&axis.header).label(),
            entries,
            compared,
            ..Legend::default()
        }
    }
}

fn spacing(log: bool) -> Spacing {
    if log { Spacing::Log } else { Spacing::Linear }
}

/// The rows in which `axis` has `value`.
fn with(rows: &[usize], axis: &Axis, value: &str) -> Vec<usize> {
    rows.iter()
        .copied()
        .filter(|row| axis.text(*row) == value)
        .collect()
}

/// The style of a value, by its place in the study's own axis: the same in every plot of the study.
fn style(axis: &Axis, value: &str) -> Style {
    Style::of(
        axis.values()
            .iter()
            .position(|known| known == value)
            .unwrap_or(0),
    )
}
