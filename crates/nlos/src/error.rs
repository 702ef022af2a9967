//! Why a classifier cannot be learnt, read or asked.

use adit_observation::LogError;
use std::path::PathBuf;

/// Why a classifier cannot be learnt, read or asked: what was found, what is expected.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NlosError {
    /// The data cannot be read.
    #[error(transparent)]
    Log(#[from] LogError),
    /// A class has too few geometries to hold some out.
    #[error(
        "{found} geometries of class {class}, expected {expected} or more: what is learnt of one place is judged at another"
    )]
    TooFewGroups {
        /// The class.
        class: &'static str,
        /// Its geometries.
        found: usize,
        /// What is needed.
        expected: usize,
    },
    /// No diagnostic and no response is told in most of the rows.
    #[error("most ranges tell neither diagnostics nor an impulse response: there is nothing to learn from")]
    NoFeatures,
    /// The file is no model of ours.
    #[error("{name}: {what}")]
    Model {
        /// The file.
        name: String,
        /// What is wrong with it.
        what: String,
    },
    /// A network asks for impulse responses that the data does not have.
    #[error("{}: row {row} has no impulse response around its first path, which the network of this model looks at", file.display())]
    NoResponse {
        /// The set.
        file: PathBuf,
        /// The row, from 1.
        row: usize,
    },
    /// The features of the training data do not vary together as any covariance does.
    #[error("the covariance of the features cannot be inverted: does any of them vary?")]
    Degenerate,
    /// Training went wrong.
    #[cfg(feature = "train")]
    #[error("training: {0}")]
    Candle(#[from] candle_core::Error),
}
