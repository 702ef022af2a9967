//! Figures as SVG text: the path over the truth, errors over time, their distribution.
//!
//! One visual language, that of the console: its colours and type, light or dark as the viewer has it; thin grid, the truth in grey under everything, estimates in the colours of Okabe &
//! Ito (2008), which readers with any colour vision tell apart; legends above the data, never on it; units on every axis.
//! Paths have equal axes and a scale bar. Curves are thinned to what the eye can see, [`MAX_POINTS`] at most.
//!
//! Text stays text (`<text>`, sans-serif of the viewer), so its width is guessed with room to spare.

mod allan;
mod attitude;
mod axes;
mod canvas;
mod convergence;
mod curves;
mod magnetometer;
mod path;
mod ranges;
mod thin;

use crate::marks::Phase;
use crate::statistics::Distribution;
use crate::{Evaluation, EvaluationError};
use adit_core::time::Time;
use adit_core::trajectory::Trajectory;
pub use allan::{AllanAxis, AllanPanel, AllanParts, allan_figure};
pub use attitude::attitude_figure;
pub use convergence::{ConvergenceCurve, convergence_figure};
pub use magnetometer::{MagneticCloud, magnetometer_figure};
pub use ranges::{ErrorDots, RangeErrors, range_figure};
pub use thin::MAX_POINTS;

/// What a curve stands for; it decides colour and weight.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Reference: grey, broad, beneath.
    Truth,
    /// Estimate with a running number that picks the colour.
    Estimate(usize),
}

/// A path with its name.
#[derive(Debug, Clone, Copy)]
pub struct PathCurve<'a> {
    /// Name in the legend.
    pub label: &'a str,
    /// What it stands for.
    pub role: Role,
    /// The path; x to the right, y up.
    pub trajectory: &'a Trajectory,
}

/// Values over time with their name.
#[derive(Debug, Clone)]
pub struct TimeCurve {
    /// Name in the legend.
    pub label: String,
    /// Time (s) and value, in rising order of time.
    pub points: Vec<(f64, f64)>,
}

/// A distribution with its name.
#[derive(Debug, Clone)]
pub struct DistributionCurve {
    /// Name in the legend.
    pub label: String,
    /// The distribution.
    pub distribution: Distribution,
}

/// A path wider than this times its height stands above the other panels of a page, not beside them.
const WIDE: f64 = 1.6;

/// The whole evaluation on one page: path over truth, errors over time (position, and attitude when judged), distribution.
pub fn evaluation_figure(evaluation: &Evaluation, title: &str) -> Result<String, EvaluationError> {
    let paths = evaluation_paths(evaluation);
    let attitude = attitude_curves(evaluation);
    let panels = if attitude.is_empty() { 2 } else { 3 };
    let aspect = path::aspect(&paths);
    let wide = aspect > WIDE;
    let path_height = path_panel_height(1130.0, aspect);
    let size = match (wide, panels) {
        (true, _) => (1240, path_height + 400),
        (false, 2) => (1240, 720),
        (false, _) => (1240, 900),
    };
    canvas::svg(size, title, |page| {
        let (path_area, rest) = if wide {
            page.split_vertically(canvas::units(path_height))
        } else {
            page.split_horizontally(canvas::units(640))
        };
        path::draw(&path_area, "Path", &paths)?;
        let areas = rest.split_evenly(if wide { (1, panels) } else { (panels, 1) });
        let unscored = phases(&evaluation.unmarked, evaluation.position_errors.times());
        let position = position_curves(evaluation);
        curves::over_time(&areas[0], "Position error over time", "error (m)", &position, &unscored)?;
        if !attitude.is_empty() {
            curves::over_time(&areas[1], "Attitude error over time", "error (°)", &attitude, &unscored)?;
        }
        let distributions = evaluation_distributions(evaluation);
        curves::distributions(
            &areas[panels - 1],
            "Distribution of the errors",
            ("m", "poses"),
            &distributions,
        )
    })
}

