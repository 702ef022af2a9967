//! How a run ends badly: one line on stderr and an exit code.

use crate::output::tell;
use clap::error::{Error as UsageError, ErrorKind};
use std::io;
use std::process::ExitCode;

/// The work failed.
const FAILED: u8 = 1;
/// The command line was wrong.
const WRONG_USAGE: u8 = 2;

/// Says why the work failed. A reader that went away (`adit … | head`) is no failure.
pub fn work(error: &anyhow::Error) -> ExitCode {
    let gone = |cause: &(dyn std::error::Error + 'static)| {
        cause.downcast_ref::<io::Error>().is_some_and(|e| e.kind() == io::ErrorKind::BrokenPipe)
    };
    if error.chain().any(gone) {
        return ExitCode::SUCCESS;
    }
    say(&one_line(&causes(error)));
    ExitCode::from(FAILED)
}

/// The error and its causes, outermost first; a cause that its effect has quoted already is left out.
fn causes(error: &anyhow::Error) -> String {
    error.chain().map(ToString::to_string).fold(String::new(), |said, cause| {
        if said.is_empty() {
            cause
        } else if said.contains(&cause) {
            said
        } else {
            format!("{said}: {cause}")
        }
    })
}

/// Shows the help that was asked for, or says what is wrong with the command line.
pub fn usage(error: &UsageError) -> ExitCode {
    let shown_as_it_is = [
        ErrorKind::DisplayHelp,
        ErrorKind::DisplayVersion,
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand,
    ];
    if shown_as_it_is.contains(&error.kind()) {
        // Nothing to be done when nobody listens.
        let _ = error.print();
        return if error.use_stderr() { ExitCode::from(WRONG_USAGE) } else { ExitCode::SUCCESS };
    }
    let text = error.render().to_string();
    let what = text.split("Usage:").next().unwrap_or_default();
    let what = what.split("For more information").next().unwrap_or_default();
    let what = what.trim_start_matches("error:");
    say(&format!("{} (adit --help tells more)", one_line(what)));
    ExitCode::from(WRONG_USAGE)
}

fn say(line: &str) {
    tell(&format!("adit: {line}\n"));
}

/// Lines and runs of blanks made one.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
