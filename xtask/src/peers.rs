//! Compares palpate with its peers, that is, other programs that a user could use instead. Palpate and the peers solve
//! the same tasks with the same inputs, in the same run and on one processor core.

mod peer_programs;
mod peer_table;

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use clap::Args;
use xshell::{Shell, cmd};

use crate::programs;
use peer_programs::{Absent, Kind, PeerPrograms};
use peer_table::{Figure, medians};

/// Name of palpate's Python package in the table of results. The script xtask/peers/python_package.py measures the
/// package and its peers.
const PACKAGE: &str = "palpate for Python";

/// The committed table with the results of the comparison.
const RESULTS: &str = "results/peers.csv";

#[derive(Args)]
pub(crate) struct Options {
    /// Groups of tasks to run; by default all groups.
    #[arg(value_name = "GROUP")]
    groups: Vec<String>,
    /// Number of runs of each program. Runs of a peer and runs of palpate alternate.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
    /// Number of the processor core to run on.
    #[arg(long, default_value_t = 0)]
    core: usize,
}

/// A group of tasks, which a peer runs in one process.
struct Group {
    name: &'static str,
    peer: Kind,
    /// Required ratio of times: the time of the peer program divided by the time of palpate.
    target: f64,
    /// Tasks whose required ratio of times differs from `target`, each with its ratio.
    task_targets: &'static [(&'static str, f64)],
    /// Largest allowed excess of palpate's error over the peer's error, as a share of the peer's error. The value is 0
    /// if both programs use the same inputs. If each program draws its own random inputs, the value allows for the
    /// sampling error.
    slack: f64,
}

impl Group {
    fn target_of(&self, task: &str) -> f64 {
        let own = self.task_targets.iter().find(|(of, _)| *of == task);
        own.map_or(self.target, |(_, target)| *target)
    }
}

const GROUPS: [Group; 11] = [
    Group {
        name: "rolling-long",
        peer: Kind::Rust("ode_solvers"),
        target: 2.0,
        task_targets: &[],
        slack: 0.0,
    },
    Group {
        name: "rolling-short",
        peer: Kind::Cpp("rolling_short.cpp"),
        target: 3.0,
        task_targets: &[],
        slack: 0.0,
    },
    // Each program draws its own random noise. The rms error over 100,000 trials has a standard error of 0.2 %, so
    // errors are compared with a tolerance (`slack`) of 1 %.
    Group {
        name: "ep1-trial",
        peer: Kind::Python("ep1_trial.py"),
        target: 2.0,
        task_targets: &[],
        slack: 0.01,
    },
    Group {
        name: "ep2-few",
        peer: Kind::Python("ep2_few.py"),
        target: 2.0,
        task_targets: &[],
        slack: 0.0,
    },
    Group {
        name: "ep2-many",
        peer: Kind::Python("ep2_many.py"),
        target: 5.0,
        task_targets: &[],
        slack: 0.0,
    },
    Group {
        name: "press-contact",
        peer: Kind::Python("press_contact.py"),
        target: 100.0,
        task_targets: &[],
        slack: 0.0,
    },
    Group {
        name: "image",
        peer: Kind::Python("image.py"),
        target: 1.0,
        task_targets: &[],
        slack: 0.0,
    },
    Group {
        name: "python-roll",
        peer: Kind::Package("python-roll"),
        target: 5.0,
        task_targets: &[],
        slack: 1e-9,
    },
    Group {
        name: "python-batch",
        peer: Kind::Package("python-batch"),
        target: 3.0,
        task_targets: &[],
        slack: 1e-9,
    },
    // In this group, the peer of palpate's Python package is palpate in Rust. So the comparison measures the overhead
    // of Python.
    Group {
        name: "python-glide",
        peer: Kind::Package("python-glide"),
        target: 1.0 / 1.3,
        task_targets: &[(
            "estimate_glide of 100 000 contacts, map of 30 x 30",
            1.0 / 1.1,
        )],
        slack: 1e-9,
    },
    Group {
        name: "python-two-pass",
        peer: Kind::Package("python-two-pass"),
        target: 2.0,
        task_targets: &[],
        slack: 1e-3,
    },
];

