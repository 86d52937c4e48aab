//! Harnesses of palpate-assay that compare answers and intervals with references, each into a table of `results/`.

use anyhow::Result;
use clap::Args;
use xshell::{Shell, cmd};

use crate::programs;

#[derive(Args)]
#[command(disable_help_flag = true)]
pub(crate) struct Options {
    /// Options of the harness; --help lists them.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    options: Vec<String>,
}

/// Runs the harness with this name; its table has the same name. After a harness of intervals, the table of coverages for
/// `palpate check` is written again.
pub(crate) fn run(shell: &Shell, name: &str, options: &Options) -> Result<()> {
    harness(shell, name, &options.options)?;
    if !name.ends_with("intervals") {
        return Ok(());
    }
    let assay = programs::build(shell, "palpate-assay")?;
    let table = "crates/palpate/src/coverage/families.csv";
    Ok(cmd!(
        shell,
        "{assay} coverage-table --results results --out {table}"
    )
    .quiet()
    .run()?)
}

/// Step of CI: computes a part of the answers, in a few seconds.
pub(crate) fn check_answers(shell: &Shell) -> Result<()> {
    let table = programs::target_dir(shell).join("answers.csv");
    let table = table.display().to_string();
    let part = [
        "--seeds", "5", "--pairs", "100000", "--only", "cylinder", "--out", &table,
    ];
    harness(shell, "answers", &part.map(str::to_owned))
}

fn harness(shell: &Shell, name: &str, options: &[String]) -> Result<()> {
    let assay = programs::build(shell, "palpate-assay")?;
    let run = cmd!(
        shell,
        "{assay} {name} --out results/{name}.csv {options...}"
    );
    Ok(run.quiet().run()?)
}
