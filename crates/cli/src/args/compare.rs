//! `adit compare`: its flags.

use super::not_negative;
use crate::method::MethodName;
use crate::output::Target;
use adit_evaluation::alignment::Alignment;
use clap::{Args, ValueHint};
use std::path::PathBuf;

const EXAMPLES: &str = "\
What is compared:
  a scenario: it is simulated once for each seed, from its own on; its table [compare] may name methods, their settings and
  how they are judged. A folder: each NAME_imu.csv[.gz] with NAME_truth.csv[.gz], and log.mcap with truth.tum (adit simulate),
  is one run. Sidecars are applied. A suite (kind = suite): scenarios and recorded sets as parts of one report, each with its
  contenders and the figure by which it is judged; recorded sets at $ADIT_DATA, else where the suite says; what is not there is skipped.

Figures:
  errors are taken every 0.1 s, position and velocity horizontally. All moments of all runs together; the largest error of each
  run over the runs; NEES and NIS with their 95 % bounds; time of one inertial sample. All of them but the time are the same on one
  thread and on many (RAYON_NUM_THREADS).

Examples:
  adit compare scenarios/s0.toml --seeds 100
  adit compare scenarios/s2.toml --methods foot-ins --seeds 50 -o s2.html --json s2.json
  adit compare scenarios/everything.toml -o everything.html --json everything.json
  adit compare recordings --methods foot-ins,marg-ins --align start -o recordings.html";

/// `adit compare`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct CompareArgs {
    /// Scenario, suite, or folder of logs with truth
    #[arg(value_name = "SCENARIO.toml|SUITE.toml|DIR", value_hint = ValueHint::AnyPath)]
    pub source: PathBuf,

    /// Methods, separated by commas [default: those of the scenario's table compare]; of a suite they choose among its contenders
    #[arg(long, value_enum, value_delimiter = ',', value_name = "METHOD,…")]
    pub methods: Vec<MethodName>,

    /// Number of runs of a scenario, one for each seed [default: the suite's, else 20]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub seeds: Option<u32>,

    /// What to forgive before errors are taken [default: the scenario's; se2 for a folder]
    #[arg(long, value_name = "none|start|se2|se3")]
    pub align: Option<Alignment>,

    /// Judge from this time after the start on, seconds [default: the scenario's, else 0]
    #[arg(long, value_name = "SECONDS", value_parser = not_negative, allow_negative_numbers = true)]
    pub from: Option<f64>,

    /// Report to write, one HTML page with tables and figures
    #[arg(short, long, value_name = "REPORT.html", value_hint = ValueHint::FilePath)]
    pub out: Option<PathBuf>,

    /// Figures to write, JSON; `-` is stdout
    #[arg(long, value_name = "F.json", value_hint = ValueHint::FilePath)]
    pub json: Option<Target>,
}
