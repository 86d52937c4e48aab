//! Instruction counts and accuracy against the committed baseline.
//!
//! Wall time is no part of it: it is only reported, by `cargo bench`; see crates/assay/BENCHES.md.

mod baseline;
mod benches;
mod changelog;

use std::path::Path;

use anyhow::{Context, Result, bail};
use clap::Args;
use xshell::{Shell, cmd};

use crate::palpate;
use crate::peers::replace;
use crate::tools::has;
use baseline::{Comparison, Limits};

const DIRECTORY: &str = "crates/assay/baseline";

/// Counts hardly scatter, but depend on where the linker puts what.
const COST: Limits = Limits {
    what: "instructions",
    harness: "instructions",
    allowed: 0.03,
    floor: 0.0,
};
/// Below 20 roundings, every mathematical library rounds its own way.
const ERROR: Limits = Limits {
    what: "error",
    harness: "accuracy",
    allowed: 0.01,
    floor: 5e-15,
};

#[derive(Args)]
pub(crate) struct Options {
    /// Take what is measured as the baseline; where an error changes, CHANGELOG.md must say why.
    #[arg(long)]
    pub(crate) accept: bool,
}

pub(crate) fn run(shell: &Shell, options: &Options) -> Result<()> {
    benches::check(shell)?;
    let mut comparisons = vec![compare(shell, &ERROR)?];
    match has(shell, "valgrind") {
        true => comparisons.push(compare(shell, &COST)?),
        false => println!("instructions are not compared: valgrind is missing"),
    }
    if options.accept {
        return accept(shell, &comparisons);
    }
    let failed = comparisons.iter().filter(|one| one.fails());
    let failed: Vec<&str> = failed.map(|one| one.limits.what).collect();
    if !failed.is_empty() {
        bail!(
            "{} not as in {DIRECTORY}; if that is meant, run `cargo xtask bench-check --accept` and commit",
            failed.join(" and ")
        );
    }
    Ok(())
}

/// Runs a harness of palpate-assay, compares its figures with the baseline and prints those that differ.
fn compare(shell: &Shell, limits: &'static Limits) -> Result<Comparison> {
    let (assay, harness) = (palpate::build(shell, "palpate-assay")?, limits.harness);
    let now = baseline::read(&cmd!(shell, "{assay} {harness}").quiet().read()?)?;
    let path = limits.path();
    let before = match shell.path_exists(&path) {
        true => baseline::read(&shell.read_file(&path)?)
            .with_context(|| format!("{path} is unsound"))?,
        false => Vec::new(),
    };
    let comparison = Comparison {
        limits,
        before,
        now,
    };
    print!("{}", comparison.render());
    Ok(comparison)
}

fn accept(shell: &Shell, comparisons: &[Comparison]) -> Result<()> {
    let is_error = |one: &&Comparison| one.limits.what == ERROR.what;
    if comparisons.iter().filter(is_error).any(Comparison::alters) {
        changelog::demand_line(shell)?;
    }
    shell.create_dir(DIRECTORY)?;
    for comparison in comparisons {
        let path = comparison.limits.path();
        let whole = shell.current_dir().join(Path::new(&path));
        replace(&whole, &comparison.to_csv()?)?;
        println!("{path} is written");
    }
    Ok(())
}
