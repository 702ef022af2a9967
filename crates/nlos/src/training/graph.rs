//! The network as a graph that candle differentiates.

use crate::network::{FIRST, Layer, Network, ResponseBranch, STEPS, STRIDE, WIDTH};
use crate::training::Sizes;
use crate::window::{CHANNELS, TAPS};
use candle_core::{DType, Device, Result, Tensor, Var};
use candle_nn::ops::sigmoid;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// A linear layer that learns.
pub struct LearningLayer {
    weight: Var,
    bias: Var,
}

/// What looks at the response.
struct LearningBranch {
    first: LearningLayer,
    second: LearningLayer,
    input: LearningLayer,
    recurrent: Var,
    /// Which tap each input of a convolution is.
    first_taps: Tensor,
    second_taps: Tensor,
    state: usize,
}

/// A network that learns; its logits are added to those of a discriminant.
pub struct Graph {
    found: Found,
    head: LearningLayer,
}

/// What the head looks at: the response, or a dense layer of the scores where there is none.
enum Found {
    Response(LearningBranch),
    Dense(LearningLayer),
}

fn normal(shape: (usize, usize), sigma: f64, random: &mut ChaCha8Rng) -> Result<Var> {
    let values: Vec<f32> = (0..shape.0 * shape.1)
        .map(|_| {
            let drawn: f64 = StandardNormal.sample(random);
            #[expect(clippy::cast_possible_truncation, reason = "a start, within ±6 σ")]
            let value = (sigma * drawn) as f32;
            value
        })
        .collect();
    Var::from_tensor(&Tensor::from_vec(values, shape, &Device::Cpu)?)
}

impl LearningLayer {
    /// Weights of variance `gain / inputs` (He et al. 2015 for a gain of 2).
    fn new(inputs: usize, outputs: usize, gain: f64, random: &mut ChaCha8Rng) -> Result<Self> {
        let weight = normal((inputs, outputs), (gain / inputs as f64).sqrt(), random)?;
        Ok(Self { weight, bias: Var::zeros(outputs, DType::F32, &Device::Cpu)? })
    }

    fn forward(&self, x: &Tensor) -> Result<Tensor> {
        x.matmul(&self.weight)?.broadcast_add(&self.bias)
    }

    fn layer(&self) -> Result<Layer> {
        Ok(Layer { weight: self.weight.flatten_all()?.to_vec1()?, bias: self.bias.to_vec1()? })
    }
}

fn taps(steps: usize) -> Result<Tensor> {
    let taps =
        (0..steps).flat_map(|step| (0..WIDTH).map(move |k| u32::try_from(step * STRIDE + k).unwrap_or(0)));
    Tensor::from_iter(taps, &Device::Cpu)
}

impl LearningBranch {
    fn new(sizes: &Sizes, random: &mut ChaCha8Rng) -> Result<Self> {
        let Sizes { first, second, state, .. } = *sizes;
        Ok(Self {
            first: LearningLayer::new(WIDTH * CHANNELS, first, 2.0, random)?,
            second: LearningLayer::new(WIDTH * first, second, 2.0, random)?,
            input: LearningLayer::new(second, 4 * state, 1.0, random)?,
            recurrent: normal((state, 4 * state), (1.0 / state as f64).sqrt(), random)?,
            first_taps: taps(FIRST)?,
            second_taps: taps(STEPS)?,
            state,
        })
    }

