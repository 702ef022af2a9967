//! From what a tag saw to what arrives at the server: stamps by its own clock, losses, duplicates, delays, gateways that store and forward.
//!
//! ```text
//! observations in true time → DeviceClock (stamps) → link (lost? twice? how late?) → buffer → Delivered in order of arrival
//! ```
//!
//! Every observation that is not lost comes out exactly once, and once more for each declared duplicate. The buffer holds what is under
//! way: no more than arrives within [`LinkSpec::most_delay_s`], and in an outage of the gateway [`LinkSpec::store`] observations, the
//! later ones lost.

mod clock;
mod link;

pub use clock::{ClockSpec, DeviceClock};
pub use link::{LinkSpec, StoreAndForward};

use super::keyed::Key;
use super::world::Purpose;
use crate::error::SimulationError;
use adit_core::time::Time;
use adit_observation::Observation;
use link::{Fate, Link};
use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

/// What can be delivered: something with a stamp.
pub trait Stamped: Clone {
    /// Its stamp.
    fn time(&self) -> Time;

    /// The same with another stamp.
    #[must_use]
    fn stamped(self, stamp: Time) -> Self;
}

/// An observation as the server gets it.
#[derive(Debug, Clone, PartialEq)]
pub struct Delivered<T = Observation> {
    /// When it arrives, true time, s after the start.
    pub arrival_s: f64,
    /// What arrives; stamped by the tag's clock.
    pub observation: T,
    /// It has arrived before.
    pub duplicate: bool,
}

/// What has happened to the observations so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Deliveries {
    /// Observations that the tag made.
    pub made: u64,
    /// Lost on the way.
    pub lost: u64,
    /// Lost because the gateway's store was full.
    pub dropped: u64,
    /// Sent twice.
    pub duplicated: u64,
}

/// Iterator over what arrives, in order of arrival, of observations in order of time.
///
/// The input's stamps are true times. `O(log n)` per observation in what is under way.
#[derive(Debug, Clone)]
pub struct Delivery<I: Iterator> {
    source: I,
    clock: DeviceClock,
    link: Link,
    buffer: BinaryHeap<Reverse<UnderWay<I::Item>>>,
    /// Nothing that is still to come from the source arrives before this, s.
    safe_s: f64,
    number: u64,
    counts: Deliveries,
}

#[derive(Debug, Clone)]
struct UnderWay<T> {
    number: u64,
    delivered: Delivered<T>,
}

impl<I: Iterator<Item: Stamped>> Delivery<I> {
    /// The observations of one person's tag on their way; draws keyed by seed and person.
    pub fn new(
        source: I,
        clock: &ClockSpec,
        link: &LinkSpec,
        seed: u64,
        person: u64,
    ) -> Result<Self, SimulationError> {
        let key = |purpose: Purpose| Key::new(seed, purpose as u64).with(person);
        Ok(Self {
            source,
            clock: DeviceClock::of_person(clock, seed, person)?,
            link: Link::new(link, key(Purpose::Link))?,
            buffer: BinaryHeap::new(),
            safe_s: f64::NEG_INFINITY,
            number: 0,
            counts: Deliveries::default(),
        })
    }

    /// What has happened so far.
    pub fn counts(&self) -> Deliveries {
        self.counts
    }

    /// How many are under way now.
    pub fn under_way(&self) -> usize {
        self.buffer.len()
    }

    fn send(&mut self, observation: I::Item) {
        let time_s = observation.time().seconds();
        self.counts.made += 1;
        self.safe_s = self.safe_s.max(time_s);
        let observation = observation.stamped(self.clock.stamp(time_s));
        match self.link.fate(time_s) {
            Fate::Lost => self.counts.lost += 1,
            Fate::Dropped => self.counts.dropped += 1,
            Fate::Arrives { at_s, again_s } => {
                if let Some(again_s) = again_s {
                    self.counts.duplicated += 1;
                    self.push(again_s, observation.clone(), true);
                }
                self.push(at_s, observation, false);
            }
        }
    }

    fn push(&mut self, arrival_s: f64, observation: I::Item, duplicate: bool) {
        let delivered = Delivered { arrival_s, observation, duplicate };
        self.buffer.push(Reverse(UnderWay { number: self.number, delivered }));
        self.number += 1;
    }
}

impl<I: Iterator<Item: Stamped>> Iterator for Delivery<I> {
    type Item = Delivered<I::Item>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let first_s = self.buffer.peek().map(|Reverse(first)| first.delivered.arrival_s);
            if first_s.is_some_and(|first_s| first_s <= self.safe_s) {
                return self.buffer.pop().map(|Reverse(first)| first.delivered);
            }
            match self.source.next() {
                Some(observation) => self.send(observation),
                None => return self.buffer.pop().map(|Reverse(first)| first.delivered),
            }
        }
    }
}

impl<T> PartialEq for UnderWay<T> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<T> Eq for UnderWay<T> {}

impl<T> PartialOrd for UnderWay<T> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<T> Ord for UnderWay<T> {
    fn cmp(&self, other: &Self) -> Ordering {
        let arrival = |of: &Self| of.delivered.arrival_s;
        arrival(self).total_cmp(&arrival(other)).then(self.number.cmp(&other.number))
    }
}

impl Stamped for Observation {
    fn time(&self) -> Time {
        self.time()
    }

    fn stamped(self, stamp: Time) -> Self {
        self.at(stamp)
    }
}

#[cfg(test)]
mod tests;
