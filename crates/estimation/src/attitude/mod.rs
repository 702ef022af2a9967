//! Which way a tag is turned, from its gyro, accelerometer and magnetometer: adit's own attitude estimator.
//!
//! ```text
//! every sample      gyro → attitude;  force, field and what they depend on → sums in the almost-inertial frame
//! every interval    sums → error-state filter: bounded velocity, rest, magnetic field → feedback
//! ```
//!
//! Between two corrections the attitude follows the gyro alone, so the frame that it spans is inertial but for the drift of
//! a tenth of a second (the idea of VQF: Laidig & Seel 2023, *VQF: Highly accurate IMU orientation estimation with bias
//! estimation and magnetic disturbance rejection*, §3). Where VQF low-passes the specific force in that frame with a fixed
//! time constant, here a Kalman filter weighs it: a person's velocity is bounded, and what the specific force integrates
//! to beyond that is tilt. The sums are exact sufficient statistics of an interval, which makes the filter as cheap as one
//! that runs ten times a second.
//!
//! The error state holds what makes attitudes wrong in practice ([`state`]): gyro bias and scale, accelerometer bias, and
//! for the magnetometer an offset fixed to the body, the field at the place, and the **delay** of the magnetometer against
//! the gyro. The delay is the largest error of all in fast motion: 15 ms at 500 °/s are 7.5° of heading.
//!
//! Frames: body to ENU; heading from magnetic north plus declination, or, without a magnetometer, from the body's x axis at
//! the start. Velocity and field models stand in [`measurement`]; the rejection of disturbed fields in [`disturbance`].

pub mod disturbance;
mod filter;
pub mod interval;
pub mod measurement;
mod params;
pub mod smoother;
pub mod state;

pub use filter::{AttitudeFilter, Forgotten};
pub use params::{AttitudeInitialSigma, AttitudeNoise, AttitudeParams, DisturbanceParams, RestParams};
