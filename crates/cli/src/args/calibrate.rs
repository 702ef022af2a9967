//! `adit calibrate`: its verbs and their flags.

use super::number;
use super::radio::{CalibrateFingerprintArgs, CalibratePathlossArgs};
use super::range::CalibrateRangeArgs;
use crate::output::Target;
use adit_tuning::geomagnetic::{Day, Site};
use clap::{Args, Subcommand, ValueHint};
use std::path::PathBuf;

const MAG_EXAMPLES: &str = "\
The log:
  a tumble on one spot, away from steel: each of the six sides up in turn, once around there, in a minute or two. CSV or MCAP, with
  or without gyro and accelerometer (in the same file or in one of their own, on one clock). With a gyro, or else an
  accelerometer, the axes of the magnetometer are turned onto theirs; without, they are assumed to be parallel.
  A sidecar beside the log is not applied: the calibration is made of raw readings.

The sidecar:
  gets [magnetometer] offset_ut and matrix (field = matrix · (reading − offset)), [magnetic_field] norm_ut and dip_deg, and the
  declination where it is known. What else stands in it stays, comments too. Put it beside a log (WALK.toml for
  WALK.csv) and `adit track` applies it.

Exit code 1, and no sidecar, when the motion showed the sensor too little: the message says which directions are missing.

Examples:
  adit calibrate mag tumble.csv -o tag7.toml --plot tumble.svg
  adit calibrate mag mag.csv.gz gyro.csv.gz acc.csv.gz -o tag7.toml --site 50.92,13.34,400
  adit calibrate mag tumble.mcap -o tag7.toml --field-norm 49.4 --declination 4.3 --json";

const NOISE_EXAMPLES: &str = "\
The log:
  the sensor at rest on something solid: five minutes at least, an hour for the bias instability, best after it has warmed up.
  The longest still stretch is used. A sidecar beside the log is not applied.

The sidecar:
  gets [noise], the densities that `adit track` reads: for each sensor the worst of its axes. What else stands in it stays.

Examples:
  adit calibrate noise rest.csv.gz -o tag7.toml --plot allan.svg
  adit calibrate noise rest.mcap -o tag7.toml --json";

/// `adit calibrate`.
#[derive(Debug, Args)]
pub struct CalibrateArgs {
    /// What to calibrate
    #[command(subcommand)]
    pub what: Calibration,
}

/// What can be calibrated.
#[derive(Debug, Subcommand)]
pub enum Calibration {
    /// Hard and soft iron of a magnetometer, from a tumble
    Mag(CalibrateMagArgs),
    /// Noise of gyro and accelerometer, from a rest
    Noise(CalibrateNoiseArgs),
    /// Path loss of access points or beacons and offsets of their ranges, from a survey or walks
    Pathloss(CalibratePathlossArgs),
    /// Radio map of a site, from fingerprints
    Fingerprint(CalibrateFingerprintArgs),
    /// How UWB ranges err: offsets of anchors, errors by how the signal came in, from ranges with a known distance
    Range(CalibrateRangeArgs),
}

impl Calibration {
    /// Sidecar and JSON both to stdout.
    pub fn takes_stdout_twice(&self) -> bool {
        let (out, json) = match self {
            Self::Mag(args) => (&args.out, args.json),
            Self::Noise(args) => (&args.out, args.json),
            Self::Pathloss(args) => (&args.out, args.radio.json),
            Self::Fingerprint(args) => (&args.out, args.radio.json),
            Self::Range(args) => (&args.out, args.json),
        };
        *out == Target::Stdout && json
    }
}

/// `adit calibrate mag`.
#[derive(Debug, Args)]
#[command(after_help = MAG_EXAMPLES)]
pub struct CalibrateMagArgs {
    /// Log of the tumble; several are one recording, one file per sensor, on one clock
    #[arg(value_name = "LOG", required = true, value_hint = ValueHint::FilePath)]
    pub logs: Vec<PathBuf>,

    /// Sidecar to write, or to complete where there is one; `-` is stdout
    #[arg(short, long, value_name = "SIDECAR.toml", value_hint = ValueHint::FilePath)]
    pub out: Target,

