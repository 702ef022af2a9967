//! `adit nlos`: whether a signal came straight, learnt and judged.

mod eval;
mod table;
mod train;

use crate::args::{NlosArgs, NlosVerb};
use crate::progress;
use adit_observation::csv_log::labelled::{self, LabelledRanges};
use anyhow::Result;
use std::path::PathBuf;

/// Does what was asked for.
pub fn run(args: &NlosArgs) -> Result<()> {
    match &args.verb {
        NlosVerb::Train(args) => train::run(args),
        NlosVerb::Eval(args) => eval::run(args),
    }
}

fn read(paths: &[PathBuf]) -> Result<Vec<LabelledRanges>> {
    paths
        .iter()
        .map(|path| {
            let set = labelled::read(path)?;
            progress::warn(&set.warnings);
            Ok(set)
        })
        .collect()
}
