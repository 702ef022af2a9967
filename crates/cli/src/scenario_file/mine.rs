//! The table `[mine]` of `kind = "mine"`: everybody in a mine, with their tags, the radio around them and what fails.

use super::roadway::told;
use super::{Kind, Preset, Run, Scenario};
use adit_estimation::radio::RadioSite;
use adit_mine::Mine;
use adit_observation::sidecar::{Location, Sidecar};
use adit_simulation::people::{Belt, PopulationSpec};
use adit_simulation::pressure::{AirSpec, BarometerModel};
use adit_simulation::radio::delivery::{ClockSpec, LinkSpec};
use adit_simulation::radio::{Outage, RadioSpec};
use adit_simulation::workforce::{Mount, Outfit, RadioRates, TagStream, Workforce, WorkforceSpec};
use adit_simulation::{Foot, IdealImu, ImuErrors, SimulationError, StartErrors};
use anyhow::{Context, Result};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use toml::Spanned;

const BAROMETERS: [Preset<BarometerModel>; 3] = [
    ("ideal", BarometerModel::ideal),
    ("bmp280", BarometerModel::bmp280),
    ("bmp388", BarometerModel::bmp388),
];

/// The table.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MineEntry {
    /// The mine's file, from the folder of the scenario.
    file: Spanned<PathBuf>,
    /// Length of the simulation, s.
    duration_s: f64,
    /// Rate of the truth that is written, Hz; that of the IMU when absent.
    truth_hz: Option<f64>,
    /// When the conveyors run: from, until, s.
    #[serde(default)]
    conveyors_s: Vec<[f64; 2]>,
    /// Who and what moves.
    population: PopulationSpec,
    /// What everybody wears.
    #[serde(default)]
    tag: TagEntry,
    /// The air of the mine.
    #[serde(default)]
    air: AirSpec,
    /// The radio of the mine.
    #[serde(default)]
    radio: RadioSpec,
    /// What fails when.
    #[serde(default)]
    outages: Vec<Outage>,
    /// Clock, losses, delays; without it everything arrives at once.
    delivery: Option<DeliveryEntry>,
}

#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct TagEntry {
    mount: MountEntry,
    /// Name of the barometer.
    barometer: Option<Spanned<String>>,
    /// Its rate, Hz, in place of its own.
    barometer_hz: Option<Spanned<f64>>,
    /// When barometer and magnetometer say nothing: from, until, s.
    silent_s: Vec<[f64; 2]>,
    radio: RadioRates,
    /// How wrong the start is that the log's sidecar tells; nothing is told without it.
    start: Option<Spanned<StartEntry>>,
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct StartEntry {
    /// East and north each, σ, m.
    position_m: f64,
    /// About each axis, σ, deg.
    attitude_deg: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum MountEntry {
    #[default]
    BeltFront,
    BeltBack,
    BeltLeft,
    BeltRight,
    LeftFoot,
    RightFoot,
}

#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct DeliveryEntry {
    clock: ClockSpec,
    link: LinkSpec,
}

/// A mine with everybody in it, about to be simulated.
pub struct Everybody {
    /// The people.
    pub workforce: Arc<Workforce>,
    /// Rate of the truth to write, Hz.
    pub truth_hz: f64,
    sidecar: Sidecar,
    start: Option<StartErrors>,
}

impl Everybody {
    /// The log of one person, by number from 0.
    pub fn person(&self, number: usize) -> Result<Run<TagStream>> {
        let count = self.workforce.len();
        let stream = self.workforce.stream(number).with_context(|| {
            format!("there is no person {} in the mine, expected 1 to {count}", number + 1)
        })??;
        let duration_s = self.workforce.spec().duration_s;
        let mut sidecar = self.sidecar.clone();
        if let Some(errors) = &self.start {
            sidecar.start = self.workforce.told_start(number, errors).map(|start| told(&start, errors));
        }
        Ok(Run { duration_s, sidecar: Some(sidecar), emissions: stream })
    }
}

impl Scenario {
    /// Whether the scenario is about everybody in a mine.
    pub fn has_everybody(&self) -> bool {
        *self.entries.kind.get_ref() == Kind::Mine
    }

    /// What is known of the radio of the mine of `kind = "mine"`; `None` of the other kinds.
    pub fn radio_site(&self) -> Result<Option<Arc<RadioSite>>> {
        let entry = self.entries.mine.as_ref().filter(|_| self.has_everybody());
        let Some(entry) = entry else { return Ok(None) };
        let mine = self.mine(&entry.get_ref().file)?;
        Ok(Some(Arc::new(RadioSite::of_mine(&mine))))
    }

