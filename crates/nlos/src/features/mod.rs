//! What can be measured of a reception by hand: the inputs of the discriminant, and of the network beside the response.
//!
//! Amplitudes `a_k` of the taps around the first path at index `f` (as the receiver tells it), `p` the largest of them, `q` the root mean square of the 56 taps that
//! end 4 before the first path. Delay moments are of the power of the taps above `4 q` within 80 taps:
//!
//! `τ̄ = Σ k a_k² / Σ a_k²`,  `τ_rms² = Σ (k − τ̄)² a_k² / Σ a_k²` (Saleh & Valenzuela 1987), `κ = E(a − ā)⁴ / (E(a − ā)²)²`
//! (kurtosis, mean excess delay and delay spread as features of line of sight: Güvenç, Chong & Watanabe 2007; rise time, maximum and energy: Maranò, Gifford,
//! Wymeersch & Win 2010; received minus first-path power: Decawave APS006 part 2).
//!
//! The excess of a power is what it lacks against free space at the measured range, `P + 20 log₁₀ r`: the same for all ranges in sight.
//! Logarithms of what spreads over decades. A feature that a device does not tell is NaN.

mod response;

use adit_observation::Reception;
use response::Response;

/// Features.
pub const COUNT: usize = NAMES.len();

/// Their names, in order, as a model writes them.
pub const NAMES: [&str; 30] = [
    "range, log m",
    "received power, dBm",
    "first path power, dBm",
    "received − first path power, dB",
    "excess of received power, dB",
    "excess of first path power, dB",
    "preamble symbols, log",
    "noise told, dB",
    "first path amplitude 1 / noise told, dB",
    "first path amplitude 2 / noise told, dB",
    "first path amplitude 3 / noise told, dB",
    "first path amplitude 2 / 1, dB",
    "first path amplitude 3 / 2, dB",
    "first path to peak, log taps",
    "rise 10 % to 90 %, log taps",
    "mean excess delay, taps",
    "rms delay spread, taps",
    "kurtosis, log",
    "energy of 3 taps, share",
    "energy of 5 taps, share",
    "energy of 10 taps, share",
    "noise before the first path / peak, dB",
    "noise told / peak, dB",
    "first maximum / peak, dB",
    "tap of the first path / peak, dB",
    "tap after it / peak, dB",
    "second tap after it / peak, dB",
    "noise before the first path, dB",
    "peak, dB",
    "energy, dB",
];

/// Shortest range of which a logarithm is taken, m.
const SHORTEST_M: f64 = 0.3;
/// Powers that a receiver of this kind can tell are above, dBm; below it says that it could not.
const WEAKEST_DBM: f64 = -125.0;

/// Features of a reception and its range.
pub fn of(reception: &Reception, range_m: Option<f64>) -> [f32; COUNT] {
    let told = |value: Option<f32>| value.map_or(f64::NAN, f64::from);
    let power = |value| Some(told(value)).filter(|p| *p > WEAKEST_DBM).unwrap_or(f64::NAN);
    let (received, first) = (power(reception.rx_power_dbm), power(reception.first_path_power_dbm));
    let range = range_m.map_or(f64::NAN, |r| r.max(SHORTEST_M));
    let noise = decibel(told(reception.noise_std));
    let amplitudes =
        reception.first_path_amplitudes.map_or([f64::NAN; 3], |a| a.map(|a| decibel(f64::from(a))));
    let symbols = reception.preamble_count.map_or(f64::NAN, |count| f64::from(count.max(1)).ln());
    let mut features = [f64::NAN; COUNT];
    features[..13].copy_from_slice(&[
        range.ln(),
        received,
        first,
        received - first,
        received + 20.0 * range.log10(),
        first + 20.0 * range.log10(),
        symbols,
        noise,
        amplitudes[0] - noise,
        amplitudes[1] - noise,
        amplitudes[2] - noise,
        amplitudes[1] - amplitudes[0],
        amplitudes[2] - amplitudes[1],
    ]);
    if let Some(response) = Response::of(reception) {
        features[13..].copy_from_slice(&response.features(told(reception.noise_std)));
    }
    #[expect(
        clippy::cast_possible_truncation,
        reason = "single precision is plenty for what a receiver tells"
    )]
    features.map(|value| value as f32)
}

/// An amplitude in dB; one or less counts as one.
fn decibel(amplitude: f64) -> f64 {
    if amplitude.is_nan() { f64::NAN } else { 20.0 * amplitude.max(1.0).log10() }
}
