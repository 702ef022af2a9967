//! A carrier followed on the map: every other observation holds what the carrier cannot know.
//!
//! ```text
//! carrier's solution → its way since the last one → every hypothesis moves along it (place::state)
//! ranges, fixes, heights, sightings → wait until the carrier has come to their time → held against where it was then (place::trail)
//! ```
//!
//! Before the first position the carrier walks in a frame of its own; where its direction on the map is unknown, the first positions against its way tell it (`pdr::search`).

use super::across::Across;
use super::aiding::{Aiding, Waiting};
use super::carrier::Carrier;
use super::ears::Ears;
use super::method::FusedReport;
use super::params::FusedParams;
use super::placing::Unturned;
use super::signals::Signals;
use crate::methods::MethodError;
use crate::methods::pdr::radio::RadioFixes;
use crate::methods::pdr::search::Search;
use crate::place::bank::{Bank, BankParams, Estimate};
use crate::place::params::{CarrierNoise, PlaceParams};
use crate::place::roadways::Roadways;
use crate::place::state::Back;
use crate::place::state::{HeadingError, Stretch};
use crate::place::trail::Trail;
use crate::radio::site::Reader;
use crate::ranging::listener::RangeListener;
use crate::ranging::solver::Solver;
use crate::weighed::LastWeighed;
use adit_core::attitude;
use adit_core::nalgebra::Vector3;
use adit_core::solution::{Quality, Solution};
use adit_core::time::{Interval, Time};
use adit_observation::{Observation, StartPose};
use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// The place filter moves no more often: what a carrier does within is a straight line to it.
pub(super) const TICK: Interval = Interval::from_nanos(95_000_000);
/// Heights are taken no more often, s: what the air errs lasts.
const HEIGHTS_S: f64 = 1.0;
/// Height of a tag on a foot above the floor, m.
const FOOT_M: f64 = 0.1;
/// A height that is known is known to this, m.
const LEAST_HEIGHT_M: f64 = 0.01;
/// A solution of a carrier after longer than this is a gap, s.
const GAP_S: f64 = 3.5;
/// Longest time between two moves of the place that is no hole in the log, s.
const HOLE_S: f64 = 0.3;
/// Within this a scan hears what the one before heard, m.
const SPOT_M: f64 = 5.0;
/// Speed over a gap, standard deviation, m/s.
const GAP_SPEED_M_S: f64 = 1.0;

/// One tag on the map.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Follower {
    pub(super) params: PlaceParams,
    pub(super) noise: CarrierNoise,
    pub(super) start: Option<StartPose>,
    pub(super) starts_on_map: bool,
    pub(super) mounted: bool,
    pub(super) bank: Bank,
    /// What it says, until it moves.
    pub(super) estimate: Option<Estimate>,
    /// How far across its roadway that may be.
    #[serde(default)]
    across: Option<Across>,
    pub(super) search: Option<Search>,
    pub(super) searched: Option<(Time, Vector3<f64>)>,
    /// When and where the last scan that told a position was, in the carrier's frame.
    #[serde(default)]
    pub(super) scanned: Option<(Time, Vector3<f64>)>,
    #[serde(default)]
    pub(super) unturned: Option<Unturned>,
    pub(super) trail: Trail,
    pub(super) waiting: Waiting,
    pub(super) ranges: Option<RangeListener>,
    pub(super) solver: Solver,
    /// Height of the tag on a level floor, and its standard deviation, m, where somebody told it.
    pub(super) floor_m: Option<(f64, f64)>,
    pub(super) radio: Option<Box<RadioFixes>>,
    pub(super) signals: Option<Signals>,
    pub(super) readers: Arc<[Reader]>,
    /// Last time each link was heard, by anchor.
    pub(super) heard: Vec<(usize, Time)>,
    /// The last innovation of each anchor and transmitter.
    #[serde(default)]
    pub(super) weighed: LastWeighed,
    /// The carrier's last solution, and where the bank has come to.
    pub(super) reckoned: Option<Solution>,
    pub(super) walked: Option<Walked>,
    /// Until when observations hold the place.
    pub(super) held_until: Option<Time>,
    /// And until when ranges do.
    pub(super) ranged_until: Option<Time>,
    pub(super) outliers: u32,
    pub(super) pressure_pa: Option<f64>,
    /// Time of the last pressure that was taken.
    pressed: Option<Time>,
    /// The last height by the barometer that was taken, m.
    pub(super) height: Option<(Time, f64)>,
    pub(super) told: Option<Time>,
}

