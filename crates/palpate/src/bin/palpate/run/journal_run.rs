//! A run that records its finished cells in a journal. It resumes after an interruption, and stops when a signal
//! arrives.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use anyhow::{Context, anyhow};
use palpate::{Simulation, SweepError, SweepOutput, Warnings};
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::{SigId, flag, low_level};

use crate::failure::Failure;
use crate::journal::{
    self, CellRecord, Header, Journal, JournalState, RunRequest, Totals, TrialRows,
};
use crate::output::names::JOURNAL;
use crate::output::{self, Lock};
use crate::progress::Progress;

pub(super) struct JournalRun<'s, 'a> {
    simulation: &'s Simulation<'a>,
    journal: Journal,
    totals: Totals,
    warnings: Warnings,
    tasks: u64,
    /// Rows of the table of trials, as CSV text, for the cell that is not finished. These rows are not in the journal
    /// yet.
    rows: String,
    is_shared: bool,
}

/// Rows of the table of trials are collected, and written to the journal when they exceed this size (bytes).
const MAX_PENDING_BYTES: usize = 1 << 20;

impl<'s, 'a> JournalRun<'s, 'a> {
    /// Starts a new journal, or continues the journal `found` of an interrupted run.
    pub(super) fn begin(
        simulation: &'s Simulation<'a>,
        out: &Path,
        header: Header,
        found: Option<JournalState>,
        restarts: bool,
    ) -> Result<Self, Failure> {
        let is_shared = header.request.shard.is_some();
        // Read the journal again now that the directory is locked. Since the first reading, another process may have
        // finished its run or started a new one.
        let now = match restarts {
            true => None,
            false => journal::read(out)?.filter(JournalState::may_have_results),
        };
        let is_known = now.as_ref().is_none_or(|now| {
            let found = found.as_ref();
            found.is_some_and(|found| found.header == now.header)
        });
        let path = out.join(JOURNAL);
        let cannot = || format!("cannot write {}", path.display());
        if !is_known {
            return Err(Failure::work(anyhow!(
                "another process wrote {} in the meantime: run the same command again",
                path.display()
            )));
        }
        let Some(found) = now else {
            let journal = Journal::new(out, &header).with_context(cannot);
            return Ok(Self {
                simulation,
                journal: journal.map_err(Failure::work)?,
                totals: Totals::default(),
                warnings: header.warnings,
                tasks: 0,
                rows: String::new(),
                is_shared,
            });
        };
        if found.is_torn {
            let path = path.display();
            output::print_note(format_args!(
                "note: the end of {path} is damaged; its cells run again"
            ));
        }
        let all = simulation.tasks();
        output::print_note(format_args!(
            "note: resumes after {} of {all} cells",
            found.tasks
        ));
        let journal = Journal::resumed(out, &found).with_context(cannot);
        Ok(Self {
            simulation,
            journal: journal.map_err(Failure::work)?,
            totals: found.totals,
            warnings: found.warnings,
            tasks: found.tasks,
            rows: String::new(),
            is_shared,
        })
    }

    fn record_cell(&mut self, record: CellRecord) -> std::io::Result<()> {
        self.totals.add(&record);
        self.warnings.add(record.cell as usize, &record.warnings);
        self.journal.cell(record)
    }

    pub(super) fn run(mut self) -> Result<(Totals, Warnings), Failure> {
        let simulation = self.simulation;
        let all = simulation.trials_before(simulation.tasks());
        let done = simulation.trials_before(self.tasks);
        let progress = Progress::new(all, done);
        let signals = Signals::new()?;
        let first = self.tasks;
        let mut error = None;
        let ran = simulation.stream(
            first,
            signals.stop(),
            &|trials| progress.add(trials),
            CellRecord::new,
            &mut |number, taken| match self.take(number, taken) {
                Ok(()) => {
                    progress.show_failures(&self.totals);
                    ControlFlow::Continue(())
                }
                Err(cause) => {
                    error = Some(cause);
                    ControlFlow::Break(())
                }
            },
        );
        progress.end();
        let path = self.journal.path().display().to_string();
        let again = "the same command resumes the run";
        if let Some(error) = error {
            let error = error.context(format!(
                "cannot write {path}; the stored cells remain, and {again}"
            ));
            return Err(Failure::work(error));
        }
        let flushed = self.journal.flush();
        match ran {
            Err(SweepError::Cancelled) => {
                flushed
                    .with_context(|| format!("cannot write {path}"))
                    .map_err(Failure::work)?;
                Err(Failure::Stopped(
                    anyhow!(
                        "stopped: {} of {} cells are in {path}; {again}",
                        self.tasks,
                        simulation.tasks(),
                    ),
                    signals.status(),
                ))
            }
            Err(error) => Err(Failure::of_sweep(error)),
            Ok(()) => {
                let ended = match self.is_shared {
                    true => self.journal.end(),
                    false => flushed,
                };
                let cannot = || format!("cannot write {path}; {again}");
                ended.with_context(cannot).map_err(Failure::work)?;
                Ok((self.totals, self.warnings))
            }
        }
    }

