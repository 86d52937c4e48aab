//! Reproduces the results: runs the configs in `sim-configs/` and draws their plots.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Result, bail};
use clap::Args;
use xshell::{Shell, cmd};

use crate::{compare, programs};

/// With `--quick`, only every thirteenth cell of a study is run (option `--every-nth-cell` of `palpate run`).
const QUICK_STRIDE: usize = 13;
/// Largest number of printed differences from the committed tables.
const SHOWN: usize = 20;

#[derive(Args)]
pub(crate) struct Options {
    /// Names of configs in sim-configs/, without `.toml`. By default all configs that test a claim of the papers.
    #[arg(value_name = "STUDY")]
    pub(crate) studies: Vec<String>,
    /// Run all studies, including those that test no claim.
    #[arg(long, conflicts_with = "studies")]
    pub(crate) all: bool,
    /// Run only every thirteenth cell, and do not write to results/.
    #[arg(long)]
    pub(crate) quick: bool,
    /// Compare the results with the committed results instead of replacing them. Numbers must agree within 1e-9,
    /// quantiles within one bin of their histogram.
    #[arg(long)]
    pub(crate) check: bool,
}

pub(crate) fn run(shell: &Shell, options: &Options) -> Result<()> {
    chosen(&known_studies(shell)?, &options.studies)?;
    run_with(shell, &programs::build_alone(shell)?, options)
}

/// Runs studies with a program that is already built.
pub(crate) fn run_with(shell: &Shell, palpate: &Path, options: &Options) -> Result<()> {
    let start = Instant::now();
    let known = known_studies(shell)?;
    let studies = match options.studies.as_slice() {
        [] => known
            .iter()
            .filter(|study| options.all || scores_claims(shell, study))
            .cloned()
            .collect(),
        asked => chosen(&known, asked)?,
    };
    if options.check {
        check(shell, palpate, &studies, options.quick)?;
    } else {
        draw(shell, palpate, &studies, &known, options.quick)?;
    }
    println!("total: {:.1} s", start.elapsed().as_secs_f64());
    Ok(())
}

/// Runs the studies in `studies` and draws their plots. Then tests the claims of all studies that have results,
/// including results of earlier runs.
fn draw(
    shell: &Shell,
    palpate: &Path,
    studies: &[String],
    known: &[String],
    quick: bool,
) -> Result<()> {
    let results = match quick {
        true => programs::target_dir(shell).join("reproduce-quick"),
        false => PathBuf::from("results"),
    };
    for study in studies {
        let start = Instant::now();
        let out = results.join(study);
        // Remove the manifest of the last run. With the manifest, palpate would refuse to overwrite committed files
        // that changed after that run.
        shell.remove_path(out.join(compare::MANIFEST))?;
        simulate(shell, palpate, study, &out, quick)?;
        cmd!(shell, "{palpate} plot {out}")
            .quiet()
            .ignore_stdout()
            .run()?;
        println!("{study}: {:.1} s", start.elapsed().as_secs_f64());
    }
    let scored = known.iter().map(|study| results.join(study));
    let scored: Vec<PathBuf> = scored
        .filter(|directory| shell.path_exists(directory.join("cells.csv")))
        .collect();
    let page = results.join("index.html");
    let scored = &scored;
    for directory in scored {
        shell.remove_path(directory.join(compare::MANIFEST))?;
    }
    cmd!(shell, "{palpate} report {scored...} --out {page}")
        .quiet()
        .run()?;
    for directory in scored {
        shell.remove_path(directory.join(compare::MANIFEST))?;
    }
    Ok(())
}

/// Runs the studies in a temporary folder and compares their tables with the committed tables.
fn check(shell: &Shell, palpate: &Path, studies: &[String], quick: bool) -> Result<()> {
    let directory = tempfile::tempdir()?;
    let mut differences = Vec::new();
    for study in studies {
        let start = Instant::now();
        let committed = shell.current_dir().join("results").join(study);
        let now = directory.path().join(study);
        simulate(shell, palpate, study, &now, quick)?;
        let found = compare::study(study, &committed, &now, quick)?;
        let verdict = match found.len() {
            0 => "as committed".to_owned(),
            count => format!("{count} differences"),
        };
        println!("{study}: {verdict}, {:.1} s", start.elapsed().as_secs_f64());
        differences.extend(found);
    }
    if differences.is_empty() {
        return Ok(());
    }
    print!("{}", compare::render(&differences, SHOWN));
    bail!(
        "{} differences from results/; if they are intended, run `cargo xtask reproduce --all` and commit",
        differences.len()
    )
}

fn simulate(shell: &Shell, palpate: &Path, study: &str, out: &Path, quick: bool) -> Result<()> {
    let config = format!("sim-configs/{study}.toml");
    let stride = quick.then(|| ["--every-nth-cell".to_owned(), QUICK_STRIDE.to_string()]);
    let stride = stride.into_iter().flatten();
    // Ignore the standard output of the run: its warnings are also in warnings.txt.
    let run = cmd!(
        shell,
        "{palpate} run {config} --out {out} --quiet {stride...}"
    );
    Ok(run.quiet().ignore_stdout().run()?)
}

fn known_studies(shell: &Shell) -> Result<Vec<String>> {
    let configs = shell.read_dir("sim-configs")?.into_iter();
    let mut names: Vec<String> = configs
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "toml")
        })
        .filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned()))
        .collect();
    names.sort();
    Ok(names)
}

/// Whether the config of a study lists claims of the papers, which the tables of the study test.
fn scores_claims(shell: &Shell, study: &str) -> bool {
    let config = shell.read_file(format!("sim-configs/{study}.toml"));
    config.is_ok_and(|config| config.lines().any(|line| line.starts_with("claims =")))
}

/// Names of the studies to run: the names in `asked`. Returns an error if a name in `asked` is not in `known`.
fn chosen(known: &[String], asked: &[String]) -> Result<Vec<String>> {
    if let Some(name) = asked.iter().find(|name| !known.contains(name)) {
        bail!(
            "no study `{name}` in sim-configs/; known:\n  {}",
            known.join("\n  ")
        );
    }
    Ok(asked.to_vec())
}
