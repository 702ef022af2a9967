//! The way of the last minute, in the carrier's frame: what comes late is held against where the carrier was.
//!
//! Fine for the last seconds, coarse before: late observations come within a second as a rule, those that a gateway stored within a minute.

use adit_core::nalgebra::Vector3;
use adit_core::time::{Interval, Time};
use alloc::collections::VecDeque;
use serde::{Deserialize, Serialize};

/// Fine places: three seconds of them.
const FINE: usize = 32;
const FINE_GAP: Interval = Interval::from_nanos(95_000_000);
/// Coarse places: a minute of them.
const COARSE: usize = 64;
const COARSE_GAP: Interval = Interval::from_nanos(995_000_000);
/// A velocity is that between two places so far apart, s.
const SPAN: Interval = Interval::from_nanos(250_000_000);

/// Way over time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Trail {
    fine: VecDeque<(Time, Vector3<f64>)>,
    coarse: VecDeque<(Time, Vector3<f64>)>,
    /// The newest place, which may yet be overtaken.
    newest: Option<(Time, Vector3<f64>)>,
}

impl Default for Trail {
    fn default() -> Self {
        Self { fine: VecDeque::with_capacity(FINE), coarse: VecDeque::with_capacity(COARSE), newest: None }
    }
}

impl Trail {
    /// The way has come to a place; times rise.
    #[inline]
    pub fn push(&mut self, time: Time, way_m: Vector3<f64>) {
        if self.newest.is_some_and(|(last, _)| last >= time) {
            return;
        }
        if let Some(newest) = self.newest
            && self.fine.back().is_none_or(|(last, _)| newest.0 - *last >= FINE_GAP)
        {
            if self.fine.len() == FINE
                && let Some(oldest) = self.fine.pop_front()
            {
                self.keep_coarse(oldest);
            }
            self.fine.push_back(newest);
        }
        self.newest = Some((time, way_m));
    }

    fn keep_coarse(&mut self, place: (Time, Vector3<f64>)) {
        if self.coarse.back().is_some_and(|(last, _)| place.0 - *last < COARSE_GAP) {
            return;
        }
        if self.coarse.len() == COARSE {
            self.coarse.pop_front();
        }
        self.coarse.push_back(place);
    }

    /// Nothing is known of the way before now.
    pub fn clear(&mut self) {
        self.fine.clear();
        self.coarse.clear();
        self.newest = None;
    }

    /// The way at a time, by straight lines; `None` before the oldest and after the newest.
    pub fn at(&self, time: Time) -> Option<Vector3<f64>> {
        let (latest, here) = self.newest?;
        if time >= latest {
            return (time == latest).then_some(here);
        }
        let later = || self.fine.iter().rev().find(|(at, _)| *at <= time);
        if let Some((earlier, from)) = later() {
            let next = self.fine.iter().find(|(at, _)| *at > time).copied().unwrap_or((latest, here));
            return Some(between((*earlier, *from), next, time));
        }
        let (earlier, from) = self.coarse.iter().rev().find(|(at, _)| *at <= time)?;
        let next = self.coarse.iter().find(|(at, _)| *at > time).or_else(|| self.fine.front())?;
        Some(between((*earlier, *from), *next, time))
    }

    /// The velocity at a time, m/s; zero where it is not known.
    pub fn velocity_m_s(&self, time: Time) -> Vector3<f64> {
        let Some((latest, _)) = self.newest else { return Vector3::zeros() };
        let (from, to) = (time - SPAN, (time + SPAN).min(latest));
        match (self.at(from), self.at(to)) {
            (Some(here), Some(there)) if to > from => (there - here) / (to - from).seconds(),
            _ => Vector3::zeros(),
        }
    }
}

fn between(
    (earlier, from): (Time, Vector3<f64>),
    (later, to): (Time, Vector3<f64>),
    time: Time,
) -> Vector3<f64> {
    let length_s = (later - earlier).seconds();
    let share = if length_s > 0.0 { (time - earlier).seconds() / length_s } else { 1.0 };
    from + (to - from) * share
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;

    fn at(ms: i64) -> Time {
        Time::from_nanos(ms * 1_000_000)
    }

    #[test]
    fn a_straight_way_is_found_again_for_a_minute() {
        let mut trail = Trail::default();
        assert!(trail.at(at(0)).is_none());
        for sample in 0..12_000_i64 {
            trail.push(at(10 * sample), Vector3::new(0.01 * sample as f64, 0.0, 1.0));
        }
        let newest = 10 * 11_999;
        for back in [0, 5, 10, 995, 2_000, 3_500, 20_000, 60_000] {
            let found = trail.at(at(newest - back)).unwrap();
            assert!((found.x - (119.99 - 0.001 * back as f64)).abs() < 1e-9, "{back}: {found}");
        }
        assert!(trail.at(at(newest + 1)).is_none() && trail.at(at(newest - 90_000)).is_none());
        assert!((trail.velocity_m_s(at(newest)) - Vector3::new(1.0, 0.0, 0.0)).norm() < 1e-9);
        assert!(trail.fine.capacity() <= FINE && trail.coarse.capacity() <= COARSE, "bounded");
    }

    #[test]
    fn what_goes_back_in_time_is_left() {
        let mut trail = Trail::default();
        trail.push(at(1000), Vector3::x());
        trail.push(at(900), Vector3::y());
        assert_eq!(trail.at(at(1000)), Some(Vector3::x()));
        trail.clear();
        assert_eq!(trail.at(at(1000)), None);
    }
}
