//! Compares the files of a study that was run again with the committed files.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};

const CELLS: &str = "cells.csv";
/// Table of scores. It is not compared, because `palpate report` writes it, not `palpate run`.
const SCORED: &str = "claims.csv";
/// File in which palpate lists the files that it wrote. It is not committed.
pub(crate) const MANIFEST: &str = ".palpate.toml";
/// Column with the number of the cell (grid point). If only some cells were run, this column shows which committed rows
/// must be compared.
const CELL: &str = "cell";
/// Relative tolerance for the comparison of numbers. Results differ slightly between C libraries and processors.
const TOLERANCE: f64 = 1e-9;
/// Two numbers below this magnitude agree if they differ by at most `TOLERANCE * SMALL`.
const SMALL: f64 = 1e-3;
/// Statistics that are computed from a histogram.
const QUANTILES: [&str; 3] = ["q05", "q50", "q95"];
/// Tolerance of the statistics in [`QUANTILES`]: the width of a histogram bin, relative to the distance between the
/// quantile and the true value.
const BIN: f64 = 0.008;
/// Text in [`Difference::now`] if the new file is missing.
const ABSENT: &str = "–";

/// A difference between the committed and the new version of a file: another number or text in a table, other rows,
/// another config, or a missing file.
#[derive(Debug, PartialEq)]
pub(crate) struct Difference {
    file: String,
    /// The first fields (at most 4) of the row with the difference; they identify the row. Empty if the whole file
    /// differs.
    row: String,
    column: String,
    committed: String,
    now: String,
}

impl Difference {
    /// Absolute difference of the old and the new number, divided by the larger magnitude; `None` for texts.
    fn relative(&self) -> Option<f64> {
        let (old, new): (f64, f64) = (self.committed.parse().ok()?, self.now.parse().ok()?);
        Some((old - new).abs() / old.abs().max(new.abs()))
    }
}

/// Whether the committed row `old` and the new row `new` agree in the column with the index `place`. Differences that
/// are normal between machines are ignored.
fn is_alike(header: &[String], place: usize, old: &[String], new: &[String]) -> bool {
    let number = |text: &String| text.parse::<f64>().ok();
    let (Some(then), Some(now)) = (number(&old[place]), number(&new[place])) else {
        return old[place] == new[place];
    };
    if old[place] == new[place] {
        return true;
    }
    let truth = header.iter().position(|name| name == "truth");
    let truth = truth.and_then(|place| number(&old[place]));
    let bin = match truth.filter(|_| QUANTILES.contains(&&*header[place])) {
        Some(truth) => BIN * (then - truth).abs().max((now - truth).abs()),
        None => 0.0,
    };
    (then - now).abs() <= bin + TOLERANCE * then.abs().max(now.abs()).max(SMALL)
}

/// Differences between the tables and configs of a study and the committed files. Differences that are normal between
/// machines are ignored. If only some cells were run, only these cells are compared.
pub(crate) fn study(
    name: &str,
    committed: &Path,
    now: &Path,
    partial: bool,
) -> Result<Vec<Difference>> {
    let cells = match partial {
        true => Some(cells_run(now).with_context(|| name.to_owned())?),
        false => None,
    };
    let mut differences = Vec::new();
    for file in texts(committed)?.union(&texts(now)?) {
        let path = committed.join(file);
        let old = fs::read_to_string(&path).with_context(|| {
            let path = path.display();
            format!("cannot read {path}; make it with `cargo xtask reproduce {name}` and commit it")
        })?;
        let label = format!("{name}/{file}");
        match fs::read_to_string(now.join(file)) {
            Ok(new) => differences.extend(
                compare(&label, &old, &new, cells.as_ref()).with_context(|| label.clone())?,
            ),
            Err(_) => differences.push(Difference {
                file: label,
                row: String::new(),
                column: "file".to_owned(),
                committed: "present".to_owned(),
                now: ABSENT.to_owned(),
            }),
        }
    }
    Ok(differences)
}

