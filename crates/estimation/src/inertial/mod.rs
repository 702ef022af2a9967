//! Inertial navigation in the local level frame (east, north, up) with an error-state Kalman filter.

pub mod alignment;
pub mod covariance;
pub mod error_quaternion;
pub mod filter;
pub mod reference_attitude;
pub mod rest;
pub mod smoother;
pub mod strapdown;
