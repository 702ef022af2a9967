//! A comparison as one HTML page: tables and figures inside, nothing loaded from elsewhere.

use super::style::STYLE;
use super::summary::{Comparison, MethodSummary, Nees, Quantiles};
use crate::EvaluationError;
use crate::plot::{DistributionCurve, PathCurve, TimeCurve, distribution_figure, path_figure, time_figure};
use std::fmt::Write;

/// The page; `paths` are truth and estimates of the first run.
pub fn html(comparison: &Comparison, paths: &[PathCurve<'_>]) -> Result<String, EvaluationError> {
    let mut page = String::new();
    let scenario = &comparison.scenario;
    let title = escape(scenario.rsplit(['/', '\\']).next().unwrap_or(scenario));
    let methods = comparison.methods.iter().map(|(name, method)| (name, method));
    let shown: Vec<(&String, &MethodSummary)> = methods.filter(|(_, method)| method.in_figures).collect();
    // Writing to a String does not fail.
    let _ = write!(
        page,
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title}</title>\
         <meta name=\"viewport\" content=\"width=device-width\"><style>{STYLE}body{{max-width:72rem}}</style></head><body>\n<h1>{title}</h1>\n<p>{}: {} runs{}; aligned {}, judged {}. \
         Position and velocity errors are horizontal.</p>\n",
        escape(scenario),
        comparison.seeds,
        comparison.first_seed.map_or_else(String::new, |seed| format!(", seeds from {seed}")),
        escape(&comparison.alignment),
        comparison.judged(),
    );
    for (name, method) in comparison.methods.iter().filter(|(_, method)| method.failed_runs > 0) {
        let failed = method.failed_runs;
        let _ = writeln!(
            page,
            "<p><b>{} gave up on {failed} runs</b>, which are in no figure.</p>",
            escape(name)
        );
    }
    errors_table(&mut page, comparison);
    largest_table(&mut page, comparison);
    consistency_table(&mut page, comparison);
    if paths.len() > 1 {
        page += "<h2>Path of the first run</h2>\n";
        page += &path_figure(paths, "")?;
    }
    let curves = |of: &dyn Fn(&MethodSummary) -> Vec<(f64, f64)>| -> Vec<TimeCurve> {
        let named = shown.iter().map(|(name, method)| ((*name).clone(), of(method)));
        let named = named.filter(|(_, points)| !points.is_empty());
        named.map(|(label, points)| TimeCurve { label, points }).collect()
    };
    let over_time = [
        ("Position error", "error (m)", curves(&|method| method.curves.position_m.clone())),
        ("Heading error", "error (°)", curves(&|method| method.curves.heading_deg.clone())),
        ("Velocity error", "error (m/s)", curves(&|method| method.curves.velocity_m_s.clone())),
    ];
    for (heading, label, curves) in over_time {
        if !curves.is_empty() {
            let _ = writeln!(page, "<h2>{heading} that 95 % of the runs do not exceed</h2>");
            page += &time_figure(&curves, "", label)?;
        }
    }
    let distributions: Vec<DistributionCurve> = shown
        .iter()
        .filter_map(|(name, method)| {
            let distribution = method.distribution.clone()?;
            Some(DistributionCurve { label: (*name).clone(), distribution })
        })
        .collect();
    if !distributions.is_empty() {
        page += "<h2>Distribution of the position errors</h2>\n";
        page += &distribution_figure(&distributions, "")?;
    }
    nees_figures(&mut page, &shown)?;
    page += "</body></html>\n";
    Ok(page)
}

fn errors_table(page: &mut String, comparison: &Comparison) {
    *page += "<h2>Errors, all moments of all runs</h2>\n<table><tr><th>method</th><th>position: RMSE</th><th>mean</th><th>median</th>\
        <th>95 %</th><th>largest</th><th>below 2 m</th><th>heading: 95 %</th><th>velocity: 95 %</th>\
        <th>one sample</th></tr>\n";
    for (name, method) in &comparison.methods {
        let position = |of: fn(&Quantiles) -> f64| number(method.position_m.as_ref().map(of), " m");
        let _ = writeln!(
            page,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.0} ns</td></tr>",
            escape(name),
            position(|q| q.rmse),
            position(|q| q.mean),
            position(|q| q.median),
            position(|q| q.p95),
            position(|q| q.max),
            number(method.share_below_2m.map(|share| 100.0 * share), " %"),
            number(method.heading_deg.map(|q| q.p95), "°"),
            number(method.velocity_m_s.map(|q| q.p95), " m/s"),
            method.time_per_step_ns,
        );
    }
    *page += "</table>\n";
}

