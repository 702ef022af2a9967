//! Many runs in a few numbers.

use super::PROBABILITY;
use super::run::{DIMENSIONS, PARTS, RunErrors};
use crate::EvaluationError;
use crate::consistency::{Bounds, average_nees_bounds};
use crate::statistics::{Distribution, Statistics};
use serde::{Serialize, Serializer};
use std::fmt;

/// Radius of `share_below_2m`.
const NEAR_M: f64 = 2.0;

/// What one run of one method gave.
#[derive(Debug, Clone, PartialEq)]
pub struct RunOutcome {
    /// Errors at the judged moments.
    pub errors: RunErrors,
    /// Normalised innovations squared: dimension, count, sum.
    pub nis: Option<(usize, u64, f64)>,
    /// Time of one inertial sample through the method, ns.
    pub time_per_step_ns: f64,
}

/// Spread of absolute errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Quantiles {
    /// Root mean square.
    pub rmse: f64,
    /// Mean.
    pub mean: f64,
    /// 50th percentile.
    pub median: f64,
    /// 90th percentile.
    pub p90: f64,
    /// 95th percentile.
    pub p95: f64,
    /// Largest.
    pub max: f64,
}

/// One number of each run, over the runs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OverSeeds {
    /// Largest |east| error of a run, m.
    pub largest_east_m: Option<Quantiles>,
    /// Largest horizontal error of a run, m.
    pub largest_position_m: Option<Quantiles>,
    /// Largest |heading| error of a run, deg.
    pub largest_heading_deg: Option<Quantiles>,
    /// Largest horizontal velocity error of a run, m/s.
    pub largest_velocity_m_s: Option<Quantiles>,
    /// RMSE of the horizontal position of a run, m.
    pub position_rmse_m: Option<Quantiles>,
    /// Mean horizontal position error of a run, m.
    pub position_mean_m: Option<Quantiles>,
    /// |East| error at the end, m.
    pub end_east_m: Option<Quantiles>,
    /// |Heading| error at the end, deg.
    pub end_heading_deg: Option<Quantiles>,
    /// Horizontal velocity error at the end, m/s.
    pub end_velocity_m_s: Option<Quantiles>,
}

/// NEES of one part of the state over the runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Nees {
    /// Dimension: the ideal mean.
    pub dimension: usize,
    /// Mean over all moments and runs.
    pub mean: f64,
    /// Bounds that hold the mean over the runs at one moment with 95 %.
    #[serde(flatten)]
    pub bounds: Bounds,
    /// Share of the moments whose mean lies inside: ideally 0.95.
    pub share_inside: f64,
    /// Mean over the runs at each moment.
    #[serde(skip)]
    pub per_moment: Vec<f64>,
}

/// Whether the stated covariance is honest.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Consistency {
    /// Horizontal position.
    pub position: Option<Nees>,
    /// Horizontal velocity.
    pub velocity: Option<Nees>,
    /// Heading.
    pub heading: Option<Nees>,
    /// The five together.
    pub joint: Option<Nees>,
}

/// Normalised innovations squared of all runs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct NisSummary {
    /// Dimension: the ideal mean.
    pub dimension: usize,
    /// Number of measurements.
    pub count: u64,
    /// Mean.
    pub mean: f64,
    /// Bounds that hold the mean with 95 %.
    #[serde(flatten)]
    pub bounds: Bounds,
}

/// One method over all runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodSummary {
    /// Name of the method; the name of the entry may be another, of another configuration.
    pub method: String,
    /// Number of runs that it came to the end of: all figures are over these.
    pub runs: usize,
    /// Number of runs on which it gave up.
    pub failed_runs: usize,
    /// Horizontal position errors; none for attitude alone.
    pub position_m: Option<Quantiles>,
    /// |Heading| errors.
    pub heading_deg: Option<Quantiles>,
    /// Horizontal velocity errors, where the truth has velocities.
    pub velocity_m_s: Option<Quantiles>,
    /// Share of position errors not above 2 m.
    pub share_below_2m: Option<f64>,
    /// NEES of the horizontal position.
    pub nees: Option<Nees>,
    /// Time of one inertial sample through the method, median over the runs, ns. The one number that no two comparisons
    /// share.
    pub time_per_step_ns: f64,
    /// Per run, over the runs.
    pub over_seeds: OverSeeds,
    /// NEES of every part.
    pub consistency: Consistency,
    /// NIS.
    pub nis: Option<NisSummary>,
    /// Whether it stands in the figures.
    #[serde(skip)]
    pub in_figures: bool,
    /// Time of the judged moments, s, and at each the error that 95 % of the runs do not exceed: position (m), heading
    /// (deg), velocity (m/s).
    #[serde(skip)]
    pub curves: ErrorCurves,
    /// All position errors.
    #[serde(skip)]
    pub distribution: Option<Distribution>,
}

