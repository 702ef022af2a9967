//! What a log is of, told from its beginning: where a tag is worn and what it hears decide how it is carried.

use super::carrier::CarrierKind;
use super::params::FusedParams;
use crate::methods::Worn;
use adit_core::time::{Interval, Time};
use adit_observation::Observation;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// A declared tag is looked at for so long: is there a magnetometer?
const DECLARED: Interval = Interval::from_nanos(500_000_000);
/// One of which nothing is declared, so long at least.
const LOOK: Interval = Interval::from_nanos(10_000_000_000);
/// Observations kept meanwhile; with more the verdict falls.
const MOST: usize = 20_000;
/// Below this rate steps cannot be told, 1/s.
const LEAST_RATE: f64 = 25.0;
/// A swinging foot turns faster than this, rad/s; nothing above the knee of a walker does for long.
const SWING_RAD_S: f64 = 4.5;
/// Share of the samples that move, of which a swinging foot turns so fast.
const SWING_SHARE: f64 = 0.1;
/// Faster than this counts as motion, rad/s.
const MOTION_RAD_S: f64 = 1.0;
/// Time of motion that is enough to judge, s.
const MOTION_S: f64 = 4.0;

/// How a tag is carried.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Process {
    /// Dead reckoning, held by all else.
    Carried(CarrierKind),
    /// Strapdown between fixes.
    Strapdown,
    /// Ranges alone.
    Ranges,
    /// Signal strengths alone.
    Signals,
    /// Attitude alone.
    Attitude,
}

/// The beginning of a log.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Evidence {
    /// All of it.
    pub kept: Vec<Observation>,
    first: Option<Time>,
    latest: Option<Time>,
    inertial: u32,
    moving: u32,
    swinging: u32,
    magnetic: bool,
    ranges: bool,
    signals: bool,
}

impl Evidence {
    /// Takes an observation; gives the verdict once there is one.
    pub fn observe(&mut self, observation: &Observation, params: &FusedParams) -> Option<Process> {
        self.kept.push(observation.clone());
        let time = observation.time();
        if self.first.is_none() || observation.kind().is_wired() {
            self.first.get_or_insert(time);
            self.latest = self.latest.max(Some(time));
        }
        match observation {
            Observation::Imu(imu) => {
                self.inertial += 1;
                let rate = imu.angular_rate_rad_s.norm();
                self.moving += u32::from(rate > MOTION_RAD_S);
                self.swinging += u32::from(rate > SWING_RAD_S);
            }
            Observation::Acceleration(_) => self.inertial += 1,
            Observation::Magnetic(_) => self.magnetic = true,
            Observation::Range(_) => self.ranges = true,
            Observation::Signal(_) => self.signals = true,
            Observation::Fix(_) | Observation::Pressure(_) | Observation::Sighting(_) => {}
        }
        let looked = self.latest? - self.first?;
        let enough = match params.worn {
            Some(_) => looked >= DECLARED,
            None => looked >= LOOK && (self.ranges || self.inertial == 0 || self.has_moved(looked)),
        };
        (enough || self.kept.len() >= MOST).then(|| self.verdict(params))
    }

    /// Nothing that a position or an attitude could be made of.
    pub fn is_empty(&self) -> bool {
        self.inertial == 0 && !self.ranges && !self.signals
    }

    fn has_moved(&self, looked: Interval) -> bool {
        let rate = f64::from(self.inertial) / looked.seconds().max(1e-3);
        f64::from(self.moving) >= MOTION_S * rate
    }

    /// What the log is of, as far as one can tell.
    pub fn verdict(&self, params: &FusedParams) -> Process {
        let looked_s = match (self.first, self.latest) {
            (Some(first), Some(latest)) => (latest - first).seconds(),
            _ => 0.0,
        };
        // Where there is a site its place tells what the compass errs.
        let alone = self.magnetic && params.compass && params.site.is_none();
        let foot = if alone { CarrierKind::Marg } else { CarrierKind::Foot };
        if self.inertial == 0 {
            return if self.ranges { Process::Ranges } else { Process::Signals };
        }
        let slow = f64::from(self.inertial) < LEAST_RATE * looked_s;
        match params.worn {
            Some(Worn::Foot) => Process::Carried(foot),
            _ if slow && params.strapdown.start.is_some() && params.strapdown.site.is_some() => {
                Process::Strapdown
            }
            Some(Worn::Elsewhere) if !self.ranges => Process::Attitude,
            Some(Worn::Elsewhere) => Process::Ranges,
            None if self.ranges => Process::Ranges,
            None if self.swings() => Process::Carried(foot),
            Some(Worn::Body) | None => Process::Carried(CarrierKind::Steps),
        }
    }

    /// Whether this is a foot that swings and stands in turn.
    fn swings(&self) -> bool {
        f64::from(self.swinging) > SWING_SHARE * f64::from(self.moving) && self.swinging > 0
    }
}
