//! What it costs to tune system S1: its fitness on one core, next to mealpy over a filter on numpy, in one run.
//!
//! ```text
//! s1_fitness WALKS.csv TABLE.md [PYTHON ci/rival/mealpy_s1.py]
//! ```
//!
//! The walks are the shape of the paper's training (192 reports every 10 s, there at 2 m/s and back at 3), drawn here: dead reckoning that is off by 4 %
//! and 1° and wanders, fixes that err by 4 m. The untuned filter must cost the same in both languages.

use adit_core::nalgebra::Vector2;
use adit_estimation::methods::pdr_wifi::{FusionParams, Report, Walk, squared_error_m2};
use adit_tuning::optimise::{Method, Search, Task};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use std::error::Error;
use std::fmt::Write;
use std::process::Command;
use std::time::Instant;

const LEGS: usize = 8;
const AGENTS: usize = 30;
const EVALUATIONS: usize = 3000;
/// A start known to a metre, as the Python script has it.
const START_SIGMA_M: Vector2<f64> = Vector2::new(1.0, 1.0);
/// The factors go from a thousandth to a thousandfold.
const DECADES: f64 = 3.0;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [csv, table, rival @ ..] = args.as_slice() else {
        return Err("usage: s1_fitness WALKS.csv TABLE.md [PYTHON SCRIPT]".into());
    };
    let walks = walks(1);
    std::fs::write(csv, text(&walks)?)?;
    let reports: usize = walks.iter().map(|walk| walk.reports.len()).sum();
    let cost = |x: &[f64]| squared_error_m2(&scaled(x), START_SIGMA_M, &walks);
    let untuned = cost(&[0.0; 8]);

    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let task =
        |seed| Task { bounds: vec![[-DECADES, DECADES]; 8], agents: AGENTS, evaluations: EVALUATIONS, seed };
    let mut out = String::new();
    writeln!(
        out,
        "| {reports} reports, 8 factors, {EVALUATIONS} evaluations, one core | evaluations/s | untuned, m² | least found, m² |"
    )?;
    writeln!(out, "|---|---:|---:|---:|")?;
    let mut fastest = 0.0_f64;
    for method in [Method::Bat, Method::SineCosine, Method::SineCosineBat, Method::CovarianceMatrix] {
        // The best of five: whatever else the machine does only takes away.
        let mut speed = 0.0_f64;
        let mut least = f64::INFINITY;
        for seed in 1..=5 {
            let clock = Instant::now();
            let found = alone.install(|| {
                Ok::<_, adit_tuning::TuningError>(Search::new(method, task(seed), &cost)?.run())
            })?;
            speed = speed.max(found.evaluations as f64 / clock.elapsed().as_secs_f64());
            least = if seed == 1 { found.cost } else { least };
        }
        writeln!(out, "| adit `{}` | {speed:.0} | {untuned:.3} | {least:.3} |", method.name())?;
        fastest = if method == Method::Bat { speed } else { fastest };
    }
    if let [python, script] = rival {
        let output = Command::new(python)
            .args([script.as_str(), csv, &EVALUATIONS.to_string()])
            .env("OPENBLAS_NUM_THREADS", "1")
            .output()?;
        let said = String::from_utf8(output.stdout)?;
        let numbers: Vec<f64> = said.split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
        let [speed, their_untuned, least] = numbers[..] else {
            return Err(format!("{script}: {}", String::from_utf8_lossy(&output.stderr)).into());
        };
        // Six decimals are printed.
        if (their_untuned - untuned).abs() > 1e-5 * untuned {
            return Err(format!("the untuned filter costs {untuned} here and {their_untuned} there").into());
        }
        writeln!(out, "| mealpy DevBA, numpy | {speed:.0} | {their_untuned:.3} | {least:.3} |")?;
        writeln!(out, "| adit `bat` is so many times as fast | {:.0} | | |", fastest / speed)?;
    }
    print!("{out}");
    std::fs::write(table, out)?;
    Ok(())
}

fn scaled(exponents: &[f64]) -> FusionParams {
    let mut params = FusionParams::default();
    for (place, exponent) in exponents.iter().enumerate() {
        params.set_noise(place, 10_f64.powf(*exponent));
    }
    params
}

/// There at 2 m/s, 29 reports, and back at 3 m/s, 19, four times.
fn walks(seed: u64) -> Vec<Walk> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = move || -> f64 { StandardNormal.sample(&mut rng) };
    let leg = |leg: usize| {
        let (count, speed) = if leg.is_multiple_of(2) { (29, 2.0) } else { (19, -3.0) };
        let way = Vector2::new(0.995, 0.1) * speed;
        let off = Vector2::new(0.04 * way.x - 0.017 * way.y, 0.04 * way.y + 0.017 * way.x);
        let mut wander = Vector2::zeros();
        let reports = (1..=count).map(|k| {
            let time_s = 10.0 * f64::from(k);
            wander += Vector2::new(normal(), normal()) * 0.3;
            let truth = way * time_s;
            let fix_m = truth + Vector2::new(normal() * 4.0, normal());
            (Report { time_s, reckoned_m: truth + off * time_s + wander, fix_m }, truth)
        });
        Walk { reports: reports.collect() }
    };
    (0..LEGS).map(leg).collect()
}

fn text(walks: &[Walk]) -> Result<String, std::fmt::Error> {
    let mut text = "walk,time_s,pdr_x_m,pdr_y_m,fix_x_m,fix_y_m,true_x_m,true_y_m\n".to_owned();
    for (number, walk) in walks.iter().enumerate() {
        for (Report { time_s, reckoned_m: pdr, fix_m: fix }, truth) in &walk.reports {
            writeln!(
                text,
                "{number},{time_s},{},{},{},{},{},{}",
                pdr.x, pdr.y, fix.x, fix.y, truth.x, truth.y
            )?;
        }
    }
    Ok(text)
}
