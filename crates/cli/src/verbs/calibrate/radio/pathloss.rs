//! `adit calibrate pathloss`: a survey in, path loss and range offsets out.

use super::data::{self, RadioData};
use super::judge::{Table, tables};
use super::models::SiteModels;
use super::{contest, deliver, read, trials};
use crate::args::CalibratePathlossArgs;
use adit_core::frames::Position;
use adit_estimation::radio::model::{ModelKind, PathLossModel, SignalScatter, VERSION};
use adit_estimation::radio::range_fit::RangeModel;
use adit_mine::plan::{AccessPoint, Radio};
use adit_tuning::radio::Site;
use adit_tuning::radio::path_loss::PathLossFit;
use adit_tuning::radio::ranges::RangesFit;
use anyhow::Result;
use serde::Serialize;
use std::fmt::Write as _;

/// What `--json` prints.
#[derive(Serialize)]
struct Report<'a> {
    data: Vec<String>,
    transmitters: usize,
    path_loss: &'a PathLossFit,
    ranges: Option<&'a RangesFit>,
    judged: &'a [Table],
}

/// Fits, judges, writes.
pub fn run(args: &CalibratePathlossArgs) -> Result<()> {
    let (all, tests) = read(&args.radio)?;
    let places = data::places(&args.access_points)?;
    let sites = data::sites(&all, &places, &args.access_points)?;
    let trials = trials(&args.radio, &all, tests)?;
    let mut results = Vec::new();
    for trial in &trials {
        crate::interrupt::check()?;
        let models = SiteModels::new(&trial.train, &sites)?;
        let judged = contest::run(&trial.test, &models.contestants(), &models.followers(&trial.test));
        results.push((trial, judged));
    }
    let tables = tables(&results);
    let models = SiteModels::new(&all, &sites)?;
    let file = model(&all, &models);
    let text = format!(
        "# adit calibrate pathloss {}\n# [[access_points]] are those of a mine file.\n{}",
        all.name(),
        toml::to_string(&file)?
    );
    let said = if args.radio.json {
        let report = Report {
            data: args.radio.data.iter().map(|path| path.display().to_string()).collect(),
            transmitters: all.transmitters.len(),
            path_loss: &models.fit,
            ranges: models.ranges.as_ref(),
            judged: &tables,
        };
        serde_json::to_string_pretty(&report)? + "\n"
    } else {
        table(&all, &models, &tables)?
    };
    deliver(&args.out, &text, &said)
}

/// What the file holds.
pub fn model(all: &RadioData, models: &SiteModels) -> PathLossModel {
    let fit = &models.fit;
    let access_point =
        |(id, emitter): (&adit_observation::DeviceId, &Option<adit_estimation::radio::Emitter>)| {
            let emitter = (*emitter)?;
            let [x, y, z] = emitter.position_m.into();
            Some(AccessPoint {
                id: id.to_string(),
                radio: Radio::Wifi,
                mac: None,
                position_m: Position::new(x, y, z),
                tx_power_dbm: None,
                path_loss: Some(emitter.path_loss),
            })
        };
    let range =
        |(id, model): (&adit_observation::DeviceId, &Option<RangeModel>)| Some((id.to_string(), (*model)?));
    let floor =
        |(id, site): (&adit_observation::DeviceId, &Option<Site>)| Some((id.to_string(), (*site)?.floor?));
    PathLossModel {
        kind: ModelKind::PathLoss,
        version: VERSION,
        signal: SignalScatter {
            height_m: models.height_m,
            sigma_db: fit.sigma_db,
            rssi_at_1m_dbm: fit.common[0],
            exponent: fit.common[1],
        },
        hearing: fit.hearing,
        storeys: fit.storeys,
        area: models.area,
        belief: models.belief,
        ranges: models
            .ranges
            .iter()
            .flat_map(|ranges| all.transmitters.iter().zip(&ranges.models).filter_map(range))
            .collect(),
        floors: all.transmitters.iter().zip(&models.sites).filter_map(floor).collect(),
        access_points: all.transmitters.iter().zip(&fit.emitters).filter_map(access_point).collect(),
    }
}

fn table(all: &RadioData, models: &SiteModels, tables: &[Table]) -> Result<String> {
    let fit = &models.fit;
    let mut text = format!("data         {}\n", all.name());
    writeln!(
        text,
        "path loss    {:.1} ± {:.1} dBm at 1 m, exponent {:.2} ± {:.2} over {} transmitters, readings ± {:.1} dB ({} values)",
        fit.common[0],
        fit.between[0],
        fit.common[1],
        fit.between[1],
        fit.emitters.iter().flatten().count(),
        fit.sigma_db,
        fit.values
    )?;
    if let Some(breakpoint_m) = fit.breakpoint_m {
        writeln!(text, "two slopes   beyond {breakpoint_m:.1} m")?;
    }
    if fit.storeys.loss_db > 0.0 {
        writeln!(text, "floors       {:.1} dB from one to the next", fit.storeys.loss_db)?;
    }
    if let Some(ranges) = &models.ranges {
        writeln!(
            text,
            "ranges       offset {:.2} ± {:.2} m, scale {:.3} ± {:.3}, ± {:.2} m",
            ranges.common[0], ranges.between[0], ranges.common[1], ranges.between[1], ranges.sigma_m
        )?;
    }
    let floors = all.spots().iter().any(|(_, floor)| *floor != all.spots()[0].1);
    for judged in tables {
        judged.write(&mut text, floors)?;
    }
    Ok(text)
}
