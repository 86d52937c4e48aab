//! Queue of the trials that the worker threads run. The queue hands out trials task by task, in the order of the tasks.

use std::ops::Range;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Duration;

use crate::cell::BLOCK;
use crate::cell::Task;

/// Intended run time of a job (the trials that a thread receives at once). This time is long compared with the overhead
/// of the queue, and short compared with a whole run.
pub const JOB: Duration = Duration::from_millis(4);
const MAX_BLOCKS: u64 = 64;
/// Largest number of jobs that may be handed out while the results of an earlier job are missing. Results are passed on
/// in the order of the jobs, so the results of later jobs wait in memory. The limit restricts this memory.
const AHEAD: u64 = 512;
/// Limit that replaces [`AHEAD`] while the queue hands out trials of a cell that a stopping rule may end early.
const AHEAD_WITH_RULE: u64 = 128;

/// The experiment of a cell, or the error with which its set-up failed. The first thread that needs the experiment sets
/// it up. The memory is freed when no thread needs it any more.
pub(crate) type Experiment<T, E> = OnceLock<Result<T, Mutex<Option<E>>>>;

/// Work for one worker thread: consecutive trials of one or several tasks.
pub(crate) struct Job<T, E> {
    pub(crate) number: u64,
    pub(crate) pieces: Vec<Piece<T, E>>,
}

/// Consecutive trials of a task: all trials, whole blocks of trials, or some trials of one block.
pub(crate) struct Piece<T, E> {
    pub(crate) number: u64,
    pub(crate) task: Task,
    pub(crate) trials: Range<u64>,
    pub(crate) experiment: Arc<Experiment<T, E>>,
}

impl<T, E> Piece<T, E> {
    pub(crate) fn is_whole(&self) -> bool {
        self.trials == (0..self.task.trials)
    }
}

pub(crate) struct Queue<T, E, F> {
    tasks: u64,
    task: F,
    state: Mutex<State<T, E>>,
    changed: Condvar,
}

/// The task that is being handed out, the number of its next trial, and the experiment of its cell.
type OpenTask<T, E> = (Task, u64, Arc<Experiment<T, E>>);

struct State<T, E> {
    open: Option<OpenTask<T, E>>,
    /// Index of the task that is being handed out. If no task is being handed out, the index of the next task.
    next: u64,
    /// Number of jobs that were handed out to threads, and number of jobs whose results were passed on to the caller.
    jobs: [u64; 2],
    is_stopped: bool,
    /// Time per trial (s) in the last finished job. `None` before the first job is finished, and if there is no clock.
    trial_s: Option<f64>,
}

impl<T, E> State<T, E> {
    fn max_ahead(&self) -> u64 {
        let has_rule = self.open.as_ref().is_some_and(|(task, ..)| task.may_stop);
        if has_rule { AHEAD_WITH_RULE } else { AHEAD }
    }
}

impl<T, E, F: Fn(u64) -> Task> Queue<T, E, F> {
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

    /// The next job; `None` if no trials are left, or if the queue was stopped. The function waits while too many jobs
    /// that were handed out have not returned their results. If `has_clock` is true, the number of trials in a job
    /// follows from the measured time per trial.
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

    /// The next piece of a job: as many trials of a task as fit into the remaining time of the job. The first piece of
    /// a job contains at least one trial, even if this trial takes longer than the intended time [`JOB`].
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
            // The first job has only one trial. Its time is used to choose the sizes of the following jobs.
            (true, None) => 1,
            (true, Some(trial_s)) => (*left_s / trial_s).clamp(0.0, 1e18) as u64,
        };
        let block_end = (start - start % BLOCK).saturating_add(BLOCK).min(end);
        let to_block = block_end - start;
        // The queue cannot predict at which trial a stopping rule will end a task. Therefore, a single thread runs all
        // trials of such a task, so that no thread runs trials beyond the end. Only the last task is shared by all
        // threads, because the other threads would otherwise be idle.
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
            // Experiments may compute up to 8 trials together, so hand out a multiple of 8 trials.
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

    pub(crate) fn set_time(&self, trials: u64, time: Duration) {
        if trials > 0 {
            let trial_s = time.as_secs_f64() / trials as f64;
            self.state().trial_s = Some(trial_s.max(1e-10));
        }
    }

    pub(crate) fn set_passed_on(&self, jobs: u64) {
        self.state().jobs[1] = jobs;
        self.changed.notify_all();
    }

    pub(crate) fn stop(&self) {
        self.state().is_stopped = true;
        self.changed.notify_all();
    }

    /// Locks the state of the queue. The state is valid even if another thread panicked, because every change is a
    /// single step.
    fn state(&self) -> MutexGuard<'_, State<T, E>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
