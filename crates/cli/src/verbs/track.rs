//! `adit track`: a log in, a path out.

use crate::args::TrackArgs;
use crate::interrupt;
use crate::journey::Journey;
use crate::judged_ranges::{self, JudgedRanges};
use crate::log_stream::LogStream;
use crate::method::{self, MethodName, with_settings};
use crate::output::{self, Staged, Target};
use crate::progress::{self, Progress, Unit};
use crate::radio_site;
use adit_core::solution::Solution;
use adit_core::trajectory::Pose;
use adit_estimation::methods::{Estimates, MethodReport, MethodSettings, Nis};
use adit_observation::Observation;
use adit_observation::solution_csv::SolutionWriter;
use adit_observation::tum::TumWriter;
use anyhow::{Context, Result, bail};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Observations between two looks at the clock, the bar and Ctrl-C.
const PULSE: u64 = 4096;

/// Tracks and writes everything asked for.
pub fn run(args: &TrackArgs) -> Result<()> {
    let report = track(args)?;
    progress::warn(&report.warnings);
    if let Some(target) = &args.json {
        target.write(&(serde_json::to_string_pretty(&report)? + "\n"))?;
    }
    let stdout_is_taken = args.out == Target::Stdout || args.json == Some(Target::Stdout);
    if stdout_is_taken {
        output::tell(&report.summary());
        Ok(())
    } else {
        output::print(&report.summary())
    }
}

/// What `--json` writes.
#[derive(Debug, Serialize)]
pub struct TrackReport {
    method: &'static str,
    estimates: Estimates,
    logs: Vec<PathBuf>,
    smoothed: bool,
    lag_s: Option<f64>,
    inertial_samples: u64,
    /// Ranges that `--nlos` judged, where it is given.
    judged_ranges: Option<u64>,
    poses: u64,
    start_s: f64,
    duration_s: f64,
    /// Nothing of these four where the method estimates attitude alone.
    distance_m: Option<f64>,
    end_from_start_2d_m: Option<f64>,
    end_from_start_up_m: Option<f64>,
    end_radius_95_m: Option<f64>,
    end_heading_sigma_deg: Option<f64>,
    end_inclination_sigma_deg: Option<f64>,
    share_at_rest: Option<f64>,
    /// Normalised innovations squared of the measurements used, where the method tells.
    nis: Option<Nis>,
    elapsed_s: f64,
    times_real_time: f64,
    warnings: Vec<String>,
    method_report: serde_json::Value,
}

/// Tracks logs into files; the files appear only when all went well.
pub fn track(args: &TrackArgs) -> Result<TrackReport> {
    with_settings!(args.method, S => track_by::<S>(args))
}

fn track_by<S: MethodSettings>(args: &TrackArgs) -> Result<TrackReport> {
    let clock = Instant::now();
    let stream = LogStream::open(&args.logs)?;
    let mut settings: S = method::settings(stream.sidecar(), args.config.as_deref())?;
    if let Some(site) = radio_site::read(args.mine.as_deref(), &args.radio)? {
        settings = settings.at_site(&site);
    }
    tracing::debug!("settings: {settings:?}");
    let model = args.nlos.as_deref().map(|name| judged_ranges::model(name, Path::new(""))).transpose()?;
    let mut log = Log { stream, ranges: model.as_ref().map(JudgedRanges::by) };
    let mut outputs = Outputs::create(args)?;
    let run = if args.smooth {
        smooth(&mut log, settings, &mut outputs)?
    } else {
        filter(&mut log, settings, args.lag, &mut outputs)?
    };
    if outputs.journey.poses() == 0 {
        bail!("{}: no inertial samples, expected some: {} needs them", log.stream.name(), S::NAME);
    }
    let Log { stream, ranges } = log;
    let journey = outputs.finish()?;
    let mut warnings = stream.warnings();
    warnings.extend(stream.sidecar().and_then(|sidecar| args.method.objection(sidecar)));
    warnings.extend(ranges.as_ref().and_then(JudgedRanges::warning));
    warnings.extend(method::warnings(run.report.warnings()));
    let judged_ranges = ranges.map(|ranges| ranges.judged());
    report::<S>(args, &run, &journey, judged_ranges, warnings, clock.elapsed().as_secs_f64())
}

/// A log whose ranges are judged as they pass, where somebody asked for it.
struct Log {
    stream: LogStream,
    ranges: Option<JudgedRanges>,
}

impl Log {
    fn next(&mut self) -> Result<Option<Observation>> {
        let mut next = self.stream.next()?;
        if let (Some(observation), Some(ranges)) = (&mut next, &mut self.ranges) {
            ranges.see(observation);
        }
        Ok(next)
    }
}

