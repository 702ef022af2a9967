//! The numbers of a method's settings that say how large its random errors are: what `adit tune` searches.

/// A noise parameter: a setting above zero, searched by its logarithm between its bounds.
///
/// The bounds are those of physics and of the sensors that people wear, not those of a method: from the best sensor that fits into a tag
/// to the worst that is still sold, from a foot that stands like a rock to one on a moving belt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseParameter {
    /// Where it stands in the settings: names with dots between them, as in their TOML.
    pub path: &'static str,
    /// Least value that makes sense.
    pub least: f64,
    /// Largest value that makes sense.
    pub largest: f64,
}

impl NoiseParameter {
    /// A parameter and its bounds.
    pub const fn new(path: &'static str, least: f64, largest: f64) -> Self {
        Self { path, least, largest }
    }
}
