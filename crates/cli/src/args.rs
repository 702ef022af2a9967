//! The command line: names, flags and their help. This is a contract; scripts stand on it.

mod calibrate;
mod compare;
mod load;
pub mod mine;
mod nlos;
mod radio;
mod range;
mod replay;
mod serve;
mod store;
mod tune;

pub use calibrate::{CalibrateArgs, CalibrateMagArgs, CalibrateNoiseArgs, Calibration};
pub use compare::CompareArgs;
pub use load::LoadArgs;
pub use nlos::{NlosArgs, NlosEvalArgs, NlosTrainArgs, NlosVerb};
pub use radio::{CalibrateFingerprintArgs, CalibratePathlossArgs, LeaveOut, RadioArgs};
pub use range::CalibrateRangeArgs;
pub use replay::ReplayArgs;
pub use serve::ServeArgs;
pub use store::{AuditArgs, AuditVerb, AuditVerifyArgs, Exported, StoreArgs, StoreExportArgs, StoreVerb};
pub use tune::{OptimiserName, TuneArgs};

use crate::method::MethodName;
use crate::output::Target;
use adit_estimation::methods::RadioUse;
use adit_evaluation::alignment::Alignment;
use clap::error::{Error as UsageError, ErrorKind};
use clap::{ArgAction, Args, CommandFactory, Parser, Subcommand, ValueHint};
use std::fmt;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::str::FromStr;

const EXAMPLES: &str = "\
Examples:
  adit demo                                          a simulated shift of 200 people, live in the console
  adit track walk_imu.csv.gz --method foot-ins -o walk.tum
  adit eval walk.tum --truth walk_truth.csv --plot walk.svg

Exit code: 0 done, 1 the work failed, 2 wrong usage. Errors are one line on stderr, with file and line.";

const DEMO_EXAMPLES: &str = "\
Examples:
  adit demo                                          200 people, ten times as fast as real time; opens the console
  adit demo --speed 4 --listen 0.0.0.0:8080          for others on the network to look at
  adit demo --walk --out /tmp/walk                   one walk, tracked and judged";

const SIMULATE_EXAMPLES: &str = "\
The scenario is a TOML file; scenarios/s2.toml (one walk) and scenarios/shift.toml (everybody in a mine) of the repository are
commented examples. The same scenario and seed give the same bytes, on any number of threads (RAYON_NUM_THREADS).

One walk: DIR/log.mcap, truth.tum and, where something is known beside them, log.toml. Everybody in a mine: DIR/p001/log.mcap,
truth.tum, ranges_truth.csv, activities.csv, log.toml, and so on for each person, with DIR/mine.json and people.csv.

Examples:
  adit simulate scenarios/s2.toml -o out/walk
  adit simulate scenarios/s2.toml -o out/walk-7 --seed 7
  adit simulate scenarios/shift.toml -o out/shift --people 1-4";

const TRACK_EXAMPLES: &str = "\
Logs:
  CSV, plain or gzip, with the unit in each column name (time_s, acc_x_m_s2 or acc_x_g, gyro_x_rad_s or gyro_x_deg_s, …),
  or MCAP; the kind is told by content. A sidecar WALK.toml beside WALK.csv may give mounting, frame and noise.
  Several logs are merged in order of time into one stream: consecutive parts of one recording, or one file per sensor, all
  on one clock. Two logs whose inertial samples overlap in time are an error.

Output:
  TUM text, a line `t x y z qx qy qz qw` for every inertial sample: metres, z up, quaternion sensor to world, scalar last;
  the walk starts at the origin. Files appear when complete, never half written.

Radio:
  wifi makes positions of the signal strengths in the log. It needs to know the site: --mine gives places (and path loss) of access
  points, --radio what adit calibrate found on the spot; both together: what was calibrated goes first.
  uwb-ls makes positions of ranges; --mine gives the places of the anchors, and what each adds to its ranges.

Examples:
  adit track walk_imu.csv.gz --method foot-ins -o walk.tum
  adit track walk.mcap --method foot-ins --smooth -o walk.tum --json report.json
  adit track shift/p001/log.mcap --method wifi --mine shift/mine.json -o p001.tum
  adit track ranges.csv --method uwb-ls --mine anchors.csv -o walk.tum --covariance walk.csv
  adit track part1.csv part2.csv --method foot-ins -o - | gzip > walk.tum.gz";

const EVAL_EXAMPLES: &str = "\
The estimate is interpolated at the times of the truth, of which it must cover 95 %. Figures: absolute position error (RMSE,
mean, median, 90 and 95 %, largest), attitude error where the truth has attitudes, relative error over 1 m and 10 m, error
at the end, distance travelled. Exit code 1 when the estimate cannot be scored.