/// Where the bank has come to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Walked {
    /// When.
    pub time: Time,
    /// The carrier's place in its own frame, m.
    pub way_m: Vector3<f64>,
    heading_rad2: f64,
    /// The carrier's heading when it stood last, rad.
    pub heading_rad: f64,
}

impl Walked {
    /// At a solution of the carrier, which stood last with this heading (rad).
    pub fn of(now: &Solution, heading_rad: f64) -> Self {
        Self { time: now.time, way_m: now.position_m, heading_rad2: now.covariance[(8, 8)], heading_rad }
    }
}

impl Follower {
    /// Of a carrier with these settings.
    pub fn new(params: &FusedParams, carrier: &Carrier) -> Result<Self, MethodError> {
        let site = params.site.as_deref();
        let ears = Ears::new(params)?;
        Ok(Self {
            params: params.place,
            noise: carrier.noise(params),
            start: params.start,
            starts_on_map: carrier.starts_on_map(params),
            mounted: carrier.is_mounted(params),
            bank: Bank::new(bank_params(params, carrier), roadways(params)),
            estimate: None,
            across: None,
            search: None,
            searched: None,
            scanned: None,
            unturned: None,
            trail: Trail::default(),
            waiting: Waiting::default(),
            ranges: ears.ranges.clone(),
            solver: Solver::new(params.solver, site),
            floor_m: params
                .solver
                .height_m
                .map(|height_m| (height_m, params.solver.height_sigma_m.max(LEAST_HEIGHT_M))),
            radio: ears.radio.clone().map(Box::new),
            signals: ears.signals.clone(),
            readers: Arc::clone(&ears.readers),
            heard: Vec::new(),
            weighed: LastWeighed::default(),
            reckoned: None,
            walked: None,
            held_until: None,
            ranged_until: None,
            outliers: 0,
            pressure_pa: None,
            pressed: None,
            height: None,
            told: None,
        })
    }

    /// Whether there is anything that could ever place the walker on a map.
    pub(super) fn has_map(&self) -> bool {
        self.start.is_some() || self.ranges.is_some() || self.radio.is_some() || !self.readers.is_empty()
    }

    /// Whether the walker stands on the map.
    pub(super) fn is_placed(&self) -> bool {
        self.bank.best().is_some()
    }

    /// Once there is a place each signal is held against it by itself, and nothing is made of scans.
    pub(super) fn takes_signals_alone(&self) -> bool {
        self.signals.is_some() && self.is_placed()
    }

    /// Whether a scan at this time is of the same spot as the last one that told a position.
    fn rests(&self, time: Time) -> bool {
        let (Some((before, there_m)), Some(now)) = (self.scanned, &self.reckoned) else { return false };
        let gone_m = (now.position_m - there_m).xy().norm();
        (time - before).seconds() < self.params.scan_rest_s && gone_m < SPOT_M
    }

