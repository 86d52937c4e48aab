//! Fuzzes the parsers of files: runs the parsers on random inputs to find inputs that cause a panic.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result, bail};
use clap::Args;
use xshell::{Shell, cmd};

use crate::programs::target_dir;

const TARGETS: [&str; 5] = ["config", "formula", "readings", "frame", "calibration"];

/// Folder of the input files (corpus), with one folder for each parser.
const CORPUS: &str = "crates/fuzz/corpus";

/// Further folders with input files: name of the parser, and folder.
const SEEDS: [(&str, &str); 2] = [("config", "sim-configs"), ("config", "examples")];

/// Compiler flags that add the code that libFuzzer needs: coverage counters, reports of compared values, and a table of
/// code addresses.
const COVERAGE: &str = "-Cpasses=sancov-module \
    -Cllvm-args=-sanitizer-coverage-level=4 \
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters \
    -Cllvm-args=-sanitizer-coverage-pc-table \
    -Cllvm-args=-sanitizer-coverage-trace-compares";

#[derive(Args)]
pub(crate) struct Options {
    /// Parsers to fuzz: config, formula, readings, frame, calibration; by default all of them.
    #[arg(value_name = "READER")]
    readers: Vec<String>,
    /// Time for which each parser is fuzzed, s.
    #[arg(long, default_value_t = 60)]
    seconds: u32,
    /// Add inputs that reach new code to crates/fuzz/corpus.
    #[arg(long)]
    keep: bool,
}

pub(crate) fn run(shell: &Shell, options: &Options) -> Result<()> {
    for reader in &options.readers {
        if !TARGETS.contains(&reader.as_str()) {
            bail!("no reader `{reader}`; known: {}", TARGETS.join(", "));
        }
    }
    let program = build(shell)?;
    let work = target_dir(shell).join("fuzzing");
    let mut broken = Vec::new();
    for target in TARGETS {
        if options.readers.is_empty() || options.readers.iter().any(|reader| reader == target) {
            let start = Instant::now();
            let passes = fuzz(shell, &program, &work, target, options)?;
            let outcome = if passes { "nothing found" } else { "BROKEN" };
            println!(
                "{target}: {outcome}, {:.0} s",
                start.elapsed().as_secs_f64()
            );
            if !passes {
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

fn build(shell: &Shell) -> Result<PathBuf> {
    let version = cmd!(shell, "rustc -vV").read()?;
    let host = version.lines().find_map(|line| line.strip_prefix("host: "));
    let host = host.context("`rustc -vV` has no host")?;
    // State the compilation target explicitly. Without an explicit target, cargo would compile build scripts and macros
    // with coverage counters too.
    let target = target_dir(shell).join("fuzzing");
    cmd!(
        shell,
        "cargo build --profile fuzz --package palpate-fuzz --features libfuzzer --bin palpate-fuzz --target {host}"
    )
    .env("RUSTFLAGS", COVERAGE)
    .env("CARGO_TARGET_DIR", &target)
    .quiet()
    .run()?;
    Ok(target.join(host).join("fuzz/palpate-fuzz"))
}

/// Fuzzes one parser. Returns false if an input caused a panic; the input is then stored in a folder.
fn fuzz(
    shell: &Shell,
    program: &Path,
    work: &Path,
    target: &str,
    options: &Options,
) -> Result<bool> {
    let corpus = Path::new(CORPUS).join(target);
    let found = work.join("found").join(target);
    let broken = work.join("broken").join(target);
    for folder in [&found, &broken] {
        std::fs::create_dir_all(folder)?;
    }
    let seeds = SEEDS.iter().filter(|(of, _)| *of == target);
    let seeds: Vec<&str> = seeds.map(|(_, folder)| *folder).collect();
    let _reader = shell.push_env("FUZZ_READER", target);
    let seconds = options.seconds.to_string();
    let prefix = format!("{}/", broken.display());
    let run = cmd!(
        shell,
        "{program} -max_total_time={seconds} -timeout=20 -rss_limit_mb=2048 -max_len=4096 -print_final_stats=1
         -artifact_prefix={prefix} {found} {corpus} {seeds...}"
    )
    .quiet()
    .ignore_status()
    .output()?;
    let output = String::from_utf8_lossy(&run.stderr);
    for line in output.lines().filter(|line| {
        ["stat::number_of_executed_units", "SUMMARY", "panicked at"]
            .iter()
            .any(|part| line.contains(part))
    }) {
        println!("  {line}");
    }
    if !run.status.success() {
        return Ok(false);
    }
    if options.keep {
        cmd!(shell, "{program} -merge=1 {corpus} {found}")
            .quiet()
            .ignore_stderr()
            .run()?;
    }
    Ok(true)
}
