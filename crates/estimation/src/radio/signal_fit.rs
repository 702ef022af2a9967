//! Robust least squares on signal strengths themselves.
//!
//! The error of a strength is about the same near and far, in decibels; that of the distance made of it grows with the distance and is lopsided.
//! So the fit stays with what was measured:
//!
//! ```text
//! RSSI_i = P_i(‖p − p_i‖) + c + e_i,   e_i ~ Student t_ν(σ_i),   c ~ N(0, σ_c²),   p ~ N(m, S) where an area is known
//! ```
//!
//! The offset c is that of the tag: its antenna, its case, the body that wears it.

use super::gauss_newton::{LANES, Lane, Problem, Residuals, solve};
use super::path_loss::{NEAREST_M, distance_m, fall_db};
use super::{AreaPrior, Emitter, Heard, RadioFix};
use adit_core::nalgebra::Vector2;
use alloc::vec::Vec;

/// What is taken as known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SignalFitParams {
    /// Height of the tag, m.
    pub height_m: f64,
    /// Degrees of freedom of the errors: few for long tails.
    pub dof: f64,
    /// Standard deviation of the tag's own offset, dB.
    pub offset_sigma_db: f64,
    /// Iterations at most.
    pub iterations: usize,
    /// Steps shorter than this end the search, m: far below what a fix is sure of.
    pub small_step_m: f64,
}

impl Default for SignalFitParams {
    fn default() -> Self {
        Self { height_m: 0.0, dof: 4.0, offset_sigma_db: 3.0, iterations: 20, small_step_m: 0.02 }
    }
}