/// What a pass over the log leaves behind.
struct Run<Report> {
    inertial_samples: u64,
    report: Report,
}

/// One observation at a time, in bounded memory.
fn filter<S: MethodSettings>(
    log: &mut Log,
    settings: S,
    lag_s: Option<f64>,
    outputs: &mut Outputs,
) -> Result<Run<S::Report>> {
    let progress = Progress::new("tracking", Unit::Bytes, log.stream.bytes_total());
    let mut method = match lag_s {
        None => settings.start()?,
        Some(lag_s) => settings.start_fixed_lag(lag_s)?,
    };
    let (mut inertial_samples, mut count) = (0, 0_u64);
    while let Some(observation) = log.next()? {
        inertial_samples += u64::from(is_inertial(&observation));
        let place = || format!("{}: at {} s", log.stream.name(), observation.time());
        let mut solution = method.observe(&observation).with_context(place)?;
        while let Some(due) = solution {
            outputs.push(&due)?;
            solution = method.next_due().with_context(place)?;
        }
        count += 1;
        if count.is_multiple_of(PULSE) {
            interrupt::check()?;
            progress.at(log.stream.bytes_read());
        }
    }
    while let Some(solution) = method.finish_next().with_context(|| log.stream.name())? {
        outputs.push(&solution)?;
    }
    Ok(Run { inertial_samples, report: method.report().clone() })
}

/// An accelerometer, with a gyro or without.
fn is_inertial(observation: &Observation) -> bool {
    matches!(observation, Observation::Imu(_) | Observation::Acceleration(_))
}

/// The whole log at once.
fn smooth<S: MethodSettings>(log: &mut Log, settings: S, outputs: &mut Outputs) -> Result<Run<S::Report>> {
    let mut observations = Vec::new();
    {
        let progress = Progress::new("reading", Unit::Bytes, log.stream.bytes_total());
        while let Some(observation) = log.next()? {
            observations.push(observation);
            if (observations.len() as u64).is_multiple_of(PULSE) {
                interrupt::check()?;
                progress.at(log.stream.bytes_read());
            }
        }
    }
    let progress = Progress::new("smoothing", Unit::Samples, Some(2 * observations.len() as u64));
    let solutions = settings.smooth(&observations, &mut |done| progress.at(done as u64));
    let (solutions, report) = solutions.with_context(|| log.stream.name())?;
    interrupt::check()?;
    for solution in &solutions {
        outputs.push(solution)?;
    }
    let inertial_samples = observations.iter().filter(|o| is_inertial(o)).count() as u64;
    Ok(Run { inertial_samples, report })
}

/// The files being written, and the sums over all solutions.
struct Outputs {
    staged: Staged,
    trajectory: TumWriter,
    covariance: Option<SolutionWriter>,
    thinning: Option<Thinning>,
    journey: Journey,
}

/// Which solutions are written: those at or next after the multiples of a time, and the last.
struct Thinning {
    every_s: f64,
    /// The multiple that the next one serves.
    due_s: f64,
    /// The latest that was not written.
    skipped: Option<Solution>,
}

impl Thinning {
    fn new(every_s: f64) -> Self {
        Self { every_s, due_s: f64::NEG_INFINITY, skipped: None }
    }

    /// Whether to write it.
    fn takes(&mut self, solution: &Solution) -> bool {
        // Half a microsecond, for samples that fall on the grid.
        let time_s = solution.time.seconds() + 5e-7;
        let due = time_s >= self.due_s;
        if due {
            self.due_s = ((time_s / self.every_s).floor() + 1.0) * self.every_s;
            self.skipped = None;
        } else {
            self.skipped = Some(solution.clone());
        }
        due
    }
}

impl Outputs {
    fn create(args: &TrackArgs) -> Result<Self> {
        let staged = Staged::new(&args.out)?;
        Ok(Self {
            trajectory: TumWriter::create(staged.path())?,
            staged,
            covariance: args.covariance.as_ref().map(SolutionWriter::create).transpose()?,
            thinning: args.every.map(Thinning::new),
            journey: Journey::default(),
        })
    }

    fn push(&mut self, solution: &Solution) -> Result<()> {
        self.journey.push(solution);
        if self.thinning.as_mut().is_none_or(|thinning| thinning.takes(solution)) {
            self.write(solution)?;
        }
        Ok(())
    }

    fn write(&mut self, solution: &Solution) -> Result<()> {
        let Solution { time, position_m, attitude, .. } = *solution;
        self.trajectory.push(&Pose { time, position_m, attitude })?;
        if let Some(file) = &mut self.covariance {
            file.push(solution)?;
        }
        Ok(())
    }