/// Numbers of the cells that a run contains, from its `cells.csv`.
fn cells_run(folder: &Path) -> Result<BTreeSet<String>> {
    let (header, rows) = table(&fs::read_to_string(folder.join(CELLS))?)?;
    let place = header.iter().position(|name| name == CELL);
    let place = place.with_context(|| format!("{CELLS} has no column {CELL}"))?;
    let cells: BTreeSet<String> = rows
        .into_iter()
        .map(|mut row| row.swap_remove(place))
        .collect();
    match cells.is_empty() {
        true => bail!("no cell was run"),
        false => Ok(cells),
    }
}

/// Names of the tables and configs in a folder, without the files that `palpate report` writes.
fn texts(folder: &Path) -> Result<BTreeSet<String>> {
    let names = fs::read_dir(folder)?.map(|entry| Ok(entry?.file_name().into_string().ok()));
    let names: Vec<Option<String>> = names.collect::<Result<_>>()?;
    let is_text = |name: &String| {
        (name.ends_with(".csv") || name.ends_with(".toml")) && name != SCORED && name != MANIFEST
    };
    Ok(names.into_iter().flatten().filter(is_text).collect())
}

/// Differences between two versions of a file. If `cells` is given, only the rows of these cells are compared.
fn compare(
    file: &str,
    committed: &str,
    now: &str,
    cells: Option<&BTreeSet<String>>,
) -> Result<Vec<Difference>> {
    let difference = |row: &[String], column: &str, committed: &str, now: &str| Difference {
        file: file.to_owned(),
        row: row.join(" "),
        column: column.to_owned(),
        committed: committed.to_owned(),
        now: now.to_owned(),
    };
    if committed == now {
        return Ok(Vec::new());
    }
    if !file.ends_with(".csv") {
        return Ok(vec![difference(&[], "text", "as committed", "different")]);
    }
    let (header, mut old) = table(committed)?;
    let (new_header, new) = table(now)?;
    if header != new_header {
        let (old, new) = (header.join(","), new_header.join(","));
        return Ok(vec![difference(&[], "header", &old, &new)]);
    }
    if let (Some(cells), Some(place)) = (cells, header.iter().position(|name| name == CELL)) {
        old.retain(|row| cells.contains(&row[place]));
    }
    if old.len() != new.len() {
        let lengths = [&old, &new].map(|rows| format!("{} rows", rows.len()));
        return Ok(vec![difference(&[], "rows", &lengths[0], &lengths[1])]);
    }
    let mut differences = Vec::new();
    for (old, new) in old.iter().zip(&new) {
        let unlike = (0..header.len()).filter(|&place| !is_alike(&header, place, old, new));
        differences.extend(unlike.map(|place| {
            difference(
                &old[..place.min(4)],
                &header[place],
                &old[place],
                &new[place],
            )
        }));
    }
    Ok(differences)
}

type Row = Vec<String>;

/// Header and rows of a CSV table. Fails unless all rows have the same length.
fn table(text: &str) -> Result<(Row, Vec<Row>)> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let owned = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect::<Row>();
    let header = owned(reader.headers()?);
    if header.is_empty() {
        bail!("has no header");
    }
    let rows = reader.records().map(|record| Ok(owned(&record?)));
    Ok((header, rows.collect::<Result<_>>()?))
}

