//! The fitness of system S1: the filter of `pdr-wifi` over the reports of the tag, made once for each log.
//!
//! Steps and positions by radio do not depend on the noises of the filter; an evaluation is the filter alone, some ten nanoseconds a report. Judged at
//! the reports, in the frame of the site: the inverse of the fitness (Lu, Zhao & Xu, eq. 19), as a mean.

use super::objective::{FAILED, Objective};
use super::parameters::Parameters;
use super::runs::Runs;
use adit_core::nalgebra::Vector2;
use adit_core::time::Time;
use adit_core::trajectory::Trajectory;
use adit_estimation::methods::MethodSettings;
use adit_estimation::methods::pdr_wifi::{FusionParams, PdrWifi, PdrWifiParams, Walk, squared_error_m2};
use anyhow::{Context, Result};

/// The reports of all logs.
pub struct Reports {
    logs: Vec<Log>,
    /// Which noise of the filter each parameter is.
    places: Vec<usize>,
}

struct Log {
    fusion: FusionParams,
    start_sigma_m: Vector2<f64>,
    walk: Walk,
}

impl Reports {
    /// Makes the reports; `None` where a parameter is searched on which they depend.
    pub fn of(runs: &Runs, parameters: &Parameters) -> Result<Option<Self>> {
        let place = |name: &str| FusionParams::NOISE.iter().position(|known| known.path == name);
        let places: Option<Vec<usize>> = parameters.0.iter().map(|one| place(&one.name)).collect();
        let Some(places) = places else { return Ok(None) };
        let logs = runs.map(|trial, settings, truth| {
            let mut settings: PdrWifiParams = settings.clone().try_into()?;
            if let Some(radio) = &trial.radio {
                settings = settings.at_site(radio);
            }
            let fusion = settings.fusion.clone();
            let sigma_m = Vector2::repeat(fusion.fix_sigma_m);
            let start_sigma_m = settings.start_sigma_m().unwrap_or(sigma_m);
            let mut method = PdrWifi::new(settings)?.keeping_reports();
            trial.run(&mut method, |_| {}).with_context(|| trial.name.clone())?;
            let reports = method.report().kept.iter().flatten();
            let known = reports.filter_map(|report| Some((*report, true_place_m(truth, report.time_s)?)));
            Ok(Log { fusion, start_sigma_m, walk: Walk { reports: known.collect() } })
        })?;
        Ok(Some(Self { logs, places }))
    }
}

fn true_place_m(truth: &Trajectory, time_s: f64) -> Option<Vector2<f64>> {
    Some(truth.at(Time::from_seconds(time_s)?)?.position_m.xy())
}

impl Objective for Reports {
    fn cost(&self, values: &[f64]) -> f64 {
        let cost = |log: &Log| {
            let mut fusion = log.fusion.clone();
            for (place, value) in self.places.iter().zip(values) {
                fusion.set_noise(*place, *value);
            }
            let count = log.walk.reports.len().max(1) as f64;
            let squared = squared_error_m2(&fusion, log.start_sigma_m, core::slice::from_ref(&log.walk));
            if squared.is_finite() { (squared / count).min(FAILED) } else { FAILED }
        };
        self.logs.iter().map(cost).sum::<f64>() / self.logs.len().max(1) as f64
    }
}
