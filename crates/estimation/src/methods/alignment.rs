//! Dead reckoning and ranges on one axis of time (Jia et al. 2024: "time alignment before fusion").
//!
//! Sensors of a tag tell of a step when it is done, ranges come when they are measured, or late. An epoch of ranges waits until dead reckoning has come
//! to its time, and is told with the place that dead reckoning was at then (a straight line between two of its solutions). Without inertial
//! samples nothing waits.

use super::MethodError;
use super::pdr::{Pdr, PdrParams, PdrReport};
use crate::pedestrian::trail::Trail;
use crate::ranging::epochs::Epoch;
use crate::ranging::listener::RangeListener;
use adit_core::nalgebra::Vector2;
use adit_core::solution::Solution;
use adit_observation::Observation;
use alloc::collections::VecDeque;
use serde::{Deserialize, Serialize};

/// Epochs that may wait for dead reckoning: a minute of them at 16 a second. With more, the oldest do not wait.
const MOST_HELD: usize = 1024;

/// What happened next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[expect(clippy::large_enum_variant, reason = "a queue of a few; a box would be an allocation a step")]
pub enum Event {
    /// Dead reckoning has come to a place, in its own frame.
    Reckoned(Solution),
    /// An epoch of ranges, and where dead reckoning was at its time, m; `None` before its beginning and in a gap.
    Ranges(Epoch, Option<Vector2<f64>>),
}

/// Both halves, streaming; events come in order of time but for epochs older than the trail.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Alignment {
    listener: RangeListener,
    pdr: Option<Pdr>,
    /// True once there was an inertial sample.
    inertial: bool,
    waiting: Waiting,
}

/// What waits for dead reckoning.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
struct Waiting {
    trail: Trail,
    held: VecDeque<Epoch>,
    due: VecDeque<Event>,
}

impl Alignment {
    /// Of these ranges, with dead reckoning or without.
    pub fn new(listener: RangeListener, pdr: Option<PdrParams>) -> Result<Self, MethodError> {
        let pdr = pdr.map(|mut params| {
            params.fixes.used = false;
            params.radio.used = false;
            Pdr::new(params)
        });
        Ok(Self { listener, pdr: pdr.transpose()?, inertial: false, waiting: Waiting::default() })
    }

    /// Takes an observation; what it makes due comes with [`Self::pop`].
    #[inline]
    pub fn observe(&mut self, observation: &Observation) -> Result<(), MethodError> {
        self.listener.observe(observation);
        if let Some(pdr) = &mut self.pdr
            && !matches!(observation, Observation::Range(_))
        {
            self.inertial |= matches!(observation, Observation::Imu(_) | Observation::Acceleration(_));
            let mut reckoned = pdr.observe(observation)?;
            while let Some(now) = reckoned {
                self.waiting.reckon(now);
                reckoned = pdr.next_due();
            }
        }
        while let Some(epoch) = self.listener.pop() {
            self.waiting.hold(epoch, self.inertial);
        }
        Ok(())
    }

    /// The next event, if any is due.
    #[inline]
    pub fn pop(&mut self) -> Option<Event> {
        self.waiting.due.pop_front()
    }

    /// After the last observation: what is left becomes due.
    pub fn finish(&mut self) -> Result<(), MethodError> {
        while let Some(epoch) = self.listener.finish() {
            self.waiting.hold(epoch, self.inertial);
        }
        if let Some(pdr) = self.pdr.as_mut().filter(|_| self.inertial) {
            while let Some(now) = pdr.finish_next()? {
                self.waiting.reckon(now);
            }
        }
        while let Some(epoch) = self.waiting.held.pop_front() {
            self.waiting.release(epoch);
        }
        Ok(())
    }

    /// Ranges to the anchors of the site.
    pub fn listener(&self) -> &RangeListener {
        &self.listener
    }

    /// What dead reckoning did so far, where there is any.
    pub fn pdr(&self) -> Option<&PdrReport> {
        self.pdr.as_ref().map(Pdr::report)
    }
}

impl Waiting {
    fn hold(&mut self, epoch: Epoch, inertial: bool) {
        let time = epoch.time();
        let ahead = self.trail.newest().is_none_or(|newest| time > newest);
        if !(inertial && ahead) {
            self.release(epoch);
            return;
        }
        if self.held.len() == MOST_HELD
            && let Some(oldest) = self.held.pop_front()
        {
            self.release(oldest);
        }
        let place = self.held.partition_point(|held| held.time() <= time);
        self.held.insert(place, epoch);
    }

    fn release(&mut self, epoch: Epoch) {
        let way_m = self.trail.at(epoch.time());
        self.due.push_back(Event::Ranges(epoch, way_m));
    }

    fn reckon(&mut self, now: Solution) {
        self.trail.push(now.time, now.position_m.xy());
        while let Some(epoch) = self.held.pop_front() {
            if epoch.time() > now.time {
                self.held.push_front(epoch);
                break;
            }
            self.release(epoch);
        }
        self.due.push_back(Event::Reckoned(now));
    }
}
