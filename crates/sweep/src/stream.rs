//! A sweep whose results are handed over in the order of its tasks, while it runs.

use std::collections::BTreeMap;
use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::partial::{Note, Partial, Slice};
use crate::queue::{Experiment, Job, Piece, Queue};
use crate::record::{Record, TrialObservations};
use crate::runner::{Runner, SweepError};
use crate::summary::CellStatistics;
use crate::task::{Stop, Task};
use crate::trial::{BLOCK, Trial};

/// Sweep: tasks, the experiments of their cells, and what is made of each.
pub trait Sweep: Sync {
    /// Experiment of a cell.
    type Trial: Trial + Send;
    /// Result of a task.
    type Result: Send;
    /// Error of setting up an experiment.
    type Error: Send;

    /// Number of tasks.
    fn tasks(&self) -> u64;

    /// Task of this number.
    fn task(&self, number: u64) -> Task;

    /// Sets up the experiment of a cell: on any thread when its first trial is due. It must not wait for the threads of
    /// the run.
    ///
    /// # Errors
    /// Reason why the cell cannot be run; it ends the run.
    fn set_up(&self, cell: usize) -> Result<Self::Trial, Self::Error>;

    /// Rule by which a cell of a task that may stop has had enough trials; without one it runs all of them.
    fn stop(&self, trial: &Self::Trial) -> Option<Stop> {
        let _ = trial;
        None
    }

    /// Whether single trials are noted.
    fn is_noted(&self) -> bool {
        false
    }

    /// Appends a note on trial `number` to `text`: on its observations, or on the kind of its failure. Called on any
    /// thread, in the order of the trials of a task.
    fn note(
        &self,
        trial: &Self::Trial,
        number: u64,
        observed: Result<&TrialObservations<'_>, &'static str>,
        text: &mut String,
    ) {
        let _ = (trial, number, observed, text);
    }

    /// Computes the result of a cell. Called on any thread.
    fn finish(&self, cell: usize, trial: &Self::Trial, statistics: CellStatistics) -> Self::Result;
}

/// Piece of a sweep's outcome, handed over as it comes.
#[derive(Clone, Debug, PartialEq)]
pub enum Taken<R> {
    /// Notes on some trials of a task, those that follow the notes before.
    Note(String),
    /// Result of a task, after all notes on its trials.
    Result(R),
}