/// The fix by the transmitters heard; `None` of none, or where nothing ties the position down (fewer than three, no prior).
pub fn signal_fit(
    heard: &[Heard<'_>],
    prior: Option<&AreaPrior>,
    params: &SignalFitParams,
) -> Option<RadioFix> {
    if prior.is_none() && heard.len() < 3 {
        return None;
    }
    let start = among_strongest_three(heard)?;
    let problem = Problem {
        dof: params.dof,
        offset_sigma: params.offset_sigma_db,
        small_offset: f64::INFINITY,
        prior,
        iterations: params.iterations,
        small_step_m: params.small_step_m,
    };
    let prepared: Vec<Prepared> =
        heard.chunks(LANES).map(|group| Prepared::new(group, params.height_m)).collect();
    let minimum = solve(
        prepared.len(),
        |group, position, offset| prepared[group].residuals(position, offset),
        (start, 0.0),
        &problem,
    )?;
    Some(RadioFix { position_m: minimum.position_m, covariance_m2: minimum.level_covariance_m2() })
}

/// Some readings with everything that does not change from step to step, over their standard deviation; zero where there is none.
#[derive(Default)]
struct Prepared {
    east_m: Lane,
    north_m: Lane,
    drop_m2: Lane,
    /// Mean at 1 m less the reading.
    level: Lane,
    /// Fall for each unit of ln d², up to the turn and beyond it.
    fall: Lane,
    fall_beyond: Lane,
    /// ln d² at the turn.
    turn: Lane,
    inverse_sigma: Lane,
}

impl Prepared {
    fn new(group: &[Heard<'_>], height_m: f64) -> Self {
        let mut all = Self::default();
        for (k, Heard { emitter, rssi_dbm }) in group.iter().enumerate().take(LANES) {
            let Emitter { position_m, path_loss, sigma_db } = emitter;
            let inverse_sigma = 1.0 / sigma_db;
            let drop = position_m.z - height_m;
            // Of ln d², not of ln d.
            let fall = |at_m: f64| 0.5 * fall_db(path_loss, at_m) * inverse_sigma;
            all.east_m[k] = position_m.x;
            all.north_m[k] = position_m.y;
            all.drop_m2[k] = drop * drop;
            all.level[k] = (path_loss.rssi_at_1m_dbm - rssi_dbm) * inverse_sigma;
            all.fall[k] = fall(0.0);
            all.fall_beyond[k] = fall(f64::INFINITY);
            all.turn[k] =
                path_loss.breakpoint_m.map_or(f64::MAX, |breakpoint_m| 2.0 * libm::log(breakpoint_m));
            all.inverse_sigma[k] = inverse_sigma;
        }
        all
    }

    #[inline]
    fn residuals(&self, position: &Vector2<f64>, offset: f64) -> Residuals {
        let mut all = Residuals { offset: self.inverse_sigma, ..Residuals::default() };
        for k in 0..LANES {
            let (east, north) = (position.x - self.east_m[k], position.y - self.north_m[k]);
            let square = (east * east + north * north + self.drop_m2[k]).max(NEAREST_M * NEAREST_M);
            let log = ln(square);
            let over = (log - self.turn[k]).max(0.0);
            let fall = if over > 0.0 { self.fall_beyond[k] } else { self.fall[k] };
            let by_metre = -2.0 * fall / square;
            all.value[k] = self.level[k] - self.fall[k] * (log - over) - self.fall_beyond[k] * over
                + offset * self.inverse_sigma[k];
            all.east[k] = by_metre * east;
            all.north[k] = by_metre * north;
        }
        all
    }
}

/// Among the three strongest transmitters, nearer to the nearer: a search that begins past a transmitter of a row stays there.
fn among_strongest_three(heard: &[Heard<'_>]) -> Option<Vector2<f64>> {
    let mut best: [Option<&Heard<'_>>; 3] = [None; 3];
    for one in heard.iter().filter(|one| one.rssi_dbm.is_finite()) {
        let place = best.iter().position(|known| known.is_none_or(|known| one.rssi_dbm > known.rssi_dbm));
        if let Some(place) = place {
            best[place..].rotate_right(1);
            best[place] = Some(one);
        }
    }
    let mut total = 0.0;
    let mut sum = Vector2::zeros();
    for one in best.iter().flatten() {
        let range_m = distance_m(&one.emitter.path_loss, one.rssi_dbm);
        let weight = 1.0 / (range_m * range_m);
        sum += one.emitter.position_m.xy() * weight;
        total += weight;
    }
    (total > 0.0).then(|| sum / total)
}

/// Natural logarithm of a number above zero that is not subnormal, right to 1e-9: a fifth of the time of one that is right to the last bit.
///
/// `ln(m 2ᵉ) = e ln 2 + 2 artanh((m − 1)/(m + 1))`, m from √½ to √2.
#[inline]
fn ln(x: f64) -> f64 {
    // √½ as bits: what is subtracted before the exponent is read and added after.
    const HALF_ROOT: u64 = 0x3fe6_a09e_667f_3bcd;
    const ONE: u64 = 0x3ff0_0000_0000_0000;
    // 2⁵², whose last bits count ones.
    const COUNTING: u64 = 0x4330_0000_0000_0000;
    let bits = x.to_bits().wrapping_add(ONE - HALF_ROOT);
    let exponent = f64::from_bits(COUNTING | (bits >> 52)) - (f64::from_bits(COUNTING) + 1023.0);
    let m = f64::from_bits((bits & 0x000f_ffff_ffff_ffff) + HALF_ROOT);
    let s = (m - 1.0) / (m + 1.0);
    let q = s * s;
    let series =
        2.0 + q * (2.0 / 3.0 + q * (2.0 / 5.0 + q * (2.0 / 7.0 + q * (2.0 / 9.0 + q * (2.0 / 11.0)))));
    exponent * core::f64::consts::LN_2 + s * series
}

#[cfg(test)]
mod tests {
    use super::ln;

    #[test]
    fn the_quick_logarithm_is_right_to_a_billionth() {
        for step in -4000..4000 {
            let x = libm::exp(f64::from(step) * 0.01);
            assert!((ln(x) - f64::from(step) * 0.01).abs() < 1e-9, "{x}");
        }
    }
}
