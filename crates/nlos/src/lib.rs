//! # adit-nlos: did the signal come straight?
//!
//! An ultra-wideband range is too long where its signal came through or round something. How it came in tells: [`Model::judge`] turns a reception
//! (diagnostics, impulse response) into probabilities of line of sight (LOS), none (NLOS) and no direct path (NDP),
//! or of what is in the way ([`adit_observation::InTheWay`]).
//!
//! - [`features`]: what can be measured by hand; [`baseline`]: their normal scores and a linear discriminant for each of two or three questions ([`task`]).
//! - [`network`]: convolutions and an LSTM over the response (system S4: Jia et al. 2024), added to the discriminant; learnt with candle (feature `train`), asked by a kernel of our own.
//! - [`calibration`]: probabilities that hold; [`measures`]: how good they are; [`judging`], [`folds`]: on geometries held out, never on ranges drawn at random.
//! - [`annotate`]: ranges judged on their way into a method, what was told of a link before kept in mind ([`LinkFilter`]).
//! - [`learning`]: all of it, from labelled ranges ([`adit_observation::csv_log::labelled`]) to a [`Model`] and its record.
//!
//! Limits: receivers in the terms of a DW1000; ranges of another device have other powers and noise, and want a model of their own.

mod annotation;
pub mod baseline;
pub mod calibration;
pub mod discriminant;
mod error;
pub mod examples;
pub mod features;
pub mod folds;
pub mod judging;
pub mod learning;
mod link_filter;
pub mod measures;
mod model;
pub mod network;
pub mod normal_scores;
pub mod task;
#[cfg(feature = "train")]
pub mod training;
pub mod window;

pub use annotation::{Links, annotate};
pub use error::NlosError;
pub use link_filter::{LinkFilter, Persistence};
pub use model::{
    DataRecord, HeldOutRecord, Model, NetworkRecord, Probabilities, Record, SHIPPED, ScoreRecord,
};
