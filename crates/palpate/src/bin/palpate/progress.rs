//! A progress bar, on a terminal only.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar over `trials`, with rate and time left, on standard error if that is a terminal.
pub(crate) fn bar(trials: u64) -> ProgressBar {
    let style = ProgressStyle::with_template(
        "{wide_bar} {human_pos}/{human_len} trials, {per_sec}, {eta} left",
    );
    let bar = ProgressBar::with_draw_target(Some(trials), ProgressDrawTarget::stderr());
    match style {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
