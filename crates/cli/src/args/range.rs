//! `adit calibrate range`.

use super::number;
use crate::output::Target;
use clap::{Args, ValueHint};
use std::path::PathBuf;

const NOTES: &str = "\
The data, any mixture of:
  labelled  a folder with ranges.csv or meta.csv, or such a table: range_m, true_range_m, label or nlos, and which rows are of one place
            (tag_location_id, geometry_id, room_id, group_id; or tag_height_m)
  logs      with the truth beside them: log.mcap with ranges_truth.csv as `adit simulate` writes it, NAME_ranges.csv with NAME_ranges_truth.csv; or
            positions (NAME_truth.csv, truth.tum) together with --mine. Each log is one group, one or two alone are cut in five by time

What is learnt: offsets common to all anchors or of each (those of the mine count as zero and are replaced), and the error of signals that came
straight, that did not, and that nobody has judged: nothing, a constant, a polynomial of the range, or a curve of the received power and the like.
Which of it, is decided on places that it has not seen; nothing is taken off where that does not help. What is printed as corrected is of
places held out, choices and all.

The file goes to `adit track … --radio FILE.toml`.

Examples:
  adit calibrate range uwb-industrial -o hall.toml --plot hall.svg
  adit calibrate range hall_a hall_b -o radio.toml --evaluate hall_c --json
  adit calibrate range loop_ranges.csv.gz -o rig.toml
  adit calibrate range run1_ranges.csv run2_ranges.csv --mine anchors.csv --lever 0,0,1 -o vehicle.toml";

/// `adit calibrate range`.
#[derive(Debug, Args)]
#[command(after_help = NOTES)]
pub struct CalibrateRangeArgs {
    /// Ranges of which the distance is known
    #[arg(value_name = "DATA", required = true, value_hint = ValueHint::AnyPath)]
    pub data: Vec<PathBuf>,

    /// Where the anchors are: a mine file, or CSV with `anchor_id,x_m,y_m,z_m`; for logs with true positions
    #[arg(long, value_name = "MINE", value_hint = ValueHint::FilePath)]
    pub mine: Option<PathBuf>,

    /// Antenna of the tag, metres from what the truth is of, in its body axes; along the axes of the truth where that has no attitude
    #[arg(long, value_name = "X,Y,Z", value_parser = lever, allow_hyphen_values = true)]
    pub lever: Option<[f64; 3]>,

    /// Further data to judge the correction on that is written
    #[arg(long, value_name = "TEST", num_args = 1.., value_hint = ValueHint::AnyPath)]
    pub evaluate: Vec<PathBuf>,

    /// File to write, TOML; `-` is stdout
    #[arg(short, long, value_name = "FILE.toml", value_hint = ValueHint::FilePath)]
    pub out: Target,

    /// Figure to write, SVG: errors and what is taken off, errors before and after
    #[arg(long, value_name = "OUT.svg", value_hint = ValueHint::FilePath)]
    pub plot: Option<PathBuf>,

    /// Print one JSON object instead of the table
    #[arg(long)]
    pub json: bool,
}

fn lever(text: &str) -> Result<[f64; 3], String> {
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let [x, y, z] = parts[..] else { return Err("expected three numbers of metres, X,Y,Z".to_owned()) };
    let metres = |part| number(part, |v: f64| v.abs() < 1e3, "metres, less than 1,000");
    Ok([metres(x)?, metres(y)?, metres(z)?])
}
