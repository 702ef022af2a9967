//! `adit calibrate`: what a sensor's own recording tells about its errors, into a sidecar; what a survey tells about the radio of a site.

mod mag;
mod noise;
pub mod radio;
mod range;
mod readings;

use crate::args::{CalibrateArgs, Calibration};
use crate::output::{self, Target};
use adit_observation::sidecar::SidecarEdit;
use anyhow::Result;
use std::path::Path;

/// Calibrates what was asked for.
pub fn run(args: &CalibrateArgs) -> Result<()> {
    match &args.what {
        Calibration::Mag(args) => mag::run(args),
        Calibration::Noise(args) => noise::run(args),
        Calibration::Pathloss(args) => radio::pathloss::run(args),
        Calibration::Fingerprint(args) => radio::fingerprint::run(args),
        Calibration::Range(args) => range::run(args),
    }
}

/// The sidecar that will be written, with what stands in it now.
fn sidecar(target: &Target) -> Result<SidecarEdit> {
    Ok(match target {
        Target::File(path) => SidecarEdit::open(path)?,
        Target::Stdout => SidecarEdit::parse(Path::new("stdout"), b"")?,
    })
}

/// Writes the sidecar, then the report: to stderr where stdout has the sidecar.
fn deliver(target: &Target, edit: &SidecarEdit, report: &str) -> Result<()> {
    match target {
        Target::File(_) => {
            edit.write()?;
            output::print(report)
        }
        Target::Stdout => {
            output::print(&edit.text()?)?;
            output::tell(report);
            Ok(())
        }
    }
}