/// Errors over time that 95 % of the runs do not exceed.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ErrorCurves {
    /// Horizontal position, m.
    pub position_m: Vec<(f64, f64)>,
    /// |Heading|, deg.
    pub heading_deg: Vec<(f64, f64)>,
    /// Horizontal velocity, m/s.
    pub velocity_m_s: Vec<(f64, f64)>,
}

/// Methods on the same runs; JSON as `adit compare --json` documents it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// The scenario or folder.
    pub scenario: String,
    /// Number of runs.
    pub seeds: usize,
    /// Seed of the first run; none for recorded ones.
    pub first_seed: Option<u64>,
    /// Alignment before errors are taken.
    pub alignment: String,
    /// Judged from this time on, s.
    pub judged_from_s: f64,
    /// Time between judged moments, s; none where they are the stamps of the truth.
    pub judged_every_s: Option<f64>,
    /// Judged only while the truth moves faster than this, m/s.
    pub judged_above_m_s: f64,
    /// By name, in the order in which they were named; a map in JSON.
    #[serde(serialize_with = "as_map")]
    pub methods: Vec<(String, MethodSummary)>,
}

/// Sums up the runs of one method; those that it failed are `None`.
pub fn summarise(
    method: &str,
    all: &[Option<RunOutcome>],
    in_figures: bool,
) -> Result<MethodSummary, EvaluationError> {
    let runs: Vec<&RunOutcome> = all.iter().flatten().collect();
    let errors: Vec<&RunErrors> = runs.iter().map(|run| &run.errors).collect();
    let pool =
        |of: &dyn Fn(&RunErrors) -> Vec<f64>| -> Vec<f64> { errors.iter().flat_map(|run| of(run)).collect() };
    let horizontal = |run: &RunErrors| run.horizontal_m().collect::<Vec<f64>>();
    let east = |run: &RunErrors| absolute(run.level_m.iter().map(|[east, _]| *east));
    let heading = |run: &RunErrors| absolute(run.heading_deg.iter().copied());
    let velocity = |run: &RunErrors| absolute(run.velocity_m_s.iter().copied());
    let each = |of: &dyn Fn(&RunErrors) -> Vec<f64>, number: fn(&[f64]) -> Option<f64>| {
        Quantiles::of(&errors.iter().filter_map(|run| number(&of(run))).collect::<Vec<f64>>())
    };
    let position = Distribution::of(&pool(&horizontal));
    let nees = |part: usize| nees(&errors, part);
    let mut times_ns: Vec<f64> = runs.iter().map(|run| run.time_per_step_ns).collect();
    times_ns.sort_by(f64::total_cmp);
    Ok(MethodSummary {
        method: method.to_owned(),
        runs: runs.len(),
        failed_runs: all.len() - runs.len(),
        position_m: Quantiles::of(&pool(&horizontal)),
        heading_deg: Quantiles::of(&pool(&heading)),
        velocity_m_s: Quantiles::of(&pool(&velocity)),
        share_below_2m: position.as_ref().map(|errors| errors.share_below(NEAR_M)),
        nees: nees(0)?,
        time_per_step_ns: times_ns.get(times_ns.len() / 2).copied().unwrap_or_default(),
        over_seeds: OverSeeds {
            largest_east_m: each(&east, largest),
            largest_position_m: each(&horizontal, largest),
            largest_heading_deg: each(&heading, largest),
            largest_velocity_m_s: each(&velocity, largest),
            position_rmse_m: each(&horizontal, |errors| Statistics::of(errors).map(|s| s.rmse)),
            position_mean_m: each(&horizontal, |errors| Statistics::of(errors).map(|s| s.mean)),
            end_east_m: each(&east, last),
            end_heading_deg: each(&heading, last),
            end_velocity_m_s: each(&velocity, last),
        },
        consistency: Consistency {
            position: nees(0)?,
            velocity: nees(1)?,
            heading: nees(2)?,
            joint: nees(3)?,
        },
        nis: nis(&runs)?,
        in_figures,
        curves: ErrorCurves {
            position_m: curve(&errors, &horizontal),
            heading_deg: curve(&errors, &heading),
            velocity_m_s: curve(&errors, &velocity),
        },
        distribution: position,
    })
}

