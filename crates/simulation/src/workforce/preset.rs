//! Tags as most tests and demonstrations wear them.

use super::{Mount, Outfit, RadioRates, WorkforceSpec};
use crate::ideal_imu::IdealImu;
use crate::imu_errors::ImuErrorModel;
use crate::people::{Errand, PersonSpec, Place, PopulationSpec, Roam};
use crate::pressure::AirSpec;
use crate::radio::delivery::{ClockSpec, LinkSpec};
use crate::radio::{RadioSpec, RangeDetail};

impl Outfit {
    /// An MPU-6050 at 100 Hz and a radio that tells distances and nothing of how they came; no magnetometer, no barometer.
    pub fn plain(mount: Mount, ranging_hz: f64) -> Self {
        Self {
            mount,
            ideal: IdealImu::default(),
            imu: ImuErrorModel::mpu6050(),
            imu_hz: 100.0,
            magnetic: None,
            barometer: None,
            silent_s: Vec::new(),
            radio: RadioRates { detail: RangeDetail::Range, ranging_hz, ..RadioRates::default() },
        }
    }
}

impl WorkforceSpec {
    /// People with errands in a mine where nothing fails: clocks are true, and what is sent arrives at once.
    pub fn undisturbed(duration_s: f64, persons: Vec<PersonSpec>, outfit: Outfit) -> Self {
        Self {
            duration_s,
            population: PopulationSpec { persons, ..PopulationSpec::default() },
            outfit,
            air: AirSpec::default(),
            radio: RadioSpec::default(),
            outages: Vec::new(),
            conveyors_s: Vec::new(),
            clock: ClockSpec::perfect(),
            link: LinkSpec::perfect(),
        }
    }
}

impl Roam {
    /// About a level until a time, no farther than `reach_m` at a stretch, with stops at a share of the places.
    pub fn on_level(level: &str, until_s: f64, reach_m: f64, stop_share: f64, stop_s: [f64; 2]) -> Self {
        let levels = vec![level.to_owned()];
        Self { until_s, levels, reach_m, speed_share: [0.9, 1.1], stop_share, stop_s, work_share: 0.5 }
    }
}

impl PersonSpec {
    /// Somebody whose build is drawn, who stands for a while and walks about then.
    pub fn roaming(start: Place, stand_s: f64, roam: Roam) -> Self {
        let errands = vec![Errand::Stand { seconds: stand_s }, Errand::Roam(roam)];
        Self { body: crate::people::Body::default(), drawn: true, start, errands }
    }
}
