//! The radio half of a method: signals in, position fixes out, with an account of what was heard.

use super::locator::{Locator, LocatorParams};
use super::scan::{ScanParams, Scanner};
use super::site::RadioSite;
use crate::methods::{MethodError, MethodWarning};
use adit_core::time::Time;
use adit_observation::{DeviceId, FixSource, PositionFix, Radio, SignalStrength};
use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// Names of unknown transmitters kept for the report.
const MOST_NAMES: usize = 100;

/// Scanner and locator, streaming. Clones share the locator.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Listener {
    scanner: Scanner,
    /// `None` while it is kept: what belongs to the site is kept once, there.
    locator: Option<Arc<Locator>>,
    heard: HeardReport,
}

/// What was heard and what became of it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct HeardReport {
    /// Signals in the log.
    pub signals: u64,
    /// Of these, from transmitters that the site does not know.
    pub unknown_signals: u64,
    /// Those transmitters, at most the first hundred.
    pub unknown_transmitters: Vec<DeviceId>,
    /// Signals that came after the report that they belong to: left.
    pub late_signals: u64,
    /// Signals of more transmitters than a scan holds: left.
    pub left_out_signals: u64,
    /// Scans, averaged.
    pub scans: u64,
    /// Of these, scans that gave a position.
    pub fixes: u64,
}

impl Listener {
    /// The listener of a method at a site.
    pub fn new(
        method: &'static str,
        site: Option<&RadioSite>,
        scan: ScanParams,
        locator: LocatorParams,
    ) -> Result<Self, MethodError> {
        if let Some(name) = scan.unusable().or_else(|| locator.unusable()) {
            return Err(MethodError::Setting { method, name });
        }
        let site =
            site.ok_or(MethodError::NoRadio { method, needs: "the radio of the site (--mine or --radio)" })?;
        let locator = Locator::new(site, locator).map_err(|needs| MethodError::NoRadio { method, needs })?;
        Ok(Self {
            scanner: Scanner::new(scan),
            locator: Some(Arc::new(locator)),
            heard: HeardReport::default(),
        })
    }

    /// Takes a signal.
    pub fn observe(&mut self, signal: &SignalStrength) {
        if !self.count(signal) {
            return;
        }
        self.scanner.observe(signal);
        self.heard.late_signals = self.scanner.late();
        self.heard.left_out_signals = self.scanner.left_out();
    }

    /// Counts a signal of which nothing is made; tells whether its transmitter is known.
    pub fn count(&mut self, signal: &SignalStrength) -> bool {
        self.heard.signals += 1;
        if !self.locator.as_ref().is_some_and(|locator| locator.knows(&signal.transmitter)) {
            self.heard.unknown_signals += 1;
            let unknown = &mut self.heard.unknown_transmitters;
            if unknown.len() < MOST_NAMES && !unknown.contains(&signal.transmitter) {
                unknown.push(signal.transmitter.clone());
            }
            return false;
        }
        true
    }

    /// Drops what was heard and not yet reported.
    pub fn clear(&mut self) {
        self.scanner.clear();
    }

    /// Takes the locator of another listener at the same site for its own, which is the same: one that was read back has a copy.
    pub fn share(&mut self, other: &Self) {
        self.locator.clone_from(&other.locator);
    }

    /// Gives up what belongs to the site, until [`Self::share`].
    pub fn detach(&mut self) {
        self.locator = None;
    }

    /// Time has come to `now`.
    pub fn advance(&mut self, now: Time) {
        self.scanner.advance(now);
    }

    /// The next position that is due, if any.
    pub fn pop(&mut self) -> Option<PositionFix> {
        while let Some(scan) = self.scanner.pop() {
            if let Some(fix) = self.fix(&scan) {
                return Some(fix);
            }
        }
        None
    }

    /// After the last observation: the positions left, one after the other.
    pub fn finish(&mut self) -> Option<PositionFix> {
        while let Some(scan) = self.scanner.finish() {
            if let Some(fix) = self.fix(&scan) {
                return Some(fix);
            }
        }
        None
    }

    /// What was heard so far.
    pub fn report(&self) -> &HeardReport {
        &self.heard
    }

    fn fix(&mut self, scan: &super::scan::Scan) -> Option<PositionFix> {
        self.heard.scans += 1;
        let fix = self.locator.as_ref()?.locate(scan)?;
        let source = match scan.radio {
            Radio::Wifi => FixSource::Wifi,
            Radio::Ble => FixSource::Bluetooth,
            Radio::Uwb => FixSource::Uwb,
            Radio::Unknown => FixSource::Unknown,
        };
        let (level_m, covariance_m2) = (fix.position_m, fix.covariance_m2);
        // Products of roundings differ in the last bit.
        let covariance_m2 = (covariance_m2 + covariance_m2.transpose()) * 0.5;
        let fix = PositionFix { time: scan.time, level_m, covariance_m2, height: None, source };
        fix.fault().is_none().then(|| {
            self.heard.fixes += 1;
            fix
        })
    }
}

impl HeardReport {
    /// What a user should know of transmitters that were heard in vain, if any.
    pub fn warning(&self) -> Option<MethodWarning> {
        (self.unknown_signals > 0).then(|| MethodWarning::UnknownTransmitters {
            transmitters: self.unknown_transmitters.len(),
            signals: self.unknown_signals,
            names: self.unknown(),
        })
    }

    /// That not one position came of it.
    pub(crate) fn no_position(&self) -> MethodError {
        let names =
            if self.unknown_signals > 0 { alloc::format!(" ({})", self.unknown()) } else { String::new() };
        MethodError::NoPosition { signals: self.signals, unknown: self.unknown_signals, names }
    }

    /// The first unknown transmitters by name, for a warning.
    pub fn unknown(&self) -> String {
        first_names(&self.unknown_transmitters)
    }
}

/// The first few, for a line to a user.
pub fn first_names(all: &[DeviceId]) -> String {
    const SHOWN: usize = 3;
    let names: Vec<&str> = all.iter().take(SHOWN).map(DeviceId::as_str).collect();
    let more = if all.len() > SHOWN { ", …" } else { "" };
    names.join(", ") + more
}
