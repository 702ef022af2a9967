//! `adit calibrate pathloss` and `adit calibrate fingerprint`.

use super::number;
use crate::output::Target;
use clap::{Args, ValueHint};
use std::path::PathBuf;

const DATA: &str = "\
The data, all of one kind:
  surveys   CSV, one scan at a known spot to a row: x_m,y_m[,floor], NAME_rssi_dBm and NAME_rtt_range_m for each transmitter NAME;
            empty is not heard
  walks     logs of signal strengths (time_s,receiver,rssi_dBm or MCAP), each with its truth beside it: NAME_truth.csv for NAME_rssi.csv;
            a folder stands for all of them in it

Judging (the file that is written is made of all DATA whatever is judged):
  --evaluate TEST          on further data
  --leave-out 0.2          on a fifth of the surveyed spots, drawn by --seed, the fit made of the others; --draws 5 draws five times
  --leave-out each         on each file of DATA in turn, the fit made of the others

What is judged is the distance of each fix from the spot. A walk is judged every half second; methods without memory get
the medians of the last three seconds of it.
";

const PATHLOSS_EXAMPLES: &str = "\
Examples:
  adit calibrate pathloss corridor_train.csv.gz --access-points corridor_access_points.csv -o corridor.toml --leave-out 0.2
  adit calibrate pathloss train.csv --access-points aps.csv -o site.toml --evaluate test.csv --json
  adit calibrate pathloss ble-tracks --access-points ble-tracks/receivers.csv -o hall.toml --leave-out each";

const FINGERPRINT_EXAMPLES: &str = "\
Examples:
  adit calibrate fingerprint train.csv --access-points aps.csv -o site.json --evaluate test.csv
  adit calibrate fingerprint corridor_train.csv.gz -o corridor.json --leave-out 0.2 --draws 5 --json";

/// What both calibrations take.
#[derive(Debug, Args)]
pub struct RadioArgs {
    /// Surveys, or logs of walks with their truth
    #[arg(value_name = "DATA", required = true, value_hint = ValueHint::AnyPath)]
    pub data: Vec<PathBuf>,

    /// Data to judge the methods on
    #[arg(long, value_name = "TEST", num_args = 1.., value_hint = ValueHint::AnyPath)]
    pub evaluate: Vec<PathBuf>,

    /// Judge on a part of DATA that the fit does not see: a share of the spots, or each file in turn
    #[arg(long, value_name = "SHARE|each", value_parser = left_out)]
    pub leave_out: Option<LeaveOut>,

    /// Seed of what is left out
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,

    /// How often a share is drawn, one seed after the other
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=1000))]
    pub draws: u64,

    /// Print one JSON object instead of the table
    #[arg(long)]
    pub json: bool,
}

/// What is left out of the fit to be judged on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LeaveOut {
    /// This share of the spots.
    Share(f64),
    /// Each file in turn.
    Each,
}

/// `adit calibrate pathloss`.
#[derive(Debug, Args)]
#[command(after_help = format!("{DATA}\n{PATHLOSS_EXAMPLES}"))]
pub struct CalibratePathlossArgs {
    /// What was heard where
    #[command(flatten)]
    pub radio: RadioArgs,

    /// Where the transmitters are: CSV with `ap,x_m,y_m[,z_m][,floor][,id_…]`, or a mine file
    #[arg(long, value_name = "PLACES", value_hint = ValueHint::FilePath)]
    pub access_points: PathBuf,

    /// File to write, TOML; its `[[access_points]]` are those of a mine file; `-` is stdout
    #[arg(short, long, value_name = "FILE.toml", value_hint = ValueHint::FilePath)]
    pub out: Target,
}

/// `adit calibrate fingerprint`.
#[derive(Debug, Args)]
#[command(after_help = format!("{DATA}\n{FINGERPRINT_EXAMPLES}"))]
pub struct CalibrateFingerprintArgs {
    /// What was heard where
    #[command(flatten)]
    pub radio: RadioArgs,

    /// Where the transmitters are, as for pathloss; the map falls off with distance from them where it knows
    #[arg(long, value_name = "PLACES", value_hint = ValueHint::FilePath)]
    pub access_points: Option<PathBuf>,

    /// File to write, JSON; `-` is stdout
    #[arg(short, long, value_name = "FILE.json", value_hint = ValueHint::FilePath)]
    pub out: Target,
}

fn left_out(text: &str) -> Result<LeaveOut, String> {
    if text == "each" {
        return Ok(LeaveOut::Each);
    }
    let share = number(text, |v| v > 0.0 && v < 1.0, "a share above 0 and below 1, or \"each\"")?;
    Ok(LeaveOut::Share(share))
}
