//! Instruction counts and accuracy against the committed baseline.
//!
//! Wall time is no part of it: it is only reported, by `cargo bench`; see crates/assay/BENCHES.md.

mod baseline;
mod benches;
mod changelog;
mod instructions;

use std::path::Path;

use anyhow::{Context, Result, bail};
use clap::Args;
use xshell::{Shell, cmd};

use crate::palpate;
use crate::peers::replace;
use baseline::{Comparison, Figures, Limits};

const DIRECTORY: &str = "crates/assay/baseline";
const INSTRUCTIONS: &str = "instructions.csv";
const ACCURACY: &str = "accuracy.csv";

/// Counts hardly scatter, but depend on where the linker puts what.
const COST: Limits = Limits {
    what: "instructions",
    allowed: 0.03,
    floor: 0.0,
};
/// Below 20 roundings, every mathematical library rounds its own way.
const ERROR: Limits = Limits {
    what: "error",
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
    let errors = compare(shell, ACCURACY, &ERROR, accuracy(shell)?)?;
    let counts = match instructions::count(shell)? {
        Ok(counts) => Some(compare(shell, INSTRUCTIONS, &COST, counts)?),
        Err(absent) => {
            println!("instructions are not compared: {absent}");
            None
        }
    };
    if options.accept {
        return accept(shell, &errors, counts.as_ref());
    }
    let failed: Vec<&str> = [Some(&errors), counts.as_ref()]
        .into_iter()
        .flatten()
        .filter(|comparison| comparison.fails())
        .map(|comparison| comparison.limits.what)
        .collect();
    if !failed.is_empty() {
        bail!(
            "{} not as in {DIRECTORY}; if that is meant, run `cargo xtask bench-check --accept` and commit",
            failed.join(" and ")
        );
    }
    Ok(())
}

/// Errors of palpate on fixed scenes, which are the same in every build profile.
fn accuracy(shell: &Shell) -> Result<Figures> {
    let assay = palpate::build(shell, "palpate-assay")?;
    Figures::read(&cmd!(shell, "{assay} accuracy").quiet().read()?)
}

/// Compares with the baseline and prints what differs.
fn compare(shell: &Shell, file: &str, limits: &'static Limits, now: Figures) -> Result<Comparison> {
    let path = shell.current_dir().join(DIRECTORY).join(file);
    let before = match shell.path_exists(&path) {
        true => Figures::read(&shell.read_file(&path)?)
            .with_context(|| format!("{} is unsound", path.display()))?,
        false => Figures::default(),
    };
    let comparison = Comparison::new(limits, before, now);
    print!("{}", comparison.render());
    Ok(comparison)
}

fn accept(shell: &Shell, errors: &Comparison, counts: Option<&Comparison>) -> Result<()> {
    if errors.alters() {
        changelog::demand_line(shell)?;
    }
    let directory = shell.current_dir().join(DIRECTORY);
    shell.create_dir(&directory)?;
    let write = |file: &str, comparison: &Comparison| -> Result<()> {
        replace(
            &Path::new(&directory).join(file),
            &comparison.now.to_csv(comparison.limits.what)?,
        )?;
        println!("{DIRECTORY}/{file} is written");
        Ok(())
    };
    write(ACCURACY, errors)?;
    if let Some(counts) = counts {
        return write(INSTRUCTIONS, counts);
    }
    println!("{DIRECTORY}/{INSTRUCTIONS} stays as it is");
    Ok(())
}