    /// Makes everybody in the mine of `kind = "mine"`.
    pub fn everybody(&self, seed: u64) -> Result<Everybody> {
        let entries = &self.entries;
        self.only(&["mine", "latitude_deg"])?;
        let spanned = self.needed("mine", entries.mine.as_ref())?;
        let entry = spanned.get_ref();
        let refused = |error| self.source.refused(&spanned.span(), &error);

        let mine = self.mine(&entry.file)?;
        let (imu, sensor) = self.sensor()?;
        ImuErrors::new(&imu, seed).map_err(|error| self.source.refused(&sensor, &error))?;
        let imu_hz = self.rate_hz()?;
        let truth_hz = entry.truth_hz.unwrap_or(imu_hz);
        if !(truth_hz > 0.0 && truth_hz <= imu_hz) {
            let expected = "above 0, at most rate_hz";
            return Err(refused(SimulationError::Parameter { name: "truth_hz", found: truth_hz, expected }));
        }
        let magnetic = match &entries.magnetic {
            None => None,
            Some(magnetic) => Some((
                magnetic.standing_world(&self.source)?,
                magnetic.magnetometer(&entries.magnetometers, &self.source)?,
            )),
        };
        let mut sidecar = magnetic.as_ref().map(|(world, _)| super::declination(world)).unwrap_or_default();
        sidecar.rate_hz = Some(imu_hz);
        sidecar.noise = Some(imu.specification());
        sidecar.mounting.location = Some(entry.tag.mount.location());

        let mut ideal: IdealImu = self.imu()?;
        // The Earth turns under every mine whose place on it is known.
        ideal.latitude_rad = ideal.latitude_rad.or_else(|| latitude_rad(&mine));
        let outfit = Outfit {
            mount: entry.tag.mount.mount(),
            ideal,
            imu,
            imu_hz,
            magnetic,
            barometer: self.barometer(&entry.tag)?,
            silent_s: entry.tag.silent_s.clone(),
            radio: entry.tag.radio,
        };
        let (clock, link) = match &entry.delivery {
            Some(delivery) => (delivery.clock, delivery.link.clone()),
            None => (ClockSpec::perfect(), LinkSpec::perfect()),
        };
        let spec = WorkforceSpec {
            duration_s: entry.duration_s,
            population: entry.population.clone(),
            outfit,
            air: entry.air.clone(),
            radio: entry.radio.clone(),
            outages: entry.outages.clone(),
            conveyors_s: entry.conveyors_s.clone(),
            clock,
            link,
        };
        let workforce = Workforce::new(mine, spec, seed).map_err(refused)?;
        if workforce.is_empty() {
            let what = "nobody is in the mine: give `people` or `persons` in [mine.population]";
            return Err(self.source.error(&spanned.span(), what));
        }
        // What only the log of a person can find wrong.
        workforce.stream(0).transpose().map_err(refused)?;
        let start = entry.tag.start.as_ref().map(|start| self.start_errors(start)).transpose()?;
        Ok(Everybody { workforce, truth_hz, sidecar, start })
    }

    fn start_errors(&self, entry: &Spanned<StartEntry>) -> Result<StartErrors> {
        let StartEntry { position_m, attitude_deg } = *entry.get_ref();
        let errors = StartErrors { position_m: [position_m; 2], attitude_rad: attitude_deg.to_radians() };
        errors.check().map_err(|error| self.source.refused(&entry.span(), &error))?;
        Ok(errors)
    }

    fn barometer(&self, tag: &TagEntry) -> Result<Option<BarometerModel>> {
        let Some(name) = &tag.barometer else { return Ok(None) };
        let mut model = super::named("barometer", name, &BTreeMap::new(), &BAROMETERS, &self.source)?;
        if let Some(rate_hz) = &tag.barometer_hz {
            model.rate_hz = *rate_hz.get_ref();
            model.check().map_err(|error| self.source.refused(&rate_hz.span(), &error))?;
        }
        Ok(Some(model))
    }

    fn mine(&self, file: &Spanned<PathBuf>) -> Result<Arc<Mine>> {
        let path = self.source.folder().join(file.get_ref());
        let here = || self.source.error(&file.span(), "the mine of this scenario cannot be used");
        let (mine, _) = adit_mine::file::open(&path).with_context(here)?;
        Ok(Arc::new(mine))
    }
}

/// Latitude of a mine: that of its first roadway.
fn latitude_rad(mine: &Mine) -> Option<f64> {
    let first = mine.plan().roadways.iter().flat_map(|roadway| &roadway.points_m).next()?;
    Some(mine.georeference()?.to_geodetic(first)?.latitude_rad)
}

impl MountEntry {
    fn location(self) -> Location {
        match self {
            Self::BeltFront | Self::BeltBack | Self::BeltLeft | Self::BeltRight => Location::Waist,
            Self::LeftFoot | Self::RightFoot => Location::Foot,
        }
    }

    fn mount(self) -> Mount {
        match self {
            Self::BeltFront => Mount::Belt(Belt::front()),
            Self::BeltBack => Mount::Belt(Belt::back()),
            Self::BeltLeft => Mount::Belt(Belt::left()),
            Self::BeltRight => Mount::Belt(Belt::right()),
            Self::LeftFoot => Mount::LeftFoot(Foot::instep()),
            Self::RightFoot => Mount::RightFoot(Foot::instep()),
        }
    }
}
