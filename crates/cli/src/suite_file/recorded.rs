//! Recorded sets as a suite names them: which files are a run, what is known beside them, which part of the truth counts.

use crate::scenario_file::Source;
use adit_observation::sidecar::Sidecar;
use anyhow::Result;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use toml::Spanned;

/// A set as written. A run is a NAME for which all its files are there: `NAME_LOG.csv[.gz]` for every LOG, and `NAME_TRUTH.csv[.gz]`.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SetEntry {
    /// Folder below the folder of the recorded sets.
    folder: PathBuf,
    /// Endings of the files that are the log, merged by time: `imu`, `ranges`, `rssi` and so on.
    #[serde(default)]
    logs: Vec<String>,
    /// Endings of files of one sensor each (gyro, accelerometer, magnetometer), brought to the stamps of the first by straight lines.
    #[serde(default)]
    join: Vec<String>,
    /// Ending of the truth: `truth` when left out; `ranges_truth` reads the places of the tag that stand beside true ranges.
    truth: Option<Spanned<String>>,
    /// Of its rows those that have this in a column.
    truth_row: Option<RowChoice>,
    /// Nothing is known but that a run ends where it began.
    #[serde(default)]
    closed: bool,
    /// The runs, with one `*` at most; all when left out.
    #[serde(default)]
    names: Vec<Spanned<String>>,
    /// The truth counts while the log of this ending speaks.
    within: Option<Spanned<String>>,
    /// Nor does it in the first seconds of it.
    #[serde(default)]
    skip_s: f64,
    /// Where anchors, receivers or beacons are.
    places: Option<Places>,
    /// What is learnt of the signal strengths of the other runs, before a run is judged.
    #[serde(default)]
    learn: Vec<Learnt>,
    /// What a sidecar of every log would say.
    sidecar: Option<Sidecar>,
    /// The first true place is told as a position fix with this standard deviation, m, and does not count.
    first_fix_sigma_m: Option<Spanned<f64>>,
}

/// A list of places, as text: a column of names, `x_m`, `y_m`, perhaps `z_m` and `floor`.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Places {
    /// The file; `NAME_anchors.csv` of the run where this is none.
    pub file: Option<PathBuf>,
    /// Of its rows those that have this in a column.
    pub row: Option<RowChoice>,
    /// Height of all of them, m; over the floor where there are storeys.
    pub height_m: Option<f64>,
    /// From floor to floor, m, and the floor on which heights are zero.
    pub storeys: Option<Storeys>,
    /// What the list says that anchors add to their ranges is taken off them.
    #[serde(default = "yes")]
    pub offsets: bool,
    /// They are Bluetooth beacons.
    #[serde(default)]
    pub beacons: bool,
}

/// Rows that have a text in a column.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RowChoice {
    /// The column.
    pub column: String,
    /// The text.
    pub is: String,
}

/// Heights by floors.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Storeys {
    /// From one to the next, m.
    pub height_m: f64,
    /// Where heights are zero.
    pub ground: i32,
}

/// What is learnt of the other runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Learnt {
    /// As `adit calibrate pathloss`.
    PathLoss,
    /// As `adit calibrate fingerprint`.
    Fingerprint,
}

/// A set, checked.
#[derive(Debug, Clone)]
pub struct RecordedSet {
    /// Its name.
    pub name: String,
    /// The folder.
    pub folder: PathBuf,
    /// Endings of the logs.
    pub logs: Vec<String>,
    /// Endings of the logs of one sensor each.
    pub join: Vec<String>,
    /// Ending of the truth; none where a run ends where it began and nothing else is known.
    pub truth: Option<String>,
    /// Rows of it.
    pub truth_row: Option<RowChoice>,
    /// The runs, with one `*` at most; all where there are none.
    pub names: Vec<String>,
    /// The truth counts while this log speaks.
    pub within: Option<String>,
    /// But for its first seconds.
    pub skip_s: f64,
    /// Where transmitters are.
    pub places: Option<Places>,
    /// What is learnt of the other runs.
    pub learn: Vec<Learnt>,
    /// What a sidecar would say.
    pub sidecar: Option<Sidecar>,
    /// The first true place is told, m.
    pub first_fix_sigma_m: Option<f64>,
}

impl SetEntry {
    /// The set below a folder of sets.
    pub fn checked(&self, data: &Path, source: &Source) -> Result<RecordedSet> {
        if let (true, Some(truth)) = (self.closed, &self.truth) {
            let what = "`truth` has no use in a set with closed = true: remove one of the two";
            return Err(source.error(&truth.span(), what));
        }
        let logs = if self.logs.is_empty() && self.join.is_empty() {
            vec!["imu".to_owned()]
        } else {
            self.logs.clone()
        };
        if let Some(within) = self.within.as_ref().filter(|within| !logs.contains(within.get_ref())) {
            let what = format!("within is \"{}\", expected one of {}", within.get_ref(), logs.join(", "));
            return Err(source.error(&within.span(), &what));
        }
        if let Some(name) = self.names.iter().find(|name| name.get_ref().matches('*').count() > 1) {
            let what = format!("\"{}\": expected a name with one * at most", name.get_ref());
            return Err(source.error(&name.span(), &what));
        }
        let first_fix_sigma_m = self.first_fix_sigma_m.as_ref().map(|sigma_m| {
            let found = *sigma_m.get_ref();
            if found > 0.0 && found.is_finite() {
                return Ok(found);
            }
            let what = format!("first_fix_sigma_m is {found}, expected more than 0 m");
            Err(source.error(&sigma_m.span(), &what))
        });
        let truth =
            || self.truth.as_ref().map_or_else(|| "truth".to_owned(), |truth| truth.get_ref().clone());
        Ok(RecordedSet {
            name: self.folder.display().to_string(),
            folder: data.join(&self.folder),
            logs,
            join: self.join.clone(),
            truth: (!self.closed).then(truth),
            truth_row: self.truth_row.clone(),
            names: self.names.iter().map(|name| name.get_ref().clone()).collect(),
            within: self.within.as_ref().map(|within| within.get_ref().clone()),
            skip_s: self.skip_s,
            places: self.places.clone(),
            learn: self.learn.clone(),
            sidecar: self.sidecar.clone(),
            first_fix_sigma_m: first_fix_sigma_m.transpose()?,
        })
    }
}

fn yes() -> bool {
    true
}
