//! Areas with a meaning.

use crate::geometry::polygon::{self, Outline};
use alloc::string::String;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// What a zone means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "std", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ZoneKind {
    /// Entry only for those who are allowed to.
    Restricted,
    /// Dangerous for everybody.
    Dangerous,
    /// A key place of work, where the number of people is watched.
    Key,
    /// A refuge for emergencies.
    Refuge,
    /// A way out of the mine: who is here counts as out.
    Portal,
}

/// An area with a meaning, on one level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "std", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Zone {
    /// Its id.
    pub id: String,
    /// Name for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// What it means.
    pub kind: ZoneKind,
    /// The level it lies on.
    pub level: String,
    /// How many people it may hold, or a refuge can keep alive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub capacity: Option<u32>,
    /// Who was inside is outside only when this far from it, m.
    #[serde(default)]
    #[cfg_attr(feature = "std", schemars(extend("minimum" = 0)))]
    pub exit_tolerance_m: f64,
    /// Who was inside is outside only after this long beyond the tolerance, s.
    #[serde(default)]
    #[cfg_attr(feature = "std", schemars(extend("minimum" = 0)))]
    pub exit_delay_s: f64,
    /// Corners east, north, in order round the zone, the first not repeated, m.
    #[cfg_attr(feature = "std", schemars(length(min = 3)))]
    pub outline_m: Vec<[f64; 2]>,
}

impl Zone {
    /// Horizontal distance from the zone, m; 0 inside. The level is the caller's affair: see
    /// [`Mine::zones_at`](crate::Mine::zones_at).
    pub fn distance_m(&self, x_m: f64, y_m: f64) -> f64 {
        polygon::distance_m(&self.outline_m, [x_m, y_m])
    }

    /// Is somebody at this place inside, who was or was not so far? In at the outline, out at `exit_tolerance_m` from it, so that
    /// somebody who stands on the line does not come and go with every fix.
    pub fn holds(&self, was_inside: bool, x_m: f64, y_m: f64) -> bool {
        let distance_m = self.distance_m(x_m, y_m);
        if was_inside { distance_m <= self.exit_tolerance_m } else { distance_m <= 0.0 }
    }
    /// Where somebody who goes straight from one place to the other is inside, from the first entry to the last exit: shares of the way,
    /// 0 to 1. `None` when the way does not lead through the zone.
    pub fn passage(&self, from: [f64; 2], to: [f64; 2]) -> Option<(f64, f64)> {
        let inside = polygon::chords(&self.outline_m, from, to, Outline::Inside);
        Some((inside.first()?.from, inside.last()?.to))
    }
}
