//! A simulated lower back against recorded ones: `cargo run -p adit-simulation --example waist_figures WAIST.svg`.
//!
//! Reads `gait-lowback` and `steps` below `$ADIT_DATA` (default `../shared/data`); says so and goes on without them where they are absent.

use adit_core::frames::Position;
use adit_core::nalgebra::Vector3;
use adit_mine::Mine;
use adit_mine::plan::{Grid, MinePlan, Roadway, RoadwayKind};
use adit_simulation::IdealImu;
use adit_simulation::people::{Belt, Body, Errand, Pace, PersonSpec, Place, Population, PopulationSpec};
use core::f64::consts::TAU;
use plotters::prelude::*;
use std::collections::HashMap;
use std::error::Error;
use std::fs::File;
use std::path::{Path, PathBuf};

/// Times (s), specific force (m/s²), rate (rad/s).
#[derive(Default, Clone)]
struct Walk {
    time_s: Vec<f64>,
    force: Vec<Vector3<f64>>,
    rate: Vec<Vector3<f64>>,
}

/// Step length by the tape, m; none where it is not known.
type Figures = [f64; 18];
const NAMES: [&str; 18] = [
    "step time, s",
    "vertical, peak to peak in a step, m/s²",
    "vertical, rms, m/s²",
    "forward, rms, m/s²",
    "sideways, rms, m/s²",
    "vertical at step frequency, m/s²",
    "vertical at twice that, m/s²",
    "forward at step frequency, m/s²",
    "forward at twice that, m/s²",
    "sideways at stride frequency, m/s²",
    "sideways at thrice that, m/s²",
    "harmonic ratio, vertical",
    "harmonic ratio, sideways",
    "rate about the vertical, rms, rad/s",
    "rate about sideways, rms, rad/s",
    "rate about forward, rms, rad/s",
    "speed, m/s",
    "step length over cadence, m·min",
];

fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::args().nth(1).ok_or("usage: waist_figures WAIST.svg")?;
    let data = std::env::var("ADIT_DATA").map_or_else(|_| PathBuf::from("../shared/data"), PathBuf::from);
    let simulated: Vec<(Walk, f64, f64)> = [0.95, 1.05, 1.15, 1.25, 1.35, 1.45]
        .into_iter()
        .flat_map(|speed| [1.65, 1.75, 1.85].map(|height| (speed, height)))
        .map(|(speed, height)| Ok((simulate(speed, height)?, speed, height)))
        .collect::<Result<_, Box<dyn Error>>>()?;
    let ours: Vec<Figures> = simulated.iter().map(|(walk, speed, _)| figures(walk, *speed)).collect();

    let set = data.join("gait-lowback");
    let mut recorded: Vec<Figures> = Vec::new();
    let mut example = None;
    if set.is_dir() {
        for trial in trials(&set.join("trials.csv"))? {
            let name = trial["trial"].clone();
            let walk = read(&set.join(format!("{name}_imu.csv.gz")))?;
            let time = |key: &str| trial[key].parse::<f64>();
            let (start, turn) = (time("walk_start_time_s")?, time("uturn_start_time_s")?);
            let (turned, end) = (time("uturn_end_time_s")?, time("walk_end_time_s")?);
            for (from, until) in [(start + 1.5, turn - 0.5), (turned + 0.5, end - 1.5)] {
                let part = cut(&walk, from, until);
                if part.time_s.len() > 300 {
                    recorded.push(figures(&part, 10.0 / (turn - start)));
                    if name == "s07_t1" && example.is_none() {
                        example = Some(part);
                    }
                }
            }
        }
    } else {
        println!("SKIPPED (no test data): gait-lowback");
    }
    println!("| figure | recorded, 10 %, median, 90 % of {} | simulated |\n|---|---|---|", recorded.len());
    for (index, name) in NAMES.iter().enumerate() {
        let [low, middle, high] = spread(&recorded, index);
        let [a, b, c] = spread(&ours, index);
        println!("| {name} | {low:.3} {middle:.3} {high:.3} | {a:.3} {b:.3} {c:.3} |");
    }
    phones(&data.join("steps"))?;
    draw(&out, example.as_ref(), &simulated[7].0)
}

/// A minute of walking in a straight roadway, tag on the back, 100 Hz.
fn simulate(speed: f64, height: f64) -> Result<Walk, Box<dyn Error>> {
    let mut plan = MinePlan::new("straight", Grid::Local {});
    plan.roadways.push(Roadway {
        id: "a".into(),
        name: None,
        level: None,
        kind: RoadwayKind::Drift,
        width_m: 5.0,
        height_m: 3.0,
        max_slope_percent: None,
        walkable: true,
        points_m: vec![Position::new(0.0, 0.0, 0.0), Position::new(90.0, 0.0, 0.0)],
    });
    let mine = Mine::new(plan)?;
    let place = |along_m| Place::Roadway { id: "a".into(), along_m, left_m: 0.0 };
    let body = Body { walk_m_s: speed, height_m: height, ..Body::default() };
    let errands = vec![
        Errand::Stand { seconds: 2.0 },
        Errand::Go { to: place(88.0), pace: Pace::Walk, speed_m_s: None },
    ];
    let person = PersonSpec { body, drawn: false, start: place(2.0), errands };
    let population =
        Population::new(&mine, &PopulationSpec { persons: vec![person], ..PopulationSpec::default() }, 4)?;
    let person = population.person(0).ok_or("nobody")??;
    let waist = person.waist(Belt::back());
    let mut walk = Walk::default();
    let imu = IdealImu::default();
    let mut before_s = 0.0;
    while before_s < person.duration_s() {
        let time_s = before_s + 0.01;
        let sample = imu.sample(&waist, before_s, time_s);
        walk.time_s.push(time_s);
        walk.force.push(sample.specific_force_m_s2);
        walk.rate.push(sample.angular_rate_rad_s);
        before_s = time_s;
    }
    let end = person.duration_s() - 6.0;
    Ok(cut(&walk, 14.0, end))
}

