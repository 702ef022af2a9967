//! Surveys and walks, read into scans.

use crate::interrupt;
use crate::progress;
use crate::truth_beside;
use adit_core::nalgebra::{Vector2, Vector3};
use adit_core::time::Time;
use adit_estimation::radio::Reading;
use adit_observation::survey::{self, TransmitterPlace};
use adit_observation::{DeviceId, LogWarning, Observation, truth};
use adit_tuning::radio::{Site, SurveyedScan};
use anyhow::{Context, Result, bail, ensure};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Which kind of data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DataKind {
    /// Scans at spots.
    Surveys,
    /// Packets along walks.
    Walks,
}

/// Everything heard, of all files.
#[derive(Debug, Clone)]
pub struct RadioData {
    /// Which kind.
    pub kind: DataKind,
    /// Transmitters by number.
    pub transmitters: Vec<DeviceId>,
    /// The files.
    pub files: Vec<RadioFile>,
    /// What was odd.
    pub warnings: Vec<String>,
}

/// What one file holds.
#[derive(Debug, Clone)]
pub struct RadioFile {
    /// The file.
    pub path: PathBuf,
    /// Signal strengths.
    pub strengths: Vec<SurveyedScan>,
    /// Ranges of the same scans.
    pub ranges: Vec<SurveyedScan>,
    /// Of a walk: when each packet came.
    pub times: Vec<Time>,
}

impl RadioData {
    /// Reads files, or the logs of folders.
    pub fn read(paths: &[PathBuf]) -> Result<Self> {
        let mut data = Self {
            kind: DataKind::Surveys,
            transmitters: Vec::new(),
            files: Vec::new(),
            warnings: Vec::new(),
        };
        let mut kind = None;
        for path in expand(paths)? {
            interrupt::check()?;
            let this = if survey_file(&path)? { DataKind::Surveys } else { DataKind::Walks };
            let first = *kind.get_or_insert(this);
            ensure!(
                first == this,
                "{}: expected files of one kind: surveys (x_m, y_m, readings) or walks (time_s, …)",
                path.display()
            );
            data.kind = this;
            data.add(&path)?;
        }
        Ok(data)
    }

    /// Reads one test with the transmitters of another; those it alone has are added at the end.
    pub fn read_like(path: &Path, all: &Self) -> Result<Self> {
        let mut data = Self {
            kind: all.kind,
            transmitters: all.transmitters.clone(),
            files: Vec::new(),
            warnings: Vec::new(),
        };
        for path in expand(&[path.to_path_buf()])? {
            let kind = if survey_file(&path)? { DataKind::Surveys } else { DataKind::Walks };
            ensure!(kind == all.kind, "{}: expected the same kind of data as is fitted", path.display());
            data.add(&path)?;
        }
        Ok(data)
    }

    fn add(&mut self, path: &Path) -> Result<()> {
        let file = match self.kind {
            DataKind::Surveys => self.survey(path)?,
            DataKind::Walks => self.walk(path)?,
        };
        self.files.push(file);
        Ok(())
    }

    fn odd(&mut self, warnings: &[LogWarning]) {
        self.warnings.extend(warnings.iter().map(LogWarning::to_string));
    }

    fn number(&mut self, id: &DeviceId) -> usize {
        self.transmitters.iter().position(|known| known == id).unwrap_or_else(|| {
            self.transmitters.push(id.clone());
            self.transmitters.len() - 1
        })
    }

    fn survey(&mut self, path: &Path) -> Result<RadioFile> {
        let survey = survey::read(path)?;
        self.odd(&survey.warnings);
        let numbers: Vec<usize> = survey.transmitters.iter().map(|id| self.number(id)).collect();
        let mut file = RadioFile::new(path);
        for scan in &survey.scans {
            let readings = |values: &[Option<f64>]| {
                let known = values
                    .iter()
                    .zip(&numbers)
                    .filter_map(|(value, number)| value.map(|value| Reading { transmitter: *number, value }));
                let [x, y] = scan.position_m;
                let position_m = Vector3::new(x, y, 0.0);
                SurveyedScan { position_m, floor: scan.floor, readings: known.collect(), whole: true }
            };
            file.strengths.push(readings(&scan.rssi_dbm));
            file.ranges.push(readings(&scan.range_m));
        }
        if file.ranges.iter().all(|scan| scan.readings.is_empty()) {
            file.ranges.clear();
        }
        Ok(file)
    }

