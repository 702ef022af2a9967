//! # adit-nlos: did the signal come straight?
//!
//! TODO
pub mod baseline;
pub mod calibration;
pub mod discriminant;
mod error;
pub mod examples;
pub mod features;
pub mod folds;
pub mod judging;
pub mod measures;
pub mod normal_scores;
pub mod window;

pub use error::NlosError;
