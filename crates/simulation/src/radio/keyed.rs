//! Random numbers that depend on what they are for, not on when they are asked: the same key gives the same draw.
//!
//! The mixing function is `SplitMix64` (Steele, Lea & Flood 2014, *Fast splittable pseudorandom number generators*); what
//! runs in time (noise, losses) comes from `ChaCha8` instead, one stream per person and purpose.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng};
use rand_distr::{Distribution, StandardNormal};

/// A number that stands for a place, a device and a purpose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Key(u64);

impl Key {
    /// The key of a purpose under a seed.
    pub fn new(seed: u64, purpose: u64) -> Self {
        Self(mixed(seed)).with(purpose)
    }

    /// The key of a part of what this one stands for.
    pub fn with(self, part: u64) -> Self {
        Self(mixed(self.0 ^ mixed(part)))
    }

    /// The same of a signed part.
    pub fn with_cell(self, part: i64) -> Self {
        self.with(part.cast_unsigned())
    }

    /// A generator for the few draws that this key stands for.
    pub fn draws(self) -> Draws {
        Draws { state: self.0 }
    }

    /// A generator for draws that go on: `ChaCha8` on its own stream.
    pub fn stream(self) -> ChaCha8Rng {
        ChaCha8Rng::seed_from_u64(self.0)
    }
}

/// A short row of draws of one key.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Draws {
    state: u64,
}

impl Draws {
    /// From 0 to below 1, with 53 bits.
    pub fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_add(GOLDEN);
        unit(mixed(self.state))
    }

    /// Standard normal (Box & Muller 1958).
    pub fn normal(&mut self) -> f64 {
        let (u, v) = (1.0 - self.uniform(), self.uniform());
        libm::sqrt(-2.0 * libm::log(u)) * libm::cos(core::f64::consts::TAU * v)
    }

    /// Exponential with mean 1.
    pub fn exponential(&mut self) -> f64 {
        -libm::log(1.0 - self.uniform())
    }
}

const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

fn mixed(value: u64) -> u64 {
    let mut z = value.wrapping_add(GOLDEN);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// From 0 to below 1.
fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

/// From 0 to below 1, out of a running stream.
pub(crate) fn uniform(rng: &mut ChaCha8Rng) -> f64 {
    unit(rng.next_u64())
}

/// Standard normal, out of a running stream.
pub(crate) fn normal(rng: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(rng)
}

/// Exponential with mean 1, out of a running stream.
pub(crate) fn exponential(rng: &mut ChaCha8Rng) -> f64 {
    -libm::log(1.0 - uniform(rng))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_have_the_moments_of_their_distributions() {
        let count = 40_000;
        let (mut sum, mut square, mut mean_time) = (0.0, 0.0, 0.0);
        for index in 0..count {
            let mut draws = Key::new(7, 1).with(index).draws();
            let value = draws.normal();
            sum += value;
            square += value * value;
            mean_time += draws.exponential();
        }
        let n = count as f64;
        // Four standard errors: 1/√n, √(2/n), 1/√n.
        assert!((sum / n).abs() < 4.0 / n.sqrt(), "{}", sum / n);
        assert!((square / n - 1.0).abs() < 4.0 * (2.0 / n).sqrt(), "{}", square / n);
        assert!((mean_time / n - 1.0).abs() < 4.0 / n.sqrt(), "{}", mean_time / n);
    }

    #[test]
    fn a_key_gives_the_same_draw_again_and_others_give_others() {
        let key = Key::new(1, 2).with_cell(-3);
        assert_eq!(key.draws().uniform().to_bits(), Key::new(1, 2).with_cell(-3).draws().uniform().to_bits());
        assert_ne!(key, Key::new(1, 2).with_cell(3));
        assert_ne!(Key::new(1, 2).with(3).with(4), Key::new(1, 2).with(4).with(3));
    }
}
