//! Profiles of a press: the displacement of the skin along a radius, true and estimated.

mod table;

use super::along::{self, Along};
use super::captions::{full_value, short_value};
use super::cells::{self, Chosen};
use super::figure::{Figure, Legend, Line, Panel};
use super::points::Placed;
use super::scale::{Scale, Spacing};
use super::select::present;
use super::spec::{Component, ProfileSpec, nearest};
use super::style::{PLAIN, Style};
use crate::table::Axis;
use crate::{ReportError, Study, words};
use table::{Profile, Runs};

/// Lines without markers are told apart by colour alone.
const MOST_LINES: usize = PLAIN;

/// The figure that `spec` asks for of the study's `map.csv`.
pub(crate) fn figure(study: &Study, spec: &ProfileSpec) -> Result<Figure, ReportError> {
    let profiles = table::read(&study.dir().join("map.csv"), spec.component)?;
    let mapped: Vec<u64> = profiles.cells.iter().map(|profile| profile.cell).collect();
    let Chosen { rows, notes } = cells::choose(study, &spec.heading, &spec.filters, &mapped)?;
    let bad = |problem: String| ReportError::BadPlot {
        path: study.run_toml(),
        plot: spec.heading.name.clone(),
        problem,
    };
    let axes = Axes::of(study, spec, &rows)?;
    let series = axes.series(&rows);
    if series.len() > MOST_LINES {
        let count = series.len();
        return Err(bad(format!(
            "{count} lines are told apart by colour alone; choose at most {MOST_LINES} by `where`, or spread them over `panels`"
        )));
    }
    let along = ['x', 'y'].map(|name| Along {
        name,
        spacing: Spacing::Linear,
        factor: 1.0,
    });
    let panel_values = axes.panel.map_or(Vec::new(), |axis| present(axis, &rows));
    let placed = Placed::of(&spec.points, along, &panel_values, |name| {
        series_named(&series, name)
    })
    .map_err(bad)?;

    let panel = |value: Option<&str>| {
        let here = rows.iter().filter(|row| match (axes.panel, value) {
            (Some(axis), Some(value)) => axis.text(**row) == value,
            _ => true,
        });
        let shown = here.filter_map(|row| {
            let cell = study.cells().cell(*row);
            let profile = profiles.cells.iter().find(|profile| profile.cell == cell)?;
            let name = axes.name(*row);
            let series = series.iter().find(|series| series.name == name)?;
            Some((series.style, profile))
        });
        Panel {
            title: axes
                .panel
                .zip(value)
                .map(|(axis, value)| full_value(axis, value)),
            lines: lines(&shown.collect::<Vec<_>>()),
            points: placed.of_panel(value),
        }
    };
    let panels: Vec<Panel> = if panel_values.is_empty() {
        vec![panel(None)]
    } else {
        panel_values
            .iter()
            .map(|value| panel(Some(value)))
            .collect()
    };
    let marks = along::marks(&spec.marks, along).map_err(bad)?;
    let places: Vec<(f64, f64)> = panels.iter().flat_map(Panel::places).collect();
    let marked = |on_x: bool| {
        marks
            .iter()
            .filter(move |mark| mark.on_x == on_x)
            .map(|mark| mark.at)
    };
    let scale = |values: &mut dyn Iterator<Item = f64>| Scale::around(Spacing::Linear, values);
    let displacement = match spec.component {
        Component::Normal => "displacement inward",
        Component::Radial => "displacement along the skin, outward",
    };
    let [x_unit, y_unit] = profiles.units.each_ref().map(|unit| words::unit(unit));
    let estimated = panels
        .iter()
        .flat_map(|panel| &panel.lines)
        .any(|line| line.dashed);
    let mut subtitle = cells::in_common(study, &rows);
    if estimated {
        subtitle.push("estimates of one trial each".to_owned());
    }
    Ok(Figure {
        name: spec.heading.name.clone(),
        title: spec
            .heading
            .title
            .as_deref()
            .unwrap_or(study.title())
            .to_owned(),
        subtitle: subtitle.join(" · "),
        x_label: words::with_unit("radial position", &x_unit),
        y_label: words::with_unit(displacement, &y_unit),
        x: scale(&mut places.iter().map(|place| place.0).chain(marked(true))),
        y: scale(&mut places.iter().map(|place| place.1).chain(marked(false))),
        legend: Legend {
            title: axes.title(),
            entries: if axes.names.is_empty() {
                Vec::new()
            } else {
                series
                    .iter()
                    .map(|series| (series.label.clone(), series.style))
                    .collect()
            },
            compared: estimated.then(|| ("truth".to_owned(), "estimate".to_owned())),
            points: placed.legend(),
        },
        panels,
        marks,
        notes,
        markers: false,
    })
}

