//! The network: convolutions over the response, an LSTM over what they find, and a head that also sees the features made by hand.
//!
//! ```text
//! window 80 × 2 ─ conv 5, stride 2 ─ ReLU ─ conv 5, stride 2 ─ ReLU ─ 17 steps ─ LSTM ─ last state ─┬─ linear ─ logits
//! scores of the features made by hand ──────────────────────────────────────────────────────────────┘
//! ```
//!
//! System S4 (Jia et al. 2024) gives a CNN that feeds an LSTM and no sizes; they are chosen by experiment (`docs/methods/nlos.md`). LSTM (Hochreiter & Schmidhuber 1997, with the forget gate of Gers,
//! Schmidhuber & Cummins 2000): `i, f, o = σ(W x + U h + b)`, `g = tanh(W x + U h + b)`, `c ← f c + i g`, `h ← o tanh c`; gates in the order i, f, g, o.
//!
//! Inference is plain Rust without allocation: all products are [`kernel::affine`], whose loops the compiler turns into vector instructions, fused ones where
//! the processor has AVX2; its bits are those of a processor, within 1e-6 of one another. A model for tables of diagnostics has a dense layer of the scores in place of the response.

pub mod kernel;
mod scratch;

pub use scratch::Scratch;

use crate::window::{self, CHANNELS, TAPS, Window};
#[cfg(target_arch = "x86_64")]
use kernel::Fused;
use kernel::{Apart, Sum, affine};
use std::marker::PhantomData;

/// Taps that a convolution looks at.
pub const WIDTH: usize = 5;
/// Taps from one of its outputs to the next.
pub const STRIDE: usize = 2;
/// Responses that are worked on together.
pub const TOGETHER: usize = 8;

/// Outputs of a convolution over so many inputs.
pub const fn outputs(inputs: usize) -> usize {
    (inputs - WIDTH) / STRIDE + 1
}

/// Steps of the first convolution's output.
pub const FIRST: usize = outputs(TAPS);
/// Steps of the second's, which the LSTM walks along.
pub const STEPS: usize = outputs(FIRST);

/// A linear layer: `out = x W + b`.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// Inputs × outputs, row by row.
    pub weight: Vec<f32>,
    /// Outputs.
    pub bias: Vec<f32>,
}

impl Layer {
    /// Number of inputs.
    pub fn inputs(&self) -> usize {
        self.weight.len() / self.bias.len().max(1)
    }

    /// Number of outputs.
    pub const fn outputs(&self) -> usize {
        self.bias.len()
    }
}

/// What looks at the response.
#[derive(Debug, Clone, PartialEq)]
pub struct ResponseBranch {
    /// [`WIDTH`] × [`CHANNELS`] inputs.
    pub first: Layer,
    /// [`WIDTH`] × outputs of the first.
    pub second: Layer,
    /// From the second convolution to the four gates, with their bias.
    pub input: Layer,
    /// From the state to the four gates: state × 4 states.
    pub recurrent: Vec<f32>,
}

impl ResponseBranch {
    /// Numbers in the state of the LSTM.
    pub const fn state(&self) -> usize {
        self.input.outputs() / 4
    }
}

/// A network.
#[derive(Debug, Clone, PartialEq)]
pub struct Network {
    /// What looks at the response, unless it looks at the features alone.
    pub response: Option<ResponseBranch>,
    /// Of the scores, where there is no response.
    pub dense: Option<Layer>,
    /// Of the state, the dense layer and the scores, in this order.
    pub head: Layer,
}

impl Network {
    /// Whether it needs a response.
    pub const fn looks_at_window(&self) -> bool {
        self.response.is_some()
    }

    /// Number of weights.
    pub fn weights(&self) -> usize {
        let layer = |layer: &Layer| layer.weight.len() + layer.bias.len();
        let of =
            |r: &ResponseBranch| layer(&r.first) + layer(&r.second) + layer(&r.input) + r.recurrent.len();
        self.response.as_ref().map_or(0, of) + self.dense.as_ref().map_or(0, layer) + layer(&self.head)
    }

    /// Logits of one reception: scores of its features and its window.
    pub fn logits(&self, scores: &[f32], window: Option<&Window>, scratch: &mut Scratch, into: &mut [f32]) {
        self.logits_of(&[(scores, window)], scratch, into);
    }