    /// Last states of the LSTM: batch × state.
    fn forward(&self, windows: &Tensor) -> Result<Tensor> {
        let batch = windows.dim(0)?;
        let convolve = |x: &Tensor, taps: &Tensor, steps: usize, layer: &LearningLayer| {
            let inputs = x.index_select(taps, 1)?.reshape((batch * steps, WIDTH * x.dim(2)?))?;
            layer.forward(&inputs)?.relu()
        };
        let x = windows.reshape((batch, TAPS, CHANNELS))?;
        let x = convolve(&x, &self.first_taps, FIRST, &self.first)?;
        let x = x.reshape((batch, FIRST, ()))?;
        let x = convolve(&x, &self.second_taps, STEPS, &self.second)?;
        let gates = self.input.forward(&x)?.reshape((batch, STEPS, 4 * self.state))?;
        let mut hidden = Tensor::zeros((batch, self.state), DType::F32, &Device::Cpu)?;
        let mut cell = hidden.clone();
        for step in 0..STEPS {
            let gates = (gates.narrow(1, step, 1)?.squeeze(1)? + hidden.matmul(&self.recurrent)?)?;
            let gate = |k: usize| gates.narrow(1, k * self.state, self.state);
            let (input, forget, output) = (sigmoid(&gate(0)?)?, sigmoid(&gate(1)?)?, sigmoid(&gate(3)?)?);
            cell = ((forget * cell)? + (input * gate(2)?.tanh()?)?)?;
            hidden = (output * cell.tanh()?)?;
        }
        Ok(hidden)
    }
}

impl Graph {
    /// With weights drawn; the head begins at zero, so that the logits are those of the discriminant.
    pub fn new(sizes: &Sizes, features: usize, questions: usize, random: &mut ChaCha8Rng) -> Result<Self> {
        let (found, inputs) = if sizes.response {
            (Found::Response(LearningBranch::new(sizes, random)?), sizes.state)
        } else {
            (Found::Dense(LearningLayer::new(features, sizes.dense, 2.0, random)?), sizes.dense)
        };
        let head = LearningLayer {
            weight: Var::zeros((inputs, questions), DType::F32, &Device::Cpu)?,
            bias: Var::zeros(questions, DType::F32, &Device::Cpu)?,
        };
        Ok(Self { found, head })
    }

    /// What is added to the logits of the discriminant: batch × questions. `seen` are windows where the network looks at the response, else scores; `kept`
    /// silences inputs of the head (dropout).
    pub fn forward(&self, seen: &Tensor, kept: &Tensor) -> Result<Tensor> {
        let found = match &self.found {
            Found::Response(branch) => branch.forward(seen)?,
            Found::Dense(layer) => layer.forward(seen)?.relu()?,
        };
        self.head.forward(&(found * kept)?)
    }

    /// Inputs of the head.
    pub fn head_inputs(&self) -> Result<usize> {
        self.head.weight.dim(0)
    }

    /// Everything that learns.
    pub fn variables(&self) -> Vec<Var> {
        let mut variables = Vec::new();
        let mut layers = vec![&self.head];
        match &self.found {
            Found::Response(branch) => {
                layers.extend([&branch.first, &branch.second, &branch.input]);
                variables.push(branch.recurrent.clone());
            }
            Found::Dense(layer) => layers.push(layer),
        }
        for layer in layers {
            variables.extend([layer.weight.clone(), layer.bias.clone()]);
        }
        variables
    }

    /// As it is asked, with a discriminant (features × questions, and bias) in its head: one sum less.
    pub fn network(&self, weights: &Tensor, bias: &Tensor) -> Result<Network> {
        let (response, dense) = match &self.found {
            Found::Dense(layer) => (None, Some(layer.layer()?)),
            Found::Response(branch) => {
                let response = ResponseBranch {
                    first: branch.first.layer()?,
                    second: branch.second.layer()?,
                    input: branch.input.layer()?,
                    recurrent: branch.recurrent.flatten_all()?.to_vec1()?,
                };
                (Some(response), None)
            }
        };
        let weight = Tensor::cat(&[self.head.weight.as_tensor(), weights], 0)?;
        let bias = (self.head.bias.as_tensor() + bias)?;
        let head = Layer { weight: weight.flatten_all()?.to_vec1()?, bias: bias.to_vec1()? };
        Ok(Network { response, dense, head })
    }
}
