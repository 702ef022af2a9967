//! Which numbers of a sender have come: exactly, in little memory.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Gaps remembered; of more, the oldest is closed.
const MOST_GAPS: usize = 4096;

/// First and last of each span of numbers.
pub type Spans = Vec<(u64, u64)>;

/// Numbers that have come, as spans. A sender that counts by one and loses nothing is one span, whatever it sent.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Seen {
    /// First and last of each span.
    spans: BTreeMap<u64, u64>,
}

impl Seen {
    /// Whether the number has come.
    pub fn has(&self, number: u64) -> bool {
        self.spans.range(..=number).next_back().is_some_and(|(_, last)| number <= *last)
    }

    /// Remembers the number; `false` when it has come before.
    pub fn insert(&mut self, number: u64) -> bool {
        let before = self.spans.range(..=number).next_back().map(|(first, last)| (*first, *last));
        if before.is_some_and(|(_, last)| number <= last) {
            return false;
        }
        let joins_before = before.filter(|(_, last)| last + 1 == number).map(|(first, _)| first);
        let after = number.checked_add(1).and_then(|next| self.spans.remove(&next));
        let (first, last) = (joins_before.unwrap_or(number), after.unwrap_or(number));
        self.spans.insert(first, last);
        if self.spans.len() > MOST_GAPS
            && let Some((oldest, _)) = self.spans.pop_first()
            && let Some(next) = self.spans.first_entry()
        {
            let last = *next.get();
            next.remove();
            self.spans.insert(oldest, last);
        }
        true
    }

    /// As if the number had not come.
    pub fn forget(&mut self, number: u64) {
        let Some((first, last)) =
            self.spans.range(..=number).next_back().map(|(first, last)| (*first, *last))
        else {
            return;
        };
        if number > last {
            return;
        }
        self.spans.remove(&first);
        if first < number {
            self.spans.insert(first, number - 1);
        }
        if number < last {
            self.spans.insert(number + 1, last);
        }
    }

    /// Spans of numbers that have come, in order: first and last of each.
    pub fn spans(&self) -> impl Iterator<Item = (u64, u64)> + '_ {
        self.spans.iter().map(|(first, last)| (*first, *last))
    }

    /// The largest number that has come.
    pub fn last(&self) -> Option<u64> {
        self.spans.last_key_value().map(|(_, last)| *last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    proptest! {
        #[test]
        fn knows_what_a_set_knows(numbers in proptest::collection::vec(0_u64..200, 0..300)) {
            let (mut seen, mut set) = (Seen::default(), BTreeSet::new());
            for number in numbers {
                prop_assert_eq!(seen.insert(number), set.insert(number));
            }
            for number in 0..200 {
                prop_assert_eq!(seen.has(number), set.contains(&number));
            }
            prop_assert_eq!(seen.last(), set.last().copied());
            for number in 0..100 {
                seen.forget(number);
            }
            for number in 0..200 {
                prop_assert_eq!(seen.has(number), number >= 100 && set.contains(&number));
            }
            set.retain(|number| *number >= 100);
            let counted: u64 = seen.spans().map(|(first, last)| last - first + 1).sum();
            prop_assert_eq!(counted, set.len() as u64);
        }
    }

    #[test]
    fn its_memory_is_bounded() {
        let mut seen = Seen::default();
        for number in 0..3 * MOST_GAPS as u64 {
            assert!(seen.insert(2 * number));
        }
        assert_eq!(seen.spans().count(), MOST_GAPS);
        assert!(seen.has(u64::from(1_u8)), "the oldest gap is closed");
        assert!(seen.insert(u64::MAX));
    }
}
