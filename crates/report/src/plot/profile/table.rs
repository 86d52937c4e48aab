//! `map.csv` of a press: displacements along a radius, true and estimated.

use super::super::spec::Component;
use crate::ReportError;
use crate::records::Columns;
use std::collections::BTreeMap;
use std::path::Path;

/// One component of every cell's displacement, cells in order of appearance.
#[derive(Debug)]
pub(crate) struct Profiles {
    /// Units of the radial position and of the displacement, as in the table; may be empty.
    pub(crate) units: [String; 2],
    pub(crate) cells: Vec<Profile>,
}

/// Runs of places (radial position, displacement), broken where the table has none.
pub(crate) type Runs = Vec<Vec<(f64, f64)>>;

/// One cell's displacement.
#[derive(Debug)]
pub(crate) struct Profile {
    pub(crate) cell: u64,
    pub(crate) truth: Runs,
    pub(crate) estimate: Runs,
}

/// Reads `map.csv`.
pub(crate) fn read(path: &Path, component: Component) -> Result<Profiles, ReportError> {
    let columns = match component {
        Component::Normal => ["normal_displacement", "estimated_normal_displacement"],
        Component::Radial => ["radial_displacement", "estimated_radial_displacement"],
    };
    let table = Columns::read(path, &["cell", "radial_position", columns[0], columns[1]])?;
    let mut order: Vec<u64> = Vec::new();
    let mut rows_of: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    for row in 0..table.rows() {
        let cell = table
            .text(row, 0)
            .parse()
            .map_err(|_| table.bad(row, 0, "the number of a cell"))?;
        let rows = rows_of.entry(cell).or_default();
        if rows.is_empty() {
            order.push(cell);
        }
        rows.push(row);
    }
    let profile = |cell: u64| -> Result<Profile, ReportError> {
        let rows = &rows_of[&cell];
        check_rising(&table, rows)?;
        Ok(Profile {
            cell,
            truth: runs(&table, rows, 2)?,
            estimate: runs(&table, rows, 3)?,
        })
    };
    Ok(Profiles {
        units: [table.unit(1).to_owned(), table.unit(2).to_owned()],
        cells: order.into_iter().map(profile).collect::<Result<_, _>>()?,
    })
}

fn check_rising(table: &Columns, rows: &[usize]) -> Result<(), ReportError> {
    for pair in rows.windows(2) {
        if table.number(pair[0], 1)? >= table.number(pair[1], 1)? {
            return Err(table.bad(pair[1], 1, "further out than the row before of its cell"));
        }
    }
    Ok(())
}

fn runs(table: &Columns, rows: &[usize], column: usize) -> Result<Runs, ReportError> {
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
