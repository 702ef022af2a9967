//! Trajectories as TUM text: `t x y z qx qy qz qw`, one pose a line, blanks between.
//!
//! ```text
//! # time_s x_m y_m z_m qx qy qz qw
//! 1511374923.123456789 1.25 -0.5 0 0 0 0.7071067811865476 0.7071067811865476
//! ```
//!
//! - Time is seconds, read and written exactly to the nanosecond; it must rise strictly.
//! - The quaternion is Hamilton, scalar **last**, body to world (z up). Its length must be 1 within 5 %; it is
//!   normalised unless it is 1 to the last bits, so that what was written here reads back bit for bit.
//! - Lines that start with `#` and empty lines are skipped. Gzip is recognised by content, and written by name (`.gz`).
//!
//! Format: TUM RGB-D benchmark (Sturm et al. 2012).

mod reader;
mod writer;

pub use reader::{TumReader, read};
pub(crate) use reader::{attitude_from, collect, trajectory};
pub use writer::{TumWriter, write};
