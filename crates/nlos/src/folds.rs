//! Which groups are held out together.
//!
//! Responses of one geometry are near copies of each other: a random split leaks (a forest scores 0.99 at random and 0.84 balanced by geometry on `uwb-cir`). So whole groups are held
//! out, those of each class spread evenly over the folds.

use crate::error::NlosError;
use crate::examples::Examples;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Of each fold the groups of `rows` that it holds out; with as many folds as groups, each group alone.
pub fn by_group(
    examples: &Examples,
    rows: &[usize],
    folds: usize,
    seed: u64,
) -> Result<Vec<Vec<usize>>, NlosError> {
    for (class, name) in examples.task.classes().iter().enumerate() {
        let found = examples.groups_of(class, rows).len();
        if found < 2 {
            return Err(NlosError::TooFewGroups { class: name, found, expected: 2 });
        }
    }
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut order: Vec<usize> = Vec::new();
    for class in 0..examples.task.classes().len() {
        let mut groups = examples.groups_of(class, rows);
        groups.retain(|group| !order.contains(group));
        shuffle(&mut groups, &mut random);
        order.extend(groups);
    }
    let folds = folds.clamp(2, order.len());
    let mut held = vec![Vec::new(); folds];
    for (k, group) in order.into_iter().enumerate() {
        held[k % folds].push(group);
    }
    Ok(held)
}

/// Fisher and Yates.
pub fn shuffle<T>(values: &mut [T], random: &mut ChaCha8Rng) {
    for last in (1..values.len()).rev() {
        #[expect(clippy::cast_possible_truncation, reason = "not above the index `last`")]
        let other = (random.next_u64() % (last as u64 + 1)) as usize;
        values.swap(last, other);
    }
}
