//! What somebody is told of the start of a walk: the truth, and how wrong it is.

use crate::error::{SimulationError, check_within};
use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::{Vector2, Vector3};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

/// How wrong the start is that somebody is told, σ.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct StartErrors {
    /// Position east and north, m.
    pub position_m: [f64; 2],
    /// Attitude about each level axis, rad.
    pub attitude_rad: f64,
}

/// The start as somebody is told it: the truth with one draw of [`StartErrors`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToldStart {
    /// Position (east, north), level frame of the walk, m.
    pub position_m: Vector2<f64>,
    /// Body to level.
    pub attitude: Attitude,
}

impl StartErrors {
    /// Errors that somebody could make.
    pub fn check(&self) -> Result<(), SimulationError> {
        for sigma in self.position_m {
            check_within("position_m", sigma, 0.0, 1e4, "0 to 10000 m")?;
        }
        check_within("attitude_rad", self.attitude_rad, 0.0, 0.5, "0 to 0.5 rad (28°)")
    }
}

impl ToldStart {
    /// Tells a start: the draws are those of a stream of this seed.
    pub fn draw(
        position_m: &Vector3<f64>,
        attitude: &Attitude,
        errors: &StartErrors,
        seed: u64,
        stream: u64,
    ) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(stream);
        let mut draw = || StandardNormal.sample(&mut rng);
        let [east, north] = errors.position_m;
        let position = Vector2::new(draw() * east, draw() * north);
        let turn: Vector3<f64> = Vector3::new(draw(), draw(), draw()) * errors.attitude_rad;
        Self { position_m: position_m.xy() + position, attitude: attitude::turn_navigation(attitude, &turn) }
    }
}
