//! Measures the cost of a computation: the median and quartiles of its time and, if valgrind is installed, its number
//! of processor instructions.
//!
//! A test program creates a list of [`Evaluation`]s. [`Evaluation::time`] measures the time of one of them.
//! [`instructions`] starts the program again under callgrind (a tool of valgrind), with the same arguments and the flag
//! [`COUNTED`]. In this second process, the program creates the same list and passes it to [`count`].

use std::ffi::OsString;
use std::fs;
use std::hint::black_box;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};

/// Flag that makes a test program run its computations once for the instruction counter, instead of measuring their
/// times.
pub const COUNTED: &str = "--counted";
/// Message for users. If valgrind is not installed, [`instructions`] returns `None`, and this message is printed.
pub const NO_VALGRIND: &str =
    "valgrind is not installed: instructions are not counted, their column stays empty";

/// Smallest duration of a batch of runs, so long that the time for reading the clock is negligible.
const MIN_BATCH_TIME: Duration = Duration::from_millis(5);
/// Number of runs of each evaluation under callgrind. Only the last run is counted.
const RUNS: usize = 2;
const MIN_BATCHES: usize = 3;
/// Pattern for the name of the function [`evaluate_once`] in the compiled program. It matches whether or not the
/// compiler has mangled the name.
const EVALUATE_ONCE: &str = "*timing*evaluate_once*";

/// A computation whose cost is measured. Each run does the same work.
pub struct Evaluation {
    /// Name of the computation, for messages.
    pub name: String,
    run: Box<dyn FnMut()>,
    /// Number of evaluations in one run. The cost of a run is divided by this number.
    evaluations: u32,
}

/// Time per evaluation in nanoseconds: the median and the quartiles over all batches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Lower quartile: a quarter of the batches were faster.
    pub q25: f64,
    /// Median: half of the batches were faster.
    pub median: f64,
    /// Upper quartile: a quarter of the batches were slower.
    pub q75: f64,
}

impl Evaluation {
    /// A computation with one evaluation per run. The compiler cannot optimise away the result of `run`.
    pub fn new<T>(name: impl Into<String>, mut run: impl FnMut() -> T + 'static) -> Self {
        Self {
            name: name.into(),
            run: Box::new(move || drop(black_box(run()))),
            evaluations: 1,
        }
    }

    /// Runs the computation once.
    pub fn run(&mut self) {
        (self.run)();
    }

    /// Sets the number of evaluations in one run, at least 1. All costs are stated per evaluation.
    #[must_use]
    pub fn evaluations_per_run(mut self, evaluations: u32) -> Self {
        self.evaluations = evaluations.max(1);
        self
    }

    /// Number of evaluations per run, as set by [`Self::evaluations_per_run`].
    pub fn scale(&self) -> u32 {
        self.evaluations
    }

    /// Measures the times of batches of runs for a total of about `patience`. One run before the first batch fills
    /// caches and tables.
    pub fn time(&mut self, patience: Duration) -> Spread {
        (self.run)();
        let start = Instant::now();
        let length = self.batch_length();
        let mut batches = Vec::new();
        while batches.len() < MIN_BATCHES || start.elapsed() < patience {
            let evaluations = f64::from(length) * f64::from(self.evaluations);
            batches.push(self.batch(length).as_secs_f64() * 1e9 / evaluations);
        }
        batches.sort_unstable_by(f64::total_cmp);
        let [q25, median, q75] = [0.25, 0.5, 0.75].map(|share| quantile(&batches, share));
        Spread { q25, median, q75 }
    }

    /// Number of runs that together take at least [`MIN_BATCH_TIME`].
    fn batch_length(&mut self) -> u32 {
        let mut length = 1;
        while self.batch(length) < MIN_BATCH_TIME {
            length *= 2;
        }
        length
    }

    fn batch(&mut self, length: u32) -> Duration {
        let start = Instant::now();
        for _ in 0..length {
            (self.run)();
        }
        start.elapsed()
    }
}

