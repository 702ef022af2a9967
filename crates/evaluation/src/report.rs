//! The numbers of an evaluation, for machines (JSON by serde) and for eyes (a table by `Display`).
//!
//! Field names are stable and carry their unit. The JSON object is flat but for the settings and lists:
//!
//! | fields | meaning |
//! |---|---|
//! | `association`, `alignment` | what was done before errors were taken; a figure means nothing without |
//! | `poses_estimate`, `poses_truth`, `poses_unmarked`, `poses_compared`, `covered_share`, `duration_s` | what was compared |
//! | `{rmse,mean,median,p90,p95,max,min,std}_{2d,3d,vertical}_m`, `sse_…_m2` | absolute position errors |
//! | `cep50_m`, `cep95_m` | radius about the truth that holds 50 %, 95 % of the horizontal errors |
//! | `{rmse,…}_{attitude,heading,inclination}_deg`, `sse_…_deg2`, `bias_heading_deg` | attitude errors; absent when not judged |
//! | `end_2d_m`, `end_3d_m`, `end_vertical_m`, `end_share` | error of the last pose, share of the true path |
//! | `path_truth_m`, `path_estimate_m`, `path_ratio` | horizontal distance travelled on 0.25 m chords |
//! | `path_sum_truth_m`, `path_sum_estimate_m` | plain sum of steps in space |
//! | `rpe` | list of `{delta, delta_unit, selection, frame, pairs, translation_m, angle_deg}`, statistics or null |
//! | `nees` | `{horizontal, position, attitude}` of [`crate::consistency::RunNees`]; null without covariance |

use crate::alignment::{Alignment, RigidMotion};
use crate::ape::{AttitudeStatistics, PositionStatistics};
use crate::association::Association;
use crate::consistency::{RunNees, SolutionNees};
use crate::rpe::{Delta, Frame, Selection};
use crate::statistics::Statistics;
use crate::travel::{FinalError, Travel};
use serde::Serialize;
use std::fmt;

/// The numbers of an evaluation; JSON as the table of the module.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EvaluationReport {
    /// How poses were paired.
    pub association: Association,
    /// What was taken away before absolute errors were taken.
    pub alignment: AppliedAlignment,
    /// Poses of the estimate.
    pub poses_estimate: usize,
    /// Poses of the truth.
    pub poses_truth: usize,
    /// Poses of the truth that it does not mark, left out.
    pub poses_unmarked: usize,
    /// Pairs compared.
    pub poses_compared: usize,
    /// Share of the judged poses of the truth that were compared, 0 to 1.
    pub covered_share: f64,
    /// Time from the first to the last pair, s.
    pub duration_s: f64,
    /// Absolute position errors.
    #[serde(flatten)]
    pub position: PositionStatistics,
    /// Radius about the truth that holds half of the horizontal errors, m.
    pub cep50_m: f64,
    /// Radius about the truth that holds 95 % of the horizontal errors, m.
    pub cep95_m: f64,
    /// Attitude errors, when judged.
    #[serde(flatten)]
    pub attitude: Option<AttitudeStatistics>,
    /// Error of the last pose.
    #[serde(flatten)]
    pub end: FinalError,
    /// Distance travelled.
    #[serde(flatten)]
    pub travel: Travel,
    /// Relative errors, one entry for each delta.
    #[serde(rename = "rpe")]
    pub relative: Vec<RelativeReport>,
    /// Consistency of the covariance, when given.
    pub nees: Option<SolutionNees>,
}

/// The alignment asked for and the motion found.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AppliedAlignment {
    /// Kind of alignment.
    pub method: Alignment,
    /// Distance that gave the heading, m; for `start` only.
    pub start_distance_m: Option<f64>,
    /// Angle of the rotation, degrees, 0 to 180.
    pub rotation_deg: f64,
    /// Turn about the vertical, counter-clockwise seen from above, degrees.
    pub yaw_deg: f64,
    /// Translation `t` of `x ↦ R x + t`, m.
    pub translation_m: [f64; 3],
    /// What the point moved by that the alignment lays on its true place (start or centre of the run), m: unlike the
    /// translation it does not grow with the distance from the origin of the grid.
    pub moved_m: [f64; 3],
}

impl AppliedAlignment {
    /// From the settings and the motion found.
    pub fn new(method: Alignment, start_distance_m: f64, motion: &RigidMotion) -> Self {
        Self {
            method,
            start_distance_m: (method == Alignment::Start).then_some(start_distance_m),
            rotation_deg: motion.rotation.angle().to_degrees(),
            yaw_deg: motion.rotation.euler_angles().2.to_degrees(),
            translation_m: motion.translation_m().into(),
            moved_m: (motion.to_m - motion.from_m).into(),
        }
    }
}

/// Relative errors over one delta.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RelativeReport {
    /// Delta and its unit.
    #[serde(flatten)]
    pub delta: Delta,
    /// Which pairs were taken.
    pub selection: Selection,
    /// Axes in which displacements were compared.
    pub frame: Frame,
    /// Number of pairs; 0 when the path is shorter than the delta.
    pub pairs: usize,
    /// Translation part, m.
    pub translation_m: Option<Statistics>,
    /// Rotation angle, degrees; none when attitudes were not judged.
    pub angle_deg: Option<Statistics>,
}

impl fmt::Display for Association {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Interpolate { .. } => f.write_str("estimate interpolated at the truth's stamps"),
            Self::Nearest { max_difference } => {
                write!(f, "nearest stamps within {} s", max_difference.seconds())
            }
        }
    }
}