    /// Takes what is not the carrier's own.
    #[inline]
    pub fn observe(&mut self, observation: &Observation, report: &mut FusedReport) {
        match observation {
            Observation::Range(_) => {
                if let Some(ranges) = &mut self.ranges {
                    ranges.observe(observation);
                }
            }
            Observation::Signal(signal) => {
                let left = self.takes_signals_alone() || self.rests(signal.time);
                if let Some(radio) = &mut self.radio {
                    if left {
                        radio.count(signal);
                    } else {
                        radio.observe(signal);
                    }
                }
                let (time, rssi_dbm) = (signal.time, signal.rssi_dbm);
                let known = self.signals.as_ref().and_then(|signals| signals.transmitter(signal));
                if let Some(transmitter) = known.filter(|_| signal.fault().is_none()) {
                    self.waiting.push(Aiding::Signal { time, transmitter, rssi_dbm }, report);
                }
            }
            Observation::Fix(fix) if fix.fault().is_none() => {
                self.waiting.push(Aiding::Fix(Box::new(*fix)), report);
            }
            Observation::Pressure(pressure) => {
                let first_pa = *self.pressure_pa.get_or_insert(pressure.pressure_pa);
                let soon = |before: Time| (pressure.time - before).seconds() < HEIGHTS_S;
                if !self.pressed.is_some_and(soon) {
                    self.pressed = Some(pressure.time);
                    let height_m = height_by_pressure(pressure.pressure_pa, first_pa);
                    self.waiting.push(Aiding::Height { time: pressure.time, height_m }, report);
                }
            }
            Observation::Sighting(sighting) => {
                let known = self.readers.iter().position(|reader| reader.id == sighting.reader.as_str());
                if let Some(reader) = known {
                    self.waiting.push(Aiding::Sighting { time: sighting.time, reader }, report);
                }
            }
            _ => {}
        }
        if let Some(ranges) = &mut self.ranges {
            if observation.kind().is_wired() {
                ranges.observe(observation);
            }
            while let Some(epoch) = ranges.pop() {
                self.waiting.push(Aiding::Ranges(epoch), report);
            }
        }
        let alone = self.takes_signals_alone();
        if let Some(radio) = &mut self.radio
            && !matches!(observation, Observation::Range(_))
            && !alone
        {
            while let Some(fix) = radio.due(observation.time()) {
                let way_m = self.reckoned.as_ref().map_or_else(Vector3::zeros, |now| now.position_m);
                self.scanned = Some((fix.time, way_m));
                self.waiting.push(Aiding::Radio(Box::new(fix)), report);
                if self.params.scan_rest_s > 0.0 {
                    // Of the next scan a part may be there.
                    radio.clear();
                }
            }
        }
    }

    /// After the last observation: what is left waits for nothing.
    pub fn finish(&mut self, report: &mut FusedReport) {
        while let Some(epoch) = self.ranges.as_mut().and_then(RangeListener::finish) {
            self.waiting.push(Aiding::Ranges(epoch), report);
        }
        while let Some(fix) = self.radio.as_mut().and_then(|radio| radio.finish()) {
            self.waiting.push(Aiding::Radio(Box::new(fix)), report);
        }
        report.ranges = self.ranges.as_ref().map(|ranges| ranges.heard().clone());
        report.signals = self.radio.as_ref().map(|radio| radio.report().clone());
    }

    /// Gives up what belongs to the site, until [`Self::attach`].
    pub fn detach(&mut self) {
        if let Some(ranges) = &mut self.ranges {
            ranges.detach();
        }
        if let Some(radio) = &mut self.radio {
            radio.detach();
        }
        if let Some(signals) = &mut self.signals {
            signals.detach();
        }
        self.readers = Arc::default();
    }

    /// Gives a follower that was read back its site again: that of the settings it began with, shared with others there.
    pub fn attach(&mut self, params: &FusedParams) -> Result<(), MethodError> {
        let ears = Ears::new(params)?;
        self.bank.attach(roadways(params));
        if let (Some(own), Some(shared)) = (&mut self.ranges, &ears.ranges) {
            own.share(shared);
        }
        if let (Some(own), Some(shared)) = (&mut self.radio, &ears.radio) {
            own.share(shared);
        }
        if let (Some(own), Some(shared)) = (&mut self.signals, &ears.signals) {
            own.share(shared);
        }
        self.readers = Arc::clone(&ears.readers);
        Ok(())
    }

