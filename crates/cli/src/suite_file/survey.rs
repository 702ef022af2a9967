//! Radio surveys as a suite names them: scans at known spots, which locators are fitted to and judged on.

use crate::scenario_file::Source;
use anyhow::Result;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use toml::Spanned;

/// Draws of left-out spots, where nothing is said.
const DRAWS: u64 = 10;

/// A survey as written: each NAME with `NAME_FIT.csv[.gz]` and `NAME_access_points.csv` is a site.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SurveyEntry {
    /// Folder below the folder of the recorded sets.
    folder: PathBuf,
    /// Ending of the file to which everything is fitted.
    fit: String,
    /// Ending of the file on which it is judged.
    test: Option<Spanned<String>>,
    /// Without one: the share of spots that is left out and judged.
    leave_out: Option<Spanned<f64>>,
    /// So many times, by seeds from 1.
    draws: Option<u64>,
}

/// A survey, checked.
#[derive(Debug, Clone)]
pub struct RadioSurvey {
    /// Its name.
    pub name: String,
    /// The folder.
    pub folder: PathBuf,
    /// Ending of the file to which everything is fitted.
    pub fit: String,
    /// What is judged.
    pub judged: SpotChoice,
}

/// What of a survey is judged.
#[derive(Debug, Clone, PartialEq)]
pub enum SpotChoice {
    /// The file of this ending.
    Test(String),
    /// A share of the spots, so many times.
    LeftOut(f64, u64),
}

impl SurveyEntry {
    /// The survey below a folder of sets.
    pub fn checked(&self, data: &Path, source: &Source) -> Result<RadioSurvey> {
        let judged = match (&self.test, &self.leave_out) {
            (Some(test), None) => SpotChoice::Test(test.get_ref().clone()),
            (None, Some(share)) => {
                let found = *share.get_ref();
                if !(found > 0.0 && found < 1.0) {
                    let what = format!("leave_out is {found}, expected a share between 0 and 1");
                    return Err(source.error(&share.span(), &what));
                }
                SpotChoice::LeftOut(found, self.draws.unwrap_or(DRAWS))
            }
            (Some(test), Some(_)) => {
                return Err(source.error(&test.span(), "expected `test` or `leave_out`, not both"));
            }
            (None, None) => SpotChoice::LeftOut(0.2, self.draws.unwrap_or(DRAWS)),
        };
        let (name, folder) = (self.folder.display().to_string(), data.join(&self.folder));
        Ok(RadioSurvey { name, folder, fit: self.fit.clone(), judged })
    }
}
