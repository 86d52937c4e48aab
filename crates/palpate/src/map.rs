//! Maps of the first trial of cells.

use palpate_scene::Scene;
use palpate_scene::glide::MapTable;
use palpate_scene::press::ProfileTable;
use palpate_study::Table;
use palpate_study::config::LengthUnit;

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
#[derive(Debug)]
pub(crate) struct CellMap {
    cell: usize,
    csv: String,
    lacks: &'static str,
    failed: Option<&'static str>,
}

impl CellMap {
    pub(crate) fn of(scene: &Scene, cell: usize, unit: LengthUnit) -> Self {
        let (csv, lacks, failed) = match scene {
            Scene::Roll(_) | Scene::Fingertip(_) => (String::new(), "cells", None),
            Scene::Glide(glide) => {
                let mut map = MapTable::of_cells(unit);
                let failed = glide.map(cell, 0, &mut map).err().map(|error| error.name());
                (map.into_csv(), "cells", failed)
            }
            Scene::Press(press) => {
                let mut profile = ProfileTable::of_cells(unit);
                let failed = press.profile(cell, 0, &mut profile).err();
                let failed = failed.map(|error| error.name());
                (profile.into_csv(), "estimates of cells", failed)
            }
        };
        Self {
            cell,
            csv,
            lacks,
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
