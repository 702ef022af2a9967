//! One tag: its clock, its estimator, what came of its packets.

use super::clock::{TagClock, Verdict};
use super::estimator::Estimator;
use super::hearing::{Hearing, HearingReport};
use super::motion;
use super::profile::Profile;
use crate::journal::{Position, Seen};
use adit_core::frames::{Position as GridPosition, Vector};
use adit_core::solution::{Quality, Solution};
use adit_core::time::{Interval, Time};
use adit_nlos::network::Scratch;
use adit_nlos::{Links, annotate};
use adit_observation::Observation;
use adit_observation::wire::Packet;
use adit_tracking::{Battery, Button, Charge, Fix, Heard, Input};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A packet gives a fix for each such span of time that it covers, and one for its end.
const FIX_EVERY: Interval = Interval::from_nanos(1_000_000_000);
/// Errors of an estimator in a row after which it begins anew.
const MOST_ERRORS: u32 = 100;
/// Speeds with a larger standard deviation are not known, m/s.
const SPEED_SIGMA_M_S: f64 = 1.0;

/// One tag.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Follower {
    /// Name of its profile.
    profile: Arc<str>,
    clock: TagClock,
    /// Of the tag's own numbers.
    numbers: Seen,
    estimator: Option<Estimator>,
    /// What was told of its links, where ranges are judged.
    #[serde(default, skip_serializing_if = "Links::is_empty")]
    links: Links,
    /// What it sends, whom it hears.
    #[serde(default)]
    hearing: Hearing,
    /// Newest time of its own sensors that the estimator has.
    wired: Option<Time>,
    /// When the last fix was valid.
    told: Option<Time>,
    /// The last entry of the journal that counts.
    applied: Position,
    /// The same when it was read back from a snapshot: all of that entry and of those before it is in it.
    #[serde(skip)]
    held: Position,
    counts: TagCounts,
    errors_in_a_row: u32,
    last_error: Option<String>,
}

/// What came of a tag's packets.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TagCounts {
    /// Packets taken.
    pub packets: u64,
    /// Packets that had come before.
    pub repeated_packets: u64,
    /// Packets all of which was older than what came before.
    pub late_packets: u64,
    /// Observations given to the estimator.
    pub observations: u64,
    /// Readings of the tag's own sensors that came too late for it.
    pub late_readings: u64,
    /// Observations that the estimator refused.
    pub refused: u64,
    /// How often it began anew after errors.
    pub restarts: u64,
    /// Ranges judged for line of sight.
    #[serde(default)]
    pub judged: u64,
    /// Fixes told.
    pub fixes: u64,
}

/// How a tag is followed: why its position is where it is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TagHealth {
    /// The tag.
    pub tag: String,
    /// Its profile.
    pub profile: String,
    /// The method.
    pub method: String,
    /// What is added to its stamps, s.
    pub clock_shift_s: f64,
    /// What came of its packets.
    pub counts: TagCounts,
    /// First and last of each span of its own packet numbers.
    pub packet_numbers: Vec<(u64, u64)>,
    /// The last error of the estimator.
    pub last_error: Option<String>,
    /// What the method says of its run.
    pub method_report: serde_json::Value,
    /// Whether its profile has ranges judged for line of sight.
    pub judged: bool,
    /// What it sends, whom it hears, how that fits.
    pub heard: HearingReport,
}

impl Follower {
    /// A tag that was never heard of.
    pub fn new(profile: &Profile) -> Self {
        Self {
            profile: profile.name.as_str().into(),
            clock: TagClock::default(),
            numbers: Seen::default(),
            estimator: None,
            links: Links::default(),
            hearing: Hearing::default(),
            wired: None,
            told: None,
            applied: 0,
            held: 0,
            counts: TagCounts::default(),
            errors_in_a_row: 0,
            last_error: None,
        }
    }

    /// Its profile.
    pub fn profile(&self) -> &str {
        &self.profile
    }

    /// The last entry of the journal that it knows of.
    pub fn applied(&self) -> Position {
        self.applied
    }

