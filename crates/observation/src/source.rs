//! The one shape of every log: observations with their place, pulled one at a time.

use crate::error::{At, LogError};
use crate::observation::Observation;
use crate::warning::Warnings;
use std::path::Path;
use std::sync::Arc;

/// A log of any kind, or a stage that checks one. Memory is bounded whatever the length of the log.
pub trait LogSource {
    /// The next observation and where it stands; `None` after the last.
    ///
    /// After an error there is nothing more to come.
    fn next_observation(&mut self, warnings: &mut Warnings) -> Result<Option<(Observation, At)>, LogError>;

    /// The file it comes from.
    fn file(&self) -> &Arc<Path>;
}

impl LogSource for Box<dyn LogSource + Send> {
    fn next_observation(&mut self, warnings: &mut Warnings) -> Result<Option<(Observation, At)>, LogError> {
        (**self).next_observation(warnings)
    }

    fn file(&self) -> &Arc<Path> {
        (**self).file()
    }
}
