//! One function per parser: any bytes in, no panic, no memory beyond bounds, an answer or a clear error out.
//!
//! The fuzz targets call them, and so does `crates/observation/tests/mutated_input.rs`, which needs nothing but
//! stable Rust and runs with every `make test`.

use adit_observation::files::Input;
use adit_observation::sidecar::Sidecar;
use adit_observation::solution_csv::SolutionReader;
use adit_observation::tum::TumReader;
use adit_observation::{LogError, LogReader, ReadOptions, truth};
use std::path::Path;
use std::sync::Arc;

/// Name under which the bytes are known; every error must start with it.
const NAME: &str = "fuzzed";

/// A log of any kind, as `adit_observation::open` reads it: CSV or MCAP, gzip or not. Gives the number of observations.
pub fn parse_log(bytes: &[u8]) -> Result<usize, LogError> {
    let input = Input::from_bytes(NAME, bytes)?;
    let mut log = LogReader::from_input(input, &ReadOptions::default())?;
    let mut latest = None;
    let mut count = 0;
    for observation in log.by_ref() {
        let time = observation?.time();
        assert!(latest.is_none_or(|latest| latest <= time), "observations come in order of time");
        latest = Some(time);
        count += 1;
    }
    assert!(log.warnings().len() < 100, "warnings stay few");
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
    Ok(usize::from(sidecar.mounting.rotation.is_some()) + usize::from(sidecar.mounting.location.is_some()))
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
