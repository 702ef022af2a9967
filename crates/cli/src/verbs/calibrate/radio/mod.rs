//! `adit calibrate pathloss` and `adit calibrate fingerprint`: the radio of a site, and how well each method finds people by it.

mod contest;
mod data;
pub mod fingerprint;
mod judge;
mod models;
pub mod pathloss;

use crate::args::{LeaveOut, RadioArgs};
use crate::output::{self, Target};
use crate::progress;
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
    progress::warn(&all.warnings);
    let tests = args.evaluate.iter().map(|path| {
        let test = RadioData::read_like(path, &all)?;
        progress::warn(&test.warnings);
        Ok(test)
    });
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

/// What of a survey is judged.
#[derive(Debug, Clone, Copy)]
pub enum JudgedSpots<'a> {
    /// Those of another file.
    Of(&'a Path),
    /// A share of its spots, drawn by this seed, which nothing is fitted to.
    LeftOut(f64, u64),
}

/// How far the fixes of every locator are off, m.
pub struct SpotErrors {
    /// By name.
    pub locators: Vec<(&'static str, Vec<f64>)>,
    /// What was odd.
    pub warnings: Vec<String>,
}

/// Every locator on scans at known spots, fitted to the others.
pub fn judge_survey(survey: &Path, list: &Path, judged: JudgedSpots<'_>) -> Result<SpotErrors> {
    let all = RadioData::read(&[survey.to_path_buf()])?;
    let (train, test) = match judged {
        JudgedSpots::Of(test) => {
            let test = RadioData::read_like(test, &all)?;
            (all, test)
        }
        JudgedSpots::LeftOut(share, seed) => all.split_by_spot(share, seed)?,
    };
    let sites = data::sites(&train, &data::places(list)?, list)?;
    let models = models::SiteModels::new(&train, &sites)?;
    let maps = fingerprint::SiteMaps::new(&train, &sites)?;
    let mut judged = contest::run(&test, &models.contestants(), &models.followers(&test));
    judged.extend(contest::run(&test, &maps.contestants(), &maps.followers(&test)));
    let locators = judged.iter().map(|one| (one.method, one.errors_m().to_vec())).collect();
    let warnings = train.warnings.iter().chain(&test.warnings).cloned().collect();
    Ok(SpotErrors { locators, warnings })
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