Attitude alone is judged where the truth has no positions, or where all positions of the estimate are zero (ahrs). Nothing
is forgiven then unless --align says so: start = heading of the first 2 s, se2 = heading over the run, se3 = all three angles.
A truth with a column `moving` is scored where it is 1; the other rows are left out as if they were not there.

Examples:
  adit eval walk.tum --truth walk_truth.csv
  adit eval walk.tum --truth truth.tum --align start --start-distance 2 --json
  adit eval walk.tum --truth truth.tum --covariance walk.csv --plot walk.svg
  adit eval hand.tum --truth hand_truth.csv --align se2                attitude from a log without magnetometer";

/// Where is everybody underground: turns the logs of people's tags into their paths, and judges them against truth
#[derive(Debug, Parser)]
#[command(name = "adit", version, after_help = EXAMPLES)]
pub struct Adit {
    /// What to do
    #[command(subcommand)]
    pub verb: Verb,

    /// Say more on stderr: -v what is done, -vv details
    #[arg(short, long, global = true, action = ArgAction::Count, display_order = 900)]
    pub verbose: u8,
}

impl Adit {
    /// The command line of this process, checked beyond what a single flag can say of itself.
    pub fn from_command_line() -> Result<Self, UsageError> {
        let args = Self::try_parse()?;
        let twice = match &args.verb {
            Verb::Track(TrackArgs { out, json, .. }) => {
                out == &Target::Stdout && json.as_ref() == Some(&Target::Stdout)
            }
            Verb::Calibrate(CalibrateArgs { what }) => what.takes_stdout_twice(),
            _ => false,
        };
        if twice {
            let what = "-o and --json cannot both go to stdout";
            return Err(Self::command().error(ErrorKind::ArgumentConflict, what));
        }
        if let Verb::Tune(tune) = &args.verb
            && let Some((kind, what)) = tune.contradiction()
        {
            return Err(Self::command().error(kind, what));
        }
        if let Verb::Track(track) = &args.verb
            && let Some((kind, what)) = track.contradiction()
        {
            return Err(Self::command().error(kind, what));
        }
        Ok(args)
    }
}

/// The verbs.
#[derive(Debug, Subcommand)]
pub enum Verb {
    /// Watch a simulated shift live: people at work, a fall, a power cut, an evacuation
    Demo(DemoArgs),
    /// Make a log and its truth from a scenario
    Simulate(SimulateArgs),
    /// Turn the log of a tag into the path of its wearer
    Track(TrackArgs),
    /// Judge an estimated path against the truth
    Eval(EvalArgs),
    /// Learn the errors of a sensor, or the radio of a site, from recordings
    Calibrate(CalibrateArgs),
    /// Check a mine file, or write it in another form
    Mine(mine::MineArgs),
    /// Learn whether a signal came straight from how it came in, or judge such a model
    Nlos(NlosArgs),
    /// Compare methods over many seeds of a scenario, or on recorded runs
    Compare(CompareArgs),
    /// Find the noise parameters of a method on logs with truth
    Tune(TuneArgs),
    /// Follow everybody live: gateways in; positions, alarms and an open API out
    Serve(ServeArgs),
    /// Back up, check or export what a server has stored
    Store(StoreArgs),
    /// Find out whether somebody tampered with the audit log of a server
    Audit(AuditArgs),
    /// Load a server with simulated tags and tell what came of what was sent
    Load(LoadArgs),
    /// Send a recorded log to a server, as a gateway would
    Replay(ReplayArgs),
}

/// `adit demo`.
#[derive(Debug, Args)]
#[command(after_help = DEMO_EXAMPLES)]
pub struct DemoArgs {
    /// One walk instead of a shift: simulated, tracked from its log and judged
    #[arg(long, conflicts_with_all = ["people", "speed", "minutes", "listen", "no_browser"])]
    pub walk: bool,

    /// Folder for everything that is written; a shift without it is removed at the end, a walk goes to out/demo
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub out: Option<PathBuf>,

    /// Seed of every random draw; 1 when not given here
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,

    /// People of the shift
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(4..=2000))]
    pub people: u32,

    /// How many times as fast as real time, 1 to 100
    #[arg(long, value_name = "X", default_value_t = 10.0, value_parser = speed)]
    pub speed: f64,

    /// End after so many minutes of the shift; of less than 40 the story is told in less [default: Ctrl-C]
    #[arg(long, value_name = "MINUTES", value_parser = minutes)]
    pub minutes: Option<f64>,

    /// Address of the console; 127.0.0.1:8080 when not given, or any port where that is taken
    #[arg(long, value_name = "ADDRESS:PORT")]
    pub listen: Option<SocketAddr>,

    /// Open no browser
    #[arg(long)]
    pub no_browser: bool,
}

