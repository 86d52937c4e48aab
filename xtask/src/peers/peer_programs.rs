//! Prepares the peer programs, with which palpate is compared. Creates a virtual environment for Python scripts, and
//! compiles other programs under the target directory.

use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use xshell::{Shell, cmd};

use super::peer_table::Figure;
use crate::python;

/// File that lists the Python packages of the peers, the programs with which palpate is compared.
const REQUIREMENTS: &str = "xtask/peers/requirements.txt";
/// Environment variables that restrict numerical libraries to one thread.
const ONE_THREAD: [&str; 3] = ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"];

/// Language of a peer program, with the path of its source.
pub(crate) enum Kind {
    Python(&'static str),
    /// Name of a group of tasks in the script xtask/peers/python_package.py, which also measures palpate's Python
    /// package.
    Package(&'static str),
    /// A C++ source file in xtask/peers/, compiled with g++.
    Cpp(&'static str),
    Rust(&'static str),
}

/// Reason why a peer program cannot run on this machine.
pub(crate) struct Absent(pub(crate) String);

pub(crate) struct PeerPrograms<'s> {
    shell: &'s Shell,
    sources: PathBuf,
    directory: PathBuf,
    /// The Python interpreter of an environment with the required packages. `Err` contains the reason if there is no
    /// such environment.
    python: Result<PathBuf, String>,
}

/// A peer program that has been prepared and can be run.
pub(crate) struct Peer {
    command: Vec<OsString>,
    /// Group of tasks that the program runs; `None` if the program has only one group.
    group: Option<&'static str>,
}

impl From<Vec<OsString>> for Peer {
    fn from(command: Vec<OsString>) -> Self {
        Self {
            command,
            group: None,
        }
    }
}

impl Peer {
    /// Runs the peer program on one core, and reads the times and errors that it prints.
    pub(crate) fn figures(&self, shell: &Shell, core: &str, inputs: &Path) -> Result<Vec<Figure>> {
        let Self { command, group } = self;
        let mut run = cmd!(shell, "taskset -c {core} {command...} {inputs} {group...}").quiet();
        for variable in ONE_THREAD {
            run = run.env(variable, "1");
        }
        Figure::read(&run.read()?)
    }
}

impl<'s> PeerPrograms<'s> {
    /// Prepares the Python environment in which the scripts run.
    pub(crate) fn new(shell: &'s Shell, directory: &Path) -> Self {
        let sources = shell.current_dir().join("xtask").join("peers");
        let python = python::environment(shell, &directory.join("venv"), REQUIREMENTS);
        Self {
            shell,
            sources,
            directory: directory.to_owned(),
            python: python.map_err(|error| format!("{error:#}")),
        }
    }

    /// Prepares a peer program. The result is [`Absent`] if this machine lacks a required tool.
    ///
    /// # Errors
    /// An error if the program cannot be built although all required tools are installed.
    pub(crate) fn make(&self, kind: &Kind) -> Result<Result<Peer, Absent>> {
        match kind {
            Kind::Python(script) => Ok(match &self.python {
                Ok(python) => Ok(vec![python.into(), self.sources.join(script).into()].into()),
                Err(why) => Err(Absent(why.clone())),
            }),
            Kind::Package(group) => {
                let python = python::installed(self.shell)?;
                let script = self.sources.join("python_package.py");
                Ok(Ok(Peer {
                    command: vec![python.into(), script.into()],
                    group: Some(group),
                }))
            }
            Kind::Cpp(source) => self.compile(source),
            Kind::Rust(package) => self.build(package),
        }
    }

    fn compile(&self, source: &str) -> Result<Result<Peer, Absent>> {
        let shell = self.shell;
        let header = "#include <boost/numeric/odeint.hpp>";
        let probe = cmd!(shell, "g++ -x c++ -fsyntax-only -")
            .quiet()
            .stdin(header);
        if probe.ignore_stderr().run().is_err() {
            return Ok(Err(Absent("g++ or Boost's headers are missing".to_owned())));
        }
        let program = self.directory.join(Path::new(source).with_extension(""));
        let source = self.sources.join(source);
        cmd!(
            shell,
            "g++ -O3 -march=native -ffp-contract=fast {source} -o {program}"
        )
        .quiet()
        .run()?;
        Ok(Ok(Peer::from(vec![program.into()])))
    }

    fn build(&self, package: &str) -> Result<Result<Peer, Absent>> {
        let shell = self.shell;
        let manifest = self.sources.join(package).join("Cargo.toml");
        let target = self.directory.join(package);
        if cmd!(shell, "cargo fetch --locked --manifest-path {manifest}")
            .quiet()
            .run()
            .is_err()
        {
            return Ok(Err(Absent("its crates cannot be fetched".to_owned())));
        }
        cmd!(
            shell,
            "cargo build --release --locked --manifest-path {manifest} --target-dir {target}"
        )
        .env("RUSTFLAGS", "-C target-cpu=native")
        .run()?;
        let release = target.join("release");
        let name = fs::read_to_string(&manifest)?
            .lines()
            .find_map(|line| {
                line.strip_prefix("name = \"")?
                    .strip_suffix('"')
                    .map(str::to_owned)
            })
            .context("the Cargo.toml of the peer program has no package name")?;
        let program = release.join(format!("{name}{}", env::consts::EXE_SUFFIX));
        Ok(Ok(Peer::from(vec![program.into()])))
    }
}
