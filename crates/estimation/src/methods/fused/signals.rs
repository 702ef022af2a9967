//! Signal strengths, each held against the place by itself.
//!
//! What a reading errs has two parts: fading, which is new at each, and shadowing, which belongs to the place and fades with the way, `ρ = exp(−Δs/D − Δt/T)`
//! (Gudmundson 1991; D and T: [`crate::methods::pdr::PdrRadio`]). How large both are is learnt from the innovations ν: of all of them the sum (Mehra 1972), of the differences of two in a row of
//! one transmitter the part that is new:
//!
//! ```text
//! V = ⟨ν² − H P Hᵀ⟩ = σ_f² + σ_s²,   D = ½ ⟨(ν − ν')²⟩ = σ_f² + (1 − ρ) σ_s²
//! R = σ_f² + σ_s² (1 + ρ)/(1 − ρ)
//! ```
//!
//! so that readings one after the other add up to what they know together.

use crate::methods::pdr::PdrRadio;
use crate::radio::locator::{LocatorMethod, emitters, names};
use crate::radio::{Emitter, RadioSite};
use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use adit_observation::{DeviceId, SignalStrength};
use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// Readings over which errors are learnt, and what the settings count for, in readings.
const READINGS: f64 = 300.0;
const BEGIN: f64 = 30.0;
/// Share of the variance that is fading before anything is learnt.
const FADING: f64 = 0.5;
/// Least variance of either part, dB².
const LEAST_DB2: f64 = 0.1;
/// An outlier counts as no more than so many variances.
const MOST_OFF: f64 = 9.0;
/// Readings whose shadowing is this much alike still tell it from fading.
const ALIKE: f64 = 0.3;
/// Transmitters of which the last reading is remembered.
const MOST: usize = 32;
/// A reading that repeats the one before is still one.
const LEAST_SHARE: f64 = 1e-3;

/// The transmitters of a site, and when each was heard last.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Signals {
    /// Number of the transmitter of each name, by name.
    names: Arc<[(DeviceId, usize)]>,
    emitters: Arc<[Emitter]>,
    /// The last reading of each transmitter that was heard lately.
    last: Vec<Heard>,
    correlation_m: f64,
    correlation_s: f64,
    /// V and `σ_s²`, dB².
    whole_db2: f64,
    shadow_db2: f64,
    learnt: [f64; 2],
}

/// A reading.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Heard {
    transmitter: usize,
    time: Time,
    way_m: Vector3<f64>,
    off_db: f64,
}

/// What a reading is expected to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected {
    /// Place and path loss of the transmitter.
    pub emitter: Emitter,
    /// What the reading errs by itself, dB.
    pub sigma_db: f64,
    /// The same for what is new in it, dB.
    pub new_db: f64,
    /// How much its shadowing is that of the reading before, and by what that was off, dB.
    alike: f64,
    before_db: f64,
}

impl Signals {
    /// Where transmitters of known places beside roadways are all that is known of the radio. Along a roadway a strength tells a place; on an open floor it tells a ring, and all strengths
    /// of a scan together are a better measurement. A survey knows more than a path loss.
    pub fn new(site: &RadioSite, params: &PdrRadio) -> Option<Self> {
        let whole = params.used
            && params.locator.method == LocatorMethod::Auto
            && site.surveyed.is_none()
            && site.roadways.is_some();
        if !whole || site.transmitters.is_empty() {
            return None;
        }
        let emitters: Arc<[Emitter]> =
            emitters(site, &params.locator).into_iter().map(|(emitter, _)| emitter).collect();
        let mut names = names(&site.transmitters);
        names.sort();
        let sigma_db = emitters.first().map_or(params.locator.sigma_db, |emitter| emitter.sigma_db);
        Some(Self {
            names: names.into(),
            last: Vec::new(),
            emitters,
            correlation_m: params.correlation_m,
            correlation_s: params.correlation_s,
            whole_db2: sigma_db * sigma_db,
            shadow_db2: (1.0 - FADING) * sigma_db * sigma_db,
            learnt: [BEGIN; 2],
        })
    }

