//! From the axes of the magnetometer to those of the inertial sensor.
//!
//! The length of the field leaves the rotation after the soft iron open: any rotation of a sphere is a sphere. The inertial
//! sensor closes it, in one of two ways:
//!
//! - `gyro`: a field that stands still in the room turns in the sensor as the gyro says. Needs a turning sensor, and no rest.
//! - `gravity`: the angle between field and gravity is the same in every attitude. Needs slow motion.
//!
//! The gyro is preferred, unless it contradicts the accelerometer: the same fit with gravity in the place of the field tells whether the two are
//! logged in one right-handed frame. Where they are not, gravity decides, since it is what headings are levelled by.
//!
//! Neither tells `R` from `−R`. Axes that are a right-handed frame in the log decide it; a log in which an axis
//! of the magnetometer has the wrong sign shows as a field that dips the wrong way.

mod gravity;
mod gyro;
mod rotation;

use crate::robust;
use adit_core::nalgebra::{Matrix3, Vector3};
use serde::Serialize;

/// Largest uncertainty of a rotation that is used, deg.
const LARGEST_SD_DEG: f64 = 1.0;
/// Largest angle between gyro and accelerometer that are one sensor: gravity in motion is no better a reference, deg.
const ONE_FRAME_DEG: f64 = 20.0;
/// Specific force is averaged over this time, s: at 2 rad/s that bends the direction by 0.1° at most.
const AVERAGED_S: f64 = 0.1;
/// Both ends of that time hold a sample that stands on them, whatever the last bit of its stamp.
const STAMP_SLACK_S: f64 = 1e-6;
/// Length of the mean specific force off its median at which the sensor was not accelerated, as a share.
const CALM: f64 = 0.05;
/// Samples needed for a dip.
const FEWEST_CALM: usize = 100;

/// Where the rotation between the sensors' axes comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum AlignmentSource {
    /// The field turns as the gyro says.
    Gyro,
    /// The field keeps its angle to gravity.
    Gravity,
    /// Not determined: the axes are taken as parallel.
    Assumed,
}

/// How the magnetometer's axes lie to those of the inertial sensor.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Alignment {
    /// Where it comes from.
    pub source: AlignmentSource,
    /// Why nothing better was had; empty where the gyro tells.
    pub reason: String,
    /// Turns the calibrated field into the axes of the inertial sensor; a mirror image where the user said so.
    #[serde(skip)]
    pub rotation: Matrix3<f64>,
    /// Angle of that rotation, deg.
    pub angle_deg: f64,
    /// Its uncertainty about x, y, z, σ, deg; zero where assumed.
    pub sd_deg: [f64; 3],
    /// What remains between the field and where it should be, robust σ, deg; zero where assumed.
    pub residual_deg: f64,
    /// Gyro bias found on the way, rad/s; zero where the gyro was not used.
    pub gyro_bias_rad_s: [f64; 3],
    /// Its σ, rad/s.
    pub gyro_bias_sd_rad_s: [f64; 3],
    /// How much later the magnetometer's stamps come than the gyro's, s; zero where the gyro was not used.
    pub lag_s: f64,
    /// Its σ, s.
    pub lag_sd_s: f64,
    /// Field below the horizontal, deg, where an accelerometer tells.
    pub dip_deg: Option<f64>,
    /// Its spread, robust σ, deg.
    pub dip_spread_deg: Option<f64>,
}

/// Calibrated field of length 1, axes of the magnetometer, and what the inertial sensor said; times in s.
pub struct Sensed<'a> {
    /// Times of the field.
    pub field_s: &'a [f64],
    /// The field; none for an outlier.
    pub field: &'a [Option<Vector3<f64>>],
    /// Gyro, rad/s.
    pub gyro: Option<(&'a [f64], &'a [Vector3<f64>])>,
    /// Accelerometer, any unit.
    pub accelerometer: Option<(&'a [f64], &'a [Vector3<f64>])>,
}

impl Alignment {
    fn assumed(reason: String) -> Self {
        Self {
            source: AlignmentSource::Assumed,
            reason,
            rotation: Matrix3::identity(),
            angle_deg: 0.0,
            sd_deg: [0.0; 3],
            residual_deg: 0.0,
            gyro_bias_rad_s: [0.0; 3],
            gyro_bias_sd_rad_s: [0.0; 3],
            lag_s: 0.0,
            lag_sd_s: 0.0,
            dip_deg: None,
            dip_spread_deg: None,
        }
    }

    /// The best that the sensors allow. `mirrored`: an axis of the magnetometer has the wrong sign in the log.
    pub fn find(sensed: &Sensed<'_>, mirrored: bool) -> Self {
        let mut alignment = Self::rotation_of(sensed);
        if mirrored {
            alignment.rotation = -alignment.rotation;
        }
        if let Some((dip_deg, spread)) = dip(sensed, &alignment) {
            (alignment.dip_deg, alignment.dip_spread_deg) = (Some(dip_deg), Some(spread));
        }
        alignment
    }

