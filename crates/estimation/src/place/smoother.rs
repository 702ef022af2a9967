//! Smoothing of a bank over a whole log: every place knows what came after it.
//!
//! ```text
//! C = P Fᵀ (F P Fᵀ + Q)⁻¹
//! x̂ = x + C (x̂⁺ − x⁻)                                 x filtered before a step, x⁻ predicted by it, x̂⁺ smoothed after it
//! Pˢ = (I − C F) P (I − C F)ᵀ + C (Pˢ⁺ + Q) Cᵀ
//! ```
//!
//! Rauch, Tung & Striebel 1965; Särkkä 2013, eq. 8.6, with the covariance as a sum of squares, which rounding leaves positive. F and Q are those of `Motion` at the filtered
//! state: what the filter did is not linearised anew.
//!
//! While it runs forward every hypothesis leaves a record at each step, with the one before it as parent. Branches share their parents' records; of two that merge the heavier
//! one's are kept; records that nobody descends from are thrown away from time to time. At the end the line of the most likely hypothesis is followed back. Whatever changes a hypothesis between
//! two steps (measurements, roadways, merging) is what was learnt there. A bank that finds itself contradicted and opens again has walked on by a large
//! error of one moment; one that is started anew begins a new [`Segment`]: what is before is not corrected by what is after.

use super::motion::Motion;
use super::state::{Covariance, FACTOR, STATES, State, Stretch, Vector, symmetrise};
use adit_core::nalgebra::Vector2;
use alloc::vec::Vec;

/// Numbers of a symmetric matrix.
const PACKED: usize = STATES * (STATES + 1) / 2;
/// Records after which dead ones are thrown away first.
const TIDIED: usize = 4096;
/// Added to the correlations of a prediction that has no Cholesky factor, and the most of it.
const JITTER: (f64, f64) = (1e-13, 1e-3);

/// A step of one hypothesis.
#[derive(Debug, Clone)]
struct Record {
    parent: Option<u32>,
    step: Step,
}

/// What a step did.
#[derive(Debug, Clone)]
struct Step {
    /// To which instant.
    to: usize,
    /// Before it, all measurements taken.
    mean: Vector,
    covariance: [f64; PACKED],
    passage: Passage,
    /// After it.
    predicted: Vector,
}

/// How a state came to be another.
#[derive(Debug, Clone)]
enum Passage {
    /// Along a stretch, on a roadway in this direction if on any.
    Way(Stretch, Option<Vector2<f64>>),
    /// The bank was opened again: variances that were added, and whether the factor was forgotten before.
    Opened(Vector, bool),
}

/// Keeps what a bank does.
#[derive(Debug, Clone, Default)]
pub struct Recorder {
    /// The instant that the bank is at or comes to next, whatever its owner counts by.
    pub instant: usize,
    begun: usize,
    records: Vec<Record>,
    tidied: usize,
    segments: Vec<Segment>,
}

/// One line of a bank from its start to its end, or to where it was started anew.
#[derive(Debug, Clone)]
pub struct Segment {
    /// The instant of its start.
    pub begun: usize,
    steps: Vec<Step>,
    last: State,
}

impl Recorder {
    /// A hypothesis that comes from `parent` has gone along a stretch; gives the name of the record.
    pub(super) fn step(
        &mut self,
        parent: Option<u32>,
        before: &State,
        (stretch, roadway): (&Stretch, Option<&Vector2<f64>>),
        after: &State,
    ) -> Option<u32> {
        self.push(parent, before, Passage::Way(*stretch, roadway.copied()), after)
    }

    /// All hypotheses have become one, of which less is known: it has the line of the most likely.
    pub(super) fn reopen(&mut self, parent: Option<u32>, before: &State, after: &State) -> Option<u32> {
        let forgotten = after.factor.to_bits() != before.factor.to_bits();
        let mut added = after.covariance.diagonal() - before.covariance.diagonal();
        if forgotten {
            added[FACTOR] = after.covariance[(FACTOR, FACTOR)];
        }
        self.push(parent, before, Passage::Opened(added, forgotten), after)
    }

    fn push(&mut self, parent: Option<u32>, before: &State, passage: Passage, after: &State) -> Option<u32> {
        let name = u32::try_from(self.records.len()).ok()?;
        let covariance = packed(&before.covariance);
        let step =
            Step { to: self.instant, mean: before.mean(), covariance, passage, predicted: after.mean() };
        self.records.push(Record { parent, step });
        Some(name)
    }

