//! A DW1000: what its accumulator, its leading-edge detection and its diagnostics make of a channel.
//!
//! **Accumulator.** Symbol by symbol the response is added up until its largest amplitude is full or the preamble ends, which is why
//! a weak signal has a high preamble count. Gain control flattens strong signals: with the energy `E` of one symbol and that of
//! [`ReceiverSpec::compression_dbm`] `E_c`, told is `E / (1 + (E/E_c)^p)^(1/p)` (form ours; shape of figure 22 of the manual and of the
//! recorded sets). Noise of each of I and Q over `N` symbols: `σ² = N (σ₁² + κ² a²)`, with the amplitude `a` of one symbol.
//!
//! **Leading edge.** The first tap whose amplitude passes `NTM × σ_noise` belongs to the first path; its index is where that path has half
//! the height of its first maximum. The manual does not say the second; the recorded set does: the amplitude at the index is half of
//! the next maximum, whether the threshold was low or high. The bias of a missing first path follows.
//!
//! **Diagnostics** (Decawave, *DW1000 User Manual* 2.18, §4.7.1, §4.7.2), amplitudes in units of the accumulator, `A` = 121.74 for 64 MHz:
//! first path power `10 log₁₀((F₁² + F₂² + F₃²)/N²) − A`; received power `10 log₁₀(Σ|tap|²/N²) − A` (the register holds the sum over 2¹⁷).

use super::pulse;
use super::spec::ReceiverSpec;
use crate::radio::keyed::{normal, uniform};
use adit_observation::{ImpulseResponse, Reception};
use rand_chacha::ChaCha8Rng;

/// Constant `A` of the manual for a pulse repetition of 64 MHz, dB.
pub(crate) const SCALE_DB: f64 = 121.74;
/// Taps that are simulated.
pub(crate) const TAPS: usize = 232;
/// Where among them the direct path is put, before its fraction.
pub(crate) const DIRECT_TAP: usize = 64;
/// Where the search for the first path begins.
const SEARCH_TAP: usize = DIRECT_TAP - 8;
/// Taps that are kept, and the index of the first in the register, as in the recorded set.
const KEPT: usize = 200;
const KEPT_FIRST: u16 = 700;
/// Where the chip puts the first path, on average and to either side, taps after [`KEPT_FIRST`].
const PLACED: (f64, f64) = (47.5, 3.75);
/// Taps after the one that passed the threshold in which the first path has its maximum.
const RISE_TAPS: usize = 3;

/// Complex amplitudes of one symbol, before the receiver.
pub(crate) type Channel = [[f32; 2]; TAPS];

/// What a receiver found.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Detection {
    /// Where the first path has half its height, taps of the channel.
    pub edge_tap: f64,
    /// Power of the whole signal as it arrives, dBm.
    pub power_dbm: f64,
    peak_tap: usize,
    symbols: u16,
    gain: f64,
    noise: f64,
    threshold: f64,
    /// Taps from [`SEARCH_TAP`] to before this one have their noise.
    noisy_until: usize,
}

/// A receiver.
#[derive(Debug, Clone)]
pub(crate) struct Receiver {
    spec: ReceiverSpec,
    /// From the half height of a clean path to its peak, taps.
    calibration_taps: f64,
}

impl Receiver {
    pub fn new(spec: ReceiverSpec) -> Self {
        // Mean over where the path falls between taps: its highest sample is a little below its peak.
        let steps = 64_u32;
        let lag = |step: u32| {
            let peak = 8.0 + f64::from(step) / f64::from(steps);
            let amplitudes: Vec<f64> = (0..16).map(|tap| pulse::pulse(f64::from(tap) - peak)).collect();
            peak - half_height(&|tap| amplitudes[tap], 6)
        };
        let calibration_taps = (0..steps).map(lag).sum::<f64>() / f64::from(steps);
        Self { spec, calibration_taps }
    }

    /// Energy of one symbol, in units of the accumulator, of a power.
    pub fn energy(power_dbm: f64) -> f64 {
        libm::pow(10.0, 0.1 * (power_dbm + SCALE_DB))
    }

