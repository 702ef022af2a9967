//! A zone as it is watched.

use adit_mine::plan::Zone;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// A zone of the plan, or one that was drawn since.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LiveZone {
    /// Where it is and what it means; its capacity is the live one.
    pub zone: Zone,
    /// Teams whose people may enter it when it is restricted, beside those whom [`Person::allowed_zones`](crate::Person) names.
    #[serde(default, skip_serializing_if = "BTreeSet::is_empty")]
    pub allowed_teams: BTreeSet<String>,
}

impl From<Zone> for LiveZone {
    fn from(zone: Zone) -> Self {
        Self { zone, allowed_teams: BTreeSet::new() }
    }
}
