//! A log with the truth of its ranges, as `adit simulate` leaves them.

use super::{LabelledRange, LabelledRanges};
use crate::csv_log::range_truth;
use crate::error::{LogError, Place};
use crate::observation::Observation;
use crate::radio::Reception;
use std::path::Path;
use std::sync::Arc;

/// Reads the log and the truth of a folder; ranges of which no class is told are left.
pub fn read(folder: &Path, log: &Path, truth: &Path) -> Result<LabelledRanges, LogError> {
    let known = range_truth::read(truth)?;
    let mut reader = crate::log::open(log)?;
    let mut ranges = Vec::new();
    for observation in reader.by_ref() {
        let Observation::Range(range) = observation? else { continue };
        let Some(told) = known.of(&range) else { continue };
        let Some(class) = told.class else { continue };
        ranges.push(LabelledRange {
            group: 0,
            class,
            in_the_way: told.in_the_way,
            time: Some(range.time),
            anchor: Some(range.anchor),
            range_m: Some(range.range_m),
            true_range_m: Some(told.distance_m),
            reception: range.reception.map_or_else(Reception::default, Arc::unwrap_or_clone),
        });
    }
    if ranges.is_empty() {
        return Err(LogError::NothingRecorded { place: Place::file(log), expected: "labelled range" });
    }
    let name = |path: &Path| path.file_name().map(|name| name.to_string_lossy().into_owned());
    // Of everybody in a mine each has a folder p001, p002, …
    let person = |name: &str| name.strip_prefix('p').is_some_and(|n| n.bytes().all(|b| b.is_ascii_digit()));
    let group = match (name(folder), folder.parent().and_then(name)) {
        (Some(own), Some(parent)) if person(&own) => parent,
        (Some(own), _) => own,
        (None, _) => folder.display().to_string(),
    };
    Ok(LabelledRanges {
        path: folder.to_path_buf(),
        file: truth.to_path_buf(),
        groups: vec![group],
        tells_ndp: true,
        tells_in_the_way: ranges.iter().all(|range| range.in_the_way.is_some()),
        ranges,
        warnings: reader.warnings().to_vec(),
    })
}
