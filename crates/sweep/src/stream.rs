//! Runs sweeps. The results are passed on to the caller in the order of the tasks, while later tasks are still running.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::cell::{BLOCK, StoppingRule, Task, Trial};
use crate::partial_statistics::{Partial, Slice, TrialReader};
use crate::queue::{Experiment, Job, Piece, Queue};
use crate::runner::{Runner, SweepError};
use crate::summary::CellStatistics;
use crate::trial_record::{Record, TrialObservations};

/// Describes a sweep to [`Runner::stream`]: lists the tasks, makes the experiment that runs the trials of a cell, and
/// computes the result of a task from the statistics of its trials.
pub trait Sweep: Sync {
    /// Type of a cell's experiment, which runs the trials of the cell.
    type Trial: Trial + Send;
    /// Type of the result of a task, which [`Self::finish`] computes.
    type Result: Send;
    /// Type of error if an experiment cannot be set up.
    type Error: Send;

    /// Number of tasks of the sweep.
    fn tasks(&self) -> u64;

    /// The task with the index `number`, counted from 0.
    fn task(&self, number: u64) -> Task;

    /// Sets up the experiment of a cell before the first trial of the cell is run. This function may be called on any
    /// thread. It must not wait for the threads of the run.
    ///
    /// # Errors
    /// Reason why the cell cannot be run. The error ends the run.
    fn set_up(&self, cell: usize) -> Result<Self::Trial, Self::Error>;

    /// Rule that may end a task before its last trial. It is used only for tasks with `may_stop`. Without a rule
    /// (`None`), all trials of the task are run.
    fn stopping_rule(&self, trial: &Self::Trial) -> Option<StoppingRule> {
        let _ = trial;
        None
    }

    /// Whether the sweep writes an output row for each trial, see [`Self::add_trial_row`].
    fn has_trial_rows(&self) -> bool {
        false
    }

    /// Appends the output row of a trial to `text`. `observed` contains the observations of the trial, or the kind of
    /// its failure. This function may be called on any thread. For the trials of one task, it is called in the order of
    /// the trials.
    fn add_trial_row(
        &self,
        trial: &Self::Trial,
        number: u64,
        observed: Result<&TrialObservations<'_>, &'static str>,
        text: &mut String,
    ) {
        let _ = (trial, number, observed, text);
    }

    /// Computes the result of a cell from its statistics. This function may be called on any thread.
    fn finish(&self, cell: usize, trial: &Self::Trial, statistics: CellStatistics) -> Self::Result;
}

/// A part of the output that a sweep passes on to the caller.
#[derive(Clone, Debug, PartialEq)]
pub enum SweepOutput<R> {
    /// Output rows of consecutive trials of a task. They continue the rows that were passed on before for this task.
    TrialRows(String),
    /// Result of a task. It is passed on after all rows of the task's trials.
    Result(R),
}

