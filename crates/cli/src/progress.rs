//! Progress bars, only on a terminal.

use indicatif::{ProgressBar, ProgressStyle};

/// Returns a bar on standard error over a number of files; a hidden one for a single file, and
/// where standard error is no terminal.
pub(crate) fn bar(count: usize, what: &'static str) -> ProgressBar {
    if count < 2 {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len}, {eta} left");
    let bar = ProgressBar::new(count as u64).with_message(what);
    match style {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
