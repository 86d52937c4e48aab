//! Every public entry point at its extremes: tables that tests write, collected into results/extremes.csv.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use clap::Args;
use xshell::{Shell, cmd};

use crate::palpate::{FEATURES, PYTHON, target_dir};

/// Environment variable by which `palpate_verdict` is told where to write its tables.
pub(crate) const FOLDER: &str = "PALPATE_EXTREMES";
const COMMITTED: &str = "results/extremes.csv";
/// Crates whose tests write tables, in the order of their rows.
const CRATES: [&str; 11] = [
    "palpate-geometry",
    "palpate-rolling",
    "palpate-sensing",
    "palpate-ep1",
    "palpate-ep2",
    "palpate-press",
    "palpate-chromatouch",
    "palpate-tracking",
    "palpate-scene",
    "palpate-sweep",
    "palpate-chance",
];
/// Rows that are printed where tables differ.
const SHOWN: usize = 20;

#[derive(Args)]
pub(crate) struct Options {
    /// The table to write.
    #[arg(long, default_value = COMMITTED)]
    out: PathBuf,
    /// Compare with the committed table instead of writing one.
    #[arg(long, conflicts_with = "out")]
    check: bool,
}

/// Runs the tests; fails if a row breaks a promise, after the table is written.
pub(crate) fn run(shell: &Shell, options: &Options) -> Result<()> {
    let folder = empty_folder(shell)?;
    let tests = cmd!(
        shell,
        "cargo test --quiet --no-fail-fast --workspace --exclude {PYTHON} --features {FEATURES} --test it extremes::"
    );
    let tested = tests.env(FOLDER, folder).run();
    if options.check {
        tested?;
        return check(shell);
    }
    let table = collected(shell)?;
    shell.write_file(&options.out, &table)?;
    println!("{}", summary(&table));
    Ok(tested?)
}

/// Empties the folder that tests are to write their tables to, and names it.
pub(crate) fn empty_folder(shell: &Shell) -> Result<PathBuf> {
    let folder = folder(shell);
    shell.remove_path(&folder)?;
    Ok(shell.create_dir(folder)?)
}

/// Compares the tables that tests have written with the committed one.
pub(crate) fn check(shell: &Shell) -> Result<()> {
    let committed = shell.read_file(COMMITTED)?;
    let table = collected(shell)?;
    let differences = differences(&committed, &table);
    for difference in differences.iter().take(SHOWN) {
        println!("{difference}");
    }
    ensure!(
        differences.is_empty(),
        "{} rows differ from {COMMITTED}; if they are meant, run `cargo xtask extremes` and commit",
        differences.len()
    );
    println!("extremes as committed: {}", summary(&table));
    Ok(())
}

fn folder(shell: &Shell) -> PathBuf {
    target_dir(shell).join("extremes")
}

/// All tables in one, those of a crate in the order of their names.
fn collected(shell: &Shell) -> Result<String> {
    let mut lines: Vec<String> = Vec::new();
    for name in CRATES {
        let tables = shell.read_dir(folder(shell).join(name));
        for path in tables.with_context(|| format!("the tests of {name} wrote no table"))? {
            let table = shell.read_file(path)?;
            let is_first = lines.is_empty();
            lines.extend(
                table
                    .lines()
                    .skip(usize::from(!is_first))
                    .map(str::to_owned),
            );
        }
    }
    Ok(lines.join("\n") + "\n")
}

/// Number of the rows, and of those of each verdict.
fn summary(table: &str) -> String {
    let mut verdicts = BTreeMap::<&str, usize>::new();
    let rows = table.lines().skip(1);
    for verdict in rows.filter_map(|row| row.rsplit(',').next()) {
        *verdicts.entry(verdict).or_default() += 1;
    }
    let counts = verdicts.iter();
    let counts = counts.map(|(verdict, count)| format!("{count} {verdict}"));
    let cases: usize = verdicts.values().sum();
    format!("{cases} cases: {}", counts.collect::<Vec<_>>().join(", "))
}

/// Rows of one table that the other has not, each after a sign.
fn differences(committed: &str, now: &str) -> Vec<String> {
    let [old, new] = [committed, now].map(|table| table.lines().collect::<BTreeSet<_>>());
    let gone = old.difference(&new).map(|row| format!("- {row}"));
    let come = new.difference(&old).map(|row| format!("+ {row}"));
    let mut differences: Vec<String> = gone.chain(come).collect();
    if differences.is_empty() && committed != now {
        differences.push("the same rows in another order, or more than once".to_owned());
    }
    differences
}

#[cfg(test)]
mod tests {
    use super::{differences, summary};

    #[test]
    fn verdicts_are_counted() {
        let table = "entry,input,verdict\na,\"1, 2\",finite\na,2,refused\nb,3,finite\n";
        assert_eq!(summary(table), "3 cases: 2 finite, 1 refused");
    }

    #[test]
    fn rows_that_differ_are_named() {
        let table = "entry,input\na,1\nb,2\n";
        assert!(differences(table, table).is_empty());
        let other = differences(table, "entry,input\na,1\nb,3\n");
        assert_eq!(other, ["- b,2", "+ b,3"]);
        for same_rows in ["entry,input\nb,2\na,1\n", "entry,input\na,1\na,1\nb,2\n"] {
            assert_eq!(differences(table, same_rows).len(), 1);
        }
    }
}
