//! Recorded sets of a suite: which files make a run, and what a run holds.
//!
//! | beside `NAME_LOG.csv[.gz]` | becomes |
//! |---|---|
//! | `NAME_TRUTH.csv[.gz]` | the truth; places of the tag beside true ranges (`tag_x_m` …) as well |
//! | `NAME_anchors.csv[.gz]`, or the list that the suite names | places of anchors, receivers, beacons |
//! | the other runs of the set, with their truth | what is learnt of the signal strengths, where the suite asks for it |

mod join;
mod places;
mod rows;

use crate::log_stream::LogStream;
use crate::suite_file::{Learnt, RecordedSet};
use crate::truth_beside;
use crate::verbs::calibrate::radio as calibration;
use crate::verbs::trials::Trial;
use adit_core::time::{Interval, Time};
use adit_core::trajectory::{Pose, Trajectory};
use adit_estimation::radio::RadioSite;
use adit_evaluation::ape::carries_attitude;
use adit_evaluation::compare::TrueState;
use adit_observation::truth::{self, Truth};
use adit_observation::{FixSource, Observation, PositionFix};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The runs of a set.
pub struct SetRuns {
    set: RecordedSet,
    runs: Vec<SetRun>,
}

/// The files of one run.
struct SetRun {
    name: String,
    logs: Vec<PathBuf>,
    join: Vec<PathBuf>,
    truth: Option<PathBuf>,
}

impl SetRuns {
    /// Those of a set, in order of name; `None` where its folder is not there, an error where nothing in it is a run.
    pub fn find(set: &RecordedSet) -> Result<Option<Self>> {
        if !set.folder.is_dir() {
            return Ok(None);
        }
        let place = || format!("{}: cannot read this folder", set.folder.display());
        let mut runs = Vec::new();
        for entry in fs::read_dir(&set.folder).with_context(place)? {
            let file = entry.with_context(place)?.path();
            runs.extend(set.run_of(&file));
        }
        if runs.is_empty() {
            let endings = set.join.iter().chain(&set.logs).chain(&set.truth);
            let files: Vec<String> = endings.map(|ending| format!("NAME_{ending}.csv")).collect();
            bail!("{}: no runs in this folder, expected {}", set.folder.display(), files.join(" with "));
        }
        runs.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(Some(Self { set: set.clone(), runs }))
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.runs.len()
    }

    /// The name of one.
    pub fn name(&self, index: usize) -> &str {
        &self.runs[index].name
    }

    /// Whether the truth is known along the way.
    pub fn has_truth(&self) -> bool {
        self.set.truth.is_some()
    }

    /// Reads one.
    pub fn get(&self, index: usize) -> Result<Trial> {
        let (set, run) = (&self.set, &self.runs[index]);
        let name = format!("{} {}", set.name, run.name);
        let mut stream = LogStream::open_with(&run.logs, set.sidecar.as_ref())?;
        let mut observations = Vec::new();
        while let Some(observation) = stream.next()? {
            observations.push(observation);
        }
        let sidecar = set.sidecar.clone().or_else(|| stream.sidecar().cloned());
        if !run.join.is_empty() {
            observations.extend(join::joined(&run.join, sidecar.as_ref())?);
            observations.sort_by_key(Observation::time);
        }
        let mut known = match &run.truth {
            Some(path) => Some(self.truth(run, path)?),
            None => None,
        };
        if let (Some(sigma_m), Some(known)) = (set.first_fix_sigma_m, &mut known) {
            tell_first(&mut observations, known, sigma_m)?;
        }
        let radio = self.radio(index)?;
        let state = |pose: &Pose| TrueState { pose: *pose, velocity_m_s: None };
        let poses = || known.iter().flat_map(|known| known.trajectory.poses());
        Ok(Trial {
            name,
            observations,
            range_truths: Vec::new(),
            truth: poses().map(state).collect(),
            sidecar,
            radio,
            has_position: known.as_ref().is_none_or(|known| known.has_position),
            has_height: known.as_ref().is_none_or(|known| known.has_height),
            has_attitude: known
                .as_ref()
                .is_some_and(|known| known.has_attitude && carries_attitude(&known.trajectory)),
            marked: known.and_then(|known| known.moving),
        })
    }