    fn walk(&mut self, path: &Path) -> Result<RadioFile> {
        let mut log = adit_observation::open(path)?;
        let truth_path = truth_beside::of(path).with_context(|| {
            format!(
                "{}: no truth beside it: expected {}",
                path.display(),
                truth_beside::names(path).join(" or ")
            )
        })?;
        let truth = truth::read(&truth_path)?;
        self.odd(&truth.warnings);
        ensure!(truth.has_position, "{}: has no positions", truth_path.display());
        let mut file = RadioFile::new(path);
        for observation in log.by_ref() {
            let Observation::Signal(signal) = observation? else { continue };
            // Before the first and after the last true position nothing is judged or learnt.
            let Some(pose) = truth.trajectory.at(signal.time) else { continue };
            let reading = Reading { transmitter: self.number(&signal.transmitter), value: signal.rssi_dbm };
            file.times.push(signal.time);
            let (position_m, readings) = (pose.position_m, vec![reading]);
            file.strengths.push(SurveyedScan { position_m, floor: 0, readings, whole: false });
        }
        self.odd(log.warnings());
        ensure!(
            !file.strengths.is_empty(),
            "{}: no signal strength within the time of {}",
            path.display(),
            truth_path.display()
        );
        Ok(file)
    }

    /// Scans of signal strengths of all files.
    pub fn strengths(&self) -> Vec<SurveyedScan> {
        self.files.iter().flat_map(|file| file.strengths.iter().cloned()).collect()
    }

    /// Scans of ranges of all files; empty where there are none.
    pub fn ranges(&self) -> Vec<SurveyedScan> {
        self.files.iter().flat_map(|file| file.ranges.iter().cloned()).collect()
    }

    /// Every spot with its floor, once.
    pub fn spots(&self) -> Vec<(Vector2<f64>, i32)> {
        let mut known = std::collections::HashSet::new();
        let all = self.files.iter().flat_map(|file| &file.strengths);
        let new = all.filter(|scan| known.insert(spot_key(scan)));
        new.map(|scan| (scan.position_m.xy(), scan.floor)).collect()
    }

    /// Mean height of the tag, m.
    pub fn height_m(&self) -> f64 {
        let all = || self.files.iter().flat_map(|file| &file.strengths);
        all().map(|scan| scan.position_m.z).sum::<f64>() / all().count().max(1) as f64
    }

    /// Short name for reports.
    pub fn name(&self) -> String {
        self.files.iter().map(|file| truth_beside::stem(&file.path)).collect::<Vec<_>>().join(", ")
    }

    /// This data without a share of its spots, and these.
    pub fn split_by_spot(&self, share: f64, seed: u64) -> Result<(Self, Self)> {
        ensure!(
            self.kind == DataKind::Surveys,
            "a share of spots can be left out of surveys only: use --leave-out each for walks"
        );
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut lots: BTreeMap<[i64; 3], u64> = BTreeMap::new();
        for scan in self.files.iter().flat_map(|file| &file.strengths) {
            lots.entry(spot_key(scan)).or_insert(0);
        }
        for lot in lots.values_mut() {
            *lot = random.next_u64();
        }
        let mut drawn: Vec<([i64; 3], u64)> = lots.into_iter().collect();
        drawn.sort_by_key(|(_, lot)| *lot);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of the length")]
        let count = (share * drawn.len() as f64).round() as usize;
        ensure!(
            count > 0 && count < drawn.len(),
            "{} spots: a share of {share} of them leaves nothing to fit or nothing to judge",
            drawn.len()
        );
        let left_out: std::collections::HashSet<[i64; 3]> =
            drawn[..count].iter().map(|(key, _)| *key).collect();
        let keep = |out: bool| {
            let mut part = self.clone();
            for file in &mut part.files {
                file.strengths.retain(|scan| left_out.contains(&spot_key(scan)) == out);
                file.ranges.retain(|scan| left_out.contains(&spot_key(scan)) == out);
            }
            part
        };
        Ok((keep(false), keep(true)))
    }

