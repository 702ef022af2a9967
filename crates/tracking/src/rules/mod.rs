//! Policy: what is an alarm, from when on, how bad, and how soon somebody must have seen it.
//!
//! Every number has its unit in its name and a default that serves a real mine; the table stands in `docs/live/tracking.md`. Whoever
//! writes rules names only what differs.

mod check;
mod policy;

pub use check::RulesError;
pub use policy::{AlarmPolicies, AlarmPolicy, Escalation};

use serde::{Deserialize, Serialize};

/// All rules.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Rules {
    /// When a tag is lost.
    pub contact: ContactRules,
    /// What the fixes of somebody may be, and where they may be when none come.
    pub position: PositionRules,
    /// When somebody does not move.
    pub motion: MotionRules,
    /// How long somebody may be below.
    pub shifts: ShiftRules,
    /// When a battery is low.
    pub battery: BatteryRules,
    /// When somebody is missing.
    pub evacuation: EvacuationRules,
    /// Which alarms there are and how bad they are.
    pub alarms: AlarmPolicies,
    /// When an alarm that nobody acknowledges goes further up.
    pub escalation: Escalation,
}

/// When a tag is lost.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ContactRules {
    /// A tag below is lost when it was not heard for this long, s.
    pub lost_after_s: f64,
    /// When nothing at all was heard for this long, the fault is not the tags': one alarm for all, s.
    pub silence_after_s: f64,
    /// … and when at least so many people are below: a few may well be silent together.
    pub silence_from_people: u32,
    /// A longer break between two ticks means that nobody listened: the time is not held against the tags, s.
    pub tick_gap_s: f64,
    /// What is stamped further ahead of its arrival than this is left out, s.
    pub future_s: f64,
    /// How many tags that nobody has registered are followed.
    pub unregistered_tags: u32,
}

impl Default for ContactRules {
    fn default() -> Self {
        Self {
            lost_after_s: 120.0,
            silence_after_s: 30.0,
            silence_from_people: 5,
            tick_gap_s: 10.0,
            future_s: 2.0,
            unregistered_tags: 1000,
        }
    }
}

/// What the fixes of somebody may be, and where they may be when none come.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PositionRules {
    /// The way between two fixes is taken for straight when no more time lies between them than this, s.
    pub crossing_gap_s: f64,
    /// … and when nobody has to be faster than this for it, beyond what the radii of both explain, m/s.
    pub crossing_speed_m_s: f64,
    /// Somebody is on another level only when beyond the border between both by this, m.
    pub level_tolerance_m: f64,
    /// How fast the radius of the last known position grows while nothing is heard of motion or rest, m/s.
    pub growth_m_s: f64,
}

impl Default for PositionRules {
    fn default() -> Self {
        Self { crossing_gap_s: 20.0, crossing_speed_m_s: 12.0, level_tolerance_m: 1.0, growth_m_s: 1.5 }
    }
}

/// When somebody does not move.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MotionRules {
    /// Alarm when the tag's sensors, or its method, have said "still" for this long, s.
    pub still_after_s: f64,
    /// Alarm when only positions are known and all of them lay within `still_radius_m` and their own radius for this long, s.
    pub still_position_after_s: f64,
    /// How far somebody who does not move may seem to, m.
    pub still_radius_m: f64,
    /// How long what a tag's sensors have said stays true; longer silence between two words begins a new count, s.
    pub evidence_s: f64,
}

impl Default for MotionRules {
    fn default() -> Self {
        Self { still_after_s: 300.0, still_position_after_s: 900.0, still_radius_m: 3.0, evidence_s: 60.0 }
    }
}

/// How long somebody may be below.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ShiftRules {
    /// Below for longer than this is overtime, h.
    pub limit_h: f64,
    /// Who is below again within this time goes on with the same shift, s.
    pub break_s: f64,
    /// How many tags a person may wear at a time.
    pub tags_per_person: u32,
}

impl Default for ShiftRules {
    fn default() -> Self {
        Self { limit_h: 10.0, break_s: 1800.0, tags_per_person: 1 }
    }
}

/// When a battery is low.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BatteryRules {
    /// Low from here down, share of a full one.
    pub low_share: f64,
    /// Not low from here up.
    pub fine_share: f64,
    /// Low from here down, V.
    pub low_volts: f64,
    /// Not low from here up, V.
    pub fine_volts: f64,
}

impl Default for BatteryRules {
    fn default() -> Self {
        Self { low_share: 0.2, fine_share: 0.3, low_volts: 3.5, fine_volts: 3.65 }
    }
}

/// When somebody is missing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct EvacuationRules {
    /// Who is heard and does not move for this long is not moving, s.
    pub not_moving_after_s: f64,
    /// Who is neither safe nor on the way for this long is missing, s.
    pub missing_after_s: f64,
    /// Who is on the way is missing when even at this speed the way would be done by now, with `missing_after_s` on top, m/s.
    pub walking_m_s: f64,
}

impl Default for EvacuationRules {
    fn default() -> Self {
        Self { not_moving_after_s: 30.0, missing_after_s: 300.0, walking_m_s: 0.7 }
    }
}