impl fmt::Display for AppliedAlignment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.moved_m;
        match (self.method, self.start_distance_m) {
            (Alignment::None, _) => return f.write_str("none"),
            (method, Some(distance)) => write!(f, "{method} (heading over {distance} m)")?,
            (method, None) => write!(f, "{method}")?,
        }
        let turn = if self.method == Alignment::Se3 { self.rotation_deg } else { self.yaw_deg };
        write!(f, ": turned {turn:.2}°, moved ({x:.3}, {y:.3}, {z:.3}) m")
    }
}

impl fmt::Display for EvaluationReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let coverage = Coverage {
            association: &self.association,
            poses_truth: self.poses_truth,
            poses_unmarked: self.poses_unmarked,
            poses_compared: self.poses_compared,
            covered_share: self.covered_share,
            duration_s: self.duration_s,
        };
        write!(f, "{coverage}")?;
        writeln!(f, "aligned     {}", self.alignment)?;
        writeln!(f)?;
        head_row(f)?;
        row(f, "position 2D", "m", &self.position.horizontal_m)?;
        row(f, "position 3D", "m", &self.position.spatial_m)?;
        row(f, "vertical", "m", &self.position.vertical_m)?;
        if let Some(attitude) = &self.attitude {
            attitude_rows(f, attitude)?;
        }
        for relative in &self.relative {
            relative_rows(f, relative)?;
        }
        writeln!(f)?;
        self.attitude.iter().try_for_each(|attitude| bias_line(f, attitude))?;
        self.end_lines(f)?;
        self.nees.iter().try_for_each(|nees| nees_lines(f, nees))
    }
}

/// What was compared, for eyes.
pub(crate) struct Coverage<'a> {
    pub association: &'a Association,
    pub poses_truth: usize,
    pub poses_unmarked: usize,
    pub poses_compared: usize,
    pub covered_share: f64,
    pub duration_s: f64,
}

impl fmt::Display for Coverage<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "associated  {}", self.association)?;
        let (compared, seconds, percent) = (self.poses_compared, self.duration_s, self.covered_share * 100.0);
        if self.poses_unmarked == 0 {
            return writeln!(
                f,
                "compared    {compared} poses over {seconds:.1} s, {percent:.1} % of the truth"
            );
        }
        let (truth, marked) = (self.poses_truth, self.poses_truth - self.poses_unmarked);
        writeln!(
            f,
            "scored      {marked} of {truth} rows of the truth: those that its column `moving` marks"
        )?;
        writeln!(f, "compared    {compared} poses over {seconds:.1} s, {percent:.1} % of these rows")
    }
}

impl EvaluationReport {
    fn end_lines(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "end error   2D {:.3} m, vertical {:.3} m", self.end.end_2d_m, self.end.end_vertical_m)?;
        if let Some(share) = self.end.end_share {
            write!(f, ", 2D {:.2} % of the path", share * 100.0)?;
        }
        writeln!(f)?;
        write!(
            f,
            "distance    estimate {:.2} m, truth {:.2} m",
            self.travel.path_estimate_m, self.travel.path_truth_m
        )?;
        if let Some(ratio) = self.travel.path_ratio {
            write!(f, ", ratio {ratio:.4}")?;
        }
        writeln!(f)?;
        writeln!(f, "circle      50 % within {:.3} m, 95 % within {:.3} m", self.cep50_m, self.cep95_m)
    }
}

pub(crate) fn head_row(f: &mut fmt::Formatter<'_>) -> fmt::Result {
    write!(f, "{:<22}", "error")?;
    for name in ["rmse", "mean", "median", "p90", "p95", "max", "std"] {
        write!(f, "{name:>10}")?;
    }
    writeln!(f)
}

pub(crate) fn attitude_rows(f: &mut fmt::Formatter<'_>, attitude: &AttitudeStatistics) -> fmt::Result {
    row(f, "attitude", "°", &attitude.total_deg)?;
    row(f, "heading", "°", &attitude.heading_deg)?;
    row(f, "inclination", "°", &attitude.inclination_deg)
}

pub(crate) fn bias_line(f: &mut fmt::Formatter<'_>, attitude: &AttitudeStatistics) -> fmt::Result {
    let bias = attitude.heading_bias_deg;
    let way = if bias < 0.0 { "counter-clockwise" } else { "clockwise" };
    writeln!(f, "heading     {:.2}° too far {way} over the run", bias.abs())
}

fn row(f: &mut fmt::Formatter<'_>, name: &str, unit: &str, s: &Statistics) -> fmt::Result {
    write!(f, "{name:<20}{unit:<2}")?;
    for value in [s.rmse, s.mean, s.median, s.p90, s.p95, s.max, s.std] {
        write!(f, "{value:>10.3}")?;
    }
    writeln!(f)
}

fn relative_rows(f: &mut fmt::Formatter<'_>, relative: &RelativeReport) -> fmt::Result {
    let name = format!("RPE {}", relative.delta);
    match &relative.translation_m {
        Some(translation) => row(f, &name, "m", translation)?,
        None => writeln!(f, "{name:<20}m  the path is shorter")?,
    }
    relative.angle_deg.iter().try_for_each(|angle| row(f, &name, "°", angle))
}

pub(crate) fn nees_lines(f: &mut fmt::Formatter<'_>, nees: &SolutionNees) -> fmt::Result {
    let parts = [("horizontal", nees.horizontal), ("position", nees.position), ("attitude", nees.attitude)];
    for (name, part) in parts {
        let Some(RunNees { dimension, mean, bounds, probability, share_inside, .. }) = part else { continue };
        writeln!(
            f,
            "NEES        {name}: mean {mean:.2}, ideal {dimension}; {:.1} % of samples within {:.2} to {:.2}, ideal {:.0} %",
            share_inside * 100.0,
            bounds.lower,
            bounds.upper,
            probability * 100.0
        )?;
    }
    Ok(())
}