impl Runner {
    /// Runs the tasks of a sweep and passes their results to `take`, in the order of the tasks and one at a time,
    /// until another thread sets `cancelled` or `take` breaks. Each thread calls `progress` with the number of trials
    /// that it has run since its last call.
    ///
    /// Memory holds only the experiments in use and the results that wait for an earlier one, so that it grows
    /// neither with the tasks nor with the trials. Results do not depend on how trials are divided among threads.
    ///
    /// ```
    /// use std::convert::Infallible;
    /// use std::ops::ControlFlow;
    /// use std::sync::atomic::AtomicBool;
    /// use palpate_sweep::{
    ///     CellStatistics, Observation, Record, RunOptions, Runner, Sweep, Taken, Task, Trial,
    /// };
    ///
    /// /// Estimates its truth without an error.
    /// struct Exact(f64);
    /// impl Trial for Exact {
    ///     fn quantities(&self) -> usize { 1 }
    ///     fn run(&self, _trial: u64, record: &mut Record) -> Result<(), &'static str> {
    ///         let (estimate, truth) = (self.0, self.0);
    ///         record.observe(0, Observation { estimate, truth, std: None, interval_holds: None });
    ///         Ok(())
    ///     }
    /// }
    ///
    /// struct Means;
    /// impl Sweep for Means {
    ///     type Trial = Exact;
    ///     type Result = Option<f64>;
    ///     type Error = Infallible;
    ///     fn tasks(&self) -> u64 { 3 }
    ///     fn task(&self, number: u64) -> Task { Task { cell: number as usize, trials: 20, may_stop: false } }
    ///     fn set_up(&self, cell: usize) -> Result<Exact, Infallible> { Ok(Exact(cell as f64)) }
    ///     fn finish(&self, _cell: usize, _trial: &Exact, statistics: CellStatistics) -> Option<f64> {
    ///         statistics.quantities[0].mean
    ///     }
    /// }
    ///
    /// let mut means = Vec::new();
    /// let runner = Runner::new(&RunOptions::default())?;
    /// runner.stream(&Means, &AtomicBool::new(false), &|_finished| (), &mut |_task, taken| {
    ///     if let Taken::Result(mean) = taken {
    ///         means.push(mean);
    ///     }
    ///     ControlFlow::Continue(())
    /// })?;
    /// assert_eq!(means, [Some(0.0), Some(1.0), Some(2.0)]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SweepError::SetUp`] of the first cell that cannot be set up, after the results before it;
    /// [`SweepError::Cancelled`], also where `take` broke.
    ///
    /// # Panics
    /// Where a trial, `progress` or `take` does.
    pub fn stream<S: Sweep>(
        &self,
        sweep: &S,
        cancelled: &AtomicBool,
        progress: &(dyn Fn(u64) + Sync),
        take: &mut (dyn FnMut(u64, Taken<S::Result>) -> ControlFlow<()> + Send),
    ) -> Result<(), SweepError<S::Error>> {
        let queue = Queue::new(sweep.tasks(), |number| sweep.task(number));
        let crew = Crew {
            sweep,
            queue: &queue,
            cancelled,
            progress,
            has_clock: self.has_clock(),
            line: Mutex::new(Line {
                waiting: BTreeMap::new(),
                head: 0,
                open: None,
                tasks: 0,
                failed: None,
                take,
            }),
        };
        self.everywhere(|| crew.work());
        let line = crew.line.into_inner();
        let line = line.unwrap_or_else(PoisonError::into_inner);
        match line.failed {
            Some(error) => Err(SweepError::SetUp(error)),
            None if line.tasks < sweep.tasks() => Err(SweepError::Cancelled),
            None => Ok(()),
        }
    }
}

/// The threads of a run.
struct Crew<'a, S: Sweep, F> {
    sweep: &'a S,
    queue: &'a Queue<S::Trial, S::Error, F>,
    cancelled: &'a AtomicBool,
    progress: &'a (dyn Fn(u64) + Sync),
    has_clock: bool,
    line: Mutex<Line<'a, S>>,
}

/// Results on their way to whoever takes them.
struct Line<'a, S: Sweep> {
    /// Results of jobs that wait for an earlier one.
    waiting: BTreeMap<u64, Vec<Ran<S>>>,
    /// Number of the job whose results are due.
    head: u64,
    open: Option<Open>,
    /// Number of the tasks whose results have been taken.
    tasks: u64,
    failed: Option<S::Error>,
    take: &'a mut (dyn FnMut(u64, Taken<S::Result>) -> ControlFlow<()> + Send),
}

/// Task whose first trials have been run.
#[derive(Default)]
struct Open {
    /// Trials of the completed blocks.
    cell: Partial,
    /// Trials of the block that is not complete yet.
    block: Slice,
}

/// Trials of a task that have been run.
struct Ran<S: Sweep> {
    /// Number of the task.
    number: u64,
    task: Task,
    /// Number of the trial after the last of them.
    end: u64,
    /// Experiment, unless the task is done: then nothing is asked of it any more.
    experiment: Option<Arc<Experiment<S::Trial, S::Error>>>,
    sums: Sum<S::Result>,
    /// Notes on them.
    text: String,
}

enum Sum<R> {
    Whole(R),
    Blocks(Partial),
    Slice(Slice),
    /// The experiment could not be set up.
    Failed,
}

/// Ends the run of all threads where one panics.
struct Fuse<'a, T, E, F: Fn(u64) -> Task>(&'a Queue<T, E, F>);

