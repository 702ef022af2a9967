//! Learning the network, with candle on the processor.
//!
//! - It begins at the discriminant and learns what that leaves: `logits = discriminant / T₀ + network`, the head of the network zero at the start. A network of this size that begins
//!   from nothing can collapse to one class on a few dozen geometries; this one cannot be worse than the discriminant before its first step.
//! - Cross-entropy with smoothed labels (Szegedy et al. 2016), Adam with decoupled decay (Loshchilov & Hutter 2019), a warm-up of one pass and a half cosine to zero, gradients clipped to norm 1.
//! - Balanced: each sample draws a class, a group of it, then one of its ranges.
//! - Each window drawn is changed as another packet in another room might have it ([`augment`]); scores of features jump a little and are sometimes not told.
//! - How many passes: the number of least log loss on groups held out, over all folds ([`crate::judging`]).

mod augment;
mod graph;
mod learner;

pub use graph::Graph;
pub use learner::NetworkLearner;

use crate::baseline::Baseline;
use crate::discriminant::Discriminant;
use crate::error::NlosError;
use crate::examples::Examples;
use crate::network::Network;
use crate::task::MOST_CLASSES;
use crate::window;
use augment::Augment;
use candle_core::backprop::GradStore;
use candle_core::{Device, Tensor, Var};
use candle_nn::{AdamW, Optimizer, ParamsAdamW};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::ops::ControlFlow;

/// Temperature at which the discriminant enters the sum.
const START_TEMPERATURE: f32 = 3.0;

/// So many ranges are many.
const MANY: usize = 50_000;

/// Sizes of the network.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sizes {
    /// Whether it looks at responses.
    pub response: bool,
    /// Channels of the first convolution.
    pub first: usize,
    /// Of the second.
    pub second: usize,
    /// Numbers in the state of the LSTM.
    pub state: usize,
    /// Outputs of the dense layer.
    pub dense: usize,
}

/// How to train.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Of the network.
    pub sizes: Sizes,
    /// Passes at most.
    pub epochs: u32,
    /// Samples of a pass.
    pub samples: usize,
    /// Samples of a step.
    pub batch: usize,
    /// Largest step width.
    pub rate: f64,
    /// Decay of the weights.
    pub decay: f64,
    /// Share of the head's inputs that a step leaves out.
    pub dropout: f32,
    /// Standard deviation of what is added to the scores of features.
    pub jitter: f32,
    /// Share of probability spread over all classes.
    pub smoothing: f32,
}

impl Settings {
    /// For so many ranges with or without responses: a few dozen geometries are learnt by heart in a few thousand samples, many walks take more.
    pub const fn of(response: bool, ranges: usize) -> Self {
        let (epochs, samples) = if ranges < MANY { (4, 1024) } else { (6, 4096) };
        Self {
            sizes: Sizes { response, first: 16, second: 24, state: 32, dense: 16 },
            epochs,
            samples,
            batch: 64,
            rate: 1e-3,
            decay: 0.05,
            dropout: 0.3,
            jitter: 0.3,
            smoothing: 0.05,
        }
    }
}

/// Trains on some rows; gives the network after each pass, until told to stop.
pub fn train(
    examples: &Examples,
    rows: &[usize],
    baseline: &Baseline,
    settings: &Settings,
    seed: u64,
    mut after: impl FnMut(u32, Network) -> ControlFlow<()>,
) -> Result<(), NlosError> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let features = baseline.used.len();
    let graph = Graph::new(&settings.sizes, features, examples.task.questions(), &mut random)?;
    let variables = graph.variables();
    let parameters =
        ParamsAdamW { lr: settings.rate, weight_decay: settings.decay, ..ParamsAdamW::default() };
    let mut optimizer = AdamW::new(variables.clone(), parameters)?;
    let drawing = Drawing::new(examples, rows);
    let augment = Augment { dropout: settings.dropout, jitter: settings.jitter };
    let head = graph.head_inputs()?;
    let steps = settings.samples.div_ceil(settings.batch);
    let total = steps * settings.epochs as usize;
    let (weights, bias) = discriminant_tensors(&baseline.discriminants, features)?;
    let mut step = 0;
    for epoch in 0..settings.epochs {
        for _ in 0..steps {
            optimizer.set_learning_rate(settings.rate * schedule(step, steps, total));
            step += 1;
            let batch = Batch::draw(examples, baseline, settings, &drawing, &augment, &mut random);
            let loss =
                batch.loss(&graph, &weights, &bias, augment.kept(settings.batch * head, &mut random))?;
            let mut gradients = loss.backward()?;
            clip(&variables, &mut gradients, 1.0)?;
            optimizer.step(&gradients)?;
        }
        if after(epoch + 1, graph.network(&weights, &bias)?).is_break() {
            break;
        }
    }
    Ok(())
}

/// Samples of a step, row by row.
#[derive(Default)]
struct Batch {
    samples: usize,
    scores: Vec<f32>,
    windows: Vec<f32>,
    /// Probability of yes in each question.
    answers: Vec<f32>,
    /// 1 where it is told, else 0.
    asked: Vec<f32>,
}