impl Runner {
    /// Runs the tasks of a sweep and passes their results to `take`, one at a time in the order of the tasks. The run
    /// ends early if another thread sets `cancelled`, or if `take` returns `Break`. A thread calls `progress` each time
    /// it has run some trials, with the number of these trials.
    ///
    /// Memory contains only the experiments that are in use, and results that wait for an earlier result. Therefore,
    /// the required memory does not grow with the number of tasks or trials. The results do not depend on which thread
    /// runs which trials.
    ///
    /// ```
    /// use std::convert::Infallible;
    /// use std::ops::ControlFlow;
    /// use std::sync::atomic::AtomicBool;
    /// use palpate_sweep::{
    ///     CellStatistics, Observation, Record, RunOptions, Runner, Sweep, SweepOutput, Task, Trial,
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
    ///     if let SweepOutput::Result(mean) = taken {
    ///         means.push(mean);
    ///     }
    ///     ControlFlow::Continue(())
    /// })?;
    /// assert_eq!(means, [Some(0.0), Some(1.0), Some(2.0)]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SweepError::SetUp`] of the first cell that cannot be set up; before, `take` receives the results of all
    /// earlier tasks. [`SweepError::Cancelled`] if the run was cancelled or `take` returned `Break`.
    ///
    /// # Panics
    /// Panics if a trial, `progress` or `take` panics.
    pub fn stream<S: Sweep>(
        &self,
        sweep: &S,
        cancelled: &AtomicBool,
        progress: &(dyn Fn(u64) + Sync),
        take: &mut (dyn FnMut(u64, SweepOutput<S::Result>) -> ControlFlow<()> + Send),
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

struct Crew<'a, S: Sweep, F> {
    sweep: &'a S,
    queue: &'a Queue<S::Trial, S::Error, F>,
    cancelled: &'a AtomicBool,
    progress: &'a (dyn Fn(u64) + Sync),
    has_clock: bool,
    line: Mutex<Line<'a, S>>,
}

/// Results that have not been passed to `take` yet, in the order of the jobs.
struct Line<'a, S: Sweep> {
    /// Results that must wait for the results of an earlier job. The key is the number of the job that computed the
    /// results.
    waiting: BTreeMap<u64, Vec<Ran<S>>>,
    /// Number of the job whose results will be passed to `take` next.
    head: u64,
    open: Option<Open>,
    /// Number of tasks whose results have been passed to `take`.
    tasks: u64,
    failed: Option<S::Error>,
    take: &'a mut (dyn FnMut(u64, SweepOutput<S::Result>) -> ControlFlow<()> + Send),
}

/// A task that is not complete: some of its trials have been run, and others have not.
#[derive(Default)]
struct Open {
    /// Statistics of the trials in completed blocks.
    cell: Partial,
    /// Trials of the first block that is not complete yet.
    block: Slice,
}

struct Ran<S: Sweep> {
    number: u64,
    task: Task,
    /// Number of the first trial after the trials of these results.
    end: u64,
    /// The experiment of the cell. `None` if the task is complete, because the experiment is then no longer needed.
    experiment: Option<Arc<Experiment<S::Trial, S::Error>>>,
    sums: Sum<S::Result>,
    text: String,
}

enum Sum<R> {
    Whole(R),
    Blocks(Partial),
    Slice(Slice),
    Failed,
}

/// A guard of a thread: if the thread panics, the guard stops the queue, so that the run ends on all threads.
struct Fuse<'a, T, E, F: Fn(u64) -> Task>(&'a Queue<T, E, F>);

impl<T, E, F: Fn(u64) -> Task> Drop for Fuse<'_, T, E, F> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.stop();
        }
    }
}