    /// The truth, cut to the time that counts.
    fn truth(&self, run: &SetRun, path: &Path) -> Result<Truth> {
        let mut known = truth::from_input(rows::of_truth(path, self.set.truth_row.as_ref())?)?;
        let [mut from, to] = match self.set.logs.iter().position(|log| Some(log) == self.set.within.as_ref())
        {
            Some(nth) => times(&run.logs[nth])?,
            None => [Time::from_nanos(i64::MIN / 4), Time::from_nanos(i64::MAX / 4)],
        };
        if self.set.within.is_none()
            && let Some(first) = known.trajectory.poses().first()
        {
            from = first.time;
        }
        #[expect(clippy::cast_possible_truncation, reason = "seconds of a log")]
        let skip = Interval::from_nanos((self.set.skip_s * 1e9) as i64);
        let counts = |pose: &Pose| (from + skip..=to).contains(&pose.time);
        let poses = known.trajectory.poses();
        if let Some(moving) = &mut known.moving {
            let mut kept = poses.iter().map(counts);
            moving.retain(|_| kept.next().unwrap_or(false));
        }
        let kept: Vec<Pose> = poses.iter().filter(|pose| counts(pose)).copied().collect();
        if kept.is_empty() {
            bail!("{}: no row of the truth within the time of the log", path.display());
        }
        known.trajectory = Trajectory::new(kept)?;
        Ok(known)
    }

    /// What is known of the radio of the site.
    fn radio(&self, index: usize) -> Result<Option<Arc<RadioSite>>> {
        let Some(places) = &self.set.places else { return Ok(None) };
        let listed = places::read(places, &self.set.folder, &self.runs[index].name)?;
        let mut site = places::site(&listed, places.beacons);
        let others = self.runs.iter().enumerate().filter(|(other, _)| *other != index);
        let logs: Vec<PathBuf> = others.flat_map(|(_, run)| run.logs.clone()).collect();
        let (list, file) = (&listed.places, &listed.file);
        for learn in &self.set.learn {
            site = match learn {
                Learnt::PathLoss => site.with_path_loss(&calibration::path_loss_of(&logs, list, file)?),
                Learnt::Fingerprint => {
                    site.with_fingerprints(calibration::fingerprints_of(&logs, list, file)?)
                }
            };
        }
        Ok(Some(Arc::new(site)))
    }
}

impl RecordedSet {
    /// The run to which this file is the truth, or the first log where there is no truth, with all its other files.
    fn run_of(&self, file: &Path) -> Option<SetRun> {
        let first = self.join.first().or(self.logs.first())?;
        let ending = self.truth.as_ref().unwrap_or(first);
        let stem = truth_beside::stem(file);
        let name = stem.strip_suffix(ending.as_str())?.strip_suffix('_')?;
        if !self.names.is_empty() && !self.names.iter().any(|pattern| fits(name, pattern)) {
            return None;
        }
        let beside = |ending: &String| csv_of(&self.folder, &format!("{name}_{ending}"));
        Some(SetRun {
            name: name.to_owned(),
            logs: self.logs.iter().map(beside).collect::<Option<_>>()?,
            join: self.join.iter().map(beside).collect::<Option<_>>()?,
            truth: self.truth.is_some().then(|| file.to_path_buf()),
        })
    }
}

/// A file of this name without its end, plain or gzip.
fn csv_of(folder: &Path, stem: &str) -> Option<PathBuf> {
    [".csv", ".csv.gz"].map(|end| folder.join(format!("{stem}{end}"))).into_iter().find(|file| file.is_file())
}

/// Whether a name is this one, or begins and ends as it does about its `*`.
fn fits(name: &str, pattern: &str) -> bool {
    match pattern.split_once('*') {
        None => name == pattern,
        Some((start, end)) => {
            name.len() >= start.len() + end.len() && name.starts_with(start) && name.ends_with(end)
        }
    }
}

/// First and last time of a log.
fn times(log: &Path) -> Result<[Time; 2]> {
    let mut ends: Option<[Time; 2]> = None;
    for observation in adit_observation::open(log)? {
        let time = observation?.time();
        ends = Some(ends.map_or([time; 2], |[first, last]| [first.min(time), last.max(time)]));
    }
    ends.with_context(|| format!("{}: nothing in it", log.display()))
}

/// The first true place, as somebody told it; what was told is no more to be found.
fn tell_first(observations: &mut Vec<Observation>, known: &mut Truth, sigma_m: f64) -> Result<()> {
    let Some((first, others)) = known.trajectory.poses().split_first() else { return Ok(()) };
    let fix = PositionFix::level(first.time, first.position_m.xy(), sigma_m, FixSource::Survey);
    let at = observations.partition_point(|observation| observation.time() <= first.time);
    observations.insert(at, Observation::Fix(fix));
    known.trajectory = Trajectory::new(others.to_vec())?;
    if let Some(moving) = known.moving.as_mut().filter(|moving| !moving.is_empty()) {
        moving.remove(0);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::fits;

    #[test]
    fn names_fit_patterns() {
        for (name, pattern, expected) in [
            ("lab_m1l", "lab_m*", true),
            ("lab_4hnm2", "lab_m*", false),
            ("short_walk", "*_walk", true),
            ("walk", "*_walk", false),
            ("aba", "ab*ba", false),
            ("walk1", "walk1", true),
            ("walk12", "walk1", false),
        ] {
            assert_eq!(fits(name, pattern), expected, "{name} {pattern}");
        }
    }
}
