//! `adit mine`: names, flags and their help.

use crate::output::Target;
use clap::{Args, Subcommand, ValueHint};
use std::path::PathBuf;

const CHECK_EXAMPLES: &str = "\
A mine is a TOML, JSON or GeoJSON file, or a CSV of anchors (anchor_id,x_m,y_m,z_m); the kind is told by content.
Errors and warnings go to stderr, one line each with file, line and remedy; exit code 1 when there is an error.

Examples:
  adit mine check mines/two-level.toml
  adit mine check mines/two-level.toml --plot plan.svg
  adit mine check mines/two-level.toml --json";

const CONVERT_EXAMPLES: &str = "\
The form is told by the end of the name: .toml, .json or .geojson. Nothing of the mine is lost on the way, comments are.

Examples:
  adit mine convert mines/lab.toml -o lab.geojson
  adit mine convert edited.geojson -o lab.toml";

/// `adit mine`.
#[derive(Debug, Args)]
pub struct MineArgs {
    /// What to do with it
    #[command(subcommand)]
    pub verb: MineVerb,
}

/// What can be done with a mine.
#[derive(Debug, Subcommand)]
pub enum MineVerb {
    /// Find everything that is wrong with a mine file, and say what is in it
    Check(MineCheckArgs),
    /// Write a mine in another form
    Convert(MineConvertArgs),
}

/// `adit mine check`.
#[derive(Debug, Args)]
#[command(after_help = CHECK_EXAMPLES)]
pub struct MineCheckArgs {
    /// The mine
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,

    /// Print one JSON object: errors, warnings and the summary
    #[arg(long)]
    pub json: bool,

    /// Plan view to write, SVG: a panel for each level
    #[arg(long, value_name = "OUT.svg", value_hint = ValueHint::FilePath)]
    pub plot: Option<PathBuf>,
}

/// `adit mine convert`.
#[derive(Debug, Args)]
#[command(after_help = CONVERT_EXAMPLES)]
pub struct MineConvertArgs {
    /// The mine
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,

    /// File to write: .toml, .json or .geojson; `-` is stdout, as TOML
    #[arg(short, long, value_name = "OUT", value_hint = ValueHint::FilePath)]
    pub out: Target,
}
