//! What a vehicle does to a seat while it moves: seeded sinusoids between 1 and 15 Hz, and bumps of the floor.
//!
//! Vertical acceleration is a sum of [`TONES`] sinusoids, one in each of as many bands of equal ratio from 1 to 15 Hz, frequencies and
//! phases drawn; their accelerations have equal mean squares, summing to the `rms` asked for. Across and along it is 0.6 of that,
//! each with tones of its own. The seat rolls and pitches with two slow tones each. A bump is a quartic pulse over 1.2 m of
//! floor, one in every 12 m, at a drawn place and of a drawn height.
//!
//! Sources: whole-body vibration of load-haul-dump vehicles of 0.5 to 1.7 m/s² rms in the vertical, most of it between 1 and 10 Hz (after
//! Eger, Salmoni, Cann & Jack, *Occup. Ergonomics* 6, 2006, from memory); split over bands, axes and bumps are chosen.

use crate::blend::Window;
use crate::jet::{Jet, JetVector};
use core::f64::consts::TAU;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Uniform};

/// Sinusoids on each axis.
const TONES: usize = 6;
/// Lowest frequency, and the ratio of the highest to it.
const LOWEST_HZ: f64 = 1.0;
const SPAN: f64 = 15.0;
/// One bump in each stretch of this length, this long, m.
const STRETCH_M: f64 = 12.0;
const BUMP_M: f64 = 1.2;
/// Across and along against the vertical.
const LEVEL_SHARE: f64 = 0.6;
/// Roll and pitch of the seat, rad, in tones from 0.8 to 2.5 Hz.
const ROCKING_RAD: f64 = 0.008;

/// A sinusoid: `amplitude sin(omega t + phase)`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Tone {
    pub amplitude: f64,
    pub omega: f64,
    pub phase: f64,
}

impl Tone {
    pub fn at(&self, time_s: f64) -> Jet {
        let (sin, cos) = libm::sincos(self.omega * time_s + self.phase);
        let value = self.amplitude * sin;
        Jet { value, first: self.amplitude * self.omega * cos, second: -self.omega * self.omega * value }
    }
}

/// The sum of some tones.
pub(super) fn sum(tones: &[Tone], time_s: f64) -> Jet {
    tones.iter().fold(Jet::default(), |sum, tone| sum + tone.at(time_s))
}

/// A number drawn evenly between two.
pub(super) fn between(rng: &mut ChaCha8Rng, low: f64, high: f64) -> f64 {
    Uniform::new_inclusive(low, high).map_or(low, |uniform| uniform.sample(rng))
}

/// Vibration of one vehicle.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Vibration {
    axes: [[Tone; TONES]; 3],
    rocking: [[Tone; 2]; 2],
    /// Place in its stretch (share) and height (m) of each bump, again and again.
    bumps: [(f64, f64); 32],
}

impl Vibration {
    pub fn new(rng: &mut ChaCha8Rng, rms_m_s2: f64, bump_m: f64) -> Self {
        let band = libm::pow(SPAN, 1.0 / TONES as f64);
        let axes = [LEVEL_SHARE, LEVEL_SHARE, 1.0].map(|share| {
            let mut low = LOWEST_HZ;
            core::array::from_fn(|_| {
                let omega = TAU * between(rng, low, low * band);
                low *= band;
                let acceleration = rms_m_s2 * share * libm::sqrt(2.0 / TONES as f64);
                Tone { amplitude: acceleration / (omega * omega), omega, phase: between(rng, 0.0, TAU) }
            })
        });
        let rocking = [0, 1].map(|_| {
            [0.8, 1.5].map(|low| Tone {
                amplitude: if rms_m_s2 > 0.0 { ROCKING_RAD * core::f64::consts::FRAC_1_SQRT_2 } else { 0.0 },
                omega: TAU * between(rng, low, low + 1.0),
                phase: between(rng, 0.0, TAU),
            })
        });
        let bumps = core::array::from_fn(|_| (between(rng, 0.0, 0.9), between(rng, 0.0, bump_m)));
        Self { axes, rocking, bumps }
    }

    /// Displacement (forward, left, up) where the vehicle is `sigma` along its way, `vigour` from 0 at rest to 1 at speed.
    pub fn shift(&self, time_s: f64, sigma: Jet, vigour: Jet) -> JetVector {
        let mut shift = JetVector(core::array::from_fn(|axis| sum(&self.axes[axis], time_s) * vigour));
        let stretch = libm::floor(sigma.value / STRETCH_M);
        let number = libm::fmod(stretch.abs(), self.bumps.len() as f64);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 31")]
        let (place, height_m) = self.bumps[number as usize];
        let into = (sigma - Jet::constant((stretch + place) * STRETCH_M)) * (1.0 / BUMP_M);
        shift.0[2] = shift.0[2] + Window::new(0.0, 1.0).pulse(into) * vigour * height_m;
        shift
    }

    /// Pitch and roll, rad.
    pub fn rocking(&self, time_s: f64, vigour: Jet) -> [Jet; 2] {
        [0, 1].map(|axis| sum(&self.rocking[axis], time_s) * vigour)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::rand_core::SeedableRng;

    #[test]
    fn acceleration_has_the_rms_asked_for() {
        let vibration = Vibration::new(&mut ChaCha8Rng::seed_from_u64(3), 0.8, 0.0);
        let count = 200_000_u32;
        let squares: f64 = (0..count)
            .map(|i| {
                let shift = vibration.shift(f64::from(i) * 0.01, Jet::constant(0.0), Jet::constant(1.0));
                shift.0[2].second * shift.0[2].second
            })
            .sum();
        let rms = libm::sqrt(squares / f64::from(count));
        // Six tones over 2000 s: beats of neighbours leave below a percent.
        assert!((rms - 0.8).abs() < 0.01, "{rms}");
    }

    #[test]
    fn a_vehicle_at_rest_does_not_shake() {
        let vibration = Vibration::new(&mut ChaCha8Rng::seed_from_u64(3), 0.8, 0.0);
        let still = Jet::constant(0.0);
        assert_eq!(vibration.shift(7.3, Jet::constant(5.0), still), JetVector::default());
        assert_eq!(vibration.rocking(7.3, still), [still; 2]);
    }
}
