//! `adit replay`: its flags.

use crate::output::Target;
use clap::{ArgAction, Args, ValueHint};
use std::path::PathBuf;

const REPLAY_HELP: &str = "\
The log is sent as a gateway would: a batch for each second of it, numbered, again under its number until it is acknowledged; the next one waits.
Readings go out as they were recorded: mounting, signs and noise are those of the profile that the server has for the tag, not of a sidecar beside
the log.

Times: moved to now, as a whole, so that nothing is from the future: the log begins now, or at a speed above 1 ends when it has been sent.
--keep-times leaves them as recorded; the server takes that for a tag that it has heard nothing newer of.

Told are batches sent, acknowledged, known already and refused, and tries that failed. Exit code 1 when a batch was refused.
The token needs the role admin or the grant ingest: ADIT_TOKEN, or --token.

Examples:
  adit replay walk.mcap --tag T-17
  adit replay ranges.csv imu.csv --to http://10.0.0.5:8080 --tag T-17 --speed 10
  adit replay yesterday.mcap --tag T-17 --keep-times --speed 1000";

/// `adit replay`.
#[derive(Debug, Args)]
#[command(after_help = REPLAY_HELP)]
pub struct ReplayArgs {
    /// Log of the tag; several are merged in order of time
    #[arg(value_name = "LOG", required = true, value_hint = ValueHint::FilePath)]
    pub logs: Vec<PathBuf>,

    /// The server
    #[arg(long, value_name = "URL", default_value = "http://127.0.0.1:8080", value_hint = ValueHint::Url)]
    pub to: String,

    /// Name of the tag at the server
    #[arg(long, value_name = "TAG")]
    pub tag: String,

    /// How many times faster than it was recorded (0.1 to 10000)
    #[arg(long, value_name = "N", default_value_t = 1.0, value_parser = speed, allow_negative_numbers = true)]
    pub speed: f64,

    /// Name of the gateway
    #[arg(long, value_name = "NAME", default_value = "replay")]
    pub gateway: String,

    /// Leave times as they were recorded
    #[arg(long, action = ArgAction::SetTrue)]
    pub keep_times: bool,

    /// Token of the API
    #[arg(long, value_name = "TOKEN", env = "ADIT_TOKEN", hide_env_values = true)]
    pub token: String,

    /// The report as JSON; `-` for stdout
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub json: Option<Target>,
}

fn speed(text: &str) -> Result<f64, String> {
    super::number(text, |v| (0.1..=10_000.0).contains(&v), "a number from 0.1 to 10000")
}
