//! `adit nlos train`: from labelled ranges to a model.

use super::{read, table};
use crate::args::NlosTrainArgs;
use crate::output;
#[cfg(feature = "train")]
use crate::progress::{Progress, Unit};
use adit_nlos::learning::{self, Data, Learnt, Plan};
use adit_nlos::measures::Measures;
#[cfg(feature = "train")]
use adit_nlos::training::Settings;
use adit_observation::files::AtomicFile;
use anyhow::{Context, Result};
use serde::Serialize;
use std::io::Write;

/// What is printed.
#[derive(Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    model: &'a Measures,
    baseline: &'a Measures,
    folds: usize,
}

/// Learns, writes the model, says how it did.
pub fn run(args: &NlosTrainArgs) -> Result<()> {
    let data = Data::of(read(&args.data)?, read(&args.also)?)?;
    let plan = Plan { folds: args.folds.into(), seed: args.seed, note: args.note.clone() };
    let learnt = learn(args, &data, &plan)?;
    let mut file = AtomicFile::create(&args.out)?;
    let written = file.write_all(&learnt.model.to_bytes()?);
    written.with_context(|| format!("{}: cannot write it", args.out.display()))?;
    file.finish()?;
    let (baseline, folds) = (&learnt.baseline, learnt.model.record.held_out.folds);
    let model = learnt.network.as_ref().unwrap_or(baseline);
    if args.json {
        let report = Report { model, baseline, folds };
        return output::print(&(serde_json::to_string_pretty(&report)? + "\n"));
    }
    let head = format!("held out    {folds} times some geometries; the model is learnt of all\n");
    let text = match &learnt.network {
        Some(network) => table::measures((table::NETWORK, network), &[(table::BASELINE, baseline)]),
        None => table::measures((table::BASELINE, baseline), &[]),
    };
    output::print(&(head + &text))
}

#[cfg(feature = "train")]
fn learn(args: &NlosTrainArgs, data: &Data, plan: &Plan) -> Result<Learnt> {
    if args.baseline {
        return Ok(learning::learn_baseline(data, plan)?);
    }
    let ranges = data.examples.rows.len();
    let response = data.examples.rows.iter().filter(|row| row.window.is_some()).count();
    let settings = Settings::of(2 * response > ranges, ranges);
    let bar = std::sync::OnceLock::new();
    let show = |done, total| {
        let bar: &Progress = bar.get_or_init(|| Progress::new("learning", Unit::Passes, Some(total)));
        bar.at(done);
    };
    Ok(learning::learn(data, plan, &settings, &show)?)
}

#[cfg(not(feature = "train"))]
fn learn(args: &NlosTrainArgs, data: &Data, plan: &Plan) -> Result<Learnt> {
    if args.baseline {
        return Ok(learning::learn_baseline(data, plan)?);
    }
    anyhow::bail!(
        "this adit was built without learning of networks: build it with `cargo install --locked --path crates/cli --features train`, or learn the discriminant \
         alone with --baseline"
    )
}