    fn finish(mut self) -> Result<Journey> {
        if let Some(last) = self.thinning.take().and_then(|thinning| thinning.skipped) {
            self.write(&last)?;
        }
        self.trajectory.finish()?;
        if let Some(file) = self.covariance {
            file.finish()?;
        }
        self.staged.deliver()?;
        Ok(self.journey)
    }
}

fn report<S: MethodSettings>(
    args: &TrackArgs,
    run: &Run<S::Report>,
    journey: &Journey,
    judged_ranges: Option<u64>,
    warnings: Vec<String>,
    elapsed_s: f64,
) -> Result<TrackReport> {
    let back_m = journey.end_from_start_m();
    let path = S::ESTIMATES != Estimates::Attitude;
    let turned = S::ESTIMATES != Estimates::Position;
    Ok(TrackReport {
        method: S::NAME,
        estimates: S::ESTIMATES,
        logs: args.logs.clone(),
        smoothed: args.smooth,
        lag_s: args.lag,
        inertial_samples: run.inertial_samples,
        judged_ranges,
        poses: journey.poses(),
        start_s: journey.times().map_or(0.0, |(first, _)| first.seconds()),
        duration_s: journey.duration_s(),
        distance_m: path.then_some(journey.distance_m()),
        end_from_start_2d_m: path.then_some(back_m.xy().norm()),
        end_from_start_up_m: path.then_some(back_m.z),
        end_radius_95_m: journey.radius_95_m().filter(|_| path),
        end_heading_sigma_deg: journey.heading_sigma_rad().map(f64::to_degrees).filter(|_| turned),
        end_inclination_sigma_deg: journey.inclination_sigma_rad().map(f64::to_degrees).filter(|_| turned),
        share_at_rest: run.report.share_at_rest(),
        nis: run.report.nis(),
        elapsed_s,
        times_real_time: journey.duration_s() / elapsed_s.max(f64::MIN_POSITIVE),
        warnings,
        method_report: method::details(&run.report)?,
    })
}

impl TrackReport {
    /// The report for eyes.
    pub fn summary(&self) -> String {
        let line = |name: &str, value: String| format!("{name:<12}{value}\n");
        let smoothed = match (self.smoothed, self.lag_s) {
            (true, _) => ", smoothed over the whole log".to_owned(),
            (false, Some(lag)) => format!(", smoothed over {lag} s"),
            (false, None) => String::new(),
        };
        let mut text = line("method", format!("{}{smoothed}", self.method));
        text += &line(
            "duration",
            format!("{:.1} s, {} inertial samples", self.duration_s, self.inertial_samples),
        );
        if let Some(distance_m) = self.distance_m {
            text += &line("distance", format!("{distance_m:.2} m"));
        }
        if let (Some(level_m), Some(up_m)) = (self.end_from_start_2d_m, self.end_from_start_up_m) {
            text += &line("end", format!("{level_m:.2} m from the start, {up_m:+.2} m up"));
        }
        match (self.end_radius_95_m, self.end_heading_sigma_deg, self.end_inclination_sigma_deg) {
            (Some(radius_m), ..) => {
                text += &line("certainty", format!("the end is within {radius_m:.2} m (95 %)"));
            }
            (None, Some(heading_deg), Some(inclination_deg)) => {
                let value = format!(
                    "at the end heading ±{heading_deg:.1}°, inclination ±{inclination_deg:.1}° (1 σ)"
                );
                text += &line("certainty", value);
            }
            _ => {}
        }
        if let Some(share) = self.share_at_rest {
            text += &line("at rest", format!("{:.0} % of the time", 100.0 * share));
        }
        text + &line("speed", format!("{:.0} × real time ({:.2} s)", self.times_real_time, self.elapsed_s))
    }

    /// Everything odd about the log and the run.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Seconds of log per second of work.
    pub fn times_real_time(&self) -> f64 {
        self.times_real_time
    }

    /// Settings of a plain run of a method, for verbs that track on the way.
    pub fn arguments(
        log: PathBuf,
        method: MethodName,
        config: PathBuf,
        out: PathBuf,
        covariance: PathBuf,
    ) -> TrackArgs {
        TrackArgs {
            logs: vec![log],
            method,
            out: Target::File(out),
            config: Some(config),
            mine: None,
            radio: Vec::new(),
            nlos: None,
            smooth: false,
            lag: None,
            every: None,
            json: None,
            covariance: Some(covariance),
        }
    }
}
