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

pub use graph::Graph;

use crate::baseline::Baseline;
use crate::discriminant::Discriminant;
use crate::error::NlosError;
use crate::examples::Examples;
use crate::network::Network;
use crate::window;
use augment::Augment;
use candle_core::backprop::GradStore;
use candle_core::{D, Device, Tensor, Var};
use candle_nn::ops::log_softmax;
use candle_nn::{AdamW, Optimizer, ParamsAdamW};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Temperature at which the discriminant enters the sum.
const START_TEMPERATURE: f32 = 3.0;

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
    pub smoothing: f64,
}

impl Settings {
    /// For ranges with or without responses.
    pub fn of(response: bool) -> Self {
        let number = |name: &str, default: f64| {
            std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default)
        };
        Self {
            sizes: Sizes { response, first: number("C1", 16.0) as usize, second: number("C2", 24.0) as usize, state: number("ST", 32.0) as usize, dense: number("DE", 16.0) as usize },
            epochs: number("EP", 12.0) as u32,
            samples: number("SA", 1024.0) as usize,
            batch: 64,
            rate: number("LR", 2e-3),
            decay: number("WD", 0.05),
            dropout: number("DO", 0.3) as f32,
            jitter: number("JI", 0.3) as f32,
            smoothing: number("SM", 0.05),
        }
    }
}

/// Trains on some rows; gives the network after each pass.
pub fn train(
    examples: &Examples,
    rows: &[usize],
    baseline: &Baseline,
    settings: &Settings,
    seed: u64,
    mut after: impl FnMut(u32, Network),
) -> Result<(), NlosError> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let classes = examples.classes.len();
    let features = baseline.used.len();
    let graph = Graph::new(&settings.sizes, features, classes, &mut random)?;
    let variables = graph.variables();
    let parameters = ParamsAdamW { lr: settings.rate, weight_decay: settings.decay, ..ParamsAdamW::default() };
    let mut optimizer = AdamW::new(variables.clone(), parameters)?;
    let drawing = Drawing::new(examples, rows);
    let augment = Augment { dropout: settings.dropout, jitter: settings.jitter };
    let head = graph.head_inputs()?;
    let steps = settings.samples.div_ceil(settings.batch);
    let total = steps * settings.epochs as usize;
    let offset: Vec<Tensor> = discriminant_tensors(&baseline.discriminant, features)?;
    let mut step = 0;
    for epoch in 0..settings.epochs {
        for _ in 0..steps {
            optimizer.set_learning_rate(settings.rate * schedule(step, steps, total));
            step += 1;
            let (mut scores, mut windows, mut labels) = (Vec::new(), Vec::new(), Vec::new());
            for _ in 0..settings.batch {
                let row = &examples.rows[drawing.draw(&mut random)];
                let mut z = baseline.scores(&row.features);
                augment.scores(&mut z, &mut random);
                scores.extend(z);
                if settings.sizes.response {
                    let mut taps = row.window.as_deref().copied().unwrap_or([0.0; window::TAPS * window::CHANNELS]);
                    augment.window(&mut taps, &mut random);
                    windows.extend(taps);
                }
                let smooth = settings.smoothing / classes as f64;
                #[expect(clippy::cast_possible_truncation, reason = "a probability")]
                labels.extend((0..classes).map(|c| {
                    if c == row.class { (1.0 - settings.smoothing + smooth) as f32 } else { smooth as f32 }
                }));
            }
            let mut kept: Vec<f32> = augment.kept(settings.batch * head, &mut random);
            if std::env::var("RO").is_ok() { for (k, v) in kept.iter_mut().enumerate() { if k % head >= settings.sizes.state { *v = 0.0; } } }
            let tensor = |values: Vec<f32>, width: usize| Tensor::from_vec(values, (settings.batch, width), &Device::Cpu);
            let scores = tensor(scores, features)?;
            let windows = if settings.sizes.response {
                Some(tensor(windows, window::TAPS * window::CHANNELS)?)
            } else {
                None
            };
            let added = graph.forward(&scores, windows.as_ref(), Some(&tensor(kept, head)?))?;
            let start = scores.matmul(&offset[0])?.broadcast_add(&offset[1])?;
            let told = log_softmax(&(start + added)?, D::Minus1)?;
            let loss = (told * tensor(labels, classes)?)?.sum_all()?.affine(-1.0 / settings.batch as f64, 0.0)?;
            let mut gradients = loss.backward()?;
            clip(&variables, &mut gradients, 1.0)?;
            optimizer.step(&gradients)?;
        }
        after(epoch + 1, with_discriminant(graph.network()?, &baseline.discriminant));
    }
    Ok(())
}

/// Warm-up over one pass, then half a cosine to zero.
fn schedule(step: usize, warm: usize, total: usize) -> f64 {
    if step < warm {
        return (step + 1) as f64 / warm as f64;
    }
    let done = (step - warm) as f64 / (total - warm).max(1) as f64;
    0.5 * (1.0 + (std::f64::consts::PI * done).cos())
}

/// Weights (features × classes) and bias of the discriminant at its start temperature.
fn discriminant_tensors(discriminant: &Discriminant, features: usize) -> candle_core::Result<Vec<Tensor>> {
    let classes = discriminant.bias.len();
    let weights: Vec<f32> = (0..features)
        .flat_map(|f| discriminant.weights.iter().map(move |w| w[f] / START_TEMPERATURE))
        .collect();
    let bias: Vec<f32> = discriminant.bias.iter().map(|b| b / START_TEMPERATURE).collect();
    Ok(vec![
        Tensor::from_vec(weights, (features, classes), &Device::Cpu)?,
        Tensor::from_vec(bias, classes, &Device::Cpu)?,
    ])
}

/// The network with the discriminant in its head: one sum less to ask for.
fn with_discriminant(mut network: Network, discriminant: &Discriminant) -> Network {
    let classes = discriminant.bias.len();
    let features = network.dense.inputs();
    let before = (network.head.inputs() - features) * classes;
    for (class, (weights, bias)) in discriminant.weights.iter().zip(&discriminant.bias).enumerate() {
        network.head.bias[class] += bias / START_TEMPERATURE;
        for (feature, weight) in weights.iter().enumerate() {
            network.head.weight[before + feature * classes + class] += weight / START_TEMPERATURE;
        }
    }
    network
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

/// Draws rows: a class, a group of it, a range of the group.
struct Drawing {
    classes: Vec<Vec<Vec<usize>>>,
}

impl Drawing {
    fn new(examples: &Examples, rows: &[usize]) -> Self {
        let of = |class: usize| -> Vec<Vec<usize>> {
            let mut groups = vec![Vec::new(); examples.groups.len()];
            for row in rows.iter().filter(|row| examples.rows[**row].class == class) {
                groups[examples.rows[*row].group].push(*row);
            }
            groups.retain(|group| !group.is_empty());
            groups
        };
        let mut classes: Vec<_> = (0..examples.classes.len()).map(of).collect();
        classes.retain(|groups| !groups.is_empty());
        Self { classes }
    }

    fn draw(&self, random: &mut ChaCha8Rng) -> usize {
        let groups = &self.classes[below(self.classes.len(), random)];
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
