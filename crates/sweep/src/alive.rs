//! Experiments of the cells that are being run.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::trial::blocks;

/// Experiments that are set up when the first block of their cell is run, shared by the threads that run other blocks of
/// it, and dropped after the last.
pub(crate) struct Alive<T, F> {
    set_up: F,
    cells: Vec<Mutex<State<T>>>,
}

/// Experiment of a cell, and the number of blocks that have not been run.
struct State<T> {
    trial: Option<Arc<T>>,
    left: u64,
}

impl<T, E, F: Fn(usize) -> Result<T, E>> Alive<T, F> {
    /// Cells with these numbers of trials, none of them set up.
    pub(crate) fn new(trials: &[u64], set_up: F) -> Self {
        let state = |&trials| {
            Mutex::new(State {
                trial: None,
                left: blocks(trials),
            })
        };
        Self {
            set_up,
            cells: trials.iter().map(state).collect(),
        }
    }

    /// Experiment of a cell; other threads that need it wait while it is set up.
    pub(crate) fn get(&self, cell: usize) -> Result<Arc<T>, E> {
        let mut state = self.state(cell);
        match &state.trial {
            Some(trial) => Ok(Arc::clone(trial)),
            None => {
                let trial = Arc::new((self.set_up)(cell)?);
                state.trial = Some(Arc::clone(&trial));
                Ok(trial)
            }
        }
    }

    /// Notes that a block of a cell has been run.
    pub(crate) fn finish_block(&self, cell: usize) {
        let mut state = self.state(cell);
        state.left -= 1;
        if state.left == 0 {
            state.trial = None;
        }
    }

    /// State of a cell; that of a thread that panicked is sound, for it changes at once.
    fn state(&self, cell: usize) -> MutexGuard<'_, State<T>> {
        let state = self.cells[cell].lock();
        state.unwrap_or_else(PoisonError::into_inner)
    }
}