    /// Looks for the first path; `None` when nothing passes the threshold. Writes the noise of the taps it has looked at over them: what
    /// comes back is the accumulator up to the detection, and [`Self::reception`] does the rest with the same generator.
    pub fn detect(&self, channel: &mut Channel, rng: &mut ChaCha8Rng) -> Option<Detection> {
        let spec = &self.spec;
        let square = |tap: &[f32; 2]| f64::from(tap[0] * tap[0] + tap[1] * tap[1]);
        let energy: f64 = channel.iter().map(square).sum();
        let (peak_tap, peak) = channel
            .iter()
            .map(square)
            .enumerate()
            .fold((0, 0.0), |best, (tap, power)| if power > best.1 { (tap, power) } else { best });
        if energy <= 0.0 {
            return None;
        }
        let power_dbm = 10.0 * libm::log10(energy) - SCALE_DB;
        let ratio = energy / Self::energy(spec.compression_dbm);
        let order = spec.compression_order;
        let flattened = libm::pow(1.0 + libm::pow(ratio, order), -0.5 / order);
        let per_symbol = libm::sqrt(peak) * flattened;
        let full = spec.full_amplitude * (0.94 + 0.16 * uniform(rng));
        let most = f64::from(spec.most_symbols);
        let count = (full / per_symbol).clamp(0.25 * most, most);
        let gain = count * flattened;
        let noise = libm::sqrt(count) * libm::hypot(spec.noise_per_symbol, spec.self_noise * per_symbol);
        // The chip's own estimate: amplitudes of noise have a standard deviation of √(2 − π/2) σ; echoes of strong signals come on
        // top, and it scatters.
        let grown = libm::sqrt(count) * per_symbol * per_symbol / spec.noise_growth;
        let estimate = 0.655 * libm::hypot(noise, grown) * (1.0 + 0.15 * normal(rng)).max(0.3);
        let threshold = spec.noise_multiplier * estimate;
        let mut last = TAPS;
        let mut passed = None;
        for (tap, value) in channel.iter_mut().enumerate().skip(SEARCH_TAP) {
            let noisy = value.map(|v| gain * f64::from(v) + noise * normal(rng));
            #[expect(clippy::cast_possible_truncation, reason = "taps are single precision")]
            {
                *value = noisy.map(|v| v as f32);
            }
            if passed.is_none() && libm::hypot(noisy[0], noisy[1]) > threshold {
                passed = Some(tap);
                last = (tap + RISE_TAPS).min(TAPS - 1);
            }
            if tap >= last {
                break;
            }
        }
        let amplitude = |tap: usize| amplitude(channel, tap);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "16 to 4096")]
        let symbols = count as u16;
        passed.map(|tap| Detection {
            edge_tap: half_height(&amplitude, tap),
            power_dbm,
            peak_tap,
            symbols,
            gain,
            noise,
            threshold,
            noisy_until: last + 1,
        })
    }

    /// How much later than a clean path at [`DIRECT_TAP`] plus `fraction` the edge was found, taps.
    pub fn lateness_taps(&self, found: &Detection, fraction: f64) -> f64 {
        found.edge_tap + self.calibration_taps - (DIRECT_TAP as f64 + fraction)
    }

    /// The accumulator and the diagnostics of a detection that [`Self::detect`] just made with the same generator.
    pub fn reception(
        &self,
        found: &Detection,
        channel: &mut Channel,
        rng: &mut ChaCha8Rng,
        with_response: bool,
    ) -> Reception {
        let noisy = |value: &mut [f32; 2], rng: &mut ChaCha8Rng| {
            #[expect(clippy::cast_possible_truncation, reason = "taps are single precision")]
            {
                *value = value.map(|v| (found.gain * f64::from(v) + found.noise * normal(rng)) as f32);
            }
        };
        for value in channel.iter_mut().skip(found.noisy_until) {
            noisy(value, rng);
        }
        for value in channel.iter_mut().take(SEARCH_TAP) {
            noisy(value, rng);
        }
        let amplitude = |tap: usize| amplitude(channel, tap);
        let index = found.edge_tap;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "within the taps by construction"
        )]
        let first = index.floor() as usize;
        let placed = PLACED.0 + PLACED.1 * (2.0 * uniform(rng) - 1.0);
        // Later first paths stand earlier in the register: the chip centres on the strongest part.
        let placed = placed - 0.25 * (found.peak_tap as f64 - index - 1.5).clamp(0.0, 30.0);
        let last_shift = (TAPS - KEPT) as f64;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to the spare taps"
        )]
        let shift = libm::round(index - placed).clamp(0.0, last_shift) as usize;
        let amplitudes = [1, 2, 3].map(|after| amplitude(first + after));
        let symbols = f64::from(found.symbols);
        let decibel = |squares: f64| 10.0 * libm::log10(squares / (symbols * symbols)) - SCALE_DB;
        let total: f64 = (first.saturating_sub(2)..TAPS).map(|tap| amplitude(tap).powi(2)).sum();
        let quiet = (shift..first.saturating_sub(3)).map(amplitude);
        let told_peak = (shift..shift + KEPT)
            .map(|tap| (tap, amplitude(tap)))
            .fold((0, 0.0), |best, now| if now.1 > best.1 { now } else { best });
        let register = |tap: f64| tap - shift as f64 + f64::from(KEPT_FIRST);
        #[expect(clippy::cast_possible_truncation, reason = "the chip tells few digits")]
        Reception {
            rx_power_dbm: Some(decibel(total) as f32),
            first_path_power_dbm: Some(decibel(amplitudes.iter().map(|a| a * a).sum()) as f32),
            first_path_index_tap: Some(register(index) as f32),
            peak_index_tap: Some(register(told_peak.0 as f64) as f32),
            first_path_amplitudes: Some(amplitudes.map(|a| a.round() as f32)),
            noise_std: Some((found.threshold / self.spec.noise_multiplier).round() as f32),
            noise_max: Some(quiet.fold(0.0, f64::max).round() as f32),
            preamble_count: Some(found.symbols),
            impulse_response: with_response.then(|| ImpulseResponse {
                first_tap: KEPT_FIRST,
                taps: channel[shift..shift + KEPT].iter().map(|tap| tap.map(|v| v.round() as i16)).collect(),
            }),
        }
    }
}

/// Amplitude of a tap; 0 outside.
fn amplitude(channel: &Channel, tap: usize) -> f64 {
    let value = channel.get(tap).copied().unwrap_or_default();
    libm::hypot(f64::from(value[0]), f64::from(value[1]))
}

/// Where the path that begins with `tap` has half the height of its first maximum, taps.
fn half_height(amplitude: &impl Fn(usize) -> f64, tap: usize) -> f64 {
    let mut top = tap;
    while top < tap + RISE_TAPS && amplitude(top + 1) > amplitude(top) {
        top += 1;
    }
    let half = 0.5 * amplitude(top);
    let mut above = top;
    while above > tap.saturating_sub(RISE_TAPS).max(1) && amplitude(above - 1) > half {
        above -= 1;
    }
    let (before, here) = (amplitude(above - 1), amplitude(above));
    let rise = here - before;
    let share = if rise > 0.0 { ((half - before) / rise).clamp(0.0, 1.0) } else { 0.0 };
    above as f64 - 1.0 + share
}
