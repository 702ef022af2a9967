//! Absolute errors: where and which way, against the truth, pose by pose.
//!
//! **Position**: `e = estimate − truth` after the alignment; horizontal `|(e_x, e_y)|`, spatial `|e|`, vertical `|e_z|`.
//! The spatial one is evo's APE of the translation part.
//!
//! **Attitude**: `q_e = q_truth ∘ q_estimate⁻¹ = (w, x, y, z)`, an error in the navigation frame, split as Laidig & Seel
//! 2023 (VQF, §4.1) do: total `2 atan2(|(x, y, z)|, |w|)` (evo's APE rotation angle), heading `2 atan(|z| / |w|)`,
//! inclination `2 atan2(|(x, y)|, |(w, z)|)`. The arc tangents keep small angles exact where arc cosines lose them.
//! The heading error with its sign is `2 atan(z / w)`, compass heading of the estimate minus that of the truth.
//!
//! **Circular error probable**: radius about the truth that holds a share of the horizontal errors; empirical, so it is
//! the percentile of the horizontal error.

use crate::association::PosePairs;
use crate::statistics::{Distribution, Statistics};
use adit_core::attitude::Attitude;
use adit_core::time::Time;
use adit_core::trajectory::Trajectory;
use nalgebra::Vector3;
use serde::ser::{Serialize, SerializeMap, Serializer};

/// Position errors over time.
#[derive(Debug, Clone, PartialEq)]
pub struct PositionErrors {
    times: Vec<Time>,
    errors_m: Vec<Vector3<f64>>,
}

impl PositionErrors {
    /// Errors of pairs, as they are: align them first.
    pub fn of(pairs: &PosePairs) -> Self {
        Self {
            times: pairs.truth().iter().map(|pose| pose.time).collect(),
            errors_m: pairs.iter().map(|(e, t)| e.position_m - t.position_m).collect(),
        }
    }

    /// Stamps of the truth.
    pub fn times(&self) -> &[Time] {
        &self.times
    }

    /// Estimate minus truth, m.
    pub fn errors_m(&self) -> &[Vector3<f64>] {
        &self.errors_m
    }

    /// Horizontal distances, m.
    pub fn horizontal_m(&self) -> Vec<f64> {
        self.errors_m.iter().map(|e| e.xy().norm()).collect()
    }

    /// Distances in space, m.
    pub fn spatial_m(&self) -> Vec<f64> {
        self.errors_m.iter().map(Vector3::norm).collect()
    }

    /// Absolute height differences, m.
    pub fn vertical_m(&self) -> Vec<f64> {
        self.errors_m.iter().map(|e| e.z.abs()).collect()
    }

    /// The three series in numbers; `None` when there is no pair.
    pub fn summary(&self) -> Option<PositionStatistics> {
        Some(PositionStatistics {
            horizontal_m: Statistics::of(&self.horizontal_m())?,
            spatial_m: Statistics::of(&self.spatial_m())?,
            vertical_m: Statistics::of(&self.vertical_m())?,
        })
    }
}

/// Radius of the circle about the truth that holds the share `probability` of horizontal errors, m.
pub fn circular_error_probable_m(horizontal: &Distribution, probability: f64) -> f64 {
    horizontal.quantile(probability)
}

/// Angle between two attitudes and its parts, rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AttitudeError {
    /// Angle of the whole rotation, 0 to π.
    pub total_rad: f64,
    /// Part about the vertical, 0 to π.
    pub heading_rad: f64,
    /// Part about a horizontal axis, 0 to π.
    pub inclination_rad: f64,
    /// The heading part with its sign, −π to π: above zero where the estimate points too far clockwise, seen from above.
    pub signed_heading_rad: f64,
}

/// Error of one attitude; both turn body into the same navigation frame.
pub fn attitude_error(estimate: &Attitude, truth: &Attitude) -> AttitudeError {
    let q = (truth * estimate.inverse()).into_inner();
    AttitudeError {
        total_rad: 2.0 * q.imag().norm().atan2(q.w.abs()),
        heading_rad: 2.0 * q.k.abs().atan2(q.w.abs()),
        inclination_rad: 2.0 * q.i.hypot(q.j).atan2(q.w.hypot(q.k)),
        // q and −q are one rotation; its shorter angle is meant.
        signed_heading_rad: 2.0 * (q.k * q.w.signum()).atan2(q.w.abs()),
    }
}

