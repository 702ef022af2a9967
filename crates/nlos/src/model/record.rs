//! What a model says of itself.

use crate::calibration::Scalings;
use crate::measures::Measures;
use serde::{Deserialize, Serialize};

/// The record of a training; stands in the metadata of the model's file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// Of the file's layout.
    pub version: u32,
    /// The classes it tells apart, in order of its outputs.
    pub classes: Vec<String>,
    /// Names of the features it looks at, in order.
    pub features: Vec<String>,
    /// From the baseline's logits to probabilities.
    pub baseline_scalings: Scalings,
    /// The network, where there is one.
    pub network: Option<NetworkRecord>,
    /// Seed of everything drawn.
    pub seed: u64,
    /// What it was learnt of.
    pub data: Vec<DataRecord>,
    /// How it did on groups held out.
    pub held_out: HeldOutRecord,
    /// What its owners ask to be said of the data.
    pub note: Option<String>,
}

/// How the network was learnt.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NetworkRecord {
    /// From its logits to probabilities.
    pub scalings: Scalings,
    /// Passes over the data.
    pub epochs: u32,
}

/// One set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DataRecord {
    /// Name of the folder or file.
    pub name: String,
    /// Ranges of each class.
    pub ranges: Vec<usize>,
    /// Groups of each class.
    pub groups: Vec<usize>,
    /// Learnt from but never judged on.
    pub only_learnt: bool,
    /// How many folders or files it stands for.
    #[serde(default = "one")]
    pub sets: usize,
}

fn one() -> usize {
    1
}

/// Scores on groups held out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeldOutRecord {
    /// How often some were held out.
    pub folds: usize,
    /// Of the baseline.
    pub baseline: ScoreRecord,
    /// Of the network.
    pub network: Option<ScoreRecord>,
}

/// The figures of [`Measures`] that fit in a line.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScoreRecord {
    /// Share told rightly.
    pub accuracy: f64,
    /// Mean over the classes.
    pub balanced_accuracy: f64,
    /// Mean over the classes.
    pub macro_f1: f64,
    /// Line of sight or not.
    pub binary_accuracy: f64,
    /// Of these two.
    pub binary_balanced_accuracy: f64,
    /// Of "not line of sight".
    pub binary_f1: f64,
    /// Of the probability of line of sight.
    pub calibration_error: f64,
}

impl From<&Measures> for ScoreRecord {
    fn from(measures: &Measures) -> Self {
        // Four digits say more than a few dozen geometries know.
        let round = |value: f64| (value * 1e4).round() / 1e4;
        Self {
            accuracy: round(measures.accuracy),
            balanced_accuracy: round(measures.balanced_accuracy),
            macro_f1: round(measures.macro_f1),
            binary_accuracy: round(measures.binary.accuracy),
            binary_balanced_accuracy: round(measures.binary.balanced_accuracy),
            binary_f1: round(measures.binary.f1),
            calibration_error: round(measures.binary.calibration_error),
        }
    }
}
