//! What a faultless IMU would read.
//!
//! `f^b = C_n^b (a + 2 ω_ie × v − g)`, `ω_ib^b = ω_nb^b + C_n^b ω_ie`, with `ω_ie = Ω (0, cos L, sin L)` in ENU
//! (Groves 2013, eq. 2.123 and 5.53 resolved in a local frame). The navigation frame is taken as flat: the transport
//! rate of a walker, 2e-7 rad/s, is left out, and gravity (centrifugal part included) is one value straight down.
//!
//! A sample with [`Sampling::Averaged`] is the mean over its interval of rate and of specific force, each in the body
//! axes of its moment, as an integrating MEMS sensor delivers them: `Δθ = ω̄ Δt` without coning, `Δv = f̄ Δt` without
//! sculling, which are left to the strapdown, as with a real device that does not compensate internally. The
//! mean is taken by four-point Gauss–Legendre quadrature of the closed form on either half of the interval; its error
//! over 5 ms stays below 1e-3 m/s² and 1e-5 rad/s at a runner's heel strike and is far less elsewhere.
//! [`Sampling::Instantaneous`] reads at the end of the interval.

use crate::error::SimulationError;
use crate::motion::{Motion, MotionState};
use adit_core::geodesy::EARTH_RATE_RAD_S;
use adit_core::nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// How a sample comes from the continuous motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sampling {
    /// Mean over the interval that ends at the stamp.
    #[default]
    Averaged,
    /// Value at the stamp.
    Instantaneous,
}

/// Rate and specific force, body axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inertial {
    /// Angular rate of the body against inertial space, rad/s.
    pub angular_rate_rad_s: Vector3<f64>,
    /// Specific force, m/s².
    pub specific_force_m_s2: Vector3<f64>,
}

/// An IMU without errors at one place on Earth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IdealImu {
    /// Gravity, m/s², straight down.
    pub gravity_m_s2: f64,
    /// Latitude for the Earth's rotation, rad; none = an Earth at rest.
    pub latitude_rad: Option<f64>,
    /// How samples come from the motion.
    pub sampling: Sampling,
}

/// Standard gravity, m/s² (3rd CGPM, 1901).
pub const STANDARD_GRAVITY_M_S2: f64 = 9.80665;

/// Nodes (share of the interval) and weights of the four-point Gauss–Legendre rule on [0, 1].
const GAUSS_LEGENDRE: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// Times and weights (sum 1) of the mean of a smooth function from `start_s` to `end_s`: [`GAUSS_LEGENDRE`] on either half.
pub(crate) fn quadrature(start_s: f64, end_s: f64) -> impl Iterator<Item = (f64, f64)> {
    [0.0, 0.5].into_iter().flat_map(move |half| {
        GAUSS_LEGENDRE
            .map(|(share, weight)| (start_s + (half + 0.5 * share) * (end_s - start_s), 0.5 * weight))
    })
}

impl Default for IdealImu {
    /// Standard gravity, averaged samples, at 35.4° N: the Xinglongzhuang mine of spec S2.
    fn default() -> Self {
        Self { gravity_m_s2: STANDARD_GRAVITY_M_S2, latitude_rad: Some(0.618), sampling: Sampling::Averaged }
    }
}

impl IdealImu {
    /// Gravity and latitude are those of this Earth.
    pub fn check(&self) -> Result<(), SimulationError> {
        if !(9.0..=10.5).contains(&self.gravity_m_s2) {
            return Err(SimulationError::Parameter {
                name: "gravity_m_s2",
                found: self.gravity_m_s2,
                expected: "9 to 10.5 m/s²",
            });
        }
        match self.latitude_rad {
            Some(latitude) if !(-1.571..=1.571).contains(&latitude) => Err(SimulationError::Parameter {
                name: "latitude_rad",
                found: latitude,
                expected: "-π/2 to π/2 rad",
            }),
            _ => Ok(()),
        }
    }

    /// Rotation of the Earth in ENU, rad/s.
    pub fn earth_rate_rad_s(&self) -> Vector3<f64> {
        self.latitude_rad.map_or_else(Vector3::zeros, |latitude| {
            let (sin, cos) = libm::sincos(latitude);
            Vector3::new(0.0, cos, sin) * EARTH_RATE_RAD_S
        })
    }

    /// The reading at one moment.
    pub fn instant(&self, state: &MotionState) -> Inertial {
        let earth = self.earth_rate_rad_s();
        let reaction = Vector3::z() * self.gravity_m_s2;
        let force = state.acceleration_m_s2 + 2.0 * earth.cross(&state.velocity_m_s) + reaction;
        Inertial {
            angular_rate_rad_s: state.angular_rate_rad_s + state.attitude.inverse_transform_vector(&earth),
            specific_force_m_s2: state.attitude.inverse_transform_vector(&force),
        }
    }

    /// The sample over the interval from `start_s` to `end_s` of the motion.
    pub fn sample(&self, motion: &impl Motion, start_s: f64, end_s: f64) -> Inertial {
        if self.sampling == Sampling::Instantaneous {
            return self.instant(&motion.at(end_s));
        }
        let mut mean =
            Inertial { angular_rate_rad_s: Vector3::zeros(), specific_force_m_s2: Vector3::zeros() };
        for (time_s, weight) in quadrature(start_s, end_s) {
            let inertial = self.instant(&motion.at(time_s));
            mean.angular_rate_rad_s += weight * inertial.angular_rate_rad_s;
            mean.specific_force_m_s2 += weight * inertial.specific_force_m_s2;
        }
        mean
    }
}