/// Quantile of sorted values with linear interpolation. `share` (0 to 1) is the quantile's probability.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = share * (sorted.len() - 1) as f64;
    let (below, above) = (place.floor() as usize, place.ceil() as usize);
    sorted[below] + (sorted[above] - sorted[below]) * place.fract()
}

/// Runs each evaluation twice; the first run fills caches and tables. A test program that was started with the flag
/// [`COUNTED`] calls only this function. Callgrind writes its instruction count at the end of each run and starts again
/// from 0.
pub fn count(evaluations: impl IntoIterator<Item = Evaluation>) {
    for mut evaluation in evaluations {
        for _ in 0..RUNS {
            evaluate_once(&mut *evaluation.run);
        }
    }
}

#[inline(never)]
fn evaluate_once(run: &mut dyn FnMut()) {
    run();
    // Without this line, the call of `run` could be a tail call. Callgrind would then consider this function finished
    // before `run` has finished.
    black_box(());
}

/// Number of instructions of each evaluation, in the order of the program's list of evaluations. `None` if valgrind is
/// not installed. Starts this program again under valgrind, with the same arguments and the flag [`COUNTED`]. `scales`
/// contains the [`Evaluation::scale`] of each evaluation.
///
/// # Errors
/// An error if the run under valgrind fails, or the number of evaluations differs from the length of `scales`.
pub fn instructions(scales: &[u32]) -> Result<Option<Vec<u64>>> {
    let arguments = std::env::args_os().skip(1);
    instructions_by(arguments.chain([COUNTED.into()]), scales)
}

/// Like [`instructions`], but with other arguments. When this program is started with these arguments, it must call
/// [`count`].
///
/// # Errors
/// An error if the run under valgrind fails, or the number of evaluations differs from the length of `scales`.
pub fn instructions_by(
    arguments: impl IntoIterator<Item = OsString>,
    scales: &[u32],
) -> Result<Option<Vec<u64>>> {
    let probe = Command::new("valgrind").arg("--version").output();
    if !probe.is_ok_and(|output| output.status.success()) {
        return Ok(None);
    }
    let folder = tempfile::tempdir()?;
    let out = folder.path().join("dump");
    let run = Command::new("valgrind")
        .arg("--tool=callgrind")
        .arg(format!("--dump-after={EVALUATE_ONCE}"))
        .arg(format!("--callgrind-out-file={}", out.display()))
        .arg(std::env::current_exe()?)
        .args(arguments)
        .stdout(Stdio::null())
        .output()
        .context("cannot run valgrind")?;
    if !run.status.success() {
        bail!(
            "counting instructions failed: {}",
            String::from_utf8_lossy(&run.stderr)
        );
    }
    let runs = dumps(&out)?;
    ensure!(
        runs.len() == scales.len() * RUNS,
        "callgrind counted {} runs of {} evaluations, {RUNS} each",
        runs.len(),
        scales.len()
    );
    let counted = runs.chunks(RUNS).zip(scales);
    let counted = counted.map(|(runs, scale)| runs[RUNS - 1] / u64::from(*scale));
    Ok(Some(counted.collect()))
}

/// Numbers of instructions in the dump files of callgrind, in the order of their names: `dump.1`, `dump.2` and so on.
fn dumps(stem: &Path) -> Result<Vec<u64>> {
    let mut counts = Vec::new();
    loop {
        let path = stem.with_extension((counts.len() + 1).to_string());
        match fs::read_to_string(&path) {
            Ok(text) => counts
                .push(total(&text).with_context(|| format!("{} has no total", path.display()))?),
            Err(_) => return Ok(counts),
        }
    }
}

/// Number of instructions in a dump file of callgrind. It is in the line `summary:` or, if there is no such line, in
/// the line `totals:`.
fn total(dump: &str) -> Option<u64> {
    let line = |name: &str| dump.lines().find_map(|line| line.strip_prefix(name));
    let numbers = line("summary:").or_else(|| line("totals:"))?;
    numbers.split_whitespace().next()?.parse().ok()
}