    fn rotation_of(sensed: &Sensed<'_>) -> Self {
        let mut reasons = Vec::new();
        let up = up(sensed, 0.0);
        let by_gyro = |field: &[Option<Vector3<f64>>]| {
            let (times, rates) = sensed.gyro?;
            Some(
                gyro::align(sensed.field_s, field, times, rates)
                    .and_then(|found| uncertain("the gyro", &found.fit).map_or(Ok(found), Err)),
            )
        };
        let inertial_angle_deg = match up.as_ref().and_then(|up| by_gyro(up)) {
            Some(Ok(found)) => Some(angle_deg(&found.fit.rotation)),
            _ => None,
        };
        match by_gyro(sensed.field) {
            Some(Ok(found)) => match inertial_angle_deg.filter(|angle| *angle > ONE_FRAME_DEG) {
                None => {
                    let mut alignment = Self::of(AlignmentSource::Gyro, &found.fit);
                    alignment.gyro_bias_rad_s = found.bias_rad_s.into();
                    alignment.gyro_bias_sd_rad_s = found.bias_sd_rad_s.into();
                    (alignment.lag_s, alignment.lag_sd_s) = (found.lag_s, found.lag_sd_s);
                    return alignment;
                }
                Some(angle) => reasons.push(format!(
                    "gyro and accelerometer are turned by {angle:.0}° against each other: they are not logged in one right-handed frame"
                )),
            },
            Some(Err(reason)) => reasons.push(reason),
            None => reasons.push("no gyro in the log".to_owned()),
        }
        match up.as_ref().map(|up| gravity::align(sensed.field, up)) {
            Some(Ok(fit)) => match uncertain("gravity", &fit) {
                None => {
                    let reason = reasons.join("; ");
                    return Self { reason, ..Self::of(AlignmentSource::Gravity, &fit) };
                }
                Some(reason) => reasons.push(reason),
            },
            Some(Err(reason)) => reasons.push(reason),
            None => reasons.push("no accelerometer in the log".to_owned()),
        }
        Self::assumed(reasons.join("; "))
    }

    fn of(source: AlignmentSource, fit: &rotation::RotationFit) -> Self {
        Self {
            source,
            rotation: fit.rotation,
            angle_deg: angle_deg(&fit.rotation),
            sd_deg: fit.sd_rad.map(f64::to_degrees).into(),
            residual_deg: fit.residual_rad.to_degrees(),
            ..Self::assumed(String::new())
        }
    }
}

fn angle_deg(rotation: &Matrix3<f64>) -> f64 {
    (0.5 * (rotation.trace() - 1.0)).clamp(-1.0, 1.0).acos().to_degrees()
}

fn uncertain(what: &str, fit: &rotation::RotationFit) -> Option<String> {
    let sd_deg = fit.sd_rad.max().to_degrees();
    (sd_deg > LARGEST_SD_DEG).then(|| {
        format!("{what} leaves {sd_deg:.1}° of uncertainty in the axes, expected {LARGEST_SD_DEG}° or less")
    })
}

/// Direction of up in the inertial sensor at the times of the field, where the sensor was calm.
fn up(sensed: &Sensed<'_>, lag_s: f64) -> Option<Vec<Option<Vector3<f64>>>> {
    let (times, forces) = sensed.accelerometer?;
    let half = 0.5 * AVERAGED_S + STAMP_SLACK_S;
    let (mut from, mut to) = (0, 0);
    let mut sum = Vector3::zeros();
    let mut means: Vec<Option<Vector3<f64>>> = Vec::with_capacity(sensed.field_s.len());
    for time in sensed.field_s {
        let middle = time - lag_s;
        while to < times.len() && times[to] <= middle + half {
            sum += forces[to];
            to += 1;
        }
        while from < to && times[from] < middle - half {
            sum -= forces[from];
            from += 1;
        }
        means.push((to > from).then(|| sum / (to - from) as f64));
    }
    let usual = robust::median(means.iter().flatten().map(Vector3::norm).collect())?;
    let calm = |mean: Vector3<f64>| {
        let length = mean.norm();
        ((length - usual).abs() <= CALM * usual && length > 0.0).then(|| mean / length)
    };
    Some(means.into_iter().map(|mean| mean.and_then(calm)).collect())
}

/// Dip of the field and its spread, deg.
fn dip(sensed: &Sensed<'_>, alignment: &Alignment) -> Option<(f64, f64)> {
    let up = up(sensed, alignment.lag_s)?;
    let both = sensed.field.iter().zip(&up).filter_map(|(field, up)| Some((((*field)?), ((*up)?))));
    let dips: Vec<f64> = both
        .map(|(field, up)| {
            (-(alignment.rotation * field).normalize().dot(&up)).clamp(-1.0, 1.0).asin().to_degrees()
        })
        .collect();
    if dips.len() < FEWEST_CALM {
        return None;
    }
    let spread = |centre| robust::spread_about(dips.iter().copied(), centre);
    let centre = robust::median(dips.clone())?;
    Some((centre, spread(centre)?))
}
