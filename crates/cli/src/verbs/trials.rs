//! What methods are compared and tuned on: logs with their truth, simulated or recorded.

use crate::log_stream::LogStream;
use crate::scenario_file::{Contest, Scenario};
use crate::truth_beside;
use crate::verbs::recorded_set::SetRuns;
use adit_core::solution::Solution;
use adit_core::trajectory::{Pose, Trajectory};
use adit_estimation::methods::{Method, MethodError, MethodReport};
use adit_estimation::radio::RadioSite;
use adit_evaluation::ape::carries_attitude;
use adit_evaluation::compare::TrueState;
use adit_observation::sidecar::Sidecar;
use adit_observation::{Observation, truth};
use adit_simulation::radio::RangeTruth;
use adit_simulation::{Emission, TruthState};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// All runs; each is made or read when it is its turn.
pub enum Trials {
    /// A scenario, its first seed and their number.
    Simulated(Box<Scenario>, u64, usize),
    /// Logs with their truth.
    Recorded(Vec<(PathBuf, PathBuf)>),
    /// Runs of a set of a suite.
    Set(Box<SetRuns>),
}

/// One run.
pub struct Trial {
    /// Its name, for messages.
    pub name: String,
    /// The log.
    pub observations: Vec<Observation>,
    /// The truth of each range of the log, in its order, where it was simulated.
    pub range_truths: Vec<RangeTruth>,
    /// The truth.
    pub truth: Vec<TrueState>,
    /// What is told beside the log.
    pub sidecar: Option<Sidecar>,
    /// What is known of the radio of its site.
    pub radio: Option<Arc<RadioSite>>,
    /// The truth has positions.
    pub has_position: bool,
    /// The truth has heights.
    pub has_height: bool,
    /// The truth has attitudes.
    pub has_attitude: bool,
    /// For each true state whether attitudes are judged there, where the truth says so.
    pub marked: Option<Vec<bool>>,
}

impl Trials {
    /// Those of a scenario file or a folder.
    pub fn of(source: &Path, seeds: u32) -> Result<Self> {
        if !source.is_dir() {
            let scenario = Scenario::read(source)?;
            let first = scenario.seed;
            return Ok(Self::Simulated(Box::new(scenario), first, seeds as usize));
        }
        Ok(Self::Recorded(pairs(source)?))
    }

    /// Those of logs that have a truth beside them, and of folders of such logs.
    pub fn recorded(paths: &[PathBuf]) -> Result<Self> {
        let mut all: Vec<(PathBuf, PathBuf)> = Vec::new();
        for path in paths {
            if path.is_dir() {
                all.extend(pairs(path)?);
                continue;
            }
            let truth = truth_beside::of(path).with_context(|| {
                let names = truth_beside::names(path).join(" or ");
                format!("{}: no truth beside it: expected {names}", path.display())
            })?;
            all.push((path.clone(), truth));
        }
        Ok(Self::Recorded(all))
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Simulated(_, _, count) => *count,
            Self::Recorded(pairs) => pairs.len(),
            Self::Set(runs) => runs.len(),
        }
    }

    /// Seed of the first.
    pub fn first_seed(&self) -> Option<u64> {
        match self {
            Self::Simulated(_, first, _) => Some(*first),
            Self::Recorded(_) | Self::Set(_) => None,
        }
    }

    /// Name of one in a list of them: its seed, or what its file is called.
    pub fn name(&self, index: usize) -> String {
        match self {
            Self::Simulated(_, first, _) => format!("seed {}", first.wrapping_add(index as u64)),
            Self::Recorded(pairs) => truth_beside::stem(&pairs[index].0),
            Self::Set(runs) => runs.name(index).to_owned(),
        }
    }

    /// What the scenario says of a comparison.
    pub fn contest(&self) -> Result<Contest> {
        match self {
            Self::Simulated(scenario, ..) => scenario.contest(),
            Self::Recorded(_) | Self::Set(_) => Ok(Contest::default()),
        }
    }

    /// Makes or reads one.
    pub fn get(&self, index: usize) -> Result<Trial> {
        match self {
            Self::Simulated(..) => self.of_person(index, 0),
            Self::Recorded(pairs) => recorded(&pairs[index].0, &pairs[index].1),
            Self::Set(runs) => runs.get(index),
        }
    }

    /// Makes the run of another person, by number from 0, of everybody in a mine.
    pub fn of_person(&self, index: usize, person: usize) -> Result<Trial> {
        match self {
            Self::Simulated(scenario, first, _) => {
                simulated(scenario, first.wrapping_add(index as u64), person)
            }
            Self::Recorded(_) | Self::Set(_) if person == 0 => self.get(index),
            Self::Recorded(_) | Self::Set(_) => bail!("recorded runs have no further people"),
        }
    }
}

