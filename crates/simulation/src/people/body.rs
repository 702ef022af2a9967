//! Who walks: build, speeds, habits.

use super::errands::Pace;
use super::posture::Manner;
use crate::error::{SimulationError, check_within};
use crate::gait::Gait;
use serde::{Deserialize, Serialize};

/// Step length over steps per minute, m·min, of a person of 1.75 m who walks freely; it hardly changes with speed (Sekiya & Nagasaki,
/// *Gait & Posture* 7, 1998, from memory; the men of `gait-lowback` give 0.0059).
const WALK_RATIO_M_MIN: f64 = 0.006;
/// Time of one step, s.
const RUN_STEP_S: f64 = 0.37;
const CRAWL_STEP_S: f64 = 0.75;

/// Build, speeds and habits of a person.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Body {
    /// Height, m.
    pub height_m: f64,
    /// Walking speed, m/s.
    pub walk_m_s: f64,
    /// Running speed, m/s.
    pub run_m_s: f64,
    /// Crawling speed, m/s.
    pub crawl_m_s: f64,
    /// Coefficient of variation from step to step of length and time.
    pub variation: f64,
    /// How far right of the centre line they keep where the roadway is wide enough, m.
    pub keep_right_m: f64,
    /// How far they wander to either side of that, m.
    pub wander_m: f64,
    /// They crawl where the roof is lower than this share of their height.
    pub headroom: f64,
}

impl Default for Body {
    fn default() -> Self {
        Self {
            height_m: 1.76,
            walk_m_s: 1.25,
            run_m_s: 2.4,
            crawl_m_s: 0.45,
            variation: 0.03,
            keep_right_m: 0.8,
            wander_m: 0.25,
            headroom: 0.7,
        }
    }
}

impl Body {
    /// The numbers are those of a person.
    pub fn check(&self) -> Result<(), SimulationError> {
        check_within("height_m", self.height_m, 1.0, 2.5, "1 to 2.5 m")?;
        check_within("walk_m_s", self.walk_m_s, 0.3, 3.2, "0.3 to 3.2 m/s")?;
        check_within("run_m_s", self.run_m_s, 1.0, 6.0, "1 to 6 m/s")?;
        check_within("crawl_m_s", self.crawl_m_s, 0.1, 1.0, "0.1 to 1 m/s")?;
        check_within("variation", self.variation, 0.0, 0.1, "0 to 0.1")?;
        check_within("keep_right_m", self.keep_right_m, 0.0, 10.0, "0 to 10 m")?;
        check_within("wander_m", self.wander_m, 0.0, 2.0, "0 to 2 m")?;
        check_within("headroom", self.headroom, 0.2, 1.0, "0.2 to 1")
    }

    /// The same person at another speed of a pace, m/s.
    pub(super) fn at_speed(&self, pace: Pace, speed_m_s: f64) -> Self {
        match pace {
            Pace::Walk => Self { walk_m_s: speed_m_s, ..*self },
            Pace::Run => Self { run_m_s: speed_m_s, ..*self },
            Pace::Crawl => Self { crawl_m_s: speed_m_s, ..*self },
        }
    }

    /// Length (m) and time (s) of a step, at this manner's speed.
    pub(super) fn step(&self, manner: Manner) -> (f64, f64) {
        match manner {
            Manner::Run => (self.run_m_s * RUN_STEP_S, RUN_STEP_S),
            Manner::Crawl => (self.crawl_m_s * CRAWL_STEP_S, CRAWL_STEP_S),
            _ => {
                // speed = length · cadence / 60, length = ratio · cadence.
                let ratio = WALK_RATIO_M_MIN * self.height_m / 1.75;
                let length_m = libm::sqrt(60.0 * self.walk_m_s * ratio);
                (length_m, length_m / self.walk_m_s)
            }
        }
    }

    /// The stride of one foot in this manner.
    pub(super) fn gait(&self, manner: Manner) -> Gait {
        let (step_m, step_s) = self.step(manner);
        let shape = match manner {
            Manner::Run => Gait::run(),
            // A shin that is drawn along the floor hardly rolls.
            Manner::Crawl => Gait {
                early_heel_off_rad: 0.02,
                heel_off_rad: 0.05,
                heel_strike_rad: 0.0,
                clearance_m: 0.02,
                circumduction_m: 0.01,
                swing_roll_rad: 0.05,
                swing_yaw_rad: 0.05,
                still_share: 0.3,
                shock_m: 0.0,
                ..Gait::slow()
            },
            _ => Gait::walk(),
        };
        Gait { stride_m: 2.0 * step_m, stride_s: 2.0 * step_s, variation: self.variation, ..shape }
    }
}
