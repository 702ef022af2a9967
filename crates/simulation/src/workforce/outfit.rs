//! What a person wears: where the tag sits, its sensors and their rates.

use crate::error::{SimulationError, check_within};
use crate::gait::Foot;
use crate::ideal_imu::IdealImu;
use crate::imu_errors::ImuErrorModel;
use crate::magnetic::MagneticWorld;
use crate::magnetometer::MagnetometerModel;
use crate::motion::{Motion, MotionState};
use crate::people::{Belt, FootMotion, Person, WaistMotion};
use crate::pressure::BarometerModel;
use crate::radio::RangeDetail;
use serde::{Deserialize, Serialize};

/// Where a tag sits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Mount {
    /// On the belt.
    Belt(Belt),
    /// On the left foot.
    LeftFoot(Foot),
    /// On the right foot.
    RightFoot(Foot),
}

/// How often the tag uses its radios, Hz; 0 for never.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RadioRates {
    /// Scans for Wi-Fi and Bluetooth.
    pub scan_hz: f64,
    /// Epochs of UWB ranging; all anchors of an epoch answer at its time.
    pub ranging_hz: f64,
    /// Polls of RFID portals.
    pub portal_hz: f64,
    /// What is told of a range.
    pub detail: RangeDetail,
}

/// A tag: sensors, their errors and rates.
#[derive(Debug, Clone)]
pub struct Outfit {
    /// Where it sits.
    pub mount: Mount,
    /// Gravity, latitude, sampling of the IMU.
    pub ideal: IdealImu,
    /// Its errors.
    pub imu: ImuErrorModel,
    /// Its rate, Hz.
    pub imu_hz: f64,
    /// Magnetometer and field, where it has one.
    pub magnetic: Option<(MagneticWorld, MagnetometerModel)>,
    /// Barometer, where it has one.
    pub barometer: Option<BarometerModel>,
    /// Times [from, until) in which magnetometer and barometer say nothing, s: the IMU alone is left.
    pub silent_s: Vec<[f64; 2]>,
    /// Radios.
    pub radio: RadioRates,
}

impl Default for RadioRates {
    fn default() -> Self {
        Self { scan_hz: 1.0, ranging_hz: 10.0, portal_hz: 2.0, detail: RangeDetail::Diagnostics }
    }
}

impl Outfit {
    /// Rates are those of radios; sensors are checked where they are made.
    pub fn check(&self) -> Result<(), SimulationError> {
        let RadioRates { scan_hz, ranging_hz, portal_hz, .. } = self.radio;
        for (name, rate_hz) in [("scan_hz", scan_hz), ("ranging_hz", ranging_hz), ("portal_hz", portal_hz)] {
            check_within(name, rate_hz, 0.0, 1000.0, "0 to 1000 Hz, 0 for never")?;
        }
        for [from_s, until_s] in &self.silent_s {
            let expected = "an end no earlier than the beginning";
            check_within("silent_s", *until_s, *from_s, f64::INFINITY, expected)?;
        }
        Ok(())
    }

    /// Whether magnetometer and barometer say nothing.
    pub fn is_silent(&self, time_s: f64) -> bool {
        self.silent_s.iter().any(|[from_s, until_s]| (*from_s..*until_s).contains(&time_s))
    }
}

/// The motion of a tag on somebody, until the simulation ends.
#[derive(Debug, Clone)]
pub struct Worn {
    motion: WornMotion,
    end_s: f64,
}

#[derive(Debug, Clone)]
enum WornMotion {
    Belt(Box<WaistMotion>),
    Foot(Box<FootMotion>),
}

impl Worn {
    /// Puts a tag on.
    pub fn new(person: &Person, mount: Mount, end_s: f64) -> Self {
        let motion = match mount {
            Mount::Belt(belt) => WornMotion::Belt(Box::new(person.waist(belt))),
            Mount::LeftFoot(foot) => WornMotion::Foot(Box::new(person.foot(foot, true))),
            Mount::RightFoot(foot) => WornMotion::Foot(Box::new(person.foot(foot, false))),
        };
        Self { motion, end_s }
    }
}

impl Motion for Worn {
    fn at(&self, time_s: f64) -> MotionState {
        match &self.motion {
            WornMotion::Belt(motion) => motion.at(time_s),
            WornMotion::Foot(motion) => motion.at(time_s),
        }
    }

    fn duration_s(&self) -> f64 {
        self.end_s
    }
}
