//! What contenders learn before a run is judged: settings tuned on another person's log, fingerprints of a survey, how ranges err.

use crate::judged_ranges::JudgedRanges;
use crate::scenario_file::{Contender, Contest, Tuning};
use crate::verbs::trials::{Trial, Trials};
use crate::verbs::tune::{self, TuningTask};
use adit_estimation::radio::nearest::Fingerprints;
use adit_estimation::radio::{RadioSite, Reading, Surveyed};
use adit_estimation::ranging::correction::RangeCorrection;
use adit_observation::csv_log::labelled::LinkClass;
use adit_observation::{DeviceId, Observation, Radio};
use adit_simulation::radio::LinkClass as SimulatedClass;
use adit_tuning::fingerprint::fingerprints;
use adit_tuning::radio::{SurveyedScan, by_spot};
use adit_tuning::ranges::KnownRange;
use anyhow::{Context, Result};
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Fingerprints within a square of this size are one, m: what somebody walks over in a second.
const CELL_M: f64 = 0.5;
/// Ranges of so long are of one place, s: what is held out when the model of their errors is chosen.
const PLACE_S: f64 = 10.0;

/// Lessons before one run.
pub struct Lessons<'a> {
    trials: &'a Trials,
    contest: &'a Contest,
    index: usize,
    surveyed: BTreeMap<usize, Surveyed>,
    calibrated: BTreeMap<usize, RangeCorrection>,
}

impl<'a> Lessons<'a> {
    /// Before the run of this number.
    pub fn before(trials: &'a Trials, contest: &'a Contest, index: usize) -> Self {
        Self { trials, contest, index, surveyed: BTreeMap::new(), calibrated: BTreeMap::new() }
    }

    /// The contender as it enters the run.
    pub fn taught(&mut self, contender: &Contender) -> Result<Contender> {
        let (Some(optimiser), Some(tuning)) = (contender.tune, &self.contest.tuning) else {
            return Ok(contender.clone());
        };
        let Tuning { person, config, agents, evaluations } = tuning;
        let mut trial = self.trials.of_person(self.index, *person)?;
        if let Some(model) = &contender.nlos {
            trial.observations = JudgedRanges::of(model, &trial.observations);
        }
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
        if contender.survey.is_none() && contender.calibrate.is_none() {
            return Ok(trial.radio.clone());
        }
        let mut site = trial.radio.as_deref().cloned().unwrap_or_default();
        if let Some(person) = contender.survey {
            site.surveyed = Some(match self.surveyed.entry(person) {
                Entry::Occupied(known) => known.get().clone(),
                Entry::Vacant(new) => {
                    new.insert(surveyed(&self.trials.of_person(self.index, person)?)?).clone()
                }
            });
        }
        if let Some(person) = contender.calibrate {
            site = site.with_ranges(match self.calibrated.entry(person) {
                Entry::Occupied(known) => known.get().clone(),
                Entry::Vacant(new) => {
                    let known = known_ranges(&self.trials.of_person(self.index, person)?);
                    let learnt = adit_tuning::ranges::learn(&known)
                        .with_context(|| format!("{}: how ranges err", contender.name))?;
                    new.insert(learnt.correction).clone()
                }
            });
        }
        Ok(Some(Arc::new(site)))
    }
}

/// The ranges of a log with their true distances; those of [`PLACE_S`] are of one place.
fn known_ranges(trial: &Trial) -> Vec<KnownRange> {
    let ranges = trial.observations.iter().filter_map(|observation| match observation {
        Observation::Range(range) => Some(range),
        _ => None,
    });
    let Some(first) = ranges.clone().map(|range| range.time).min() else { return Vec::new() };
    let known = ranges.zip(&trial.range_truths).map(|(range, truth)| KnownRange {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "not before the first")]
        group: ((range.time - first).seconds() / PLACE_S) as usize,
        range: range.clone(),
        true_m: truth.distance_m,
        class: Some(match truth.class {
            SimulatedClass::Los => LinkClass::Los,
            SimulatedClass::Nlos => LinkClass::Nlos,
            SimulatedClass::Ndp => LinkClass::Ndp,
        }),
    });
    known.collect()
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