fn cut(walk: &Walk, from: f64, until: f64) -> Walk {
    let inside = |i: &usize| (from..until).contains(&walk.time_s[*i]);
    let kept: Vec<usize> = (0..walk.time_s.len()).filter(inside).collect();
    Walk {
        time_s: kept.iter().map(|i| walk.time_s[*i]).collect(),
        force: kept.iter().map(|i| walk.force[*i]).collect(),
        rate: kept.iter().filter_map(|i| walk.rate.get(*i).copied()).collect(),
    }
}

/// Complex amplitude of a signal at a frequency over whole periods.
fn tone(time: &[f64], signal: &[f64], frequency: f64) -> (f64, f64) {
    let (mut c, mut s) = (0.0, 0.0);
    for (t, x) in time.iter().zip(signal) {
        let (sin, cos) = (TAU * frequency * (t - time[0])).sin_cos();
        c += x * cos;
        s += x * sin;
    }
    let scale = 2.0 / time.len() as f64;
    (c * scale, s * scale)
}

fn amplitude(time: &[f64], signal: &[f64], frequency: f64) -> f64 {
    let (c, s) = tone(time, signal, frequency);
    c.hypot(s)
}

fn rms(signal: &[f64]) -> f64 {
    (signal.iter().map(|x| x * x).sum::<f64>() / signal.len() as f64).sqrt()
}

/// Vertical part less its mean, and the frequency of strides.
fn vertical(walk: &Walk) -> (Vector3<f64>, Vec<f64>, f64) {
    let count = walk.force.len() as f64;
    let mean = walk.force.iter().sum::<Vector3<f64>>() / count;
    let up = mean.normalize();
    let signal: Vec<f64> = walk.force.iter().map(|f| f.dot(&up) - mean.norm()).collect();
    let strength =
        |f: f64| [2.0, 4.0].map(|n| amplitude(&walk.time_s, &signal, n * f).powi(2)).iter().sum::<f64>();
    let best =
        (0..200).map(|i| 0.68 + 0.0025 * f64::from(i)).max_by(|a, b| strength(*a).total_cmp(&strength(*b)));
    (up, signal, best.unwrap_or(0.9))
}

fn figures(walk: &Walk, speed: f64) -> Figures {
    let (up, z, stride) = vertical(walk);
    let mean = walk.force.iter().sum::<Vector3<f64>>() / walk.force.len() as f64;
    let level: Vec<Vector3<f64>> = walk.force.iter().map(|f| f - mean - up * (f - mean).dot(&up)).collect();
    // Sideways is where the odd harmonics of the stride are.
    let (e1, e2) = axes(&up);
    let along = |axis: &Vector3<f64>| level.iter().map(|f| f.dot(axis)).collect::<Vec<f64>>();
    let odd = |axis: &Vector3<f64>| {
        let signal = along(axis);
        [1.0, 3.0].map(|n| amplitude(&walk.time_s, &signal, n * stride).powi(2)).iter().sum::<f64>()
    };
    let side = (0..90)
        .map(|i| f64::from(i) * TAU / 180.0)
        .map(|angle| e1 * angle.cos() + e2 * angle.sin())
        .max_by(|a, b| odd(a).total_cmp(&odd(b)))
        .unwrap_or(e1);
    let ahead = side.cross(&up);
    let (x, y) = (along(&ahead), along(&side));
    let at = |signal: &[f64], n: f64| amplitude(&walk.time_s, signal, n * stride);
    let ratio = |signal: &[f64], first: u32| {
        let sum = |start: u32| (0..5).map(|i| at(signal, f64::from(start + 2 * i))).sum::<f64>();
        sum(first) / sum(3 - first)
    };
    let step_s = 0.5 / stride;
    let steps = ((walk.time_s.last().unwrap_or(&0.0) - walk.time_s[0]) / step_s).floor();
    let mut peaks: Vec<f64> = (0..10_000)
        .map(f64::from)
        .take_while(|i| *i < steps)
        .map(|i| {
            let from = walk.time_s[0] + i * step_s;
            let inside = walk.time_s.iter().zip(&z).filter(|(t, _)| (from..from + step_s).contains(*t));
            let (low, high) = inside.fold((0.0_f64, 0.0_f64), |(l, h), (_, z)| (l.min(*z), h.max(*z)));
            high - low
        })
        .collect();
    peaks.sort_by(f64::total_cmp);
    let turning = |axis: &Vector3<f64>| rms(&walk.rate.iter().map(|w| w.dot(axis)).collect::<Vec<f64>>());
    let (up_rate, side_rate, ahead_rate) = (turning(&up), turning(&side), turning(&ahead));
    [
        step_s,
        peaks[peaks.len() / 2],
        rms(&z),
        rms(&x),
        rms(&y),
        at(&z, 2.0),
        at(&z, 4.0),
        at(&x, 2.0),
        at(&x, 4.0),
        at(&y, 1.0),
        at(&y, 3.0),
        ratio(&z, 2),
        ratio(&y, 1),
        up_rate,
        side_rate,
        ahead_rate,
        speed,
        speed * step_s * step_s / 60.0,
    ]
}

