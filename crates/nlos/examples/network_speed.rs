//! `network_speed MODEL OUT`: responses a second of a model's network on one core, alone and in batches of 64, and what a rival needs to run the same: inputs and our
//! logits as little-endian single precision in OUT (`ci/rival/onnx_network.py`).

use adit_nlos::Model;
use adit_nlos::network::Scratch;
use adit_nlos::window::{CHANNELS, TAPS, Window};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Uniform};
use std::error::Error;
use std::hint::black_box;
use std::path::Path;
use std::time::{Duration, Instant};

const BATCH: usize = 64;
/// Each way is measured so often, for so long; the fastest counts.
const ROUNDS: usize = 5;
const ROUND: Duration = Duration::from_millis(400);

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [model, out] = arguments.as_slice() else { return Err("usage: network_speed MODEL OUT".into()) };
    let model = Model::from_bytes(model, &std::fs::read(model)?)?;
    let network = model.network.ok_or("this model has no network")?;
    let (features, questions) = (model.baseline.used.len(), network.head.outputs());
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let uniform = Uniform::new(0.0_f32, 1.0)?;
    let mut drawn = |count: usize| -> Vec<f32> { (0..count).map(|_| uniform.sample(&mut random)).collect() };
    let scores = drawn(BATCH * features);
    let values = drawn(BATCH * TAPS * CHANNELS);
    let (windows, _) = values.as_chunks::<{ TAPS * CHANNELS }>();
    let asked: Vec<(&[f32], Option<&Window>)> =
        scores.chunks(features).zip(windows).map(|(scores, window)| (scores, Some(window))).collect();
    let (mut scratch, mut told) = (Scratch::default(), vec![0.0; BATCH * questions]);
    let mut rate = |at_once: usize| {
        let round = || {
            let (start, mut count) = (Instant::now(), 0_u32);
            while start.elapsed() < ROUND {
                for asked in asked.chunks(at_once) {
                    network.logits_of(black_box(asked), &mut scratch, &mut told);
                    black_box(&told);
                }
                count += 1;
            }
            f64::from(count) * BATCH as f64 / start.elapsed().as_secs_f64()
        };
        std::iter::repeat_with(round).take(ROUNDS).fold(0.0, f64::max)
    };
    let (alone, together) = (rate(1), rate(BATCH));
    println!("{alone:.0} {together:.0} {}", network.weights());
    network.logits_of(&asked, &mut scratch, &mut told);
    let out = Path::new(out);
    std::fs::create_dir_all(out)?;
    for (name, values) in [("scores", &scores), ("windows", &values), ("logits", &told)] {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        std::fs::write(out.join(name), bytes)?;
    }
    Ok(())
}
