//! Figures of kind `profile`: the true and the estimated displacement of the skin over the distance from the contact.

use super::captions::{full_value, short_value};
use super::drawing::Figure;
use super::reference_lines::{self, AxisScale, Points};
use super::scale::{Scale, Spacing};
use super::selection::{self, CellSelection, Request, nearest};
use super::series::{self, Content, Line, Plot, Runs, SeriesKey, scales};
use super::style::{PLAIN, Style};
use crate::phrases::with_unit;
use crate::records::{Records, distinct};
use crate::table::Axis;
use crate::{ReportError, phrases};
use palpate_study::Label;
use palpate_study::config::Component;
use palpate_study::label::spoken_unit;

/// Largest number of series. The lines have no markers and differ only in colour, so only a few can be distinguished.
const MAX_LINES: usize = PLAIN;

pub(crate) fn figure(of: Request<'_>) -> Result<Figure, ReportError> {
    let component = of.plot.component.unwrap_or(Component::Normal);
    let profiles = read(of, component)?;
    let mapped: Vec<u64> = profiles.cells.iter().map(|profile| profile.cell).collect();
    let CellSelection { rows, notes } = selection::choose_cells(of, &mapped)?;
    let axes = Axes::of(of, &rows)?;
    let series = axes.series(&rows);
    if series.len() > MAX_LINES {
        let count = series.len();
        return Err(of.bad(format!(
            "{count} lines would differ only in colour; choose at most {MAX_LINES} by `where`, or spread them \
             over `panels`"
        )));
    }
    let along = ['x', 'y'].map(|name| AxisScale {
        name,
        spacing: Spacing::Linear,
        factor: 1.0,
    });
    let panel_values = axes.panel.map_or(Vec::new(), |axis| axis.among(&rows));
    let look = |name: &str| series_named(&series, name);
    let points = Points::of(&of.plot.points, along, &panel_values, look);
    let points = points.map_err(|why| of.bad(why))?;

    let panel = |value: Option<&str>| {
        let here = rows.iter().filter(|row| match (axes.panel, value) {
            (Some(axis), Some(value)) => axis.text(**row) == value,
            _ => true,
        });
        let shown = here.filter_map(|row| {
            let cell = of.study.cells().cell(*row);
            let profile = profiles.cells.iter().find(|profile| profile.cell == cell)?;
            let name = axes.name(*row);
            let series = series.iter().find(|series| series.name == name)?;
            Some((series.style, profile))
        });
        let title = axes.panel.zip(value);
        let title = title.map(|(axis, value)| full_value(axis, value));
        Content {
            title: title.unwrap_or_default(),
            lines: lines(&shown.collect::<Vec<_>>()),
            points: points.of_panel(value),
            ..Content::default()
        }
    };
    let panels: Vec<Content> = match panel_values.is_empty() {
        true => vec![panel(None)],
        false => panel_values
            .iter()
            .map(|value| panel(Some(value)))
            .collect(),
    };
    let marks = reference_lines::marks(&of.plot.marks, along).map_err(|why| of.bad(why))?;
    let [x, y] = scales(&panels, &marks, |_, places| {
        Scale::around(Spacing::Linear, places)
    });
    let displacement = match component {
        Component::Normal => "displacement inward",
        Component::Radial => "displacement along the skin, outward",
    };
    let mut shown = panels.iter().flat_map(|panel| &panel.lines);
    let estimated = shown.any(|line| line.dashed);
    let of_what = match estimated {
        true => "true displacements, and the estimates of one trial each",
        false => "true displacements",
    };
    let subtitle = phrases::sentence(&selection::in_common(of.study, &rows), of_what);
    let named = series.iter().filter(|_| !axes.names.is_empty());
    let [x_unit, y_unit] = profiles.units.each_ref().map(|unit| spoken_unit(unit));
    let labels = [("radial position", x_unit), (displacement, y_unit)];
    let labels = labels.map(|(text, unit)| with_unit(text, &unit));
    let plot = Plot {
        series: SeriesKey {
            title: axes.title(),
            entries: named
                .map(|series| (series.label.clone(), series.style))
                .collect(),
            compared: estimated.then(|| ("truth".to_owned(), "estimate".to_owned())),
            points: points.legend(),
        },
        marks,
        marker: 0.0,
        ..Plot::new(labels, [x, y], panels)
    };
    series::figure(of.words(subtitle, notes), vec![plot])
}

/// Lines of one panel: first the true displacements, then the estimates. If several cells of the study have the same
/// true displacement, one line in a neutral colour shows it for all of them.
fn lines(shown: &[(Style, &Profile)]) -> Vec<Line> {
    let mut truths: Vec<Line> = Vec::new();
    for (style, profile) in shown {
        match truths.iter_mut().find(|known| known.runs == profile.truth) {
            Some(shared) => shared.style = Style::open(0),
            None => truths.push(Line::new(*style, false, profile.truth.clone())),
        }
    }
    let estimates = shown
        .iter()
        .map(|(style, profile)| Line::new(*style, true, profile.estimate.clone()));
    let all = truths.into_iter().chain(estimates);
    all.filter(|line| !line.runs.is_empty()).collect()
}

