//! Maps of the first trial of cells.

use palpate_scene::{MapTable, Scene};
use palpate_study::Table;

/// Maps, or profiles, of the first trial of every cell.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Map {
    /// Rows of all of them.
    pub table: Table,
    /// Name of what may be missing in it: "cells" or "estimates of cells".
    pub lacks: &'static str,
    /// Numbers of the cells whose trial 0 failed, and the stable name of how.
    pub failed: Vec<(usize, &'static str)>,
}

/// Map of the first trial of a cell.
#[derive(Debug, Default)]
pub(crate) struct CellMap {
    cell: usize,
    csv: String,
    lacks: &'static str,
    failed: Option<&'static str>,
}

impl CellMap {
    /// Map of a scene, from an empty table if it has one.
    pub(crate) fn of(scene: &Scene, cell: usize, table: &Result<MapTable, &str>) -> Self {
        let Ok(mut table) = table.clone() else {
            return Self::default();
        };
        let failed = scene.map(cell, 0, &mut table).err();
        Self {
            cell,
            lacks: table.lacks,
            csv: table.into_csv(),
            failed,
        }
    }
}

impl Map {
    /// Map of cells that share a table.
    pub(crate) fn of_cells(cells: impl Iterator<Item = CellMap>) -> Self {
        let fields = |line: &str| line.split(',').map(str::to_owned).collect();
        let mut map = Self::default();
        for cell in cells {
            // No field of a map is quoted.
            let mut lines = cell.csv.lines();
            map.table.header = lines.next().map(fields).unwrap_or_default();
            map.table.rows.extend(lines.map(fields));
            map.lacks = cell.lacks;
            map.failed.extend(cell.failed.map(|name| (cell.cell, name)));
        }
        map
    }
}
