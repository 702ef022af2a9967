//! `adit calibrate mag`: a tumble in, hard and soft iron out.

use super::{deliver, readings, sidecar};
use crate::args::CalibrateMagArgs;
use crate::output;
use crate::progress;
use adit_core::time::Time;
use adit_evaluation::plot::{MagneticCloud, magnetometer_figure};
use adit_observation::sidecar::MagneticFieldReference;
use adit_tuning::geomagnetic::{self, Day, SiteField};
use adit_tuning::magnetometer::{AlignmentSource, KnownField, MagnetometerFit, Tumble, calibrate};
use anyhow::{Context, Result};
use serde::Serialize;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::{SystemTime, UNIX_EPOCH};

/// A dip farther from that of the site is worth a warning, deg.
const STRANGE_DIP_DEG: f64 = 8.0;
/// A dip that varies by more is not written down, deg.
const UNSTEADY_DIP_DEG: f64 = 5.0;

/// What `--json` prints.
#[derive(Debug, Serialize)]
struct Report<'a> {
    logs: &'a [PathBuf],
    calibration: &'a MagnetometerFit,
    site: Option<Site>,
    declination_deg: Option<f64>,
    reference: Reference,
    warnings: Vec<String>,
}

/// The field of the site by the model.
#[derive(Debug, Clone, Serialize)]
struct Site {
    date: String,
    #[serde(flatten)]
    field: SiteField,
}

/// What is written into `[magnetic_field]`.
#[derive(Debug, Clone, Copy, Serialize)]
struct Reference {
    norm_ut: Option<f64>,
    dip_deg: Option<f64>,
}

/// Calibrates, writes sidecar and figure, says what was found.
pub fn run(args: &CalibrateMagArgs) -> Result<()> {
    // Before any work: a sidecar that cannot be completed.
    let mut edit = sidecar(&args.out)?;
    let tumble = readings::read(&args.logs)?;
    let site = site(args, &tumble)?;
    let known = KnownField {
        norm_ut: args.field_norm.or(site.as_ref().map(|site| site.field.norm_ut)),
        mirrored: args.mirrored,
    };
    let fit = calibrate(&tumble, &known).with_context(|| names(args))?;
    let steady = fit.alignment.dip_spread_deg.is_some_and(|spread| spread < UNSTEADY_DIP_DEG);
    let measured_dip = fit.alignment.dip_deg.filter(|_| steady);
    let reference = Reference {
        norm_ut: Some(fit.norm_ut),
        dip_deg: site.as_ref().map(|site| site.field.dip_deg).or(measured_dip),
    };
    let declination_deg = args.declination.or(site.as_ref().map(|site| site.field.declination_deg));

    edit.set_magnetometer(&fit.calibration);
    let Reference { norm_ut, dip_deg } = reference;
    edit.set_magnetic_field(&MagneticFieldReference { norm_ut, dip_deg });
    if let Some(declination_deg) = declination_deg {
        edit.set_declination_deg(declination_deg);
    }
    if let Some(path) = &args.plot {
        output::write_file(path, &figure(args, &tumble, &fit)?)?;
    }
    let mut warnings = fit.warnings.clone();
    warnings.extend(site.as_ref().and_then(|site| strange_dip(&site.field, &fit)));
    progress::warn(&warnings);
    let report = Report { logs: &args.logs, calibration: &fit, site, declination_deg, reference, warnings };
    let said = if args.json { serde_json::to_string_pretty(&report)? + "\n" } else { table(args, &report)? };
    deliver(&args.out, &edit, &said)
}

fn names(args: &CalibrateMagArgs) -> String {
    args.logs.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ")
}

fn site(args: &CalibrateMagArgs, tumble: &Tumble) -> Result<Option<Site>> {
    let Some(place) = &args.site else { return Ok(None) };
    let of_log = || tumble.field_ut.times().first().copied().and_then(Day::of_unix);
    let day =
        args.date.or_else(of_log).or_else(today).context("the clock tells no day: give one by --date")?;
    let field = geomagnetic::field(place, &day)?;
    Ok(Some(Site { date: day.to_string(), field }))
}

fn today() -> Option<Day> {
    let since_epoch = SystemTime::now().duration_since(UNIX_EPOCH).ok()?;
    Day::of_unix(Time::from_nanos(i64::try_from(since_epoch.as_nanos()).ok()?))
}

/// A measured dip that contradicts the site's.
fn strange_dip(site: &SiteField, fit: &MagnetometerFit) -> Option<String> {
    let measured = fit.alignment.dip_deg.filter(|_| fit.alignment.source != AlignmentSource::Assumed)?;
    let off = (measured - site.dip_deg).abs();
    let upside_down = (measured + site.dip_deg).abs();
    (off > STRANGE_DIP_DEG).then(|| {
        let why = if upside_down < STRANGE_DIP_DEG {
            "an axis of the magnetometer has the wrong sign in the log (--mirrored), or the accelerometer points down at rest \
             ([frame] acceleration = \"gravity\" in a sidecar beside the log)"
        } else {
            "steel near by, or axes that are not what they seem"
        };
        format!("the field dips by {measured:.1}°, at this site it should by {:.1}°: {why}", site.dip_deg)
    })
}

fn figure(args: &CalibrateMagArgs, tumble: &Tumble, fit: &MagnetometerFit) -> Result<String> {
    let readings = &tumble.field_ut;
    let origin = readings.times().first().copied().unwrap_or_default();
    let time_s: Vec<f64> = readings.times().iter().map(|time| (*time - origin).seconds()).collect();
    let raw: Vec<[f64; 3]> = readings.readings().iter().map(|r| (*r).into()).collect();
    let calibrated: Vec<[f64; 3]> =
        readings.readings().iter().map(|r| fit.calibration.field_ut(r).into()).collect();
    let cloud =
        MagneticCloud { time_s: &time_s, raw_ut: &raw, calibrated_ut: &calibrated, norm_ut: fit.norm_ut };
    let shown = args.logs.iter().filter_map(|path| path.file_name()).map(|name| name.to_string_lossy());
    let title = format!("Magnetometer of {}", shown.collect::<Vec<_>>().join(", "));
    Ok(magnetometer_figure(&cloud, &title)?)
}

fn table(args: &CalibrateMagArgs, report: &Report<'_>) -> Result<String> {
    let mut table = format!("log         {}\n{}", names(args), report.calibration);
    if let Some(Site { date, field }) = &report.site {
        writeln!(
            table,
            "site        {date}: strength {:.2} µT, dip {:.1}°, declination {:.2} ± {:.2}° (World Magnetic Model 2025)",
            field.norm_ut, field.dip_deg, field.declination_deg, field.declination_sd_deg
        )?;
    }
    if let Some(declination) = args.declination {
        writeln!(table, "declination {declination:.2}°, given")?;
    }
    if let crate::output::Target::File(path) = &args.out {
        writeln!(table, "sidecar     {}", path.display())?;
    }
    if let Some(path) = &args.plot {
        writeln!(table, "figure      {}", path.display())?;
    }
    Ok(table)
}
