//! Log lines that others can make many of: one in a while, so that junk cannot fill the disk. All of them are counted in the metrics.

use std::fmt::Display;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// One line in so long.
const PAUSE: Duration = Duration::from_secs(5);

/// A kind of line.
pub(crate) struct Seldom(Mutex<State>);

struct State {
    last: Option<Instant>,
    untold: u64,
}

impl Seldom {
    /// Nothing told yet.
    pub const fn new() -> Self {
        Self(Mutex::new(State { last: None, untold: 0 }))
    }

    /// Whether a line may be told at this moment; if so, how many were left out since the last.
    fn may(&self, now: Instant) -> Option<u64> {
        let mut state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if state.last.is_some_and(|last| now.saturating_duration_since(last) < PAUSE) {
            state.untold += 1;
            return None;
        }
        state.last = Some(now);
        Some(std::mem::take(&mut state.untold))
    }

    /// Warns, or counts.
    pub fn warn(&self, what: impl Display) {
        match self.may(Instant::now()) {
            Some(0) => tracing::warn!("{what}"),
            Some(untold) => tracing::warn!("{what} (and {untold} like it since the last such line)"),
            None => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_line_in_a_while_and_the_count_of_the_others() {
        let (lines, begin) = (Seldom::new(), Instant::now());
        let at = |ms| lines.may(begin + Duration::from_millis(ms));
        assert_eq!([at(0), at(1), at(4999), at(5000), at(5001)], [Some(0), None, None, Some(2), None]);
        assert_eq!(at(60_000), Some(1));
    }
}
