//! Plane geometry in metres, on coordinates of a mine: up to 10⁷ m with millimetres behind the point.
//!
//! Everything is taken relative to a nearby point first, so that large eastings cost no digits. [`TOUCH_M`] decides what
//! touches: surveys end at the millimetre, a thousandth of that is contact.

pub mod plane;
pub mod polygon;
pub mod polyline;
pub mod spans;

/// What is closer than this touches, m.
pub const TOUCH_M: f64 = 1e-6;