/// Paths on equal axes: estimates over a truth, or alone when none is given.
pub fn path_figure(paths: &[PathCurve<'_>], title: &str) -> Result<String, EvaluationError> {
    let size = (900, path_panel_height(790.0, path::aspect(paths)) + 40);
    canvas::svg(size, title, |page| path::draw(page, "", paths))
}

/// Height at which a path of this aspect fills its panel, within reason, px.
fn path_panel_height(width_px: f64, aspect: f64) -> i32 {
    #[expect(clippy::cast_possible_truncation, reason = "clamped")]
    let plot = (width_px / aspect).clamp(180.0, 720.0) as i32;
    // Heading, legend, axis.
    plot + 120
}

/// Curves over time; `y_label` names the quantity with its unit.
pub fn time_figure(series: &[TimeCurve], title: &str, y_label: &str) -> Result<String, EvaluationError> {
    canvas::svg((900, 420), title, |page| curves::over_time(page, "", y_label, series, &[]))
}

/// Cumulative distributions of errors in metres.
pub fn distribution_figure(series: &[DistributionCurve], title: &str) -> Result<String, EvaluationError> {
    canvas::svg((900, 480), title, |page| curves::distributions(page, "", ("m", "poses"), series))
}

/// Cumulative distributions of errors in this unit, over judged moments.
pub fn error_distribution_figure(
    series: &[DistributionCurve],
    unit: &str,
) -> Result<String, EvaluationError> {
    canvas::svg((900, 420), "", |page| curves::distributions(page, "", (unit, "moments"), series))
}

/// Truth and aligned estimate of an evaluation.
pub fn evaluation_paths(evaluation: &Evaluation) -> [PathCurve<'_>; 2] {
    [
        PathCurve { label: "truth", role: Role::Truth, trajectory: &evaluation.truth },
        PathCurve { label: "estimate", role: Role::Estimate(0), trajectory: &evaluation.estimate },
    ]
}

/// Horizontal and vertical position errors of an evaluation, time from its first pair.
pub fn position_curves(evaluation: &Evaluation) -> Vec<TimeCurve> {
    let (errors, report) = (&evaluation.position_errors, &evaluation.report.position);
    vec![
        time_curve(
            evaluation,
            format!("horizontal, RMSE {:.3} m", report.horizontal_m.rmse),
            &errors.horizontal_m(),
        ),
        time_curve(
            evaluation,
            format!("vertical, RMSE {:.3} m", report.vertical_m.rmse),
            &errors.vertical_m(),
        ),
    ]
}

/// Heading (with its sign) and inclination errors of an evaluation in degrees; empty when attitudes were not judged.
pub fn attitude_curves(evaluation: &Evaluation) -> Vec<TimeCurve> {
    let Some(report) = &evaluation.report.attitude else { return Vec::new() };
    let errors = &evaluation.attitude_errors;
    let heading: Vec<f64> = errors.iter().map(|e| e.signed_heading_rad.to_degrees()).collect();
    let inclination: Vec<f64> = errors.iter().map(|e| e.inclination_rad.to_degrees()).collect();
    vec![
        time_curve(evaluation, format!("heading, RMSE {:.2}°", report.heading_deg.rmse), &heading),
        time_curve(
            evaluation,
            format!("inclination, RMSE {:.2}°", report.inclination_deg.rmse),
            &inclination,
        ),
    ]
}

/// Distributions of the horizontal and vertical errors of an evaluation.
pub fn evaluation_distributions(evaluation: &Evaluation) -> Vec<DistributionCurve> {
    let errors = &evaluation.position_errors;
    let parts = [("horizontal", errors.horizontal_m()), ("vertical", errors.vertical_m())];
    parts
        .into_iter()
        .filter_map(|(name, values)| {
            let distribution = Distribution::of(&values)?;
            let label = format!("{name}, 95 % < {:.3} m", distribution.quantile(0.95));
            Some(DistributionCurve { label, distribution })
        })
        .collect()
}

fn time_curve(evaluation: &Evaluation, label: String, values: &[f64]) -> TimeCurve {
    curve_since_first(label, evaluation.position_errors.times(), values.iter().copied())
}

fn curve_since_first(label: String, times: &[Time], values: impl Iterator<Item = f64>) -> TimeCurve {
    let since_first = times.iter().map(|time| (*time - times[0]).seconds());
    TimeCurve { label, points: since_first.zip(values).collect() }
}

/// Phases that are not scored, s from the first of these times.
fn phases(unmarked: &[Phase], times: &[Time]) -> Vec<(f64, f64)> {
    let Some(first) = times.first() else { return Vec::new() };
    let since = |time: Time| (time - *first).seconds();
    unmarked.iter().map(|phase| (since(phase.start), since(phase.end))).collect()
}