pub(crate) fn run(shell: &Shell, options: &Options) -> Result<()> {
    let groups = chosen(&options.groups)?;
    if cmd!(shell, "taskset --version")
        .quiet()
        .ignore_stdout()
        .run()
        .is_err()
    {
        println!("skipped: taskset is missing, so programs cannot be pinned to one core");
        return Ok(());
    }
    let directory = programs::target_dir(shell).join("peers");
    shell.create_dir(&directory)?;
    let ours = programs::build(shell, "palpate-assay")?;
    let inputs = directory.join("inputs");
    cmd!(shell, "{ours} peer-tasks --inputs {inputs}")
        .quiet()
        .run()?;
    let programs = PeerPrograms::new(shell, &directory);
    let core = options.core.to_string();
    let (mut rows, mut is_whole) = (Vec::new(), options.groups.is_empty());
    for group in &groups {
        let peer = match programs.make(&group.peer)? {
            Ok(peer) => peer,
            Err(Absent(why)) => {
                println!("skipped: {}: {why}", group.name);
                is_whole = false;
                continue;
            }
        };
        println!("{} ...", group.name);
        let (mut theirs, mut mine) = (Vec::new(), Vec::new());
        for _ in 0..options.rounds {
            let figures = peer.figures(shell, &core, &inputs)?;
            let name = group.name;
            let (package, others): (Vec<_>, Vec<_>) = figures
                .into_iter()
                .partition(|figure| figure.peer.starts_with(PACKAGE));
            theirs.extend(others);
            let limits = strictest(&theirs);
            let in_rust = || {
                let command = cmd!(
                    shell,
                    "taskset -c {core} {ours} peer-tasks {name} {limits...}"
                );
                Figure::read(&command.quiet().read()?)
            };
            match package.is_empty() {
                true => mine.extend(in_rust()?),
                // The only peer of the group `python-glide` is palpate in Rust. The Python script measures only
                // palpate's Python package, so measure palpate in Rust here.
                false if name == "python-glide" => theirs.extend(in_rust()?),
                false => {}
            }
            mine.extend(package);
        }
        rows.extend(peer_table::rows(
            &medians(theirs),
            &medians(mine),
            |task| group.target_of(task),
            group.slack,
        ));
    }
    print!("{}", peer_table::render(&rows));
    let path = shell.current_dir().join(RESULTS);
    let text = peer_table::csv(&rows, &programs::machine(shell))?;
    // If only some tasks were run, keep the rows of the other tasks. The kept rows are valid, because both times of a
    // row were measured in the same run on the same machine.
    let text = match is_whole {
        true => text,
        false => peer_table::merged(&fs::read_to_string(&path).unwrap_or_default(), &text)?,
    };
    replace(&path, &text)?;
    println!("{RESULTS} is written");
    Ok(())
}

/// Options for palpate's test program that state, for each task, the largest allowed error of palpate. The largest
/// allowed error is the smallest error of all peers. The test program chooses the tolerances of palpate's models so
/// that their errors are at most this large.
fn strictest(theirs: &[Figure]) -> Vec<String> {
    let mut least: Vec<(&str, f64)> = Vec::new();
    for figure in theirs {
        match least.iter_mut().find(|(task, _)| *task == figure.task) {
            Some((_, error)) => *error = error.min(figure.error),
            None => least.push((&figure.task, figure.error)),
        }
    }
    let limit = |(task, error)| format!("--error-at-most={task}={error:e}");
    least.into_iter().map(limit).collect()
}

fn chosen(asked: &[String]) -> Result<Vec<&'static Group>> {
    if asked.is_empty() {
        return Ok(GROUPS.iter().collect());
    }
    let find = |name: &String| {
        let known = || GROUPS.map(|group| group.name).join(", ");
        let group = GROUPS.iter().find(|group| group.name == name);
        group.with_context(|| format!("no group of tasks `{name}`; known: {}", known()))
    };
    asked.iter().map(find).collect()
}

/// Writes a file in one step, so that it is never incomplete.
pub(crate) fn replace(path: &Path, text: &str) -> Result<()> {
    let unfinished = path.with_extension("unfinished");
    fs::write(&unfinished, text)
        .with_context(|| format!("cannot write {}", unfinished.display()))?;
    fs::rename(&unfinished, path).with_context(|| format!("cannot replace {}", path.display()))
}
