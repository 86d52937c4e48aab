//! Warnings of the cells of a run.

use std::collections::BTreeMap;

/// Lines that warn of cells, each once.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Warnings {
    /// First cell that each line is of, its place among the lines of that cell, and the number of its cells.
    lines: BTreeMap<String, (usize, usize, usize)>,
}

impl Warnings {
    /// Lines with the first cell that each is of, its place among the lines of that cell, and the number of its cells.
    pub fn entries(&self) -> impl Iterator<Item = (&str, (usize, usize, usize))> {
        let lines = self.lines.iter();
        lines.map(|(line, entry)| (line.as_str(), *entry))
    }

    /// Adds a line of this many cells.
    pub fn insert(&mut self, line: String, (cell, place, count): (usize, usize, usize)) {
        let entry = self.lines.entry(line).or_insert((cell, place, 0));
        *entry = match (entry.0, entry.1) <= (cell, place) {
            true => (entry.0, entry.1, entry.2 + count),
            false => (cell, place, entry.2 + count),
        };
    }

    /// Adds the lines of a cell.
    pub fn add(&mut self, cell: usize, lines: Vec<String>) {
        for (place, line) in lines.into_iter().enumerate() {
            self.insert(line, (cell, place, 1));
        }
    }

    /// Lines with words for their cells, among this many, in the order of the first cells.
    pub fn lines(&self, cells: usize) -> Vec<String> {
        let mut entries: Vec<_> = self.entries().collect();
        entries.sort_by_key(|&(_, (cell, place, _))| (cell, place));
        let words = |(line, (first, _, count)): (&str, (usize, usize, usize))| match (count, cells)
        {
            (_, 1) => line.to_owned(),
            (1, _) => format!("{line} (cell {first})"),
            (_, all) => format!("{line} ({count} of {all} cells, the first is {first})"),
        };
        entries.into_iter().map(words).collect()
    }
}
