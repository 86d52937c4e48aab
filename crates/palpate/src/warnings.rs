//! Warnings of a run, grouped by their codes.

use std::collections::BTreeMap;

use palpate_study::Warning;
use serde::{Deserialize, Serialize};

/// Warnings of cells: of each code the first, and the number of cells.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Warnings {
    by_code: BTreeMap<String, Group>,
}

/// Warnings of one code.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Group {
    /// Warning of the first cell.
    warning: Warning,
    /// The first cell, and the place among its warnings.
    first: (usize, usize),
    /// Number of cells.
    cells: usize,
}

impl Warnings {
    /// Adds the warnings of a cell. Of several with one code, only the first counts.
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

    /// Adds the warnings of other cells.
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

    /// One warning per code, in the order of the first cells. If there are several `cells`, it states which have it: the
    /// number of these cells and the first one.
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

/// Files with the warnings of a run, by their names: as lines, and as JSON. There are none without warnings.
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
