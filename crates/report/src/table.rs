//! `cells.csv`: one row per cell and quantity.

use crate::records::Records;
use crate::{ReportError, words};
use std::path::Path;

/// The statistics every `cells.csv` has, in their order.
pub(crate) const STATISTICS: [&str; 15] = [
    "truth",
    "trials",
    "failures",
    "mean",
    "std",
    "bias",
    "rms_error",
    "mean_abs_error",
    "relative_rms_error",
    "relative_mean_abs_error",
    "q05",
    "q50",
    "q95",
    "mean_reported_std",
    "coverage95",
];

/// One swept path: a column of the table, between `cell` and `quantity`.
#[derive(Debug, Clone)]
pub struct Axis {
    /// The header of the column: the path, with its unit appended where it has one.
    pub header: String,
    cells: Vec<String>,
    numbers: Vec<Option<f64>>,
    /// The distinct texts in order of appearance, which is the order of the study's sweep.
    values: Vec<String>,
}

impl Axis {
    /// Whether `path` names this axis, with or without the unit.
    pub fn is(&self, path: &str) -> bool {
        self.header == path || words::split_unit(&self.header).0 == path
    }

    /// The text in `row`.
    pub fn text(&self, row: usize) -> &str {
        &self.cells[row]
    }

    /// The finite number in `row`, if it is one (a label is not).
    pub fn number(&self, row: usize) -> Option<f64> {
        self.numbers[row]
    }

    /// Whether every cell is a finite number.
    pub fn is_numeric(&self) -> bool {
        self.numbers.iter().all(Option::is_some)
    }

    /// The distinct values in the order of the study's sweep.
    pub fn values(&self) -> &[String] {
        &self.values
    }
}

/// The contents of one `cells.csv`. Rows are numbered from 0; row `r` stands on line `r + 2` of the file
/// unless a quoted cell spans lines.
#[derive(Debug, Clone)]
pub struct Table {
    axes: Vec<Axis>,
    cell: Vec<u64>,
    quantity: Axis,
    trials: Axis,
    unit: Vec<String>,
    statistics: Vec<(String, Vec<Option<f64>>)>,
}

impl Table {
    /// Reads a `cells.csv`.
    ///
    /// ```
    /// use palpate_report::Table;
    ///
    /// let dir = tempfile::tempdir()?;
    /// let path = dir.path().join("cells.csv");
    /// let statistics = "truth,trials,failures,mean,std,bias,rms_error,mean_abs_error,relative_rms_error,\
    ///     relative_mean_abs_error,q05,q50,q95,mean_reported_std,coverage95";
    /// let row = format!("0,5,curvature,1/mm,0.2,1,0,0.25{}", ",".repeat(11));
    /// std::fs::write(&path, format!("cell,scene.object.radius_mm,quantity,unit,{statistics}\n{row}\n"))?;
    ///
    /// let table = Table::read(&path)?;
    /// let radius = table.axis("scene.object.radius").and_then(|axis| axis.number(0));
    /// assert_eq!((radius, table.quantity(0)), (Some(5.0), "curvature"));
    /// assert_eq!((table.statistic(0, "mean"), table.statistic(0, "std")), (Some(0.25), None));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// The file cannot be read, is not CSV, has no rows, lacks a column or has one twice, or holds text or
    /// a number that is not finite where a number must be.
    pub fn read(path: &Path) -> Result<Self, ReportError> {
        let Records {
            header,
            rows,
            lines,
        } = Records::read(path, &["cell", "quantity", "unit"])?;
        if rows.is_empty() {
            return Err(ReportError::EmptyTable {
                path: path.to_owned(),
            });
        }
        let place = |name: &str| {
            header
                .iter()
                .position(|column| column == name)
                .ok_or_else(|| ReportError::MissingColumn {
                    path: path.to_owned(),
                    column: name.to_owned(),
                    found: header.clone(),
                })
        };
        for name in STATISTICS {
            place(name)?;
        }
        let (cell, quantity, unit) = (place("cell")?, place("quantity")?, place("unit")?);
        let column = |at: usize| {
            rows.iter()
                .map(|row| row[at].clone())
                .collect::<Vec<String>>()
        };
        let bad = |row: usize, at: usize, expected| ReportError::BadCell {
            path: path.to_owned(),
            line: lines[row],
            column: header[at].clone(),
            value: rows[row][at].clone(),
            expected,
        };

        let axes = (cell + 1..quantity)
            .map(|at| Axis::new(header[at].clone(), column(at)))
            .collect();
        let cells = (0..rows.len())
            .map(|row| {
                rows[row][cell]
                    .parse()
                    .map_err(|_| bad(row, cell, "the number of a cell"))
            })
            .collect::<Result<_, _>>()?;
        let statistics = (unit + 1..header.len())
            .map(|at| {
                let values = (0..rows.len())
                    .map(|row| match rows[row][at].as_str() {
                        "" => Ok(None),
                        text => finite(text)
                            .map(Some)
                            .ok_or_else(|| bad(row, at, "a finite number")),
                    })
                    .collect::<Result<_, _>>()?;
                Ok((header[at].clone(), values))
            })
            .collect::<Result<_, ReportError>>()?;
        Ok(Self {
            axes,
            cell: cells,
            quantity: Axis::new(header[quantity].clone(), column(quantity)),
            trials: Axis::new("trials".to_owned(), column(place("trials")?)),
            unit: column(unit),
            statistics,
        })
    }

    /// Number of rows, at least 1.
    pub fn rows(&self) -> usize {
        self.cell.len()
    }

    /// The swept paths, in the order of the study.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// The axis that `path` names, with or without its unit.
    pub fn axis(&self, path: &str) -> Option<&Axis> {
        self.axes.iter().find(|axis| axis.is(path))
    }

    /// Names of the quantities as an axis, one per row.
    pub fn quantities(&self) -> &Axis {
        &self.quantity
    }

    /// Numbers of trials as an axis, one per row: where trials are swept, the table has no other column for them.
    pub fn trials(&self) -> &Axis {
        &self.trials
    }

    /// The cell that `row` belongs to.
    pub fn cell(&self, row: usize) -> u64 {
        self.cell[row]
    }

    /// Name of the quantity of `row`.
    pub fn quantity(&self, row: usize) -> &str {
        self.quantity.text(row)
    }

    /// Unit of the quantity of `row`, as written in the table.
    pub fn unit(&self, row: usize) -> &str {
        &self.unit[row]
    }

    /// Names of the statistics columns.
    pub fn statistics(&self) -> impl Iterator<Item = &str> {
        self.statistics.iter().map(|(name, _)| name.as_str())
    }

    /// The statistic `name` of `row`; `None` if it is undefined there, or there is no such column.
    pub fn statistic(&self, row: usize, name: &str) -> Option<f64> {
        self.statistics
            .iter()
            .find(|(column, _)| column == name)
            .and_then(|(_, values)| values[row])
    }
}

impl Axis {
    fn new(header: String, cells: Vec<String>) -> Self {
        let mut values: Vec<String> = Vec::new();
        for cell in &cells {
            if !values.contains(cell) {
                values.push(cell.clone());
            }
        }
        let numbers = cells.iter().map(|cell| finite(cell)).collect();
        Self {
            header,
            cells,
            numbers,
            values,
        }
    }
}

/// A finite number, or nothing.
pub(crate) fn finite(text: &str) -> Option<f64> {
    text.trim()
        .parse()
        .ok()
        .filter(|number: &f64| number.is_finite())
}
