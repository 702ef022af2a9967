//! Overlapping Allan deviation with its confidence.
//!
//! `σ²(mτ₀) = 1/(2 m²τ₀² (N−2m)) Σ (x_{k+2m} − 2 x_{k+m} + x_k)²` over the N sums x of the readings (Riley, *Handbook of
//! frequency stability analysis*, NIST SP 1065, eq. 11; IEEE Std 952-1997, annex C). Degrees of freedom by type of noise: Riley,
//! table 5.

use serde::Serialize;

/// Averaging times in an octave.
pub const PER_OCTAVE: f64 = 4.0;
/// The longest averaging time is this part of the record: beyond, hardly an independent difference is left.
const LONGEST_PART: usize = 5;
/// Degrees of freedom of the last point, of whatever kind its noise is, at least.
pub const FEWEST_DEGREES: f64 = 3.0;

/// One point of the curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AllanPoint {
    /// Averaging time τ, s.
    pub tau_s: f64,
    /// Allan deviation, unit of the readings.
    pub deviation: f64,
    /// σ of the deviation by its degrees of freedom; 0 before a model tells the kind of noise.
    pub sd: f64,
    /// Readings averaged: τ in samples.
    #[serde(skip)]
    pub samples: usize,
}

/// The kinds of noise that an inertial sensor at rest shows, by the slope of their deviation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoiseKind {
    /// −1
    Quantisation,
    /// −1/2
    White,
    /// 0
    Flicker,
    /// +1/2
    RandomWalk,
}

/// Overlapping Allan deviation of evenly spaced readings, for averaging times spread evenly in their logarithm.
pub fn overlapping(readings: &[f64], interval_s: f64) -> Vec<AllanPoint> {
    // Without their mean, the sums stay small and exact.
    let mean = readings.iter().sum::<f64>() / readings.len().max(1) as f64;
    let mut sum = 0.0;
    let sums: Vec<f64> = std::iter::once(0.0)
        .chain(readings.iter().map(|r| {
            sum += r - mean;
            sum
        }))
        .collect();
    averaging_times(readings.len())
        .map(|samples| {
            let differences = sums.len() - 2 * samples;
            let square: f64 = (0..differences)
                .map(|k| sums[k + 2 * samples] - 2.0 * sums[k + samples] + sums[k])
                .map(|d| d * d)
                .sum();
            let m = samples as f64;
            let deviation = (square / (2.0 * m * m * differences as f64)).sqrt();
            AllanPoint { tau_s: m * interval_s, deviation, sd: 0.0, samples }
        })
        .collect()
}

/// Averaging times, in samples.
fn averaging_times(readings: usize) -> impl Iterator<Item = usize> {
    let longest = readings / LONGEST_PART;
    let mut last = 0;
    (0..)
        .map(|i| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "saturates, and ends the list"
            )]
            let samples = (f64::from(i) / PER_OCTAVE).exp2().round() as usize;
            samples
        })
        .take_while(move |samples| *samples <= longest)
        .filter(move |samples| std::mem::replace(&mut last, *samples) != *samples)
}

/// Equivalent degrees of freedom of the variance at an averaging time of m of n readings (Riley 2008, table 5).
pub fn degrees_of_freedom(kind: NoiseKind, readings: usize, samples: usize) -> f64 {
    // The table counts phases, one more than readings.
    let (n, m) = ((readings + 1) as f64, samples as f64);
    let degrees = match kind {
        NoiseKind::Quantisation => (n + 1.0) * (n - 2.0 * m) / (2.0 * (n - m)),
        NoiseKind::White => {
            (3.0 * (n - 1.0) / (2.0 * m) - 2.0 * (n - 2.0) / n) * 4.0 * m * m / (4.0 * m * m + 5.0)
        }
        NoiseKind::Flicker if samples == 1 => 2.0 * (n - 2.0).powi(2) / (2.3 * n - 4.9),
        NoiseKind::Flicker => 5.0 * n * n / (4.0 * m * (n + 3.0 * m)),
        NoiseKind::RandomWalk => {
            (n - 2.0) / m * ((n - 1.0).powi(2) - 3.0 * m * (n - 1.0) + 4.0 * m * m) / (n - 3.0).powi(2)
        }
    };
    degrees.max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_has_the_deviation_of_the_book() {
        // Rate ramp R: σ = R τ/√2 (IEEE Std 952-1997, eq. C.22), exactly at every averaging time.
        let readings: Vec<f64> = (0..5000).map(|i| 0.002 * f64::from(i) * 0.01).collect();
        for point in overlapping(&readings, 0.01) {
            let expected = 0.002 * point.tau_s / 2_f64.sqrt();
            // The sums lose ten of sixteen digits.
            assert!((point.deviation / expected - 1.0).abs() < 1e-6, "{point:?} {expected}");
        }
    }

    #[test]
    fn averaging_times_rise_to_a_fifth_of_the_record() {
        let times: Vec<usize> = averaging_times(1000).collect();
        assert!(times.windows(2).all(|w| w[0] < w[1]), "{times:?}");
        assert_eq!((times.first(), times.last()), (Some(&1), Some(&181)));
    }
}
