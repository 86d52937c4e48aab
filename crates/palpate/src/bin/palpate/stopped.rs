//! Signals that end a run in good order.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use anyhow::Context;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::{SigId, flag, low_level};

use crate::failure::Failure;

/// Ctrl-C and the signal by which schedulers end a job; a second one ends the process at once.
pub(crate) struct Signals {
    stop: Arc<AtomicBool>,
    signal: Arc<AtomicUsize>,
    handlers: Vec<SigId>,
}

impl Signals {
    /// Listens to them from now on.
    pub(crate) fn new() -> Result<Self, Failure> {
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
                .context("cannot listen to signals")
                .map_err(Failure::work)?;
        }
        Ok(Self {
            stop,
            signal,
            handlers,
        })
    }

    /// Whether the run is to stop.
    pub(crate) fn stop(&self) -> &AtomicBool {
        &self.stop
    }

    /// Status with which a process ends that such a signal stopped.
    pub(crate) fn status(&self) -> u8 {
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