/// Attitude errors of pairs, as they are, one for each pair.
pub fn attitude_errors(pairs: &PosePairs) -> Vec<AttitudeError> {
    pairs.iter().map(|(estimate, truth)| attitude_error(&estimate.attitude, &truth.attitude)).collect()
}

/// Summary of attitude errors, in degrees; `None` when there are none.
pub fn attitude_summary(errors: &[AttitudeError]) -> Option<AttitudeStatistics> {
    let degrees = |part: fn(&AttitudeError) -> f64| -> Option<Statistics> {
        Statistics::of(&errors.iter().map(|e| part(e).to_degrees()).collect::<Vec<_>>())
    };
    Some(AttitudeStatistics {
        total_deg: degrees(|e| e.total_rad)?,
        heading_deg: degrees(|e| e.heading_rad)?,
        inclination_deg: degrees(|e| e.inclination_rad)?,
        heading_bias_deg: heading_bias_rad(errors).to_degrees(),
    })
}

/// The turn about the vertical by which a run is off as a whole, rad, −π to π: above zero where clockwise.
///
/// It is the mean of the headings on the circle, each with the weight that its inclination leaves it: the average of
/// Markley et al. 2007 (eq. 12) among the turns about the vertical, `atan2(Σ c² sin h, Σ c² cos h)`, `c = cos(i/2)`.
pub fn heading_bias_rad(errors: &[AttitudeError]) -> f64 {
    let (mut sine, mut cosine) = (0.0, 0.0);
    for error in errors {
        let weight = (0.5 * error.inclination_rad).cos().powi(2);
        sine += weight * error.signed_heading_rad.sin();
        cosine += weight * error.signed_heading_rad.cos();
    }
    sine.atan2(cosine)
}

/// True when a trajectory turns at all: files of positions alone carry one attitude throughout.
pub fn carries_attitude(trajectory: &Trajectory) -> bool {
    trajectory.poses().windows(2).any(|two| two[0].attitude != two[1].attitude)
}

/// True when any position is not zero: estimates of attitude alone, and truths of attitude alone, carry none.
pub fn carries_position(trajectory: &Trajectory) -> bool {
    trajectory.poses().iter().any(|pose| pose.position_m != Vector3::zeros())
}

/// Summary of position errors.
///
/// In JSON a flat object: `rmse_2d_m`, `mean_2d_m`, …, `sse_2d_m2`, the same with `3d` and `vertical`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PositionStatistics {
    /// Horizontal (`2d`), m.
    pub horizontal_m: Statistics,
    /// In space (`3d`), m.
    pub spatial_m: Statistics,
    /// Height (`vertical`), m.
    pub vertical_m: Statistics,
}

impl Serialize for PositionStatistics {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let parts = [("2d", self.horizontal_m), ("3d", self.spatial_m), ("vertical", self.vertical_m)];
        let mut map = serializer.serialize_map(None)?;
        flat_entries(&mut map, &parts, "m")?;
        map.end()
    }
}

/// Summary of attitude errors.
///
/// In JSON a flat object: `rmse_attitude_deg`, …, `sse_attitude_deg2`, the same with `heading` and `inclination`, and
/// `bias_heading_deg`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AttitudeStatistics {
    /// Whole rotation (`attitude`), degrees.
    pub total_deg: Statistics,
    /// About the vertical (`heading`), degrees.
    pub heading_deg: Statistics,
    /// About a horizontal axis (`inclination`), degrees.
    pub inclination_deg: Statistics,
    /// [`heading_bias_rad`] of the run, degrees: above zero where the estimate points too far clockwise.
    pub heading_bias_deg: f64,
}

impl Serialize for AttitudeStatistics {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let parts = [
            ("attitude", self.total_deg),
            ("heading", self.heading_deg),
            ("inclination", self.inclination_deg),
        ];
        let mut map = serializer.serialize_map(None)?;
        flat_entries(&mut map, &parts, "deg")?;
        map.serialize_entry("bias_heading_deg", &self.heading_bias_deg)?;
        map.end()
    }
}

/// `{statistic}_{part}_{unit}` for every statistic of every part; the sum of squares has the unit squared.
fn flat_entries<M: SerializeMap>(
    map: &mut M,
    parts: &[(&str, Statistics)],
    unit: &str,
) -> Result<(), M::Error> {
    for (part, statistics) in parts {
        for (name, value) in statistics.named() {
            let power = if name == "sse" { "2" } else { "" };
            map.serialize_entry(&format!("{name}_{part}_{unit}{power}"), &value)?;
        }
    }
    Ok(())
}
