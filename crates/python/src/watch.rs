//! Runs work without Python's interpreter lock, so that Ctrl-C can stop the work.

use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error;

/// Time between two checks for signals, and between two calls of `progress`.
const CHECK_INTERVAL: Duration = Duration::from_millis(40);

#[derive(Default)]
pub(crate) struct Watch {
    pub(crate) cancelled: AtomicBool,
    done: AtomicU64,
    reached: AtomicU64,
}

impl Watch {
    pub(crate) fn add(&self, done: u64) {
        self.done.fetch_add(done, Ordering::Relaxed);
    }

    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Reports progress. `done` is the amount of work that is completed, counted from the start. If the work is
    /// cancelled, this function panics on purpose, because there is no other way to end the work.
    pub(crate) fn reach(&self, done: u64) {
        let before = self.reached.swap(done, Ordering::Relaxed);
        self.add(done.saturating_sub(before));
        if self.is_cancelled() {
            std::panic::resume_unwind(Box::new("cancelled"));
        }
    }

    /// Calls `progress`, if it is given, with the amount of work that was done since the previous call.
    fn call(&self, py: Python<'_>, progress: Option<&Py<PyAny>>) -> PyResult<()> {
        let done = self.done.swap(0, Ordering::Relaxed);
        match progress {
            Some(progress) if done > 0 => progress.call1(py, (done,)).map(drop),
            _ => Ok(()),
        }
    }
}

/// Longest time to wait for the end of cancelled work. After this time, the exception is raised although the work still
/// runs.
const PATIENCE: Duration = Duration::from_millis(60);

/// Runs work on another thread, without the interpreter's lock. Meanwhile, the calling thread checks for signals and
/// calls `progress`. After a signal, the work may continue for a short time, until it finds that it is cancelled.
///
/// # Errors
/// The exception that the signal or `progress` raises.
pub(crate) fn watched<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Watch) -> T + Send + 'static,
) -> PyResult<T> {
    let watch = Arc::new(Watch::default());
    let progress = progress.map(|progress| progress.clone().unbind());
    let (sender, receiver) = channel();
    let worker = std::thread::Builder::new().spawn({
        let watch = Arc::clone(&watch);
        move || sender.send(work(&watch))
    });
    let worker = worker.map_err(error::run)?;
    let (state, calls) = (&watch, progress.as_ref());
    let done = py.detach(move || {
        loop {
            match receiver.recv_timeout(CHECK_INTERVAL) {
                Err(RecvTimeoutError::Timeout) => {}
                done => return Ok(done.ok()),
            }
            let raised = Python::attach(|py| {
                py.check_signals()?;
                state.call(py, calls)
            });
            if raised.is_err() {
                state.cancelled.store(true, Ordering::Relaxed);
                let _ = receiver.recv_timeout(PATIENCE);
                return raised.map(|()| None);
            }
        }
    })?;
    match (done, worker.join()) {
        (Some(done), _) => watch.call(py, progress.as_ref()).map(|()| done),
        // The work panicked, so it sent no result. Continue the panic in this thread.
        (None, Err(panic)) => std::panic::resume_unwind(panic),
        (None, Ok(_)) => Err(error::RunError::new_err("the work has no result")),
    }
}

const MAX_THREADS: usize = 256;

/// Converts the argument `threads` to a number of threads; `None` means the default. The number 0 is an error.
pub(crate) fn threads(threads: Option<usize>) -> PyResult<Option<NonZeroUsize>> {
    let number = threads.map(|threads| NonZeroUsize::new(threads.min(MAX_THREADS)));
    if number == Some(None) {
        let message = "threads is 0; it must be at least 1";
        return Err(error::argument("threads", &[], Some(0.0), message));
    }
    Ok(number.flatten())
}

/// Starts the threads for one call; `None` means the default number. The threads end with the call, because a Python
/// program that has running threads cannot fork safely.
pub(crate) fn pool(threads: Option<usize>) -> PyResult<ThreadPool> {
    let threads = self::threads(threads)?.map_or(0, NonZeroUsize::get);
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(error::run)
}
