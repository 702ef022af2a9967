//! From labelled ranges to a model, with its scores on groups held out.

use crate::baseline::{Baseline, SHRINKAGE};
use crate::error::NlosError;
use crate::examples::Examples;
use crate::features;
use crate::folds;
use crate::judging::{BaselineLearner, HeldOut};
use crate::measures::Measures;
use crate::model::{DataRecord, HeldOutRecord, Model, Record, ScoreRecord, VERSION};
use adit_observation::csv_log::labelled::{LabelledRanges, LinkClass};

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
        let examples = Examples::of(&all);
        let before: usize = all[..judged].iter().map(|set| set.ranges.len()).sum();
        let rows = (0..before).collect();
        let also = (before..examples.rows.len()).collect();
        let records = all.iter().enumerate().map(|(k, set)| record(set, &examples.classes, k >= judged)).collect();
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
        classes: examples.classes.clone(),
        features: baseline.used.iter().map(|k| features::NAMES[*k].to_owned()).collect(),
        baseline_scalings: held.scalings(examples),
        network: None,
        seed: plan.seed,
        data: data.records.clone(),
        held_out: HeldOutRecord {
            folds: folds.len(),
            baseline: ScoreRecord::from(&measures),
            network: None,
        },
        note: plan.note.clone(),
    };
    Ok(Learnt { model: Model { record, baseline, network: None }, baseline: measures, network: None })
}

fn record(set: &LabelledRanges, classes: &[LinkClass], only_learnt: bool) -> DataRecord {
    let of = |class: LinkClass| set.ranges.iter().filter(move |range| range.class == class);
    let groups = |class: &LinkClass| {
        let mut groups: Vec<usize> = of(*class).map(|range| range.group).collect();
        groups.sort_unstable();
        groups.dedup();
        groups.len()
    };
    // A folder is known by its name, not by that of the table in it.
    let folder = set.file.parent().and_then(std::path::Path::file_name);
    let name = folder.or(set.file.file_name()).unwrap_or_default();
    DataRecord {
        name: name.to_string_lossy().into_owned(),
        ranges: classes.iter().map(|class| of(*class).count()).collect(),
        groups: classes.iter().map(groups).collect(),
        only_learnt,
    }
}