    /// Logits of many, row by row.
    pub fn logits_of(&self, asked: &[(&[f32], Option<&Window>)], scratch: &mut Scratch, into: &mut [f32]) {
        #[cfg(target_arch = "x86_64")]
        if let Some(unit) = pulp::x86::V3::try_new() {
            return unit.vectorize(Walk { network: self, asked, scratch, into, sum: PhantomData::<Fused> });
        }
        pulp::Arch::new().dispatch(Walk { network: self, asked, scratch, into, sum: PhantomData::<Apart> });
    }

    #[expect(clippy::inline_always, reason = "compiled for the vector unit that was dispatched to")]
    #[inline(always)]
    fn walk<S: Sum>(&self, asked: &[(&[f32], Option<&Window>)], scratch: &mut Scratch, into: &mut [f32]) {
        let questions = self.head.outputs();
        for (asked, into) in asked.chunks(TOGETHER).zip(into.chunks_mut(TOGETHER * questions)) {
            scratch.fit(self);
            if let Some(response) = &self.response {
                response.run::<S>(asked, scratch);
            }
            self.finish::<S>(asked, scratch, into);
        }
    }

    /// The dense layer and the head, of the states in `scratch`.
    #[expect(clippy::inline_always, reason = "compiled for the vector unit that was dispatched to")]
    #[inline(always)]
    fn finish<S: Sum>(&self, asked: &[(&[f32], Option<&Window>)], scratch: &mut Scratch, into: &mut [f32]) {
        let state = self.response.as_ref().map_or(0, ResponseBranch::state);
        let before = state + self.dense.as_ref().map_or(0, Layer::outputs);
        let Scratch { hidden, found, .. } = scratch;
        for (k, ((scores, _), into)) in asked.iter().zip(into.chunks_mut(self.head.outputs())).enumerate() {
            found[..state].copy_from_slice(&hidden[k * state..(k + 1) * state]);
            if let Some(dense) = &self.dense {
                affine::<S>(dense, scores, 1, 0, &mut found[state..before], 0);
                kernel::relu(&mut found[state..before]);
            }
            found[before..].copy_from_slice(scores);
            affine::<S>(&self.head, found, 1, 0, into, 0);
        }
    }
}

/// A call, for whichever vector unit there is. No closure: its body would not be inlined there.
struct Walk<'a, S> {
    network: &'a Network,
    asked: &'a [(&'a [f32], Option<&'a Window>)],
    scratch: &'a mut Scratch,
    into: &'a mut [f32],
    sum: PhantomData<S>,
}

impl<S: Sum> pulp::NullaryFnOnce for Walk<'_, S> {
    type Output = ();

    #[expect(clippy::inline_always, reason = "compiled for the vector unit that was dispatched to")]
    #[inline(always)]
    fn call(self) {
        self.network.walk::<S>(self.asked, self.scratch, self.into);
    }
}

impl ResponseBranch {
    /// Walks the responses, up to [`TOGETHER`], and leaves their last states in `scratch.hidden`.
    #[expect(clippy::inline_always, reason = "compiled for the vector unit that was dispatched to")]
    #[inline(always)]
    fn run<S: Sum>(&self, asked: &[(&[f32], Option<&Window>)], scratch: &mut Scratch) {
        let (count, state) = (asked.len(), self.state());
        let Scratch { first, second, gates, hidden, cell, .. } = scratch;
        for (k, (_, window)) in asked.iter().enumerate() {
            let window = window.unwrap_or(&window::SILENT);
            affine::<S>(&self.first, window, FIRST, STRIDE * CHANNELS, first, self.first.outputs());
            kernel::relu(first);
            affine::<S>(
                &self.second,
                first,
                STEPS,
                STRIDE * self.first.outputs(),
                second,
                self.second.outputs(),
            );
            kernel::relu(second);
            // Step by step, the responses side by side.
            affine::<S>(
                &self.input,
                second,
                STEPS,
                self.second.outputs(),
                &mut gates[4 * k * state..],
                4 * state * count,
            );
        }
        hidden.fill(0.0);
        cell.fill(0.0);
        for gates in gates.chunks_mut(4 * state * count).take(STEPS) {
            kernel::add_product::<S>(&self.recurrent, hidden, count, state, gates);
            for ((gates, cell), hidden) in
                gates.chunks_mut(4 * state).zip(cell.chunks_mut(state)).zip(hidden.chunks_mut(state))
            {
                kernel::lstm::<S>(gates, cell, hidden);
            }
        }
    }
}