    /// The carrier has come to a place in its own frame; gives where that is on the map.
    pub fn reckon(
        &mut self,
        carrier: &mut Carrier,
        now: Solution,
        report: &mut FusedReport,
    ) -> Result<Option<Solution>, MethodError> {
        let time = now.time;
        if self.reckoned.is_none() {
            self.begin(carrier, &now);
        }
        self.trail.push(time, now.position_m);
        let due = self.waiting.is_due(time);
        self.reckoned = Some(now);
        if due || self.walked.is_none_or(|walked| time - walked.time >= TICK) {
            self.walk(carrier);
            self.estimate = None;
        }
        if self.is_placed() {
            carrier.hand_over();
        }
        if let Some(seen) = carrier.seen() {
            self.hold_compass(carrier, &seen, report);
        }
        while let Some(aiding) = self.waiting.pop(time) {
            self.hold(carrier, &aiding, report);
            self.estimate = None;
        }
        self.tell()
    }

    /// The bank moves along the carrier's way to its last solution.
    pub(super) fn walk(&mut self, carrier: &Carrier) {
        let Some(now) = &self.reckoned else { return };
        let to = Walked::of(now, carrier.heading_rad());
        let Some(from) = self.walked.replace(to) else { return };
        if !self.is_placed() {
            return;
        }
        let stretch = self.stretch(carrier, &from, &to);
        self.bank.walk(&stretch);
    }

    /// The carrier's way between two places, and how it errs.
    pub(super) fn stretch(&self, carrier: &Carrier, from: &Walked, to: &Walked) -> Stretch {
        let (way_m, interval_s) = (to.way_m - from.way_m, (to.time - from.time).seconds());
        let (noise, length_m) = (&self.noise, way_m.xy().norm());
        let walk = |sigma: f64| sigma * sigma * length_m;
        let rest = |sigma: f64| sigma * sigma * interval_s;
        let heading = if carrier.is_held_magnetic() {
            let kept = libm::exp(-interval_s / noise.magnetic_s);
            let least_rad2 = noise.magnetic_sigma_rad * noise.magnetic_sigma_rad;
            HeadingError::Magnetic { variance_rad2: to.heading_rad2.max(least_rad2), kept }
        } else {
            // What a stride adds is in the noise by the way; what a hole in the log adds is not.
            let hole = if interval_s > HOLE_S { to.heading_rad2 - from.heading_rad2 } else { 0.0 };
            HeadingError::Gyro { walk_rad2: hole.max(0.0) + rest(noise.heading_walk_rad_sqrt_s) }
        };
        let gap_s = (interval_s - GAP_S).max(0.0);
        let moved = GAP_SPEED_M_S * gap_s;
        Stretch {
            way_m,
            drifting: length_m,
            turned_rad: attitude::angle_difference(to.heading_rad, from.heading_rad),
            along_m2: walk(noise.along_m_sqrt_m),
            across_m2: walk(noise.across_m_sqrt_m),
            up_m2: walk(noise.up_m_sqrt_m),
            about_m2: rest(noise.standing_m_sqrt_s) + moved * moved,
            heading,
            turn_rad2: walk(noise.turn_walk_rad_sqrt_m),
            drift2: walk(noise.drift_walk_rad_m_sqrt_m),
            iron_rad2: walk(noise.iron_walk_rad_sqrt_m),
            factor2: walk(noise.factor_walk_sqrt_m),
            barometer_m2: rest(self.params.weather_m_sqrt_s),
        }
    }

    /// What the carrier did since a time; `None` where that is forgotten.
    pub(super) fn back(&self, time: Time) -> Option<Back> {
        let now = self.reckoned.as_ref()?;
        let then = if time >= now.time { now.position_m } else { self.trail.at(time)? };
        Some(Back { way_m: now.position_m - then, velocity_m_s: self.trail.velocity_m_s(time) })
    }