impl Quantiles {
    /// Of errors; `None` when there are none.
    pub fn of(errors: &[f64]) -> Option<Self> {
        let Statistics { rmse, mean, median, p90, p95, max, .. } = Statistics::of(errors)?;
        Some(Self { rmse, mean, median, p90, p95, max })
    }
}

fn as_map<S: Serializer>(methods: &[(String, MethodSummary)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(methods.iter().map(|(name, method)| (name, method)))
}

fn absolute(values: impl Iterator<Item = f32>) -> Vec<f64> {
    values.map(|value| f64::from(value.abs())).collect()
}

fn largest(errors: &[f64]) -> Option<f64> {
    errors.iter().copied().reduce(f64::max)
}

fn last(errors: &[f64]) -> Option<f64> {
    errors.last().copied()
}

/// Error that 95 % of the runs do not exceed, at each moment that all runs have.
fn curve(errors: &[&RunErrors], of: &dyn Fn(&RunErrors) -> Vec<f64>) -> Vec<(f64, f64)> {
    let series: Vec<Vec<f64>> = errors.iter().map(|run| of(run)).collect();
    let moments = series.iter().map(Vec::len).min().unwrap_or(0);
    (0..moments)
        .filter_map(|moment| {
            let at: Vec<f64> = series.iter().map(|run| run[moment]).collect();
            let time_s = f64::from(errors.first()?.time_s[moment]);
            Some((time_s, Distribution::of(&at)?.quantile(PROBABILITY)))
        })
        .collect()
}

/// NEES of one part; `None` unless every moment of every run has it.
fn nees(errors: &[&RunErrors], part: usize) -> Result<Option<Nees>, EvaluationError> {
    debug_assert!(part < PARTS, "one of the parts");
    let moments = errors.iter().map(|run| run.nees.len()).min().unwrap_or(0);
    let per_moment: Vec<f64> = (0..moments)
        .map(|moment| errors.iter().map(|run| f64::from(run.nees[moment][part])).sum::<f64>())
        .map(|sum| sum / errors.len() as f64)
        .collect();
    if moments == 0 || per_moment.iter().any(|mean| mean.is_nan()) {
        return Ok(None);
    }
    let bounds = average_nees_bounds(DIMENSIONS[part], errors.len(), PROBABILITY)?;
    let inside = per_moment.iter().filter(|mean| bounds.contain(**mean)).count();
    Ok(Some(Nees {
        dimension: DIMENSIONS[part],
        mean: per_moment.iter().sum::<f64>() / moments as f64,
        bounds,
        share_inside: inside as f64 / moments as f64,
        per_moment,
    }))
}

fn nis(runs: &[&RunOutcome]) -> Result<Option<NisSummary>, EvaluationError> {
    let known: Vec<_> = runs.iter().filter_map(|run| run.nis).collect();
    let Some((dimension, ..)) = known.first().copied() else { return Ok(None) };
    let (count, sum) = known.iter().fold((0, 0.0), |(count, sum), (_, n, s)| (count + n, sum + s));
    let Ok(many) = usize::try_from(count) else { return Ok(None) };
    let bounds = average_nees_bounds(dimension, many, PROBABILITY)?;
    Ok(Some(NisSummary { dimension, count, mean: sum / count as f64, bounds }))
}

impl Comparison {
    /// Which moments are judged, in words.
    pub(super) fn judged(&self) -> String {
        let moving = match self.judged_above_m_s {
            0.0 => String::new(),
            speed => format!(" while moving faster than {speed} m/s"),
        };
        match self.judged_every_s {
            Some(every_s) => format!("from {} s on every {every_s} s{moving}", self.judged_from_s),
            None => "at the stamps of the truth".to_owned(),
        }
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let runs = if self.seeds == 1 { "1 run".to_owned() } else { format!("{} runs", self.seeds) };
        let seeds = self.first_seed.map_or_else(String::new, |first| format!(", seeds from {first}"));
        writeln!(f, "{}: {runs}{seeds}", self.scenario)?;
        writeln!(f, "aligned {}, judged {}", self.alignment, self.judged())?;
        let width = self.methods.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0).max(6);
        writeln!(f)?;
        writeln!(
            f,
            "{:width$}  position, all moments                       largest error of a run, 95 % of the runs",
            ""
        )?;
        writeln!(
            f,
            "{:width$}  rmse      mean    95 %   largest  below 2 m   east    position  heading   velocity",
            "method"
        )?;
        for (name, method) in &self.methods {
            let all = method.position_m;
            let over = &method.over_seeds;
            let p95 = |quantiles: Option<Quantiles>| quantiles.map(|q| q.p95);
            writeln!(
                f,
                "{name:width$} {}{}{}{}{} {}{}{}{}",
                cell(all.map(|q| q.rmse), 6, " m"),
                cell(all.map(|q| q.mean), 6, " m"),
                cell(p95(all), 6, " m"),
                cell(all.map(|q| q.max), 6, " m"),
                cell(method.share_below_2m.map(|share| 100.0 * share), 6, " %"),
                cell(p95(over.largest_east_m), 6, " m"),
                cell(p95(over.largest_position_m), 6, " m"),
                cell(p95(over.largest_heading_deg), 6, "°"),
                cell(p95(over.largest_velocity_m_s), 6, " m/s"),
            )?;
        }
        writeln!(f)?;
        writeln!(f, "{:width$}  NEES (mean over runs and time; in brackets 95 % bounds at one moment)", "")?;
        writeln!(f, "{:width$}  {:33}{:33}NIS", "method", "position, 2", "position, velocity, heading, 5")?;
        for (name, method) in &self.methods {
            let nis = method.nis.map_or_else(
                || "–".to_owned(),
                |nis| {
                    format!(
                        "{:.2} [{:.2}–{:.2}], {}",
                        nis.mean, nis.bounds.lower, nis.bounds.upper, nis.dimension
                    )
                },
            );
            let parts = &method.consistency;
            let (position, joint) = (parts.position.as_ref(), parts.joint.as_ref());
            writeln!(f, "{name:width$}  {:33}{:33}{nis}", nees_cell(position), nees_cell(joint))?;
        }
        writeln!(f)?;
        for (name, method) in self.methods.iter().filter(|(_, method)| method.failed_runs > 0) {
            let (failed, seeds) = (method.failed_runs, self.seeds);
            writeln!(f, "{name} gave up on {failed} of {seeds} runs, which are in no figure")?;
        }
        for (name, method) in &self.methods {
            writeln!(f, "speed {name:width$}  {:.0} ns for one sample", method.time_per_step_ns)?;
        }
        Ok(())
    }
}

fn cell(value: Option<f64>, width: usize, unit: &str) -> String {
    let unit_width = 4;
    match value {
        None => format!("{:>width$}{:unit_width$}", "–", ""),
        Some(value) => {
            let decimals = if value.abs() < 100.0 { 2 } else { 0 };
            format!("{value:width$.decimals$}{unit:unit_width$}")
        }
    }
}

fn nees_cell(nees: Option<&Nees>) -> String {
    nees.map_or_else(
        || "–".to_owned(),
        |nees| {
            let inside = 100.0 * nees.share_inside;
            format!(
                "{:.2} [{:.2}–{:.2}], {inside:.0} % inside",
                nees.mean, nees.bounds.lower, nees.bounds.upper
            )
        },
    )
}
