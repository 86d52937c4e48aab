//! The Python package: its wheel, installed into a virtual environment of its own, and all that is tested of it.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use clap::Args;
use xshell::{Shell, cmd};

use crate::palpate::{self, PYTHON};

/// What the environment has beside the wheel.
const REQUIREMENTS: &str = "crates/python/requirements.txt";

#[derive(Args)]
pub(crate) struct Options {
    /// Build and install the wheel, and test nothing.
    #[arg(long)]
    install: bool,
}

/// Interpreter of the environment, in which the wheel is installed.
pub(crate) fn installed(shell: &Shell) -> Result<PathBuf> {
    run(shell, &Options { install: true })?;
    environment(shell, &place(shell))
}

/// Folder of the environment and of the wheels.
fn place(shell: &Shell) -> PathBuf {
    palpate::target_dir(shell).join("python")
}

/// Builds the wheel, installs it into a virtual environment under the target directory, and there runs the tests, the type
/// checkers and the notebooks.
pub(crate) fn run(shell: &Shell, options: &Options) -> Result<()> {
    let place = place(shell);
    shell.create_dir(&place)?;
    let python = environment(shell, &place)?;
    let wheel = wheel(shell, &python, &place)?;
    cmd!(
        shell,
        "{python} -m pip install --quiet --disable-pip-version-check --force-reinstall --no-deps {wheel}"
    )
    .quiet()
    .run()?;
    println!("{}: {:.1} MB", wheel.display(), size_mb(&wheel)?);
    if options.install {
        return Ok(());
    }
    cmd!(
        shell,
        "cargo clippy --package {PYTHON} --all-targets -- -D warnings"
    )
    .env("PYO3_PYTHON", &python)
    .run()?;
    // The program that the tests compare with.
    let program = palpate::build(shell, "palpate")?;
    let root = shell.current_dir();
    let of_package = root.join("crates").join("python");
    // Away from the sources, so that nothing but the wheel is imported.
    let _elsewhere = shell.push_dir(&place);
    let tests = of_package.join("tests");
    cmd!(shell, "{python} -m pytest -q -p no:cacheprovider {tests}")
        .env("PALPATE", program)
        .env("PALPATE_EXAMPLES", root.join("examples"))
        .run()?;
    let config = root.join("pyproject.toml");
    cmd!(shell, "{python} -m mypy --config-file {config} -p palpate").run()?;
    let allowed = of_package.join("stubtest.txt");
    cmd!(
        shell,
        "{python} -m mypy.stubtest palpate --ignore-disjoint-bases --concise --allowlist {allowed}"
    )
    .env("MYPYPATH", "")
    .run()?;
    notebooks(shell, &python, &root)
}

/// Runs every notebook in `examples/notebooks` to its end.
fn notebooks(shell: &Shell, python: &Path, root: &Path) -> Result<()> {
    let folder = root.join("examples").join("notebooks");
    let mut notebooks = shell.read_dir(&folder)?;
    notebooks.retain(|path| path.extension().is_some_and(|kind| kind == "ipynb"));
    let _there = shell.push_dir(&folder);
    cmd!(shell, "{python} -m jupyter execute {notebooks...}")
        .env("JUPYTER_PLATFORM_DIRS", "1")
        .run()?;
    Ok(())
}

/// The interpreter of the environment, which is made where it is missing or its packages are others.
fn environment(shell: &Shell, place: &Path) -> Result<PathBuf> {
    let environment = place.join("venv");
    let python = environment.join("bin").join("python");
    let wanted = shell.current_dir().join(REQUIREMENTS);
    let installed = environment.join("requirements.txt");
    if fs::read(&installed)
        .is_ok_and(|installed| fs::read(&wanted).is_ok_and(|wanted| wanted == installed))
    {
        return Ok(python);
    }
    cmd!(shell, "python3 -m venv --clear {environment}")
        .quiet()
        .run()
        .context("Python 3.10 or later with its module venv is needed (Debian: apt-get install python3-venv)")?;
    cmd!(
        shell,
        "{python} -m pip install --quiet --no-compile --disable-pip-version-check -r {wanted}"
    )
    .quiet()
    .run()
    .with_context(|| format!("pip cannot install {REQUIREMENTS}"))?;
    fs::copy(&wanted, &installed).context("cannot note what is installed")?;
    Ok(python)
}

/// The wheel, built as the released programs are, with whose crates it shares what is built.
fn wheel(shell: &Shell, python: &Path, place: &Path) -> Result<PathBuf> {
    let wheels = place.join("wheels");
    shell.remove_path(&wheels)?;
    cmd!(
        shell,
        "{python} -m maturin build --release --locked --features palpate-python/released --out {wheels} --quiet"
    )
    .quiet()
    .run()?;
    let built = shell.read_dir(&wheels)?;
    built
        .into_iter()
        .next()
        .context("maturin has built no wheel")
}

fn size_mb(path: &Path) -> Result<f64> {
    Ok(fs::metadata(path)?.len() as f64 / 1e6)
}
