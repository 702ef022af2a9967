//! Ranges with their distances, of labelled sets and of logs.

use crate::interrupt;
use crate::progress;
use crate::truth_beside;
use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use adit_core::trajectory::Trajectory;
use adit_mine::plan::Anchor;
use adit_observation::csv_log::labelled::{self, LinkClass};
use adit_observation::csv_log::range_truth::{self, RangeTruth};
use adit_observation::{DeviceId, Observation, Radio, RangeSample, truth};
use adit_tuning::ranges::KnownRange;
use anyhow::{Context, Result, ensure};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Fewer logs than this alone become so many groups each, by time.
const FEW_LOGS: usize = 3;
const PARTS: usize = 5;

/// Where anchors are, and the tag on what the truth is of.
#[derive(Debug, Clone, Default)]
pub struct Places {
    anchors: Vec<Anchor>,
    lever_m: Vector3<f64>,
}

impl Places {
    /// From the mine.
    pub fn read(mine: Option<&Path>, lever_m: Option<[f64; 3]>) -> Result<Self> {
        let anchors = match mine {
            Some(path) => adit_mine::file::open(path)?.0.plan().anchors.clone(),
            None => Vec::new(),
        };
        Ok(Self { anchors, lever_m: lever_m.unwrap_or_default().into() })
    }
}

/// Ranges of one group after the other.
#[derive(Debug, Clone, Default)]
pub struct RangeData {
    /// Names of the groups.
    pub groups: Vec<String>,
    /// The ranges.
    pub ranges: Vec<KnownRange>,
    /// Ranges of which no distance is known.
    pub unknown: usize,
}

impl RangeData {
    /// Reads all of it.
    pub fn read(paths: &[PathBuf], places: &Places) -> Result<Self> {
        let mut data = Self::default();
        let mut logs = Vec::new();
        for path in paths {
            interrupt::check()?;
            let log = path.join("log.mcap");
            if log.is_file() {
                logs.push(log);
            } else if path.is_dir() || is_labelled(path)? {
                data.add_labelled(path)?;
            } else {
                logs.push(path.clone());
            }
        }
        let parts = if logs.len() < FEW_LOGS && data.groups.is_empty() { PARTS } else { 1 };
        for log in logs {
            interrupt::check()?;
            data.add_log(&log, places, parts)?;
        }
        ensure!(!data.ranges.is_empty(), "no range whose distance is known");
        if data.unknown > 0 {
            let (left, all) = (data.unknown, data.unknown + data.ranges.len());
            progress::warn(&[format!("{left} of {all} ranges have no known distance: left out")]);
        }
        Ok(data)
    }

    fn add_labelled(&mut self, path: &Path) -> Result<()> {
        let set = labelled::read(path)?;
        progress::warn(&set.warnings);
        let first = self.groups.len();
        let name = truth_beside::stem(path);
        self.groups.extend(set.groups.iter().map(|group| format!("{name} {group}")));
        for row in set.ranges {
            let (Some(range_m), Some(true_m)) = (row.range_m, row.true_range_m) else {
                self.unknown += 1;
                continue;
            };
            // A set that tells no anchors has one.
            let anchor = row.anchor.or_else(|| DeviceId::new("-")).context("a name")?;
            let mut reception = row.reception;
            reception.impulse_response = None;
            let range = RangeSample {
                time: Time::ZERO,
                anchor,
                tag: None,
                range_m,
                sigma_m: None,
                line_of_sight: None,
                in_the_way: None,
                radio: Radio::Uwb,
                reception: Some(Arc::new(reception)),
            };
            self.ranges.push(KnownRange { range, true_m, group: first + row.group, class: Some(row.class) });
        }
        Ok(())
    }

