//! What the ranging circles of an epoch look like (Jia et al. 2024, fig. 4).
//!
//! The paper tells four cases apart: (a), (b) without line of sight, no position can be had of the circles; (c) ideal; (d) a position with an error. It does
//! not say what makes (a) differ from (b). Here the links that are recognised as clear decide: all of them (c), enough for a position (d), some but too few (b),
//! none (a).

use crate::ranging::listener::Link;
use serde::{Deserialize, Serialize};

/// Four cases.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Environment {
    /// (a) No link is clear.
    Blocked,
    /// (b) Some links are clear, too few for a position.
    PartlyBlocked,
    /// (c) Every link is clear.
    Ideal,
    /// (d) Enough links are clear, not all.
    WithError,
}

impl Environment {
    /// Of the links of an epoch; a position needs `least` of them.
    pub fn of(links: &[Link], least: usize) -> Self {
        match links.iter().filter(|link| link.is_clear()).count() {
            0 => Self::Blocked,
            clear if clear == links.len() => Self::Ideal,
            clear if clear >= least => Self::WithError,
            _ => Self::PartlyBlocked,
        }
    }

    /// Whether UWB is believed less than dead reckoning.
    pub const fn is_blocked(self) -> bool {
        matches!(self, Self::Blocked | Self::PartlyBlocked)
    }
}
