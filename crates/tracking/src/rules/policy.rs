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

/// What somebody wants otherwise.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Change {
    enabled: Option<bool>,
    severity: Option<Severity>,
    hold_off_s: Option<f64>,
}

impl AlarmPolicy {
    fn changed(self, change: &Change) -> Self {
        Self {
            enabled: change.enabled.unwrap_or(self.enabled),
            severity: change.severity.unwrap_or(self.severity),
            hold_off_s: change.hold_off_s.unwrap_or(self.hold_off_s),
        }
    }
}

/// One policy for each kind of alarm: its name, the kind, how bad it is and its hold-off unless somebody wants otherwise.
macro_rules! policies {
    ($($name:ident, $kind:ident, $severity:ident, $hold_off_s:literal;)+) => {
        /// What becomes of each kind of alarm. Whoever writes them names only what differs, also within a kind.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
        #[serde(from = "Changes")]
        pub struct AlarmPolicies {
            $(
                #[doc = concat!("Of [`AlarmKind::", stringify!($kind), "`].")]
                pub $name: AlarmPolicy,
            )+
        }

        #[derive(Debug, Default, Deserialize)]
        #[serde(deny_unknown_fields, default)]
        struct Changes {
            $($name: Change,)+
        }

        impl From<Changes> for AlarmPolicies {
            fn from(changes: Changes) -> Self {
                let kinds = Self::default();
                Self { $($name: kinds.$name.changed(&changes.$name),)+ }
            }
        }

        impl Default for AlarmPolicies {
            fn default() -> Self {
                let policy = |severity, hold_off_s| AlarmPolicy { enabled: true, severity, hold_off_s };
                Self { $($name: policy(Severity::$severity, $hold_off_s),)+ }
            }
        }

        impl AlarmPolicies {
            /// All with their names.
            pub(super) fn named(&self) -> impl Iterator<Item = (&'static str, &AlarmPolicy)> {
                [$((stringify!($name), &self.$name),)+].into_iter()
            }

            /// The policy of a kind.
            pub const fn of(&self, kind: AlarmKind) -> &AlarmPolicy {
                match kind {
                    $(AlarmKind::$kind => &self.$name,)+
                }
            }
        }
    };
}

policies! {
    distress, Distress, Critical, 0.0;
    man_down, ManDown, Critical, 0.0;
    no_motion, NoMotion, High, 60.0;
    dangerous_zone, DangerousZone, Critical, 10.0;
    restricted_zone, RestrictedZone, High, 30.0;
    over_capacity, OverCapacity, Medium, 60.0;
    missing_in_evacuation, MissingInEvacuation, Critical, 0.0;
    lost_contact, LostContact, High, 60.0;
    overtime, Overtime, Medium, 600.0;
    two_tags, TwoTags, Medium, 60.0;
    low_battery, LowBattery, Low, 600.0;
    gateway_down, GatewayDown, High, 60.0;
    anchor_down, AnchorDown, Medium, 60.0;
    silence, Silence, Critical, 30.0;
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
