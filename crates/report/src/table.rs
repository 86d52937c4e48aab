//! The table `cells.csv`, with one row per cell and quantity.

use crate::records::{Records, distinct};
use crate::{Files, ReportError};
use palpate_study::number::finite;
use palpate_study::{Statistic, config};

/// Statistics whose columns may be missing in `cells.csv`. A statistic without a column is `None` in all rows.
const OPTIONAL: [Statistic; 3] = [
    Statistic::RmsErrorStd,
    Statistic::Coverage50,
    Statistic::Coverage80,
];

/// The values of a swept field in all rows. In `cells.csv`, the columns of swept fields are between `cell` and
/// `quantity`.
#[derive(Debug, Clone)]
pub(crate) struct Axis {
    /// Header of the column: the path of the field, with its unit if it has one.
    pub(crate) header: String,
    stem: String,
    cells: Vec<String>,
    numbers: Vec<Option<f64>>,
    /// The values of the field without repetitions, in the order of the study's sweep.
    values: Vec<String>,
}

impl Axis {
    /// Whether `path` names this field, with or without its unit.
    pub(crate) fn is(&self, path: &str) -> bool {
        self.header == path || self.stem == path
    }

    pub(crate) fn text(&self, row: usize) -> &str {
        &self.cells[row]
    }

    /// The value of the field in `row` as a number; `None` if it is not a finite number.
    pub(crate) fn number(&self, row: usize) -> Option<f64> {
        self.numbers[row]
    }

    pub(crate) fn is_numeric(&self) -> bool {
        self.numbers.iter().all(Option::is_some)
    }

    /// The different values of the field in `rows`, in the order of the study's sweep.
    pub(crate) fn among(&self, rows: &[usize]) -> Vec<&str> {
        let occurs = |value: &&String| rows.iter().any(|row| self.text(*row) == **value);
        let values = self.values.iter().filter(occurs);
        values.map(String::as_str).collect()
    }

    pub(crate) fn values(&self) -> &[String] {
        &self.values
    }
}

/// Contents of `cells.csv`. Rows are numbered from 0. Row `r` is line `r + 2` of the file, unless a quoted cell has
/// several lines.
#[derive(Debug, Clone)]
pub(crate) struct Table {
    axes: Vec<Axis>,
    cell: Vec<u64>,
    quantity: Axis,
    trials: Axis,
    unit: Vec<String>,
    statistics: Vec<(String, Vec<Option<f64>>)>,
}

impl Table {
    pub(crate) fn read(files: &Files) -> Result<Self, ReportError> {
        let places = ["cell", "quantity", "unit"].into_iter();
        let statistics = Statistic::ALL.into_iter();
        let needed = statistics.filter(|statistic| !OPTIONAL.contains(statistic));
        let names: Vec<&str> = places.chain(needed.map(Statistic::name)).collect();
        let table = Records::read_in_order(files, "cells.csv", &names, 3)?.filled()?;
        let [cell, quantity, unit] = [0, 1, 2].map(|column| table.place(column));
        let column = |at: usize| table.column(at).map(str::to_owned).collect::<Vec<String>>();
        let axis = |at: usize| Axis::new(table.header()[at].clone(), column(at));
        let rows = 0..table.rows();
        let number_of_cell = |row: usize| table.parsed(row, 0, "the number of a cell");
        let statistic = |at: usize| {
            let number = |(row, text): (usize, &str)| match text {
                "" => Ok(None),
                text => match finite(text) {
                    None => Err(table.bad_at(row, at, "a finite number")),
                    number => Ok(number),
                },
            };
            let numbers = table.column(at).enumerate().map(number);
            Ok((
                table.header()[at].clone(),
                numbers.collect::<Result<_, _>>()?,
            ))
        };
        let statistics = (unit + 1..table.header().len()).map(statistic);
        let trials = names.iter().position(|name| *name == "trials");
        Ok(Self {
            axes: (cell + 1..quantity).map(axis).collect(),
            cell: rows.map(number_of_cell).collect::<Result<_, _>>()?,
            quantity: axis(quantity),
            trials: axis(table.place(trials.unwrap_or_default())),
            unit: column(unit),
            statistics: statistics.collect::<Result<_, ReportError>>()?,
        })
    }

    pub(crate) fn rows(&self) -> usize {
        self.cell.len()
    }

    pub(crate) fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// The swept field with this path; `None` if the field is not swept. `path` may be the name of the column without
    /// its unit.
    pub(crate) fn axis(&self, path: &str) -> Option<&Axis> {
        self.axes.iter().find(|axis| axis.is(path))
    }

    /// The column `quantity` as an [`Axis`], so that plots can treat quantities like the values of a swept field.
    pub(crate) fn quantities(&self) -> &Axis {
        &self.quantity
    }

    /// The column `trials` as an [`Axis`], so that plots can treat numbers of trials like the values of a swept field.
    /// If the study sweeps the number of trials, the result is the swept column.
    pub(crate) fn trials(&self) -> &Axis {
        &self.trials
    }

    pub(crate) fn cell(&self, row: usize) -> u64 {
        self.cell[row]
    }

    pub(crate) fn quantity(&self, row: usize) -> &str {
        self.quantity.text(row)
    }

    pub(crate) fn unit(&self, row: usize) -> &str {
        &self.unit[row]
    }

    pub(crate) fn statistics(&self) -> impl Iterator<Item = &str> {
        self.statistics.iter().map(|(name, _)| name.as_str())
    }

    /// The value of a statistic in `row`; `None` if it is empty in the table, or if the table has no such column.
    pub(crate) fn statistic(&self, row: usize, name: &str) -> Option<f64> {
        self.statistics
            .iter()
            .find(|(column, _)| column == name)
            .and_then(|(_, values)| values[row])
    }
}

impl Axis {
    fn new(header: String, cells: Vec<String>) -> Self {
        let numbers = cells.iter().map(|cell| finite(cell)).collect();
        Self {
            stem: config::field(&header).0.to_owned(),
            values: distinct(&cells).into_iter().cloned().collect(),
            header,
            cells,
            numbers,
        }
    }
}

/// Whether two texts are equal. If both are numbers, the numbers are compared.
pub(crate) fn same(a: &str, b: &str) -> bool {
    match (finite(a), finite(b)) {
        (Some(a), Some(b)) => (a - b).abs() <= 1e-12 * a.abs().max(b.abs()),
        _ => a == b,
    }
}
