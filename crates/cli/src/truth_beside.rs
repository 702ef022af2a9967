//! The truth that lies beside a log, found by the names of the files.
//!
//! `NAME_truth` beside `NAME.csv`, `NAME_imu.csv`, `NAME_rssi.mcap` and so on; `truth.tum` beside the `log.mcap` of a simulation.

use std::path::{Path, PathBuf};

/// A simulated log.
const SIMULATED_LOG: &str = "log.mcap";
/// Its truth.
const SIMULATED_TRUTH: &str = "truth.tum";

/// The truth of a log, where there is one.
pub fn of(log: &Path) -> Option<PathBuf> {
    names(log).into_iter().map(|name| log.with_file_name(name)).find(|file| file.is_file())
}

/// What the truth of a log may be called, the first found counts.
pub fn names(log: &Path) -> Vec<String> {
    let stem = stem(log);
    let without = stem.rsplit_once('_').map(|(name, _)| format!("{name}_truth"));
    let names = without.into_iter().chain([format!("{stem}_truth")]);
    let simulated = is_simulated(log).then(|| SIMULATED_TRUTH.to_owned());
    simulated
        .into_iter()
        .chain(names.flat_map(|name| [".csv", ".csv.gz", ".tum"].map(|end| format!("{name}{end}"))))
        .collect()
}

/// True for the log of a simulation.
pub fn is_simulated(log: &Path) -> bool {
    log.file_name().is_some_and(|name| name == SIMULATED_LOG)
}

/// Name of a file without what tells its kind.
pub fn stem(path: &Path) -> String {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    [".csv", ".mcap"].iter().find_map(|end| name.strip_suffix(end)).unwrap_or(name).to_owned()
}
