//! A level walk along roadways on the rotating ellipsoid, with position fixes: the world of system S0.
//!
//! 1. [`RoadwayPlan`]: legs (straight at a speed, turn, stand), drawn at random from a seed or given;
//! 2. [`RoadwayWalk`]: pose as a C³ function of time on WGS-84, and what an ideal IMU reads, from Earth-centred
//!    coordinates;
//! 3. [`RoadwayGenerator`]: inertial samples with errors, fixes with noise, truth, and what somebody is told of the start.
//!
//! Random draws are `ChaCha8` of the scenario's seed: stream 0 the IMU errors (order in [`crate::imu_errors`]), 1 the plan,
//! 3 the fixes (east, north each), 4 the start (position east, north, then attitude about east, north, up).

mod generator;
mod plan;
mod walk;

pub use generator::{FixModel, RoadwayGenerator};
pub use plan::{RoadwayLeg, RoadwayPlan, RoadwayRanges};
pub use walk::{EarthState, RoadwayWalk};