    /// Where the walker is now.
    fn tell(&mut self) -> Result<Option<Solution>, MethodError> {
        let Some(now) = &self.reckoned else { return Ok(None) };
        if self.told.is_some_and(|told| now.time <= told) {
            return Ok(None);
        }
        if !self.is_placed() {
            let told = if self.has_map() { self.tell_unturned() } else { Some(now.clone()) };
            self.told = told.as_ref().map(|told| told.time).or(self.told);
            return Ok(told);
        }
        if self.estimate.is_none() {
            self.estimate = self.bank.estimate();
            self.across = self.estimate.and_then(|estimate| self.across(&estimate, now.time));
        }
        let (Some(estimate), Some(best)) = (self.estimate, self.bank.best()) else { return Ok(None) };
        let state = &best.state;
        if !state.is_finite() {
            return Err(MethodError::Diverged { time: now.time });
        }
        let since_m = self.walked.map_or_else(Vector3::zeros, |walked| now.position_m - walked.way_m);
        let mut solution = now.clone();
        solution.position_m = estimate.position_m + state.on_map(&since_m);
        solution.velocity_m_s = state.on_map(&now.velocity_m_s);
        solution.attitude = attitude::exp(&(Vector3::z() * -state.turn_rad)) * now.attitude;
        solution.covariance.fixed_view_mut::<3, 9>(0, 0).fill(0.0);
        solution.covariance.fixed_view_mut::<9, 3>(0, 0).fill(0.0);
        let ranged = self.ranged_until.is_some_and(|until| now.time <= until);
        let stated = if ranged { self.params.stated_by_ranges } else { 1.0 };
        let mut place_m2 = estimate.covariance_m2 * stated;
        if let Some(across) = &self.across {
            across.widen(&mut place_m2);
        }
        solution.covariance.fixed_view_mut::<3, 3>(0, 0).copy_from(&place_m2);
        solution.covariance[(8, 8)] = state.direction_rad2();
        let fresh = self.held_until.is_some_and(|until| now.time <= until);
        solution.quality = match now.quality {
            Quality::Lost => Quality::Lost,
            _ if solution.radius_95_m() > self.params.lost_m => Quality::Lost,
            // Off the map, but where ranges say: a chamber that the map lacks, a heading driven last week.
            _ if estimate.lost && !ranged => Quality::Lost,
            _ if fresh => Quality::Fixed,
            _ => Quality::DeadReckoning,
        };
        self.told = Some(now.time);
        Ok(Some(solution))
    }
}

/// The roadways that hold the walker, where the settings let them.
fn roadways(params: &FusedParams) -> Option<Arc<Roadways>> {
    params.site.as_ref().filter(|_| params.place.roadways)?.roadways.clone()
}

/// How the bank takes this carrier's way, and how high its tag is.
fn bank_params(params: &FusedParams, carrier: &Carrier) -> BankParams {
    let PlaceParams { above_floor_m, above_floor_sigma_m, .. } = params.place;
    match carrier {
        Carrier::Foot(_) | Carrier::Marg(_) => {
            BankParams { tag_height_m: FOOT_M, tag_height_sigma_m: FOOT_M, ..BankParams::default() }
        }
        Carrier::Steps(_) => BankParams {
            tag_height_m: above_floor_m,
            tag_height_sigma_m: above_floor_sigma_m,
            level_way: true,
            ..BankParams::default()
        },
    }
}

/// Height over that of a first pressure, m, in the standard atmosphere: `h = (T₀/L) (1 − (p/p₁)^(R L / g M))` about 15 °C (ISO 2533).
fn height_by_pressure(pressure_pa: f64, first_pa: f64) -> f64 {
    const SCALE_M: f64 = 288.15 / 0.0065;
    const EXPONENT: f64 = 0.190_263;
    SCALE_M * (1.0 - libm::pow(pressure_pa / first_pa, EXPONENT))
}
