//! Whether rules can be.

use super::{Escalation, Rules};

/// A rule that cannot be.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("rule {rule} is expected {expected}, found {found}")]
pub struct RulesError {
    /// Its name.
    pub rule: String,
    /// What it may be.
    pub expected: &'static str,
    /// What it is.
    pub found: f64,
}

/// The longest time and the largest number that rules may have: far beyond any use, and exact in nanoseconds.
const LARGEST: f64 = 1e9;

impl Rules {
    /// The first rule that cannot be, if any.
    pub fn check(&self) -> Result<(), RulesError> {
        let positive = [
            ("contact.lost_after_s", self.contact.lost_after_s),
            ("contact.silence_after_s", self.contact.silence_after_s),
            ("contact.tick_gap_s", self.contact.tick_gap_s),
            ("position.crossing_speed_m_s", self.position.crossing_speed_m_s),
            ("position.growth_m_s", self.position.growth_m_s),
            ("motion.still_after_s", self.motion.still_after_s),
            ("motion.evidence_s", self.motion.evidence_s),
            ("motion.still_position_after_s", self.motion.still_position_after_s),
            ("shifts.limit_h", self.shifts.limit_h),
            ("evacuation.not_moving_after_s", self.evacuation.not_moving_after_s),
            ("evacuation.missing_after_s", self.evacuation.missing_after_s),
            ("evacuation.walking_m_s", self.evacuation.walking_m_s),
        ];
        for (rule, found) in positive {
            number(rule, found, found > 0.0 && found <= LARGEST, "above 0 and at most 10⁹")?;
        }
        let from_zero = [
            ("contact.future_s", self.contact.future_s),
            ("position.crossing_gap_s", self.position.crossing_gap_s),
            ("position.level_tolerance_m", self.position.level_tolerance_m),
            ("motion.still_radius_m", self.motion.still_radius_m),
            ("shifts.break_s", self.shifts.break_s),
            ("battery.low_share", self.battery.low_share),
            ("battery.low_volts", self.battery.low_volts),
        ];
        for (rule, found) in from_zero {
            number(rule, found, (0.0..=LARGEST).contains(&found), "from 0 to 10⁹")?;
        }
        let (share, volts) = (self.battery.fine_share, self.battery.fine_volts);
        let (low_share, low_volts) = (self.battery.low_share, self.battery.low_volts);
        number("battery.fine_share", share, (low_share..=1.0).contains(&share), "from low_share to 1")?;
        number("battery.fine_volts", volts, (low_volts..=LARGEST).contains(&volts), "low_volts or more")?;
        for (name, policy) in self.alarms.named() {
            let found = policy.hold_off_s;
            let rule = format!("alarms.{name}.hold_off_s");
            number(&rule, found, (0.0..=LARGEST).contains(&found), "from 0 to 10⁹")?;
        }
        let Escalation { critical_after_s, high_after_s, medium_after_s, low_after_s } = &self.escalation;
        for (rule, steps) in [
            ("escalation.critical_after_s", critical_after_s),
            ("escalation.high_after_s", high_after_s),
            ("escalation.medium_after_s", medium_after_s),
            ("escalation.low_after_s", low_after_s),
        ] {
            let mut before = 0.0;
            for &found in steps {
                number(rule, found, found > before && found <= LARGEST, "above 0, rising, at most 10⁹")?;
                before = found;
            }
        }
        Ok(())
    }
}

fn number(rule: &str, found: f64, fits: bool, expected: &'static str) -> Result<(), RulesError> {
    if fits { Ok(()) } else { Err(RulesError { rule: rule.into(), expected, found }) }
}
