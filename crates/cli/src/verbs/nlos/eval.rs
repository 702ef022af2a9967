//! `adit nlos eval`: a model against labelled ranges.

use super::{read, table};
use crate::args::NlosEvalArgs;
use crate::judged_ranges;
use crate::output;
use adit_nlos::Model;
use adit_nlos::examples::Examples;
use adit_nlos::judging::judge;
use anyhow::Result;
use std::path::Path;
use std::sync::Arc;

/// Judges the model.
pub fn run(args: &NlosEvalArgs) -> Result<()> {
    let model = match &args.model {
        None => Model::shipped()?,
        Some(name) => Arc::unwrap_or_clone(judged_ranges::model(name, Path::new(""))?),
    };
    let judgement = judge(&model, &Examples::of(&read(&args.data)?));
    if args.json {
        return output::print(&(serde_json::to_string_pretty(&judgement)? + "\n"));
    }
    output::print(&table::judgement(&judgement, model.network.is_some()))
}
