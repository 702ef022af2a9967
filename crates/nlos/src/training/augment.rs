//! What another packet, another tag or another room would change.

use crate::window::{self, CHANNELS, TAPS, Window};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal, Uniform};

/// How much is changed.
pub struct Augment {
    /// Share of the head's inputs left out.
    pub dropout: f32,
    /// Standard deviation of what is added to the scores.
    pub jitter: f32,
}

/// Share of the features that are not told.
const NOT_TOLD: f32 = 0.05;

fn uniform(low: f32, high: f32, random: &mut ChaCha8Rng) -> f32 {
    Uniform::new(low, high).map_or(low, |u| u.sample(random))
}

impl Augment {
    /// Scores: another device's scale, and features that are missing.
    pub fn scores(&self, scores: &mut [f32], random: &mut ChaCha8Rng) {
        for score in scores {
            let drawn: f32 = StandardNormal.sample(random);
            *score += self.jitter * drawn;
            if uniform(0.0, 1.0, random) < NOT_TOLD {
                *score = 0.0;
            }
        }
    }

    /// A window: the first path found a little earlier or later, walls that swallow more or less of the late echoes, fading of each
    /// echo, noise.
    pub fn window(taps: &mut Window, random: &mut ChaCha8Rng) {
        let before = *taps;
        let (before, _) = before.as_chunks::<CHANNELS>();
        let (after, _) = taps.as_chunks_mut::<CHANNELS>();
        let shift = uniform(0.0, 3.0, random);
        let slope = uniform(-0.6, 0.6, random);
        let fading = uniform(0.0, 0.15, random);
        let noise = 10.0_f32.powf(uniform(-45.0, -30.0, random) / 20.0);
        let mut largest = 1e-6_f32;
        for (k, tap) in after.iter_mut().enumerate() {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 83")]
            let at = (k + shift as usize).checked_sub(1);
            let amplitude = at.and_then(|at| before.get(at)).map_or(0.0, |tap| tap[0]);
            let late = k.saturating_sub(window::BEFORE) as f32 / TAPS as f32;
            let [fade, real, imaginary]: [f32; 3] = std::array::from_fn(|_| StandardNormal.sample(random));
            let echo = amplitude * (slope * late).exp() * (1.0 + fading * fade).max(0.0);
            tap[0] = (echo + noise * real * 0.7).hypot(noise * imaginary * 0.7);
            largest = largest.max(tap[0]);
        }
        for tap in after {
            *tap = window::values(tap[0] / largest);
        }
    }

    /// Which inputs a step keeps, each scaled so that their mean stays.
    pub fn kept(&self, count: usize, random: &mut ChaCha8Rng) -> Vec<f32> {
        let scale = 1.0 / (1.0 - self.dropout);
        (0..count).map(|_| if uniform(0.0, 1.0, random) < self.dropout { 0.0 } else { scale }).collect()
    }
}