    fn add_log(&mut self, path: &Path, places: &Places, parts: usize) -> Result<()> {
        let truth = Truth::beside(path, places)?;
        let mut log = adit_observation::open(path)?;
        let (mut found, before) = (Vec::new(), self.unknown);
        for observation in log.by_ref() {
            let Observation::Range(mut range) = observation? else { continue };
            if !matches!(range.radio, Radio::Uwb | Radio::Unknown) {
                continue;
            }
            let Some((true_m, class)) = truth.of(&range, places) else {
                self.unknown += 1;
                continue;
            };
            if let Some(reception) = range.reception.as_mut() {
                // Hundreds of bytes that no correction asks for.
                Arc::make_mut(reception).impulse_response = None;
            }
            found.push(KnownRange { range, true_m, group: 0, class });
        }
        progress::warn(log.warnings());
        let (none, ranges) = (self.unknown - before, found.len());
        ensure!(ranges > 0, "{}: the distance of none of {none} ranges is known", path.display());
        let (first, name) = (self.groups.len(), truth_beside::stem(path));
        let part = |part: usize| if parts > 1 { format!("{name}, part {part}") } else { name.clone() };
        self.groups.extend((1..=parts).map(part));
        let all = found.into_iter().enumerate();
        self.ranges.extend(all.map(|(k, known)| KnownRange { group: first + k * parts / ranges, ..known }));
        Ok(())
    }
}

/// A table of labelled ranges has no time; a log has.
fn is_labelled(path: &Path) -> Result<bool> {
    let text = path.to_string_lossy();
    if !(text.ends_with(".csv") || text.ends_with(".csv.gz")) {
        return Ok(false);
    }
    Ok(labelled::is_labelled(path)?)
}

/// What tells the distances of a log.
enum Truth {
    Ranges(RangeTruth),
    Path(Box<truth::Truth>),
}

impl Truth {
    fn beside(log: &Path, places: &Places) -> Result<Self> {
        let stem = truth_beside::stem(log);
        let names = if truth_beside::is_simulated(log) {
            vec!["ranges_truth.csv".to_owned()]
        } else {
            [".csv", ".csv.gz"].map(|end| format!("{stem}_truth{end}")).to_vec()
        };
        let beside = names.iter().map(|name| log.with_file_name(name)).find(|file| file.is_file());
        if let Some(file) = beside
            && range_truth::is_range_truth(&file)?
        {
            return Ok(Self::Ranges(range_truth::read(file)?));
        }
        let of_path = truth_beside::of(log).with_context(|| {
            let expected = names.iter().cloned().chain(truth_beside::names(log)).collect::<Vec<_>>();
            format!("{}: no truth beside it: expected {}", log.display(), expected.join(" or "))
        })?;
        let truth = truth::read(&of_path)?;
        progress::warn(&truth.warnings);
        ensure!(truth.has_position, "{}: has no positions", of_path.display());
        ensure!(
            !places.anchors.is_empty(),
            "{}: tells positions only: where the anchors are (--mine) is needed too",
            of_path.display()
        );
        if !truth.has_height && places.lever_m.z == 0.0 {
            progress::warn(&[format!(
                "{}: has no heights: the tag is taken to be at 0 m (--lever 0,0,HEIGHT)",
                of_path.display()
            )]);
        }
        Ok(Self::Path(Box::new(truth)))
    }

    fn of(&self, range: &RangeSample, places: &Places) -> Option<(f64, Option<LinkClass>)> {
        match self {
            Self::Ranges(truth) => truth.of(range).map(|known| (known.distance_m, known.class)),
            Self::Path(truth) => {
                let anchor = places.anchors.iter().find(|anchor| anchor.id == range.anchor.as_str())?;
                let tag = antenna(&truth.trajectory, range.time, &places.lever_m)?;
                Some(((tag - anchor.position_m.raw()).norm(), None))
            }
        }
    }
}

fn antenna(trajectory: &Trajectory, time: Time, lever_m: &Vector3<f64>) -> Option<Vector3<f64>> {
    let pose = trajectory.at(time)?;
    Some(pose.position_m + pose.attitude * lever_m)
}
