//! Harnesses that hold answers and intervals against the truth, each into a table of `results/`.

use anyhow::Result;
use clap::Args;
use xshell::{Shell, cmd};

use crate::palpate;

#[derive(Args)]
#[command(disable_help_flag = true)]
pub(crate) struct Options {
    /// Options of the harness, which lists them with --help.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    options: Vec<String>,
}

/// Runs the harness of this name, whose table has it too; what `palpate check` tells of intervals follows from the tables of
/// theirs.
pub(crate) fn run(shell: &Shell, name: &str, options: &Options) -> Result<()> {
    asked(shell, name, &options.options)?;
    if !name.ends_with("intervals") {
        return Ok(());
    }
    let assay = palpate::build(shell, "palpate-assay")?;
    let told = "crates/palpate/src/tested/table.csv";
    Ok(cmd!(shell, "{assay} tested --results results --out {told}")
        .quiet()
        .run()?)
}

/// The step of CI: a part that takes seconds.
pub(crate) fn check_answers(shell: &Shell) -> Result<()> {
    let table = palpate::target_dir(shell).join("answers.csv");
    let table = table.display().to_string();
    let part = [
        "--seeds", "5", "--pairs", "100000", "--only", "cylinder", "--out", &table,
    ];
    asked(shell, "answers", &part.map(str::to_owned))
}

fn asked(shell: &Shell, name: &str, options: &[String]) -> Result<()> {
    let assay = palpate::build(shell, "palpate-assay")?;
    let asked = cmd!(
        shell,
        "{assay} {name} --out results/{name}.csv {options...}"
    );
    Ok(asked.quiet().run()?)
}