    /// Takes what belongs to the site from others there: those that were read back have copies.
    pub fn share(&mut self, other: &Self) {
        self.names = Arc::clone(&other.names);
        self.emitters = Arc::clone(&other.emitters);
    }

    /// Gives up what belongs to the site, until [`Self::share`].
    pub fn detach(&mut self) {
        self.names = Arc::default();
        self.emitters = Arc::default();
    }

    /// The transmitter of a signal.
    pub fn transmitter(&self, signal: &SignalStrength) -> Option<usize> {
        let place = self.names.binary_search_by(|(name, _)| name.cmp(&signal.transmitter)).ok()?;
        self.names.get(place).map(|(_, number)| *number)
    }

    /// The names of a transmitter: its id, its MAC address.
    pub fn names_of(&self, transmitter: usize) -> Vec<String> {
        let names = self.names.iter().filter(|(_, number)| *number == transmitter);
        names.map(|(name, _)| String::from(name.as_str())).collect()
    }

    /// What a reading of a transmitter is expected to err; `way_m` is the way of the carrier.
    pub fn expect(&self, transmitter: usize, time: Time, way_m: &Vector3<f64>) -> Option<Expected> {
        let emitter = *self.emitters.get(transmitter)?;
        let last = self.last.iter().find(|last| last.transmitter == transmitter);
        let (alike, before_db) = last.map_or((0.0, 0.0), |last| {
            let walked = (way_m - last.way_m).xy().norm() / self.correlation_m;
            let passed = (time - last.time).seconds().abs() / self.correlation_s;
            (libm::exp(-walked - passed), last.off_db)
        });
        let fading = self.whole_db2 - self.shadow_db2;
        let repeated = (1.0 + alike) / (1.0 - alike).max(LEAST_SHARE);
        Some(Expected {
            emitter,
            sigma_db: libm::sqrt(self.whole_db2),
            new_db: libm::sqrt(fading + self.shadow_db2 * repeated),
            alike,
            before_db,
        })
    }

    /// In place of the reading before, or of the oldest one: who walks leaves one transmitter after the other behind.
    fn remember(&mut self, heard: Heard) {
        let full = self.last.len() >= MOST;
        let known = self.last.iter_mut().find(|last| last.transmitter == heard.transmitter);
        if let Some(last) = known {
            *last = heard;
        } else if let Some(oldest) = self.last.iter_mut().min_by_key(|last| last.time).filter(|_| full) {
            *oldest = heard;
        } else {
            self.last.push(heard);
        }
    }

    /// A reading was off by so much, dB, where so much was expected of the place alone, dB².
    pub fn learn(
        &mut self,
        (transmitter, time, way_m): (usize, Time, Vector3<f64>),
        expected: &Expected,
        off_db: f64,
        of_place_db2: f64,
    ) {
        self.remember(Heard { transmitter, time, way_m, off_db });
        let most = MOST_OFF * (self.whole_db2 + of_place_db2);
        let shown = ((off_db * off_db).min(most) - of_place_db2).max(0.0);
        let [whole, parts] = &mut self.learnt;
        *whole = (*whole + 1.0).min(READINGS);
        self.whole_db2 = (self.whole_db2 + (shown - self.whole_db2) / *whole).max(2.0 * LEAST_DB2);
        if expected.alike > ALIKE {
            let differ = off_db - expected.before_db;
            let new = (0.5 * differ * differ).min(most);
            // V − D = ρ σ_s².
            let shadow = (self.whole_db2 - new) / expected.alike;
            *parts = (*parts + 1.0).min(READINGS);
            self.shadow_db2 += (shadow - self.shadow_db2) / *parts;
        }
        self.shadow_db2 = self.shadow_db2.clamp(LEAST_DB2, self.whole_db2 - LEAST_DB2);
    }
}
