//! Scenarios as people write them: TOML with degrees, names of gaits and sensors, and one line a leg.
//!
//! ```toml
//! kind = "foot-walk"
//! seed = 1
//! sensor = "adis16448"      # or adis16448-calibrated, ideal, mpu6050, microstrain-gx5-25, or a table [sensors.NAME] of this file
//! gait = "walk"             # or slow, run, stairs, or a table [gaits.NAME] of this file
//! heading_deg = 90.0        # clockwise from north
//! legs = [
//!     { stand = { seconds = 5.0 } },
//!     { straight = { length_m = 20.0 } },
//!     { turn = { turn_deg = 180.0 } },
//! ]
//! ```

use crate::config;
use adit_simulation::{FootWalkScenario, Gait, Generator, IdealImu, ImuErrorModel, Leg, generate};
use anyhow::{Context, Result, anyhow};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A scenario file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// What is simulated.
    kind: Kind,
    /// Seed of every random draw, unless the command line gives one.
    #[serde(default)]
    pub seed: u64,
    /// Name of the sensor.
    sensor: String,
    /// Name of the first gait.
    gait: String,
    /// First heading, clockwise from north.
    heading_deg: f64,
    /// Samples per second.
    #[serde(default = "default_rate_hz")]
    rate_hz: f64,
    /// Latitude, for the rotation of the Earth.
    #[serde(default)]
    latitude_deg: Option<f64>,
    /// Where the walk goes.
    legs: Vec<LegEntry>,
    /// Sensors of this file.
    #[serde(default)]
    sensors: BTreeMap<String, ImuErrorModel>,
    /// Gaits of this file.
    #[serde(default)]
    gaits: BTreeMap<String, Gait>,
    #[serde(skip)]
    file: PathBuf,
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Kind {
    FootWalk,
}

/// A leg as people write it; [`Leg`] with degrees and names.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
enum LegEntry {
    Gait(String),
    Stand { seconds: f64 },
    Straight { length_m: f64 },
    Arc { radius_m: f64, turn_deg: f64 },
    Turn { turn_deg: f64 },
    Ramp { length_m: f64, slope_deg: f64 },
    Stairs { risers: u32, rise_m: f64, tread_m: f64 },
}

const fn default_rate_hz() -> f64 {
    200.0
}

