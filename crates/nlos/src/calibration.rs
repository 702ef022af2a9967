//! Probabilities that hold: temperature scaling (Guo, Pleiss, Sun & Weinberger 2017).
//!
//! `P(c) = softmax(logit_c / T)`, with the `T` that minimises the log loss of judgements on groups that were not learnt from.

/// From logits to probabilities, in place.
pub fn softmax(logits: &mut [f32], temperature: f32) {
    let largest = logits.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let mut sum = 0.0;
    for logit in &mut *logits {
        *logit = ((*logit - largest) / temperature).exp();
        sum += *logit;
    }
    for logit in logits {
        *logit /= sum;
    }
}

/// The temperature of least log loss, 0.1 to 30: true class, logits and weight of each judgement.
pub fn temperature(judged: &[(usize, Vec<f32>, f64)]) -> f32 {
    let loss = |log_temperature: f64| -> f64 {
        let inverse = (-log_temperature).exp();
        judged
            .iter()
            .map(|(truth, logits, weight)| {
                let of = |k: usize| f64::from(logits[k]) * inverse;
                let largest = (0..logits.len()).map(of).fold(f64::NEG_INFINITY, f64::max);
                let sum: f64 = (0..logits.len()).map(|k| (of(k) - largest).exp()).sum();
                weight * (sum.ln() + largest - of(*truth))
            })
            .sum()
    };
    // The loss is convex in 1/T, so with one minimum in ln T: golden section.
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut low, mut high) = (0.1_f64.ln(), 30.0_f64.ln());
    let (mut a, mut b) = (high - ratio * (high - low), low + ratio * (high - low));
    let (mut at_a, mut at_b) = (loss(a), loss(b));
    while high - low > 1e-3 {
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
    #[expect(clippy::cast_possible_truncation, reason = "0.1 to 30")]
    let temperature = (0.5 * (low + high)).exp() as f32;
    temperature
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_temperature_of_logits_that_were_stretched_is_the_stretch() {
        // 3 of 4 are of class 0 with logits that say so at T = 1: ln 3.
        let stretched = |factor: f32| -> Vec<(usize, Vec<f32>, f64)> {
            (0..4).map(|k| (usize::from(k == 0), vec![factor * 3.0_f32.ln(), 0.0], 1.0)).collect()
        };
        for factor in [0.5, 1.0, 7.0] {
            // The search ends within 1e-3 of ln T.
            assert!((temperature(&stretched(factor)) / factor - 1.0).abs() < 2e-3);
        }
    }

    #[test]
    fn probabilities_sum_to_one_and_do_not_overflow() {
        let mut values = [1000.0, 0.0, -1000.0];
        softmax(&mut values, 1.0);
        assert_eq!(values, [1.0, 0.0, 0.0]);
        let mut values = [1.0, 2.0, 3.0];
        softmax(&mut values, 2.0);
        assert!((values.iter().sum::<f32>() - 1.0).abs() < 1e-6);
    }
}