    /// Stores one output of the task `number`: rows of the table of trials, or the results of the finished cell.
    fn take(&mut self, number: u64, taken: SweepOutput<CellRecord>) -> Result<(), anyhow::Error> {
        match taken {
            SweepOutput::TrialRows(rows) => {
                self.rows.push_str(&rows);
                if self.rows.len() > MAX_PENDING_BYTES {
                    let cell = self.simulation.cell_of(number) as u64;
                    let rows = std::mem::take(&mut self.rows);
                    self.journal.trials(TrialRows { cell, rows })?;
                }
                return Ok(());
            }
            SweepOutput::Result(mut record) => {
                record.rows[3] = std::mem::take(&mut self.rows);
                self.record_cell(record)?;
            }
        }
        self.tasks += 1;
        Ok(())
    }
}

/// The journal of an interrupted run that this run can resume; `None` if the directory has none. Returns an error if
/// the journal belongs to a different run.
pub(super) fn journal_to_resume(
    out: &Path,
    request: &RunRequest,
) -> Result<Option<JournalState>, Failure> {
    // If another process has locked the directory, do not compare the journals. Opening the directory will fail later,
    // with a message about the lock.
    if Lock::is_held(out) {
        return Ok(None);
    }
    let Some(found) = journal::read(out)? else {
        return Ok(None);
    };
    let (known, version) = (&found.header.request, &found.header.version);
    let own = env!("CARGO_PKG_VERSION");
    let why = if version != own {
        format!("written by palpate {version}, but this is {own}")
    } else if known.shard != request.shard {
        let words = |shard: Option<(u64, u64)>| match shard {
            Some((number, of)) => format!("shard {number} of {of}"),
            None => "the whole study".to_owned(),
        };
        format!("of {}, not {}", words(known.shard), words(request.shard))
    } else if known.every_nth_cell != request.every_nth_cell {
        let (known, own) = (known.every_nth_cell, request.every_nth_cell);
        format!("of --every-nth-cell {known}, not {own}")
    } else if known.trials_out != request.trials_out {
        let with = |is: bool| if is { "with" } else { "without" };
        let (known, own) = (with(known.trials_out), with(request.trials_out));
        format!("{known} --trials-out, and this is {own}")
    } else if known.goal != request.goal {
        let or_none = |goal: &str| match goal {
            "" => "without --budget and --target-error".to_owned(),
            goal => format!("with {goal}"),
        };
        let [known, own] = [&known.goal, &request.goal].map(|goal| or_none(goal));
        format!("{known}, and this is {own}")
    } else if known.config != request.config {
        let difference = difference(&known.config, &request.config);
        format!("of another config:{difference}")
    } else {
        return Ok(Some(found));
    };
    if !found.may_have_results() {
        // The journal belongs to another run, but has no finished cell. So a new run may replace it.
        return Ok(None);
    }
    let state = match found.is_ended {
        true => "a shard that is done",
        false => "a run that has not ended",
    };
    Err(Failure::usage(anyhow!(
        "{} is of {state}, {why}\nuse --restart to delete it, or another --out to keep it",
        out.join(JOURNAL).display()
    )))
}

/// Text with the lines that are only in the old config or only in the new config; at most 8 lines.
pub(crate) fn difference(old: &str, new: &str) -> String {
    const MAX_LINES: usize = 8;
    let only = |sign: char, text: &str, other: &str| {
        let mut rest: Vec<&str> = other.lines().collect();
        let mut lines = Vec::new();
        for line in text.lines() {
            match rest.iter().position(|one| *one == line) {
                Some(place) => drop(rest.swap_remove(place)),
                None => lines.push(format!("\n  {sign} {line}")),
            }
        }
        lines
    };
    let (removed, added) = (only('-', old, new), only('+', new, old));
    let count = removed.len() + added.len();
    let half = MAX_LINES / 2;
    let few = removed
        .into_iter()
        .take(half)
        .chain(added.into_iter().take(half));
    let mut text: String = few.collect();
    if count > MAX_LINES {
        text += "\n  …";
    }
    text
}

/// Handlers of the signals `SIGINT` (Ctrl-C) and `SIGTERM` (sent by job schedulers). The first signal stops the run
/// cleanly; a second signal ends the process at once.
struct Signals {
    stop: Arc<AtomicBool>,
    signal: Arc<AtomicUsize>,
    handlers: Vec<SigId>,
}

impl Signals {
    fn new() -> Result<Self, Failure> {
        let stop = Arc::new(AtomicBool::new(false));
        let signal = Arc::new(AtomicUsize::new(0));
        let mut handlers = Vec::new();
        for one in [SIGINT, SIGTERM] {
            let mut listen = || {
                let second =
                    flag::register_conditional_shutdown(one, 128 + one, Arc::clone(&stop))?;
                let which = flag::register_usize(one, Arc::clone(&signal), one as usize)?;
                let first = flag::register(one, Arc::clone(&stop))?;
                handlers.extend([second, which, first]);
                Ok::<(), std::io::Error>(())
            };
            listen()
                .context("cannot install signal handlers")
                .map_err(Failure::work)?;
        }
        Ok(Self {
            stop,
            signal,
            handlers,
        })
    }

    fn stop(&self) -> &AtomicBool {
        &self.stop
    }

    /// Exit status for a run that the signal stopped: 128 plus the number of the signal.
    fn status(&self) -> u8 {
        128 + self.signal.load(Ordering::Relaxed) as u8
    }
}

impl Drop for Signals {
    fn drop(&mut self) {
        for handler in self.handlers.drain(..) {
            low_level::unregister(handler);
        }
    }
}
