//! `adit nlos eval`: a model against labelled ranges.

use super::{read, table};
use crate::args::NlosEvalArgs;
use crate::output;
use adit_nlos::Model;
use adit_nlos::examples::Examples;
use adit_nlos::judging::judge;
use anyhow::{Context, Result};
use std::fs;

/// Judges the model.
pub fn run(args: &NlosEvalArgs) -> Result<()> {
    let model = match &args.model {
        None => Model::shipped()?,
        Some(path) => {
            let name = path.display().to_string();
            let bytes = fs::read(path).with_context(|| format!("{name}: cannot read it"))?;
            Model::from_bytes(&name, &bytes)?
        }
    };
    let judgement = judge(&model, &Examples::of(&read(&args.data)?));
    if args.json {
        return output::print(&(serde_json::to_string_pretty(&judgement)? + "\n"));
    }
    output::print(&table::judgement(&judgement, model.network.is_some()))
}
