//! Gateways and anchors as they were heard of, so that the tracking hears of changes only.

use adit_core::time::{Interval, Time};
use adit_tracking::{Device, DeviceKind};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A gateway that sends nothing for so long is down, whatever the broker says: thirty batches.
pub const GATEWAY_SILENCE: Interval = Interval::from_nanos(30_000_000_000);

/// How devices are.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Devices {
    gateways: BTreeMap<String, Known>,
    anchors: BTreeMap<String, bool>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Known {
    up: bool,
    heard: Time,
}

impl Devices {
    /// A gateway sent something, or went; what is new, if anything.
    pub fn gateway(&mut self, id: &str, up: bool, now: Time) -> Option<Device> {
        if let Some(known) = self.gateways.get_mut(id) {
            let changed = known.up != up;
            *known = Known { up, heard: now };
            return changed.then(|| device(DeviceKind::Gateway, id, up, now));
        }
        self.gateways.insert(id.to_owned(), Known { up, heard: now });
        Some(device(DeviceKind::Gateway, id, up, now))
    }

    /// A gateway told how an anchor is; what is new, if anything.
    pub fn anchor(&mut self, id: &str, up: bool, now: Time) -> Option<Device> {
        if self.anchors.get(id) == Some(&up) {
            return None;
        }
        self.anchors.insert(id.to_owned(), up);
        Some(device(DeviceKind::Anchor, id, up, now))
    }

    /// Gateways that have been silent for too long.
    pub fn silent(&mut self, now: Time) -> Vec<Device> {
        let mut silent = Vec::new();
        for (id, known) in &mut self.gateways {
            if known.up && now - known.heard > GATEWAY_SILENCE {
                known.up = false;
                silent.push(device(DeviceKind::Gateway, id, false, now));
            }
        }
        silent
    }
}

fn device(kind: DeviceKind, id: &str, up: bool, time: Time) -> Device {
    Device { kind, id: id.to_owned(), time, up }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gateway_silent_for_half_a_minute_is_down_once_and_up_when_it_is_heard() {
        let at = |second: i64| Time::from_nanos(second * 1_000_000_000);
        let mut devices = Devices::default();
        assert!(devices.gateway("north", true, at(0)).is_some_and(|told| told.up));
        assert!(devices.gateway("north", true, at(5)).is_none());
        assert!(devices.silent(at(35)).is_empty());
        let down = devices.silent(at(36));
        assert_eq!(down, [device(DeviceKind::Gateway, "north", false, at(36))]);
        assert!(devices.silent(at(37)).is_empty());
        assert!(devices.gateway("north", true, at(40)).is_some_and(|told| told.up));
    }
}
