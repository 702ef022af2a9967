//! Positions by the radio of the site, as fixes for the filter.
//!
//! Their errors are alike from one to the next: shadowing belongs to the place, and the body that shadows a tag stays where it is for a
//! while. With a correlation ρ to the fix before, which had the variance u, a fix of variance v adds to what is known of the mean (from the inverse of
//! `[[u, ρ√uv], [ρ√uv, v]]`; Bar-Shalom & Campo 1986 combine tracks so):
//!
//! ```text
//! (1/v) (1 − ρ √(v/u))² / (1 − ρ²),   ρ = exp(−Δs / D − Δt / T);   of equals (1/v) (1 − ρ) / (1 + ρ)
//! ```
//!
//! Its covariance grows by that share. Less sure ones than √u/ρ add nothing, much surer ones count whole: never more than whole, since ρ is a guess. Who stands learns
//! little from hearing the same over and over. D is a length of shadowing, or the standard deviation of the fix where that is more: an
//! error of 30 m that comes of far transmitters ends where others are near (Gudmundson 1991 has the exponential of the distance).

use super::NAME;
use super::params::{PdrParams, PdrRadio};
use crate::methods::MethodError;
use crate::radio::{HeardReport, Listener};
use adit_core::nalgebra::Vector2;
use adit_core::time::Time;
use adit_observation::{FixSource, PositionFix, SignalStrength};
use serde::{Deserialize, Serialize};

/// A listener, and what it said last.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RadioFixes {
    listener: Listener,
    params: PdrRadio,
    /// The last fix used of each source.
    last: [Option<Last>; FixSource::ALL.len()],
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Last {
    time: Time,
    way_m: Vector2<f64>,
    variance: f64,
}

impl RadioFixes {
    /// Where something is known of the site and radio is to be used.
    pub fn new(params: &PdrParams) -> Result<Option<Self>, MethodError> {
        let (params, site) = (params.radio, params.site.as_deref());
        let Some(site) = site.filter(|_| params.used) else { return Ok(None) };
        let listener = Listener::new(NAME, Some(site), params.scan, params.locator)?;
        Ok(Some(Self { listener, params, last: Default::default() }))
    }

    /// Takes a signal.
    pub fn observe(&mut self, signal: &SignalStrength) {
        self.listener.observe(signal);
    }

    /// The next fix that is due.
    pub fn due(&mut self, now: Time) -> Option<PositionFix> {
        self.listener.advance(now);
        self.listener.pop()
    }

    /// After the last observation: the fixes left.
    pub fn finish(&mut self) -> Option<PositionFix> {
        self.listener.finish()
    }

    /// What was heard.
    pub fn report(&self) -> &HeardReport {
        self.listener.report()
    }

    /// The fix with the covariance with which it adds to those before it, and what share of a whole one that is; `way_m` is the way
    /// walked until then.
    pub fn weigh(&mut self, fix: &PositionFix, way_m: &Vector2<f64>) -> (PositionFix, f64) {
        let PdrRadio { correlation_m, correlation_sigmas, correlation_s, .. } = self.params;
        let variance = fix.covariance_m2.trace();
        let alike_m = correlation_m.max(correlation_sigmas * libm::sqrt(variance));
        let last = &mut self.last[fix.source as usize];
        let share = last.map_or(1.0, |Last { time, way_m: before_m, variance: before }| {
            let (walked_m, passed_s) = ((way_m - before_m).norm(), (fix.time - time).seconds().abs());
            let correlation = libm::exp(-walked_m / alike_m - passed_s / correlation_s);
            let own = (1.0 - correlation * libm::sqrt(variance / before)).max(0.0);
            // Two at one time and place: 0/0, of equals no news.
            (own * own / (1.0 - correlation * correlation).max(f64::MIN_POSITIVE)).clamp(LEAST_SHARE, 1.0)
        });
        *last = Some(Last { time: fix.time, way_m: *way_m, variance });
        (PositionFix { covariance_m2: fix.covariance_m2 / share, ..*fix }, share)
    }
}

/// A fix that repeats the one before is still one: its covariance stays finite.
const LEAST_SHARE: f64 = 1e-3;
