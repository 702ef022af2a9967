//! How far somebody went, and how far from the truth they ended.
//!
//! The plain sum of steps between poses grows with noise and rate. The figure to quote is therefore the horizontal
//! length on chords: a pose counts once it is [`CHORD_M`] away from the last one that counted.

use nalgebra::Vector3;
use serde::Serialize;

/// Length of a chord, m: longer than centimetre noise, shorter than a step.
pub const CHORD_M: f64 = 0.25;

/// A truth shorter than this gives no ratio and no share, m.
const SHORTEST_PATH_M: f64 = 1e-9;

/// Sum of the distances in space between successive positions, m (evo's path length).
pub fn summed_length_m(positions_m: &[Vector3<f64>]) -> f64 {
    positions_m.windows(2).map(|two| (two[1] - two[0]).norm()).sum()
}

/// Horizontal length of the path on chords of at least [`CHORD_M`], m.
pub fn chord_length_m(positions_m: &[Vector3<f64>]) -> f64 {
    let Some(first) = positions_m.first() else { return 0.0 };
    let (mut total, mut last) = (0.0, first.xy());
    for position in positions_m {
        let chord = (position.xy() - last).norm();
        if chord >= CHORD_M {
            total += chord;
            last = position.xy();
        }
    }
    total
}

/// Distance travelled, by estimate and truth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Travel {
    /// Horizontal length of the true path on chords, m.
    pub path_truth_m: f64,
    /// Horizontal length of the estimated path on chords, m.
    pub path_estimate_m: f64,
    /// Estimated over true length; none when the truth did not move.
    pub path_ratio: Option<f64>,
    /// Plain sum of the true path in space, m.
    pub path_sum_truth_m: f64,
    /// Plain sum of the estimated path in space, m.
    pub path_sum_estimate_m: f64,
}

impl Travel {
    /// Lengths of two paths that are compared.
    pub fn of(estimate_m: &[Vector3<f64>], truth_m: &[Vector3<f64>]) -> Self {
        let (path_estimate_m, path_truth_m) = (chord_length_m(estimate_m), chord_length_m(truth_m));
        Self {
            path_truth_m,
            path_estimate_m,
            path_ratio: (path_truth_m > SHORTEST_PATH_M).then(|| path_estimate_m / path_truth_m),
            path_sum_truth_m: summed_length_m(truth_m),
            path_sum_estimate_m: summed_length_m(estimate_m),
        }
    }
}

/// Error of the last pose.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FinalError {
    /// Horizontal, m.
    pub end_2d_m: f64,
    /// In space, m.
    pub end_3d_m: f64,
    /// Height, absolute, m.
    pub end_vertical_m: f64,
    /// Horizontal, as a share of the true path on chords; none when the truth did not move.
    pub end_share: Option<f64>,
}

impl FinalError {
    /// From the last error (estimate minus truth, m) and the length of the true path on chords, m.
    pub fn of(last_error_m: &Vector3<f64>, path_truth_m: f64) -> Self {
        let end_2d_m = last_error_m.xy().norm();
        Self {
            end_2d_m,
            end_3d_m: last_error_m.norm(),
            end_vertical_m: last_error_m.z.abs(),
            end_share: (path_truth_m > SHORTEST_PATH_M).then(|| end_2d_m / path_truth_m),
        }
    }
}
