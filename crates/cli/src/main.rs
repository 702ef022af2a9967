//! `adit`: where is everybody underground.
//!
//! One binary, one verb per task ([`args`] is the contract, [`verbs`] the work). Exit code 0 done, 1 the work failed,
//! 2 wrong usage; an error is one line on stderr that begins with `adit:`.

mod args;
mod config;
mod failure;
mod interrupt;
mod journey;
mod judged_ranges;
mod log_stream;
mod map;
mod method;
mod mounting;
mod output;
mod progress;
mod radio_site;
mod scenario_file;
mod suite_file;
mod truth_beside;
mod verbs;

use mimalloc::MiMalloc;
use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

fn main() -> ExitCode {
    let args = match args::Adit::from_command_line() {
        Ok(args) => args,
        Err(error) => return failure::usage(&error),
    };
    progress::trace(args.verbose, matches!(args.verb, args::Verb::Serve(_)));
    match interrupt::install().and_then(|()| verbs::run(&args.verb)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => failure::work(&error),
    }
}