/// Text with the number of differences and the largest difference. The text lists at most `shown` differences.
pub(crate) fn render(differences: &[Difference], shown: usize) -> String {
    let relative: Vec<f64> = differences
        .iter()
        .filter_map(Difference::relative)
        .collect();
    let largest = relative.iter().copied().fold(0.0, f64::max);
    let others = differences.len() - relative.len();
    let mut text = format!(
        "{} numbers differ, the most by {largest:.1e} of the larger; {others} texts or rows differ\n",
        relative.len()
    );
    for one in differences.iter().take(shown) {
        text += &format!(
            "{}, {}, {}: {} committed, {} now\n",
            one.file, one.row, one.column, one.committed, one.now
        );
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
cell,radius,quantity,truth,mean
0,5,curvature,0.2,0.2001
0,5,length,1,1e-13
7,50,curvature,0.02,0.021
";

    fn found(old: &str, new: &str, cells: &[&str]) -> Vec<(String, String)> {
        let cells: BTreeSet<String> = cells.iter().map(ToString::to_string).collect();
        let cells = (!cells.is_empty()).then_some(&cells);
        let found = compare("s/cells.csv", old, new, cells).unwrap().into_iter();
        found
            .map(|difference| (difference.row, difference.column))
            .collect()
    }

    fn pair(row: &str, column: &str) -> (String, String) {
        (row.to_owned(), column.to_owned())
    }

    #[test]
    fn last_digits_and_bins_of_quantiles_may_differ() {
        assert_eq!(found(CELLS, CELLS, &[]), []);
        let digits = CELLS
            .replace("0.2001", "0.20010000000001")
            .replace("1e-13", "-5e-13");
        assert_eq!(found(CELLS, &digits, &[]), []);
        for other in ["0.200100001", "NaN", ""] {
            assert_eq!(
                found(CELLS, &CELLS.replace("0.2001", other), &[]),
                [pair("0 5 curvature 0.2", "mean")]
            );
        }
        let quantiles = CELLS.replace("mean", "q05");
        let bin = quantiles.replace("0.021", "0.021007");
        assert_eq!(found(&quantiles, &bin, &[]), []);
        let bins = quantiles.replace("0.021", "0.02101");
        assert_eq!(
            found(&quantiles, &bins, &[]),
            [pair("7 50 curvature 0.02", "q05")]
        );
        let renamed = CELLS.replace("mean", "median");
        assert_eq!(found(CELLS, &renamed, &[]), [pair("", "header")]);
        let fewer = CELLS.replace("7,50,curvature,0.02,0.021\n", "");
        assert_eq!(found(CELLS, &fewer, &[]), [pair("", "rows")]);
        assert_eq!(found(&fewer, CELLS, &[]), [pair("", "rows")]);
        assert_eq!(compare("s/run.toml", "a", "b", None).unwrap().len(), 1);
    }

    #[test]
    fn only_the_cells_of_a_partial_run_are_compared() {
        let ran = "cell,radius,quantity,truth,mean\n7,50,curvature,0.02,0.021\n";
        assert_eq!(found(CELLS, ran, &["7"]), []);
        assert_eq!(
            found(CELLS, &ran.replace("0.021", "0.022"), &["7"]).len(),
            1
        );
        assert_ne!(found(CELLS, ran, &[]), []);
        // Cell 0 was run, but the table has no rows of it, so the comparison must report the rows.
        assert_eq!(found(CELLS, ran, &["0", "7"]), [pair("", "rows")]);
    }

    #[test]
    fn missing_files_and_runs_without_cells_are_noticed() {
        let folders = [(); 2].map(|()| tempfile::tempdir().unwrap());
        let [old, new] = folders.each_ref().map(|folder| folder.path());
        for name in ["cells.csv", "map.csv", "claims.csv"] {
            fs::write(old.join(name), CELLS).unwrap();
        }
        fs::write(new.join("cells.csv"), CELLS).unwrap();
        let missing = study("s", old, new, true).unwrap();
        assert_eq!(missing.len(), 1);
        assert_eq!(
            (missing[0].file.as_str(), missing[0].column.as_str()),
            ("s/map.csv", "file")
        );
        fs::write(new.join("cells.csv"), "cell,mean\n").unwrap();
        let error = study("s", old, new, true).unwrap_err();
        assert!(
            format!("{error:#}").contains("no cell was run"),
            "{error:#}"
        );
        fs::remove_file(old.join("cells.csv")).unwrap();
        let error = study("s", old, new, false).unwrap_err().to_string();
        assert!(error.contains("cargo xtask reproduce s"), "{error}");
    }
}
