//! Fuzzing of the readers of files.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result, bail};
use clap::Args;
use xshell::{Shell, cmd};

use crate::palpate::target_dir;

/// Readers, as `palpate-fuzz` has them.
const TARGETS: [&str; 5] = ["config", "formula", "readings", "frame", "calibration"];

/// Where the corpus lies, a folder for each reader.
const CORPUS: &str = "crates/fuzz/corpus";

/// Files that are read too, but are not kept in the corpus.
const SEEDS: [(&str, &str); 2] = [("config", "sim-configs"), ("config", "examples")];

/// Coverage counters, comparisons and a table of places, for libFuzzer.
const COVERAGE: &str = "-Cpasses=sancov-module \
    -Cllvm-args=-sanitizer-coverage-level=4 \
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters \
    -Cllvm-args=-sanitizer-coverage-pc-table \
    -Cllvm-args=-sanitizer-coverage-trace-compares";

#[derive(Args)]
pub(crate) struct Options {
    /// Readers to try; all of them by default: config, formula, readings, frame, calibration.
    #[arg(value_name = "READER")]
    readers: Vec<String>,
    /// How long each is tried.
    #[arg(long, default_value_t = 60)]
    seconds: u32,
    /// Put inputs that reach code which the corpus does not into crates/fuzz/corpus.
    #[arg(long)]
    keep: bool,
}

pub(crate) fn run(shell: &Shell, options: &Options) -> Result<()> {
    for reader in &options.readers {
        if !TARGETS.contains(&reader.as_str()) {
            bail!("no reader `{reader}`; known: {}", TARGETS.join(", "));
        }
    }
    let programs = build(shell)?;
    let work = target_dir(shell).join("fuzzing");
    let mut broken = Vec::new();
    for target in TARGETS {
        if options.readers.is_empty() || options.readers.iter().any(|reader| reader == target) {
            let start = Instant::now();
            let found = tried(shell, &programs, &work, target, options)?;
            println!("{target}: {found}, {:.0} s", start.elapsed().as_secs_f64());
            if found != Found::Nothing {
                broken.push(target);
            }
        }
    }
    if !broken.is_empty() {
        let folder = work.join("broken");
        bail!("{} broke: see {}", broken.join(", "), folder.display());
    }
    Ok(())
}

#[derive(PartialEq, Eq)]
enum Found {
    Nothing,
    Something,
}

impl std::fmt::Display for Found {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Nothing => "nothing found",
            Self::Something => "BROKEN",
        })
    }
}

/// Builds the programs and says in which folder they lie.
fn build(shell: &Shell) -> Result<PathBuf> {
    let version = cmd!(shell, "rustc -vV").read()?;
    let host = version.lines().find_map(|line| line.strip_prefix("host: "));
    let host = host.context("rustc names no host")?;
    // A target of its own keeps the counters out of build scripts and macros.
    let target = target_dir(shell).join("fuzzing");
    cmd!(
        shell,
        "cargo build --profile fuzz --package palpate-fuzz --features libfuzzer --bins --target {host}"
    )
    .env("RUSTFLAGS", COVERAGE)
    .env("CARGO_TARGET_DIR", &target)
    .quiet()
    .run()?;
    Ok(target.join(host).join("fuzz"))
}

/// Tries one reader; what breaks it is left in a folder.
fn tried(
    shell: &Shell,
    programs: &Path,
    work: &Path,
    target: &str,
    options: &Options,
) -> Result<Found> {
    let corpus = Path::new(CORPUS).join(target);
    let found = work.join("found").join(target);
    let broken = work.join("broken").join(target);
    for folder in [&found, &broken] {
        std::fs::create_dir_all(folder)?;
    }
    let seeds = SEEDS.iter().filter(|(of, _)| *of == target);
    let seeds: Vec<&str> = seeds.map(|(_, folder)| *folder).collect();
    let program = programs.join(format!("fuzz-{target}"));
    let seconds = options.seconds.to_string();
    let prefix = format!("{}/", broken.display());
    let ran = cmd!(
        shell,
        "{program} -max_total_time={seconds} -timeout=20 -rss_limit_mb=2048 -max_len=4096 -print_final_stats=1
         -artifact_prefix={prefix} {found} {corpus} {seeds...}"
    )
    .quiet()
    .ignore_status()
    .output()?;
    let said = String::from_utf8_lossy(&ran.stderr);
    for line in said.lines().filter(|line| {
        ["stat::number_of_executed_units", "SUMMARY", "panicked at"]
            .iter()
            .any(|part| line.contains(part))
    }) {
        println!("  {line}");
    }
    if !ran.status.success() {
        return Ok(Found::Something);
    }
    if options.keep {
        cmd!(shell, "{program} -merge=1 {corpus} {found}")
            .quiet()
            .ignore_stderr()
            .run()?;
    }
    Ok(Found::Nothing)
}
