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
pub mod learning;
pub mod measures;
mod model;
pub mod network;
pub mod normal_scores;
#[cfg(feature = "train")]
pub mod training;
pub mod window;

pub use error::NlosError;
pub use model::{DataRecord, HeldOutRecord, MOST_CLASSES, Model, NetworkRecord, Probabilities, Record, ScoreRecord};
