//! `adit simulate`: a scenario in, a log with its truth out.

use crate::args::SimulateArgs;
use crate::interrupt;
use crate::output::{self, make_folder};
use crate::progress::{Progress, Unit};
use crate::scenario_file::Scenario;
use adit_core::trajectory::Pose;
use adit_observation::Observation;
use adit_observation::mcap_log::{McapLogWriter, Packing};
use adit_observation::tum::TumWriter;
use anyhow::Result;
use std::path::{Path, PathBuf};

/// Samples between two looks at the bar and Ctrl-C.
const PULSE: u64 = 1024;

/// Simulates and says what was made.
pub fn run(args: &SimulateArgs) -> Result<()> {
    let scenario = Scenario::read(&args.scenario)?;
    let made = simulate(&scenario, args.seed.unwrap_or(scenario.seed), &args.out)?;
    output::print(&format!(
        "{}: {} samples over {:.1} s\n{}: the truth\n",
        made.log.display(),
        made.samples,
        made.duration_s,
        made.truth.display()
    ))
}

/// What a simulation left behind.
pub struct Simulated {
    /// Inertial samples.
    pub log: PathBuf,
    /// Pose of the sensor at each of them.
    pub truth: PathBuf,
    /// Number of samples.
    pub samples: u64,
    /// Length in time, s.
    pub duration_s: f64,
}

/// Writes `log.mcap` and `truth.tum` of a scenario into a folder, sample by sample.
pub fn simulate(scenario: &Scenario, seed: u64, folder: &Path) -> Result<Simulated> {
    let generator = scenario.generate(seed)?;
    let duration_s = generator.walk().duration_s();
    make_folder(folder)?;
    let (log_path, truth_path) = (folder.join("log.mcap"), folder.join("truth.tum"));
    let mut log = McapLogWriter::create(&log_path, Packing::Lz4)?;
    let mut truth = TumWriter::create(&truth_path)?;
    let progress = Progress::new("simulating", Unit::Samples, None);
    let mut samples = 0_u64;
    for (sample, state) in generator {
        log.push(&Observation::Imu(sample))?;
        truth.push(&Pose { time: state.time, position_m: state.position_m, attitude: state.attitude })?;
        samples += 1;
        if samples.is_multiple_of(PULSE) {
            interrupt::check()?;
            progress.at(samples);
        }
    }
    log.finish()?;
    truth.finish()?;
    Ok(Simulated { log: log_path, truth: truth_path, samples, duration_s })
}
