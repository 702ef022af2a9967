//! The server's clock: the time of the mine.
//!
//! `world = world₀ + speed · (wall − wall₀)`. In a real mine both are one. A simulated shift may go faster ([`Clock::set_speed`]): then
//! all that is of the mine goes by this clock (stamps of arrival, ticks, alarms, history), and what is between the server and its users by
//! the wall's (sessions, log-ins, time limits of sockets, the ticks of the feed).

use adit_core::time::{Interval, Time};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::time::{SystemTime, UNIX_EPOCH};
use tokio::sync::watch;

/// A clock goes no faster.
pub const FASTEST: f64 = 100.0;

/// What the wall's clock says, since the Unix epoch.
pub fn now() -> Time {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    Time::from_nanos(i64::try_from(since.as_nanos()).unwrap_or(i64::MAX))
}

/// How a clock goes: at a time of the wall it says a time, and goes on from there.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pace {
    /// Time of the wall, ns since the Unix epoch.
    pub wall_ns: i64,
    /// What the clock says then, ns since the Unix epoch.
    pub world_ns: i64,
    /// Seconds of the clock in a second of the wall, above 0, to [`FASTEST`].
    pub speed: f64,
}

impl Pace {
    /// Real time.
    pub const REAL: Self = Self { wall_ns: 0, world_ns: 0, speed: 1.0 };

    /// What the clock says at a time of the wall.
    pub fn at(&self, wall: Time) -> Time {
        let since = wall - Time::from_nanos(self.wall_ns);
        // Real time stays exact: a float has no nanoseconds after 50 years.
        let since = if self.speed.to_bits() == 1.0_f64.to_bits() {
            since
        } else {
            Interval::from_seconds(since.seconds() * self.speed).unwrap_or(since)
        };
        Time::from_nanos(self.world_ns) + since
    }

    /// The same clock at another speed from a time of the wall on.
    #[must_use]
    pub fn from(&self, wall: Time, speed: f64) -> Self {
        Self { wall_ns: wall.nanos(), world_ns: self.at(wall).nanos(), speed }
    }
}

/// The clock of a server; cheap to clone, all clones are one.
#[derive(Debug, Clone)]
pub struct Clock {
    pace: Arc<watch::Sender<Pace>>,
    simulated: bool,
}

impl Default for Clock {
    fn default() -> Self {
        Self { pace: Arc::new(watch::Sender::new(Pace::REAL)), simulated: false }
    }
}

impl Clock {
    /// The clock of a simulated shift.
    pub fn simulated(pace: Pace) -> Self {
        Self { pace: Arc::new(watch::Sender::new(pace)), simulated: true }
    }

    /// Nobody works by it.
    pub fn is_simulated(&self) -> bool {
        self.simulated
    }

    /// Now.
    pub fn now(&self) -> Time {
        self.pace().at(now())
    }

    /// How it goes.
    pub fn pace(&self) -> Pace {
        *self.pace.borrow()
    }

    /// Goes on at another speed from now.
    pub fn set_speed(&self, speed: f64) {
        self.pace.send_modify(|pace| *pace = pace.from(now(), speed));
    }

    /// Hears of changes of how it goes.
    pub fn changes(&self) -> watch::Receiver<Pace> {
        self.pace.subscribe()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_that_goes_faster_does_not_jump_when_its_speed_changes() {
        let wall = Time::from_nanos(1_800_000_000_123_456_789);
        assert_eq!(Pace::REAL.at(wall), wall, "real time, to the nanosecond");
        let fast = Pace::REAL.from(wall, 10.0);
        assert_eq!(fast.at(wall), wall);
        let later = wall + Interval::from_nanos(2_000_000_000);
        assert_eq!(fast.at(later), wall + Interval::from_nanos(20_000_000_000));
        let slower = fast.from(later, 4.0);
        assert_eq!(slower.at(later), fast.at(later));
        let end = later + Interval::from_nanos(1_000_000_000);
        assert_eq!(slower.at(end), wall + Interval::from_nanos(24_000_000_000));
    }
}
