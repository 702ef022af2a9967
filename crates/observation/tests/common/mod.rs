//! Where the recorded test data lies, and how to skip when it does not.

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
