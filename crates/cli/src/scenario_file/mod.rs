//! Scenarios as people write them: TOML with degrees, names of gaits and sensors, and one line a leg.
//!
//! ```toml
//! kind = "foot-walk"        # or tumble, roadway-walk, mine: a table [tumble], [roadway], [mine] in place of gait, heading_deg and legs
//! seed = 1
//! sensor = "adis16448"      # or another preset, or a table [sensors.NAME] of this file
//! gait = "walk"             # or slow, run, stairs, or a table [gaits.NAME] of this file
//! heading_deg = 90.0        # clockwise from north
//! legs = [
//!     { stand = { seconds = 5.0 } },
//!     { straight = { length_m = 20.0 } },
//!     { turn = { turn_deg = 180.0 } },
//! ]
//! [magnetic]                # without it the log has no magnetometer
//! sensor = "xsens-mti-g"
//! ```
//!
//! Whatever is wrong is told with its line, also what only the simulator can know.

mod compare;
mod magnetic;
mod mine;
mod place;
mod roadway;
mod tumble;

use crate::config;
use adit_observation::sidecar::{Location, Sidecar};
use adit_simulation::{
    Emission, FootWalk, FootWalkScenario, Gait, Generator, IdealImu, ImuErrorModel, Leg, MagneticWorld,
    MagnetometerModel, Motion, Tumble,
};
use anyhow::{Result, bail};
use compare::CompareEntry;
pub use compare::{Contender, Contest, RunEntry, Tuning};
use magnetic::Magnetic;
pub use mine::Everybody;
use mine::MineEntry;
pub use place::Source;
use roadway::RoadwayEntry;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use toml::Spanned;
use tumble::TumbleEntry;

/// A scenario and the text it was read from.
#[derive(Debug, Clone)]
pub struct Scenario {
    /// Seed of every random draw, unless the command line gives one.
    pub seed: u64,
    entries: Entries,
    source: Source,
}

/// A scenario file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entries {
    /// What is simulated.
    kind: Spanned<Kind>,
    #[serde(default)]
    seed: u64,
    /// Name of the sensor.
    sensor: Spanned<String>,
    /// Samples per second.
    rate_hz: Option<Spanned<f64>>,
    /// Latitude, for the rotation of the Earth.
    latitude_deg: Option<Spanned<f64>>,
    /// Name of the first gait.
    gait: Option<Spanned<String>>,
    /// First heading, clockwise from north.
    heading_deg: Option<Spanned<f64>>,
    /// Where the walk goes.
    legs: Option<Spanned<Vec<Spanned<LegEntry>>>>,
    /// How the tag is turned, where nobody walks.
    tumble: Option<Spanned<TumbleEntry>>,
    /// The level walk, its fixes and its start.
    roadway: Option<Spanned<RoadwayEntry>>,
    /// Everybody in a mine.
    mine: Option<Spanned<MineEntry>>,
    /// Field and magnetometer.
    magnetic: Option<Magnetic>,
    /// What `adit compare` runs.
    compare: Option<CompareEntry>,
    /// Sensors of this file.
    #[serde(default)]
    sensors: BTreeMap<String, Spanned<ImuErrorModel>>,
    /// Magnetometers of this file.
    #[serde(default)]
    magnetometers: BTreeMap<String, Spanned<MagnetometerModel>>,
    /// Gaits of this file.
    #[serde(default)]
    gaits: BTreeMap<String, Spanned<Gait>>,
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Kind {
    FootWalk,
    Tumble,
    RoadwayWalk,
    Mine,
}

/// A leg as people write it; [`Leg`] with degrees and names.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
enum LegEntry {
    Gait(Spanned<String>),
    Stand { seconds: f64 },
    Straight { length_m: f64 },
    Arc { radius_m: f64, turn_deg: f64 },
    Turn { turn_deg: f64 },
    Ramp { length_m: f64, slope_deg: f64 },
    Stairs { risers: u32, rise_m: f64, tread_m: f64 },
}

