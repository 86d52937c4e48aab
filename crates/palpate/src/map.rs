//! Maps of the first trial of cells.

use palpate_scene::Scene;
use palpate_study::MapTable;
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
#[derive(Clone, Debug)]
pub(crate) struct CellMap {
    cell: usize,
    table: MapTable,
    pub(crate) failed: Option<&'static str>,
}

impl CellMap {
    /// Map of a scene, in an empty table for scenes of its kind.
    pub(crate) fn of(scene: &Scene, cell: usize, mut table: MapTable) -> Self {
        let failed = scene.map(cell, 0, &mut table).err();
        Self {
            cell,
            table,
            failed,
        }
    }

    /// Rows of its table as CSV text.
    pub(crate) fn rows(&self) -> String {
        self.table.table.rows_to_csv()
    }
}

impl Map {
    /// Map of cells that share a table.
    pub(crate) fn of_cells(cells: impl Iterator<Item = CellMap>) -> Self {
        let mut map = Self::default();
        for CellMap {
            cell,
            table: MapTable { table, lacks, .. },
            failed,
        } in cells
        {
            map.table.header = table.header;
            map.table.rows.extend(table.rows);
            map.lacks = lacks;
            map.failed.extend(failed.map(|name| (cell, name)));
        }
        map
    }
}
