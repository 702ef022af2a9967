//! The recorded sets, where they are at hand.

use std::path::{Path, PathBuf};

/// The folder of a set; `None`, after saying so, where the recordings are not at hand.
pub fn folder(set: &str) -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let folder = std::env::var_os("ADIT_DATA").map_or_else(beside, PathBuf::from).join(set);
    if folder.is_dir() {
        return Some(folder);
    }
    println!("SKIPPED (no test data): {set}");
    None
}

/// Every `NAME_imu.csv` or `NAME_imu.csv.gz` with its `NAME`, in order of name.
pub fn trials(folder: &Path) -> Vec<(String, PathBuf)> {
    let paths = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let named = |path: PathBuf| {
        let file = path.file_name()?.to_str()?;
        let name = file.strip_suffix(".gz").unwrap_or(file).strip_suffix("_imu.csv")?.to_owned();
        Some((name, path))
    };
    let mut trials: Vec<_> = paths.filter_map(named).collect();
    trials.sort();
    trials
}

/// `NAME_truth.csv` or `NAME_truth.csv.gz`.
pub fn truth_file(folder: &Path, name: &str) -> PathBuf {
    let files = [".csv", ".csv.gz"].map(|end| folder.join(format!("{name}_truth{end}")));
    files.into_iter().find(|file| file.exists()).unwrap()
}
