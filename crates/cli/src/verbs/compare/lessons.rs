//! What contenders learn before a run is judged: settings tuned on another person's log, fingerprints of a survey.

use crate::scenario_file::{Contender, Contest, Tuning};
use crate::verbs::trials::{Trial, Trials};
use crate::verbs::tune::{self, TuningTask};
use adit_estimation::radio::nearest::Fingerprints;
use adit_estimation::radio::{RadioSite, Reading, Surveyed};
use adit_observation::{DeviceId, Observation, Radio};
use adit_tuning::fingerprint::fingerprints;
use adit_tuning::radio::{SurveyedScan, by_spot};
use anyhow::{Context, Result};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Fingerprints within a square of this size are one, m: what somebody walks over in a second.
const CELL_M: f64 = 0.5;

/// Lessons before one run.
pub struct Lessons<'a> {
    trials: &'a Trials,
    contest: &'a Contest,
    index: usize,
    surveyed: BTreeMap<usize, Arc<RadioSite>>,
}

impl<'a> Lessons<'a> {
    /// Before the run of this number.
    pub fn before(trials: &'a Trials, contest: &'a Contest, index: usize) -> Self {
        Self { trials, contest, index, surveyed: BTreeMap::new() }
    }

    /// The contender as it enters the run.
    pub fn taught(&mut self, contender: &Contender) -> Result<Contender> {
        let (Some(optimiser), Some(tuning)) = (contender.tune, &self.contest.tuning) else {
            return Ok(contender.clone());
        };
        let Tuning { person, config, agents, evaluations } = tuning;
        let trial = self.trials.of_person(self.index, *person)?;
        let mut base = contender.config.clone();
        crate::config::merge(&mut base, config.clone());
        let task =
            TuningTask { optimiser, agents: *agents, evaluations: *evaluations, seed: self.index as u64 };
        let found = tune::on_trial(contender.method, trial, &base, &task)
            .with_context(|| format!("{}: tuning", contender.name))?;
        let mut taught = contender.clone();
        crate::config::merge(&mut taught.config, found);
        Ok(taught)
    }

    /// The site as the contender knows it.
    pub fn site(&mut self, contender: &Contender, trial: &Trial) -> Result<Option<Arc<RadioSite>>> {
        let Some(person) = contender.survey else { return Ok(trial.radio.clone()) };
        if let Some(known) = self.surveyed.get(&person) {
            return Ok(Some(Arc::clone(known)));
        }
        let survey = self.trials.of_person(self.index, person)?;
        let mut site = trial.radio.as_deref().cloned().unwrap_or_default();
        site.surveyed = Some(surveyed(&survey)?);
        let site = Arc::new(site);
        self.surveyed.insert(person, Arc::clone(&site));
        Ok(Some(site))
    }
}

/// Each scan of a log as a fingerprint at its true place.
fn surveyed(survey: &Trial) -> Result<Surveyed> {
    let truth = survey.path()?;
    let signals = || {
        survey.observations.iter().filter_map(|observation| match observation {
            Observation::Signal(signal) if signal.radio == Radio::Wifi => Some(signal),
            _ => None,
        })
    };
    let transmitters: Vec<DeviceId> =
        signals().map(|signal| signal.transmitter.clone()).collect::<BTreeSet<_>>().into_iter().collect();
    let mut scans = BTreeMap::new();
    for signal in signals() {
        let Some(pose) = truth.at(signal.time) else { continue };
        let scan = scans.entry(signal.time).or_insert_with(|| SurveyedScan {
            position_m: pose.position_m,
            floor: 0,
            readings: Vec::new(),
            whole: true,
        });
        if let Ok(transmitter) = transmitters.binary_search(&signal.transmitter) {
            scan.readings.push(Reading { transmitter, value: signal.rssi_dbm });
        }
    }
    let scans: Vec<SurveyedScan> = scans.into_values().collect();
    let spots = by_spot(&scans, transmitters.len(), CELL_M);
    let fingerprints: Fingerprints = fingerprints(&spots, transmitters.len());
    Ok(Surveyed { transmitters, fingerprints, map: None })
}
