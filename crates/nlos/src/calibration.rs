//! From logits to probabilities that hold.
//!
//! Two questions make three classes: `P(LOS) = σ(l₁/T₁)`, `P(NLOS) = (1 − P(LOS)) σ(l₂/T₂)`, `P(NDP) = (1 − P(LOS)) (1 − σ(l₂/T₂))`; three make four likewise. So sets that tell line of sight
//! alone (and simulated ones, in which what counts as no direct path is a matter of taste) teach the first without disturbing the second.
//!
//! `σ(l/T + ln o)` in place of `σ(l)`: the temperature `T` (Guo, Pleiss, Sun & Weinberger 2017) of least log loss over judgements on groups that were not learnt from, and the odds `o` at which yes comes in
//! the data (learning weighs both answers the same). The odds are not fitted to the judgements: with a few geometries of a class, leaving one out would shift them against it.

use crate::model::Probabilities;
use crate::task::MOST_QUESTIONS;
use serde::{Deserialize, Serialize};

/// `ln P(yes)/P(no)` of each question; 0 for one that is not asked.
pub type Logits = [f32; MOST_QUESTIONS];

/// How a logit becomes a probability: `σ(scale · l + offset)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scaling {
    /// Of the logit.
    pub scale: f32,
    /// Added to it.
    pub offset: f32,
}

/// One for each question.
pub type Scalings = Vec<Scaling>;

impl Default for Scaling {
    fn default() -> Self {
        Self { scale: 1.0, offset: 0.0 }
    }
}

/// Probabilities of the classes, by as many questions less one; a scaling that is not there changes nothing.
pub fn probabilities(logits: Logits, scalings: &[Scaling], classes: usize) -> Probabilities {
    let (mut told, mut left) = (Probabilities::default(), 1.0);
    for (k, (logit, told)) in logits.iter().zip(&mut told).take(classes.saturating_sub(1)).enumerate() {
        let Scaling { scale, offset } = scalings.get(k).copied().unwrap_or_default();
        let yes = 1.0 / (1.0 + (-logit * scale - offset).exp());
        *told = left * yes;
        left *= 1.0 - yes;
    }
    if let Some(last) = told.get_mut(classes.saturating_sub(1)) {
        *last = left;
    }
    told
}

/// Shares of the classes in the data, as the scalings know them.
pub fn shares(scalings: &[Scaling], classes: usize) -> Probabilities {
    probabilities(Logits::default(), scalings, classes)
}

impl Scaling {
    /// The temperature of least log loss, 0.05 to 50, with these odds: answer (`false` is yes) and logit of each judgement.
    pub fn learn(judged: &[(bool, f32)], odds: f64) -> Self {
        let offset = odds.ln();
        let loss = |log_temperature: f64| -> f64 {
            let inverse = (-log_temperature).exp();
            let of = |(no, logit): &(bool, f32)| {
                let l = f64::from(*logit) * inverse + offset;
                let against = if *no { l } else { -l };
                // ln(1 + e^x) without overflow.
                against.max(0.0) + (-against.abs()).exp().ln_1p()
            };
            judged.iter().map(of).sum()
        };
        // The loss is convex in 1/T, so with one minimum in ln T: golden section.
        let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
        let (mut low, mut high) = (0.05_f64.ln(), 50.0_f64.ln());
        let (mut a, mut b) = (high - ratio * (high - low), low + ratio * (high - low));
        let (mut at_a, mut at_b) = (loss(a), loss(b));
        while high - low > 1e-4 {
            if at_a < at_b {
                (high, b, at_b) = (b, a, at_a);
                a = high - ratio * (high - low);
                at_a = loss(a);
            } else {
                (low, a, at_a) = (a, b, at_b);
                b = low + ratio * (high - low);
                at_b = loss(b);
            }
        }
        #[expect(clippy::cast_possible_truncation, reason = "kept in single precision")]
        let learnt = Self { scale: (-0.5 * (low + high)).exp() as f32, offset: offset as f32 };
        learnt
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "tests: these are exact")]
mod tests {
    use super::*;

    #[test]
    fn logits_that_were_stretched_are_put_right() {
        // Of each logit l a share σ(l + ln o) is yes, as exactly as 10,000 judgements can tell.
        let judged = |stretch: f32, odds: f32| -> Vec<(bool, f32)> {
            let levels = [-2.0_f32, -1.0, 0.0, 1.0, 2.0];
            let of = |level: f32| {
                let yes = 10_000.0 / (1.0 + (-level).exp() / odds);
                (0..10_000_u16).map(move |k| (f32::from(k) >= yes, stretch * level))
            };
            levels.into_iter().flat_map(of).collect()
        };
        for (stretch, odds) in [(1.0, 1.0), (4.0, 0.25), (0.2, 3.0)] {
            let learnt = Scaling::learn(&judged(stretch, odds), odds.into());
            // Counts are rounded, and the search ends within 1e-4.
            assert!((learnt.scale * stretch - 1.0).abs() < 1e-3, "{learnt:?} {stretch}");
            assert!((learnt.offset - odds.ln()).abs() < 1e-6);
        }
    }

    #[test]
    fn probabilities_sum_to_one_and_do_not_overflow() {
        let as_they_are = [Scaling::default(); 3];
        assert_eq!(probabilities([1e30, 5.0, 1.0], &as_they_are, 4), [1.0, 0.0, 0.0, 0.0]);
        assert_eq!(probabilities([-1e30, -1e30, -1e30], &as_they_are, 4), [0.0, 0.0, 0.0, 1.0]);
        let [los, nlos, ndp, none] = probabilities([0.0, 3.0_f32.ln(), 7.0], &as_they_are, 3);
        assert!((los - 0.5).abs() < 1e-6 && (nlos - 0.375).abs() < 1e-6 && (ndp - 0.125).abs() < 1e-6);
        assert_eq!(none, 0.0);
        assert_eq!(probabilities([0.0, 9.0, 9.0], &as_they_are, 2), [0.5, 0.5, 0.0, 0.0]);
        let told = probabilities([0.0, 0.0, 0.0], &as_they_are, 4);
        assert_eq!(told, [0.5, 0.25, 0.125, 0.125]);
    }
}
