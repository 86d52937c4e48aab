//! Compares instruction counts and errors with the committed baseline.
//!
//! Run times are not compared, because they vary too much; `cargo bench` reports them. This task also checks that the
//! changelog describes every change of an error.

use std::collections::BTreeSet;
use std::path::Path;

use anyhow::{Context, Result, bail};
use clap::Args;
use xshell::{Shell, cmd};

use crate::baseline::{self, Comparison, DIRECTORY, Limits};
use crate::peers::replace;
use crate::programs;
use crate::tools::has;

/// Limits for instruction counts. Instruction counts hardly vary between runs. The limit allows for changes that occur
/// if the linker arranges the code in another order.
pub(crate) const COST: Limits = Limits {
    what: "instructions",
    harness: "instructions",
    allowed: 0.03,
    floor: 0.0,
};
/// Limits for the errors of computed results. Errors below `floor`, about 20 times the relative rounding error of a
/// double, are not compared, because they depend on the mathematical library of the machine.
pub(crate) const ERROR: Limits = Limits {
    what: "error",
    harness: "accuracy",
    allowed: 0.01,
    floor: 5e-15,
};

#[derive(Args)]
pub(crate) struct Options {
    /// Replace the baseline by the measured numbers. If an error changes, describe the reason in CHANGELOG.md.
    #[arg(long)]
    pub(crate) accept: bool,
}

pub(crate) fn run(shell: &Shell, options: &Options) -> Result<()> {
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
            "{} not as in {DIRECTORY}; if this is intended, run `cargo xtask bench-check --accept` and commit",
            failed.join(" and ")
        );
    }
    Ok(())
}

/// Runs a test program of palpate-assay, compares its numbers with the baseline, and prints the numbers that differ.
fn compare(shell: &Shell, limits: &'static Limits) -> Result<Comparison> {
    let (assay, harness) = (programs::build(shell, "palpate-assay")?, limits.harness);
    let now = baseline::read(&cmd!(shell, "{assay} {harness}").quiet().read()?)?;
    let path = limits.path();
    let before = match shell.path_exists(&path) {
        true => baseline::read(&shell.read_file(&path)?)
            .with_context(|| format!("{path} is invalid"))?,
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
        require_changelog_line(shell)?;
    }
    shell.create_dir(DIRECTORY)?;
    for comparison in comparisons {
        let path = comparison.limits.path();
        let whole = shell.current_dir().join(Path::new(&path));
        replace(&whole, &comparison.to_csv()?)?;
        println!("{path} written");
    }
    Ok(())
}

const CHANGELOG: &str = "CHANGELOG.md";
/// Heading of the section of the changelog that must describe every change of an error.
const HEADING: &str = "### Numerical changes";

/// Fails unless the section "Numerical changes" of the changelog has a line that is not in the last commit.
fn require_changelog_line(shell: &Shell) -> Result<()> {
    let committed = cmd!(shell, "git show HEAD:{CHANGELOG}")
        .quiet()
        .ignore_stderr()
        .read();
    if has_new_line(&committed.unwrap_or_default(), &shell.read_file(CHANGELOG)?) {
        return Ok(());
    }
    bail!(
        "an error differs from the baseline, is new or is missing, but `{HEADING}` in {CHANGELOG} has no new line since the last \
         commit: describe there the change, its reason and its size, then accept"
    )
}

fn has_new_line(committed: &str, now: &str) -> bool {
    let known: BTreeSet<&str> = section(committed).collect();
    section(now).any(|line| !known.contains(line))
}

/// Lines of the changelog's section [`HEADING`], without empty lines.
fn section(text: &str) -> impl Iterator<Item = &str> {
    let below = text
        .lines()
        .skip_while(|line| line.trim_end() != HEADING)
        .skip(1);
    let lines = below.take_while(|line| !line.starts_with('#'));
    lines.map(str::trim).filter(|line| !line.is_empty())
}
