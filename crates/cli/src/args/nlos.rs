//! `adit nlos`: its verbs and flags.

use clap::{Args, Subcommand, ValueHint};
use std::path::PathBuf;

const TRAIN_HELP: &str = "\
DATA, each:
  a folder of adit simulate (log.mcap, ranges_truth.csv): also what is in the way, nothing, a shallow or a deep shadow, rock: four classes;
  a folder with meta.csv and cir_i16le.bin (diagnostics and impulse responses), or with ranges.csv (diagnostics alone), plain or .gz; or such a
  table. One range to a row: geometry_id (or tag_location_id, room_id, group_id), label (LOS, NLOS, NDP) or nlos (0, 1), range_m, and what the
  receiver told: rx_power_dBm, first_path_power_dBm, preamble_count, …

Judging:
  whole geometries are held out, never single ranges: those of one geometry are near copies of each other. The file is made of all DATA.

Examples:
  adit nlos train uwb-cir -o flat.safetensors
  adit nlos train hall --baseline -o hall.safetensors --json";

const EVAL_HELP: &str = "\
The model judges every range of DATA (as for adit nlos train); where the two do not have the same classes, line of sight or not is judged. binary
asks: no line of sight? F1 is that of \"no\". Ranges with times are judged once more with what was told of their link before kept in mind.

Examples:
  adit nlos eval uwb-cir
  adit nlos eval uwb-cir --model flat.safetensors --json
  adit nlos eval lab/p001 lab/p002 --model mine";

/// `adit nlos`.
#[derive(Debug, Args)]
pub struct NlosArgs {
    /// What to do
    #[command(subcommand)]
    pub verb: NlosVerb,
}

/// Its verbs.
#[derive(Debug, Subcommand)]
pub enum NlosVerb {
    /// Learn a model from labelled ranges and judge it on geometries held out
    Train(NlosTrainArgs),
    /// Judge a model on labelled ranges
    Eval(NlosEvalArgs),
}

/// `adit nlos train`.
#[derive(Debug, Args)]
#[command(after_help = TRAIN_HELP)]
pub struct NlosTrainArgs {
    /// Labelled ranges
    #[arg(value_name = "DATA", required = true, value_hint = ValueHint::AnyPath)]
    pub data: Vec<PathBuf>,

    /// Model to write
    #[arg(short, long, value_name = "MODEL.safetensors", value_hint = ValueHint::FilePath)]
    pub out: PathBuf,

    /// Further labelled ranges that are learnt from, never judged on (simulated ones)
    #[arg(long, value_name = "DATA", num_args = 1.., value_hint = ValueHint::AnyPath)]
    pub also: Vec<PathBuf>,

    /// Learn the discriminant of features made by hand alone, no network
    #[arg(long)]
    pub baseline: bool,

    /// How often some geometries are held out; as many as there are: each in turn
    #[arg(long, value_name = "N", default_value_t = 24, value_parser = clap::value_parser!(u16).range(2..=1000))]
    pub folds: u16,

    /// Seed of everything drawn
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,

    /// What to say of the data in the model's record (licence, source)
    #[arg(long, value_name = "TEXT")]
    pub note: Option<String>,

    /// Print one JSON object instead of the table
    #[arg(long)]
    pub json: bool,
}

/// `adit nlos eval`.
#[derive(Debug, Args)]
#[command(after_help = EVAL_HELP)]
pub struct NlosEvalArgs {
    /// Labelled ranges
    #[arg(value_name = "DATA", required = true, value_hint = ValueHint::AnyPath)]
    pub data: Vec<PathBuf>,

    /// Model to judge: flat or mine (they ship with adit), or a file [default: flat]
    #[arg(long, value_name = "flat|mine|M", value_hint = ValueHint::FilePath)]
    pub model: Option<String>,

    /// Print one JSON object instead of the table
    #[arg(long)]
    pub json: bool,
}
