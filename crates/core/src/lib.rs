//! What has exactly one right answer in positioning.
//!
//! Everything here is `no_std`, free of I/O, and shared by every other room of adit: [`time`], [`frames`],
//! [`geodesy`], [`level_frame`], [`attitude`], the [`solution::Solution`] that every method returns, and
//! [`trajectory`] with interpolation.
//!
//! # Conventions, stated once
//! - **Navigation frame n**: local level, right-handed, x east, y north, **z up** (ENU), on the mine grid or on a
//!   local origin. Never z down; logs with a z-down sensor are levelled by gravity.
//! - **Body frame b**: the sensor's own axes, as logged or as turned by the mounting of the sidecar.
//! - **Attitude** `q` = `C_b^n`: Hamilton unit quaternion that turns body coordinates into navigation coordinates.
//!   Errors of attitude are rotation vectors in **n**: `q_true = exp(φ) ∘ q_estimated`.
//! - **Specific force** `f`: what an accelerometer reads; at rest `C_b^n f = (0, 0, +g)`.
//! - **Heading**: angle from north, clockwise seen from above, rad.
//! - Units: SI; angles rad; the unit stands in the name where it is not the SI one or could be doubted.
#![no_std]

extern crate alloc;

pub mod attitude;
pub mod frames;
pub mod geodesy;
pub mod level_frame;
pub mod solution;
pub mod time;
pub mod trajectory;

pub use nalgebra;
