//! What can be wrong with a scenario.

/// Why a simulation cannot be set up.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimulationError {
    /// A parameter is not a number or outside the range for which the model makes sense.
    #[error("{name} is {found}, expected {expected}")]
    Parameter {
        /// Field name, unit included.
        name: &'static str,
        /// Its value.
        found: f64,
        /// The range in words.
        expected: &'static str,
    },
    /// A name that nothing bears, or a place that cannot be had.
    #[error("{name} is \"{found}\", expected {expected}")]
    Unknown {
        /// Field name.
        name: &'static str,
        /// What stands there.
        found: String,
        /// What would fit, in words.
        expected: &'static str,
    },
}

/// `found` lies between `low` and `high`; not a number lies nowhere.
pub(crate) fn check_within(
    name: &'static str,
    found: f64,
    low: f64,
    high: f64,
    expected: &'static str,
) -> Result<(), SimulationError> {
    if (low..=high).contains(&found) {
        Ok(())
    } else {
        Err(SimulationError::Parameter { name, found, expected })
    }
}
