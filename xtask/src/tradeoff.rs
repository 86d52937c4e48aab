//! Error against cost of every ladder: measured, then drawn, into `results/tradeoff/`; and whether `auto` keeps its
//! word (`promise.csv`).

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result};
use clap::Args;
use xshell::{Shell, cmd};

use crate::palpate;

const RESULTS: &str = "results/tradeoff";
const PROMISE: &str = "promise.csv";

#[derive(Args)]
pub(crate) struct Options {
    /// Time as short as may be; into the target directory, never into results/.
    #[arg(long)]
    quick: bool,
    /// Draw the committed tables again without measuring.
    #[arg(long, conflicts_with = "quick")]
    draw: bool,
}

pub(crate) fn run(shell: &Shell, options: &Options) -> Result<()> {
    let start = Instant::now();
    let assay = palpate::build(shell, "palpate-assay")?;
    if options.draw {
        cmd!(shell, "{assay} fronts {RESULTS}").quiet().run()?;
        return Ok(());
    }
    let out = match options.quick {
        true => palpate::target_dir(shell).join("tradeoff-quick"),
        false => shell.current_dir().join(RESULTS),
    };
    let parent = out.parent().context("results lie in no folder")?;
    shell.create_dir(parent)?;
    // Beside the old tables, so that the new ones take their place whole or not at all.
    let temporary = tempfile::tempdir_in(parent)?;
    let fresh = temporary.path().join("tradeoff");
    measure(shell, &assay, &fresh, options.quick)?;
    cmd!(shell, "{assay} fronts {fresh}")
        .quiet()
        .ignore_stdout()
        .run()?;
    let judged = judge(shell, &assay, &fresh.join(PROMISE));
    keep(PROMISE, &fresh, &out)?;
    replace(&fresh, &out)?;
    // A promise that is broken stands in the tables, too.
    judged?;
    println!(
        "{}: {:.1} s; `cargo xtask reproduce` puts it on the page",
        out.display(),
        start.elapsed().as_secs_f64()
    );
    Ok(())
}

/// Measures on the last core, where the system has a way to say so. What stages do is counted by a build with counters,
/// whose counts are the same in any profile; what they cost, by the one without.
fn measure(shell: &Shell, assay: &Path, out: &Path, quick: bool) -> Result<()> {
    let tallies = tempfile::NamedTempFile::new()?;
    let tallies = tallies.path();
    cmd!(
        shell,
        "cargo run --quiet -p palpate-assay -- tallies --out {tallies}"
    )
    .quiet()
    .run()?;
    let machine = palpate::machine(shell);
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
            "taskset --cpu-list {last} {assay} tradeoff --out {out} --tallies {tallies} --machine {machine} {quick...}"
        ),
        Err(_) => cmd!(
            shell,
            "{assay} tradeoff --out {out} --tallies {tallies} --machine {machine} {quick...}"
        ),
    }
    .quiet()
    .run()?;
    Ok(())
}

/// Whether `auto` keeps its word, by instructions.
fn judge(shell: &Shell, assay: &Path, promise: &Path) -> Result<()> {
    let valgrind = cmd!(shell, "valgrind --version").quiet().ignore_stdout();
    if valgrind.ignore_stderr().run().is_err() {
        println!(
            "valgrind is missing: what `auto` promises is not judged; {PROMISE} stays as it was"
        );
        return Ok(());
    }
    cmd!(shell, "{assay} promise --out {promise}")
        .quiet()
        .run()?;
    Ok(())
}

/// Where a fresh folder lacks a file, it gets the one of the folder whose place it is to take, if there is one.
fn keep(name: &str, fresh: &Path, out: &Path) -> Result<()> {
    let (missing, known) = (fresh.join(name), out.join(name));
    if !missing.exists() && known.exists() {
        std::fs::copy(&known, &missing)
            .with_context(|| format!("cannot copy {}", known.display()))?;
    }
    Ok(())
}

/// Puts a fresh folder in the place of another, which goes beside where it was.
fn replace(fresh: &Path, out: &Path) -> Result<()> {
    if out.exists() {
        std::fs::rename(out, fresh.with_file_name("replaced"))
            .with_context(|| format!("cannot replace {}", out.display()))?;
    }
    std::fs::rename(fresh, out)
        .with_context(|| format!("cannot rename {} to {}", fresh.display(), out.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_not_judged_again_is_kept() {
        let parent = tempfile::tempdir().unwrap();
        let [out, fresh] = ["tradeoff", "fresh"].map(|name| parent.path().join(name));
        let promise = |folder: &Path| std::fs::read_to_string(folder.join(PROMISE)).ok();
        std::fs::create_dir(&fresh).unwrap();
        keep(PROMISE, &fresh, &out).unwrap();
        assert_eq!(promise(&fresh), None);
        std::fs::create_dir(&out).unwrap();
        std::fs::write(out.join(PROMISE), "known").unwrap();
        keep(PROMISE, &fresh, &out).unwrap();
        assert_eq!(promise(&fresh).as_deref(), Some("known"));
        std::fs::write(fresh.join(PROMISE), "judged").unwrap();
        keep(PROMISE, &fresh, &out).unwrap();
        assert_eq!(promise(&fresh).as_deref(), Some("judged"));
    }

    #[test]
    fn a_fresh_folder_takes_the_place_of_the_old_one() {
        let parent = tempfile::tempdir().unwrap();
        let out = parent.path().join("tradeoff");
        std::fs::create_dir(&out).unwrap();
        std::fs::write(out.join("old.csv"), "old").unwrap();
        let fresh = parent.path().join("temporary").join("fresh");
        std::fs::create_dir_all(&fresh).unwrap();
        std::fs::write(fresh.join("rungs.csv"), "new").unwrap();
        replace(&fresh, &out).unwrap();
        assert!(!out.join("old.csv").exists());
        assert_eq!(
            std::fs::read_to_string(out.join("rungs.csv")).unwrap(),
            "new"
        );
        assert!(parent.path().join("temporary/replaced/old.csv").exists());
    }
}