struct Axes<'a> {
    panel: Option<&'a Axis>,
    /// Swept fields that distinguish the series within a panel, because the drawn cells differ in them. `panel` is
    /// excluded, because each value of `panel` has its own panel.
    names: Vec<&'a Axis>,
}

/// A series of the plot: cells of the study that are drawn in the same colour, at most one cell in each panel.
struct Series<'a> {
    /// Values of the swept fields [`Axes::names`] in this series.
    name: Vec<&'a str>,
    label: String,
    style: Style,
}

impl<'a> Axes<'a> {
    fn of(of: Request<'a>, rows: &[usize]) -> Result<Self, ReportError> {
        let panel = of.plot.panels.as_deref();
        let panel = panel.map(|name| of.axis("panels", name)).transpose()?;
        let differ = |axis: &&Axis| {
            panel.is_none_or(|panel| panel.header != axis.header) && axis.among(rows).len() > 1
        };
        let names = of.study.cells().axes().iter().filter(differ).collect();
        Ok(Self { panel, names })
    }

    fn name(&self, row: usize) -> Vec<&'a str> {
        self.names.iter().map(|axis| axis.text(row)).collect()
    }

    /// Heading of the legend: the name of the swept field if the series differ in only one field; otherwise empty.
    fn title(&self) -> String {
        match self.names.as_slice() {
            [axis] => Label::of_field(&axis.header).to_string(),
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
        // If the series differ in only one field with few values, each value of the field gets the same colour in all
        // plots of the study.
        if let [axis] = self.names.as_slice()
            && axis.values().len() <= PLAIN
        {
            for series in &mut all {
                let mut values = axis.values().iter();
                let place = values.position(|value| series.name == [value]);
                series.style = Style::of(place.unwrap_or(0));
            }
        }
        all
    }

    fn label(&self, name: &[&str]) -> String {
        match (self.names.as_slice(), name) {
            ([axis], [value]) => short_value(axis, value),
            (axes, values) => {
                let parts = axes.iter().zip(values);
                let parts = distinct(parts.map(|(axis, value)| full_value(axis, value)));
                parts.join(", ")
            }
        }
    }
}

/// Style of the series whose label is `name`. If the series differ in only one swept field, `name` may also be the
/// value of this field.
fn series_named(series: &[Series<'_>], name: &str) -> Result<Style, String> {
    let is_it = |series: &&Series<'_>| series.label == name || series.name == [name];
    let found = series.iter().find(is_it);
    found.map(|series| series.style).ok_or_else(|| {
        let known = nearest(name, series.iter().map(|series| series.label.as_str())).join("; ");
        format!("no line is called {name:?}; known: {known}")
    })
}

/// One component of the skin's displacement in every cell of the study, in the order of `map.csv`.
struct Profiles {
    /// Units in the headers of the table: the unit of the distance from the contact, and the unit of the displacement.
    /// A unit may be empty.
    units: [String; 2],
    cells: Vec<Profile>,
}

struct Profile {
    cell: u64,
    truth: Runs,
    estimate: Runs,
}

fn read(of: Request<'_>, component: Component) -> Result<Profiles, ReportError> {
    let columns = match component {
        Component::Normal => ["normal_displacement", "estimated_normal_displacement"],
        Component::Radial => ["radial_displacement", "estimated_radial_displacement"],
    };
    let columns = ["cell", "radial_position", columns[0], columns[1]];
    let table = Records::read(of.study.files(), "map.csv", &columns)?.filled()?;
    let profile = |(cell, rows): (u64, Vec<usize>)| -> Result<Profile, ReportError> {
        for pair in rows.windows(2) {
            if table.number(pair[0], 1)? >= table.number(pair[1], 1)? {
                return Err(table.bad(pair[1], 1, "larger than in the previous row of its cell"));
            }
        }
        Ok(Profile {
            cell,
            truth: runs(&table, &rows, 2)?,
            estimate: runs(&table, &rows, 3)?,
        })
    };
    let cells = table.by_cell(0)?.into_iter();
    Ok(Profiles {
        units: [1, 2].map(|column| table.unit(column).to_owned()),
        cells: cells.map(profile).collect::<Result<_, _>>()?,
    })
}

fn runs(table: &Records, rows: &[usize], column: usize) -> Result<Runs, ReportError> {
    let mut runs: Runs = vec![Vec::new()];
    for &row in rows {
        if table.text(row, column).is_empty() {
            runs.push(Vec::new());
        } else if let Some(run) = runs.last_mut() {
            run.push((table.number(row, 1)?, table.number(row, column)?));
        }
    }
    runs.retain(|run| !run.is_empty());
    Ok(runs)
}
