//! A progress bar, on a terminal only.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar over `trials`, with rate and time left, on standard error if that is a terminal.
pub(crate) fn bar(trials: u64) -> ProgressBar {
    let bar = bar_of("trials");
    bar.set_length(trials);
    bar
}

/// A bar over a number of `things` that is still to be set, as [`bar`]; it is not drawn before it moves.
pub(crate) fn bar_of(things: &str) -> ProgressBar {
    let style = ProgressStyle::with_template(&format!(
        "{{wide_bar}} {{human_pos}}/{{human_len}} {things}, {{per_sec}}, {{eta}} left"
    ));
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    match style {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
