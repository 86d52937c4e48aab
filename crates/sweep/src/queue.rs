//! Queue of the trials that the threads run, in the order of the tasks.

use std::ops::Range;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Duration;

use crate::cell::BLOCK;
use crate::cell::Task;

/// Approximate time of a job's trials: long compared with the work of the queue, short compared with a run.
pub const JOB: Duration = Duration::from_millis(4);
/// Largest number of blocks in a job.
const MAX_BLOCKS: u64 = 64;
/// Number of jobs by which fast threads may be ahead of a slow thread.
const AHEAD: u64 = 512;
/// The same number for cells whose trials a rule may end.
const AHEAD_WITH_RULE: u64 = 128;

/// Experiment of a cell, or the error of setting it up. The first thread that needs it sets it up; the last user drops
/// it.
pub(crate) type Experiment<T, E> = OnceLock<Result<T, Mutex<Option<E>>>>;

/// Work for one thread.
pub(crate) struct Job<T, E> {
    /// Number of the job, from 0.
    pub(crate) number: u64,
    pub(crate) pieces: Vec<Piece<T, E>>,
}

/// Trials of a task: all of them, whole blocks, or some within one block.
pub(crate) struct Piece<T, E> {
    /// Number of the task.
    pub(crate) number: u64,
    pub(crate) task: Task,
    pub(crate) trials: Range<u64>,
    pub(crate) experiment: Arc<Experiment<T, E>>,
}

impl<T, E> Piece<T, E> {
    /// Whether the piece holds all trials of the task.
    pub(crate) fn is_whole(&self) -> bool {
        self.trials == (0..self.task.trials)
    }
}

/// Queue of the tasks that have not been run yet.
pub(crate) struct Queue<T, E, F> {
    tasks: u64,
    task: F,
    state: Mutex<State<T, E>>,
    changed: Condvar,
}

/// Task that is being handed out, the next of its trials to hand out, and its experiment.
type OpenTask<T, E> = (Task, u64, Arc<Experiment<T, E>>);

struct State<T, E> {
    open: Option<OpenTask<T, E>>,
    /// Number of the open task, or of the next.
    next: u64,
    /// Number of jobs handed out, and number of those whose results have been passed on.
    jobs: [u64; 2],
    is_stopped: bool,
    /// Time per trial in the last job, s; `None` before the first job has ended, or without a clock.
    trial_s: Option<f64>,
}

impl<T, E> State<T, E> {
    /// Number of jobs by which fast threads may be ahead.
    fn max_ahead(&self) -> u64 {
        let has_rule = self.open.as_ref().is_some_and(|(task, ..)| task.may_stop);
        if has_rule { AHEAD_WITH_RULE } else { AHEAD }
    }
}

impl<T, E, F: Fn(u64) -> Task> Queue<T, E, F> {
    /// Queue of this many tasks.
    pub(crate) fn new(tasks: u64, task: F) -> Self {
        Self {
            tasks,
            task,
            state: Mutex::new(State {
                open: None,
                next: 0,
                jobs: [0, 0],
                is_stopped: false,
                trial_s: None,
            }),
            changed: Condvar::new(),
        }
    }

    /// The next job; `None` if no trials are left. `has_clock` is whether jobs are timed.
    pub(crate) fn job(&self, has_clock: bool) -> Option<Job<T, E>> {
        let mut state = self.state();
        while !state.is_stopped && state.jobs[0] >= state.jobs[1] + state.max_ahead() {
            let waited = self.changed.wait(state);
            state = waited.unwrap_or_else(PoisonError::into_inner);
        }
        if state.is_stopped {
            return None;
        }
        let mut pieces = Vec::new();
        let mut blocks = 0;
        let mut left_s = JOB.as_secs_f64();
        while blocks < MAX_BLOCKS
            && let Some(piece) = self.piece(&mut state, has_clock, pieces.is_empty(), &mut left_s)
        {
            blocks += (piece.trials.end - piece.trials.start)
                .div_ceil(BLOCK)
                .max(1);
            let may_be_too_many = piece.task.may_stop && !piece.is_whole();
            pieces.push(piece);
            if may_be_too_many {
                break;
            }
        }
        let number = state.jobs[0];
        state.jobs[0] += u64::from(!pieces.is_empty());
        (!pieces.is_empty()).then_some(Job { number, pieces })
    }

    /// The next trials of a task that fit into the time left. The first piece of a job may take longer.
    fn piece(
        &self,
        state: &mut State<T, E>,
        has_clock: bool,
        is_first: bool,
        left_s: &mut f64,
    ) -> Option<Piece<T, E>> {
        let (task, start, experiment) = match state.open.take() {
            Some(open) => open,
            None if state.next < self.tasks => ((self.task)(state.next), 0, Arc::default()),
            None => return None,
        };
        let end = task.trials;
        let fitting = match (has_clock, state.trial_s) {
            (false, _) => MAX_BLOCKS * BLOCK,
            // A single trial, to measure its time.
            (true, None) => 1,
            (true, Some(trial_s)) => (*left_s / trial_s).clamp(0.0, 1e18) as u64,
        };
        let block_end = (start - start % BLOCK).saturating_add(BLOCK).min(end);
        let to_block = block_end - start;
        // The end of a task with a rule is not known in advance. Threads share only the last task; some of its trials
        // may be beyond its end.
        let is_last = has_clock && state.next + 1 == self.tasks;
        let is_whole = task.may_stop && !is_last && start == 0;
        let taken = if is_whole {
            end - start
        } else if task.may_stop && fitting >= to_block {
            to_block
        } else if start.is_multiple_of(BLOCK) && fitting >= to_block {
            let blocks = (fitting / BLOCK).clamp(1, MAX_BLOCKS);
            (end - start).min(blocks * BLOCK)
        } else if is_first {
            // A multiple of 8, because up to 8 trials run side by side.
            let whole = if fitting > 8 {
                fitting - fitting % 8
            } else {
                fitting
            };
            to_block.min(whole.max(1))
        } else {
            state.open = Some((task, start, experiment));
            return None;
        };
        let until = start + taken;
        if let Some(trial_s) = state.trial_s {
            *left_s -= trial_s * taken as f64;
        }
        let number = state.next;
        if until < end {
            state.open = Some((task, until, Arc::clone(&experiment)));
        } else {
            state.next += 1;
        }
        Some(Piece {
            number,
            task,
            trials: start..until,
            experiment,
        })
    }

    /// Stores the time of a job's trials.
    pub(crate) fn set_time(&self, trials: u64, time: Duration) {
        if trials > 0 {
            let trial_s = time.as_secs_f64() / trials as f64;
            self.state().trial_s = Some(trial_s.max(1e-10));
        }
    }

    /// Stores the number of jobs whose results have been passed on.
    pub(crate) fn set_passed_on(&self, jobs: u64) {
        self.state().jobs[1] = jobs;
        self.changed.notify_all();
    }

    /// Ends the queue: it hands out no more jobs.
    pub(crate) fn stop(&self) {
        self.state().is_stopped = true;
        self.changed.notify_all();
    }

    /// State. Every change is a single step, so that the state is valid even if another thread panicked.
    fn state(&self) -> MutexGuard<'_, State<T, E>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
