//! One function per parser: any bytes in, no panic, no memory beyond bounds, an answer or a clear error out.
//!
//! The fuzz targets call them, and so does `crates/observation/tests/mutated_input.rs`, which needs nothing but
//! stable Rust and runs with every `make test`.

use adit_core::nalgebra::{Matrix3, Vector3};
use adit_observation::files::Input;
use adit_observation::order::DEFAULT_LATE_LIMIT;
use adit_observation::sidecar::{MagneticFieldReference, MagnetometerCalibration, Sidecar, SidecarEdit};
use adit_observation::solution_csv::SolutionReader;
use adit_observation::tum::TumReader;
use adit_observation::{ImuSpecification, LogError, LogReader, ReadOptions, SensorRows, truth};
use std::path::Path;
use std::sync::Arc;

/// Name under which the bytes are known; every error must start with it.
const NAME: &str = "fuzzed";

/// A log of any kind, as `adit_observation::open` reads it: CSV or MCAP, gzip or not. Gives the number of observations.
pub fn parse_log(bytes: &[u8]) -> Result<usize, LogError> {
    let input = Input::from_bytes(NAME, bytes)?;
    let mut log = LogReader::from_input(input, &ReadOptions::default())?;
    let (mut clock, mut newest) = (None, None);
    let mut count = 0;
    for observation in log.by_ref() {
        let observation = observation?;
        let time = observation.time();
        assert_eq!(observation.fault(), None, "what is read can be");
        if observation.kind().is_wired() {
            assert!(clock.is_none_or(|clock| clock <= time), "the tag's own sensors come in order of time");
            clock = Some(time);
        } else if let Some(now) = clock.or(newest) {
            assert!(now - time <= DEFAULT_LATE_LIMIT, "what comes by radio is no later than the limit");
        }
        newest = newest.max(Some(time));
        count += 1;
    }
    assert!(log.warnings().len() < 100, "warnings stay few");
    Ok(count)
}

/// A log of any one sensor, as a calibration reads it. Gives the number of rows.
pub fn parse_sensor_rows(bytes: &[u8]) -> Result<usize, LogError> {
    let mut rows = SensorRows::from_input(Input::from_bytes(NAME, bytes)?)?;
    let mut latest = None;
    let mut count = 0;
    for row in rows.by_ref() {
        let time = row?.time;
        assert!(latest.is_none_or(|latest| latest <= time), "rows come in order of time");
        latest = Some(time);
        count += 1;
    }
    assert!(rows.warnings().len() < 100, "warnings stay few");
    Ok(count)
}

/// TUM text. Gives the number of poses.
pub fn parse_tum(bytes: &[u8]) -> Result<usize, LogError> {
    TumReader::new(Input::from_bytes(NAME, bytes)?).try_fold(0, |count, pose| {
        let length = pose?.attitude.norm();
        assert!((length - 1.0).abs() < 1e-12, "attitudes have length 1, found {length}");
        Ok(count + 1)
    })
}

/// A truth file. Gives the number of poses.
pub fn parse_truth(bytes: &[u8]) -> Result<usize, LogError> {
    let truth = truth::from_input(Input::from_bytes(NAME, bytes)?)?;
    let poses = truth.trajectory.len();
    assert!(truth.moving.is_none_or(|moving| moving.len() == poses), "one mark per pose");
    Ok(poses)
}

/// Solutions with covariance. Gives their number.
pub fn parse_solution_csv(bytes: &[u8]) -> Result<usize, LogError> {
    SolutionReader::new(Input::from_bytes(NAME, bytes)?)?
        .try_fold(0, |count, solution| solution.map(|_| count + 1))
}

/// A sidecar. Gives the number of things it says about the mounting.
pub fn parse_sidecar(bytes: &[u8]) -> Result<usize, LogError> {
    let sidecar = Sidecar::parse(&Arc::from(Path::new(NAME)), bytes)?;
    if let Some(rotation) = &sidecar.mounting.rotation {
        let determinant = rotation.matrix().determinant();
        assert!((determinant - 1.0).abs() < 1e-9, "mountings are proper rotations, found {determinant}");
    }
    edit_sidecar(bytes, &sidecar);
    Ok(usize::from(sidecar.mounting.rotation.is_some()) + usize::from(sidecar.mounting.location.is_some()))
}

/// Whatever a valid sidecar looks like, it can be completed, and says afterwards what was set and what it said before.
fn edit_sidecar(bytes: &[u8], before: &Sidecar) {
    let path = Path::new(NAME);
    let mut edit = SidecarEdit::parse(path, bytes).unwrap();
    let calibration =
        MagnetometerCalibration::new(Vector3::new(1.5, -2.0, 0.25), Matrix3::identity()).unwrap();
    let field = MagneticFieldReference { norm_ut: Some(49.5), dip_deg: Some(66.0) };
    let noise = ImuSpecification {
        angle_random_walk_rad_sqrt_s: 1e-4,
        velocity_random_walk_m_s_sqrt_s: 1e-3,
        gyro_bias_walk_rad_s_sqrt_s: 1e-6,
        acc_bias_walk_m_s2_sqrt_s: 1e-5,
    };
    edit.set_magnetometer(&calibration);
    edit.set_magnetic_field(&field);
    edit.set_declination_deg(-3.5);
    edit.set_noise(&noise);
    let text = edit.text().unwrap();
    let after = Sidecar::parse(&Arc::from(path), text.as_bytes()).unwrap();
    let mut expected = before.clone();
    expected.magnetometer = Some(calibration);
    expected.magnetic_field = field;
    expected.frame.magnetic_declination_deg = Some(-3.5);
    expected.noise = Some(noise);
    assert!(after == expected, "an edit changes what it says and nothing else");
}

/// What every error must be: one line that starts with the name of the file.
pub fn check<T>(result: Result<T, LogError>) -> Option<T> {
    match result {
        Ok(value) => Some(value),
        Err(error) => {
            let text = error.to_string();
            assert!(text.starts_with(NAME) && !text.contains('\n'), "not one clear line: {text}");
            None
        }
    }
}
