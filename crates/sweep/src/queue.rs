//! Tasks handed out to threads, in their order.

use std::ops::Range;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Duration;

use crate::task::Task;
use crate::trial::BLOCK;

/// Time that the trials of a job take, roughly: long against handing it out, short against a run.
pub(crate) const JOB: Duration = Duration::from_millis(4);
/// Most blocks of a job.
const MOST_BLOCKS: u64 = 64;
/// Jobs by which the results of quick threads may be ahead of a slow one's.
const AHEAD: u64 = 512;

/// The same limit for cells whose trials a stopping rule may end.
const AHEAD_OF_RULE: u64 = 128;

/// Experiment of a cell, set up by the first thread that needs it and dropped by the last; or why there is none.
pub(crate) type Experiment<T, E> = OnceLock<Result<T, Mutex<Option<E>>>>;

/// Work for one thread.
pub(crate) struct Job<T, E> {
    /// Its place among all jobs.
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

/// The tasks that are left.
pub(crate) struct Queue<T, E, F> {
    tasks: u64,
    task: F,
    state: Mutex<State<T, E>>,
    moved: Condvar,
}

/// Task that is being handed out, the next of its trials to hand out, and its experiment.
type OpenTask<T, E> = (Task, u64, Arc<Experiment<T, E>>);

struct State<T, E> {
    open: Option<OpenTask<T, E>>,
    /// Number of the open task, or of the next.
    next: u64,
    /// Number of jobs handed out, and of those whose results have been taken.
    jobs: [u64; 2],
    is_stopped: bool,
    /// Time of a trial in the last job, s; `None` before there was one, or without a clock.
    trial_s: Option<f64>,
}

impl<T, E> State<T, E> {
    /// Jobs by which quick threads may be ahead.
    fn ahead(&self) -> u64 {
        let has_rule = self.open.as_ref().is_some_and(|(task, ..)| task.may_stop);
        if has_rule { AHEAD_OF_RULE } else { AHEAD }
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
            moved: Condvar::new(),
        }
    }

    /// The next job; `None` where nothing is left to do. `has_clock` tells whether jobs are timed.
    pub(crate) fn job(&self, has_clock: bool) -> Option<Job<T, E>> {
        let mut state = self.state();
        while !state.is_stopped && state.jobs[0] >= state.jobs[1] + state.ahead() {
            let waited = self.moved.wait(state);
            state = waited.unwrap_or_else(PoisonError::into_inner);
        }
        if state.is_stopped {
            return None;
        }
        let mut pieces = Vec::new();
        let mut blocks = 0;
        let mut left_s = JOB.as_secs_f64();
        while blocks < MOST_BLOCKS
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

    /// The next trials of a task that fit into the time; the first of a job need not.
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
            (false, _) => MOST_BLOCKS * BLOCK,
            // The first trials tell the time of one.
            (true, None) => 1,
            (true, Some(trial_s)) => (*left_s / trial_s).clamp(0.0, 1e18) as u64,
        };
        let block_end = (start - start % BLOCK).saturating_add(BLOCK).min(end);
        let to_block = block_end - start;
        // Where it will end is not known. Threads that have nothing else to do run trials of it that may turn out to be
        // too many.
        let is_last = has_clock && state.next + 1 == self.tasks;
        let is_whole = task.may_stop && !is_last && start == 0;
        let taken = if is_whole {
            end - start
        } else if task.may_stop && fitting >= to_block {
            to_block
        } else if start.is_multiple_of(BLOCK) && fitting >= to_block {
            let blocks = (fitting / BLOCK).clamp(1, MOST_BLOCKS);
            (end - start).min(blocks * BLOCK)
        } else if is_first {
            // Trials side by side are eight.
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

    /// Notes the time of a job's trials.
    pub(crate) fn timed(&self, trials: u64, time: Duration) {
        if trials > 0 {
            let trial_s = time.as_secs_f64() / trials as f64;
            self.state().trial_s = Some(trial_s.max(1e-10));
        }
    }

    /// Notes how many jobs' results have been taken.
    pub(crate) fn taken(&self, jobs: u64) {
        self.state().jobs[1] = jobs;
        self.moved.notify_all();
    }

    /// Hands out nothing more.
    pub(crate) fn stop(&self) {
        self.state().is_stopped = true;
        self.moved.notify_all();
    }

    /// State, which changes at once, so that it is sound also where another thread panicked.
    fn state(&self) -> MutexGuard<'_, State<T, E>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
