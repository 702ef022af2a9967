//! Judged on groups that were held out: how well what is learnt of one place serves at another.

use crate::baseline::Baseline;
use crate::calibration::{self, Logits, Scaling, Scalings};
use crate::error::NlosError;
use crate::examples::{Example, Examples};
use crate::link_filter::{LinkFilter, Persistence};
use crate::measures::{self, Measures};
use crate::model::{Model, Probabilities};
use crate::network::Scratch;
use crate::task::Task;
use rayon::prelude::*;
use serde::Serialize;
use std::collections::HashMap;

/// How a model and its baseline do on labelled ranges; where the model and the ranges do not have the same classes, on line of sight or not.
#[derive(Debug, Clone, Serialize)]
pub struct Judgement {
    /// The model's.
    #[serde(flatten)]
    pub model: Measures,
    /// Of the discriminant in it; the same where it has no network.
    pub baseline: Measures,
    /// The model's with what was told of each link before kept in mind ([`LinkFilter`]), of ranges with times.
    pub filtered: Option<Measures>,
    /// Group by group, what the model said.
    pub groups: Vec<GroupJudgement>,
}

/// How a model does on one group and class.
#[derive(Debug, Clone, Serialize)]
pub struct GroupJudgement {
    /// Name of the group.
    pub group: String,
    /// True class.
    pub class: &'static str,
    /// Its ranges.
    pub ranges: usize,
    /// Share of them told to be of each class.
    pub told: Vec<f64>,
}

/// Judges a model on labelled ranges.
pub fn judge(model: &Model, examples: &Examples) -> Judgement {
    let task = model.task;
    let classes = task.common(examples.task);
    let names = if classes == 2 { Task::LineOfSight.classes() } else { task.classes() };
    let truth = |row: &Example| row.class.min(classes - 1);
    let merged = |mut told: Probabilities| {
        if classes == 2 {
            told = [told[0], told[1..].iter().sum(), 0.0, 0.0];
        }
        told
    };
    let asked = |of: &(dyn Fn(&Example, &mut Scratch) -> Probabilities + Sync)| -> Vec<Probabilities> {
        examples.rows.par_iter().map_init(Scratch::default, |scratch, row| merged(of(row, scratch))).collect()
    };
    let of_model = |row: &Example, scratch: &mut Scratch| {
        model.judge_features(&row.features, row.window.as_deref(), scratch)
    };
    let network = asked(&of_model);
    let filtered = filtered(model, examples, Persistence::default())
        .map(|told| told.into_iter().map(merged).collect::<Vec<_>>());
    let baseline = asked(&|row, _| model.judge_baseline(&row.features));
    let measures = |told: &[Probabilities]| {
        Measures::of(names, examples.rows.iter().zip(told).map(|(row, p)| (truth(row), &p[..classes])))
    };
    let mut cells = vec![vec![vec![0_usize; classes]; classes]; examples.groups.len()];
    for (row, told) in examples.rows.iter().zip(&network) {
        cells[row.group][truth(row)][measures::told(&told[..classes]).0] += 1;
    }
    let groups = examples.groups.iter().zip(&cells).flat_map(|(group, cells)| {
        cells.iter().zip(names).filter_map(|(told, class)| {
            let ranges: usize = told.iter().sum();
            let share = |told: &usize| *told as f64 / ranges as f64;
            let (group, told) = (group.name.clone(), told.iter().map(share).collect());
            (ranges > 0).then_some(GroupJudgement { group, class, ranges, told })
        })
    });
    Judgement {
        model: measures(&network),
        baseline: measures(&baseline),
        filtered: filtered.map(|told| measures(&told)),
        groups: groups.collect(),
    }
}

/// Judgements of ranges, each with what was told of its link before; `None` where some have no time.
pub fn filtered(model: &Model, examples: &Examples, persistence: Persistence) -> Option<Vec<Probabilities>> {
    let mut order = (0..examples.rows.len())
        .map(|row| examples.rows[row].at.map(|(time, link)| (time, link, row)))
        .collect::<Option<Vec<_>>>()?;
    order.sort_unstable();
    let filter = LinkFilter::new(model, persistence);
    let (mut links, mut scratch) = (vec![filter; examples.links], Scratch::default());
    let mut told = vec![Probabilities::default(); examples.rows.len()];
    for (time, link, row) in order {
        let Example { features, window, .. } = &examples.rows[row];
        told[row] =
            links[link].update(time, &model.judge_features(features, window.as_deref(), &mut scratch));
    }
    Some(told)
}

