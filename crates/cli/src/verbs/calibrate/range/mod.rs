//! `adit calibrate range`: ranges with a known distance in, what is known of their errors out.

mod data;
mod figure;
mod table;

use crate::args::CalibrateRangeArgs;
use crate::output::{self, Target};
use adit_estimation::radio::model::{ModelKind, RangesModel, VERSION};
use adit_tuning::ranges::measures::{self, ClassErrors};
use adit_tuning::ranges::{self, Learnt};
use anyhow::Result;
use data::{Places, RangeData};
use serde::Serialize;

/// What `--json` prints.
#[derive(Serialize)]
struct Report {
    data: Vec<String>,
    groups: usize,
    ranges: usize,
    learnt: Learnt,
    /// Each group by what the others told.
    held_out: Vec<ClassErrors>,
    tests: Vec<Test>,
}

/// The correction that is written, on further data.
#[derive(Serialize)]
struct Test {
    data: String,
    errors: Vec<ClassErrors>,
}

/// Learns, judges, writes.
pub fn run(args: &CalibrateRangeArgs) -> Result<()> {
    let places = Places::read(args.mine.as_deref(), args.lever)?;
    let data = RangeData::read(&args.data, &places)?;
    let learnt = ranges::learn(&data.ranges)?;
    let held = ranges::held_out(&data.ranges)?;
    let mut tests = Vec::new();
    for path in &args.evaluate {
        let test = RangeData::read(std::slice::from_ref(path), &places)?;
        let corrected: Vec<_> =
            test.ranges.iter().map(|one| ranges::corrected(&learnt.correction, one)).collect();
        let errors = measures::of(&test.ranges, &corrected);
        tests.push(Test { data: path.display().to_string(), errors });
    }
    if let Some(path) = &args.plot {
        output::write_file(path, &figure::of(&args.data, &data, &learnt.correction, &held)?)?;
    }
    let names = args.data.iter().map(|path| path.display().to_string()).collect::<Vec<_>>();
    let model =
        RangesModel { kind: ModelKind::Ranges, version: VERSION, correction: learnt.correction.clone() };
    let text = format!("# adit calibrate range {}\n{}", names.join(" "), toml::to_string(&model)?);
    let report = Report {
        data: names,
        groups: data.groups.len(),
        ranges: data.ranges.len(),
        held_out: measures::of(&data.ranges, &held),
        learnt,
        tests,
    };
    let said = if args.json { serde_json::to_string_pretty(&report)? + "\n" } else { table::of(&report)? };
    args.out.write(&text)?;
    match &args.out {
        Target::File(_) => output::print(&said),
        Target::Stdout => {
            output::tell(&said);
            Ok(())
        }
    }
}
