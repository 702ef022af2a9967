//! `--mine` and `--radio`: what is known of the radio of a site, read.

use crate::config;
use crate::progress;
use adit_estimation::radio::RadioSite;
use adit_estimation::radio::model::{FingerprintModel, ModelKind, PathLossModel, RangesModel, VERSION};
use adit_mine::Mine;
use anyhow::{Context, Result, anyhow, bail};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// How every model begins.
#[derive(Deserialize)]
struct Head {
    kind: Option<ModelKind>,
    version: Option<u32>,
}

/// The radio of a site by its mine and the calibrations of its radio; `None` where nothing is given.
pub fn read(mine: Option<&Path>, models: &[PathBuf]) -> Result<Option<Arc<RadioSite>>> {
    if mine.is_none() && models.is_empty() {
        return Ok(None);
    }
    let Some(path) = mine else { return with_models(RadioSite::default(), models).map(Some) };
    let (mine, notices) = adit_mine::file::open(path)?;
    for notice in notices {
        tracing::info!("{}: {notice}", path.display());
    }
    of(&mine, path, models).map(Some)
}

/// The radio of a site by its mine, read from this file, and the calibrations of its radio.
pub fn of(mine: &Mine, path: &Path, models: &[PathBuf]) -> Result<Arc<RadioSite>> {
    // Access points (or, in a bare list, anchors) and roadways.
    let site = RadioSite::of_mine(mine);
    if site.transmitters.is_empty() {
        progress::warn(&[format!("{}: has no access points", path.display())]);
    }
    with_models(site, models)
}

fn with_models(site: RadioSite, models: &[PathBuf]) -> Result<Arc<RadioSite>> {
    models.iter().try_fold(site, |site, path| with_model(site, path)).map(Arc::new)
}

fn with_model(site: RadioSite, path: &Path) -> Result<RadioSite> {
    let text = config::text(path)?;
    let json = text.trim_start().starts_with('{');
    let head: Head = if json { of_json(path, &text)? } else { config::parse(path, &text)? };
    let expected = "a file of adit calibrate pathloss, fingerprint or range";
    let Some(kind) = head.kind else { bail!("{}: no \"kind\", expected {expected}", path.display()) };
    match head.version {
        Some(VERSION) => {}
        Some(other) => bail!("{}: version {other}, expected {VERSION}", path.display()),
        None => bail!("{}: no \"version\", expected {VERSION}", path.display()),
    }
    match kind {
        ModelKind::PathLoss => {
            let model: PathLossModel = if json { of_json(path, &text)? } else { config::parse(path, &text)? };
            Ok(site.with_path_loss(&model))
        }
        ModelKind::Ranges => {
            let model: RangesModel = if json { of_json(path, &text)? } else { config::parse(path, &text)? };
            if let Some((name, expected)) = model.correction.fault() {
                bail!("{}: {name}: expected {expected}", path.display());
            }
            Ok(site.with_ranges(model.correction))
        }
        ModelKind::Fingerprint => {
            let model: FingerprintModel =
                if json { of_json(path, &text)? } else { config::parse(path, &text)? };
            let (found, expected) = (model.transmitters.len(), model.strengths.transmitters());
            let fingerprints = &model.fingerprints;
            let means = fingerprints.spots.len() * fingerprints.transmitters;
            if found != expected
                || fingerprints.transmitters != found
                || fingerprints.means_dbm.len() != means
            {
                bail!(
                    "{}: {found} names, a map of {expected} transmitters and fingerprints of {}, expected as many of each",
                    path.display(),
                    fingerprints.transmitters
                );
            }
            Ok(site.with_fingerprints(model))
        }
    }
}

fn of_json<'a, T: Deserialize<'a>>(path: &Path, text: &'a str) -> Result<T> {
    serde_json::from_str(text)
        .map_err(|error| anyhow!("{}:{}: {error}", path.display(), error.line()))
        .context("the radio model cannot be used")
}
