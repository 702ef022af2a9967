//! `adit calibrate noise`: a rest in, noise densities out.

use super::{deliver, readings, sidecar};
use crate::args::CalibrateNoiseArgs;
use crate::output::{self, Target};
use adit_evaluation::plot::{AllanAxis, AllanPanel, AllanParts, allan_figure};
use adit_tuning::noise::{InertialNoise, NoiseModel, SensorNoise, measure};
use anyhow::{Context, Result};
use serde::Serialize;
use std::fmt::Write as _;
use std::path::Path;

/// What `--json` prints.
#[derive(Debug, Serialize)]
struct Report<'a> {
    log: &'a Path,
    noise: &'a InertialNoise,
    densities: adit_observation::ImuSpecification,
}

/// Measures, writes sidecar and figure, says what was found.
pub fn run(args: &CalibrateNoiseArgs) -> Result<()> {
    let mut edit = sidecar(&args.out)?;
    let log = readings::read(std::slice::from_ref(&args.log))?;
    let noise = measure(&log.angular_rate_rad_s, &log.specific_force_m_s2)
        .with_context(|| args.log.display().to_string())?;
    edit.set_noise(&noise.specification());
    if let Some(path) = &args.plot {
        output::write_file(path, &figure(args, &noise)?)?;
    }
    let said = if args.json {
        let report = Report { log: &args.log, noise: &noise, densities: noise.specification() };
        serde_json::to_string_pretty(&report)? + "\n"
    } else {
        let mut table = format!("log         {}\n{noise}", args.log.display());
        if let Target::File(path) = &args.out {
            writeln!(table, "sidecar     {}", path.display())?;
        }
        if let Some(path) = &args.plot {
            writeln!(table, "figure      {}", path.display())?;
        }
        table
    };
    deliver(&args.out, &edit, &said)
}

fn figure(args: &CalibrateNoiseArgs, noise: &InertialNoise) -> Result<String> {
    let panel = |heading: &'static str, unit: &'static str, sensor: &SensorNoise| {
        let axes = sensor.axes.iter().map(|axis| {
            let NoiseModel { quantisation, white, instability, walk } = axis.fit.model;
            AllanAxis {
                name: axis.axis,
                curve: axis.curve.iter().map(|p| (p.tau_s, p.deviation, p.sd)).collect(),
                parts: AllanParts { quantisation, white, instability, walk },
            }
        });
        AllanPanel { heading, unit, axes: axes.collect() }
    };
    let panels = [panel("Gyro", "rad/s", &noise.gyro), panel("Accelerometer", "m/s²", &noise.accelerometer)];
    let name = args.log.file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
    Ok(allan_figure(&panels, &format!("Allan deviation of {name}, at rest for {:.0} s", noise.duration_s))?)
}
