//! Positioning methods: observations in, solutions and innovations out.
//!
//! - [`attitude`]: which way a tag is turned, from gyro, accelerometer and magnetometer.
//! - [`kalman`]: what every filter shares: the measurement model and its [`kalman::Innovation`].
//! - [`inertial`]: alignment at rest, strapdown integration, the error-state filter and its smoother.
//! - [`magnetic`]: the field as a compass, and when not to believe it.
//! - [`pedestrian`]: what is true of people: when a foot stands still.
//! - [`place`]: what dead reckoning cannot observe, held by everything else: hypotheses of place, heading and scale.
//! - [`radio`]: position from signal strengths and round-trip ranges.
//! - [`ranging`]: position in space from ranges to anchors, as UWB measures them.
//! - [`weighed`]: the last innovation of each anchor and transmitter.
//! - [`methods`]: the published systems and adit's own, each readable whole in one file.
//!
//! Everything takes one observation at a time in bounded memory and is `no_std` + `alloc`.
#![no_std]

extern crate alloc;

pub mod attitude;
pub mod inertial;
pub mod kalman;
pub mod magnetic;
pub mod methods;
pub mod pedestrian;
pub mod place;
pub mod radio;
pub mod ranging;
mod settings;
pub mod weighed;
