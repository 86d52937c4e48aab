//! Work without the lock of the interpreter, which Ctrl-C stops.

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error;

/// Time between two looks for signals, and between two calls of a progress.
const LOOK: Duration = Duration::from_millis(40);

/// Work in hand: whether it is to end, and how much of it is done.
#[derive(Default)]
pub(crate) struct Watch {
    pub(crate) cancelled: AtomicBool,
    done: AtomicU64,
    reached: AtomicU64,
    ended: Mutex<bool>,
    bell: Condvar,
}

impl Watch {
    /// Counts work that is done.
    pub(crate) fn tell(&self, done: u64) {
        self.done.fetch_add(done, Ordering::Relaxed);
    }

    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Counts work by how much of it is done from its beginning on, and unwinds work that is cancelled, which nothing else
    /// ends.
    pub(crate) fn reach(&self, done: u64) {
        let before = self.reached.swap(done, Ordering::Relaxed);
        self.tell(done.saturating_sub(before));
        if self.is_cancelled() {
            std::panic::resume_unwind(Box::new("cancelled"));
        }
    }

    /// Calls a progress with how much has been done since the last call.
    fn call(&self, py: Python<'_>, progress: Option<&Py<PyAny>>) -> PyResult<()> {
        let done = self.done.swap(0, Ordering::Relaxed);
        match progress {
            Some(progress) if done > 0 => progress.call1(py, (done,)).map(drop),
            _ => Ok(()),
        }
    }

    /// Sleeps for a while, or until the work has ended; says whether it has.
    fn wait(&self) -> bool {
        let ended = self.ended.lock().unwrap_or_else(PoisonError::into_inner);
        let waited = self.bell.wait_timeout_while(ended, LOOK, |ended| !*ended);
        *waited.unwrap_or_else(PoisonError::into_inner).0
    }
}

/// Tells that the work has ended, also where it panics.
struct Ending<'w>(&'w Watch);

impl Drop for Ending<'_> {
    fn drop(&mut self) {
        *self.0.ended.lock().unwrap_or_else(PoisonError::into_inner) = true;
        self.0.bell.notify_all();
    }
}

/// Looks for signals and calls `progress`, from time to time, with how much has been done since it was last called, until
/// the work ends.
///
/// # Errors
/// Error that a signal or the progress raises; the work is told to end.
fn look(watch: &Watch, progress: Option<&Py<PyAny>>) -> PyResult<()> {
    while !watch.wait() {
        let raised = Python::attach(|py| {
            py.check_signals()?;
            watch.call(py, progress)
        });
        if raised.is_err() {
            watch.cancelled.store(true, Ordering::Relaxed);
            return raised;
        }
    }
    Ok(())
}

/// Does work on another thread, which must end soon after it is cancelled, while this one looks for signals.
///
/// # Errors
/// Error that a signal raises; the work has ended then.
pub(crate) fn watched<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&Watch) -> T + Send,
) -> PyResult<T> {
    let watch = Watch::default();
    let done = py.detach(|| {
        std::thread::scope(|scope| {
            let worker = scope.spawn(|| {
                let _ending = Ending(&watch);
                work(&watch)
            });
            look(&watch, None).map(|()| worker.join())
        })
    })?;
    match done {
        Ok(done) => Ok(done),
        Err(panic) => std::panic::resume_unwind(panic),
    }
}

/// Time for which cancelled work may go on before it is left to itself.
const PATIENCE: Duration = Duration::from_millis(60);

/// Does work on another thread while this one looks for signals and calls `progress`. Work that does not end soon after a
/// signal goes on by itself until it sees that it is cancelled.
///
/// # Errors
/// Exception that a signal or the progress raises.
pub(crate) fn watched_alone<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Watch) -> T + Send + 'static,
) -> PyResult<T> {
    let watch = Arc::new(Watch::default());
    let progress = progress.map(|progress| progress.clone().unbind());
    let worker = std::thread::Builder::new().spawn({
        let watch = Arc::clone(&watch);
        move || {
            let _ending = Ending(&watch);
            work(&watch)
        }
    });
    let worker = worker.map_err(|error| error::RunError::new_err(error.to_string()))?;
    let done = py.detach(|| match look(&watch, progress.as_ref()) {
        Ok(()) => Ok(worker.join()),
        Err(raised) => {
            let start = Instant::now();
            while start.elapsed() < PATIENCE && !watch.wait() {}
            Err(raised)
        }
    })?;
    let done = match done {
        Ok(done) => done,
        Err(panic) => std::panic::resume_unwind(panic),
    };
    watch.call(py, progress.as_ref())?;
    Ok(done)
}

/// Threads for one call: no thread is left behind, so that a program may fork later.
pub(crate) fn pool(threads: Option<usize>) -> PyResult<ThreadPool> {
    let threads = match threads {
        Some(0) => {
            let message = "threads is 0; it must be at least 1";
            return Err(error::argument("threads", &[], Some(0.0), message));
        }
        Some(threads) => threads,
        None => std::thread::available_parallelism().map_or(1, NonZeroUsize::get),
    };
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|error| error::RunError::new_err(error.to_string()))
}
