//! Weights of both positions (Jia et al. 2024, eq. 11).
//!
//! ```text
//! Z = ω_u Z_u + ω_p Z_p,   ω_u + ω_p = 1,   ω_u = σ_p² / (σ_p² + n σ_u²)
//! ```
//!
//! `Z_p`: the last fused place and the way since. Its standard deviation grows with that way, `σ_p ← σ_p + share · |way|`: the step of a person who
//! steps longer than the model, and a heading that is off, err in the same direction all along. `σ_u²`: mean of the level variances of the position by UWB. What is in the way stays there:
//! in a blocked environment the errors of epochs that are less than `correlation_s` apart are one error, and each of the n epochs in that time counts for 1/n.
//!
//! What is kept is `Z − way`, not Z: an epoch that comes late is held against the way at its own time.

use super::Environment;
use crate::methods::NoiseParameter;
use crate::settings::{first_unusable, not_negative};
use adit_core::nalgebra::{Matrix2, Vector2};
use adit_core::time::Time;
use serde::{Deserialize, Serialize};

/// Settings of the weights.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FusionParams {
    /// One weight for both axes, as in the paper, or a matrix of them.
    pub weights: Weights,
    /// Error of dead reckoning as a share of the way.
    pub drift_share: f64,
    /// Who does not walk still shifts about: m/√s.
    pub standing_m_sqrt_s: f64,
    /// A position by UWB whose normalised distance squared from the expected one exceeds this pulls no more than one at it.
    pub nis_bound: f64,
    /// Speed over a gap in the inertial samples, standard deviation, m/s.
    pub gap_speed_m_s: f64,
    /// Time over which what is in the way errs the same, s.
    pub correlation_s: f64,
}

/// What `ω_u` and `ω_p` are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Weights {
    /// Numbers, as in the paper.
    Scalar,
    /// Matrices: UWB may know one direction well and the other not, when a single link is clear.
    #[default]
    Matrix,
}

impl Default for FusionParams {
    fn default() -> Self {
        Self {
            weights: Weights::default(),
            drift_share: 0.03,
            standing_m_sqrt_s: 0.05,
            gap_speed_m_s: 1.0,
            correlation_s: 1.0,
            nis_bound: 4.0,
        }
    }
}

impl FusionParams {
    /// What tuning may search.
    pub(super) const NOISE: [NoiseParameter; 4] = [
        NoiseParameter::new("ranges.nlos_sigma_m", 0.1, 20.0),
        NoiseParameter::new("fusion.drift_share", 1e-3, 0.5),
        NoiseParameter::new("fusion.standing_m_sqrt_s", 1e-3, 0.5),
        NoiseParameter::new("fusion.correlation_s", 0.1, 60.0),
    ];

    /// The first setting that cannot be worked with, by name.
    pub(super) fn unusable(&self) -> Option<&'static str> {
        first_unusable(&[
            ("fusion.drift_share", not_negative(self.drift_share)),
            ("fusion.standing_m_sqrt_s", not_negative(self.standing_m_sqrt_s)),
            ("fusion.nis_bound", self.nis_bound > 0.0),
            ("fusion.gap_speed_m_s", not_negative(self.gap_speed_m_s)),
            ("fusion.correlation_s", not_negative(self.correlation_s)),
        ])
    }
}

/// What dead reckoning is to be moved by, and how well that is known.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Fusion {
    params: FusionParams,
    /// From the place of dead reckoning to the fused one, m; `None` until there is one.
    offset_m: Option<Vector2<f64>>,
    covariance_m2: Matrix2<f64>,
    /// Time and place that dead reckoning has come to.
    walked: Option<(Time, Vector2<f64>)>,
    /// Time of the last epoch.
    ranged: Option<Time>,
}

impl Fusion {
    /// Dead reckoning begins at a start of this level variance, m²; `None` where nobody told one.
    pub fn new(params: FusionParams, start_variance_m2: Option<f64>) -> Self {
        Self {
            params,
            offset_m: start_variance_m2.map(|_| Vector2::zeros()),
            covariance_m2: Matrix2::identity() * start_variance_m2.unwrap_or_default(),
            walked: None,
            ranged: None,
        }
    }