const DEFAULT_RATE_HZ: f64 = 200.0;

/// A name and what it stands for.
type Preset<T> = (&'static str, fn() -> T);

const SENSORS: [Preset<ImuErrorModel>; 7] = [
    ("ideal", ImuErrorModel::default),
    ("adis16448", ImuErrorModel::adis16448),
    ("adis16448-calibrated", ImuErrorModel::adis16448_calibrated),
    ("mpu6050", ImuErrorModel::mpu6050),
    ("mpu9250", ImuErrorModel::mpu9250),
    ("microstrain-gx5-25", ImuErrorModel::microstrain_gx5_25),
    ("xsens-mti-g", ImuErrorModel::xsens_mti_g),
];

const GAITS: [Preset<Gait>; 4] =
    [("walk", Gait::walk), ("slow", Gait::slow), ("run", Gait::run), ("stairs", Gait::stairs)];

/// A simulation about to run.
pub struct Run<I = Box<dyn Iterator<Item = Emission>>> {
    /// Length in time, s.
    pub duration_s: f64,
    /// What somebody would tell in a sidecar of this run, where there is something to tell.
    pub sidecar: Option<Sidecar>,
    /// Samples with their truth, in order of time.
    pub emissions: I,
}

impl Scenario {
    /// Reads and checks a scenario file.
    pub fn read(path: &Path) -> Result<Self> {
        Self::parse(path, &config::text(path)?)
    }

    /// The scenario of `adit demo`, which is in the binary.
    pub fn demo() -> Result<Self> {
        Self::parse(Path::new("scenarios/s2.toml"), include_str!("../../../../scenarios/s2.toml"))
    }

    /// Checks the text of a scenario; `path` is its name in errors.
    fn parse(path: &Path, text: &str) -> Result<Self> {
        let entries: Entries = config::parse(path, text)?;
        Ok(Self { seed: entries.seed, entries, source: Source::new(path, text) })
    }

    /// Starts the simulation; of everybody in a mine, that of the first.
    pub fn generate(&self, seed: u64) -> Result<Run> {
        match *self.entries.kind.get_ref() {
            Kind::FootWalk => {
                let scenario = self.foot_walk()?;
                let refused = |error| self.source.refused(&self.entries.kind.span(), &error);
                let walk = scenario.walk(seed).map_err(refused)?;
                let magnetometer = self.magnetometer(&walk, Some(&walk))?;
                self.run(walk, magnetometer, Some(Location::Foot), seed)
            }
            Kind::Tumble => {
                let tumble = self.tumble()?;
                let magnetometer = self.magnetometer(&tumble, None)?;
                self.run(tumble, magnetometer, None, seed)
            }
            Kind::RoadwayWalk => self.roadway_walk(seed),
            Kind::Mine => self.generate_person(seed, 0),
        }
    }

    /// Makes the log of one person of `kind = "mine"`, by number from 0; of the other kinds of the only one there is.
    pub fn generate_person(&self, seed: u64, person: usize) -> Result<Run> {
        if self.has_everybody() {
            let Run { duration_s, sidecar, emissions } = self.everybody(seed)?.person(person)?;
            return Ok(Run { duration_s, sidecar, emissions: Box::new(emissions) });
        }
        if person > 0 {
            bail!("there is no person {} in this scenario: it has one", person + 1);
        }
        self.generate(seed)
    }

    /// Puts the sensors on a motion.
    fn run<M: Motion + 'static>(
        &self,
        motion: M,
        magnetometer: Option<(MagneticWorld, MagnetometerModel)>,
        location: Option<Location>,
        seed: u64,
    ) -> Result<Run> {
        let (errors, span) = self.sensor()?;
        let refused = |error| self.source.refused(&span, &error);
        let duration_s = motion.duration_s();
        let mut sidecar = magnetometer.as_ref().map(|(world, _)| declination(world)).unwrap_or_default();
        sidecar.mounting.location = location;
        let sidecar = Some(sidecar).filter(|sidecar| *sidecar != Sidecar::default());
        let imu = Generator::new(motion, self.imu()?, self.rate_hz()?, &errors, seed).map_err(refused)?;
        let emissions: Box<dyn Iterator<Item = Emission>> = match magnetometer {
            Some((world, model)) => Box::new(imu.with_magnetometer(world, &model, seed).map_err(refused)?),
            None => Box::new(imu.map(|(sample, truth)| Emission::Imu(sample, truth))),
        };
        Ok(Run { duration_s, sidecar, emissions })
    }

    /// The errors of the sensor, and where they stand.
    fn sensor(&self) -> Result<(ImuErrorModel, Range<usize>)> {
        let Entries { sensor, sensors, .. } = &self.entries;
        let errors = named("sensor", sensor, sensors, &SENSORS, &self.source)?;
        let span = sensors.get(sensor.get_ref()).map_or_else(|| sensor.span(), Spanned::span);
        Ok((errors, span))
    }

    fn magnetometer(
        &self,
        motion: &impl Motion,
        walk: Option<&FootWalk>,
    ) -> Result<Option<(MagneticWorld, MagnetometerModel)>> {
        let Entries { magnetic, magnetometers, .. } = &self.entries;
        let Some(magnetic) = magnetic else { return Ok(None) };
        let model = magnetic.magnetometer(magnetometers, &self.source)?;
        Ok(Some((magnetic.world(motion, walk, &self.source)?, model)))
    }

    fn foot_walk(&self) -> Result<FootWalkScenario> {
        let Entries { gait, gaits, heading_deg, legs, .. } = &self.entries;
        self.only(&["gait", "heading_deg", "legs", "latitude_deg"])?;
        for own in gaits.values() {
            own.get_ref().check().map_err(|error| self.source.refused(&own.span(), &error))?;
        }
        let gait = self.gait(self.needed("gait", gait.as_ref())?)?;
        let heading_deg = self.needed("heading_deg", heading_deg.as_ref())?;
        let heading_deg = self.within("heading_deg", heading_deg, 3600.0, "-3600 to 3600 degrees")?;
        let legs = self.needed("legs", legs.as_ref())?.get_ref();
        let legs = legs.iter().map(|leg| self.leg(leg)).collect::<Result<_>>()?;
        let mut walk = FootWalkScenario::new(gait, heading_deg.to_radians(), legs);
        (walk.rate_hz, walk.imu) = (self.rate_hz()?, self.imu()?);
        Ok(walk)
    }

    fn tumble(&self) -> Result<Tumble> {
        self.only(&["tumble", "latitude_deg"])?;
        let entry = self.needed("tumble", self.entries.tumble.as_ref())?;
        let tumble = entry.get_ref().tumble();
        tumble.check().map_err(|error| self.source.refused(&entry.span(), &error))?;
        Ok(tumble)
    }

    fn rate_hz(&self) -> Result<f64> {
        let Some(entry) = &self.entries.rate_hz else { return Ok(DEFAULT_RATE_HZ) };
        let found = *entry.get_ref();
        if (10.0..=10_000.0).contains(&found) {
            return Ok(found);
        }
        Err(self.source.error(&entry.span(), &format!("rate_hz is {found}, expected 10 to 10000 Hz")))
    }

    fn imu(&self) -> Result<IdealImu> {
        let imu = IdealImu::default();
        let Some(latitude_deg) = &self.entries.latitude_deg else { return Ok(imu) };
        let latitude_deg = self.within("latitude_deg", latitude_deg, 90.0, "-90 to 90 degrees")?;
        Ok(IdealImu { latitude_rad: Some(latitude_deg.to_radians()), ..imu })
    }

    /// A number of at most this size.
    fn within(&self, name: &str, entry: &Spanned<f64>, largest: f64, expected: &str) -> Result<f64> {
        let found = *entry.get_ref();
        if found.abs() <= largest {
            return Ok(found);
        }
        Err(self.source.error(&entry.span(), &format!("{name} is {found}, expected {expected}")))
    }

    /// What this kind of scenario cannot do without.
    fn needed<'a, T>(&self, name: &str, entry: Option<&'a Spanned<T>>) -> Result<&'a Spanned<T>> {
        entry.ok_or_else(|| {
            let kind = self.entries.kind.get_ref().name();
            self.source.error(&self.entries.kind.span(), &format!("kind = \"{kind}\" needs `{name}`: add it"))
        })
    }

    /// Of what belongs to one kind of scenario or another, there is nothing but this.
    fn only(&self, used: &[&str]) -> Result<()> {
        fn place<T>(entry: Option<&Spanned<T>>) -> Option<Range<usize>> {
            entry.map(Spanned::span)
        }
        let entries = &self.entries;
        let given = [
            ("gait", place(entries.gait.as_ref())),
            ("heading_deg", place(entries.heading_deg.as_ref())),
            ("legs", place(entries.legs.as_ref())),
            ("latitude_deg", place(entries.latitude_deg.as_ref())),
            ("tumble", place(entries.tumble.as_ref())),
            ("roadway", place(entries.roadway.as_ref())),
            ("mine", place(entries.mine.as_ref())),
        ];
        let strange =
            given.into_iter().find_map(|(name, span)| Some((name, span?)).filter(|_| !used.contains(&name)));
        let Some((name, span)) = strange else { return Ok(()) };
        let kind = entries.kind.get_ref().name();
        Err(self.source.error(&span, &format!("`{name}` has no use in kind = \"{kind}\": remove it")))
    }

    fn gait(&self, name: &Spanned<String>) -> Result<Gait> {
        named("gait", name, &self.entries.gaits, &GAITS, &self.source)
    }

    fn leg(&self, entry: &Spanned<LegEntry>) -> Result<Leg> {
        let leg = match *entry.get_ref() {
            LegEntry::Gait(ref name) => Leg::Gait(self.gait(name)?),
            LegEntry::Stand { seconds } => Leg::Stand { seconds },
            LegEntry::Straight { length_m } => Leg::Straight { length_m },
            LegEntry::Arc { radius_m, turn_deg } => Leg::Arc { radius_m, turn_rad: turn_deg.to_radians() },
            LegEntry::Turn { turn_deg } => Leg::Turn { turn_rad: turn_deg.to_radians() },
            LegEntry::Ramp { length_m, slope_deg } => {
                Leg::Ramp { length_m, slope_rad: slope_deg.to_radians() }
            }
            LegEntry::Stairs { risers, rise_m, tread_m } => Leg::Stairs { risers, rise_m, tread_m },
        };
        leg.check().map_err(|error| self.source.refused(&entry.span(), &error))?;
        Ok(leg)
    }
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::FootWalk => "foot-walk",
            Self::Tumble => "tumble",
            Self::RoadwayWalk => "roadway-walk",
            Self::Mine => "mine",
        }
    }
}

/// A sidecar that gives the declination of the site.
fn declination(world: &MagneticWorld) -> Sidecar {
    let mut sidecar = Sidecar::default();
    sidecar.frame.magnetic_declination_deg = Some(world.earth.declination_rad.to_degrees());
    sidecar
}

/// Looks a name up, in the file first.
fn named<T: Copy>(
    what: &str,
    name: &Spanned<String>,
    own: &BTreeMap<String, Spanned<T>>,
    known: &[Preset<T>],
    source: &Source,
) -> Result<T> {
    let wanted = name.get_ref();
    let preset = || known.iter().find(|(known, _)| known == wanted).map(|(_, make)| make());
    own.get(wanted).map(|entry| *entry.get_ref()).or_else(preset).ok_or_else(|| {
        let names = own.keys().map(String::as_str).chain(known.iter().map(|(name, _)| *name));
        let names = names.collect::<Vec<_>>().join(", ");
        source.error(&name.span(), &format!("unknown {what} \"{wanted}\", expected {names}"))
    })
}

#[cfg(test)]
mod tests;