/// What is learnt of some rows and asked of others.
pub trait Learner: Sync {
    /// Learns of the rows `learn` and gives the logits of the rows `ask`: once, or after each pass over the data.
    fn logits(
        &self,
        examples: &Examples,
        learn: &[usize],
        ask: &[usize],
        fold: u64,
    ) -> Result<Vec<Vec<Logits>>, NlosError>;
}

/// The discriminant.
#[derive(Debug, Clone, Copy)]
pub struct BaselineLearner {
    /// Of the correlations.
    pub shrinkage: f64,
}

impl Learner for BaselineLearner {
    fn logits(
        &self,
        examples: &Examples,
        learn: &[usize],
        ask: &[usize],
        _: u64,
    ) -> Result<Vec<Vec<Logits>>, NlosError> {
        let baseline = Baseline::learn(examples, learn, self.shrinkage)?;
        Ok(vec![ask.iter().map(|row| baseline.logits(&examples.rows[*row].features)).collect()])
    }
}

/// Judgements of every row by what was learnt without its group.
#[derive(Debug, Clone, Default)]
pub struct HeldOut {
    /// Of every judged row its number.
    pub rows: Vec<usize>,
    /// Its logits.
    pub logits: Vec<Logits>,
}

impl HeldOut {
    /// Fold by fold, after each pass; `also` are rows to learn from that are never held out.
    pub fn after_each(
        learner: &impl Learner,
        examples: &Examples,
        folds: &[Vec<usize>],
        also: &[usize],
    ) -> Result<Vec<Self>, NlosError> {
        let of = |groups: &[usize]| -> Vec<usize> {
            (0..examples.rows.len()).filter(|row| groups.contains(&examples.rows[*row].group)).collect()
        };
        let judged: Vec<(Vec<usize>, Vec<Vec<Logits>>)> = folds
            .par_iter()
            .enumerate()
            .map(|(fold, held)| {
                let everything = folds.iter().flatten();
                let others: Vec<usize> = everything.copied().filter(|group| !held.contains(group)).collect();
                let mut learn = of(&others);
                learn.extend(also);
                let ask = of(held);
                let logits = learner.logits(examples, &learn, &ask, fold as u64)?;
                Ok((ask, logits))
            })
            .collect::<Result<_, NlosError>>()?;
        let mut passes = vec![Self::default(); judged.first().map_or(0, |(_, logits)| logits.len())];
        for (rows, logits) in judged {
            for (pass, logits) in passes.iter_mut().zip(logits) {
                pass.rows.extend(&rows);
                pass.logits.extend(logits);
            }
        }
        Ok(passes)
    }

    /// The same of what is learnt at once.
    pub fn of(
        learner: &impl Learner,
        examples: &Examples,
        folds: &[Vec<usize>],
        also: &[usize],
    ) -> Result<Self, NlosError> {
        Ok(Self::after_each(learner, examples, folds, also)?.pop().unwrap_or_default())
    }

    /// The scalings that make them hold, of the rows that `with` lets count.
    fn scalings_of(&self, examples: &Examples, with: impl Fn(usize) -> bool) -> Scalings {
        let mut scalings = Scalings::new();
        for question in 0..examples.task.questions() {
            let judged = self.rows.iter().zip(&self.logits).filter(|(row, _)| with(**row));
            let judged: Vec<_> = judged
                .filter_map(|(row, logits)| Some((examples.rows[*row].answer(question)?, logits[question])))
                .collect();
            scalings.push(Scaling::learn(&judged, examples.odds(&self.rows, question)));
        }
        scalings
    }

    /// The scalings that make them hold.
    pub fn scalings(&self, examples: &Examples) -> Scalings {
        self.scalings_of(examples, |_| true)
    }

    /// How good they are, the probabilities of each group scaled by what makes those of the others hold.
    pub fn measures(&self, examples: &Examples) -> Measures {
        let classes = examples.task.classes().len();
        let mut groups: Vec<usize> = self.rows.iter().map(|row| examples.rows[*row].group).collect();
        groups.sort_unstable();
        groups.dedup();
        let scalings: HashMap<usize, Scalings> = groups
            .into_par_iter()
            .map(|group| (group, self.scalings_of(examples, |row| examples.rows[row].group != group)))
            .collect();
        let told: Vec<Probabilities> = self
            .rows
            .iter()
            .zip(&self.logits)
            .map(|(row, logits)| {
                calibration::probabilities(*logits, &scalings[&examples.rows[*row].group], classes)
            })
            .collect();
        let judged = self.rows.iter().zip(&told);
        Measures::of(
            examples.task.classes(),
            judged.map(|(row, p)| (examples.rows[*row].class, &p[..classes])),
        )
    }
}