/// Two axes square to a third and to each other.
fn axes(up: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
    let e1 = up.cross(&if up.x.abs() < 0.8 { Vector3::x() } else { Vector3::y() }).normalize();
    (e1, up.cross(&e1))
}

fn spread(figures: &[Figures], index: usize) -> [f64; 3] {
    let mut values: Vec<f64> = figures.iter().map(|figure| figure[index]).collect();
    values.sort_by(f64::total_cmp);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index")]
    let at = |share: f64| values.get((share * (values.len() as f64 - 1.0)).round() as usize).copied();
    [0.1, 0.5, 0.9].map(|share| if values.is_empty() { f64::NAN } else { at(share).unwrap_or(f64::NAN) })
}

/// Phones in pockets, pouches and bags: no axes to compare, but steps and strength.
fn phones(set: &Path) -> Result<(), Box<dyn Error>> {
    if !set.is_dir() {
        println!("SKIPPED (no test data): steps");
        return Ok(());
    }
    println!("\n| phone | step time, s | counted, s | vertical rms, m/s² |\n|---|---|---|---|");
    for row in trials(&set.join("counts.csv"))? {
        let name = &row["recording"];
        let walk = read(&set.join(format!("{name}_imu.csv.gz")))?;
        let end = walk.time_s.last().copied().unwrap_or(0.0);
        let counted = row["duration_s"].parse::<f64>()? / row["steps_true"].parse::<f64>()?;
        let part = cut(&walk, 0.3 * end, 0.3 * end + 20.0);
        let (_, z, stride) = vertical(&part);
        println!("| {name} | {:.3} | {counted:.3} | {:.2} |", 0.5 / stride, rms(&z));
    }
    Ok(())
}

fn trials(file: &Path) -> Result<Vec<HashMap<String, String>>, Box<dyn Error>> {
    Ok(csv::Reader::from_path(file)?.deserialize().collect::<Result<_, _>>()?)
}

fn read(file: &Path) -> Result<Walk, Box<dyn Error>> {
    let mut reader = csv::Reader::from_reader(flate2::read::GzDecoder::new(File::open(file)?));
    let mut walk = Walk::default();
    for row in reader.records() {
        let row = row?;
        let at = |i: usize| row.get(i).and_then(|v| v.parse::<f64>().ok());
        if let (Some(t), Some(x), Some(y), Some(z)) = (at(0), at(1), at(2), at(3)) {
            walk.time_s.push(t);
            walk.force.push(Vector3::new(x, y, z));
            if let (Some(x), Some(y), Some(z)) = (at(4), at(5), at(6)) {
                walk.rate.push(Vector3::new(x, y, z));
            }
        }
    }
    Ok(walk)
}

fn draw(out: &str, recorded: Option<&Walk>, simulated: &Walk) -> Result<(), Box<dyn Error>> {
    let root = SVGBackend::new(out, (1000, if recorded.is_some() { 560 } else { 290 })).into_drawing_area();
    root.fill(&WHITE)?;
    // Recorded signals stay out of figures that are published: without the data only the simulated one is drawn.
    let mut shown = vec![("simulated, 1.15 m/s, 1.75 m", simulated)];
    shown.extend(recorded.map(|walk| ("recorded (gait-lowback, s07_t1)", walk)));
    let panels = root.split_evenly((shown.len(), 1));
    for (panel, (title, walk)) in panels.iter().zip(shown) {
        let (_, z, _) = vertical(walk);
        let mut chart = ChartBuilder::on(panel)
            .caption(format!("Vertical acceleration of the lower back: {title}"), ("sans-serif", 16))
            .margin(8)
            .x_label_area_size(32)
            .y_label_area_size(44)
            .build_cartesian_2d(0.0..6.0, -8.0..12.0)?;
        chart.configure_mesh().x_desc("time, s").y_desc("m/s²").light_line_style(WHITE).draw()?;
        let start = walk.time_s.first().copied().unwrap_or(0.0);
        let line = walk.time_s.iter().zip(&z).map(|(t, z)| (t - start, *z)).take_while(|(t, _)| *t < 6.0);
        chart.draw_series(LineSeries::new(line, RGBColor(0, 114, 178).stroke_width(2)))?;
    }
    root.present()?;
    Ok(())
}
