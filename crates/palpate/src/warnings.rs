//! Warnings of a run, grouped by code.

use std::collections::BTreeMap;

use palpate_study::Warning;
use serde::{Deserialize, Serialize};

/// Warnings of many cells. For each warning code, only the first warning and the number of cells are stored.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Warnings {
    by_code: BTreeMap<String, Group>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Group {
    warning: Warning,
    /// Number of the first cell with this warning, and index of the warning among the warnings of this cell.
    first: (usize, usize),
    cells: usize,
}

impl Warnings {
    /// Adds the warnings of a cell. If several warnings of the cell have the same code, only the first one is used.
    pub fn add(&mut self, cell: usize, warnings: &[Warning]) {
        for (place, warning) in warnings.iter().enumerate() {
            if warnings[..place]
                .iter()
                .all(|other| other.code != warning.code)
            {
                self.insert(Group {
                    warning: warning.clone(),
                    first: (cell, place),
                    cells: 1,
                });
            }
        }
    }

    /// Adds warnings that were collected from other cells.
    pub fn merge(&mut self, other: Self) {
        other
            .by_code
            .into_values()
            .for_each(|group| self.insert(group));
    }

    fn insert(&mut self, group: Group) {
        let empty = || Group {
            cells: 0,
            ..group.clone()
        };
        let known = self
            .by_code
            .entry(group.warning.code.clone())
            .or_insert_with(empty);
        let cells = known.cells + group.cells;
        if group.first < known.first {
            *known = group;
        }
        known.cells = cells;
    }

    /// One warning for each code, sorted by the first cell with this code. If `cells` is larger than 1, the text of
    /// each warning also states two numbers: how many cells have the warning, and the number of the first of these
    /// cells.
    pub fn grouped(&self, cells: usize) -> Vec<Warning> {
        let mut groups: Vec<&Group> = self.by_code.values().collect();
        groups.sort_by_key(|group| group.first);
        let stated = |group: &Group| {
            let (mut warning, (first, _)) = (group.warning.clone(), group.first);
            warning.text += &match (group.cells, cells) {
                (_, 1) => return warning,
                (1, _) => format!(" (cell {first})"),
                (count, all) => format!(" ({count} of {all} cells, the first is {first})"),
            };
            for (name, number) in [("cells", group.cells), ("first_cell", first)] {
                warning.numbers.insert(name.to_owned(), number as f64);
            }
            warning
        };
        groups.into_iter().map(stated).collect()
    }
}

/// File names and contents of the warnings of a run: a file with lines of text, and a JSON file. Empty if there are no
/// warnings.
pub fn warning_files(warnings: &[Warning]) -> Vec<(&'static str, String)> {
    if warnings.is_empty() {
        return Vec::new();
    }
    let lines: String = warnings
        .iter()
        .map(|warning| format!("{warning}\n"))
        .collect();
    let json = serde_json::to_string_pretty(warnings);
    let json = json.expect("texts and numbers have a JSON form");
    vec![("warnings.txt", lines), ("warnings.json", json + "\n")]
}
