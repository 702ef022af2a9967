//! `adit calibrate pathloss` and `adit calibrate fingerprint`: the radio of a site, and how well each method finds people by it.

mod contest;
mod data;
pub mod fingerprint;
mod judge;
mod models;
pub mod pathloss;

use crate::args::{LeaveOut, RadioArgs};
use crate::output::{self, Target};
use adit_estimation::radio::model::{FingerprintModel, PathLossModel};
use adit_observation::survey::TransmitterPlace;
use anyhow::Result;
use data::{DataKind, RadioData};
use std::path::{Path, PathBuf};

/// One part to be judged on and the other to fit.
struct Trial<'a> {
    name: String,
    train: RadioData,
    test: RadioData,
    /// Where the judged part comes from.
    of: &'a str,
}

/// Every pair of a fit and a test that was asked for.
fn trials<'a>(args: &RadioArgs, all: &RadioData, tests: Vec<RadioData>) -> Result<Vec<Trial<'a>>> {
    let mut trials = Vec::new();
    match args.leave_out {
        Some(LeaveOut::Share(share)) => {
            for seed in args.seed..args.seed.saturating_add(args.draws) {
                let (train, test) = all.split_by_spot(share, seed)?;
                trials.push(Trial { name: format!("seed {seed}"), train, test, of: "spots left out" });
            }
        }
        Some(LeaveOut::Each) => {
            for (name, train, test) in all.split_by_file()? {
                trials.push(Trial { name, train, test, of: "files left out" });
            }
        }
        None => {}
    }
    for test in tests {
        trials.push(Trial { name: test.name(), train: all.clone(), test, of: "tests" });
    }
    Ok(trials)
}

/// Reads what to fit and what to judge on, with the same transmitters.
fn read(args: &RadioArgs) -> Result<(RadioData, Vec<RadioData>)> {
    let all = RadioData::read(&args.data)?;
    let tests = args.evaluate.iter().map(|path| RadioData::read_like(path, &all));
    Ok((all.clone(), tests.collect::<Result<_>>()?))
}

/// The path loss of the transmitters of logs with truth, whose places are those of a list.
pub fn path_loss_of(logs: &[PathBuf], places: &[TransmitterPlace], list: &Path) -> Result<PathLossModel> {
    let data = RadioData::read(logs)?;
    let sites = data::sites(&data, places, list)?;
    Ok(pathloss::model(&data, &models::SiteModels::new(&data, &sites)?))
}

/// A radio map of logs with truth.
pub fn fingerprints_of(
    logs: &[PathBuf],
    places: &[TransmitterPlace],
    list: &Path,
) -> Result<FingerprintModel> {
    let data = RadioData::read(logs)?;
    let sites = data::sites(&data, places, list)?;
    Ok(fingerprint::model(&data, &fingerprint::SiteMaps::new(&data, &sites)?))
}

/// Writes the file, then the report: to stderr where stdout has the file.
fn deliver(target: &Target, text: &str, report: &str) -> Result<()> {
    target.write(text)?;
    match target {
        Target::File(_) => output::print(report),
        Target::Stdout => {
            output::tell(report);
            Ok(())
        }
    }
}

/// Whether the methods have walks to follow.
fn walks(all: &RadioData) -> bool {
    all.kind == DataKind::Walks
}
