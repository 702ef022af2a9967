//! `adit simulate`: a scenario in, a log with its truth out.

use crate::args::SimulateArgs;
use crate::interrupt;
use crate::output::{self, make_folder};
use crate::progress::{Progress, Unit};
use crate::scenario_file::{Run, Scenario};
use adit_core::trajectory::Pose;
use adit_observation::mcap_log::{McapLogWriter, Packing};
use adit_observation::tum::TumWriter;
use adit_simulation::{Emission, MagneticTruth, TruthState};
use anyhow::Result;
use std::path::{Path, PathBuf};

/// Samples between two looks at the bar and Ctrl-C.
const PULSE: u64 = 1024;

/// Simulates and says what was made.
pub fn run(args: &SimulateArgs) -> Result<()> {
    let scenario = Scenario::read(&args.scenario)?;
    let made = simulate(&scenario, args.seed.unwrap_or(scenario.seed), &args.out)?;
    output::print(&format!(
        "{}: {} samples over {:.1} s\n{}{}: the truth\n",
        made.log.display(),
        made.samples,
        made.duration_s,
        made.magnetic_line(),
        made.truth.display()
    ))
}

/// What a simulation left behind.
pub struct Simulated {
    /// Samples, in order of time.
    pub log: PathBuf,
    /// Pose of the sensor at each inertial one.
    pub truth: PathBuf,
    /// Number of inertial samples.
    pub samples: u64,
    /// Number of magnetic samples.
    magnetic: u64,
    /// The largest magnetic disturbance met.
    worst: Disturbance,
    /// Length in time, s.
    pub duration_s: f64,
}

impl Simulated {
    fn magnetic_line(&self) -> String {
        let Disturbance { norm_ut, time_s } = self.worst;
        match (self.magnetic, norm_ut > 0.0) {
            (0, _) => String::new(),
            (count, false) => format!("  with {count} magnetic samples of an undisturbed field\n"),
            (count, true) => {
                format!(
                    "  with {count} magnetic samples, disturbed by at most {norm_ut:.1} µT at {time_s:.1} s\n"
                )
            }
        }
    }
}

/// What steel and currents added to the Earth's field, and when.
#[derive(Debug, Clone, Copy, Default)]
struct Disturbance {
    norm_ut: f64,
    time_s: f64,
}

impl Disturbance {
    /// The larger one.
    fn or(self, truth: &MagneticTruth) -> Self {
        let norm_ut = truth.disturbance_ut.norm();
        if norm_ut > self.norm_ut { Self { norm_ut, time_s: truth.time.seconds() } } else { self }
    }
}

/// Writes `log.mcap` and `truth.tum` of a scenario into a folder, sample by sample; with a magnetometer also `log.toml`, the
/// sidecar that gives the declination, so that headings come out from true north as in the truth.
pub fn simulate(scenario: &Scenario, seed: u64, folder: &Path) -> Result<Simulated> {
    let Run { duration_s, emissions, declination_rad } = scenario.generate(seed)?;
    make_folder(folder)?;
    let (log_path, truth_path) = (folder.join("log.mcap"), folder.join("truth.tum"));
    let mut log = McapLogWriter::create(&log_path, Packing::Lz4)?;
    let mut truth = TumWriter::create(&truth_path)?;
    let progress = Progress::new("simulating", Unit::Samples, None);
    let (mut samples, mut magnetic) = (0_u64, 0_u64);
    let mut worst = Disturbance::default();
    for emission in emissions {
        log.push(&emission.observation())?;
        match emission {
            Emission::Imu(_, TruthState { time, position_m, attitude, .. }) => {
                truth.push(&Pose { time, position_m, attitude })?;
                samples += 1;
                if samples.is_multiple_of(PULSE) {
                    interrupt::check()?;
                    progress.at(samples);
                }
            }
            Emission::Magnetic(_, field) => {
                magnetic += 1;
                worst = worst.or(&field);
            }
        }
    }
    log.finish()?;
    truth.finish()?;
    if let Some(declination_rad) = declination_rad {
        let text = format!(
            "# What is known of the simulated site; `adit track` reads it with the log.\n[frame]\nmagnetic_declination_deg = {:.3}\n",
            declination_rad.to_degrees()
        );
        output::write_file(&folder.join("log.toml"), &text)?;
    }
    Ok(Simulated { log: log_path, truth: truth_path, samples, magnetic, worst, duration_s })
}
