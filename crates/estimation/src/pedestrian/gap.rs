//! What a walker may have done while the log has a gap.

/// Walking speed that a foot may have had over a gap, standard deviation, m/s.
const SPEED_M_S: f64 = 2.0;
/// Rate of turn over a gap, standard deviation, rad/s, and its greatest effect, rad.
const RATE_RAD_S: f64 = 0.5;
const LARGEST_TURN_RAD: f64 = 0.5;

/// Variances, each axis, that a gap adds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnknownMotion {
    /// (m/s)².
    pub velocity: f64,
    /// m².
    pub position: f64,
    /// rad².
    pub attitude: f64,
}

impl UnknownMotion {
    /// Over a gap of this length.
    pub fn over(gap_s: f64) -> Self {
        let velocity = SPEED_M_S * SPEED_M_S;
        let turn = (RATE_RAD_S * gap_s).min(LARGEST_TURN_RAD);
        Self { velocity, position: velocity * gap_s * gap_s, attitude: turn * turn }
    }
}
