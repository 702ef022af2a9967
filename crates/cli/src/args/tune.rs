//! `adit tune`: its flags.

use super::{not_negative, radio_contradiction};
use crate::method::MethodName;
use crate::output::Target;
use adit_evaluation::alignment::Alignment;
use clap::builder::PossibleValue;
use clap::error::ErrorKind;
use clap::{Args, ValueEnum, ValueHint};
use serde::Deserialize;
use std::path::PathBuf;

const EXAMPLES: &str = "\
What is searched:
  the noise parameters of the method: how large its random errors are said to be. Each is searched by its logarithm between bounds that physics
  sets, from the setting that it has now. One set of values for all runs. Afterwards each value that is worth nothing is taken back.

What is sought:
  the least mean over the runs of the mean squared error. Paths: horizontal position, m², at the moments at which compare judges: every
  0.1 s, or at each solution of a method that reports less often. Attitude (ahrs): the whole angle, deg², at the stamps of the truth
  (of its rows marked `moving`, where it has that column). A run from which nothing comes costs 1e12.

Runs:
  a log with its truth beside it (NAME_imu.csv, NAME.mcap with NAME_truth.csv; log.mcap with truth.tum), or a folder of such
  logs, as for compare. Sidecars are applied. Logs are read once and held in memory.

An evaluation runs the method over all training logs. The same command gives the same file on one thread and on many
(RAYON_NUM_THREADS). Ctrl-C keeps what is known in FILE.search.json, as does a crash; --resume goes on from there to the same end.
Judge the result on logs that the search has not seen: --validate.

Examples:
  adit tune foot-ins --train walk1_imu.csv walk2_imu.csv -o tuned.toml
  adit track walk3_imu.csv --method foot-ins --config tuned.toml -o walk3.tum
  adit tune pdr --train runs --optimizer scaba --budget 5000 --seed 7 --validate other-runs -o pdr.toml --plot pdr.svg";

/// `adit tune`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct TuneArgs {
    /// Method to tune
    #[arg(value_enum, value_name = "METHOD")]
    pub method: MethodName,

    /// Logs to tune on, or folders of them, with their truth beside them
    #[arg(long, value_name = "LOG", required = true, num_args = 1.., value_hint = ValueHint::AnyPath)]
    pub train: Vec<PathBuf>,

    /// Logs to judge the result on, or folders of them: the search does not see them
    #[arg(long, value_name = "LOG", num_args = 1.., value_hint = ValueHint::AnyPath)]
    pub validate: Vec<PathBuf>,

    /// How to search
    #[arg(long, value_enum, default_value = "cmaes")]
    pub optimizer: OptimiserName,

    /// Evaluations in all
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = clap::value_parser!(u32).range(1..=1_000_000_000))]
    pub budget: u32,

    /// Agents of a generation; cmaes begins with fewer of its own
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(4..=100_000))]
    pub agents: u32,

    /// Seed of every random draw
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,

    /// Search these noise parameters only, separated by commas [default: all of the method]
    #[arg(long, value_delimiter = ',', value_name = "NAME,…")]
    pub parameters: Vec<String>,

    /// Settings to begin with, TOML; what it says stands in the result too, but for what is searched
    #[arg(long, value_name = "F.toml", value_hint = ValueHint::FilePath)]
    pub config: Option<PathBuf>,

    /// The mine, as for track
    #[arg(long, value_name = "MINE", value_hint = ValueHint::FilePath)]
    pub mine: Option<PathBuf>,

    /// The radio of the site, as for track
    #[arg(long, value_name = "MODEL", value_hint = ValueHint::FilePath)]
    pub radio: Vec<PathBuf>,

    /// What to forgive before errors are taken [default: se2; none for attitude and for methods by radio]
    #[arg(long, value_name = "none|start|se2|se3")]
    pub align: Option<Alignment>,

    /// Judge from this time after the start on, seconds
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0, value_parser = not_negative, allow_negative_numbers = true)]
    pub from: f64,

    /// Settings to write, TOML, for track --config; `-` is stdout
    #[arg(short, long, value_name = "FILE.toml", value_hint = ValueHint::FilePath)]
    pub out: Target,

    /// Go on with the search that FILE.search.json holds; from the start where there is none
    #[arg(long)]
    pub resume: bool,

    /// Figure to write, SVG: the least cost so far over the evaluations
    #[arg(long, value_name = "OUT.svg", value_hint = ValueHint::FilePath)]
    pub plot: Option<PathBuf>,

    /// Report to write, JSON; `-` is stdout
    #[arg(long, value_name = "REPORT.json", value_hint = ValueHint::FilePath)]
    pub json: Option<Target>,
}

impl TuneArgs {
    /// What is wrong beyond a single flag.
    pub fn contradiction(&self) -> Option<(ErrorKind, String)> {
        let Self { method, budget, agents, .. } = self;
        let conflict = |what: String| Some((ErrorKind::ArgumentConflict, what));
        let stdout = self.out == Target::Stdout;
        if stdout && self.json == Some(Target::Stdout) {
            return conflict("-o and --json cannot both go to stdout".to_owned());
        }
        if stdout && self.resume {
            return conflict("--resume needs a file for -o: what is known stands beside it".to_owned());
        }
        if budget < agents {
            return conflict(format!("--budget {budget} is less than one generation of --agents {agents}"));
        }
        let known: Vec<&str> = method.noise_parameters().map(|parameter| parameter.path).collect();
        if known.is_empty() {
            return conflict(format!("{} has no noise parameters to tune", method.name()));
        }
        if let Some(unknown) = self.parameters.iter().find(|name| !known.contains(&name.as_str())) {
            let (name, known) = (method.name(), known.join(", "));
            return conflict(format!(
                "--parameters: {unknown} is no noise parameter of {name}, expected some of {known}"
            ));
        }
        radio_contradiction(*method, self.mine.as_deref(), &self.radio)
    }
}

/// An optimiser on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(transparent)]
pub struct OptimiserName(pub adit_tuning::optimise::Method);

impl ValueEnum for OptimiserName {
    fn value_variants<'a>() -> &'a [Self] {
        use adit_tuning::optimise::Method::{Bat, CovarianceMatrix, SineCosine, SineCosineBat};
        &[Self(CovarianceMatrix), Self(SineCosineBat), Self(Bat), Self(SineCosine)]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        use adit_tuning::optimise::Method::{Bat, CovarianceMatrix, SineCosine, SineCosineBat};
        Some(PossibleValue::new(self.0.name()).help(match self.0 {
            CovarianceMatrix => "Covariance matrix adaptation with restarts (CMA-ES): the one to use",
            SineCosineBat => "Sine cosine and bat algorithm together, as in system S1",
            Bat => "Bat algorithm",
            SineCosine => "Sine cosine algorithm",
        }))
    }
}
