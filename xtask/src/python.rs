//! Builds the wheel of the Python package, installs it into a virtual environment, and tests it.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use clap::Args;
use xshell::{Shell, cmd};

use crate::programs;

const PACKAGE: &str = "crates/python";

/// File that lists the Python packages in the environment, except palpate.
const REQUIREMENTS: &str = "crates/python/requirements.txt";

/// Largest allowed size of a wheel, MB.
const MAX_WHEEL_MB: f64 = 10.0;

#[derive(Args)]
pub(crate) struct Options {
    /// Only build and install the wheel, without tests.
    #[arg(long)]
    install: bool,
    /// Install the package as a new user does: with `pip install .` in a new clone and an empty virtual environment.
    /// Then run the Python lines of README.md there, and print the time.
    #[arg(long, conflicts_with = "install")]
    from_clone: bool,
}

/// Runs `work` and prints its run time. `what` names the work.
fn timed<T>(what: &str, work: impl FnOnce() -> Result<T>) -> Result<T> {
    let start = Instant::now();
    let done = work()?;
    println!("{what}: {:.1} s", start.elapsed().as_secs_f64());
    Ok(done)
}

/// Folder for the virtual environment and the wheels.
fn place(shell: &Shell) -> PathBuf {
    programs::target_dir(shell).join("python")
}

pub(crate) fn run(shell: &Shell, options: &Options) -> Result<()> {
    if options.from_clone {
        return from_clone(shell);
    }
    if options.install {
        return installed(shell).map(drop);
    }
    check(shell)
}

/// Builds the wheel, and installs it into a virtual environment under the target directory. Returns the path of the
/// environment's interpreter.
pub(crate) fn installed(shell: &Shell) -> Result<PathBuf> {
    let place = place(shell);
    shell.create_dir(&place)?;
    let python = timed("environment", || {
        environment(shell, &place.join("venv"), REQUIREMENTS)
    })?;
    let wheel = timed("wheel", || wheel(shell, &python, &place))?;
    cmd!(
        shell,
        "{python} -m pip install --quiet --disable-pip-version-check --no-cache-dir --force-reinstall --no-deps {wheel}"
    )
    .quiet()
    .run()?;
    let size = fs::metadata(&wheel)?.len() as f64 / 1e6;
    println!("{}: {size:.1} MB", wheel.display());
    ensure!(
        size <= MAX_WHEEL_MB,
        "the size of the wheel is {size:.1} MB, more than {MAX_WHEEL_MB}"
    );
    Ok(python)
}

/// Builds the wheel, installs it, and runs the tests, the type checkers and the notebooks.
pub(crate) fn check(shell: &Shell) -> Result<()> {
    // The tests compare the package with the program `palpate`. Both are built from the same compiled crates.
    let program = timed("program", || programs::build(shell, "palpate"))?;
    let python = installed(shell)?;
    let root = shell.current_dir();
    // IPython, Jupyter and Matplotlib write user files into HOME, so use another folder as HOME.
    let _home = shell.push_env("HOME", shell.create_dir(place(shell).join("home"))?);
    timed("tests", || tests(shell, &python, &program))?;
    timed("types", || types(shell, &python))?;
    timed("notebooks", || notebooks(shell, &python, &root))
}

fn tests(shell: &Shell, python: &Path, program: &Path) -> Result<()> {
    let root = shell.current_dir();
    let tests = root.join(PACKAGE).join("tests");
    // The tests run outside the source folder, so that Python imports the wheel and not the sources.
    let _elsewhere = shell.push_dir(place(shell));
    cmd!(shell, "{python} -m pytest -q -p no:cacheprovider {tests}")
        .env("PALPATE", program)
        .env("PALPATE_EXAMPLES", root.join("examples"))
        .run()?;
    Ok(())
}

fn types(shell: &Shell, python: &Path) -> Result<()> {
    let root = shell.current_dir();
    let config = root.join("pyproject.toml");
    let allowed = root.join(PACKAGE).join("stubtest.txt");
    let _elsewhere = shell.push_dir(place(shell));
    cmd!(shell, "{python} -m mypy --config-file {config} -p palpate").run()?;
    cmd!(
        shell,
        "{python} -m mypy.stubtest palpate --ignore-disjoint-bases --concise --allowlist {allowed}"
    )
    .env("MYPYPATH", "")
    .run()?;
    Ok(())
}

/// Clones the repository, installs the clone with pip into an empty virtual environment, and runs the Python lines of
/// README.md there.
fn from_clone(shell: &Shell) -> Result<()> {
    let place = place(shell);
    shell.create_dir(&place)?;
    let (clone, environment) = (place.join("clone"), place.join("empty"));
    shell.remove_path(&clone)?;
    let root = shell.current_dir();
    cmd!(shell, "git clone --quiet {root} {clone}")
        .quiet()
        .run()?;
    cmd!(shell, "python3 -m venv --clear {environment}")
        .quiet()
        .run()?;
    let python = environment.join("bin").join("python");
    let _there = shell.push_dir(&clone);
    timed("pip install .", || {
        let install = cmd!(
            shell,
            "{python} -m pip install --quiet --disable-pip-version-check ."
        );
        // Do not use the shared target directory, because a new user does not have it.
        Ok(install.env_remove("CARGO_TARGET_DIR").run()?)
    })?;
    let readme = shell.read_file("README.md")?;
    let (_, block) = readme
        .split_once("```python\n")
        .context("README.md has no ```python block")?;
    let lines = block.split("```").next().unwrap_or_default();
    timed("Python lines of README.md", || {
        Ok(cmd!(shell, "{python} -").stdin(lines).run()?)
    })
}

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

/// Returns the interpreter of the virtual environment `environment`, which has the packages in the file `list`. Creates
/// the environment if it does not exist or has other packages.
pub(crate) fn environment(shell: &Shell, environment: &Path, list: &str) -> Result<PathBuf> {
    let python = environment.join("bin").join("python");
    let wanted = shell.current_dir().join(list);
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
    .env("PIP_CACHE_DIR", place(shell).join("pip"))
    .quiet()
    .run()
    .with_context(|| format!("pip cannot install {list}; is there a network?"))?;
    fs::copy(&wanted, &installed).context("cannot store the list of the installed packages")?;
    Ok(python)
}

/// Builds the wheel. The build uses the settings of the release programs, so that the crates that were compiled for
/// these programs need not be compiled again.
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
        .context("maturin did not build a wheel")
}
