//! What a user sees while work goes on: a bar on a terminal, traces when asked for, warnings once each.

use crate::output::tell;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{self, IsTerminal};
use tracing::level_filters::LevelFilter;

/// Sends traces to stderr: nothing (warnings where it `serves`), what is done (`-v`), details (`-vv`).
pub fn trace(verbosity: u8, serves: bool) {
    let level = match verbosity {
        0 if serves => LevelFilter::WARN,
        0 => return,
        1 => LevelFilter::INFO,
        2 => LevelFilter::DEBUG,
        _ => LevelFilter::TRACE,
    };
    tracing_subscriber::fmt()
        .with_writer(io::stderr)
        .with_ansi(io::stderr().is_terminal())
        .with_max_level(level)
        .with_target(false)
        .init();
}

/// A progress bar over a known amount of work; shows on a terminal only, and leaves no trace of itself.
pub struct Progress {
    bar: ProgressBar,
}

/// What a bar counts.
#[derive(Debug, Clone, Copy)]
pub enum Unit {
    /// Bytes of a file.
    Bytes,
    /// Samples.
    Samples,
    /// Seconds of a run.
    Seconds,
    /// Evaluations of a cost, with the best so far.
    Evaluations,
    /// Passes over the data of a training.
    #[cfg(feature = "train")]
    Passes,
}

impl Progress {
    /// A bar up to `total`; a spinner when that is not known (a pipe).
    pub fn new(what: &'static str, unit: Unit, total: Option<u64>) -> Self {
        let bar = total.map_or_else(ProgressBar::new_spinner, ProgressBar::new);
        let template = match (unit, total) {
            (Unit::Bytes, Some(_)) => {
                "{msg:9} [{bar:40}] {bytes}/{total_bytes} {binary_bytes_per_sec} {eta} left"
            }
            (Unit::Bytes, None) => "{msg:9} {spinner} {bytes} {binary_bytes_per_sec}",
            (Unit::Samples, Some(_)) => "{msg:9} [{bar:40}] {human_pos}/{human_len} {per_sec} {eta} left",
            (Unit::Seconds, _) => "{msg:9} [{bar:40}] {pos}/{len} s",
            (Unit::Evaluations, _) => {
                "{msg:9} [{bar:30}] {human_pos}/{human_len} {per_sec} {eta} left {prefix}"
            }
            #[cfg(feature = "train")]
            (Unit::Passes, _) => "{msg:9} [{bar:40}] {pos}/{len} passes {eta} left",
            (Unit::Samples, None) => "{msg:9} {spinner} {human_pos} {per_sec}",
        };
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.set_message(what);
        Self { bar }
    }

    /// Moves the bar on.
    pub fn more(&self, count: u64) {
        self.bar.inc(count);
    }

    /// Says something at the end of the line.
    pub fn say(&self, what: String) {
        self.bar.set_prefix(what);
    }

    /// Moves the bar.
    pub fn at(&self, position: u64) {
        self.bar.set_position(position);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// Says something that is no warning.
pub fn note(what: &str) {
    tell(&format!("adit: {what}\n"));
}

/// Shows each warning of a log once.
pub fn warn(warnings: &[impl std::fmt::Display]) {
    for warning in warnings {
        tell(&format!("adit: warning: {warning}\n"));
    }
}
