//! From labelled ranges to a model, with its scores on groups held out.

use crate::baseline::{Baseline, SHRINKAGE};
use crate::error::NlosError;
use crate::examples::{Example, Examples};
use crate::features;
use crate::folds;
use crate::judging::{BaselineLearner, HeldOut};
use crate::measures::Measures;
#[cfg(feature = "train")]
use crate::model::NetworkRecord;
use crate::model::{DataRecord, HeldOutRecord, Model, Record, ScoreRecord, VERSION};
use crate::task::Task;
#[cfg(feature = "train")]
use crate::training::{self, NetworkLearner, Settings};
use adit_observation::csv_log::labelled::LabelledRanges;
#[cfg(feature = "train")]
use std::ops::ControlFlow;
#[cfg(feature = "train")]
use std::sync::atomic::{AtomicU64, Ordering};

/// So many sets are told one by one in a record.
const MOST_TOLD: usize = 12;

/// How to learn.
#[derive(Debug, Clone)]
pub struct Plan {
    /// How often some groups are held out; as many as there are groups: each alone.
    pub folds: usize,
    /// Of all that is drawn.
    pub seed: u64,
    /// What to say of the data in the record.
    pub note: Option<String>,
}

/// A model and what it did on groups that it had not learnt from.
#[derive(Debug, Clone)]
pub struct Learnt {
    /// Learnt of everything.
    pub model: Model,
    /// The baseline, held out.
    pub baseline: Measures,
    /// The network, held out.
    pub network: Option<Measures>,
}

/// The data of a training.
pub struct Data {
    /// All of it.
    pub examples: Examples,
    /// Rows that are held out in turn.
    pub rows: Vec<usize>,
    /// Rows that are only learnt from.
    pub also: Vec<usize>,
    records: Vec<DataRecord>,
}

impl Data {
    /// From sets that are held out in turn, and sets that are only learnt from.
    pub fn of(sets: Vec<LabelledRanges>, also: Vec<LabelledRanges>) -> Result<Self, NlosError> {
        let judged = sets.len();
        let all: Vec<LabelledRanges> = sets.into_iter().chain(also).collect();
        let examples = Examples::for_task(Task::of(&all[..judged]), &all);
        let before: usize = all[..judged].iter().map(|set| set.ranges.len()).sum();
        let rows = (0..before).collect();
        let also = (before..examples.rows.len()).collect();
        let mut first = 0;
        let records = all.iter().enumerate().map(|(k, set)| {
            let rows = &examples.rows[first..first + set.ranges.len()];
            first += rows.len();
            record(set, rows, examples.task, k >= judged)
        });
        let records = merged(records);
        Ok(Self { examples, rows, also, records })
    }

    /// Groups that are held out in turn, fold by fold.
    pub fn folds(&self, plan: &Plan) -> Result<Vec<Vec<usize>>, NlosError> {
        folds::by_group(&self.examples, &self.rows, plan.folds, plan.seed)
    }

    fn everything(&self) -> Vec<usize> {
        self.rows.iter().chain(&self.also).copied().collect()
    }
}

/// Learns the baseline alone.
pub fn learn_baseline(data: &Data, plan: &Plan) -> Result<Learnt, NlosError> {
    let Data { examples, also, .. } = data;
    let folds = data.folds(plan)?;
    let held = HeldOut::of(&BaselineLearner { shrinkage: SHRINKAGE }, examples, &folds, also)?;
    let measures = held.measures(examples);
    let baseline = Baseline::learn(examples, &data.everything(), SHRINKAGE)?;
    let record = Record {
        version: VERSION,
        classes: examples.task.classes().iter().map(|class| (*class).to_owned()).collect(),
        features: baseline.used.iter().map(|k| features::NAMES[*k].to_owned()).collect(),
        baseline_scalings: held.scalings(examples),
        network: None,
        seed: plan.seed,
        data: data.records.clone(),
        held_out: HeldOutRecord { folds: folds.len(), baseline: ScoreRecord::from(&measures), network: None },
        note: plan.note.clone(),
    };
    Ok(Learnt {
        model: Model { task: examples.task, record, baseline, network: None },
        baseline: measures,
        network: None,
    })
}

/// Learns the baseline and the network. `progress` is told the passes that are done and how many there will be.
#[cfg(feature = "train")]
pub fn learn(
    data: &Data,
    plan: &Plan,
    settings: &Settings,
    progress: &(dyn Fn(u64, u64) + Sync),
) -> Result<Learnt, NlosError> {
    let mut learnt = learn_baseline(data, plan)?;
    let examples = &data.examples;
    let folds = data.folds(plan)?;
    let (done, total) = (AtomicU64::new(0), u64::from(settings.epochs) * (folds.len() as u64 + 1));
    let pass = || progress(done.fetch_add(1, Ordering::Relaxed) + 1, total);
    // After each pass the judgements of what was held out, fold by fold.
    let learner = NetworkLearner { settings, seed: plan.seed, after: &pass };
    let passes = HeldOut::after_each(&learner, examples, &folds, &data.also)?;
    let judged: Vec<Measures> = passes.iter().map(|held| held.measures(examples)).collect();
    let best = (0..judged.len()).min_by(|a, b| judged[*a].log_loss.total_cmp(&judged[*b].log_loss));
    let best = best.ok_or(NlosError::NoFeatures)?;
    let epochs = u32::try_from(best + 1).unwrap_or(settings.epochs);
    let mut network = None;
    training::train(
        examples,
        &data.everything(),
        &learnt.model.baseline,
        settings,
        plan.seed,
        |epoch, made| {
            pass();
            network = Some(made);
            if epoch == epochs { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        },
    )?;
    let measures = judged[best].clone();
    learnt.model.record.network = Some(NetworkRecord { scalings: passes[best].scalings(examples), epochs });
    learnt.model.record.held_out.network = Some(ScoreRecord::from(&measures));
    learnt.model.network = network;
    learnt.network = Some(measures);
    Ok(learnt)
}

fn record(set: &LabelledRanges, rows: &[Example], task: Task, only_learnt: bool) -> DataRecord {
    let of = |class: usize| rows.iter().filter(move |row| row.class == class);
    let groups = |class: usize| {
        let mut groups: Vec<usize> = of(class).map(|row| row.group).collect();
        groups.sort_unstable();
        groups.dedup();
        groups.len()
    };
    let classes = 0..task.classes().len();
    let name = set.path.file_name().unwrap_or(set.path.as_os_str());
    DataRecord {
        name: name.to_string_lossy().into_owned(),
        ranges: classes.clone().map(|class| of(class).count()).collect(),
        groups: classes.map(groups).collect(),
        only_learnt,
        sets: 1,
    }
}

/// Many sets are told as one: from the first to the last, with the sums.
fn merged(records: impl Iterator<Item = DataRecord>) -> Vec<DataRecord> {
    let records: Vec<DataRecord> = records.collect();
    if records.len() <= MOST_TOLD {
        return records;
    }
    [false, true]
        .into_iter()
        .filter_map(|only_learnt| {
            let mut of = records.iter().filter(|record| record.only_learnt == only_learnt);
            let mut sum = of.next()?.clone();
            let first = sum.name.clone();
            for record in of {
                sum.name = format!("{first} to {}", record.name);
                sum.sets += 1;
                for (sum, one) in sum.ranges.iter_mut().zip(&record.ranges) {
                    *sum += one;
                }
                for (sum, one) in sum.groups.iter_mut().zip(&record.groups) {
                    *sum += one;
                }
            }
            Some(sum)
        })
        .collect()
}