    /// The last entry of the journal that the snapshot had which it was read back from; an entry may have several packets of a tag.
    pub fn held(&self) -> Position {
        self.held
    }

    /// As it is kept: without what all tags of a site have in common.
    pub fn kept(&self) -> Self {
        Self {
            profile: Arc::clone(&self.profile),
            clock: self.clock,
            numbers: self.numbers.clone(),
            estimator: self.estimator.clone().map(Estimator::detached),
            links: self.links.clone(),
            hearing: self.hearing.clone(),
            last_error: self.last_error.clone(),
            ..*self
        }
    }

    /// Gives one that was read back its site again; one whose profile has another method begins anew.
    pub fn attach(&mut self, profile: &Profile) {
        self.held = self.applied;
        let attached = self.estimator.as_mut().map(|estimator| estimator.attach(&profile.settings));
        if let Some(Err(error)) = attached {
            self.begin_anew(&error.to_string());
        }
    }

    /// Takes a packet; what is to be told of it goes to `told`, in order.
    pub fn take(
        &mut self,
        mut packet: Packet,
        at: &Arrival,
        (profile, scratch): (&Profile, &mut Scratch),
        told: &mut Vec<Input>,
    ) {
        if let Some(position) = at.position {
            self.applied = position;
        }
        if packet.number != 0 && !self.numbers.insert(packet.number) {
            self.counts.repeated_packets += 1;
            return;
        }
        self.counts.packets += 1;
        let tag = packet.tag.as_str();
        let newest = packet.observations.last().map(Observation::time);
        let verdict = newest.map(|newest| self.clock.judge(newest, at.arrived));
        let shift = self.clock.shift();
        let heard = newest.map_or(at.arrived, |newest| (newest + shift).min(at.arrived));
        told.push(Input::Heard(Heard {
            tag: tag.to_owned(),
            time: heard,
            gateway: Some(at.gateway.to_string()),
        }));
        if let Some(share) = packet.battery {
            let charge = Charge::Share(share);
            told.push(Input::Battery(Battery { tag: tag.to_owned(), time: heard, charge }));
        }
        if packet.distress {
            told.push(Input::Button(Button { tag: tag.to_owned(), time: heard }));
        }
        if let Some(model) = &profile.nlos {
            for observation in &mut packet.observations {
                if let Observation::Range(range) = observation {
                    self.counts.judged += u64::from(annotate(range, model, &mut self.links, scratch));
                }
            }
        }
        match verdict {
            Some(Verdict::OnTime(_)) => {
                let observations = packet.observations.into_iter();
                let upright = profile.sidecar.mounting.rotation.is_some();
                let turned: Vec<_> = observations.map(|o| profile.sidecar.apply(o)).collect();
                if let Some(motion) = motion::of_packet(turned.iter(), upright && profile.is_on_body()) {
                    let tag = tag.to_owned();
                    told.push(Input::Activity(adit_tracking::Activity { tag, time: heard, motion }));
                }
                self.follow(tag, turned, (shift, heard), profile, told);
            }
            Some(Verdict::Late(_)) => {
                self.counts.late_packets += 1;
                let turned = packet.observations.into_iter().map(|o| profile.sidecar.apply(o)).collect();
                self.follow(tag, turned, (shift, heard), profile, told);
            }
            None => {}
        }
    }

    /// Gives the observations to the estimator: their times by the shift of the clock, none later than `latest`.
    fn follow(
        &mut self,
        tag: &str,
        observations: Vec<Observation>,
        (shift, latest): (Interval, Time),
        profile: &Profile,
        told: &mut Vec<Input>,
    ) {
        let mut last = None;
        for observation in observations {
            let time = observation.time() + shift;
            if observation.kind().is_wired() {
                // Sensors of one tag go forward together; one of several kinds may speak at the same time.
                if self.wired.is_some_and(|wired| time < wired) {
                    self.counts.late_readings += 1;
                    continue;
                }
                self.wired = Some(time);
            }
            self.counts.observations += 1;
            self.hearing.hear(&observation, time.min(latest));
            let mut due = self.observe(&observation.at(time), profile);
            while let Some(solution) = due {
                if self.told.is_none_or(|told| solution.time - told >= FIX_EVERY) {
                    self.tell(tag, &solution, profile, told);
                    last = None;
                } else {
                    last = Some(solution);
                }
                due = self.next_due();
            }
        }
        if let Some(solution) = last {
            self.tell(tag, &solution, profile, told);
        }
        if let Some(estimator) = &self.estimator {
            self.hearing.weigh(estimator.sums());
        }
    }

