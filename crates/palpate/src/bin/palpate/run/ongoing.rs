//! A run that keeps a journal of what it has done.

use std::ops::ControlFlow;
use std::path::Path;

use anyhow::{Context, anyhow};
use palpate::{Finished, Simulation, SweepError, SweepOutput, Warnings};

use crate::failure::Failure;
use crate::journal::{self, CellRecord, Found, Header, Journal, Totals, TrialRows};
use crate::output::names::JOURNAL;
use crate::progress::Progress;
use crate::stopped;

/// Run of which some tasks are done.
pub(super) struct Ongoing<'s, 'a> {
    simulation: &'s Simulation<'a>,
    journal: Journal,
    totals: Totals,
    warnings: Warnings,
    /// Number of tasks that are done.
    tasks: u64,
    /// Trial rows of the unfinished cell that are not yet in the journal.
    rows: String,
    is_shared: bool,
}

/// Rows of trials that are kept in memory before they are written, bytes.
const MOST_ROWS: usize = 1 << 20;

impl<'s, 'a> Ongoing<'s, 'a> {
    /// Begins a journal, or goes on with one that was found.
    pub(super) fn begin(
        simulation: &'s Simulation<'a>,
        out: &Path,
        header: Header,
        warnings: Warnings,
        found: Option<Found>,
        restarts: bool,
    ) -> Result<Self, Failure> {
        let is_shared = header.asked.shard.is_some();
        // Since it was looked for, another process may have ended it, or begun one.
        let now = match restarts {
            true => None,
            false => journal::read(out)?.filter(Found::has_work),
        };
        let is_known = now.as_ref().is_none_or(|now| {
            let found = found.as_ref();
            found.is_some_and(|found| found.header == now.header)
        });
        let path = out.join(JOURNAL);
        let cannot = || format!("cannot write {}", path.display());
        if !is_known {
            return Err(Failure::work(anyhow!(
                "another process wrote {} meanwhile: give the same command again",
                path.display()
            )));
        }
        let Some(found) = now else {
            let journal = Journal::new(out, &header).with_context(cannot);
            return Ok(Self {
                simulation,
                journal: journal.map_err(Failure::work)?,
                totals: Totals::default(),
                warnings,
                tasks: 0,
                rows: String::new(),
                is_shared,
            });
        };
        if found.is_torn {
            eprintln!(
                "note: the end of {} is damaged, and is done again",
                path.display()
            );
        }
        let all = simulation.tasks();
        eprintln!("note: goes on after {} of {all} cells", found.tasks);
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

    /// Notes a cell that is done.
    fn cell(&mut self, record: CellRecord) -> std::io::Result<()> {
        self.totals.add(&record);
        let warnings = record.warnings.clone();
        self.warnings.add(record.cell as usize, warnings);
        self.journal.cell(record)
    }

    /// Runs the tasks that are left.
    pub(super) fn run(mut self) -> Result<(Totals, Warnings), Failure> {
        let simulation = self.simulation;
        let all = simulation.trials();
        let done = simulation.trials_before(self.tasks);
        let progress = Progress::new(all, done);
        let signals = stopped::Signals::new()?;
        let first = self.tasks;
        let mut error = None;
        let ran = simulation.stream(
            first,
            signals.stop(),
            &|trials| progress.add(trials),
            |finished: Finished| CellRecord::new(finished.cell(), simulation.rows(&finished)),
            &mut |number, taken| match self.take(number, taken) {
                Ok(()) => {
                    progress.tell(&self.totals);
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
        let again = "the same command goes on from there";
        if let Some(error) = error {
            let error = error.context(format!(
                "cannot write {path}; what is written stays, and {again}"
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

    /// Notes rows of trials of the task of this number.
    fn trials(&mut self, number: u64, rows: &str) -> Result<(), anyhow::Error> {
        self.rows.push_str(rows);
        if self.rows.len() > MOST_ROWS {
            self.put_rows(number)?;
        }
        Ok(())
    }

    /// Writes the rows of trials of the task of this number.
    fn put_rows(&mut self, number: u64) -> std::io::Result<()> {
        let rows = std::mem::take(&mut self.rows);
        if rows.is_empty() {
            return Ok(());
        }
        let cell = self.simulation.cell_of(number) as u64;
        self.journal.trials(TrialRows { cell, rows })
    }

    /// Notes what a task gave.
    fn take(&mut self, number: u64, taken: SweepOutput<CellRecord>) -> Result<(), anyhow::Error> {
        match taken {
            SweepOutput::TrialRows(rows) => return self.trials(number, &rows),
            SweepOutput::Result(mut record) => {
                record.rows[3] = std::mem::take(&mut self.rows);
                self.cell(record)?;
            }
        }
        self.tasks += 1;
        Ok(())
    }
}