    /// Dead reckoning has come to a place; what is earlier changes nothing.
    pub fn walk(&mut self, time: Time, way_m: &Vector2<f64>) {
        let FusionParams { drift_share, standing_m_sqrt_s, gap_speed_m_s, .. } = self.params;
        match self.walked {
            Some((before, _)) if time <= before => return,
            Some((before, from_m)) => {
                let elapsed_s = (time - before).seconds();
                let spread_m = libm::sqrt(0.5 * self.covariance_m2.trace());
                let drift_m = drift_share * (way_m - from_m).norm();
                // Dead reckoning tells of itself once a second at least, but in a gap.
                let gap_m = gap_speed_m_s * (elapsed_s - GAP_S).max(0.0);
                let grown_m2 = drift_m * (drift_m + 2.0 * spread_m)
                    + standing_m_sqrt_s * standing_m_sqrt_s * elapsed_s
                    + gap_m * gap_m;
                self.covariance_m2 += Matrix2::identity() * grown_m2;
            }
            None => {}
        }
        self.walked = Some((time, *way_m));
    }

    /// Takes a position by UWB at the time at which dead reckoning was at `way_m`; returns its weight `ω_u`.
    pub fn observe(
        &mut self,
        time: Time,
        way_m: &Vector2<f64>,
        uwb_m: &Vector2<f64>,
        covariance_m2: &Matrix2<f64>,
        environment: Environment,
    ) -> f64 {
        self.walk(time, way_m);
        let elapsed_s = self.ranged.map_or(f64::INFINITY, |before| (time - before).seconds());
        self.ranged = self.ranged.max(Some(time));
        let alike =
            if environment.is_blocked() { self.params.correlation_s / elapsed_s.max(1e-3) } else { 1.0 };
        let uwb_m2 = covariance_m2 * alike.max(1.0);
        let Some(offset_m) = self.offset_m else {
            self.offset_m = Some(uwb_m - way_m);
            self.covariance_m2 = uwb_m2;
            return 1.0;
        };
        let uwb_m2 = uwb_m2 * self.doubt(&(uwb_m - way_m - offset_m), &uwb_m2);
        let both = match self.params.weights {
            Weights::Scalar => Matrix2::identity() * (0.5 * (self.covariance_m2 + uwb_m2).trace()),
            Weights::Matrix => self.covariance_m2 + uwb_m2,
        };
        let own = match self.params.weights {
            Weights::Scalar => Matrix2::identity() * (0.5 * self.covariance_m2.trace()),
            Weights::Matrix => self.covariance_m2,
        };
        let Some(inverse) = both.try_inverse() else { return 0.0 };
        let weight = own * inverse;
        self.offset_m = Some(offset_m + weight * (uwb_m - way_m - offset_m));
        let left = Matrix2::identity() - weight;
        self.covariance_m2 =
            left * self.covariance_m2 * left.transpose() + weight * uwb_m2 * weight.transpose();
        0.5 * weight.trace()
    }

    /// By how much the variance of a position grows that both covariances do not explain: its pull grows no more beyond the bound (Huber 1964).
    fn doubt(&self, off_m: &Vector2<f64>, uwb_m2: &Matrix2<f64>) -> f64 {
        let inverse = (self.covariance_m2 + uwb_m2).try_inverse();
        let nis = inverse.map_or(0.0, |inverse| (off_m.transpose() * inverse * off_m)[(0, 0)]);
        (nis / self.params.nis_bound).max(1.0)
    }

    /// Where somebody is whom dead reckoning has at `way_m`, m, and the covariance, m²; `None` before the first position.
    pub fn place(&self, way_m: &Vector2<f64>) -> Option<(Vector2<f64>, Matrix2<f64>)> {
        self.offset_m.map(|offset_m| (way_m + offset_m, self.covariance_m2))
    }
}

/// Longest time between two solutions of dead reckoning that is no gap, s.
const GAP_S: f64 = 3.5;
