//! The files of one simulated log: the log itself, its truth, what is known beside them.

use crate::interrupt;
use crate::output;
use crate::progress::Progress;
use crate::scenario_file::Run;
use adit_core::time::{Interval, Time};
use adit_core::trajectory::Pose;
use adit_observation::RangeSample;
use adit_observation::files::AtomicFile;
use adit_observation::mcap_log::{McapLogWriter, Packing};
use adit_observation::sidecar::{Sidecar, SidecarEdit};
use adit_observation::tum::TumWriter;
use adit_simulation::radio::{LinkClass, RangeTruth};
use adit_simulation::{Emission, MagneticTruth, TruthState};
use anyhow::{Context, Result};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Inertial samples between two looks at the bar and Ctrl-C.
const PULSE: u64 = 1024;

/// What a simulation left behind.
#[derive(Debug, Clone, Default)]
pub struct Simulated {
    /// The log.
    pub log: PathBuf,
    /// Pose of the sensor, at each inertial sample unless asked otherwise.
    pub truth: PathBuf,
    /// What is told beside the log, where there is something to tell.
    pub sidecar: Option<PathBuf>,
    /// Truth of the ranges, where there are any.
    pub ranges_truth: Option<PathBuf>,
    /// How many observations of each kind.
    pub counts: Counts,
    /// The largest magnetic disturbance met.
    pub worst: Disturbance,
    /// Length in time, s.
    pub duration_s: f64,
}

/// Observations in a log.
#[derive(Debug, Clone, Copy, Default)]
pub struct Counts {
    /// Inertial samples.
    pub inertial: u64,
    /// Magnetic samples.
    pub magnetic: u64,
    /// Air pressures.
    pub pressures: u64,
    /// Position fixes.
    pub fixes: u64,
    /// Signal strengths.
    pub signals: u64,
    /// Ranges.
    pub ranges: u64,
    /// Ranges past an obstacle.
    pub blocked: u64,
    /// Sightings at portals.
    pub sightings: u64,
}

impl Counts {
    /// Together with those of another log.
    #[must_use]
    pub fn and(self, other: &Self) -> Self {
        Self {
            inertial: self.inertial + other.inertial,
            magnetic: self.magnetic + other.magnetic,
            pressures: self.pressures + other.pressures,
            fixes: self.fixes + other.fixes,
            signals: self.signals + other.signals,
            ranges: self.ranges + other.ranges,
            blocked: self.blocked + other.blocked,
            sightings: self.sightings + other.sightings,
        }
    }
}

/// What steel and currents added to the Earth's field, and when.
#[derive(Debug, Clone, Copy, Default)]
pub struct Disturbance {
    /// Its length, µT.
    pub norm_ut: f64,
    /// When, s.
    pub time_s: f64,
}

impl Disturbance {
    /// The larger one.
    fn or(self, truth: &MagneticTruth) -> Self {
        let norm_ut = truth.disturbance_ut.norm();
        if norm_ut > self.norm_ut { Self { norm_ut, time_s: truth.time.seconds() } } else { self }
    }
}

/// Writes `log.mcap` and `truth.tum` of a run into a folder, sample by sample; where something is known beside the log
/// also `log.toml`, the sidecar that gives it, and where there are ranges `ranges_truth.csv`.
///
/// `truth_every`: shortest time between two poses of the truth. The bar moves by the inertial samples made.
pub fn write<I: Iterator<Item = Emission>>(
    run: Run<I>,
    folder: &Path,
    truth_every: Interval,
    progress: &Progress,
) -> Result<Simulated> {
    output::make_folder(folder)?;
    let Run { duration_s, sidecar, emissions } = run;
    let mut made = Simulated {
        log: folder.join("log.mcap"),
        truth: folder.join("truth.tum"),
        duration_s,
        ..Simulated::default()
    };
    let mut log = McapLogWriter::create(&made.log, Packing::Lz4)?;
    let mut truth = TumWriter::create(&made.truth)?;
    let mut links: Option<LinkWriter> = None;
    let mut next_truth = Time::ZERO;
    for emission in emissions {
        log.push(&emission.observation())?;
        let counts = &mut made.counts;
        match emission {
            Emission::Imu(_, TruthState { time, position_m, attitude, .. }) => {
                if time >= next_truth {
                    truth.push(&Pose { time, position_m, attitude })?;
                    next_truth = next_truth.max(time - truth_every) + truth_every;
                }
                counts.inertial += 1;
                if counts.inertial.is_multiple_of(PULSE) {
                    interrupt::check()?;
                    progress.more(PULSE);
                }
            }
            Emission::Magnetic(_, field) => {
                counts.magnetic += 1;
                made.worst = made.worst.or(&field);
            }
            Emission::Range(range, link) => {
                counts.ranges += 1;
                counts.blocked += u64::from(link.class != LinkClass::Los);
                let links = match &mut links {
                    Some(links) => links,
                    none => none.insert(LinkWriter::create(&folder.join("ranges_truth.csv"))?),
                };
                links.push(&range, &link)?;
            }
            Emission::Pressure(..) => counts.pressures += 1,
            Emission::Fix(..) => counts.fixes += 1,
            Emission::Signal(_) => counts.signals += 1,
            Emission::Sighting(_) => counts.sightings += 1,
        }
    }
    log.finish()?;
    truth.finish()?;
    made.ranges_truth = links.map(LinkWriter::finish).transpose()?;
    made.sidecar = sidecar.map(|sidecar| write_sidecar(&sidecar, &made.log)).transpose()?;
    Ok(made)
}

/// Writes the truth of ranges: row by row the ranges of the log, in its order.
struct LinkWriter {
    file: AtomicFile,
}

impl LinkWriter {
    fn create(path: &Path) -> Result<Self> {
        let mut file = AtomicFile::create(path)?;
        let head = "time_s,anchor_id,true_range_m,class,shortest_way_m,power_dBm,in_the_way,loss_dB";
        writeln!(file, "{head}").with_context(|| format!("{}: cannot write it", path.display()))?;
        Ok(Self { file })
    }

    fn push(&mut self, range: &RangeSample, truth: &RangeTruth) -> Result<()> {
        let class = match truth.class {
            LinkClass::Los => "los",
            LinkClass::Nlos => "nlos",
            LinkClass::Ndp => "ndp",
        };
        let RangeTruth { distance_m, way_m, power_dbm, loss_db, .. } = truth;
        let way = truth.in_the_way().name();
        let (time, anchor) = (range.time, &range.anchor);
        writeln!(
            self.file,
            "{time},{anchor},{distance_m:.4},{class},{way_m:.4},{power_dbm:.2},{way},{loss_db:.2}"
        )
        .with_context(|| format!("{}: cannot write it", self.file.target().display()))
    }

    fn finish(self) -> Result<PathBuf> {
        let path = self.file.target().to_path_buf();
        self.file.finish()?;
        Ok(path)
    }
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
    if let Some(location) = sidecar.mounting.location {
        edit.set_location(location);
    }
    if let Some(declination_deg) = sidecar.frame.magnetic_declination_deg {
        edit.set_declination_deg(declination_deg);
    }
    let head = "# What is known of the simulated site; `adit track` reads it with the log.\n";
    output::write_file(&path, &(head.to_owned() + &edit.text()?))?;
    Ok(path)
}