fn speed(text: &str) -> Result<f64, String> {
    number(text, |v| (1.0..=100.0).contains(&v), "a number from 1 to 100")
}

fn minutes(text: &str) -> Result<f64, String> {
    number(text, |v| (1.0..=240.0).contains(&v), "minutes from 1 to 240")
}

/// `adit simulate`.
#[derive(Debug, Args)]
#[command(after_help = SIMULATE_EXAMPLES)]
pub struct SimulateArgs {
    /// The scenario
    #[arg(value_name = "SCENARIO.toml", value_hint = ValueHint::FilePath)]
    pub scenario: PathBuf,

    /// Folder for log.mcap, truth.tum and what is known beside them; made when it is not there
    #[arg(short, long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub out: PathBuf,

    /// Seed of every random draw, instead of the scenario's
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,

    /// Write the logs of these people only; the others are in their way all the same [default: all]
    #[arg(long, value_name = "FIRST-LAST")]
    pub people: Option<PeopleRange>,
}

/// Some of the people, counted from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PeopleRange {
    first: usize,
    last: usize,
}

impl PeopleRange {
    /// As numbers from 1; `None` when there are not so many.
    pub fn within(self, count: usize) -> Option<std::ops::RangeInclusive<usize>> {
        (self.last <= count).then_some(self.first..=self.last)
    }
}

impl FromStr for PeopleRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (first, last) = text.split_once('-').unwrap_or((text, text));
        let number = |text: &str| text.trim().parse().ok().filter(|number| *number >= 1);
        match (number(first), number(last)) {
            (Some(first), Some(last)) if first <= last => Ok(Self { first, last }),
            _ => Err("expected a number from 1 on, or two with a hyphen: 7, 1-20".to_owned()),
        }
    }
}

impl fmt::Display for PeopleRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}-{}", self.first, self.last)
    }
}

/// `adit track`.
#[derive(Debug, Args)]
#[command(after_help = TRACK_EXAMPLES)]
pub struct TrackArgs {
    /// Log of the tag; several are merged in order of time
    #[arg(value_name = "LOG", required = true, value_hint = ValueHint::FilePath)]
    pub logs: Vec<PathBuf>,

    /// How to position
    #[arg(long, value_enum)]
    pub method: MethodName,

    /// Trajectory to write, TUM text; `-` is stdout, `.gz` compresses
    #[arg(short, long, value_name = "EST.tum", value_hint = ValueHint::FilePath)]
    pub out: Target,

    /// Parameters of the method, TOML; what it leaves out keeps its default
    #[arg(long, value_name = "F.toml", value_hint = ValueHint::FilePath)]
    pub config: Option<PathBuf>,

    /// The mine, in any form of a mine file, or a bare list of places: CSV with `anchor_id,x_m,y_m,z_m`
    #[arg(long, value_name = "MINE", value_hint = ValueHint::FilePath)]
    pub mine: Option<PathBuf>,

    /// The radio of the site as `adit calibrate pathloss` or `fingerprint` wrote it; one of each at most
    #[arg(long, value_name = "MODEL", value_hint = ValueHint::FilePath)]
    pub radio: Vec<PathBuf>,

    /// Judge whether ranges came straight from how their signals came in: flat or mine (they ship with adit), or a model of adit nlos train
    #[arg(long, value_name = "flat|mine|MODEL", value_hint = ValueHint::FilePath)]
    pub nlos: Option<String>,

    /// Smooth over the whole log, forwards and backwards; holds it in memory
    #[arg(long)]
    pub smooth: bool,

    /// Smooth over this many seconds (0.1 to 60) behind the newest sample, still streaming
    #[arg(long, value_name = "SECONDS", conflicts_with = "smooth", value_parser = lag, allow_negative_numbers = true)]
    pub lag: Option<f64>,

    /// Write the first pose, the last, and between them one in so many seconds (0.001 to 3600) [default: all]
    #[arg(long, value_name = "SECONDS", value_parser = every, allow_negative_numbers = true)]
    pub every: Option<f64>,

    /// Report to write, JSON; `-` is stdout
    #[arg(long, value_name = "REPORT.json", value_hint = ValueHint::FilePath)]
    pub json: Option<Target>,

