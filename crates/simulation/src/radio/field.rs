//! Random fields in space, in closed form: the same place has the same value on a second visit.
//!
//! * [`ShadowField`], dB: log-normal shadowing with the exponential correlation of Gudmundson (1991, eq. 1),
//!   `R(r) = σ² exp(−r/D)`, as a sum of cosines with random wave vectors (Shinozuka & Jan 1972): a field with that correlation
//!   has in three dimensions the spectrum `(1 + k²D²)^−2`, a multivariate Cauchy law, drawn as `k = z/(D|w|)` with normal `z`, `w`.
//! * [`FadingField`]: what many plane waves of one wavelength make of a point (Clarke 1968), Rician by a constant share; the
//!   correlation falls to zero within half a wavelength. Each wave has a small Doppler shift of its own, so that a receiver that
//!   stands does not keep one value for ever.
//!
//! Places: grid coordinates, m. Limits: with a finite number of waves the marginal laws are normal and Rician to within some
//! percent (the kurtosis of a sum of n cosines is `3 − 3/(2n)`).

use super::keyed::Key;
use adit_core::nalgebra::Vector3;
use core::f64::consts::TAU;

const SHADOW_WAVES: usize = 48;
const FADING_WAVES: usize = 12;

/// Shadowing of one transmitter over the mine.
#[derive(Debug, Clone)]
pub(crate) struct ShadowField {
    waves: Vec<(Vector3<f64>, f64)>,
}

/// Fading of one transmitter over centimetres.
#[derive(Debug, Clone)]
pub(crate) struct FadingField {
    waves: Vec<FadingWave>,
}

#[derive(Debug, Clone, Copy)]
struct FadingWave {
    per_m: Vector3<f64>,
    phase: f64,
    /// Of a standard normal Doppler shift.
    drift: f64,
}

impl ShadowField {
    pub fn new(key: Key, correlation_m: f64) -> Self {
        let mut draws = key.draws();
        let wave = |_| {
            let direction = Vector3::new(draws.normal(), draws.normal(), draws.normal());
            // A wave far shorter than a hand would be noise, not a place's shadow.
            let spread = draws.normal().abs().max(1e-3);
            (direction / (correlation_m * spread), TAU * draws.uniform())
        };
        Self { waves: (0..SHADOW_WAVES).map(wave).collect() }
    }

    /// Standard normal at a place.
    pub fn at(&self, place_m: &Vector3<f64>) -> f64 {
        let sum: f64 = self.waves.iter().map(|(k, phase)| libm::cos(k.dot(place_m) + phase)).sum();
        sum * libm::sqrt(2.0 / SHADOW_WAVES as f64)
    }
}

impl FadingField {
    pub fn new(key: Key, wavelength_m: f64) -> Self {
        let mut draws = key.draws();
        let wave = |_| {
            let direction = Vector3::new(draws.normal(), draws.normal(), draws.normal());
            let length = direction.norm().max(1e-9);
            FadingWave {
                per_m: direction * (TAU / (wavelength_m * length)),
                phase: TAU * draws.uniform(),
                drift: draws.normal(),
            }
        };
        Self { waves: (0..FADING_WAVES).map(wave).collect() }
    }

    /// Power against its mean at a place and time, dB: Rician with the ratio `k` of constant to scattered power (linear), the
    /// scattered waves drifting with Doppler shifts of `drift_hz` (σ).
    pub fn gain_db(&self, place_m: &Vector3<f64>, time_s: f64, k: f64, drift_hz: f64) -> f64 {
        let (mut re, mut im) = (0.0, 0.0);
        for wave in &self.waves {
            let angle = wave.per_m.dot(place_m) + wave.phase + TAU * drift_hz * wave.drift * time_s;
            let (sin, cos) = libm::sincos(angle);
            re += cos;
            im += sin;
        }
        let scattered = libm::sqrt(1.0 / ((k + 1.0) * FADING_WAVES as f64));
        let constant = libm::sqrt(k / (k + 1.0));
        let (re, im) = (constant + scattered * re, scattered * im);
        // A null is never deeper than what a receiver of finite bandwidth sees: −40 dB.
        10.0 * libm::log10((re * re + im * im).max(1e-4))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pairs of values of many independent fields at two places `apart_m` from each other.
    fn correlation(correlation_m: f64, apart: Vector3<f64>) -> (f64, f64) {
        let (mut product, mut square) = (0.0, 0.0);
        let count = 20_000;
        for index in 0..count {
            let field = ShadowField::new(Key::new(5, index), correlation_m);
            let here = Vector3::new(31.0, -7.0, 1.0);
            let (a, b) = (field.at(&here), field.at(&(here + apart)));
            product += a * b;
            square += a * a;
        }
        (product / count as f64, square / count as f64)
    }

    #[test]
    fn shadowing_is_correlated_as_gudmundson_says() {
        for (apart, expected) in [
            (Vector3::new(2.0, 0.0, 0.0), (-0.5_f64).exp()),
            (Vector3::new(0.0, 4.0, 0.0), (-1.0_f64).exp()),
            (Vector3::new(0.0, 8.0, 6.0), (-2.5_f64).exp()),
        ] {
            let (product, square) = correlation(4.0, apart);
            // Standard error of a product of two standard normals: at most √2/√20000 = 0.01.
            assert!((square - 1.0).abs() < 0.04, "{square}");
            assert!((product - expected).abs() < 0.04, "{product}, expected {expected}");
        }
    }

    #[test]
    fn fading_is_rayleigh_without_a_constant_share_and_vanishes_with_a_large_one() {
        let (mut power, mut deep) = (0.0, 0);
        let count = 20_000;
        for index in 0..count {
            let field = FadingField::new(Key::new(3, index), 0.125);
            let gain = field.gain_db(&Vector3::new(1.0, 2.0, 3.0), 4.0, 0.0, 0.5);
            power += 10.0_f64.powf(gain / 10.0);
            deep += usize::from(gain < -10.0);
            assert!(field.gain_db(&Vector3::new(1.0, 2.0, 3.0), 4.0, 1e6, 0.5).abs() < 0.1);
        }
        let n = count as f64;
        assert!((power / n - 1.0).abs() < 4.0 / n.sqrt(), "{}", power / n);
        // P(power < 0.1) of an exponential law: 1 − e^−0.1 = 0.095; twelve waves come within 0.01 of it.
        assert!((deep as f64 / n - 0.0952).abs() < 0.01, "{}", deep as f64 / n);
    }

    #[test]
    fn fading_forgets_within_half_a_wavelength_and_drifts_in_time() {
        let (mut near, mut far, mut later) = (0.0, 0.0, 0.0);
        for index in 0..4_000 {
            let field = FadingField::new(Key::new(3, index), 0.125);
            let power = |x: f64, t: f64| {
                10.0_f64.powf(field.gain_db(&Vector3::new(x, 0.0, 0.0), t, 0.0, 0.2) / 10.0) - 1.0
            };
            let here = power(0.0, 0.0);
            near += here * power(0.005, 0.0) / 4_000.0;
            far += here * power(0.0625, 0.0) / 4_000.0;
            later += here * power(0.0, 20.0) / 4_000.0;
        }
        // Power of Rayleigh fading has variance 1; isotropic waves give sinc²(2r/λ) for its correlation: 0.98, 0, 0.
        assert!(near > 0.8, "{near}");
        assert!(far.abs() < 0.1, "{far}");
        assert!(later.abs() < 0.1, "{later}");
    }
}
