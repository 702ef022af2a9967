//! What stands in the way of a link stays there for a while: judgements of successive responses, joined.
//!
//! A hidden Markov model of each link, filtered forwards (Rabiner 1989, §III): the way changes at a rate `λ`, then to any class by its share `π`,
//!
//! `b⁻ = π + (b − π) e^(−λ Δt)`,  `b_c ∝ b⁻_c (p_c / π_c)^w`
//!
//! with what the model says of this response, `p`. `w` below 1, as successive responses share their echoes and are no independent witnesses; with Δt = 0 and `b = π` the
//! probabilities are `p` at w = 1. Both numbers are chosen on simulated rooms (`docs/methods/nlos.md`).

use crate::model::{Model, Probabilities};
use adit_core::time::Time;
use serde::{Deserialize, Serialize};

/// How long the way lasts and how much a response counts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Persistence {
    /// How often the way changes, λ, 1/s.
    pub rate_per_s: f64,
    /// How much a response counts, w.
    pub weight: f32,
}

impl Default for Persistence {
    /// Of least log loss on simulated rooms (`cargo run -p adit-nlos --example link_filter`).
    fn default() -> Self {
        Self { rate_per_s: 2.0, weight: 0.5 }
    }
}

/// No class is ever less probable than this.
const FLOOR: f32 = 1e-4;

/// What is believed of one link.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LinkFilter {
    persistence: Persistence,
    shares: Probabilities,
    classes: usize,
    belief: Option<(Time, Probabilities)>,
}

impl LinkFilter {
    /// Of a link of which nothing is told yet, for judgements of this model.
    pub fn new(model: &Model, persistence: Persistence) -> Self {
        Self::of(persistence, model.shares(), model.task.classes().len())
    }

    fn of(persistence: Persistence, shares: Probabilities, classes: usize) -> Self {
        Self { persistence, shares, classes, belief: None }
    }

    /// What is believed after the next response; one from before the last counts as simultaneous.
    pub fn update(&mut self, time: Time, told: &Probabilities) -> Probabilities {
        let Some((before, belief)) = self.belief else {
            self.belief = Some((time, *told));
            return *told;
        };
        let since_s = (time - before).seconds().max(0.0);
        #[expect(clippy::cast_possible_truncation, reason = "0 to 1")]
        let kept = (-self.persistence.rate_per_s * since_s).exp() as f32;
        let mut now = Probabilities::default();
        for c in 0..self.classes.min(now.len()) {
            let share = self.shares[c].max(FLOOR);
            let predicted = share + (belief[c] - share) * kept;
            now[c] = predicted.max(FLOOR) * (told[c].max(FLOOR) / share).powf(self.persistence.weight);
        }
        let sum: f32 = now.iter().sum();
        for p in &mut now {
            *p /= sum;
        }
        self.belief = Some((time.max(before), now));
        now
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "tests: these are exact")]
mod tests {
    use super::*;
    use adit_core::time::Interval;

    const SHARES: Probabilities = [0.5, 0.25, 0.125, 0.125];
    const PERSISTENCE: Persistence = Persistence { rate_per_s: 0.5, weight: 0.5 };
    const STEP: Interval = Interval::from_nanos(100_000_000);

    #[test]
    fn the_first_response_is_taken_at_its_word_and_nothing_new_leads_back_to_the_shares() {
        let told = [0.7, 0.1, 0.1, 0.1];
        let mut filter = LinkFilter::of(PERSISTENCE, SHARES, 4);
        assert_eq!(filter.update(Time::ZERO, &told), told);
        // Far later, a response that says nothing: e^−λΔt is 0.
        let later = filter.update(Time::from_nanos(1_000_000_000_000), &SHARES);
        assert!(later.iter().zip(&SHARES).all(|(a, b)| (a - b).abs() < 1e-6), "{later:?}");
    }

    #[test]
    fn one_odd_response_among_many_changes_little_and_a_lasting_change_is_followed() {
        let (clear, odd) = ([0.9, 0.05, 0.025, 0.025], [0.05, 0.9, 0.025, 0.025]);
        let mut filter = LinkFilter::of(PERSISTENCE, SHARES, 4);
        let mut time = Time::ZERO;
        let mut next = |told| {
            time = time + STEP;
            filter.update(time, told)[0]
        };
        (0..20).for_each(|_| {
            next(&clear);
        });
        assert!(next(&odd) > 0.5);
        let before = next(&clear);
        assert!(before > 0.9);
        let last = (0..20).map(|_| next(&odd)).last();
        assert!(last.is_some_and(|p| p < 0.1), "{last:?}");
    }

    #[test]
    fn what_comes_late_counts_as_simultaneous_and_certainty_can_be_left() {
        let mut filter = LinkFilter::of(PERSISTENCE, SHARES, 4);
        filter.update(Time::from_nanos(10), &[1.0, 0.0, 0.0, 0.0]);
        let told = filter.update(Time::ZERO, &[0.0, 0.0, 0.0, 1.0]);
        assert!(
            (told.iter().sum::<f32>() - 1.0).abs() < 1e-6 && told.iter().all(|p| p.is_finite() && *p > 0.0)
        );
        let two =
            LinkFilter::of(PERSISTENCE, [0.3, 0.7, 0.0, 0.0], 2).update(Time::ZERO, &[0.2, 0.8, 0.0, 0.0]);
        assert_eq!(two, [0.2, 0.8, 0.0, 0.0]);
    }
}