    /// Solutions to write with velocity and covariance, CSV (what eval --covariance reads)
    #[arg(long, value_name = "OUT.csv", value_hint = ValueHint::FilePath)]
    pub covariance: Option<PathBuf>,
}

impl TrackArgs {
    /// What the method cannot do with the flags, or without them.
    fn contradiction(&self) -> Option<(ErrorKind, String)> {
        let Self { method, smooth, lag, mine, radio, nlos, .. } = self;
        let name = method.name();
        let over = match () {
            () if *smooth && !method.has_whole_log() => Some("--smooth"),
            () if lag.is_some() && !method.has_fixed_lag() => Some("--lag"),
            () => None,
        };
        if let Some(flag) = over {
            let what = format!("{name} has no smoother: {flag} cannot be used with it");
            return Some((ErrorKind::ArgumentConflict, what));
        }
        if nlos.is_some() && method.radio() == RadioUse::Unused {
            let what = format!("{name} makes no use of ranges: --nlos cannot be used with it");
            return Some((ErrorKind::ArgumentConflict, what));
        }
        radio_contradiction(*method, mine.as_deref(), radio)
    }
}

/// What a method cannot do with what is said of the radio of the site, or without it.
fn radio_contradiction(
    method: MethodName,
    mine: Option<&Path>,
    radio: &[PathBuf],
) -> Option<(ErrorKind, String)> {
    let name = method.name();
    let site = mine.map(|_| "--mine").or(radio.first().map(|_| "--radio"));
    match (method.radio(), site) {
        (RadioUse::Unused, Some(flag)) => {
            let what = format!("{name} makes no use of the radio of a site: {flag} cannot be used with it");
            Some((ErrorKind::ArgumentConflict, what))
        }
        (RadioUse::Needed, None) => {
            let what = format!(
                "{name} needs the radio of the site: --mine MINE (places of access points and anchors) or --radio MODEL \
                 (of adit calibrate pathloss or fingerprint)"
            );
            Some((ErrorKind::MissingRequiredArgument, what))
        }
        _ => None,
    }
}

/// `adit eval`.
#[derive(Debug, Args)]
#[command(after_help = EVAL_EXAMPLES)]
pub struct EvalArgs {
    /// Estimated trajectory, TUM text
    #[arg(value_name = "EST.tum", value_hint = ValueHint::FilePath)]
    pub estimate: PathBuf,

    /// True trajectory: TUM text, or CSV with `time_s[,x_m,y_m[,z_m]][,qw,qx,qy,qz][,moving]`
    #[arg(long, value_name = "TRUTH", value_hint = ValueHint::FilePath)]
    pub truth: PathBuf,

    /// What to forgive before errors are taken: none; start = position and heading at the start; se2 = position and heading
    /// over the run; se3 = position and all three angles [default: se2; none for attitude alone]
    #[arg(long, value_name = "none|start|se2|se3")]
    pub align: Option<Alignment>,

    /// Score every row of the truth, not only those that its column `moving` marks
    #[arg(long)]
    pub all_rows: bool,

    /// For --align start: the heading is that of the first true pose this far away, metres
    #[arg(long, value_name = "M", default_value_t = 1.0, value_parser = not_negative, allow_negative_numbers = true)]
    pub start_distance: f64,

    /// Print one JSON object instead of the table
    #[arg(long)]
    pub json: bool,

    /// Figure to write, SVG: path over truth (not for attitude alone), errors over time and their distribution on one page
    #[arg(long, value_name = "OUT.svg", value_hint = ValueHint::FilePath)]
    pub plot: Option<PathBuf>,

    /// Solutions with covariance of the same estimate, CSV (track --covariance): are the stated errors honest (NEES)?
    #[arg(long, value_name = "EST.csv", value_hint = ValueHint::FilePath)]
    pub covariance: Option<PathBuf>,
}

fn every(text: &str) -> Result<f64, String> {
    number(text, |v| (0.001..=3600.0).contains(&v), "seconds from 0.001 to 3600")
}

fn lag(text: &str) -> Result<f64, String> {
    number(text, |v| (0.1..=60.0).contains(&v), "seconds from 0.1 to 60")
}

fn not_negative(text: &str) -> Result<f64, String> {
    number(text, |v| v >= 0.0, "a number not below 0")
}

fn number(text: &str, good: impl Fn(f64) -> bool, expected: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().ok().filter(|v| v.is_finite() && good(*v));
    value.ok_or_else(|| format!("expected {expected}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_does_not_contradict_itself() {
        Adit::command().debug_assert();
    }
}
