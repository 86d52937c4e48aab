//! Figures of cost and error, and the sizes of the tasks.

use std::time::Duration;

use crate::measured::Evaluation;

/// Patches of few contacts.
pub(super) const PATCHES: u64 = 200;
/// Many contacts.
pub(super) const MANY: usize = 100_000;
/// Sides of frames, px.
pub(super) const FRAMES: [usize; 2] = [640, 1024];
/// How long an evaluation is timed.
const PATIENCE: Duration = Duration::from_millis(200);

/// Cost and error of one rung on one task.
pub(super) struct Figure {
    /// Name of the task, which the peers use too.
    pub(super) task: String,
    pub(super) rung: String,
    pub(super) time_us: f64,
    /// Error as the peers define it for the task.
    pub(super) error: f64,
}

impl Figure {
    /// Times `run`, which does the task `times` times.
    pub(super) fn measured<T>(
        task: impl Into<String>,
        rung: impl Into<String>,
        error: f64,
        times: usize,
        run: impl FnMut() -> T + 'static,
    ) -> Self {
        let rung = rung.into();
        let spread = Evaluation::new(rung.clone(), run).time(PATIENCE);
        Self {
            task: task.into(),
            rung,
            time_us: spread.median * 1e-3 / times as f64,
            error,
        }
    }
}
