//! Builds the programs that are tested, runs test programs of palpate-assay, lists the packages of the workspace, and
//! describes the machine.

use std::path::PathBuf;
use std::{env, fs};

use anyhow::{Result, bail};
use clap::Args;
use serde_json::Value;
use xshell::{Shell, cmd};

pub(crate) fn target_dir(shell: &Shell) -> PathBuf {
    let target = env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
    shell.current_dir().join(target)
}

/// Name of the crate of the Python package. The crate needs a Python interpreter, so only `cargo xtask python` builds
/// and tests it.
pub(crate) const PYTHON: &str = "palpate-python";

/// Feature that lints, tests and [`build`] enable. In the program that users install, it is off by default.
pub(crate) const FEATURES: &str = "palpate/parquet";

/// Packages that [`build`] compiles. Cargo enables the features that any of these packages needs. With these packages,
/// the features are the same as for tests and the Python package, so that the three builds share the compiled crates.
const RELEASED: [&str; 4] = ["-p", "palpate", "-p", "palpate-assay"];

/// Builds the release programs in [`RELEASED`], and returns the path of `program`.
pub(crate) fn build(shell: &Shell, program: &str) -> Result<PathBuf> {
    let build = cmd!(
        shell,
        "cargo build --release {RELEASED...} --features {FEATURES} --bins"
    );
    build.quiet().run()?;
    Ok(released(shell, program))
}

/// Builds only the release program `palpate`, which takes half the time of [`build`], and returns its path.
pub(crate) fn build_alone(shell: &Shell) -> Result<PathBuf> {
    let build = cmd!(
        shell,
        "cargo build --release -p palpate --bin palpate --no-default-features --features cli"
    );
    build.quiet().run()?;
    Ok(released(shell, "palpate"))
}

fn released(shell: &Shell, program: &str) -> PathBuf {
    let binary = format!("{program}{}", env::consts::EXE_SUFFIX);
    target_dir(shell).join("release").join(binary)
}

/// Packages of the workspace, as `cargo metadata` lists them.
pub(crate) fn packages(shell: &Shell) -> Result<Vec<Value>> {
    let command = cmd!(
        shell,
        "cargo metadata --no-deps --offline --format-version 1"
    );
    let mut metadata: Value = serde_json::from_str(&command.quiet().read()?)?;
    match metadata["packages"].take() {
        Value::Array(packages) => Ok(packages),
        _ => bail!("cargo metadata lists no packages"),
    }
}

pub(crate) fn machine(shell: &Shell) -> String {
    let processors = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = processors
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(": "))
        .map_or(env::consts::ARCH, |(_, model)| model.trim());
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let rustc = cmd!(shell, "rustc --version").quiet().read();
    let rustc = rustc.unwrap_or_else(|_| "an unknown rustc".to_owned());
    let rustc = rustc.split(" (").next().unwrap_or_default();
    format!("{model}, {cores} cores, {rustc}")
}

#[derive(Args)]
#[command(disable_help_flag = true)]
pub(crate) struct AssayOptions {
    /// Options for the test program. Add --help to list them.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    options: Vec<String>,
}

/// Folder of the tables into which the measured coverage of intervals is written.
const FAMILIES: &str = "crates/palpate/src/coverage";

/// Compares the answers of `design` and `distinguish` with references, and writes `results/answers.csv`.
pub(crate) fn answers(shell: &Shell, options: &AssayOptions) -> Result<()> {
    harness(shell, ["answers", "--out", "results/answers.csv"], options)
}

/// Measures the coverage of intervals and how often warnings appear, and writes both into the tables in [`FAMILIES`].
pub(crate) fn intervals(shell: &Shell, options: &AssayOptions) -> Result<()> {
    harness(shell, ["intervals", "--tables", FAMILIES], options)
}

/// A step of CI that compares only some answers with references. It takes a few seconds.
pub(crate) fn check_answers(shell: &Shell) -> Result<()> {
    let table = target_dir(shell).join("answers.csv");
    let options = "--seeds 5 --pairs 100000 --only cylinder".split(' ');
    let options = AssayOptions {
        options: options.map(str::to_owned).collect(),
    };
    let table = table.display().to_string();
    harness(shell, ["answers", "--out", &table], &options)
}

fn harness(shell: &Shell, harness: [&str; 3], options: &AssayOptions) -> Result<()> {
    let assay = build(shell, "palpate-assay")?;
    let options = &options.options;
    let run = cmd!(shell, "{assay} {harness...} {options...}");
    Ok(run.quiet().run()?)
}
