//! Tables of a study against the committed ones.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use anyhow::{Context, Result, bail};

/// The tables that are compared.
pub(crate) const TABLES: [&str; 2] = ["cells.csv", "failures.csv"];
/// First column that is no key, of either table.
const FIRST_VALUES: [&str; 2] = ["truth", "count"];
/// The key that both tables share.
const CELL: &str = "cell";
/// The mathematical functions of two machines differ by less.
const RELATIVE: f64 = 1e-9;
const ABSOLUTE: f64 = 1e-12;
/// Stands for a row or column that is not there.
const ABSENT: &str = "–";

/// One number or row that is not as it was.
#[derive(Debug, PartialEq)]
pub(crate) struct Difference {
    study: String,
    row: String,
    column: String,
    committed: String,
    now: String,
}

/// A table by its rows' keys.
#[derive(Debug)]
struct Table {
    keys: Vec<String>,
    values: Vec<String>,
    rows: BTreeMap<Vec<String>, Vec<String>>,
}

/// What differs in a study's tables; of a partial run only the cells that were run are compared.
pub(crate) fn study(
    name: &str,
    committed: &Path,
    now: &Path,
    partial: bool,
) -> Result<Vec<Difference>> {
    let mut differences = Vec::new();
    let mut cells_run = None;
    for table in TABLES {
        let mut old = Table::read(&committed.join(table))?;
        let new = Table::read(&now.join(table))?;
        if partial {
            let cells = cells_run.get_or_insert_with(|| new.cells());
            old.keep_cells(cells);
        }
        differences.extend(compare(&format!("{name}/{table}"), &old, &new));
    }
    if cells_run.is_some_and(|cells| cells.is_empty()) {
        bail!("{name}: no cell was run");
    }
    Ok(differences)
}

fn compare(study: &str, committed: &Table, now: &Table) -> Vec<Difference> {
    let difference = |row: &[String], column: &str, committed: &str, now: &str| Difference {
        study: study.to_owned(),
        row: row.join(" "),
        column: column.to_owned(),
        committed: committed.to_owned(),
        now: now.to_owned(),
    };
    let (old_header, new_header) = (committed.header(), now.header());
    if old_header != new_header {
        return vec![difference(&[], "header", &old_header, &new_header)];
    }
    let mut differences = Vec::new();
    for (key, old) in &committed.rows {
        let Some(new) = now.rows.get(key) else {
            differences.push(difference(key, "row", "present", ABSENT));
            continue;
        };
        for ((column, old), new) in committed.values.iter().zip(old).zip(new) {
            if !same(old, new) {
                differences.push(difference(key, column, old, new));
            }
        }
    }
    let added = now
        .rows
        .keys()
        .filter(|&key| !committed.rows.contains_key(key));
    differences.extend(added.map(|key| difference(key, "row", ABSENT, "present")));
    differences
}

/// Equal as texts, or near enough as numbers.
fn same(old: &str, new: &str) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= ABSOLUTE.max(RELATIVE * a.abs().max(b.abs()));
    old == new || matches!((old.parse(), new.parse()), (Ok(old), Ok(new)) if near(old, new))
}

impl Table {
    fn read(path: &Path) -> Result<Table> {
        let text = std::fs::read_to_string(path)
            .with_context(|| format!("cannot read {}", path.display()))?;
        Table::parse(&text).with_context(|| format!("{}", path.display()))
    }

    fn parse(text: &str) -> Result<Table> {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let mut keys: Vec<String> = reader.headers()?.iter().map(str::to_owned).collect();
        let first_value = keys
            .iter()
            .position(|name| FIRST_VALUES.contains(&name.as_str()));
        let Some(first_value) = first_value.filter(|_| keys.iter().any(|name| name == CELL)) else {
            bail!(
                "the header needs a column `{CELL}` and one of `{}`",
                FIRST_VALUES.join("`, `")
            );
        };
        let values = keys.split_off(first_value);
        let mut rows = BTreeMap::new();
        for record in reader.records() {
            let mut key: Vec<String> = record?.iter().map(str::to_owned).collect();
            let row = key.split_off(first_value);
            if rows.insert(key.clone(), row).is_some() {
                bail!("two rows `{}`", key.join(" "));
            }
        }
        Ok(Table { keys, values, rows })
    }

    fn header(&self) -> String {
        [&self.keys[..], &self.values].concat().join(",")
    }

    fn cell<'a>(&self, key: &'a [String]) -> Option<&'a String> {
        let column = self.keys.iter().position(|name| name == CELL)?;
        key.get(column)
    }

    fn cells(&self) -> BTreeSet<String> {
        self.rows
            .keys()
            .filter_map(|key| self.cell(key))
            .cloned()
            .collect()
    }

    fn keep_cells(&mut self, cells: &BTreeSet<String>) {
        let mut rows = std::mem::take(&mut self.rows);
        rows.retain(|key, _| self.cell(key).is_some_and(|cell| cells.contains(cell)));
        self.rows = rows;
    }
}