impl<S: Sweep, F: Fn(u64) -> Task> Crew<'_, S, F> {
    fn work(&self) {
        let _fuse = Fuse(self.queue);
        let mut record = Record::default();
        while !self.is_cancelled()
            && let Some(job) = self.queue.job(self.has_clock)
        {
            let number = job.number;
            match self.run(job, &mut record) {
                Some(ran) => self.pass_on(number, ran),
                None => break,
            }
        }
        // If the run is cancelled, this thread drops its results. Other threads may be waiting until these results are
        // passed on, so stop the queue.
        if self.is_cancelled() {
            self.queue.stop();
        }
    }

    fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

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
            // If the run was cancelled, this piece may be incomplete, so its results are dropped.
            if self.is_cancelled() {
                return None;
            }
            trials += ran;
            (self.progress)(piece.trials.end - piece.trials.start);
            let is_complete = matches!(sums, Sum::Whole(_));
            all.push(Ran {
                number: piece.number,
                task: piece.task,
                end: piece.trials.end,
                experiment: (!is_complete).then_some(piece.experiment),
                sums,
                text,
            });
        }
        if self.has_clock {
            self.queue.set_time(trials, time);
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

    /// Runs the trials of a piece of a task (consecutive trials of the task). If the sweep writes a row per trial, the
    /// rows are appended to `text`. If the piece is the whole task, a stopping rule may end the task early; then `ran`
    /// is set to the number of trials that were run.
    fn sum(
        &self,
        piece: &Piece<S::Trial, S::Error>,
        trial: &S::Trial,
        record: &mut Record,
        ran: &mut u64,
        text: &mut String,
    ) -> Sum<S::Result> {
        let Piece { task, trials, .. } = piece;
        let mut add_row = |number: u64, observed: Result<&TrialObservations<'_>, &'static str>| {
            self.sweep.add_trial_row(trial, number, observed, text);
        };
        let mut reader = self.sweep.has_trial_rows().then_some(&mut add_row);
        // An experiment that is not random has one trial.
        let most = if trial.is_random() { u64::MAX } else { 1 };
        let is_whole = piece.is_whole();
        let is_end = |trial: u64| trial.is_multiple_of(BLOCK) || trial == task.trials;
        let is_slice = !trials.start.is_multiple_of(BLOCK) || !is_end(trials.end);
        if !is_whole && (task.may_stop || is_slice) {
            let trials = trials.start..trials.end.min(most).max(trials.start);
            let reader = reader.map(|reader| reader as &mut TrialReader<'_>);
            return Sum::Slice(Slice::run(trial, trials, record, self.cancelled, reader));
        }
        let rule = task
            .may_stop
            .then(|| self.sweep.stopping_rule(trial))
            .flatten();
        let mut blocks = Partial::new(trial.quantities());
        let mut start = trials.start;
        loop {
            let end = trials.end.min(start + BLOCK);
            if start == 0 || start < end.min(most) {
                let reader = reader
                    .as_mut()
                    .map(|reader| &mut **reader as &mut TrialReader<'_>);
                blocks.run_block(trial, start..end.min(most), record, self.cancelled, reader);
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

    /// Stores the results of the job `number`. Then passes on these and later results in order, up to the first job
    /// whose results are missing.
    fn pass_on(&self, number: u64, ran: Vec<Ran<S>>) {
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
        // All tasks are complete. If a stopping rule has ended the last task early, the queue still has trials of this
        // task, so stop it.
        if line.tasks == self.sweep.tasks() {
            self.queue.stop();
        }
        if line.head > before {
            self.queue.set_passed_on(line.head);
        }
    }
}

impl<S: Sweep> Line<'_, S> {
    /// Adds the results of the next trials to the open task. If they complete the task, its result is passed on.
    fn put(&mut self, sweep: &S, ran: Ran<S>) -> ControlFlow<()> {
        if self.failed.is_some() {
            return ControlFlow::Break(());
        }
        // A rule has already ended the task of these trials, so do not use them.
        if ran.number < self.tasks {
            return ControlFlow::Continue(());
        }
        let Ran { number, task, .. } = ran;
        let rows = ran.text;
        if !rows.is_empty() && (self.take)(number, SweepOutput::TrialRows(rows)).is_break() {
            return ControlFlow::Break(());
        }
        let experiment = ran.experiment.as_ref();
        let experiment = experiment.and_then(|experiment| experiment.get());
        if let Some(Err(error)) = experiment {
            let error = error.lock();
            self.failed = error.unwrap_or_else(PoisonError::into_inner).take();
            return ControlFlow::Break(());
        }
        let trial = experiment.and_then(|experiment| experiment.as_ref().ok());
        let result = match ran.sums {
            Sum::Whole(result) => result,
            Sum::Failed => return ControlFlow::Break(()),
            sums => {
                let Some(trial) = trial else {
                    return ControlFlow::Break(());
                };
                let mut open = self.open.take().unwrap_or_default();
                let mut is_end = ran.end == task.trials || task.may_stop && !trial.is_random();
                match sums {
                    Sum::Blocks(blocks) => open.cell.merge(blocks),
                    Sum::Slice(slice) => {
                        open.block.append(slice);
                        if is_end || ran.end.is_multiple_of(BLOCK) {
                            std::mem::take(&mut open.block).end(&mut open.cell);
                            let rule = task.may_stop.then(|| sweep.stopping_rule(trial)).flatten();
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
        (self.take)(number, SweepOutput::Result(result))
    }
}