fn largest_table(page: &mut String, comparison: &Comparison) {
    *page += "<h2>Largest error of a run, over the runs</h2>\n<table><tr><th>method</th><th>east: median</th><th>95 %</th>\
        <th>position: 95 %</th><th>heading: median</th><th>95 %</th><th>velocity: 95 %</th><th>east at the end: 95 %</th>\
        </tr>\n";
    for (name, method) in &comparison.methods {
        let over = &method.over_seeds;
        let cells = [
            number(over.largest_east_m.map(|q| q.median), " m"),
            number(over.largest_east_m.map(|q| q.p95), " m"),
            number(over.largest_position_m.map(|q| q.p95), " m"),
            number(over.largest_heading_deg.map(|q| q.median), "°"),
            number(over.largest_heading_deg.map(|q| q.p95), "°"),
            number(over.largest_velocity_m_s.map(|q| q.p95), " m/s"),
            number(over.end_east_m.map(|q| q.p95), " m"),
        ];
        let _ = writeln!(page, "<tr><td>{}</td><td>{}</td></tr>", escape(name), cells.join("</td><td>"));
    }
    *page += "</table>\n";
}

fn consistency_table(page: &mut String, comparison: &Comparison) {
    *page += "<h2>Consistency</h2>\n<table><tr><th>method</th><th>NEES position (2)</th><th>velocity (2)</th>\
        <th>heading (1)</th><th>all (5)</th><th>NIS</th></tr>\n";
    for (name, method) in &comparison.methods {
        let parts = &method.consistency;
        let nis = method.nis.map_or_else(
            || "–".to_owned(),
            |nis| {
                format!(
                    "{:.2} [{:.2}–{:.2}] ({})",
                    nis.mean, nis.bounds.lower, nis.bounds.upper, nis.dimension
                )
            },
        );
        let cells = [&parts.position, &parts.velocity, &parts.heading, &parts.joint]
            .map(|part| nees_cell(part.as_ref()));
        let _ = writeln!(
            page,
            "<tr><td>{}</td><td>{}</td><td>{nis}</td></tr>",
            escape(name),
            cells.join("</td><td>")
        );
    }
    *page += "</table>\n<p class=\"note\">NEES: mean over runs and time [95 % bounds of the mean over the runs at one moment], \
        share of moments inside. Ideal are the dimension in brackets and 95 %.</p>\n";
}

/// Mean over the runs against its bounds: the widest part that a method gives.
fn nees_figures(page: &mut String, shown: &[(&String, &MethodSummary)]) -> Result<(), EvaluationError> {
    for (name, method) in shown {
        let parts = &method.consistency;
        let Some(nees) = parts.joint.as_ref().or(parts.position.as_ref()).or(parts.heading.as_ref()) else {
            continue;
        };
        let times = [&method.curves.position_m, &method.curves.heading_deg];
        let Some(times) = times.into_iter().find(|points| points.len() == nees.per_moment.len()) else {
            continue;
        };
        let times = times.iter().map(|(time_s, _)| *time_s);
        let (Some(first), Some(last)) = (times.clone().next(), times.clone().next_back()) else { continue };
        let bound = |label: &str, value: f64| TimeCurve {
            label: format!("{label} 95 % bound"),
            points: vec![(first, value), (last, value)],
        };
        let mean = TimeCurve {
            label: format!("mean over the runs, ideally {}", nees.dimension),
            points: times.zip(nees.per_moment.iter().copied()).collect(),
        };
        let curves = [mean, bound("lower", nees.bounds.lower), bound("upper", nees.bounds.upper)];
        let _ = writeln!(page, "<h2>NEES of {}</h2>", escape(name));
        *page += &time_figure(&curves, "", "NEES")?;
    }
    Ok(())
}

fn nees_cell(nees: Option<&Nees>) -> String {
    nees.map_or_else(
        || "–".to_owned(),
        |nees| {
            let inside = 100.0 * nees.share_inside;
            format!("{:.2} [{:.2}–{:.2}], {inside:.0} %", nees.mean, nees.bounds.lower, nees.bounds.upper)
        },
    )
}

fn number(value: Option<f64>, unit: &str) -> String {
    value.map_or_else(
        || "–".to_owned(),
        |value| {
            let decimals = if value.abs() < 100.0 { 3 } else { 0 };
            format!("{value:.decimals$}{unit}")
        },
    )
}

pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