    /// Each file, with the others to fit.
    pub fn split_by_file(&self) -> Result<Vec<(String, Self, Self)>> {
        ensure!(self.files.len() > 1, "one file: nothing is left to fit when it is left out");
        let one = |index: usize| {
            let (mut train, mut test) = (self.clone(), self.clone());
            train.files.remove(index);
            test.files = vec![self.files[index].clone()];
            (test.name(), train, test)
        };
        Ok((0..self.files.len()).map(one).collect())
    }
}

impl RadioFile {
    fn new(path: &Path) -> Self {
        Self { path: path.to_path_buf(), strengths: Vec::new(), ranges: Vec::new(), times: Vec::new() }
    }
}

/// Where the transmitters are: a list, or the access points and anchors of a mine.
pub fn places(path: &Path) -> Result<Vec<TransmitterPlace>> {
    let csv = path.to_string_lossy();
    if csv.ends_with(".csv") || csv.ends_with(".csv.gz") {
        return Ok(survey::read_transmitters(path)?);
    }
    let (mine, _) = adit_mine::file::open(path)?;
    let named = mine.plan().access_points.iter().flat_map(|ap| {
        [Some(&ap.id), ap.mac.as_ref()].into_iter().flatten().map(|name| (name.clone(), ap.position_m))
    });
    let anchors = mine.plan().anchors.iter().map(|anchor| (anchor.id.clone(), anchor.position_m));
    let mut list = Vec::new();
    for (name, position) in named.chain(anchors) {
        let Some(id) = DeviceId::new(&name) else { continue };
        list.push(TransmitterPlace { id, position_m: (*position.raw()).into(), floor: None });
    }
    ensure!(!list.is_empty(), "{}: has no access points", path.display());
    Ok(list)
}

/// The place of each transmitter of the data; an error where none is known.
pub fn sites(data: &RadioData, places: &[TransmitterPlace], from: &Path) -> Result<Vec<Option<Site>>> {
    let of = |id: &DeviceId| {
        let known = places.iter().find(|place| place.id == *id)?;
        Some(Site { position_m: known.position_m.into(), floor: known.floor })
    };
    let sites: Vec<Option<Site>> = data.transmitters.iter().map(of).collect();
    let unknown: Vec<&str> = data
        .transmitters
        .iter()
        .zip(&sites)
        .filter(|(_, site)| site.is_none())
        .map(|(id, _)| id.as_str())
        .collect();
    ensure!(
        unknown.len() < sites.len(),
        "{}: has none of the transmitters that the data hears ({})",
        from.display(),
        unknown.join(", ")
    );
    if !unknown.is_empty() {
        progress::warn(&[format!("{}: no place for {}", from.display(), unknown.join(", "))]);
    }
    Ok(sites)
}

fn spot_key(scan: &SurveyedScan) -> [i64; 3] {
    // To the millimetre.
    #[expect(clippy::cast_possible_truncation, reason = "coordinates within 10,000 km")]
    let key = [(scan.position_m.x * 1e3).round() as i64, (scan.position_m.y * 1e3).round() as i64];
    [key[0], key[1], i64::from(scan.floor)]
}

fn survey_file(path: &Path) -> Result<bool> {
    let text = path.to_string_lossy();
    Ok((text.ends_with(".csv") || text.ends_with(".csv.gz")) && survey::is_survey(path)?)
}

/// Folders become the logs in them that have a truth, by name.
fn expand(paths: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for path in paths {
        if !path.is_dir() {
            files.push(path.clone());
            continue;
        }
        let entries =
            std::fs::read_dir(path).with_context(|| format!("{}: cannot read it", path.display()))?;
        let mut logs = Vec::new();
        for entry in entries {
            let file = entry.with_context(|| format!("{}: cannot read it", path.display()))?.path();
            let name = truth_beside::stem(&file);
            if name.ends_with("_rssi") && truth_beside::of(&file).is_some() {
                logs.push(file);
            }
        }
        logs.sort();
        if logs.is_empty() {
            bail!("{}: no NAME_rssi.csv with a NAME_truth.csv in this folder", path.display());
        }
        files.append(&mut logs);
    }
    Ok(files)
}
