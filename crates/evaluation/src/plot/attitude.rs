//! Errors of attitude alone on one page.

use super::canvas;
use super::{DistributionCurve, curve_since_first, curves, phases};
use crate::ape::AttitudeError;
use crate::statistics::Distribution;
use crate::{AttitudeEvaluation, EvaluationError};

/// A part of an attitude error, rad.
type Part = fn(&AttitudeError) -> f64;

/// Heading error with its sign and inclination error over time, and the distribution of both and of the whole angle.
pub fn attitude_figure(evaluation: &AttitudeEvaluation, title: &str) -> Result<String, EvaluationError> {
    let report = &evaluation.report.attitude;
    let (times, unscored) = (&evaluation.times, phases(&evaluation.unmarked, &evaluation.times));
    let over_time = |label: String, part: Part| {
        let degrees = evaluation.errors.iter().map(|error| part(error).to_degrees());
        [curve_since_first(label, times, degrees)]
    };
    let heading =
        over_time(format!("heading, RMSE {:.2}°", report.heading_deg.rmse), |e| e.signed_heading_rad);
    let inclination =
        over_time(format!("inclination, RMSE {:.2}°", report.inclination_deg.rmse), |e| e.inclination_rad);
    canvas::svg((1240, 860), title, |page| {
        let (left, right) = page.split_horizontally(canvas::units(760));
        let panels = left.split_evenly((2, 1));
        let clockwise = "error (°), clockwise above 0";
        curves::over_time(&panels[0], "Heading error over time", clockwise, &heading, &unscored)?;
        curves::over_time(&panels[1], "Inclination error over time", "error (°)", &inclination, &unscored)?;
        curves::distributions(
            &right,
            "Distribution of the errors",
            ("°", "poses"),
            &distributions(evaluation),
        )
    })
}

/// Of the errors that are scored.
fn distributions(evaluation: &AttitudeEvaluation) -> Vec<DistributionCurve> {
    let parts: [(&str, Part); 3] = [
        ("heading", |e| e.heading_rad),
        ("inclination", |e| e.inclination_rad),
        ("whole angle", |e| e.total_rad),
    ];
    parts
        .into_iter()
        .filter_map(|(name, part)| {
            let degrees: Vec<f64> =
                evaluation.judged_errors.iter().map(|error| part(error).to_degrees()).collect();
            let distribution = Distribution::of(&degrees)?;
            let label = format!("{name}, 95 % < {:.2}°", distribution.quantile(0.95));
            Some(DistributionCurve { label, distribution })
        })
        .collect()
}
