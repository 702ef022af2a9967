//! Checks of settings, the same for every method.

pub fn positive(value: f64) -> bool {
    value.is_finite() && value > 0.0
}

pub fn not_negative(value: f64) -> bool {
    value.is_finite() && value >= 0.0
}

/// The first setting that cannot be worked with, by name.
pub fn first_unusable(checks: &[(&'static str, bool)]) -> Option<&'static str> {
    checks.iter().find(|(_, usable)| !usable).map(|(name, _)| *name)
}
