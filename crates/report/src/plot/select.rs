//! Rows of the table that a plot shows, and the columns by which it shows them.

use super::captions;
use super::request::Request;
use crate::table::{Axis, same};
use crate::{ReportError, Table};
use std::collections::BTreeMap;

/// A column of the table.
#[derive(Clone, Copy)]
pub(crate) enum Column<'a> {
    Axis(&'a Axis),
    Statistic(&'a str),
}

/// The columns and rows of one plot: at least one row, and one row per panel, series and x.
pub(crate) struct Selection<'a> {
    pub(crate) of: Request<'a>,
    pub(crate) table: &'a Table,
    pub(crate) x: Column<'a>,
    /// Statistic along y.
    pub(crate) y: &'a str,
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
    let quantities = || Some(table.quantities()).filter(|axis| axis.header == name);
    table.axis(name).or_else(quantities)
}

impl<'a> Selection<'a> {
    /// Holds the names in the plot against the study's table.
    pub(crate) fn new(of: Request<'a>) -> Result<Self, ReportError> {
        let (table, plot) = (of.study.cells(), of.plot);
        let swept = || table.axes().iter().map(|axis| axis.header.as_str());
        let axes = || swept().chain(["quantity"]);
        let any = |key: &str, name: &'a str| {
            let unknown = || of.unknown(key, name, axes().chain(table.statistics()));
            Column::named(table, name).ok_or_else(unknown)
        };
        let optional_axis = |key: &str, name: &'a Option<String>| {
            let trials = |name: &str| Some(table.trials()).filter(|axis| axis.header == name);
            let find = |name: &'a str| {
                let found = axis(table, name).or_else(|| trials(name));
                found.ok_or_else(|| of.unknown(key, name, axes()))
            };
            name.as_deref().map(find).transpose()
        };
        let needed = |key: &str, name: &'a Option<String>| {
            name.as_deref()
                .ok_or_else(|| of.bad(format!("{key} is missing")))
        };
        let (x, y) = (needed("x", &plot.x)?, needed("y", &plot.y)?);
        for (key, name) in [("y", Some(y)), ("compare", plot.compare.as_deref())] {
            if let Some(name) = name
                && !table.statistics().any(|known| known == name)
            {
                return Err(of.unknown(key, name, table.statistics()));
            }
        }
        let mut rows: Vec<usize> = (0..table.rows()).collect();
        if let Some(wanted) = &plot.quantity {
            rows.retain(|row| table.quantity(*row) == wanted);
            if rows.is_empty() {
                let known = table.quantities().values().iter().map(String::as_str);
                return Err(of.unknown("quantity", wanted, known));
            }
        }
        let mut absent = Vec::new();
        for (name, values) in plot.filters() {
            let column = any("where", name)?;
            let holds = |row: &usize, value: &str| same(value, &column.text(table, *row));
            let lost = values
                .iter()
                .filter(|value| !(0..table.rows()).any(|row| holds(&row, value)));
            absent.extend(lost.map(|value| format!("{name} = {value}")));
            rows.retain(|row| values.iter().any(|value| holds(row, value)));
        }
        let selection = Self {
            of,
            table,
            x: any("x", x)?,
            y,
            series: optional_axis("series", &plot.series)?,
            panels: optional_axis("panels", &plot.panels)?,
            rows,
            absent,
        };
        if selection.rows.is_empty() {
            let lost = captions::lost(&selection.absent);
            return Err(of.bad(format!("`where` leaves no rows{lost}")));
        }
        selection.check_unique()?;
        Ok(selection)
    }

    /// Checks that there is one row per panel, series and x; else the error names the axes in which the rows of a point differ.
    fn check_unique(&self) -> Result<(), ReportError> {
        let (table, plot) = (self.table, self.of.plot);
        let mut points: BTreeMap<[String; 3], Vec<usize>> = BTreeMap::new();
        for &row in &self.rows {
            let text = |axis: Option<&Axis>| axis.map_or("", |axis| axis.text(row)).to_owned();
            let point = [
                text(self.panels),
                text(self.series),
                self.x.text(table, row),
            ];
            points.entry(point).or_default().push(row);
        }
        // A statistic that is undefined is no point.
        let real = |point: &[String; 3]| matches!(self.x, Column::Axis(_)) || !point[2].is_empty();
        let mut crowded = points.into_iter().filter(|(_, rows)| rows.len() > 1);
        let Some((point, rows)) = crowded.find(|(point, _)| real(point)) else {
            return Ok(());
        };
        let named = [&plot.panels, &plot.series, &plot.x]
            .into_iter()
            .zip(&point);
        let point = named.filter_map(|(name, text)| Some(format!("{} = {text}", name.as_ref()?)));
        let axes = table.axes().iter().chain([table.quantities()]);
        let free =
            axes.filter_map(|axis| Some(format!("{} ({})", axis.header, variety(axis, &rows)?)));
        let free: Vec<String> = free.collect();
        Err(ReportError::NotUnique {
            path: self.of.study.run_toml(),
            plot: self.of.name.to_owned(),
            point: point.collect::<Vec<_>>().join(", "),
            free: match free.is_empty() {
                true => format!("no axis differs between these {} rows", rows.len()),
                false => free.join(", "),
            },
        })
    }
}

/// The values of `axis` among `rows`, if there are several, in words.
fn variety(axis: &Axis, rows: &[usize]) -> Option<String> {
    match axis.among(rows).as_slice() {
        [] | [_] => None,
        [a, b] => Some(format!("{a} or {b}")),
        [a, .., b] => Some(format!("{} values, {a} … {b}", axis.among(rows).len())),
    }
}
