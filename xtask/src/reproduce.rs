//! Study → figure: every config in `sim-configs/` to its results.

use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Result, bail};
use clap::Args;
use xshell::{Shell, cmd};

use crate::{compare, palpate};

/// Every how many cells `--quick` runs one.
const QUICK_STRIDE: usize = 13;
/// Differences that are printed.
const SHOWN: usize = 20;

#[derive(Args)]
pub(crate) struct Options {
    /// Names of configs in sim-configs/, without `.toml`; all of them by default.
    #[arg(value_name = "STUDY")]
    pub(crate) studies: Vec<String>,
    /// Run only every thirteenth cell; never written to results/.
    #[arg(long)]
    pub(crate) quick: bool,
    /// Compare with the committed results, byte for byte, instead of replacing them.
    #[arg(long)]
    pub(crate) check: bool,
    /// Relative difference of numbers that --check allows, for hosts on which bytes are not promised, such as 1e-9; below
    /// 0.001 that share of 0.001.
    #[arg(long, value_name = "SHARE", requires = "check", value_parser = share)]
    pub(crate) tolerance: Option<f64>,
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(share) if (0.0..1.0).contains(&share) => Ok(share),
        _ => Err("a number from 0 to 1, such as 1e-9".to_owned()),
    }
}

/// A study was asked for that has no config.
#[derive(Debug)]
pub(crate) struct UnknownStudy {
    name: String,
    known: Vec<String>,
}

impl fmt::Display for UnknownStudy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no study `{}` in sim-configs/; known:", self.name)?;
        self.known
            .iter()
            .try_for_each(|known| write!(f, "\n  {known}"))
    }
}

impl std::error::Error for UnknownStudy {}

pub(crate) fn run(shell: &Shell, options: &Options) -> Result<()> {
    let start = Instant::now();
    let known = known_studies(shell)?;
    let studies = chosen(&known, &options.studies)?;
    let palpate = palpate::build(shell, "palpate")?;
    if options.check {
        check(shell, &palpate, studies, options)?;
    } else {
        draw(shell, &palpate, studies, &known, options.quick)?;
    }
    println!("total: {:.1} s", start.elapsed().as_secs_f64());
    Ok(())
}

/// Runs and plots the studies, then scores all that have results.
fn draw(
    shell: &Shell,
    palpate: &Path,
    studies: &[String],
    known: &[String],
    quick: bool,
) -> Result<()> {
    let results = match quick {
        true => palpate::target_dir(shell).join("reproduce-quick"),
        false => PathBuf::from("results"),
    };
    for study in studies {
        let start = Instant::now();
        let out = results.join(study);
        // Committed results are palpate's, whatever was checked out since.
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

/// Runs the studies elsewhere and compares their tables with the committed ones.
fn check(shell: &Shell, palpate: &Path, studies: &[String], options: &Options) -> Result<()> {
    let quick = options.quick;
    let directory = tempfile::tempdir()?;
    let mut differences = Vec::new();
    for study in studies {
        let start = Instant::now();
        let committed = shell.current_dir().join("results").join(study);
        let now = directory.path().join(study);
        simulate(shell, palpate, study, &now, quick)?;
        let found = compare::study(study, &committed, &now, quick, options.tolerance)?;
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
        "{} differences from results/; if they are meant, run `cargo xtask reproduce` and commit",
        differences.len()
    )
}

fn simulate(shell: &Shell, palpate: &Path, study: &str, out: &Path, quick: bool) -> Result<()> {
    let config = format!("sim-configs/{study}.toml");
    let stride = quick.then(|| ["--every-nth-cell".to_owned(), QUICK_STRIDE.to_string()]);
    let stride = stride.into_iter().flatten();
    let run = cmd!(shell, "{palpate} run {config} --out {out} {stride...}");
    Ok(run.quiet().ignore_stdout().run()?)
}

/// Names of all configs, in alphabetical order.
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

/// The studies that were asked for, or all.
fn chosen<'a>(known: &'a [String], asked: &'a [String]) -> Result<&'a [String], UnknownStudy> {
    if let Some(name) = asked.iter().find(|name| !known.contains(name)) {
        return Err(UnknownStudy {
            name: name.clone(),
            known: known.to_vec(),
        });
    }
    Ok(if asked.is_empty() { known } else { asked })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_means_all_and_an_unknown_one_lists_the_known() {
        let known = ["one".to_owned(), "two".to_owned()];
        assert_eq!(chosen(&known, &[]).unwrap(), known);
        assert_eq!(chosen(&known, &known[1..]).unwrap(), ["two"]);
        let error = chosen(&known, &["three".to_owned()])
            .unwrap_err()
            .to_string();
        assert_eq!(
            error,
            "no study `three` in sim-configs/; known:\n  one\n  two"
        );
    }

    #[test]
    fn studies_are_the_configs_themselves() {
        let directory = tempfile::tempdir().unwrap();
        let shell = Shell::new().unwrap();
        shell.change_dir(directory.path());
        for file in ["b.toml", "a.toml", "notes.md", "sub/c.toml"] {
            shell
                .write_file(Path::new("sim-configs").join(file), "")
                .unwrap();
        }
        assert_eq!(known_studies(&shell).unwrap(), ["a", "b"]);
    }
}
