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

use super::gauss_newton::{Problem, Residual, solve};
use super::path_loss::{NEAREST_M, fall_db, mean_of_square_dbm};
use super::{AreaPrior, Heard, RadioFix, centroid};
use adit_core::nalgebra::Vector3;

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
}

impl Default for SignalFitParams {
    fn default() -> Self {
        Self { height_m: 0.0, dof: 4.0, offset_sigma_db: 3.0, iterations: 20 }
    }
}

/// The fix by the transmitters heard; `None` of none, or where nothing ties the position down (fewer than three, no prior).
pub fn signal_fit(heard: &[Heard<'_>], prior: Option<&AreaPrior>, params: &SignalFitParams) -> Option<RadioFix> {
    if prior.is_none() && heard.len() < 3 {
        return None;
    }
    let start = centroid::centroid(heard, centroid::CentroidWeight::InverseRange)?.position_m;
    let problem = Problem {
        dof: params.dof,
        offset_sigma: params.offset_sigma_db,
        prior,
        iterations: params.iterations,
    };
    let residual = |index: usize, position: &adit_core::nalgebra::Vector2<f64>, offset: f64| {
        let Heard { emitter, rssi_dbm } = &heard[index];
        let model = &emitter.path_loss;
        let away = position - emitter.position_m.xy();
        let drop = emitter.position_m.z - params.height_m;
        let square = (away.norm_squared() + drop * drop).max(NEAREST_M * NEAREST_M);
        let inverse_sigma = 1.0 / emitter.sigma_db;
        let fall = match model.breakpoint_m {
            None => fall_db(model, 0.0),
            Some(_) => fall_db(model, libm::sqrt(square)),
        };
        let gradient = away * (-fall * inverse_sigma / square);
        Residual {
            value: (mean_of_square_dbm(model, square) + offset - rssi_dbm) * inverse_sigma,
            gradient: Vector3::new(gradient.x, gradient.y, inverse_sigma),
        }
    };
    let minimum = solve(heard.len(), residual, start, &problem)?;
    Some(RadioFix { position_m: minimum.position_m, covariance_m2: minimum.covariance_m2 })
}