    /// Throws away what none of these descends from, where it is worth it.
    pub(super) fn tidy<'a>(&mut self, lineages: impl Iterator<Item = &'a mut Option<u32>>) {
        if self.records.len() < TIDIED.max(2 * self.tidied) {
            return;
        }
        let mut names: Vec<Option<u32>> = alloc::vec![None; self.records.len()];
        let mut lineages: Vec<&mut Option<u32>> = lineages.collect();
        for lineage in &lineages {
            let mut next = **lineage;
            while let Some(name) = next
                && names[name as usize].is_none()
            {
                names[name as usize] = Some(name);
                next = self.records[name as usize].parent;
            }
        }
        for (kept, name) in (0..).zip(names.iter_mut().flatten()) {
            *name = kept;
        }
        let renamed = |name: Option<u32>| name.and_then(|name| names.get(name as usize).copied().flatten());
        let mut index = 0;
        self.records.retain_mut(|record| {
            record.parent = renamed(record.parent);
            index += 1;
            names[index - 1].is_some()
        });
        for lineage in &mut lineages {
            **lineage = renamed(**lineage);
        }
        self.tidied = self.records.len();
    }

    /// The bank begins anew; until now this was the most likely, if any was.
    pub(super) fn open(&mut self, best: Option<(Option<u32>, &State)>) {
        if let Some((mut next, last)) = best {
            let mut steps = Vec::new();
            while let Some(record) = next.and_then(|name| self.records.get(name as usize)) {
                steps.push(record.step.clone());
                next = record.parent;
            }
            steps.reverse();
            self.segments.push(Segment { begun: self.begun, steps, last: last.clone() });
        }
        self.records.clear();
        self.tidied = 0;
        self.begun = self.instant;
    }

    /// All segments, in order of time, the last one with this end.
    pub(super) fn finish(mut self, best: Option<(Option<u32>, &State)>) -> Vec<Segment> {
        self.open(best);
        self.segments
    }
}

impl Segment {
    /// Gives the smoothed states, the last first, each with its instant.
    pub fn smooth(&self, mut give: impl FnMut(usize, State)) {
        let mut smoothed = self.last.clone();
        for step in self.steps.iter().rev() {
            // Smoothed less filtered, and what the filter learnt after the step.
            let learnt = smoothed.mean() - step.predicted;
            let before = step.back(&learnt, &smoothed.covariance);
            give(step.to, core::mem::replace(&mut smoothed, before));
        }
        give(self.begun, smoothed);
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + self.steps.capacity() * size_of::<Step>()
    }
}

impl Step {
    /// The smoothed state before it, from what was learnt of the prediction's error and the smoothed covariance after it.
    fn back(&self, learnt: &Vector, after: &Covariance) -> State {
        let filtered = State::of_mean(&self.mean, &unpacked(&self.covariance));
        let (transition, noise) = self.passage.of(&filtered);
        let p = filtered.covariance;
        let carried = transition * p;
        let mut predicted = carried * transition.transpose() + noise;
        symmetrise(&mut predicted);
        let gain = gain(&predicted, &carried);
        let left = Covariance::identity() - gain * transition;
        let mut smoothed = filtered;
        smoothed.covariance = left * p * left.transpose() + gain * (after + noise) * gain.transpose();
        symmetrise(&mut smoothed.covariance);
        smoothed.feed_back(&(gain * learnt));
        smoothed
    }
}

impl Passage {
    /// F and Q.
    fn of(&self, before: &State) -> (Covariance, Covariance) {
        let mut transition = Covariance::identity();
        match self {
            Self::Way(stretch, roadway) => {
                let motion = Motion::new(before, stretch, roadway.as_ref());
                for mut column in transition.column_iter_mut() {
                    let carried = motion.carry(&column.clone_owned());
                    column.copy_from(&carried);
                }
                let mut noise = Covariance::zeros();
                motion.spread(&mut noise);
                (transition, noise)
            }
            Self::Opened(added, forgotten) => {
                if *forgotten {
                    transition[(FACTOR, FACTOR)] = 0.0;
                }
                (transition, Covariance::from_diagonal(added))
            }
        }
    }
}

/// `C = (F P)ᵀ (F P Fᵀ + Q)⁻¹`, by correlations: variances lie twelve orders of magnitude apart. What has no variance has no gain.
fn gain(predicted: &Covariance, carried: &Covariance) -> Covariance {
    let inverse =
        predicted.diagonal().map(|variance| if variance > 0.0 { 1.0 / libm::sqrt(variance) } else { 0.0 });
    let scale = Covariance::from_diagonal(&inverse);
    let mut correlation = scale * predicted * scale;
    correlation.fill_diagonal(1.0);
    let scaled = scale * carried;
    let mut jitter = JITTER.0;
    while jitter < JITTER.1 {
        if let Some(factor) = correlation.cholesky() {
            return (scale * factor.solve(&scaled)).transpose();
        }
        correlation.fill_diagonal(1.0 + jitter);
        jitter *= 10.0;
    }
    Covariance::zeros()
}

/// The lower half, column by column.
fn packed(matrix: &Covariance) -> [f64; PACKED] {
    let mut lower = (0..STATES).flat_map(|column| (column..STATES).map(move |row| matrix[(row, column)]));
    core::array::from_fn(|_| lower.next().unwrap_or(0.0))
}

fn unpacked(lower: &[f64; PACKED]) -> Covariance {
    let mut matrix = Covariance::zeros();
    let mut values = lower.iter();
    for column in 0..STATES {
        for (row, value) in (column..STATES).zip(&mut values) {
            matrix[(row, column)] = *value;
            matrix[(column, row)] = *value;
        }
    }
    matrix
}
