//! Our inference against candle's own layers with the same weights.
#![cfg(feature = "train")]
#![expect(clippy::unwrap_used, clippy::float_cmp, reason = "tests; a batch gives the same bits")]

use adit_nlos::network::{FIRST, Layer, Network, ResponseBranch, STEPS, Scratch, WIDTH};
use adit_nlos::window::{CHANNELS, TAPS, Window};
use candle_core::{Device, Tensor};
use candle_nn::rnn::{LSTM, LSTMConfig, RNN};
use candle_nn::{Conv1d, Conv1dConfig, Linear, Module, VarBuilder};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Uniform};
use std::collections::HashMap;

const FIRST_CHANNELS: usize = 16;
const SECOND_CHANNELS: usize = 24;
const STATE: usize = 32;
const FEATURES: usize = 22;
const QUESTIONS: usize = 3;

fn drawn(count: usize, random: &mut ChaCha8Rng) -> Vec<f32> {
    let uniform = Uniform::new(-0.5, 0.5).unwrap();
    (0..count).map(|_| uniform.sample(random)).collect()
}

fn layer(inputs: usize, outputs: usize, random: &mut ChaCha8Rng) -> Layer {
    Layer { weight: drawn(inputs * outputs, random), bias: drawn(outputs, random) }
}

fn network(random: &mut ChaCha8Rng) -> Network {
    let response = ResponseBranch {
        first: layer(WIDTH * CHANNELS, FIRST_CHANNELS, random),
        second: layer(WIDTH * FIRST_CHANNELS, SECOND_CHANNELS, random),
        input: layer(SECOND_CHANNELS, 4 * STATE, random),
        recurrent: drawn(STATE * 4 * STATE, random),
    };
    Network { response: Some(response), dense: None, head: layer(STATE + FEATURES, QUESTIONS, random) }
}

/// Our inputs × outputs as candle's outputs × inputs.
fn matrix(weight: &[f32], inputs: usize, outputs: usize) -> Tensor {
    Tensor::from_slice(weight, (inputs, outputs), &Device::Cpu).unwrap().t().unwrap().contiguous().unwrap()
}

/// Our (taps · channels) × outputs as candle's outputs × channels × taps.
fn convolution(layer: &Layer, channels: usize) -> Conv1d {
    let weight = Tensor::from_slice(&layer.weight, (WIDTH, channels, layer.outputs()), &Device::Cpu).unwrap();
    let weight = weight.permute((2, 1, 0)).unwrap().contiguous().unwrap();
    let bias = Tensor::from_slice(&layer.bias, layer.outputs(), &Device::Cpu).unwrap();
    Conv1d::new(weight, Some(bias), Conv1dConfig { stride: 2, ..Conv1dConfig::default() })
}

/// Candle's Conv1d, LSTM and Linear.
fn candle(network: &Network, scores: &[f32], windows: &[Window]) -> Vec<f32> {
    let branch = network.response.as_ref().unwrap();
    let values: Vec<f32> = windows.iter().flatten().copied().collect();
    let x = Tensor::from_vec(values, (windows.len(), TAPS, CHANNELS), &Device::Cpu).unwrap();
    let x = x.transpose(1, 2).unwrap().contiguous().unwrap();
    let x = convolution(&branch.first, CHANNELS).forward(&x).unwrap().relu().unwrap();
    assert_eq!(x.dims(), [windows.len(), FIRST_CHANNELS, FIRST]);
    let x = convolution(&branch.second, FIRST_CHANNELS).forward(&x).unwrap().relu().unwrap();
    assert_eq!(x.dims(), [windows.len(), SECOND_CHANNELS, STEPS]);
    let bias = Tensor::from_slice(&branch.input.bias, 4 * STATE, &Device::Cpu).unwrap();
    let tensors = HashMap::from([
        ("weight_ih_l0".to_owned(), matrix(&branch.input.weight, SECOND_CHANNELS, 4 * STATE)),
        ("weight_hh_l0".to_owned(), matrix(&branch.recurrent, STATE, 4 * STATE)),
        ("bias_hh_l0".to_owned(), bias.zeros_like().unwrap()),
        ("bias_ih_l0".to_owned(), bias),
    ]);
    let builder = VarBuilder::from_tensors(tensors, candle_core::DType::F32, &Device::Cpu);
    let lstm = LSTM::new(SECOND_CHANNELS, STATE, LSTMConfig::default(), builder).unwrap();
    let x = x.transpose(1, 2).unwrap().contiguous().unwrap();
    let states = lstm.seq(&x).unwrap();
    let scores = Tensor::from_slice(scores, (windows.len(), FEATURES), &Device::Cpu).unwrap();
    let found = Tensor::cat(&[states.last().unwrap().h(), &scores], 1).unwrap();
    let bias = Tensor::from_slice(&network.head.bias, QUESTIONS, &Device::Cpu).unwrap();
    let head = Linear::new(matrix(&network.head.weight, STATE + FEATURES, QUESTIONS), Some(bias));
    head.forward(&found).unwrap().flatten_all().unwrap().to_vec1().unwrap()
}

#[test]
fn inference_equals_candle_to_1e_5_alone_and_in_batches() {
    let mut random = ChaCha8Rng::seed_from_u64(6);
    for count in [1, 3, 64] {
        let network = network(&mut random);
        let windows: Vec<Window> =
            (0..count).map(|_| drawn(TAPS * CHANNELS, &mut random).try_into().unwrap()).collect();
        let scores = drawn(count * FEATURES, &mut random);
        let expected = candle(&network, &scores, &windows);
        let asked: Vec<_> =
            scores.chunks(FEATURES).zip(&windows).map(|(scores, window)| (scores, Some(window))).collect();
        let (mut scratch, mut told) = (Scratch::default(), vec![0.0; count * QUESTIONS]);
        network.logits_of(&asked, &mut scratch, &mut told);
        for (found, expected) in told.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-5, "{found} {expected}");
        }
        let mut alone = [0.0; QUESTIONS];
        network.logits(asked[0].0, asked[0].1, &mut scratch, &mut alone);
        assert_eq!(alone, told[..QUESTIONS], "a batch changes nothing");
    }
}
