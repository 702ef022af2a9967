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
}
