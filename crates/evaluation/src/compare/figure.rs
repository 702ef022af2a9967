//! The figure by which runs are judged: one number of each run.

use super::run::RunErrors;
use crate::statistics::Distribution;
use serde::{Deserialize, Serialize};

/// One number of a run, of its errors at the judged moments; less is better.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Figure {
    /// Root mean square of the horizontal errors, m.
    #[serde(rename = "rmse-2d")]
    Rmse2d,
    /// Mean of the horizontal errors, m.
    #[serde(rename = "mean-2d")]
    Mean2d,
    /// Median of the horizontal errors, m.
    #[serde(rename = "median-2d")]
    Median2d,
    /// Horizontal error that 95 % of the moments do not exceed, m.
    #[serde(rename = "p95-2d")]
    P95At2d,
    /// Largest horizontal error, m.
    #[serde(rename = "largest-2d")]
    Largest2d,
    /// Horizontal error at the last moment, m.
    #[serde(rename = "end-2d")]
    End2d,
    /// Root mean square of the errors in space, m.
    #[serde(rename = "rmse-3d")]
    Rmse3d,
    /// Median of the errors in space, m.
    #[serde(rename = "median-3d")]
    Median3d,
    /// Error in space at the last moment, m.
    #[serde(rename = "end-3d")]
    End3d,
    /// Root mean square of the whole angle between attitudes, degrees.
    #[serde(rename = "rmse-attitude")]
    RmseAttitude,
    /// Root mean square of the heading errors, degrees.
    #[serde(rename = "rmse-heading")]
    RmseHeading,
}

impl Figure {
    /// Of one run; `None` where it does not have such errors.
    pub fn of(self, run: &RunErrors) -> Option<f64> {
        let errors = self.errors(run);
        if errors.is_empty() {
            return None;
        }
        let count = errors.len() as f64;
        let quantile = |share| Distribution::of(&errors).map(|errors| errors.quantile(share));
        match self {
            Self::Rmse2d | Self::Rmse3d | Self::RmseAttitude | Self::RmseHeading => {
                Some((errors.iter().map(|error| error * error).sum::<f64>() / count).sqrt())
            }
            Self::Mean2d => Some(errors.iter().sum::<f64>() / count),
            Self::Median2d | Self::Median3d => quantile(0.5),
            Self::P95At2d => quantile(0.95),
            Self::Largest2d => quantile(1.0),
            Self::End2d | Self::End3d => errors.last().copied(),
        }
    }

    /// The errors that it sums up, in order of time; none below zero.
    pub fn errors(self, run: &RunErrors) -> Vec<f64> {
        let absolute = |values: &[f32]| values.iter().map(|value| f64::from(value.abs())).collect();
        match self {
            Self::Rmse3d | Self::Median3d | Self::End3d => run.spatial_m().collect(),
            Self::RmseAttitude => absolute(&run.attitude_deg),
            Self::RmseHeading => absolute(&run.heading_deg),
            _ => run.horizontal_m().collect(),
        }
    }

    /// Its unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::RmseAttitude | Self::RmseHeading => "°",
            _ => "m",
        }
    }

    /// What it is, in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Rmse2d => "2D RMSE",
            Self::Mean2d => "2D mean",
            Self::Median2d => "2D median",
            Self::P95At2d => "2D 95 %",
            Self::Largest2d => "2D largest",
            Self::End2d => "2D at the end",
            Self::Rmse3d => "3D RMSE",
            Self::Median3d => "3D median",
            Self::End3d => "3D at the end",
            Self::RmseAttitude => "attitude RMSE",
            Self::RmseHeading => "heading RMSE",
        }
    }
}
