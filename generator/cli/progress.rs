//! Progress bars on long work.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::Output;

/// A bar over `total` steps; hidden when output is for scripts, on request, or without a terminal.
pub fn bar(output: Output, total: u64, what: &str) -> ProgressBar {
    let target = if output.json || output.quiet {
        ProgressDrawTarget::hidden()
    } else {
        // Draws nothing when standard error is not a terminal.
        ProgressDrawTarget::stderr()
    };
    let bar = ProgressBar::with_draw_target(Some(total), target);
    if let Ok(style) =
        ProgressStyle::with_template("{msg:24} [{bar:30}] {human_pos}/{human_len} {per_sec} {eta}")
    {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.set_message(what.to_owned());
    bar
}
