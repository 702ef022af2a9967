//! What a sensor said, when, and how well.
//!
//! The types are `no_std`; log files, trajectories as text and sidecars need the feature `std`.
#![cfg_attr(not(feature = "std"), no_std)]

mod imu;

pub use imu::{ImuSample, ImuSpecification, MagneticSample, Observation};