impl<T, E, F: Fn(u64) -> Task> Drop for Fuse<'_, T, E, F> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.stop();
        }
    }
}

impl<S: Sweep, F: Fn(u64) -> Task> Crew<'_, S, F> {
    /// Works until nothing is left to do.
    fn work(&self) {
        let _fuse = Fuse(self.queue);
        let mut record = Record::default();
        while !self.is_cancelled()
            && let Some(job) = self.queue.job(self.has_clock)
        {
            let number = job.number;
            match self.run(job, &mut record) {
                Some(ran) => self.hand_over(number, ran),
                None => break,
            }
        }
        // Others may wait for what this thread has dropped.
        if self.is_cancelled() {
            self.queue.stop();
        }
    }

    fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Runs the trials of a job; `None` where the run was cancelled meanwhile.
    fn run(&self, job: Job<S::Trial, S::Error>, record: &mut Record) -> Option<Vec<Ran<S>>> {
        let mut all = Vec::with_capacity(job.pieces.len());
        let mut trials = 0;
        let mut time = Duration::ZERO;
        for piece in job.pieces {
            let experiment = self.experiment(&piece);
            let mut ran = piece.trials.end - piece.trials.start;
            let mut text = String::new();
            let sums = match experiment {
                Ok(trial) => {
                    let start = self.has_clock.then(Instant::now);
                    let sums = self.sum(&piece, trial, record, &mut ran, &mut text);
                    time += start.map_or(Duration::ZERO, |start| start.elapsed());
                    sums
                }
                Err(_) => Sum::Failed,
            };
            // A trial may have cancelled the run, or another thread: its numbers are not all there.
            if self.is_cancelled() {
                return None;
            }
            trials += ran;
            (self.progress)(piece.trials.end - piece.trials.start);
            let Piece {
                number,
                task,
                trials: Range { end, .. },
                experiment,
            } = piece;
            let experiment = match sums {
                Sum::Whole(_) => None,
                _ => Some(experiment),
            };
            all.push(Ran {
                number,
                task,
                end,
                experiment,
                sums,
                text,
            });
        }
        if self.has_clock {
            self.queue.timed(trials, time);
        }
        Some(all)
    }

    fn experiment<'p>(
        &self,
        piece: &'p Piece<S::Trial, S::Error>,
    ) -> &'p Result<S::Trial, Mutex<Option<S::Error>>> {
        let set_up = || {
            let trial = self.sweep.set_up(piece.task.cell);
            trial.map_err(|error| Mutex::new(Some(error)))
        };
        piece.experiment.get_or_init(set_up)
    }

    /// Runs the trials of a piece, and appends notes on them to `text` if the sweep has notes. If a rule ends the
    /// trials early, `ran` becomes their number.
    fn sum(
        &self,
        piece: &Piece<S::Trial, S::Error>,
        trial: &S::Trial,
        record: &mut Record,
        ran: &mut u64,
        text: &mut String,
    ) -> Sum<S::Result> {
        let Piece { task, trials, .. } = piece;
        let mut add_note = |number: u64, observed: Result<&TrialObservations<'_>, &'static str>| {
            self.sweep.note(trial, number, observed, text);
        };
        let mut note = self.sweep.is_noted().then_some(&mut add_note);
        // The first trial tells all where nothing is random.
        let most = if trial.is_random() { u64::MAX } else { 1 };
        let is_whole = piece.is_whole();
        let is_end = |trial: u64| trial.is_multiple_of(BLOCK) || trial == task.trials;
        let is_slice = !trials.start.is_multiple_of(BLOCK) || !is_end(trials.end);
        if !is_whole && (task.may_stop || is_slice) {
            let trials = trials.start..trials.end.min(most).max(trials.start);
            let note = note.map(|note| note as &mut Note<'_>);
            return Sum::Slice(Slice::run(trial, trials, record, self.cancelled, note));
        }
        let rule = task.may_stop.then(|| self.sweep.stop(trial)).flatten();
        let mut blocks = Partial::new(trial.quantities());
        let mut start = trials.start;
        loop {
            let end = trials.end.min(start + BLOCK);
            if start == 0 || start < end.min(most) {
                let note = note.as_mut().map(|note| &mut **note as &mut Note<'_>);
                blocks.run_block(trial, start..end.min(most), record, self.cancelled, note);
            }
            start = end;
            if is_whole {
                blocks.fold();
            }
            let is_enough = rule.is_some_and(|rule| rule.is_met(&blocks));
            if is_enough || start >= trials.end.min(most) || self.is_cancelled() {
                break;
            }
        }
        if !is_whole {
            return Sum::Blocks(blocks);
        }
        *ran = blocks.trials;
        Sum::Whole(self.sweep.finish(task.cell, trial, blocks.statistics()))
    }

    /// Puts the results of a job into the line, and hands over those that are due.
    fn hand_over(&self, number: u64, ran: Vec<Ran<S>>) {
        let line = self.line.lock();
        let mut line = line.unwrap_or_else(PoisonError::into_inner);
        line.waiting.insert(number, ran);
        let before = line.head;
        while let head = line.head
            && let Some(job) = line.waiting.remove(&head)
        {
            for ran in job {
                if line.put(self.sweep, ran).is_break() {
                    line.waiting.clear();
                    return self.queue.stop();
                }
            }
            line.head += 1;
        }
        // A rule may have ended the last task before its last trial.
        if line.tasks == self.sweep.tasks() {
            self.queue.stop();
        }
        if line.head > before {
            self.queue.taken(line.head);
        }
    }
}

impl<S: Sweep> Line<'_, S> {
    /// Adds trials that follow those before.
    fn put(&mut self, sweep: &S, ran: Ran<S>) -> ControlFlow<()> {
        if self.failed.is_some() {
            return ControlFlow::Break(());
        }
        // Trials after those that were enough.
        if ran.number < self.tasks {
            return ControlFlow::Continue(());
        }
        let Ran {
            number,
            task,
            end,
            experiment,
            sums,
            text,
        } = ran;
        if !text.is_empty() && (self.take)(number, Taken::Note(text)).is_break() {
            return ControlFlow::Break(());
        }
        let experiment = experiment.as_ref().and_then(|experiment| experiment.get());
        if let Some(Err(error)) = experiment {
            let error = error.lock();
            self.failed = error.unwrap_or_else(PoisonError::into_inner).take();
            return ControlFlow::Break(());
        }
        let trial = experiment.and_then(|experiment| experiment.as_ref().ok());
        let result = match sums {
            Sum::Whole(result) => result,
            Sum::Failed => return ControlFlow::Break(()),
            Sum::Blocks(_) | Sum::Slice(_) => {
                let Some(trial) = trial else {
                    return ControlFlow::Break(());
                };
                let mut open = self.open.take().unwrap_or_default();
                let mut is_end = end == task.trials || task.may_stop && !trial.is_random();
                match sums {
                    Sum::Blocks(blocks) => open.cell.merge(blocks),
                    Sum::Slice(slice) => {
                        open.block.append(slice);
                        if is_end || end.is_multiple_of(BLOCK) {
                            std::mem::take(&mut open.block).end(&mut open.cell);
                            let rule = task.may_stop.then(|| sweep.stop(trial)).flatten();
                            is_end |= rule.is_some_and(|rule| rule.is_met(&open.cell));
                        }
                    }
                    Sum::Whole(_) | Sum::Failed => {}
                }
                if !is_end {
                    self.open = Some(open);
                    return ControlFlow::Continue(());
                }
                sweep.finish(task.cell, trial, open.cell.statistics())
            }
        };
        self.tasks += 1;
        (self.take)(number, Taken::Result(result))
    }
}
