//! `adit simulate`: a scenario in, a log with its truth out, and a sidecar where something is told of the log.

use crate::args::SimulateArgs;
use crate::interrupt;
use crate::output::{self, make_folder};
use crate::progress::{Progress, Unit};
use crate::scenario_file::{Run, Scenario};
use adit_core::trajectory::Pose;
use adit_observation::mcap_log::{McapLogWriter, Packing};
use adit_observation::sidecar::{Sidecar, SidecarEdit};
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
        "{}: {} samples over {:.1} s\n{}{}{}: the truth\n",
        made.log.display(),
        made.samples,
        made.duration_s,
        made.magnetic_line(),
        made.fix_lines(),
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
    /// Number of position fixes.
    fixes: u64,
    /// What is told beside the log, where there is something to tell.
    sidecar: Option<PathBuf>,
    /// The largest magnetic disturbance met.
    worst: Disturbance,
    /// Length in time, s.
    pub duration_s: f64,
}

impl Simulated {
    fn fix_lines(&self) -> String {
        let fixes = match self.fixes {
            0 => String::new(),
            count => format!("  with {count} position fixes\n"),
        };
        let told = |path: &PathBuf| format!("{}: what is known beside the log\n", path.display());
        fixes + &self.sidecar.as_ref().map_or_else(String::new, told)
    }

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

/// Writes `log.mcap` and `truth.tum` of a scenario into a folder, sample by sample; where something is known beside the log
/// also `log.toml`, the sidecar that gives it: the declination, so that headings come out from true north as in the truth; site, start
/// and noise of a roadway walk.
pub fn simulate(scenario: &Scenario, seed: u64, folder: &Path) -> Result<Simulated> {
    let Run { duration_s, sidecar, emissions } = scenario.generate(seed)?;
    make_folder(folder)?;
    let (log_path, truth_path) = (folder.join("log.mcap"), folder.join("truth.tum"));
    let mut log = McapLogWriter::create(&log_path, Packing::Lz4)?;
    let mut truth = TumWriter::create(&truth_path)?;
    let progress = Progress::new("simulating", Unit::Samples, None);
    let (mut samples, mut magnetic, mut fixes) = (0_u64, 0_u64, 0_u64);
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
            Emission::Fix(..) => fixes += 1,
        }
    }
    log.finish()?;
    truth.finish()?;
    let sidecar = sidecar.map(|sidecar| write_sidecar(&sidecar, &log_path)).transpose()?;
    Ok(Simulated { log: log_path, truth: truth_path, samples, magnetic, fixes, sidecar, worst, duration_s })
}

/// Writes what is told of a log beside it; one of an earlier simulation is replaced.
fn write_sidecar(sidecar: &Sidecar, log: &Path) -> Result<PathBuf> {
    let path = log.with_extension("toml");
    let mut edit = SidecarEdit::parse(&path, &[])?;
    if let Some(noise) = &sidecar.noise {
        edit.set_noise(noise);
    }
    if let Some(site) = &sidecar.site {
        edit.set_site(site);
    }
    if let Some(start) = &sidecar.start {
        edit.set_start(start);
    }
    if let Some(declination_deg) = sidecar.frame.magnetic_declination_deg {
        edit.set_declination_deg(declination_deg);
    }
    let head = "# What is known of the simulated site; `adit track` reads it with the log.\n";
    output::write_file(&path, &(head.to_owned() + &edit.text()?))?;
    Ok(path)
}
