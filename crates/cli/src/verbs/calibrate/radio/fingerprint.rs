//! `adit calibrate fingerprint`: fingerprints in, a radio map out.

use super::contest::{self, Contestant, Follower, Uses};
use super::data::{self, RadioData};
use super::judge::{Table, tables};
use super::models::lattice;
use super::{deliver, read, trials, walks};
use crate::args::CalibrateFingerprintArgs;
use adit_estimation::radio::model::{FingerprintModel, ModelKind, VERSION};
use adit_estimation::radio::nearest::NearestParams;
use adit_estimation::radio::{MapParams, PlaceFix, Reading};
use adit_tuning::fingerprint::{self, FieldScales, FingerprintFit, FingerprintParams, ReadingKind};
use adit_tuning::radio::Site;
use anyhow::Result;
use serde::Serialize;
use std::fmt::Write as _;

/// What `--json` prints.
#[derive(Serialize)]
struct Report<'a> {
    data: Vec<String>,
    transmitters: usize,
    places: usize,
    step_m: f64,
    scales: FieldScales,
    range_scales: Option<FieldScales>,
    belief: MapParams,
    range_belief: Option<MapParams>,
    judged: &'a [Table],
}

/// The maps of one set of data.
pub struct SiteMaps {
    strengths: FingerprintFit,
    ranges: Option<FingerprintFit>,
}

impl SiteMaps {
    /// Fits everything.
    pub fn new(data: &RadioData, sites: &[Option<Site>]) -> Result<Self> {
        let lattice = lattice(data, sites)?;
        let fit =
            |scans: &[_], kind| fingerprint::fit(scans, sites, lattice.clone(), &FingerprintParams::of(kind));
        let strengths = fit(&data.strengths(), ReadingKind::Strength)?;
        let ranged = data.ranges();
        let ranges = if ranged.is_empty() { None } else { Some(fit(&ranged, ReadingKind::Range)?) };
        Ok(Self { strengths, ranges })
    }

    /// The methods that stand on fingerprints.
    pub fn contestants(&self) -> Vec<Contestant<'_>> {
        let nearest = |name, weighted| {
            let params = NearestParams { weighted, ..NearestParams::default() };
            let fix = move |readings: &[Reading]| self.strengths.fingerprints.nearest(readings, &params);
            Contestant { name, uses: Uses::Strengths, fix: Box::new(fix) }
        };
        let on_map = |name, uses, fit: &FingerprintFit| {
            let (map, params) = (fit.map.clone(), fit.belief);
            let fix = move |readings: &[Reading]| -> Option<PlaceFix> { map.fix(readings, &params) };
            Contestant { name, uses, fix: Box::new(fix) }
        };
        let mut all = vec![
            nearest("nearest 5", false),
            nearest("nearest 5, weighted", true),
            on_map("process map", Uses::Strengths, &self.strengths),
        ];
        if let Some(ranges) = &self.ranges {
            all.push(on_map("ranges, process map", Uses::Ranges, ranges));
        }
        all
    }

    /// The methods that follow a walk.
    pub fn followers(&self, data: &RadioData) -> Vec<Follower<'_>> {
        let map = &self.strengths.map;
        if !walks(data) {
            return Vec::new();
        }
        vec![
            Follower { name: "process walk", map, smoothed: false },
            Follower { name: "process walk, smoothed", map, smoothed: true },
        ]
    }
}

/// Fits, judges, writes.
pub fn run(args: &CalibrateFingerprintArgs) -> Result<()> {
    let (all, tests) = read(&args.radio)?;
    let sites = match &args.access_points {
        Some(path) => data::sites(&all, &data::places(path)?, path)?,
        None => vec![None; all.transmitters.len()],
    };
    let trials = trials(&args.radio, &all, tests)?;
    let mut results = Vec::new();
    for trial in &trials {
        crate::interrupt::check()?;
        let maps = SiteMaps::new(&trial.train, &sites)?;
        let judged = contest::run(&trial.test, &maps.contestants(), &maps.followers(&trial.test));
        results.push((trial, judged));
    }
    let tables = tables(&results);
    let maps = SiteMaps::new(&all, &sites)?;
    let file = model(&all, &maps);
    let text = serde_json::to_string(&file)? + "\n";
    let said = if args.radio.json {
        let lattice = maps.strengths.map.lattice();
        let report = Report {
            data: args.radio.data.iter().map(|path| path.display().to_string()).collect(),
            transmitters: all.transmitters.len(),
            places: lattice.len(),
            step_m: lattice.step_m(),
            scales: maps.strengths.scales,
            range_scales: maps.ranges.as_ref().map(|ranges| ranges.scales),
            belief: maps.strengths.belief,
            range_belief: maps.ranges.as_ref().map(|ranges| ranges.belief),
            judged: &tables,
        };
        serde_json::to_string_pretty(&report)? + "\n"
    } else {
        table(&all, &maps, &tables)?
    };
    deliver(&args.out, &text, &said)
}

/// What the file holds.
pub fn model(all: &RadioData, maps: &SiteMaps) -> FingerprintModel {
    FingerprintModel {
        kind: ModelKind::Fingerprint,
        version: VERSION,
        transmitters: all.transmitters.clone(),
        strengths: maps.strengths.map.clone(),
        ranges: maps.ranges.as_ref().map(|ranges| ranges.map.clone()),
        belief: maps.strengths.belief,
        range_belief: maps.ranges.as_ref().map(|ranges| ranges.belief),
        fingerprints: maps.strengths.fingerprints.clone(),
    }
}

fn table(all: &RadioData, maps: &SiteMaps, tables: &[Table]) -> Result<String> {
    let lattice = maps.strengths.map.lattice();
    let mut text = format!("data         {}\n", all.name());
    writeln!(
        text,
        "map          {} transmitters at {} places, {:.2} m apart, {} spots surveyed",
        all.transmitters.len(),
        lattice.len(),
        lattice.step_m(),
        maps.strengths.fingerprints.spots.len()
    )?;
    let mut say = |name: &str, unit: &str, fit: &FingerprintFit| {
        let (s, b) = (&fit.scales, &fit.belief);
        writeln!(
            text,
            "{name:12} shadowing {:.1} {unit} over {:.1} m, spot {:.1} {unit}, reading {:.1} {unit}\n\
             believed     tails of {} degrees of freedom, tag ± {:.1} {unit}, silence {:.1}, share {:.2}",
            s.shadowing_sigma,
            s.length_m,
            s.spot_sigma,
            s.within.sqrt(),
            b.dof,
            b.offset_sigma,
            b.heard_weight,
            b.share
        )
    };
    say("strengths", "dB", &maps.strengths)?;
    if let Some(ranges) = &maps.ranges {
        say("ranges", "m", ranges)?;
    }
    let floors = lattice.floors().len() > 1;
    for judged in tables {
        judged.write(&mut text, floors)?;
    }
    Ok(text)
}
