//! The optimisers and mealpy's on functions whose optimum is known: a table, and how the costs fall.
//!
//! `cargo run -p adit-tuning --example optimise_results METHODS.md TAILS.md CONVERGENCE.svg`; `ci/results.sh` calls it.

#[path = "../tests/support/problems.rs"]
mod problems;

use adit_tuning::optimise::bat::Bat;
use adit_tuning::optimise::sine_cosine_bat::SineCosineBat;
use adit_tuning::optimise::{Method, Optimiser};
use plotters::coord::Shift;
use plotters::prelude::*;
use problems::{EVALUATIONS, PROBLEMS, Problem, SEEDS, TURNED, better, mean, median};
use std::error::Error;
use std::fmt::Write as _;

/// Colours after Okabe & Ito (2008), in the order of [`Method::ALL`].
const COLOURS: [RGBColor; 4] =
    [RGBColor(0, 114, 178), RGBColor(230, 159, 0), RGBColor(213, 94, 0), RGBColor(0, 158, 115)];
const RIVALS: [&str; 2] = ["DevBA", "OriginalSCA"];
/// Median costs below are drawn here.
const FLOOR: f64 = 1e-9;

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let usage = "usage: optimise_results METHODS.md TAILS.md CONVERGENCE.svg";
    std::fs::write(args.next().ok_or(usage)?, methods()?)?;
    std::fs::write(args.next().ok_or(usage)?, tails()?)?;
    let figure: &'static str = args.next().ok_or(usage)?.leak();
    let root = SVGBackend::new(figure, (1180, 460)).into_drawing_area();
    root.fill(&WHITE)?;
    let (left, right) = root.split_horizontally(590);
    draw(&left, &PROBLEMS[2], "Rastrigin, optimum at the origin")?;
    draw(&right, &PROBLEMS[3], "Rastrigin, optimum 30 % off")?;
    root.present()?;
    Ok(())
}

fn methods() -> Result<String, std::fmt::Error> {
    let mut out = "| function | optimum | method | mean | median | worst | mean rank | better than DevBA | better than OriginalSCA |\n|---|---|---|---|---|---|---|---|---|\n".to_owned();
    for problem in &PROBLEMS {
        let rivals = RIVALS.map(|name| problem.rival(name));
        let named = RIVALS.iter().map(|name| format!("mealpy {name}")).zip(rivals.clone());
        let ours = Method::ALL.map(|method| (format!("`{}`", method.name()), problem.costs(method)));
        let all: Vec<(String, Vec<f64>)> = ours.into_iter().chain(named).collect();
        for (name, costs) in &all {
            let worst = costs.iter().copied().fold(0.0, f64::max);
            write!(
                out,
                "| {} | {} | {name} | {:.2e} | {:.2e} | {worst:.2e} | {:.0}",
                problem.name,
                problem.optimum,
                mean(costs),
                median(costs),
                mean_rank(costs, &all)
            )?;
            for rival in &rivals {
                let same = rival == costs;
                write!(out, " | {}", if same { "–".to_owned() } else { verdict(costs, rival) })?;
            }
            out.push_str(" |\n");
        }
    }
    Ok(out)
}

/// The local search's draws, even and long-tailed.
fn tails() -> Result<String, std::fmt::Error> {
    let problems = [&PROBLEMS[1], &PROBLEMS[3], &TURNED, &PROBLEMS[4]];
    let mut out = "| method | tail |".to_owned();
    for problem in problems {
        write!(out, " {} {} |", problem.name, problem.optimum)?;
    }
    out.push_str("\n|---|---|---|---|---|---|\n");
    for tail in [1, 3, 9, 30, 60] {
        let bat = Bat { tail, ..Bat::default() };
        let both = SineCosineBat { bat, ..SineCosineBat::default() };
        for (name, optimiser) in [("bat", &bat as &dyn Optimiser), ("scaba", &both)] {
            write!(out, "| `{name}` | {tail} |")?;
            for problem in problems {
                let costs = problem.costs_with(optimiser);
                write!(out, " {:.2e} / {:.2e} |", mean(&costs), median(&costs))?;
            }
            out.push('\n');
        }
    }
    for method in [Method::SineCosine, Method::CovarianceMatrix] {
        write!(out, "| `{}` | – |", method.name())?;
        for problem in problems {
            let costs = problem.costs(method);
            write!(out, " {:.2e} / {:.2e} |", mean(&costs), median(&costs))?;
        }
        out.push('\n');
    }
    Ok(out)
}

/// Mean place of these runs among the runs of all, the first being 1.
fn mean_rank(costs: &[f64], all: &[(String, Vec<f64>)]) -> f64 {
    let rank = |cost: &f64| {
        let lower = all.iter().flat_map(|(_, others)| others).filter(|other| *other < cost).count();
        lower as f64 + 1.0
    };
    mean(&costs.iter().map(rank).collect::<Vec<f64>>())
}

/// In how many pairs of runs, and the two-sided probability of this if there is no difference.
fn verdict(ours: &[f64], theirs: &[f64]) -> String {
    let (share, deviations) = better(ours, theirs);
    let chance = libm::erfc(deviations.abs() / std::f64::consts::SQRT_2);
    let chance = if chance < 0.001 { "< 0.001".to_owned() } else { format!("{chance:.3}") };
    format!("{:.0} %, {chance}", 100.0 * share)
}

fn draw<'a>(
    area: &DrawingArea<SVGBackend<'a>, Shift>,
    problem: &Problem,
    title: &str,
) -> Result<(), Box<dyn Error + 'a>> {
    let mut chart = ChartBuilder::on(area)
        .caption(title, ("sans-serif", 18))
        .margin(12)
        .margin_right(22)
        .x_label_area_size(40)
        .y_label_area_size(64)
        .build_cartesian_2d(0.0..EVALUATIONS as f64, (FLOOR..200.0).log_scale())?;
    chart
        .configure_mesh()
        .x_desc("evaluations")
        .y_desc(format!("least cost, median of {SEEDS} seeds"))
        .x_label_formatter(&|evaluations| format!("{evaluations:.0}"))
        .y_label_formatter(&|cost| format!("{cost:.0e}"))
        .light_line_style(WHITE)
        .draw()?;
    for (method, colour) in Method::ALL.iter().zip(COLOURS) {
        let style = colour.stroke_width(2);
        chart
            .draw_series(LineSeries::new(convergence(problem, *method), style))?
            .label(method.name())
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], style));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerLeft)
        .background_style(WHITE.mix(0.8))
        .border_style(BLACK.mix(0.3))
        .label_font(("sans-serif", 14))
        .draw()?;
    Ok(())
}

/// The median over the seeds of the least cost after so many evaluations.
fn convergence(problem: &Problem, method: Method) -> Vec<(f64, f64)> {
    let runs: Vec<Vec<(usize, f64)>> =
        (0..SEEDS).map(|seed| problem.run(method, seed).improvements).collect();
    (1..=EVALUATIONS / 30)
        .map(|part| {
            let after = 30 * part;
            let least = |run: &Vec<(usize, f64)>| {
                run.iter().take_while(|(at, _)| *at <= after).last().map_or(f64::INFINITY, |(_, cost)| *cost)
            };
            (after as f64, median(&runs.iter().map(least).collect::<Vec<f64>>()).max(FLOOR))
        })
        .collect()
}
