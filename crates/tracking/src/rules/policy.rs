//! Which alarms there are, how bad they are, and when they go further up.

use crate::alarms::{AlarmKind, Severity};
use serde::{Deserialize, Serialize};

/// What becomes of one kind of alarm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AlarmPolicy {
    /// It is raised at all.
    pub enabled: bool,
    /// How bad it is.
    pub severity: Severity,
    /// How long after it was cleared it may be raised again, s.
    pub hold_off_s: f64,
}

const fn policy(severity: Severity, hold_off_s: f64) -> AlarmPolicy {
    AlarmPolicy { enabled: true, severity, hold_off_s }
}

/// What becomes of each kind of alarm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AlarmPolicies {
    /// [`AlarmKind::Distress`].
    pub distress: AlarmPolicy,
    /// [`AlarmKind::ManDown`].
    pub man_down: AlarmPolicy,
    /// [`AlarmKind::NoMotion`].
    pub no_motion: AlarmPolicy,
    /// [`AlarmKind::DangerousZone`].
    pub dangerous_zone: AlarmPolicy,
    /// [`AlarmKind::RestrictedZone`].
    pub restricted_zone: AlarmPolicy,
    /// [`AlarmKind::OverCapacity`].
    pub over_capacity: AlarmPolicy,
    /// [`AlarmKind::MissingInEvacuation`].
    pub missing_in_evacuation: AlarmPolicy,
    /// [`AlarmKind::LostContact`].
    pub lost_contact: AlarmPolicy,
    /// [`AlarmKind::Overtime`].
    pub overtime: AlarmPolicy,
    /// [`AlarmKind::TwoTags`].
    pub two_tags: AlarmPolicy,
    /// [`AlarmKind::LowBattery`].
    pub low_battery: AlarmPolicy,
    /// [`AlarmKind::GatewayDown`].
    pub gateway_down: AlarmPolicy,
    /// [`AlarmKind::AnchorDown`].
    pub anchor_down: AlarmPolicy,
    /// [`AlarmKind::Silence`].
    pub silence: AlarmPolicy,
}

impl Default for AlarmPolicies {
    fn default() -> Self {
        Self {
            distress: policy(Severity::Critical, 0.0),
            man_down: policy(Severity::Critical, 0.0),
            no_motion: policy(Severity::High, 60.0),
            dangerous_zone: policy(Severity::Critical, 10.0),
            restricted_zone: policy(Severity::High, 30.0),
            over_capacity: policy(Severity::Medium, 60.0),
            missing_in_evacuation: policy(Severity::Critical, 0.0),
            lost_contact: policy(Severity::High, 60.0),
            overtime: policy(Severity::Medium, 600.0),
            two_tags: policy(Severity::Medium, 60.0),
            low_battery: policy(Severity::Low, 600.0),
            gateway_down: policy(Severity::High, 60.0),
            anchor_down: policy(Severity::Medium, 60.0),
            silence: policy(Severity::Critical, 30.0),
        }
    }
}

impl AlarmPolicies {
    /// The policy of a kind.
    pub const fn of(&self, kind: AlarmKind) -> &AlarmPolicy {
        match kind {
            AlarmKind::Distress => &self.distress,
            AlarmKind::ManDown => &self.man_down,
            AlarmKind::NoMotion => &self.no_motion,
            AlarmKind::DangerousZone => &self.dangerous_zone,
            AlarmKind::RestrictedZone => &self.restricted_zone,
            AlarmKind::OverCapacity => &self.over_capacity,
            AlarmKind::MissingInEvacuation => &self.missing_in_evacuation,
            AlarmKind::LostContact => &self.lost_contact,
            AlarmKind::Overtime => &self.overtime,
            AlarmKind::TwoTags => &self.two_tags,
            AlarmKind::LowBattery => &self.low_battery,
            AlarmKind::GatewayDown => &self.gateway_down,
            AlarmKind::AnchorDown => &self.anchor_down,
            AlarmKind::Silence => &self.silence,
        }
    }
}

/// How long after it was raised an alarm that nobody has acknowledged goes up a level, s; one number for each level, rising.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Escalation {
    /// Of critical alarms.
    pub critical_after_s: Vec<f64>,
    /// Of high ones.
    pub high_after_s: Vec<f64>,
    /// Of medium ones.
    pub medium_after_s: Vec<f64>,
    /// Of low ones.
    pub low_after_s: Vec<f64>,
}

impl Default for Escalation {
    fn default() -> Self {
        Self {
            critical_after_s: vec![60.0, 180.0],
            high_after_s: vec![300.0, 900.0],
            medium_after_s: vec![1800.0],
            low_after_s: Vec::new(),
        }
    }
}

impl Escalation {
    /// Of alarms of a severity.
    pub fn of(&self, severity: Severity) -> &[f64] {
        match severity {
            Severity::Critical => &self.critical_after_s,
            Severity::High => &self.high_after_s,
            Severity::Medium => &self.medium_after_s,
            Severity::Low => &self.low_after_s,
        }
    }
}
