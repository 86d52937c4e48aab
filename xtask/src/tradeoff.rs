//! Measures the error and the cost of all contact models, draws figures of them into `results/tradeoff/`, and checks
//! the choices of `auto` (`promise.csv`).

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result};
use clap::Args;
use xshell::{Shell, cmd};

use crate::{programs, tools};

const RESULTS: &str = "results/tradeoff";
/// File name of the table that compares the models that `auto` chose with all other models.
const AUTO_CHECK: &str = "promise.csv";

#[derive(Args)]
pub(crate) struct Options {
    /// Measure only briefly, and write into the target directory instead of results/.
    #[arg(long)]
    quick: bool,
    /// Only draw the figures again from the committed tables, without measuring.
    #[arg(long, conflicts_with = "quick")]
    draw: bool,
}

pub(crate) fn run(shell: &Shell, options: &Options) -> Result<()> {
    let start = Instant::now();
    let assay = programs::build(shell, "palpate-assay")?;
    if options.draw {
        cmd!(shell, "{assay} pareto-fronts {RESULTS}")
            .quiet()
            .run()?;
        return Ok(());
    }
    let out = match options.quick {
        true => programs::target_dir(shell).join("tradeoff-quick"),
        false => shell.current_dir().join(RESULTS),
    };
    let parent = out.parent().context("the results have no parent folder")?;
    shell.create_dir(parent)?;
    // Write the new tables into a folder beside the old one, so that renaming the folder replaces all tables at once.
    let temporary = tempfile::tempdir_in(parent)?;
    let fresh = temporary.path().join("tradeoff");
    measure(shell, &assay, &fresh, options.quick)?;
    cmd!(shell, "{assay} pareto-fronts {fresh}")
        .quiet()
        .ignore_stdout()
        .run()?;
    let checked = check_auto(shell, &assay, &fresh.join(AUTO_CHECK));
    keep(AUTO_CHECK, &fresh, &out)?;
    replace(&fresh, &out)?;
    // If the check of `auto` failed, return its error only now, when all tables are in their place.
    checked?;
    println!(
        "{}: {:.1} s; `cargo xtask reproduce` adds it to the page",
        out.display(),
        start.elapsed().as_secs_f64()
    );
    Ok(())
}

/// Measures the models on the last processor core. If the program taskset is missing, the models are measured on any
/// core.
fn measure(shell: &Shell, assay: &Path, out: &Path, quick: bool) -> Result<()> {
    let machine = programs::machine(shell);
    let quick = quick.then_some("--quick");
    let cores = std::thread::available_parallelism()?.get();
    let last = (cores - 1).to_string();
    let pinned = cmd!(shell, "taskset --cpu-list {last} true")
        .quiet()
        .ignore_stderr()
        .run();
    match pinned {
        Ok(()) => cmd!(
            shell,
            "taskset --cpu-list {last} {assay} tradeoff --out {out} --machine {machine} {quick...}"
        ),
        Err(_) => cmd!(
            shell,
            "{assay} tradeoff --out {out} --machine {machine} {quick...}"
        ),
    }
    .quiet()
    .run()?;
    Ok(())
}

/// Checks the models that `auto` chooses. The error of a chosen model must be within the tolerance. Its number of
/// processor instructions must be at most twice that of the cheapest model within the tolerance.
fn check_auto(shell: &Shell, assay: &Path, table: &Path) -> Result<()> {
    if !tools::has(shell, "valgrind") {
        println!("valgrind is missing: `auto` is not checked, and {AUTO_CHECK} stays as it was");
        return Ok(());
    }
    cmd!(shell, "{assay} auto-check --out {table}")
        .quiet()
        .run()?;
    Ok(())
}

/// Copies the file `name` from the old folder `out` to the new folder `fresh`, unless `fresh` already contains this
/// file.
fn keep(name: &str, fresh: &Path, out: &Path) -> Result<()> {
    let (missing, known) = (fresh.join(name), out.join(name));
    if !missing.exists() && known.exists() {
        std::fs::copy(&known, &missing)
            .with_context(|| format!("cannot copy {}", known.display()))?;
    }
    Ok(())
}

/// Replaces the folder `out` by the folder `fresh`. The old folder is moved into the parent of `fresh`, which is
/// temporary.
fn replace(fresh: &Path, out: &Path) -> Result<()> {
    if out.exists() {
        std::fs::rename(out, fresh.with_file_name("replaced"))
            .with_context(|| format!("cannot replace {}", out.display()))?;
    }
    std::fs::rename(fresh, out)
        .with_context(|| format!("cannot rename {} to {}", fresh.display(), out.display()))
}
