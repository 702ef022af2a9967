//! What methods are compared on: a log with its truth, simulated or recorded.

use crate::log_stream::LogStream;
use crate::scenario_file::{Contest, Scenario};
use adit_core::trajectory::{Pose, Trajectory};
use adit_estimation::radio::RadioSite;
use adit_evaluation::ape::carries_attitude;
use adit_evaluation::compare::TrueState;
use adit_observation::sidecar::Sidecar;
use adit_observation::{Observation, truth};
use adit_simulation::{Emission, TruthState};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Names of a simulated pair.
const SIMULATED: (&str, &str) = ("log.mcap", "truth.tum");
const LOG_ENDINGS: [&str; 2] = ["_imu.csv.gz", "_imu.csv"];
const TRUTH_ENDINGS: [&str; 2] = ["_truth.csv.gz", "_truth.csv"];

/// All runs; each is made or read when it is its turn.
pub enum Trials {
    /// A scenario, its first seed and their number.
    Simulated(Box<Scenario>, u64, usize),
    /// Logs with their truth.
    Recorded(Vec<(PathBuf, PathBuf)>),
}

/// One run.
pub struct Trial {
    /// Its name, for messages.
    pub name: String,
    /// The log.
    pub observations: Vec<Observation>,
    /// The truth.
    pub truth: Vec<TrueState>,
    /// What is told beside the log.
    pub sidecar: Option<Sidecar>,
    /// What is known of the radio of its site.
    pub radio: Option<Arc<RadioSite>>,
    /// The truth has positions.
    pub has_position: bool,
    /// The truth has attitudes.
    pub has_attitude: bool,
}

impl Trials {
    /// Those of a scenario file or a folder.
    pub fn of(source: &Path, seeds: u32) -> Result<Self> {
        if !source.is_dir() {
            let scenario = Scenario::read(source)?;
            let first = scenario.seed;
            return Ok(Self::Simulated(Box::new(scenario), first, seeds as usize));
        }
        let pairs = pairs(source)?;
        if pairs.is_empty() {
            bail!(
                "{}: no runs in this folder, expected NAME_imu.csv with NAME_truth.csv, or log.mcap with truth.tum",
                source.display()
            );
        }
        Ok(Self::Recorded(pairs))
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Simulated(_, _, count) => *count,
            Self::Recorded(pairs) => pairs.len(),
        }
    }

    /// Seed of the first.
    pub fn first_seed(&self) -> Option<u64> {
        match self {
            Self::Simulated(_, first, _) => Some(*first),
            Self::Recorded(_) => None,
        }
    }

    /// What the scenario says of a comparison.
    pub fn contest(&self) -> Result<Contest> {
        match self {
            Self::Simulated(scenario, ..) => scenario.contest(),
            Self::Recorded(_) => Ok(Contest::default()),
        }
    }

    /// Makes or reads one.
    pub fn get(&self, index: usize) -> Result<Trial> {
        match self {
            Self::Simulated(scenario, first, _) => simulated(scenario, first.wrapping_add(index as u64)),
            Self::Recorded(pairs) => recorded(&pairs[index].0, &pairs[index].1),
        }
    }
}

impl Trial {
    /// The truth as a path.
    pub fn path(&self) -> Result<Trajectory> {
        Ok(Trajectory::new(self.truth.iter().map(|state| state.pose).collect())?)
    }
}

fn simulated(scenario: &Scenario, seed: u64) -> Result<Trial> {
    let run = scenario.generate(seed)?;
    let (mut observations, mut truth) = (Vec::new(), Vec::new());
    for emission in run.emissions {
        observations.push(emission.observation());
        if let Emission::Imu(_, TruthState { time, position_m, velocity_m_s, attitude, .. }) = emission {
            let pose = Pose { time, position_m, attitude };
            truth.push(TrueState { pose, velocity_m_s: Some(velocity_m_s) });
        }
    }
    let name = format!("seed {seed}");
    Ok(Trial {
        name,
        observations,
        truth,
        sidecar: run.sidecar,
        radio: scenario.radio_site()?,
        has_position: true,
        has_attitude: true,
    })
}

fn recorded(log: &Path, truth: &Path) -> Result<Trial> {
    let mut stream = LogStream::open(&[log.to_path_buf()])?;
    let mut observations = Vec::new();
    while let Some(observation) = stream.next()? {
        observations.push(observation);
    }
    let known = truth::read(truth)?;
    let state = |pose: &Pose| TrueState { pose: *pose, velocity_m_s: None };
    Ok(Trial {
        name: log.display().to_string(),
        observations,
        truth: known.trajectory.poses().iter().map(state).collect(),
        sidecar: stream.sidecar().cloned(),
        radio: None,
        has_position: known.has_position,
        has_attitude: known.has_attitude && carries_attitude(&known.trajectory),
    })
}

/// Logs of a folder that have a truth, by name.
fn pairs(folder: &Path) -> Result<Vec<(PathBuf, PathBuf)>> {
    let context = || format!("{}: cannot read this folder", folder.display());
    let mut pairs = Vec::new();
    for entry in fs::read_dir(folder).with_context(context)? {
        let log = entry.with_context(context)?.path();
        let Some(name) = log.file_name().and_then(|name| name.to_str()) else { continue };
        let beside = |name: &str| Some(log.with_file_name(name)).filter(|path| path.is_file());
        let truth = if name == SIMULATED.0 {
            beside(SIMULATED.1)
        } else {
            let stem = LOG_ENDINGS.iter().find_map(|ending| name.strip_suffix(ending));
            stem.and_then(|stem| TRUTH_ENDINGS.iter().find_map(|ending| beside(&format!("{stem}{ending}"))))
        };
        pairs.extend(truth.map(|truth| (log.clone(), truth)));
    }
    pairs.sort();
    Ok(pairs)
}