/// A name and what it stands for.
type Preset<T> = (&'static str, fn() -> T);

const SENSORS: [Preset<ImuErrorModel>; 5] = [
    ("ideal", ImuErrorModel::default),
    ("adis16448", ImuErrorModel::adis16448),
    ("adis16448-calibrated", ImuErrorModel::adis16448_calibrated),
    ("mpu6050", ImuErrorModel::mpu6050),
    ("microstrain-gx5-25", ImuErrorModel::microstrain_gx5_25),
];

const GAITS: [Preset<Gait>; 4] =
    [("walk", Gait::walk), ("slow", Gait::slow), ("run", Gait::run), ("stairs", Gait::stairs)];

impl Scenario {
    /// Reads and checks a scenario file.
    pub fn read(path: &Path) -> Result<Self> {
        Ok(Self { file: path.to_path_buf(), ..config::read(path)? })
    }

    /// The scenario of `adit demo`, which is in the binary.
    pub fn demo() -> Result<Self> {
        let path = Path::new("scenarios/s2.toml");
        let text = include_str!("../../../scenarios/s2.toml");
        Ok(Self { file: path.to_path_buf(), ..config::parse(path, text)? })
    }

    /// Starts the simulation.
    pub fn generate(&self, seed: u64) -> Result<Generator> {
        let errors = named("sensor", &self.sensor, &self.sensors, &SENSORS);
        let run = || generate(&self.foot_walk()?, &errors?, seed).map_err(anyhow::Error::from);
        run().with_context(|| self.file.display().to_string())
    }

    fn foot_walk(&self) -> Result<FootWalkScenario> {
        let gait = named("gait", &self.gait, &self.gaits, &GAITS)?;
        let legs = self.legs.iter().map(|leg| self.leg(leg)).collect::<Result<_>>()?;
        let mut walk = FootWalkScenario::new(gait, self.heading_deg.to_radians(), legs);
        walk.rate_hz = self.rate_hz;
        if let Some(latitude_deg) = self.latitude_deg {
            walk.imu = IdealImu { latitude_rad: Some(latitude_deg.to_radians()), ..walk.imu };
        }
        Ok(walk)
    }

    fn leg(&self, entry: &LegEntry) -> Result<Leg> {
        Ok(match *entry {
            LegEntry::Gait(ref name) => Leg::Gait(named("gait", name, &self.gaits, &GAITS)?),
            LegEntry::Stand { seconds } => Leg::Stand { seconds },
            LegEntry::Straight { length_m } => Leg::Straight { length_m },
            LegEntry::Arc { radius_m, turn_deg } => Leg::Arc { radius_m, turn_rad: turn_deg.to_radians() },
            LegEntry::Turn { turn_deg } => Leg::Turn { turn_rad: turn_deg.to_radians() },
            LegEntry::Ramp { length_m, slope_deg } => {
                Leg::Ramp { length_m, slope_rad: slope_deg.to_radians() }
            }
            LegEntry::Stairs { risers, rise_m, tread_m } => Leg::Stairs { risers, rise_m, tread_m },
        })
    }
}

/// Looks a name up, in the file first.
fn named<T: Copy>(what: &str, name: &str, own: &BTreeMap<String, T>, known: &[Preset<T>]) -> Result<T> {
    let preset = || known.iter().find(|(known, _)| *known == name).map(|(_, make)| make());
    own.get(name).copied().or_else(preset).ok_or_else(|| {
        let names = own.keys().map(String::as_str).chain(known.iter().map(|(name, _)| *name));
        anyhow!("unknown {what} \"{name}\", expected {}", names.collect::<Vec<_>>().join(", "))
    })
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;

    fn parse(text: &str) -> Result<Scenario> {
        config::parse(Path::new("walk.toml"), text)
    }

    const SHORT: &str = "kind = \"foot-walk\"\nsensor = \"ideal\"\ngait = \"walk\"\nheading_deg = 0.0\n";

    #[test]
    fn the_scenario_that_ships_is_the_demo_walk() {
        let ours = Scenario::demo().unwrap().foot_walk().unwrap();
        let theirs = FootWalkScenario::demo_walk();
        assert_eq!(ours.plan.gait, theirs.plan.gait);
        assert_eq!(format!("{:.9?}", ours.plan.legs), format!("{:.9?}", theirs.plan.legs));
        assert!((ours.plan.heading_rad - theirs.plan.heading_rad).abs() < 1e-12);
        assert_eq!((ours.foot, ours.imu, ours.rate_hz), (theirs.foot, theirs.imu, theirs.rate_hz));
    }

    #[test]
    fn a_file_may_bring_its_own_gaits_and_sensors() {
        let text = format!(
            "{SHORT}legs = [{{ stand = {{ seconds = 1.0 }} }}]\n[sensors.ideal]\nstamp_jitter_s = 0.001\n"
        );
        let scenario = parse(&text).unwrap();
        let errors = named("sensor", "ideal", &scenario.sensors, &SENSORS).unwrap();
        assert_eq!(errors, ImuErrorModel { stamp_jitter_s: 0.001, ..ImuErrorModel::default() });
        assert_eq!(scenario.generate(1).unwrap().count(), 200);
    }

    #[test]
    fn errors_name_the_file_and_what_is_known() {
        let unknown = format!("{SHORT}legs = [{{ gait = \"moonwalk\" }}]\n");
        let error = format!("{:#}", parse(&unknown).unwrap().generate(1).unwrap_err());
        assert!(error.contains("unknown gait \"moonwalk\", expected walk, slow, run, stairs"), "{error}");
        let error = parse(&format!("{SHORT}legs = [{{ hop = {{ }} }}]\n")).unwrap_err().to_string();
        assert!(error.starts_with("walk.toml:5: unknown variant `hop`"), "{error}");
        let error = parse(&SHORT.replace("foot-walk", "flight")).unwrap_err().to_string();
        assert!(error.starts_with("walk.toml:1: unknown variant `flight`"), "{error}");
    }
}
