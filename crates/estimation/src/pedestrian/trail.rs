//! The way of the last seconds: fixes that come late are held against where the walker was.

use adit_core::nalgebra::Vector2;
use adit_core::time::Time;
use alloc::collections::VecDeque;
use serde::{Deserialize, Serialize};

/// Places remembered: half a minute of steps.
const REMEMBERED: usize = 64;

/// Way over time.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Trail {
    /// In order of time.
    places: VecDeque<(Time, Vector2<f64>)>,
}

impl Trail {
    /// The way has come to `way_m`; times do not fall.
    pub fn push(&mut self, time: Time, way_m: Vector2<f64>) {
        if self.places.back().is_some_and(|(last, _)| *last >= time) {
            return;
        }
        if self.places.len() == REMEMBERED {
            self.places.pop_front();
        }
        self.places.push_back((time, way_m));
    }

    /// Time of the newest place.
    pub fn newest(&self) -> Option<Time> {
        self.places.back().map(|(time, _)| *time)
    }

    /// Nothing is known of the way before now.
    pub fn clear(&mut self) {
        self.places.clear();
    }

    /// The way at a time, by straight lines; `None` before the oldest and after the newest.
    pub fn at(&self, time: Time) -> Option<Vector2<f64>> {
        let after = self.places.partition_point(|(at, _)| *at < time);
        let (later, to) = self.places.get(after)?;
        if *later == time {
            return Some(*to);
        }
        let (earlier, from) = self.places.get(after.checked_sub(1)?)?;
        let share = (time - *earlier).seconds() / (*later - *earlier).seconds();
        Some(from + (to - from) * share)
    }
}
