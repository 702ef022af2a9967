//! Where the anchors, receivers and beacons of a set are.

use super::{csv_of, rows};
use crate::suite_file::Places;
use adit_core::nalgebra::Vector3;
use adit_estimation::radio::site::Transmitter;
use adit_estimation::radio::{RadioSite, SiteAnchor};
use adit_observation::survey::{self, TransmitterPlace};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};

/// A list of places.
pub struct Listed {
    /// Where it is from.
    pub file: PathBuf,
    /// The places.
    pub places: Vec<TransmitterPlace>,
    /// What anchors add to their ranges, m, in the same order; empty where nothing is told.
    pub offsets_m: Vec<f64>,
}

/// The list of a run, heights where they are told or follow from floors.
pub fn read(places: &Places, folder: &Path, run: &str) -> Result<Listed> {
    let own = || csv_of(folder, &format!("{run}_anchors"));
    let file = match &places.file {
        Some(name) => folder.join(name),
        None => own().with_context(|| format!("{}: no {run}_anchors.csv", folder.display()))?,
    };
    let mut listed = survey::transmitters_from_input(rows::chosen(&file, places.row.as_ref())?)
        .with_context(|| file.display().to_string())?;
    for place in &mut listed {
        let [_, _, up] = &mut place.position_m;
        if let Some(storeys) = places.storeys {
            let floor = place.floor.with_context(|| format!("{}: {}: no floor", file.display(), place.id))?;
            *up = storeys.height_m * f64::from(floor - storeys.ground) + places.height_m.unwrap_or(0.0);
            place.floor = None;
        } else if let Some(height_m) = places.height_m {
            *up = height_m;
        }
    }
    let offsets_m = if places.offsets { offsets(&file, &listed)? } else { Vec::new() };
    Ok(Listed { file, places: listed, offsets_m })
}

/// A list with a column of anchors may tell what each adds to its ranges.
fn offsets(file: &Path, listed: &[TransmitterPlace]) -> Result<Vec<f64>> {
    let Ok((mine, _)) = adit_mine::file::open(file) else { return Ok(Vec::new()) };
    let offset = |place: &TransmitterPlace| {
        let anchor = mine.plan().anchors.iter().find(|anchor| anchor.id == place.id.as_str());
        anchor.map(|anchor| anchor.range_offset_m.unwrap_or(0.0))
    };
    match listed.iter().map(offset).collect::<Option<Vec<f64>>>() {
        Some(offsets_m) => Ok(offsets_m),
        None => bail!("{}: two lists in one file", file.display()),
    }
}

/// A site with these as transmitters and as anchors.
pub fn site(listed: &Listed, beacons: bool) -> RadioSite {
    let mut site = RadioSite::default();
    for (nth, place) in listed.places.iter().enumerate() {
        let (id, position_m) = (place.id.to_string(), Vector3::from(place.position_m));
        site.transmitters.push(Transmitter {
            id: id.clone(),
            mac: None,
            position_m,
            floor: place.floor,
            beacon: beacons,
            tx_power_dbm: None,
            path_loss: None,
        });
        let range_offset_m = listed.offsets_m.get(nth).copied().unwrap_or(0.0);
        site.anchors.push(SiteAnchor { id, position_m, range_offset_m });
    }
    site
}
