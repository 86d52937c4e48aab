//! Trials of a cell until a statistic is known well enough.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::column::Column;
use crate::part::{Part, Workspace};
use crate::partial::Partial;
use crate::task::Stop;
use crate::trial::{BLOCK, Trial};
use crate::watch::Watch;

/// Runs blocks of trials until `rule`, if there is one, ends them, or there are `most` trials.
pub(crate) fn run(
    rule: Option<&Stop>,
    trial: &impl Trial,
    most: u64,
    workspace: &mut Workspace,
    cancelled: &AtomicBool,
) -> Partial {
    let mut partial = Partial::new(trial.quantities());
    let mut watch = rule.map(|rule| Watch::new(*rule));
    let mut start = 0;
    loop {
        let end = most.min(start + BLOCK);
        let mut part = Part::new(trial.quantities());
        let mut note = |columns: &[Column], trials: u64| {
            if let Some(watch) = &mut watch {
                watch.note(columns, trials);
            }
        };
        part.run_block(trial, start..end, workspace, cancelled, Some(&mut note));
        part.add_to(&mut partial);
        start = end;
        let is_known = watch.as_mut().is_some_and(|watch| watch.end_block(start));
        if is_known || start >= most || cancelled.load(Ordering::Relaxed) {
            return partial;
        }
    }
}
