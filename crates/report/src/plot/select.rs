//! Which rows of the table a plot shows, and by which columns.

use super::spec::{Spec, nearest};
use crate::table::{Axis, finite};
use crate::{ReportError, Study, Table};
use std::collections::BTreeMap;

/// A column of the table.
#[derive(Clone, Copy)]
pub(crate) enum Column<'a> {
    Axis(&'a Axis),
    Statistic(&'a str),
}

/// The columns and rows of one plot: at least one row, and one row per panel, series and x.
pub(crate) struct Selection<'a> {
    pub(crate) study: &'a Study,
    pub(crate) spec: &'a Spec,
    pub(crate) x: Column<'a>,
    pub(crate) series: Option<&'a Axis>,
    pub(crate) panels: Option<&'a Axis>,
    pub(crate) rows: Vec<usize>,
    /// Values asked for by `where` that the table does not have.
    pub(crate) absent: Vec<String>,
}

impl<'a> Column<'a> {
    fn named(table: &'a Table, name: &'a str) -> Option<Self> {
        let statistic = || table.statistics().any(|known| known == name);
        match axis(table, name) {
            Some(axis) => Some(Self::Axis(axis)),
            None => statistic().then_some(Self::Statistic(name)),
        }
    }

    /// The text in `row`; empty where a statistic is undefined.
    fn text(self, table: &Table, row: usize) -> String {
        match self {
            Self::Axis(axis) => axis.text(row).to_owned(),
            Self::Statistic(name) => table
                .statistic(row, name)
                .map_or(String::new(), |value| value.to_string()),
        }
    }
}

/// The axis of that name: a swept path, with or without its unit, or `quantity`.
fn axis<'a>(table: &'a Table, name: &str) -> Option<&'a Axis> {
    table
        .axis(name)
        .or_else(|| Some(table.quantities()).filter(|axis| axis.header == name))
}

impl<'a> Selection<'a> {
    /// Holds the names in `spec` against the study's table.
    pub(crate) fn new(study: &'a Study, spec: &'a Spec) -> Result<Self, ReportError> {
        let table = study.cells();
        let axes = || {
            table
                .axes()
                .iter()
                .map(|axis| axis.header.as_str())
                .chain(["quantity"])
        };
        let unknown = |key: &str, value: &str, known: Vec<String>| ReportError::UnknownColumn {
            path: study.run_toml(),
            plot: spec.name.clone(),
            key: key.to_owned(),
            value: value.to_owned(),
            known,
        };
        let any = |key: &str, name: &'a str| {
            Column::named(table, name)
                .ok_or_else(|| unknown(key, name, nearest(name, axes().chain(table.statistics()))))
        };
        let optional_axis = |key: &str, name: Option<&str>| {
            let trials = |name| Some(table.trials()).filter(|axis| axis.header == name);
            let find = |name| {
                axis(table, name)
                    .or_else(|| trials(name))
                    .ok_or_else(|| unknown(key, name, nearest(name, axes())))
            };
            name.map(find).transpose()
        };
        for (key, name) in [("y", Some(&spec.y)), ("compare", spec.compare.as_ref())] {
            if let Some(name) = name
                && !table.statistics().any(|known| known == name)
            {
                return Err(unknown(key, name, nearest(name, table.statistics())));
            }
        }
        let mut rows: Vec<usize> = (0..table.rows()).collect();
        if let Some(wanted) = &spec.quantity {
            rows.retain(|row| table.quantity(*row) == wanted);
            if rows.is_empty() {
                let known = table.quantities().values().iter().map(String::as_str);
                return Err(unknown("quantity", wanted, nearest(wanted, known)));
            }
        }
        let mut absent = Vec::new();
        for (name, values) in &spec.filters {
            let column = any("where", name)?;
            let holds = |row: &usize, value: &str| same(value, &column.text(table, *row));
            let lost = values
                .iter()
                .filter(|value| !(0..table.rows()).any(|row| holds(&row, value)));
            absent.extend(lost.map(|value| format!("{name} = {value}")));
            rows.retain(|row| values.iter().any(|value| holds(row, value)));
        }
        let selection = Self {
            study,
            spec,
            x: any("x", &spec.x)?,
            series: optional_axis("series", spec.series.as_deref())?,
            panels: optional_axis("panels", spec.panels.as_deref())?,
            rows,
            absent,
        };
        if selection.rows.is_empty() {
            let lost = selection
                .absent
                .iter()
                .map(|lost| format!("; the table has no {lost}"));
            return Err(selection.bad(format!(
                "`where` leaves no rows{}",
                lost.collect::<String>()
            )));
        }
        selection.check_unique()?;
        Ok(selection)
    }

    /// An error of this plot.
    pub(crate) fn bad(&self, problem: String) -> ReportError {
        ReportError::BadPlot {
            path: self.study.run_toml(),
            plot: self.spec.name.clone(),
            problem,
        }
    }

    /// One row per panel, series and x; else the error names the axes in which the rows of a point differ.
    fn check_unique(&self) -> Result<(), ReportError> {
        let table = self.study.cells();
        let mut points: BTreeMap<[String; 3], Vec<usize>> = BTreeMap::new();
        for &row in &self.rows {
            let text = |axis: Option<&Axis>| axis.map_or("", |axis| axis.text(row)).to_owned();
            let x = self.x.text(table, row);
            points
                .entry([text(self.panels), text(self.series), x])
                .or_default()
                .push(row);
        }
        // A statistic that is undefined is no point.
        let real = |point: &[String; 3]| matches!(self.x, Column::Axis(_)) || !point[2].is_empty();
        let Some((point, rows)) = points
            .into_iter()
            .find(|(point, rows)| rows.len() > 1 && real(point))
        else {
            return Ok(());
        };
        let names = [
            &self.spec.panels,
            &self.spec.series,
            &Some(self.spec.x.clone()),
        ];
        let named = names.iter().zip(&point);
        let point = named.filter_map(|(name, text)| Some(format!("{} = {text}", name.as_ref()?)));
        let mut free: Vec<String> = table
            .axes()
            .iter()
            .chain([table.quantities()])
            .filter_map(|axis| Some(format!("{} ({})", axis.header, variety(axis, &rows)?)))
            .collect();
        if free.is_empty() {
            free.push(format!("no axis differs between these {} rows", rows.len()));
        }
        Err(ReportError::NotUnique {
            path: self.study.run_toml(),
            plot: self.spec.name.clone(),
            point: point.collect::<Vec<_>>().join(", "),
            free: free.join(", "),
        })
    }
}

/// The values of `axis` that occur in `rows`, in the order of the study.
pub(crate) fn present<'a>(axis: &'a Axis, rows: &[usize]) -> Vec<&'a str> {
    let occurs = |value: &&String| rows.iter().any(|row| axis.text(*row) == **value);
    axis.values()
        .iter()
        .filter(occurs)
        .map(String::as_str)
        .collect()
}

/// The values of `axis` among `rows`, if there are several, in words.
fn variety(axis: &Axis, rows: &[usize]) -> Option<String> {
    match present(axis, rows).as_slice() {
        [] | [_] => None,
        [a, b] => Some(format!("{a} or {b}")),
        [a, .., b] => Some(format!("{} values, {a} … {b}", present(axis, rows).len())),
    }
}

/// Equal as numbers, if both are numbers, else as text.
pub(crate) fn same(a: &str, b: &str) -> bool {
    match (finite(a), finite(b)) {
        (Some(a), Some(b)) => (a - b).abs() <= 1e-12 * a.abs().max(b.abs()),
        _ => a == b,
    }
}
