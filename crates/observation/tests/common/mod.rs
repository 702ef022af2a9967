//! What the tests share: where the recorded data lies, and logs made in memory.
#![allow(dead_code, reason = "every test binary compiles this module and uses its own part")]
#![allow(clippy::unwrap_used, reason = "tests")]

use adit_observation::files::Input;
use adit_observation::mcap_log::{McapLogWriter, Packing};
use adit_observation::{LogError, LogReader, LogWarning, Observation, ReadOptions};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// The folder of a set, or `None` with a printed line.
pub fn data_set(set: &str) -> Option<PathBuf> {
    let root = std::env::var_os("ADIT_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"), PathBuf::from);
    let folder = root.join(set);
    if folder.is_dir() {
        return Some(folder);
    }
    println!("SKIPPED (no test data): {set}");
    None
}

/// Files of a folder whose name holds `part`, sorted.
pub fn files_with(folder: &Path, part: &str) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .filter_map(|entry| entry.ok().map(|e| e.path()))
        .filter(|path| path.file_name().is_some_and(|n| n.to_string_lossy().contains(part)))
        .collect();
    files.sort();
    files
}

/// A plain log in memory: `rows` rows at 200 Hz, a sensor at rest that turns slowly, with a magnetometer.
pub fn csv_log(rows: usize) -> String {
    let mut text = String::from(
        "time_s,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,mag_x_uT,mag_y_uT,mag_z_uT\n",
    );
    for row in 0..rows {
        let (seconds, millis) = (row * 5 / 1000, row * 5 % 1000);
        let wobble = (row % 7) as f64 / 1000.0;
        let field = if row % 2 == 0 { "17.5,1.25,-42.75" } else { ",," };
        writeln!(text, "{seconds}.{millis:03},0.1,{wobble},9.8,-0.0,0.01,{wobble},{field}").unwrap();
    }
    text
}

/// The error text of a log made of these bytes, wherever in the log it comes.
pub fn error_of(name: &str, bytes: &[u8]) -> String {
    match read_all(name, bytes) {
        Err(error) => error.to_string(),
        Ok((observations, _)) => format!("no error, {} observations", observations.len()),
    }
}

/// All observations and warnings of a log made of these bytes.
pub fn read_all(name: &str, bytes: &[u8]) -> Result<(Vec<Observation>, Vec<LogWarning>), LogError> {
    let mut log = LogReader::from_input(Input::from_bytes(name, bytes)?, &ReadOptions::default())?;
    let observations = log.by_ref().collect::<Result<Vec<_>, _>>()?;
    Ok((observations, log.warnings().to_vec()))
}

/// Compressed by gzip.
pub fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// The same observations as an MCAP file.
pub fn mcap(observations: &[Observation], packing: Packing) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.mcap");
    let mut writer = McapLogWriter::create(&path, packing).unwrap();
    for observation in observations {
        writer.push(observation).unwrap();
    }
    writer.finish().unwrap();
    std::fs::read(path).unwrap()
}