/// The lines of one panel: what is true, then what is estimated. A truth that several cells share is drawn once, in
/// nobody's colour.
fn lines(shown: &[(Style, &Profile)]) -> Vec<Line> {
    let line = |style: Style, dashed: bool, runs: &Runs| Line {
        style,
        dashed,
        runs: runs.clone(),
    };
    let mut truths: Vec<Line> = Vec::new();
    for (style, profile) in shown {
        match truths.iter_mut().find(|known| known.runs == profile.truth) {
            Some(shared) => shared.style = Style::open(0),
            None => truths.push(line(*style, false, &profile.truth)),
        }
    }
    let estimates = shown
        .iter()
        .map(|(style, profile)| line(*style, true, &profile.estimate));
    truths
        .into_iter()
        .chain(estimates)
        .filter(|line| !line.runs.is_empty())
        .collect()
}

/// Axes on which the chosen cells differ.
struct Axes<'a> {
    panel: Option<&'a Axis>,
    /// Axes other than that of the panels on which the cells differ.
    names: Vec<&'a Axis>,
}

/// The cells of one colour, at most one in a panel.
struct Series<'a> {
    /// Values on the axes that tell the series apart.
    name: Vec<&'a str>,
    label: String,
    style: Style,
}

impl<'a> Axes<'a> {
    fn of(study: &'a Study, spec: &ProfileSpec, rows: &[usize]) -> Result<Self, ReportError> {
        let table = study.cells();
        let find = |name: &String| {
            table.axis(name).ok_or_else(|| ReportError::UnknownColumn {
                path: study.run_toml(),
                plot: spec.heading.name.clone(),
                key: "panels".to_owned(),
                value: name.clone(),
                known: nearest(name, table.axes().iter().map(|axis| axis.header.as_str())),
            })
        };
        let panel = spec.panels.as_ref().map(find).transpose()?;
        let differ = |axis: &&Axis| {
            panel.is_none_or(|panel| panel.header != axis.header) && present(axis, rows).len() > 1
        };
        let names = table.axes().iter().filter(differ).collect();
        Ok(Self { panel, names })
    }

    fn name(&self, row: usize) -> Vec<&'a str> {
        self.names.iter().map(|axis| axis.text(row)).collect()
    }

    /// Title over the names of the series: the words of the axis, if a single one tells them apart.
    fn title(&self) -> String {
        match self.names.as_slice() {
            [axis] => words::path(&axis.header).label(),
            _ => String::new(),
        }
    }

    fn series(&self, rows: &[usize]) -> Vec<Series<'a>> {
        let mut all: Vec<Series<'a>> = Vec::new();
        for &row in rows {
            let name = self.name(row);
            if all.iter().all(|series| series.name != name) {
                let label = self.label(&name);
                let style = Style::of(all.len());
                all.push(Series { name, label, style });
            }
        }
        // One axis of few values has a colour for each, the same in every plot of the study.
        if let [axis] = self.names.as_slice()
            && axis.values().len() <= PLAIN
        {
            for series in &mut all {
                let place = axis
                    .values()
                    .iter()
                    .position(|value| series.name == [value]);
                series.style = Style::of(place.unwrap_or(0));
            }
        }
        all
    }

    fn label(&self, name: &[&str]) -> String {
        match (self.names.as_slice(), name) {
            ([axis], [value]) => short_value(axis, value),
            (axes, values) => {
                let mut parts: Vec<String> = Vec::new();
                for (axis, value) in axes.iter().zip(values) {
                    let part = full_value(axis, value);
                    if !parts.contains(&part) {
                        parts.push(part);
                    }
                }
                parts.join(", ")
            }
        }
    }
}

/// The look of the series of this label, or of this value if one axis tells them apart.
fn series_named(series: &[Series<'_>], name: &str) -> Result<Style, String> {
    let found = series
        .iter()
        .find(|series| series.label == name || series.name == [name]);
    found.map(|series| series.style).ok_or_else(|| {
        let known = nearest(name, series.iter().map(|series| series.label.as_str())).join("; ");
        format!("no line is called {name:?}; known: {known}")
    })
}