impl Batch {
    fn draw(
        examples: &Examples,
        baseline: &Baseline,
        settings: &Settings,
        drawing: &Drawing,
        augment: &Augment,
        random: &mut ChaCha8Rng,
    ) -> Self {
        let mut batch = Self { samples: settings.batch, ..Self::default() };
        for _ in 0..settings.batch {
            let row = &examples.rows[drawing.draw(random)];
            let mut scores = baseline.scores(&row.features);
            augment.scores(&mut scores, random);
            batch.scores.extend(scores);
            if settings.sizes.response {
                let mut window = row.window.as_deref().copied().unwrap_or(window::SILENT);
                Augment::window(&mut window, random);
                batch.windows.extend(window);
            }
            for question in 0..examples.task.questions() {
                let answer = row.answer(question);
                batch.asked.push(f32::from(u8::from(answer.is_some())));
                let yes = f32::from(u8::from(answer == Some(false)));
                batch.answers.push(yes * (1.0 - settings.smoothing) + 0.5 * settings.smoothing);
            }
        }
        batch
    }

    /// Its loss, with the discriminants' weights and bias and the inputs of the head that are kept.
    fn loss(
        self,
        graph: &Graph,
        weights: &Tensor,
        bias: &Tensor,
        kept: Vec<f32>,
    ) -> candle_core::Result<Tensor> {
        let samples = self.samples;
        let tensor = |values: Vec<f32>| {
            let width = values.len() / samples;
            Tensor::from_vec(values, (samples, width), &Device::Cpu)
        };
        let scores = tensor(self.scores)?;
        let kept = tensor(kept)?;
        let added = if self.windows.is_empty() {
            graph.forward(&scores, &kept)?
        } else {
            graph.forward(&tensor(self.windows)?, &kept)?
        };
        let start = scores.matmul(weights)?.broadcast_add(bias)?;
        cross_entropy(&(start + added)?, &tensor(self.answers)?, &tensor(self.asked)?)
    }
}

/// Warm-up over one pass, then half a cosine to zero.
fn schedule(step: usize, warm: usize, total: usize) -> f64 {
    if step < warm {
        return (step + 1) as f64 / warm as f64;
    }
    let done = (step - warm) as f64 / (total - warm).max(1) as f64;
    0.5 * (1.0 + (std::f64::consts::PI * done).cos())
}

/// Mean over the batch of `−y ln σ(l) − (1 − y) ln(1 − σ(l)) = max(l, 0) − l y + ln(1 + e^−|l|)`, of the questions that were asked.
fn cross_entropy(logits: &Tensor, answers: &Tensor, asked: &Tensor) -> candle_core::Result<Tensor> {
    let tail = (logits.abs()?.neg()?.exp()? + 1.0)?.log()?;
    let loss = ((logits.relu()? - (logits * answers)?)? + tail)?;
    (loss * asked)?.sum_all()?.affine(1.0 / logits.dim(0)? as f64, 0.0)
}

/// Weights (features × questions) and bias of the discriminants at their start temperature.
fn discriminant_tensors(
    discriminants: &[Discriminant],
    features: usize,
) -> candle_core::Result<(Tensor, Tensor)> {
    let weights: Vec<f32> = (0..features)
        .flat_map(|f| discriminants.iter().map(move |d| d.weights[f] / START_TEMPERATURE))
        .collect();
    let bias: Vec<f32> = discriminants.iter().map(|d| d.bias / START_TEMPERATURE).collect();
    Ok((
        Tensor::from_vec(weights, (features, discriminants.len()), &Device::Cpu)?,
        Tensor::from_vec(bias, discriminants.len(), &Device::Cpu)?,
    ))
}

/// Scales the gradients so that their norm is at most `most`.
fn clip(variables: &[Var], gradients: &mut GradStore, most: f64) -> candle_core::Result<()> {
    let mut square = 0.0;
    for variable in variables {
        if let Some(gradient) = gradients.get(variable) {
            square += f64::from(gradient.sqr()?.sum_all()?.to_scalar::<f32>()?);
        }
    }
    let norm = square.sqrt();
    if norm > most {
        for variable in variables {
            if let Some(gradient) = gradients.remove(variable) {
                gradients.insert(variable, gradient.affine(most / norm, 0.0)?);
            }
        }
    }
    Ok(())
}

/// Draws rows: a class and how many its set tells, a group of both, a range of the group. Of four classes each question is answered yes as often as no, as the
/// scalings take it ([`crate::calibration`]).
struct Drawing {
    /// Each as often as it stands here.
    cells: Vec<Vec<Vec<usize>>>,
}

impl Drawing {
    fn new(examples: &Examples, rows: &[usize]) -> Self {
        let of = |class: usize, told: usize| -> Vec<Vec<usize>> {
            let mut groups = vec![Vec::new(); examples.groups.len()];
            let here = |row: &&usize| {
                let row = &examples.rows[**row];
                row.class == class && row.told == told
            };
            for row in rows.iter().filter(here) {
                groups[examples.rows[*row].group].push(*row);
            }
            groups.retain(|group| !group.is_empty());
            groups
        };
        let classes = examples.task.classes().len();
        let mut cells = Vec::new();
        for (class, told) in (0..classes).flat_map(|class| (2..=classes).map(move |told| (class, told))) {
            let groups = of(class, told);
            if !groups.is_empty() {
                // 4 + 2 + 1 + 1.
                let times = if told == MOST_CLASSES {
                    1 << (MOST_CLASSES - 2_usize).saturating_sub(class)
                } else {
                    1
                };
                cells.extend(std::iter::repeat_n(groups, times));
            }
        }
        Self { cells }
    }

    fn draw(&self, random: &mut ChaCha8Rng) -> usize {
        let groups = &self.cells[below(self.cells.len(), random)];
        let group = &groups[below(groups.len(), random)];
        group[below(group.len(), random)]
    }
}

/// A whole number below `count`.
fn below(count: usize, random: &mut ChaCha8Rng) -> usize {
    #[expect(clippy::cast_possible_truncation, reason = "below count")]
    let drawn = (random.next_u64() % count as u64) as usize;
    drawn
}
