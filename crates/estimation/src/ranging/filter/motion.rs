//! How people move between two ranges, in closed form.
//!
//! Level: the velocity is a first-order Gauss–Markov process (Singer 1970 of one order less), `v̇ = −v/T + w`, of standard deviation `σ_v`:
//!
//! ```text
//! Φ = | 1  T(1−φ) |   φ = exp(−Δt/T),   q = 2 σ_v²/T
//!     | 0    φ    |
//! Q = q | T² (Δt − 2T(1−φ) + T/2 (1−φ²))   T²/2 (1−φ)² |
//!       |                                  T/2 (1−φ²)  |
//! ```
//!
//! Where nothing is heard the place is lost as that of a random walk, `σ² → 2 σ_v² T Δt`, not as that of a runaway.
//!
//! Height: the critically damped second-order Gauss–Markov process about a mean (Gelb 1974, §3.8), of standard deviation `σ_h`, its rate `σ_c`, `ω = σ_c/σ_h`:
//!
//! ```text
//! Φ = e^(−ωΔt) | 1+ωΔt    Δt   |    Q = Π − Φ Π Φᵀ,   Π = diag(σ_h², σ_c²)
//!              | −ω²Δt   1−ωΔt |
//! ```
//!
//! It never forgets the mean and never walks away from it: a height that is known, near a mean or free is `σ_h` of millimetres, of a
//! metre or of a kilometre.

use super::params::FilterParams;
use super::state::STATES;
use adit_core::nalgebra::{Matrix2, SVector};

/// Transition and noise of a coordinate and its rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pair {
    transition: Matrix2<f64>,
    /// Q: of the place, of both, of the rate.
    pub noise: [f64; 3],
}

/// Over an interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Motion {
    pub level: Pair,
    pub vertical: Pair,
}

/// Rates stand this far behind their coordinates.
const RATE: usize = 3;

impl Pair {
    /// Carries coordinate `axis` and its rate over the interval.
    pub fn apply(&self, x: &mut SVector<f64, STATES>, axis: usize) {
        let ([place, rate], m) = ([x[axis], x[axis + RATE]], &self.transition);
        x[axis] = m[(0, 0)] * place + m[(0, 1)] * rate;
        x[axis + RATE] = m[(1, 0)] * place + m[(1, 1)] * rate;
    }
}

impl Motion {
    /// Over so many seconds, above zero.
    pub fn over(dt: f64, params: &FilterParams) -> Self {
        Self {
            level: level(dt, params.motion.speed_m_s, params.motion.steady_s),
            vertical: vertical(dt, params.height.told_sigma_m(), params.height.climb_m_s),
        }
    }
}

fn level(dt: f64, speed_m_s: f64, steady_s: f64) -> Pair {
    let (t, lost) = (steady_s, -libm::expm1(-dt / steady_s));
    let density = 2.0 * speed_m_s * speed_m_s / t;
    let twice_lost = lost * (2.0 - lost);
    let place = if dt < 1e-3 * t {
        // The closed form is a difference of numbers that are nearly equal.
        density * dt * dt * dt / 3.0
    } else {
        density * t * t * (dt - 2.0 * t * lost + 0.5 * t * twice_lost)
    };
    let noise = [place, 0.5 * density * t * t * lost * lost, 0.5 * density * t * twice_lost];
    Pair { transition: Matrix2::new(1.0, t * lost, 0.0, 1.0 - lost), noise }
}

fn vertical(dt: f64, sigma_m: f64, climb_m_s: f64) -> Pair {
    let rate = climb_m_s / sigma_m;
    let turn = rate * dt;
    let left = libm::exp(-turn);
    let transition = Matrix2::new(1.0 + turn, dt, -rate * turn, 1.0 - turn) * left;
    let kept = Matrix2::from_diagonal(&[sigma_m * sigma_m, climb_m_s * climb_m_s].into());
    let anew = kept - transition * kept * transition.transpose();
    let noise = if turn < 1e-3 {
        let density = 4.0 * rate * climb_m_s * climb_m_s;
        [density * dt * dt * dt / 3.0, 0.5 * density * dt * dt, density * dt]
    } else {
        [anew[(0, 0)], anew[(0, 1)], anew[(1, 1)]]
    };
    Pair { transition, noise }
}
