//! Positions by the radio of the site, as fixes for the filter.
//!
//! Their errors are alike from one to the next: shadowing belongs to the place, and the body that shadows a tag stays where it is for a
//! while. Readings of one variance v whose errors are a first-order Markov process know the mean as well as (the information `1ᵀ R⁻¹ 1` of the
//! correlation matrix `ρ^|i−j|`)
//!
//! ```text
//! 1 + (n − 1) (1 − ρ) / (1 + ρ),   ρ = exp(−Δs / D − Δt / T)
//! ```
//!
//! independent ones: each but the first counts for the share (1 − ρ)/(1 + ρ), and its covariance grows by that. One that is surer than what came before, of least
//! variance u, also counts for what it is surer by, 1 − √ρ v/u; u is forgotten as the errors change, by √ρ from fix to fix, so that sure and unsure ones in
//! turn count as the sure ones would. Who stands learns little from hearing the same over and over. D is a length of shadowing, or the standard
//! deviation of the fix where that is more: an error of 30 m that comes of far transmitters ends where others are near (Gudmundson 1991 has the
//! exponential of the distance).

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
    /// Least variance lately, m².
    least: f64,
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

    /// Counts a signal that others take.
    pub fn count(&mut self, signal: &SignalStrength) {
        self.listener.count(signal);
    }

    /// Drops what was heard and not yet made a fix of.
    pub fn clear(&mut self) {
        self.listener.clear();
    }

    /// Takes what belongs to the site from others at the same one.
    pub fn share(&mut self, other: &Self) {
        self.listener.share(&other.listener);
    }

    /// Gives up what belongs to the site, until [`Self::share`].
    pub fn detach(&mut self) {
        self.listener.detach();
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
        let (share, least) = last.map_or((1.0, variance), |Last { time, way_m: before_m, least }| {
            let (walked_m, passed_s) = ((way_m - before_m).norm(), (fix.time - time).seconds().abs());
            let exponent = walked_m / alike_m + passed_s / correlation_s;
            let least = least * libm::exp(0.5 * exponent);
            // (1 − ρ)/(1 + ρ), and 1 − √ρ v/u.
            let share = libm::tanh(0.5 * exponent).max(1.0 - variance / least);
            (share.max(LEAST_SHARE), least.min(variance))
        });
        *last = Some(Last { time: fix.time, way_m: *way_m, least });
        (PositionFix { covariance_m2: fix.covariance_m2 / share, ..*fix }, share)
    }
}

/// A fix that repeats the one before is still one: its covariance stays finite.
const LEAST_SHARE: f64 = 1e-3;

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use crate::methods::pdr::PdrParams;
    use crate::radio::RadioSite;
    use adit_core::frames::Position;
    use adit_mine::plan::{Anchor, Grid, MinePlan};
    use alloc::sync::Arc;
    use alloc::vec::Vec;
    use nalgebra::{DMatrix, DVector};

    /// Walks in 2 m and 3 s between fixes; `sigmas` as given.
    fn information(sigmas: &[f64]) -> (f64, PdrRadio) {
        let mut plan = MinePlan::new("one", Grid::Local {});
        plan.anchors.push(Anchor {
            id: "a".into(),
            position_m: Position::new(0.0, 0.0, 0.0),
            range_offset_m: None,
            antenna_delay_ns: None,
            tx_power_dbm: None,
        });
        let mut params =
            PdrParams { site: Some(Arc::new(RadioSite::of_plan(&plan))), ..PdrParams::default() };
        params.radio =
            PdrRadio { correlation_m: 5.0, correlation_sigmas: 0.0, correlation_s: 20.0, ..params.radio };
        let mut fixes = RadioFixes::new(&params).unwrap().unwrap();
        let sum = sigmas.iter().zip(0_i64..).map(|(sigma, k)| {
            let time = Time::from_nanos(k * 3_000_000_000);
            let fix = PositionFix::level(time, Vector2::zeros(), *sigma, FixSource::Wifi);
            let (fix, _) = fixes.weigh(&fix, &Vector2::new(2.0 * k as f64, 0.0));
            1.0 / fix.covariance_m2[(0, 0)]
        });
        (sum.sum(), params.radio)
    }

    #[test]
    fn fixes_add_what_a_markov_process_of_errors_leaves() {
        let sigmas = [3.0; 12];
        let (found, radio) = information(&sigmas);
        let correlation = libm::exp(-2.0 / radio.correlation_m - 3.0 / radio.correlation_s);
        let errors = DMatrix::from_fn(12, 12, |i, j| 9.0 * libm::pow(correlation, i.abs_diff(j) as f64));
        let ones = DVector::from_element(12, 1.0);
        let exact = ones.dot(&(errors.try_inverse().unwrap() * &ones));
        assert!((found - exact).abs() < 1e-12, "{found} {exact}");
    }

    #[test]
    fn sure_and_unsure_fixes_in_turn_count_as_sure_ones_would() {
        let alike = information(&[2.0; 40]).0;
        let turns: Vec<f64> = (0..40).map(|k| if k % 2 == 0 { 2.0 } else { 4.0 }).collect();
        let (in_turn, _) = information(&turns);
        assert!((0.8 * alike..1.2 * alike).contains(&in_turn), "{in_turn} {alike}");
        // One sure fix after many unsure ones counts whole, within what those had told.
        let mut sigmas = [20.0; 20];
        let (before, _) = information(&sigmas[..19]);
        sigmas[19] = 1.0;
        let (found, _) = information(&sigmas);
        assert!((found - before - 1.0).abs() < 0.01, "{found} {before}");
        // Unsure ones after it add next to nothing.
        sigmas.reverse();
        assert!(information(&sigmas).0 < 1.0 + before);
    }

    #[test]
    fn radio_is_used_where_something_is_known_of_it() {
        let mut params = PdrParams::default();
        let site = RadioSite::default();
        assert!(RadioFixes::new(&params).unwrap().is_none(), "nothing is known of a site");
        params.site = Some(Arc::new(site));
        assert!(RadioFixes::new(&params).is_err(), "a site without transmitters");
        params.radio.used = false;
        assert!(RadioFixes::new(&params).unwrap().is_none());
    }
}