    fn observe(&mut self, observation: &Observation, profile: &Profile) -> Option<Solution> {
        let observed = match &mut self.estimator {
            Some(estimator) => estimator.observe(observation),
            none => match Estimator::start(&profile.settings) {
                Ok(estimator) => none.insert(estimator).observe(observation),
                Err(error) => Err(error),
            },
        };
        match observed {
            Ok(solution) => {
                self.errors_in_a_row = 0;
                solution
            }
            Err(error) => {
                self.counts.refused += 1;
                self.errors_in_a_row += 1;
                self.last_error = Some(error.to_string());
                if self.errors_in_a_row >= MOST_ERRORS {
                    self.begin_anew(&error.to_string());
                }
                None
            }
        }
    }

    fn next_due(&mut self) -> Option<Solution> {
        match self.estimator.as_mut()?.next_due() {
            Ok(solution) => solution,
            Err(error) => {
                self.counts.refused += 1;
                self.last_error = Some(error.to_string());
                None
            }
        }
    }

    fn begin_anew(&mut self, why: &str) {
        self.estimator = None;
        self.errors_in_a_row = 0;
        self.counts.restarts += 1;
        self.last_error = Some(why.to_owned());
    }

    fn tell(&mut self, tag: &str, solution: &Solution, profile: &Profile, told: &mut Vec<Input>) {
        // Late observations may bring a solution of a time that was told already.
        if self.told.is_some_and(|before| solution.time <= before) {
            return;
        }
        let radius_95_m = solution.radius_95_m();
        if !radius_95_m.is_finite() || !solution.position_m.iter().all(|v| v.is_finite()) {
            return;
        }
        self.told = Some(solution.time);
        self.counts.fixes += 1;
        let speed_known =
            (0..2).all(|i| solution.covariance[(3 + i, 3 + i)] < SPEED_SIGMA_M_S * SPEED_SIGMA_M_S);
        told.push(Input::Fix(Fix {
            tag: tag.to_owned(),
            time: solution.time,
            position_m: GridPosition::from_raw(solution.position_m),
            velocity_m_s: (speed_known && solution.quality != Quality::Lost)
                .then(|| Vector::from_raw(solution.velocity_m_s)),
            radius_95_m,
            protection_level_m: solution.protection_level_m(),
            quality: solution.quality,
            moving: None,
            method: profile.method(),
        }));
    }

    /// First and last of each span of its own packet numbers that came.
    pub fn packets(&self) -> impl Iterator<Item = (u64, u64)> + '_ {
        self.numbers.spans()
    }

    /// How it is followed.
    pub fn health(&self, tag: &str, profile: &Profile) -> TagHealth {
        TagHealth {
            tag: tag.to_owned(),
            profile: self.profile.to_string(),
            method: profile.settings.name().to_owned(),
            clock_shift_s: self.clock.shift().seconds(),
            counts: self.counts,
            packet_numbers: self.numbers.spans().collect(),
            last_error: self.last_error.clone(),
            method_report: self.estimator.as_ref().map(Estimator::details).unwrap_or_default(),
            judged: profile.nlos.is_some(),
            heard: self
                .hearing
                .told(&self.estimator.as_ref().map(Estimator::last_weighed).unwrap_or_default()),
        }
    }
}

/// How a packet came.
#[derive(Debug, Clone)]
pub struct Arrival {
    /// When, by the server's clock.
    pub arrived: Time,
    /// Its entry in the journal, where the journal has it.
    pub position: Option<Position>,
    /// By which gateway.
    pub gateway: Arc<str>,
}