/// A table of at most `shown` differences.
pub(crate) fn render(differences: &[Difference], shown: usize) -> String {
    let header = ["study", "row", "column", "committed", "now"];
    let rows = differences
        .iter()
        .take(shown)
        .map(|d| [&d.study, &d.row, &d.column, &d.committed, &d.now]);
    let rows = rows.map(|row| row.map(String::as_str));
    let rows: Vec<[&str; 5]> = [header].into_iter().chain(rows).collect();
    let width = |column: usize| {
        rows.iter()
            .map(|row| row[column].chars().count())
            .max()
            .unwrap_or(0)
    };
    let widths = [0, 1, 2, 3, 4].map(width);
    let mut text = String::new();
    for row in &rows {
        let cells = row
            .iter()
            .zip(widths)
            .map(|(cell, width)| format!("{cell:width$}"));
        text += cells.collect::<Vec<_>>().join("  ").trim_end();
        text.push('\n');
    }
    if differences.len() > shown {
        text += &format!("… and {} more\n", differences.len() - shown);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    const CELLS: &str = "\
cell,radius_cm,quantity,unit,truth,trials,mean,q05
0,5,curvature,1/cm,0.2,100,0.2001,0.19
0,5,arc_length,cm,,100,1e-13,
7,50,curvature,1/cm,0.02,100,0.021,0.01
";

    fn differences(old: &str, new: &str) -> Vec<(String, String)> {
        let (old, new) = (Table::parse(old).unwrap(), Table::parse(new).unwrap());
        let found = compare("s", &old, &new).into_iter();
        found
            .map(|difference| (difference.row, difference.column))
            .collect()
    }

    fn pair(row: &str, column: &str) -> (String, String) {
        (row.to_owned(), column.to_owned())
    }

    #[test]
    fn the_order_of_rows_and_the_last_digits_do_not_matter() {
        let mut lines: Vec<&str> = CELLS.lines().collect();
        lines[1..].reverse();
        let other = lines
            .join("\n")
            .replace("0.2001,", "0.20010000000001,")
            .replace("1e-13", "-5e-13");
        assert_eq!(differences(CELLS, &other), []);
    }

    #[test]
    fn numbers_beyond_the_tolerance_differ_and_so_does_an_empty_one() {
        let other = CELLS
            .replace("0.2001,", "0.200100001,")
            .replace("1e-13,", "1e-13,0")
            .replace("0.021", "NaN");
        assert_eq!(
            differences(CELLS, &other),
            [
                pair("0 5 arc_length cm", "q05"),
                pair("0 5 curvature 1/cm", "mean"),
                pair("7 50 curvature 1/cm", "mean"),
            ]
        );
    }

    #[test]
    fn keys_are_texts() {
        let other = CELLS.replace("7,50,", "7,50.0,");
        assert_eq!(
            differences(CELLS, &other),
            [
                pair("7 50 curvature 1/cm", "row"),
                pair("7 50.0 curvature 1/cm", "row")
            ]
        );
    }

    #[test]
    fn a_changed_header_is_one_difference() {
        assert_eq!(
            differences(CELLS, &CELLS.replace("q05", "q5")),
            [pair("", "header")]
        );
    }

    #[test]
    fn tables_that_cannot_be_compared_are_refused() {
        for (table, message) in [
            ("cell,mean\n0,1\n", "needs a column"),
            ("quantity,truth\nx,1\n", "needs a column"),
            ("", "needs a column"),
            ("cell,truth\n0,1\n0,2\n", "two rows `0`"),
        ] {
            let error = Table::parse(table).unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }

    #[test]
    fn of_a_partial_run_only_its_cells_are_compared() {
        let directory = tempfile::tempdir().unwrap();
        let write = |side: &str, cells: &str, failures: &str| {
            let side = directory.path().join(side);
            std::fs::create_dir_all(&side).unwrap();
            std::fs::write(side.join("cells.csv"), cells).unwrap();
            std::fs::write(side.join("failures.csv"), failures).unwrap();
            side
        };
        let failures = "cell,kind,count,first_trial\n0,rank,2,5\n7,rank,1,9\n";
        let committed = write("committed", CELLS, failures);
        let keep = |text: &str| {
            let lines = text.lines().filter(|line| !line.starts_with('0'));
            lines.collect::<Vec<_>>().join("\n")
        };
        let now = write("now", &keep(CELLS), &keep(failures));
        assert_eq!(study("s", &committed, &now, true).unwrap(), []);
        assert_eq!(study("s", &committed, &now, false).unwrap().len(), 3);

        let worse = write("worse", &keep(CELLS), &keep(failures).replace("1,9", "2,9"));
        let found = study("s", &committed, &worse, true).unwrap();
        assert_eq!((found.len(), found[0].column.as_str()), (1, "count"));

        let empty = write("empty", CELLS.lines().next().unwrap(), failures);
        assert!(study("s", &committed, &empty, true).is_err());
    }

    #[test]
    fn the_rendered_table_is_aligned_and_cut() {
        let difference = |row: &str| Difference {
            study: "s/cells.csv".to_owned(),
            row: row.to_owned(),
            column: "mean".to_owned(),
            committed: "1".to_owned(),
            now: "2".to_owned(),
        };
        assert_eq!(
            render(&[difference("7 50"), difference("8"), difference("9")], 2),
            "study        row   column  committed  now\n\
             s/cells.csv  7 50  mean    1          2\n\
             s/cells.csv  8     mean    1          2\n\
             … and 1 more\n"
        );
    }
}
