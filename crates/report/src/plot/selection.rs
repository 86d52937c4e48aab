//! Selects the columns and rows of the tables, and the cells of the study, that a `[[plot]]` shows.

use super::captions::{self, full_value};
use super::sheet::Words;
use crate::records::by_key;
use crate::table::{Axis, same};
use crate::{ReportError, Study, Table};
use palpate_study::Quantity;
use palpate_study::config::PlotConfig;
use std::collections::BTreeMap;

/// A `[[plot]]` table, and the study for which its figure is drawn.
#[derive(Clone, Copy)]
pub(crate) struct Request<'a> {
    pub(crate) study: &'a Study,
    pub(crate) plot: &'a PlotConfig,
    pub(crate) name: &'a str,
}

impl<'a> Request<'a> {
    pub(crate) fn words(&self, subtitle: String, notes: Vec<String>) -> Words {
        let title = self.plot.title.as_deref().unwrap_or(self.study.title());
        Words {
            name: self.name.to_owned(),
            title: title.to_owned(),
            subtitle,
            notes,
        }
    }

    /// Error for a plot that cannot be drawn. `problem` describes what is wrong in the table or the plot.
    pub(crate) fn bad(&self, problem: String) -> ReportError {
        ReportError::BadPlot {
            path: self.study.run_toml(),
            plot: self.name.to_owned(),
            problem,
        }
    }

    /// Error for a key of the plot whose `value` names no column. The error lists the `known` columns.
    pub(crate) fn unknown<'b>(
        &self,
        key: &str,
        value: &str,
        known: impl Iterator<Item = &'b str>,
    ) -> ReportError {
        let mut known = nearest(value, known);
        // Only rolls and glides have a mean curvature. Their tables contain the principal curvatures only if the config
        // requires it.
        let has_mean = known
            .iter()
            .any(|name| name == Quantity::MEAN_CURVATURE.name);
        if has_mean && Quantity::PRINCIPAL.iter().any(|one| one.name == value) {
            known.push(format!(
                "and {value} if the config sets `scene.principal_curvatures = true`"
            ));
        }
        self.bad(format!(
            "{key} = {value:?} is not a column; possible: {}",
            known.join(", ")
        ))
    }

    /// The swept field whose path is `name`. `key` is the plot's key that contains this name, for the error message.
    pub(crate) fn axis(&self, key: &str, name: &str) -> Result<&'a Axis, ReportError> {
        let table = self.study.cells();
        let known = table.axes().iter().map(|axis| axis.header.as_str());
        let unknown = || self.unknown(key, name, known);
        table.axis(name).ok_or_else(unknown)
    }
}

/// The `names`, most similar to `wanted` first.
pub(crate) fn nearest<'a>(wanted: &str, names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut names: Vec<&str> = names.collect();
    let likeness = |name: &str| strsim::jaro_winkler(wanted, name);
    names.sort_by(|a, b| likeness(b).total_cmp(&likeness(a)));
    names.into_iter().map(str::to_owned).collect()
}

/// A column of `cells.csv` that a plot uses: a swept field (or the column `quantity`), or a statistic.
#[derive(Clone, Copy)]
pub(crate) enum Column<'a> {
    Axis(&'a Axis),
    Statistic(&'a str),
}

/// The columns and rows that a plot of kind `lines` shows. There is at least one row. Rows with the same panel and
/// series have different x.
pub(crate) struct Selection<'a> {
    pub(crate) of: Request<'a>,
    pub(crate) table: &'a Table,
    pub(crate) x: Column<'a>,
    pub(crate) y: &'a str,
    pub(crate) series: Option<&'a Axis>,
    pub(crate) panels: Option<&'a Axis>,
    pub(crate) rows: Vec<usize>,
    /// Values that the plot's key `where` states but that the table does not contain.
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

    fn text(self, table: &Table, row: usize) -> String {
        match self {
            Self::Axis(axis) => axis.text(row).to_owned(),
            Self::Statistic(name) => table
                .statistic(row, name)
                .map_or(String::new(), |value| value.to_string()),
        }
    }
}

