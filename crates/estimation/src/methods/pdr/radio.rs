//! Positions by the radio of the site, as fixes for the filter.
//!
//! Their errors are alike from one to the next: shadowing belongs to the place, and the body that shadows a tag stays where it is for a
//! while. Readings whose errors are a first-order Markov process with correlation ρ from one to the next know the mean as well as
//!
//! ```text
//! 1 + (n − 1) (1 − ρ) / (1 + ρ),   ρ = exp(−Δs / D − Δt / T)
//! ```
//!
//! independent ones (the information `1ᵀ R⁻¹ 1` of the AR(1) correlation matrix R; Gudmundson 1991 has the exponential of the distance).
//! So every fix but the first counts for the share (1 − ρ)/(1 + ρ): its covariance is divided by it. Who stands learns little from hearing the
//! same over and over. D is a length of shadowing, or the standard deviation of the fix where that is more: an error of 30 m that comes of far transmitters
//! ends where others are near.

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
    last: [Option<(Time, Vector2<f64>)>; FixSource::ALL.len()],
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

    /// The fix with the covariance with which it adds to those before it; `way_m` is the way walked until then.
    pub fn weigh(&mut self, fix: &PositionFix, way_m: &Vector2<f64>) -> PositionFix {
        let PdrRadio { correlation_m, correlation_sigmas, correlation_s, .. } = self.params;
        let alike_m = correlation_m.max(correlation_sigmas * libm::sqrt(fix.covariance_m2.trace()));
        let last = &mut self.last[fix.source as usize];
        let share = last.map_or(1.0, |(time, before_m)| {
            let (walked_m, passed_s) = ((way_m - before_m).norm(), (fix.time - time).seconds().abs());
            let exponent = walked_m / alike_m + passed_s / correlation_s;
            // (1 − ρ)/(1 + ρ)
            libm::tanh(0.5 * exponent).max(LEAST_SHARE)
        });
        *last = Some((fix.time, *way_m));
        PositionFix { covariance_m2: fix.covariance_m2 / share, ..*fix }
    }
}

/// A fix that repeats the one before is still one: its covariance stays finite.
const LEAST_SHARE: f64 = 1e-3;
