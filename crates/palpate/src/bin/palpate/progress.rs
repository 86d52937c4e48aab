//! Shows the progress of long work on standard error: as a bar on a terminal, otherwise as one line per minute.

use std::io::IsTerminal;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{HumanCount, ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::duration::roughly;
use crate::journal::Totals;
use crate::output;

/// A progress bar appears only if the work takes longer than this time.
pub(crate) const QUIET_TIME: Duration = Duration::from_secs(1);
/// Time between two progress lines, if standard error is not a terminal.
const LINE_INTERVAL: Duration = Duration::from_secs(60);

pub(crate) struct Progress {
    bar: ProgressBar,
    all: u64,
    /// Number of trials that an earlier run had already done before it was interrupted.
    before: u64,
    done: AtomicU64,
    start: Instant,
    /// Time of the last progress line, in full minutes since the start.
    lines: AtomicU64,
    failing: Mutex<String>,
    is_terminal: bool,
}

impl Progress {
    pub(crate) fn new(all: u64, before: u64) -> Self {
        let bar = bar_of("trials");
        bar.set_length(all);
        bar.set_position(before);
        bar.reset_eta();
        Self {
            bar,
            all,
            before,
            done: AtomicU64::new(before),
            start: Instant::now(),
            lines: AtomicU64::new(0),
            failing: Mutex::new(String::new()),
            is_terminal: std::io::stderr().is_terminal(),
        }
    }

    pub(crate) fn add(&self, trials: u64) {
        let done = trials + self.done.fetch_add(trials, Ordering::Relaxed);
        if self.is_terminal {
            return self.bar.inc(trials);
        }
        let elapsed = self.start.elapsed();
        let due = elapsed.as_secs() / LINE_INTERVAL.as_secs();
        if self.lines.fetch_max(due, Ordering::Relaxed) < due {
            output::print_note(self.line(done, elapsed.as_secs_f64()));
        }
    }

    pub(crate) fn show_failures(&self, totals: &Totals) {
        if totals.kinds.is_empty() {
            return;
        }
        if let Ok(mut failing) = self.failing.try_lock() {
            *failing = format!("; failed: {}", totals.failures());
            if self.is_terminal {
                self.bar.set_message(failing.clone());
            }
        }
    }

    pub(crate) fn end(&self) {
        self.bar.finish_and_clear();
    }

    fn line(&self, done: u64, seconds: f64) -> String {
        let rate = (done - self.before) as f64 / seconds;
        let left = (self.all.saturating_sub(done)) as f64 / rate;
        let failing = self.failing.try_lock().map(|failing| failing.clone());
        format!(
            "{} of {} trials, {} a second, about {} left{}",
            HumanCount(done),
            HumanCount(self.all),
            HumanCount(rate as u64),
            roughly(left),
            failing.unwrap_or_default()
        )
    }
}

/// Shows a progress bar while `work` runs. `things` names what the bar counts. `work` reports how many of them are done,
/// and how many there are.
pub(crate) fn counting<T>(things: &str, work: impl FnOnce(&dyn Fn(usize, usize)) -> T) -> T {
    let (bar, start) = (bar_of(things), Instant::now());
    let result = work(&|done, all| {
        if start.elapsed() >= QUIET_TIME {
            bar.set_length(all as u64);
            bar.set_position(done as u64);
        }
    });
    bar.finish_and_clear();
    result
}

/// Progress bar with rate and remaining time; it is invisible if standard error is not a terminal. `things` names the
/// counted unit, for example "trials". The caller sets the total number later.
fn bar_of(things: &str) -> ProgressBar {
    let counts = format!("{{human_pos}}/{{human_len}} {things}, {{per_sec}}, {{eta}} left");
    bar_with(&format!("{{wide_bar}} {counts}{{msg}}"))
}

pub(crate) fn counter_of(things: &str) -> ProgressBar {
    bar_with(&format!("{{human_pos}} {things}, {{per_sec}}{{msg}}"))
}

fn bar_with(template: &str) -> ProgressBar {
    let style = ProgressStyle::with_template(template);
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    match style {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
