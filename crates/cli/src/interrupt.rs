//! Ctrl-C: the work stops between two samples, so that temporary files are removed on the way out.

use anyhow::{Context, Result, bail};
use std::sync::atomic::{AtomicBool, Ordering};

static ASKED_TO_STOP: AtomicBool = AtomicBool::new(false);

/// Exit code of a process that ends at once, at the second Ctrl-C (128 + SIGINT).
const KILLED: i32 = 130;

/// Listens for Ctrl-C and for the polite signals to end.
pub fn install() -> Result<()> {
    ctrlc::set_handler(|| {
        if ASKED_TO_STOP.swap(true, Ordering::Relaxed) {
            std::process::exit(KILLED);
        }
    })
    .context("cannot listen for Ctrl-C")
}

/// An error once somebody has asked to stop.
pub fn check() -> Result<()> {
    if ASKED_TO_STOP.load(Ordering::Relaxed) {
        bail!("interrupted: what was not complete was not written");
    }
    Ok(())
}
