//! How a signal falls off with distance: log-distance, and two slopes for tunnels.
//!
//! ```text
//! P(d) = P₁ − 10 n log₁₀ d                                  d ≤ b
//! P(d) = P₁ − 10 n log₁₀ b − 10 m log₁₀(d / b)              d > b
//! ```
//!
//! Rappaport 2002, *Wireless Communications*, eq. 4.67; two slopes as in tunnels: Zhang, Zheng, Sheng 2001, *Radio propagation at
//! 900 MHz in underground coal mines*. Nearer than [`NEAREST_M`] the model is held: no antenna is a point.

use adit_mine::plan::PathLoss;

/// The model is constant nearer than this, m.
pub const NEAREST_M: f64 = 0.3;
/// The farthest distance that a weak signal is turned into, m.
pub const FARTHEST_M: f64 = 1e4;
/// ln 10 / 10: decibels to natural logarithms.
const LN_PER_DB: f64 = core::f64::consts::LN_10 / 10.0;

/// Mean signal strength at a distance, dBm.
#[inline]
pub fn mean_dbm(model: &PathLoss, distance_m: f64) -> f64 {
    mean_of_square_dbm(model, distance_m * distance_m)
}

/// The same of the squared distance, m²: no root is needed.
#[inline]
pub fn mean_of_square_dbm(model: &PathLoss, square_m2: f64) -> f64 {
    let log = 0.5 * libm::log(square_m2.max(NEAREST_M * NEAREST_M)) / LN_PER_DB;
    match second_slope(model) {
        None => model.rssi_at_1m_dbm - model.exponent * log,
        Some((breakpoint_m, beyond)) => {
            let turn = libm::log(breakpoint_m) / LN_PER_DB;
            let over = (log - turn).max(0.0);
            model.rssi_at_1m_dbm - model.exponent * (log - over) - beyond * over
        }
    }
}

/// How fast it falls: decibels for each e-fold of distance, above zero.
#[inline]
pub fn fall_db(model: &PathLoss, distance_m: f64) -> f64 {
    let exponent = match second_slope(model) {
        Some((breakpoint_m, beyond)) if distance_m > breakpoint_m => beyond,
        _ => model.exponent,
    };
    exponent.max(0.01) / LN_PER_DB
}

/// The distance at which the mean is this signal strength, m: [`NEAREST_M`] to [`FARTHEST_M`].
pub fn distance_m(model: &PathLoss, rssi_dbm: f64) -> f64 {
    let lost = model.rssi_at_1m_dbm - rssi_dbm;
    let reach = |lost: f64, exponent: f64| libm::exp(LN_PER_DB * lost / exponent.max(0.01));
    let near = reach(lost, model.exponent);
    let distance = match second_slope(model) {
        Some((breakpoint_m, beyond)) if near > breakpoint_m => {
            let lost_beyond = lost - model.exponent * libm::log(breakpoint_m) / LN_PER_DB;
            breakpoint_m * reach(lost_beyond, beyond)
        }
        _ => near,
    };
    // NaN becomes the farthest: nothing is known.
    if distance < FARTHEST_M { distance.max(NEAREST_M) } else { FARTHEST_M }
}

fn second_slope(model: &PathLoss) -> Option<(f64, f64)> {
    match (model.breakpoint_m, model.exponent_beyond) {
        (Some(breakpoint_m), Some(beyond)) if breakpoint_m > 0.0 => Some((breakpoint_m, beyond)),
        _ => None,
    }
}
