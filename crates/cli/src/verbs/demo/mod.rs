//! `adit demo`: a shift that is simulated and followed live, or one walk.

mod browser;
mod crew;
mod gateways;
mod host;
mod score;
mod shift;
mod story;
mod viewer;
mod walk;

use crate::args::DemoArgs;
use anyhow::Result;

/// Shows what was asked for.
pub fn run(args: &DemoArgs) -> Result<()> {
    if args.walk { walk::run(args) } else { shift::run(args) }
}
