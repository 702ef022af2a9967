//! The parts of an Allan deviation: quantisation, white noise, bias instability, random walk.
//!
//! `σ²(τ) = 3Q²/τ² + N²/τ + (2 ln 2/π) B² + K²τ/3` (IEEE Std 952-1997, annex C.1). The squares are found by weighted least
//! squares on the variance, none below zero; weights are those of the χ² scatter of each point, `edf/(2σ⁴)`, with σ from the fit.
//! Points two octaves apart are nearly independent, those between are not: covariances are enlarged accordingly.

use super::allan::{AllanPoint, NoiseKind, PER_OCTAVE, degrees_of_freedom};
use adit_core::nalgebra::{Cholesky, Matrix4, Vector4};
use serde::Serialize;
use std::f64::consts::{LN_2, PI};

/// `2 ln 2/π`: variance of the flat part over B².
pub const FLICKER: f64 = 2.0 * LN_2 / PI;
const KINDS: [NoiseKind; 4] =
    [NoiseKind::Quantisation, NoiseKind::White, NoiseKind::Flicker, NoiseKind::RandomWalk];
/// Times the weights are taken anew; they settle in a few.
const REWEIGHTINGS: usize = 12;

/// Noise of one axis; U is the unit of its readings.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct NoiseModel {
    /// Quantisation Q, U·s.
    pub quantisation: f64,
    /// Angle or velocity random walk N, U·√s.
    pub white: f64,
    /// Bias instability B, U.
    pub instability: f64,
    /// Rate or acceleration random walk K, U/√s.
    pub walk: f64,
}

impl NoiseModel {
    /// Variance of each part at an averaging time, in the order of [`KINDS`].
    fn parts(&self, tau_s: f64) -> [f64; 4] {
        let Self { quantisation: q, white: n, instability: b, walk: k } = *self;
        let unit = unit_parts(tau_s);
        [q * q * unit[0], n * n * unit[1], b * b * unit[2], k * k * unit[3]]
    }

    /// Allan deviation of the sum.
    pub fn deviation(&self, tau_s: f64) -> f64 {
        self.parts(tau_s).iter().sum::<f64>().sqrt()
    }

    /// σ of a measured deviation, U: `deviation/√(2 edf)`, the kind of noise being that which rules this model there.
    pub(super) fn scatter(&self, point: &AllanPoint, readings: usize) -> f64 {
        let degrees = degrees_of_freedom(self.ruling(point.tau_s), readings, point.samples);
        point.deviation / (2.0 * degrees).sqrt()
    }

    /// The part that rules at an averaging time.
    fn ruling(&self, tau_s: f64) -> NoiseKind {
        let parts = self.parts(tau_s);
        let largest = (0..KINDS.len()).fold(1, |best, i| if parts[i] > parts[best] { i } else { best });
        KINDS[largest]
    }

    fn from_squares(squares: &[f64; 4]) -> Self {
        let [q, n, b, k] = squares.map(|s| s.max(0.0).sqrt());
        Self { quantisation: q, white: n, instability: b, walk: k }
    }
}

/// Variance of each part of size 1.
fn unit_parts(tau_s: f64) -> [f64; 4] {
    [3.0 / (tau_s * tau_s), 1.0 / tau_s, FLICKER, tau_s / 3.0]
}

/// A model with the σ of its parts; a part that the record does not show is 0, and so is its σ.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct NoiseFit {
    /// The parts.
    #[serde(flatten)]
    pub model: NoiseModel,
    /// Their σ.
    pub sd: NoiseModel,
}

/// Fits the parts to a curve of `readings` readings; `None` where the curve is zero or not finite.
pub fn fit(curve: &[AllanPoint], readings: usize) -> Option<NoiseFit> {
    if curve.is_empty() || !curve.iter().all(|p| p.deviation.is_finite() && p.deviation > 0.0) {
        return None;
    }
    let mut scatter: Vec<f64> = curve
        .iter()
        .map(|p| {
            scatter_of(p.deviation * p.deviation, degrees_of_freedom(NoiseKind::White, readings, p.samples))
        })
        .collect();
    let mut best = non_negative(curve, &scatter)?;
    for _ in 0..REWEIGHTINGS {
        let model = NoiseModel::from_squares(&best.squares);
        for (sd, point) in scatter.iter_mut().zip(curve) {
            let degrees = degrees_of_freedom(model.ruling(point.tau_s), readings, point.samples);
            *sd = scatter_of(model.deviation(point.tau_s).powi(2), degrees);
        }
        best = non_negative(curve, &scatter)?;
    }
    let model = NoiseModel::from_squares(&best.squares);
    // A point has eight neighbours within two octaves that say nearly the same.
    let enlarge = (2.0 * PER_OCTAVE).sqrt();
    let of = |value: f64, i: usize| if value > 0.0 { enlarge * best.sd[i] / (2.0 * value) } else { 0.0 };
    let sd = NoiseModel {
        quantisation: of(model.quantisation, 0),
        white: of(model.white, 1),
        instability: of(model.instability, 2),
        walk: of(model.walk, 3),
    };
    Some(NoiseFit { model, sd })
}

/// Standard deviation of a variance with so many degrees of freedom.
fn scatter_of(variance: f64, degrees: f64) -> f64 {
    variance * (2.0 / degrees).sqrt()
}

struct Squares {
    squares: [f64; 4],
    /// σ of the squares that are not zero.
    sd: [f64; 4],
}

/// Weighted least squares of the four squares, none negative.
///
/// The problem is convex and has four unknowns: the answer is the best of the 15 sets of parts that come out positive by
/// themselves (Lawson & Hanson 1974, ch. 23, without their search).
fn non_negative(curve: &[AllanPoint], scatter: &[f64]) -> Option<Squares> {
    let rows = || curve.iter().zip(scatter).map(|(p, sd)| (Vector4::from(unit_parts(p.tau_s)) / *sd, p, *sd));
    // Columns of one size: the squares differ by ten powers of ten.
    let sizes = rows().map(|(row, ..)| row.component_mul(&row)).sum::<Vector4<f64>>().map(f64::sqrt);
    let (mut normal, mut right) = (Matrix4::zeros(), Vector4::zeros());
    for (row, point, sd) in rows() {
        let row = row.component_div(&sizes);
        normal += row * row.transpose();
        right += row * (point.deviation.powi(2) / sd);
    }
    let sets = (1_u8..16).map(|set| std::array::from_fn(|part| set >> part & 1 == 1));
    let solved = sets.filter_map(|set: [bool; 4]| {
        // A part that is left out gets an equation of its own, with the answer 0.
        let both = |r: usize, c: usize| if r == c { 1.0 } else { 0.0 };
        let normal = Matrix4::from_fn(|r, c| if set[r] && set[c] { normal[(r, c)] } else { both(r, c) });
        let right = Vector4::from_fn(|r, _| if set[r] { right[r] } else { 0.0 });
        let factor = Cholesky::new(normal)?;
        let solution = factor.solve(&right);
        let allowed = solution.iter().all(|s| *s >= 0.0 && s.is_finite());
        let inverse = factor.inverse();
        let sd = |part: usize| if set[part] { inverse[(part, part)].sqrt() / sizes[part] } else { 0.0 };
        let squares = solution.component_div(&sizes).into();
        // The cost less that of no parts at all.
        let cost = -solution.dot(&right);
        allowed.then_some((cost, Squares { squares, sd: std::array::from_fn(sd) }))
    });
    solved.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, squares)| squares)
}