/// The column of a swept field, named with or without its unit, or the column `quantity`; `None` for other names.
fn axis<'a>(table: &'a Table, name: &str) -> Option<&'a Axis> {
    let quantities = || Some(table.quantities()).filter(|axis| axis.header == name);
    table.axis(name).or_else(quantities)
}

impl<'a> Selection<'a> {
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

    /// Returns an error if two rows have the same panel, series and x. The error names the swept fields in which the
    /// rows differ.
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
        // If x is a statistic instead of a swept field, rows without a value of this statistic are not drawn. Therefore
        // several of them may have the same panel and series.
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
        let point = point.collect::<Vec<_>>().join(", ");
        let free = match free.is_empty() {
            true => format!(
                "all swept fields have equal values in these {} rows",
                rows.len()
            ),
            false => free.join(", "),
        };
        Err(self.of.bad(format!(
            "several rows share {point}; choose a quantity by `quantity` and other values by `where`, or spread over `series` or `panels`: {free}"
        )))
    }
}

/// Text that lists the different values of the field `axis` in `rows`; `None` if all rows have the same value.
fn variety(axis: &Axis, rows: &[usize]) -> Option<String> {
    match axis.among(rows).as_slice() {
        [] | [_] => None,
        [a, b] => Some(format!("{a} or {b}")),
        [a, .., b] => Some(format!("{} values, {a} … {b}", axis.among(rows).len())),
    }
}

/// The cells of the study that a figure of `map.csv` shows.
pub(crate) struct CellSelection {
    /// One row of `cells.csv` for each selected cell. There is at least one row.
    pub(crate) rows: Vec<usize>,
    /// Notes about cells without a map, and about values that the key `where` names, but that the table does not
    /// contain.
    pub(crate) notes: Vec<String>,
}

/// Selects the cells of the study that have a map and that the key `where` of a plot accepts. `mapped` are the numbers
/// of all cells with a map.
pub(crate) fn choose_cells(of: Request<'_>, mapped: &[u64]) -> Result<CellSelection, ReportError> {
    let table = of.study.cells();
    let cells = by_key((0..table.rows()).map(|row| (table.cell(row), row)));
    let mut cells: Vec<usize> = cells.into_iter().map(|(_, rows)| rows[0]).collect();
    let mut absent = Vec::new();
    for (path, values) in of.plot.filters() {
        let axis = of.axis("where", path)?;
        let known = |value: &&String| axis.values().iter().any(|there| same(value, there));
        let lost = values.iter().filter(|value| !known(value));
        absent.extend(lost.map(|value| format!("{path} = {value}")));
        cells.retain(|row| values.iter().any(|value| same(value, axis.text(*row))));
    }
    let (rows, without): (Vec<usize>, Vec<usize>) = cells
        .into_iter()
        .partition(|row| mapped.contains(&table.cell(*row)));
    if rows.is_empty() {
        let lost = captions::lost(&absent);
        return Err(of.bad(format!(
            "`where` leaves no cell that has a map in map.csv{lost}"
        )));
    }
    let mut notes = Vec::new();
    if !without.is_empty() {
        let places = without.iter().take(4).map(|row| place(of.study, *row));
        let places = places.collect::<Vec<_>>().join("; ");
        let more = if without.len() > 4 { "; …" } else { "" };
        notes.push(format!("No map: {places}{more}."));
    }
    notes.extend(captions::absent(&absent));
    Ok(CellSelection { rows, notes })
}

fn place(study: &Study, row: usize) -> String {
    let values = captions::swept_values(study.cells(), row);
    match values.is_empty() {
        true => "the only cell".to_owned(),
        false => values.join(", "),
    }
}

/// Texts of the settings that are the same in all table rows `rows`: the object, unless it is swept, and each swept
/// field that has the same value in all these rows.
pub(crate) fn in_common(study: &Study, rows: &[usize]) -> Vec<String> {
    let axes = study.cells().axes();
    let of_object = |header: &str| header.starts_with("scene.object");
    let is_swept = axes.iter().any(|axis| of_object(&axis.header));
    let object = if is_swept {
        None
    } else {
        captions::object(study)
    };
    let shared = axes
        .iter()
        .filter_map(|axis| match axis.among(rows).as_slice() {
            [value] => Some(full_value(axis, value)),
            _ => None,
        });
    object.into_iter().chain(shared).collect()
}