impl Trial {
    /// The whole log through a method, which is left as it is at the end; each solution goes to `take`.
    pub fn run<R: MethodReport>(
        &self,
        method: &mut dyn Method<Report = R>,
        take: impl FnMut(Solution),
    ) -> Result<(), MethodError> {
        run(&self.observations, method, take)
    }

    /// The truth as a path.
    pub fn path(&self) -> Result<Trajectory> {
        Ok(Trajectory::new(self.truth.iter().map(|state| state.pose).collect())?)
    }
}

/// Observations through a method, which is left as it is at the end; each solution goes to `take`.
pub fn run<R: MethodReport>(
    observations: &[Observation],
    method: &mut dyn Method<Report = R>,
    mut take: impl FnMut(Solution),
) -> Result<(), MethodError> {
    for observation in observations {
        let mut solution = method.observe(observation)?;
        while let Some(now) = solution {
            take(now);
            solution = method.next_due()?;
        }
    }
    while let Some(last) = method.finish_next()? {
        take(last);
    }
    Ok(())
}

fn simulated(scenario: &Scenario, seed: u64, person: usize) -> Result<Trial> {
    let run = scenario.generate_person(seed, person)?;
    let (mut observations, mut truth, mut range_truths) = (Vec::new(), Vec::new(), Vec::new());
    for emission in run.emissions {
        observations.push(emission.observation());
        match emission {
            Emission::Imu(_, TruthState { time, position_m, velocity_m_s, attitude, .. }) => {
                let pose = Pose { time, position_m, attitude };
                truth.push(TrueState { pose, velocity_m_s: Some(velocity_m_s) });
            }
            Emission::Range(_, truth) => range_truths.push(truth),
            _ => {}
        }
    }
    let name = format!("seed {seed}");
    Ok(Trial {
        name,
        observations,
        range_truths,
        truth,
        sidecar: run.sidecar,
        radio: scenario.radio_site()?,
        has_position: true,
        has_height: true,
        has_attitude: true,
        marked: None,
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
        range_truths: Vec::new(),
        truth: known.trajectory.poses().iter().map(state).collect(),
        sidecar: stream.sidecar().cloned(),
        radio: None,
        has_position: known.has_position,
        has_height: known.has_height,
        has_attitude: known.has_attitude && carries_attitude(&known.trajectory),
        marked: known.moving,
    })
}

/// Logs of a folder that have a truth, by name; there is one at least.
fn pairs(folder: &Path) -> Result<Vec<(PathBuf, PathBuf)>> {
    let context = || format!("{}: cannot read this folder", folder.display());
    let mut pairs = Vec::new();
    for entry in fs::read_dir(folder).with_context(context)? {
        let log = entry.with_context(context)?.path();
        if truth_beside::is_simulated(&log) || truth_beside::stem(&log).ends_with("_imu") {
            pairs.extend(truth_beside::of(&log).map(|truth| (log, truth)));
        }
    }
    if pairs.is_empty() {
        bail!(
            "{}: no runs in this folder, expected NAME_imu.csv with NAME_truth.csv, or log.mcap with truth.tum",
            folder.display()
        );
    }
    pairs.sort();
    Ok(pairs)
}