    /// Figure to write, SVG: length of the field before and after, and its points
    #[arg(long, value_name = "OUT.svg", value_hint = ValueHint::FilePath)]
    pub plot: Option<PathBuf>,

    /// Where: degrees, north and east positive, and metres above the ellipsoid; gives declination, dip and strength of the field
    /// by the World Magnetic Model
    #[arg(long, value_name = "LAT,LON[,HEIGHT_M]", value_parser = site, allow_hyphen_values = true)]
    pub site: Option<Site>,

    /// The day at --site; otherwise that of the log where its time is Unix time, else today
    #[arg(long, value_name = "YYYY-MM-DD", value_parser = day, requires = "site")]
    pub date: Option<Day>,

    /// Angle from true to magnetic north, degrees, east positive; goes before that of --site
    #[arg(long, value_name = "DEG", value_parser = angle, allow_negative_numbers = true)]
    pub declination: Option<f64>,

    /// Strength of the field, microtesla; goes before that of --site. With neither, the sensor's own scale stands
    #[arg(long, value_name = "UT", value_parser = strength, allow_negative_numbers = true)]
    pub field_norm: Option<f64>,

    /// An axis of the magnetometer has the wrong sign in the log
    #[arg(long)]
    pub mirrored: bool,

    /// Print one JSON object instead of the table
    #[arg(long)]
    pub json: bool,
}

/// `adit calibrate noise`.
#[derive(Debug, Args)]
#[command(after_help = NOISE_EXAMPLES)]
pub struct CalibrateNoiseArgs {
    /// Log of the rest
    #[arg(value_name = "LOG", value_hint = ValueHint::FilePath)]
    pub log: PathBuf,

    /// Sidecar to write, or to complete where there is one; `-` is stdout
    #[arg(short, long, value_name = "SIDECAR.toml", value_hint = ValueHint::FilePath)]
    pub out: Target,

    /// Figure to write, SVG: Allan deviation of each axis, the fit and its parts
    #[arg(long, value_name = "OUT.svg", value_hint = ValueHint::FilePath)]
    pub plot: Option<PathBuf>,

    /// Print one JSON object instead of the table
    #[arg(long)]
    pub json: bool,
}

fn angle(text: &str) -> Result<f64, String> {
    number(text, |v| (-180.0..=180.0).contains(&v), "degrees from -180 to 180")
}

fn strength(text: &str) -> Result<f64, String> {
    number(text, |v| (1.0..=1000.0).contains(&v), "microtesla from 1 to 1000 (the Earth has 22 to 67)")
}

fn site(text: &str) -> Result<Site, String> {
    let parts: Vec<f64> = text.split(',').filter_map(|part| part.trim().parse().ok()).collect();
    let whole = parts.len() == text.split(',').count();
    let (latitude_deg, longitude_deg, height_m) = match parts[..] {
        [latitude, longitude] if whole => (latitude, longitude, 0.0),
        [latitude, longitude, height] if whole => (latitude, longitude, height),
        _ => return Err("expected LAT,LON or LAT,LON,HEIGHT_M, as in 50.92,13.34,400".to_owned()),
    };
    if !(-90.0..=90.0).contains(&latitude_deg) || !(-180.0..=360.0).contains(&longitude_deg) {
        return Err("expected a latitude from -90 to 90 and a longitude from -180 to 180 degrees".to_owned());
    }
    if !(-5000.0..=9000.0).contains(&height_m) {
        return Err("expected a height from -5000 to 9000 m".to_owned());
    }
    Ok(Site { latitude_deg, longitude_deg, height_m })
}

fn day(text: &str) -> Result<Day, String> {
    let parts: Vec<&str> = text.split('-').collect();
    let numbers = match parts[..] {
        [year, month, day] => (year.parse().ok(), month.parse().ok(), day.parse().ok()),
        _ => (None, None, None),
    };
    let (Some(year), Some(month), Some(day)) = numbers else {
        return Err("expected a day as in 2026-11-22".to_owned());
    };
    Ok(Day { year, month, day })
}
