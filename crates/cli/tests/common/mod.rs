//! Running the real binary.
#![expect(clippy::unwrap_used, reason = "tests")]
#![allow(dead_code, reason = "each test binary uses a part")]

use assert_cmd::Command;
use std::path::{Path, PathBuf};
use std::process::Output;

/// Standard gravity, m/s².
pub const G: f64 = 9.80665;
/// The columns of an inertial log in adit's units.
pub const HEADER: &str = "time_s,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s";

/// What `adit` did.
pub struct Outcome {
    /// Exit code.
    pub code: i32,
    /// Everything on stdout.
    pub stdout: String,
    /// Everything on stderr.
    pub stderr: String,
}

/// Runs `adit` in a folder.
pub fn adit(folder: &Path, args: &[&str]) -> Outcome {
    let Output { status, stdout, stderr } =
        Command::cargo_bin("adit").unwrap().current_dir(folder).args(args).output().unwrap();
    Outcome {
        code: status.code().unwrap(),
        stdout: String::from_utf8(stdout).unwrap(),
        stderr: String::from_utf8(stderr).unwrap(),
    }
}

/// Rows of a sensor at rest at 200 Hz.
pub fn rest(samples: u32) -> Vec<String> {
    (0..samples).map(|i| format!("{},0.01,-0.02,{G},0.001,0,-0.001", f64::from(i) * 0.005)).collect()
}

/// A log of these rows.
pub fn log(rows: &[String]) -> String {
    format!("{HEADER}\n{}\n", rows.join("\n"))
}

/// Names of all files of a folder, hidden ones too, sorted.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let mut names: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| PathBuf::from(entry.unwrap().file_name())).collect();
    names.sort();
    names
}
