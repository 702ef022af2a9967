//! What a tag's clock says, as far as it can be true.
//!
//! Estimators live in the time of their tag, which goes forward and is no later than the server's clock, or nearly:
//!
//! - **Ahead.** A packet cannot arrive before it was measured. When its newest stamp is more than [`AHEAD`] after its arrival, the
//!   clock of the tag is wrong: from here on its stamps are moved so that the packet ends when it arrived. A tag that thinks it is 2031
//!   does not freeze its position until then.
//! - **Behind.** What ends before the newest stamp so far is late: it is given to the estimator, which takes what can be taken late (what
//!   came by radio) and leaves the rest; the live position stays. When packet after packet is late by the same amount, while nothing else
//!   comes, the clock was set back ([`PACKETS`] packets over [`LASTS`], stamps that go forward): they are moved forward to where they belong.
//!
//! How far stamps are moved is the tag's `shift`, told with its health.

use adit_core::time::{Interval, Time};
use serde::{Deserialize, Serialize};

/// Clocks of servers and gateways are set by the network to better than this.
pub const AHEAD: Interval = Interval::from_nanos(2_000_000_000);
/// Late packets in a row that make a clock that was set back.
pub const PACKETS: u32 = 5;
/// And over how long they come.
pub const LASTS: Interval = Interval::from_nanos(5_000_000_000);

/// The clock of one tag.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct TagClock {
    /// What is added to the tag's stamps.
    shift: Interval,
    /// Newest stamp so far, moved.
    newest: Option<Time>,
    /// Since when, how many packets and with which newest stamp everything is late.
    late: Option<Late>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
struct Late {
    since: Time,
    packets: u32,
    newest: Time,
}

/// What to make of a packet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// It goes on from what came before; its stamps are to be moved by this.
    OnTime(Interval),
    /// All of it is older than what came before; its stamps are to be moved by this.
    Late(Interval),
}

impl TagClock {
    /// Judges a packet by its newest stamp, as the tag gives it, and its arrival.
    pub fn judge(&mut self, newest: Time, arrived: Time) -> Verdict {
        let moved = newest + self.shift;
        if moved > arrived + AHEAD {
            self.shift = arrived - newest;
            return self.on_time(newest + self.shift);
        }
        if self.newest.is_none_or(|before| moved > before) {
            return self.on_time(moved);
        }
        let goes_on = self.late.filter(|late| moved > late.newest);
        let late = goes_on.map_or(Late { since: arrived, packets: 1, newest: moved }, |late| Late {
            packets: late.packets.saturating_add(1),
            newest: moved,
            ..late
        });
        if late.packets >= PACKETS && arrived - late.since >= LASTS {
            self.shift = arrived - newest;
            return self.on_time(newest + self.shift);
        }
        self.late = Some(late);
        Verdict::Late(self.shift)
    }

    /// What is added to the tag's stamps.
    pub fn shift(&self) -> Interval {
        self.shift
    }

    fn on_time(&mut self, newest: Time) -> Verdict {
        // Moved stamps may still fall behind what was there by a moment.
        self.newest = self.newest.max(Some(newest));
        self.late = None;
        Verdict::OnTime(self.shift)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(seconds: f64) -> Time {
        Time::from_seconds(seconds).unwrap_or_default()
    }

    fn by(seconds: f64) -> Interval {
        Interval::from_seconds(seconds).unwrap_or_default()
    }

    #[test]
    fn a_true_clock_is_left_alone() {
        let mut clock = TagClock::default();
        for second in 0..100 {
            let newest = at(1000.0 + f64::from(second));
            assert_eq!(clock.judge(newest, newest + by(0.2)), Verdict::OnTime(Interval::ZERO));
        }
    }

    #[test]
    fn a_clock_in_the_future_is_moved_to_now_and_stays_there() {
        let mut clock = TagClock::default();
        clock.judge(at(1000.0), at(1000.1));
        let years = 5.0 * 365.25 * 86_400.0;
        for second in 1..100 {
            let now = at(1000.1 + f64::from(second));
            let verdict = clock.judge(at(1000.0 + years + f64::from(second)), now);
            assert_eq!(verdict, Verdict::OnTime(by(0.1 - years)), "second {second}");
        }
        // Set right again: late at first, until it is plain that no other packets come.
        let verdicts: Vec<_> = (100..110)
            .map(|second| clock.judge(at(1000.0 + f64::from(second)), at(1000.1 + f64::from(second))))
            .collect();
        let late = verdicts.iter().filter(|verdict| matches!(verdict, Verdict::Late(_))).count();
        assert_eq!(late, 5, "{verdicts:?}");
        assert!(matches!(verdicts[9], Verdict::OnTime(shift) if shift.seconds().abs() < 0.2));
    }

    #[test]
    fn a_backlog_is_late_and_moves_nothing() {
        let mut clock = TagClock::default();
        clock.judge(at(1000.0), at(1000.1));
        for second in 0..60 {
            // A gateway gives what it has kept, newest and oldest in turn.
            let (live, kept) = (at(1001.0 + f64::from(second)), at(900.0 + f64::from(second)));
            assert_eq!(clock.judge(live, live + by(0.1)), Verdict::OnTime(Interval::ZERO));
            assert_eq!(clock.judge(kept, live + by(0.15)), Verdict::Late(Interval::ZERO));
        }
    }
}
