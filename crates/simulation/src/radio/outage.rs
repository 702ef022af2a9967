//! What fails when: anchors and access points without power, for a time.

use super::keyed::Key;
use crate::error::SimulationError;
use adit_core::frames::Position;
use adit_core::nalgebra::Vector3;
use adit_mine::Mine;
use serde::{Deserialize, Serialize};

/// A failure from one time to another.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Outage {
    /// When it begins, s after the start.
    pub from_s: f64,
    /// When it is over, s after the start; never where it is missing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until_s: Option<f64>,
    /// What is dead.
    pub dead: Dead,
}

/// What an outage takes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Dead {
    /// One device, by its id in the mine's file.
    Device(String),
    /// All devices in a zone, by its id.
    Zone(String),
    /// All devices on a level, by its id.
    Level(String),
    /// A share of all devices, drawn once by the seed.
    Share(f64),
    /// Everything: the power is cut.
    Everything,
}

/// When one device is dead.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct DeadTimes(Vec<(f64, f64)>);

impl DeadTimes {
    /// Of the device with this id at this place.
    pub fn of(id: &str, place_m: &Vector3<f64>, mine: &Mine, outages: &[Outage], key: Key) -> Self {
        let place = Position::from_raw(*place_m);
        let hit = |(number, outage): (u64, &Outage)| {
            let dead = match &outage.dead {
                Dead::Device(device) => device == id,
                Dead::Zone(zone) => mine.zones_at(&place).any(|z| z.id == *zone),
                Dead::Level(level) => mine.level_at(place_m.z).is_some_and(|l| l.id == *level),
                Dead::Share(share) => {
                    let letters = id.bytes().fold(key.with(number), |key, byte| key.with(u64::from(byte)));
                    letters.draws().uniform() < *share
                }
                Dead::Everything => true,
            };
            dead.then(|| (outage.from_s, outage.until_s.unwrap_or(f64::INFINITY)))
        };
        Self((0..).zip(outages).filter_map(hit).collect())
    }

    /// Dead from the first instant of an outage to just before its last.
    pub fn dead_at(&self, time_s: f64) -> bool {
        self.0.iter().any(|(from, until)| (*from..*until).contains(&time_s))
    }
}

impl Dead {
    /// An id that nothing in the mine has, and whose it should be.
    fn unknown(&self, mine: &Mine) -> Option<(&str, &'static str)> {
        let plan = mine.plan();
        let (id, known, expected) = match self {
            Self::Device(id) => {
                let known = plan.anchors.iter().any(|a| a.id == *id)
                    || plan.access_points.iter().any(|a| a.id == *id)
                    || plan.rfid_portals.iter().any(|a| a.id == *id);
                (id, known, "the id of a device of the mine")
            }
            Self::Zone(id) => (id, plan.zones.iter().any(|z| z.id == *id), "the id of a zone of the mine"),
            Self::Level(id) => (id, plan.levels.iter().any(|l| l.id == *id), "the id of a level of the mine"),
            Self::Share(_) | Self::Everything => return None,
        };
        (!known).then_some((id.as_str(), expected))
    }
}

impl Outage {
    /// Times are in order and names are those of the mine.
    pub(crate) fn check(&self, mine: &Mine) -> Result<(), SimulationError> {
        let wrong = |name, found, expected| Err(SimulationError::Parameter { name, found, expected });
        if !self.from_s.is_finite() {
            return wrong("from_s", self.from_s, "a time in s");
        }
        match (self.until_s, &self.dead) {
            (Some(until), _) if until.is_nan() || until <= self.from_s => {
                wrong("until_s", until, "later than from_s")
            }
            (_, Dead::Share(share)) => super::spec::check_share("share", *share),
            (_, dead) => match dead.unknown(mine) {
                None => Ok(()),
                Some((id, expected)) => {
                    Err(SimulationError::Unknown { name: "dead", found: id.to_owned(), expected })
                }
            },
        }
    }
}
