//! A carrier followed on the map: every other observation holds what the carrier cannot know.
//!
//! ```text
//! carrier's solution → its way since the last one → every hypothesis moves along it (place::state)
//! ranges, fixes, heights, sightings → wait until the carrier has come to their time → held against where it was then (place::trail)
//! ```
//!
//! Before the first position the carrier walks in a frame of its own; where its direction on the map is unknown, the first positions against its way tell it (`pdr::search`).

use super::aiding::{Aiding, Waiting};
use super::carrier::Carrier;
use super::method::FusedReport;
use super::params::FusedParams;
use super::signals::Signals;
use crate::methods::MethodError;
use crate::methods::pdr::radio::RadioFixes;
use crate::methods::pdr::search::{FOUND_RAD, Found, Search, UNKNOWN_RAD};
use crate::place::bank::{Bank, BankParams, Estimate};
use crate::place::params::{CarrierNoise, PlaceParams};
use crate::place::state::Back;
use crate::place::state::{
    BAROMETER, CLOCK, COMMON, DRIFT, EAST, FACTOR, HEADING, HEARING, HeadingError, NORTH, State, Stretch,
    TURN, UP, Vector,
};
use crate::place::trail::Trail;
use crate::radio::AreaPrior;
use crate::radio::site::Reader;
use crate::ranging::listener::{Link, RangeListener};
use crate::ranging::solver::Solver;
use crate::ranging::{Ranged, RangingFix};
use adit_core::attitude;
use adit_core::nalgebra::{Matrix2, Vector2, Vector3};
use adit_core::solution::{Quality, Solution};
use adit_core::time::{Interval, Time};
use adit_observation::{FixSource, Observation, PositionFix, StartPose};
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// The name under which settings are refused.
use super::NAME;
/// The place filter moves no more often: what a carrier does within is a straight line to it.
const TICK: Interval = Interval::from_nanos(95_000_000);
/// The height is not known: standard deviation, m.
const ANY_HEIGHT_M: f64 = 1e3;
/// Positions over which the belief in them is learnt; its bounds; an outlier counts as no more than so many variances.
const BELIEF_FIXES: f64 = 30.0;
const BELIEF_LEAST: f64 = 0.02;
const BELIEF_MOST: f64 = 4.0;
const MOST_OFF: f64 = 9.0;
/// Height of a tag on a foot above the floor, m.
const FOOT_M: f64 = 0.1;
/// A place that proved wrong without another to go to is wrong by about this, m.
const REOPENED_M: f64 = 10.0;
/// A height that is known is known to this, m.
const LEAST_HEIGHT_M: f64 = 0.01;
/// A solution of a carrier after longer than this is a gap, s.
const GAP_S: f64 = 3.5;
/// Speed over a gap, standard deviation, m/s.
const GAP_SPEED_M_S: f64 = 1.0;
/// Epochs in a row that contradict the place, after which it is the place that is wrong.
const MOST_OUTLIERS: u32 = 4;
/// After so long without another range the place is dead reckoning.
const RANGED_HOLD: Interval = Interval::from_nanos(2_000_000_000);
/// And after so long without another position.
const FIX_HOLD: Interval = Interval::from_nanos(30_000_000_000);
/// First positions count as several where the walker has moved so far between them, m.
const APART_M: f64 = 0.5;
/// And after so long, s.
const APART_S: f64 = 1.0;

/// One tag on the map.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Follower {
    params: PlaceParams,
    noise: CarrierNoise,
    start: Option<StartPose>,
    starts_on_map: bool,
    mounted: bool,
    bank: Bank,
    /// What it said last.
    #[serde(skip)]
    estimate: Option<Estimate>,
    placed: bool,
    search: Option<Search>,
    searched: Option<(Time, Vector3<f64>)>,
    trail: Trail,
    waiting: Waiting,
    ranges: Option<RangeListener>,
    solver: Solver,
    /// Height of the tag on a level floor, and its standard deviation, m, where somebody told it.
    floor_m: Option<(f64, f64)>,
    radio: Option<RadioFixes>,
    signals: Option<Signals>,
    readers: Vec<Reader>,
    /// What the covariance of positions by radio is multiplied by, of each source.
    belief: [f64; FixSource::ALL.len()],
    /// Last time each link was heard, by anchor.
    heard: Vec<(usize, Time)>,
    /// The carrier's last solution, and where the bank has come to.
    reckoned: Option<Solution>,
    walked: Option<Walked>,
    /// Until when observations hold the place.
    held_until: Option<Time>,
    outliers: u32,
    /// Somebody who does not walk, and yet moves.
    rides: bool,
    pressure_pa: Option<f64>,
    told: Option<Time>,
    /// The bank has moved since it was asked.
    moved: bool,
}

/// Where the bank has come to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Walked {
    time: Time,
    way_m: Vector3<f64>,
    heading_rad2: f64,
}

impl Follower {
    /// Of a carrier with these settings.
    pub fn new(params: &FusedParams, carrier: &Carrier) -> Result<Self, MethodError> {
        let site = params.site.as_deref();
        let ranges = site
            .filter(|site| !site.anchors.is_empty())
            .map(|site| RangeListener::new(NAME, Some(site), params.ranges.clone()))
            .transpose()?;
        let mut radio = params.steps.clone();
        radio.site.clone_from(&params.site);
        let known = site.is_some_and(|site| site.has_signals());
        Ok(Self {
            params: params.place,
            noise: carrier.noise(params),
            start: params.start,
            starts_on_map: carrier.starts_on_map(params),
            mounted: carrier.is_mounted(params),
            bank: Bank::new(bank_params(params, carrier), site.and_then(|site| site.roadways.clone())),
            estimate: None,
            placed: false,
            search: None,
            searched: None,
            trail: Trail::default(),
            waiting: Waiting::default(),
            ranges,
            solver: Solver::new(params.solver, site),
            floor_m: params
                .solver
                .height_m
                .map(|height_m| (height_m, params.solver.height_sigma_m.max(LEAST_HEIGHT_M))),
            radio: if known { RadioFixes::new(&radio)? } else { None },
            signals: site.and_then(|site| Signals::new(site, &params.steps.radio)),
            readers: site.map(|site| site.readers.clone()).unwrap_or_default(),
            belief: [1.0; FixSource::ALL.len()],
            heard: Vec::new(),
            reckoned: None,
            walked: None,
            held_until: None,
            outliers: 0,
            rides: false,
            pressure_pa: None,
            told: None,
            moved: false,
        })
    }

    /// Whether there is anything that could ever place the walker on a map.
    fn has_map(&self) -> bool {
        self.start.is_some() || self.ranges.is_some() || self.radio.is_some() || !self.readers.is_empty()
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
                if let Some(radio) = &mut self.radio {
                    radio.observe(signal);
                }
                let (time, rssi_dbm) = (signal.time, signal.rssi_dbm);
                let known = self.signals.as_ref().and_then(|signals| signals.transmitter(signal));
                if let Some(transmitter) = known.filter(|_| signal.fault().is_none()) {
                    self.waiting.push(Aiding::Signal { time, transmitter, rssi_dbm }, report);
                }
            }
            Observation::Fix(fix) if fix.fault().is_none() => self.waiting.push(Aiding::Fix(*fix), report),
            Observation::Pressure(pressure) => {
                let first_pa = *self.pressure_pa.get_or_insert(pressure.pressure_pa);
                let height_m = height_by_pressure(pressure.pressure_pa, first_pa);
                self.waiting.push(Aiding::Height { time: pressure.time, height_m }, report);
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
        if let Some(radio) = &mut self.radio
            && !matches!(observation, Observation::Range(_))
        {
            while let Some(fix) = radio.due(observation.time()) {
                self.waiting.push(Aiding::Radio(fix), report);
            }
        }
    }

    /// After the last observation: what is left waits for nothing.
    pub fn finish(&mut self, report: &mut FusedReport) {
        while let Some(epoch) = self.ranges.as_mut().and_then(RangeListener::finish) {
            self.waiting.push(Aiding::Ranges(epoch), report);
        }
        while let Some(fix) = self.radio.as_mut().and_then(RadioFixes::finish) {
            self.waiting.push(Aiding::Radio(fix), report);
        }
        if let Some(ranges) = &self.ranges {
            report.ranges = Some(ranges.heard().clone());
        }
        if let Some(radio) = &self.radio {
            report.signals = Some(radio.report().clone());
        }
    }

    /// The carrier has come to a place in its own frame; gives where that is on the map.
    pub fn reckon(
        &mut self,
        carrier: &Carrier,
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
            self.moved = true;
        }
        while let Some(aiding) = self.waiting.pop(time) {
            self.hold(carrier, &aiding, report);
            self.moved = true;
        }
        self.tell()
    }

    /// The first solution of the carrier: by a start it stands on the map.
    fn begin(&mut self, carrier: &Carrier, first: &Solution) {
        let Some(start) = &self.start else { return };
        let [east, north] = start.position_sigma_m;
        let mut state = self.fresh(carrier, Matrix2::new(east * east, 0.0, 0.0, north * north));
        let sigma_rad = start.attitude_sigma_deg.to_radians();
        state.position_m = Vector3::new(start.position_m[0], start.position_m[1], 0.0);
        if !self.starts_on_map {
            state.turn_rad = start.heading_deg.to_radians() - attitude::heading(&first.attitude);
        }
        // A magnetometer knows better than who told, where it holds the heading.
        let known = if self.knows_direction(carrier) { self.noise.turn_sigma_rad } else { sigma_rad };
        state.forget(TURN, known * known);
        self.bank.start(state);
        self.placed = true;
    }

    /// Somewhere, in the direction of the carrier.
    fn fresh(&self, carrier: &Carrier, place_m2: Matrix2<f64>) -> State {
        let noise = &self.noise;
        let turn = if self.knows_direction(carrier) { noise.turn_sigma_rad } else { UNKNOWN_RAD };
        let mut sigmas = Vector::zeros();
        sigmas[UP] = ANY_HEIGHT_M;
        sigmas[TURN] = turn;
        sigmas[DRIFT] = if carrier.is_held_magnetic() { 0.0 } else { noise.drift_sigma_rad_s };
        sigmas[FACTOR] = noise.factor_sigma;
        sigmas[BAROMETER] = ANY_HEIGHT_M;
        sigmas[COMMON] = self.params.common_offset_sigma_m;
        sigmas[CLOCK] = self.params.clock_sigma_s;
        sigmas[HEARING] = self.params.hearing_sigma_db;
        let mut state = State::new(&sigmas.component_mul(&sigmas));
        state.spread(&place_m2);
        let heading = self.reckoned.as_ref().map_or(0.0, |now| now.covariance[(8, 8)]);
        if carrier.is_held_magnetic() {
            state.covariance[(HEADING, HEADING)] = heading;
        }
        state
    }

    fn knows_direction(&self, carrier: &Carrier) -> bool {
        carrier.is_magnetic() && self.mounted
    }

    /// The bank moves along the carrier's way to its last solution.
    fn walk(&mut self, carrier: &Carrier) {
        let Some(now) = &self.reckoned else { return };
        let heading_rad2 = now.covariance[(8, 8)];
        let to = Walked { time: now.time, way_m: now.position_m, heading_rad2 };
        let Some(from) = self.walked.replace(to) else { return };
        if !self.placed {
            return;
        }
        let (way_m, interval_s) = (to.way_m - from.way_m, (to.time - from.time).seconds());
        let (noise, length_m) = (&self.noise, way_m.xy().norm());
        let walk = |sigma: f64| sigma * sigma * length_m;
        let rest = |sigma: f64| sigma * sigma * interval_s;
        let heading = if carrier.is_held_magnetic() {
            let kept = libm::exp(-interval_s / noise.magnetic_s);
            HeadingError::Magnetic { variance_rad2: heading_rad2, kept }
        } else {
            let grown = (to.heading_rad2 - from.heading_rad2).max(0.0);
            HeadingError::Gyro { walk_rad2: grown + rest(noise.heading_walk_rad_sqrt_s) }
        };
        let gap_s = (interval_s - GAP_S).max(0.0);
        let moved = if self.rides { self.params.ride_m_s * interval_s } else { GAP_SPEED_M_S * gap_s };
        self.bank.walk(&Stretch {
            way_m,
            interval_s,
            along_m2: walk(noise.along_m_sqrt_m),
            across_m2: walk(noise.across_m_sqrt_m),
            up_m2: walk(noise.up_m_sqrt_m),
            about_m2: rest(noise.standing_m_sqrt_s) + moved * moved,
            heading,
            turn_rad2: walk(noise.turn_walk_rad_sqrt_m),
            factor2: walk(noise.factor_walk_sqrt_m),
            barometer_m2: rest(self.params.weather_m_sqrt_s),
        });
    }

    /// What the carrier did since a time; `None` where that is forgotten.
    fn back(&self, time: Time) -> Option<Back> {
        let now = self.reckoned.as_ref()?;
        let then = if time >= now.time { now.position_m } else { self.trail.at(time)? };
        Some(Back { way_m: now.position_m - then, velocity_m_s: self.trail.velocity_m_s(time) })
    }

    /// An observation holds the place.
    fn hold(&mut self, carrier: &Carrier, aiding: &Aiding, report: &mut FusedReport) {
        let Some(back) = self.back(aiding.time()) else {
            report.late += 1;
            return;
        };
        match aiding {
            Aiding::Ranges(epoch) => {
                let Some(listener) = &self.ranges else { return };
                let links: Vec<Link> = epoch.ranges.iter().filter_map(|range| listener.link(range)).collect();
                self.hold_ranges(carrier, epoch.time(), &links, &back, report);
            }
            Aiding::Signal { time, transmitter, rssi_dbm } => {
                self.hold_signal(*time, *transmitter, *rssi_dbm, &back, report);
            }
            // Once there is a place each signal is held against it by itself.
            Aiding::Radio(_) if self.placed && self.signals.is_some() => {}
            Aiding::Radio(fix) => {
                let way_m = self.trail.at(fix.time).unwrap_or_default().xy();
                let belief = self.belief[fix.source as usize];
                let fix = PositionFix { covariance_m2: fix.covariance_m2 * belief, ..*fix };
                self.learn(&fix, &back, belief);
                let weighed = self.radio.as_mut().map(|radio| radio.weigh(&fix, &way_m).0);
                self.hold_fix(carrier, &weighed.unwrap_or(fix), &back, report);
            }
            Aiding::Fix(fix) => self.hold_fix(carrier, fix, &back, report),
            Aiding::Height { height_m, .. } => {
                let sigma_m = self.params.barometer_sigma_m;
                self.bank
                    .take(|state| state.see_height(*height_m, sigma_m, &back.way_m), self.params.nis_bound);
            }
            Aiding::Sighting { time, reader } => {
                let Some(reader) = self.readers.get(*reader) else { return };
                // Uniform over the disc that it sees.
                let sigma_m = 0.5 * reader.range_m;
                let fix = PositionFix::level(*time, reader.position_m.xy(), sigma_m, FixSource::Rfid);
                self.hold_fix(carrier, &fix, &back, report);
            }
        }
    }

    /// A signal strength.
    fn hold_signal(
        &mut self,
        time: Time,
        transmitter: usize,
        rssi_dbm: f64,
        back: &Back,
        report: &mut FusedReport,
    ) {
        let way_m = self.trail.at(time).unwrap_or_default();
        let (Some(signals), Some(best)) = (&mut self.signals, self.bank.best()) else { return };
        let state = &best.state;
        let Some(expected) = signals.expect(transmitter, time, &way_m) else { return };
        let (emitter, sigma_db, new_db) = (expected.emitter, expected.sigma_db, expected.new_db);
        let seen = state.see_signal(&emitter, (rssi_dbm, sigma_db), &back.way_m);
        let of_place = (seen.jacobian * state.covariance * seen.jacobian.transpose())[(0, 0)]
            + seen.noise[(0, 0)]
            - sigma_db * sigma_db;
        signals.learn((transmitter, time, way_m), &expected, seen.residual[0], of_place);
        let bound = self.params.nis_bound;
        let taken =
            self.bank.take(|state| state.see_signal(&emitter, (rssi_dbm, new_db), &back.way_m), bound);
        if let Some(taken) = taken {
            report.note(taken.nis, 1, taken.widened);
            self.held_until = self.held_until.max(Some(time + FIX_HOLD));
        }
    }

    /// How much better or worse than they tell positions by radio are, from how they agree with where the walker was expected:
    /// a running mean of `(ν² − H P Hᵀ)/R` (Mehra 1972).
    fn learn(&mut self, fix: &PositionFix, back: &Back, belief: f64) {
        let Some(state) = self.bank.best().map(|best| &best.state).filter(|_| self.placed) else { return };
        let seen = state.see_place(&fix.level_m, &fix.covariance_m2, &back.way_m);
        let expected_m2 = state.position_covariance_m2();
        let known_m2 = expected_m2[(0, 0)] + expected_m2[(1, 1)];
        let told_m2 = fix.covariance_m2.trace();
        let off_m2 = seen.residual.norm_squared().min(MOST_OFF * told_m2);
        let shown = belief * (off_m2 - known_m2).max(0.0) / told_m2;
        let kept = 1.0 - 1.0 / BELIEF_FIXES;
        let next = kept * belief + (1.0 - kept) * shown;
        self.belief[fix.source as usize] = next.clamp(BELIEF_LEAST, BELIEF_MOST);
    }

    /// A position on the level.
    fn hold_fix(&mut self, carrier: &Carrier, fix: &PositionFix, back: &Back, report: &mut FusedReport) {
        report.fixes += 1;
        if !self.placed {
            let height = fix.height.map(|height| (height.up_m, height.sigma_m * height.sigma_m));
            self.place(carrier, fix.time, (&fix.level_m, &fix.covariance_m2, height), back);
            return;
        }
        let bound = 2.0 * self.params.nis_bound;
        let taken =
            self.bank.take(|state| state.see_place(&fix.level_m, &fix.covariance_m2, &back.way_m), bound);
        if let Some(taken) = taken {
            report.note(taken.nis, 2, taken.widened);
            self.held_until = self.held_until.max(Some(fix.time + FIX_HOLD));
        }
    }

    /// The ranges of an epoch, each by itself.
    fn hold_ranges(
        &mut self,
        carrier: &Carrier,
        time: Time,
        links: &[Link],
        back: &Back,
        report: &mut FusedReport,
    ) {
        if !self.placed {
            if let Some(fix) = self.position_of(links, None) {
                let level = fix.covariance_m2.fixed_view::<2, 2>(0, 0).into_owned();
                let height = Some((fix.position_m.z, fix.covariance_m2[(2, 2)]));
                self.place(carrier, time, (&fix.position_m.xy(), &level, height), back);
            }
            return;
        }
        let bound = self.params.nis_bound;
        if let Some((height_m, sigma_m)) = self.floor_m {
            let floor = Vector3::new(0.0, 0.0, height_m);
            self.bank.take(
                |state| state.see_along((&floor, &Vector3::z()), (0.0, sigma_m), &Vector3::zeros()),
                bound,
            );
        }
        let (mut sum, mut count) = (0.0, 0_u32);
        for link in links {
            let sigma_m = self.sigma_of(link);
            let anchor_m = link.ranged.position_m;
            let range_m = (link.ranged.range_m - link.ranged.model.offset_m) / link.ranged.model.scale;
            let taken = self.bank.take(|state| state.see_range(&anchor_m, (range_m, sigma_m), back), bound);
            if let Some(taken) = taken {
                report.note(taken.nis, 1, taken.widened);
                sum += taken.nis;
                count += 1;
            }
        }
        if count == 0 {
            return;
        }
        self.held_until = self.held_until.max(Some(time + RANGED_HOLD));
        self.outliers = if sum > bound * f64::from(count) { self.outliers + 1 } else { 0 };
        if self.outliers >= MOST_OUTLIERS {
            self.outliers = 0;
            self.reopen(links, back, report);
        }
    }

    /// Epoch after epoch contradicts the place.
    fn reopen(&mut self, links: &[Link], back: &Back, report: &mut FusedReport) {
        report.reopened += 1;
        let Some(fix) = self.position_of(links, None) else {
            self.bank.reopen(REOPENED_M, REOPENED_M, 0.0);
            return;
        };
        let Some(best) = self.bank.best() else { return };
        let mut state = best.state.clone();
        state.position_m += fix.position_m - state.before(&back.way_m);
        for axis in [EAST, NORTH, UP] {
            state.forget(axis, 0.0);
        }
        let mut block = state.covariance.fixed_view_mut::<3, 3>(EAST, EAST);
        block += fix.covariance_m2;
        self.bank.start(state);
    }

    /// What a range is uncertain of, m: noise that is of this one alone, and what it has in common with those before it.
    fn sigma_of(&mut self, link: &Link) -> f64 {
        let slot = self.heard.iter_mut().find(|(anchor, _)| *anchor == link.anchor);
        let elapsed_s = match slot {
            Some((_, heard)) => {
                let elapsed_s = (link.time - *heard).seconds();
                *heard = link.time.max(*heard);
                elapsed_s
            }
            None => {
                self.heard.push((link.anchor, link.time));
                f64::INFINITY
            }
        };
        let elapsed_s = elapsed_s.max(1e-3);
        let PlaceParams { passing_sigma_m, passing_s, blocked_s, .. } = self.params;
        let blocked = 1.0 - link.line_of_sight.unwrap_or(1.0);
        let told = link.ranged.model.sigma_m;
        let alike = |time_s: f64| (2.0 * time_s / elapsed_s).max(1.0);
        let white = told * told * (1.0 - blocked + blocked * alike(blocked_s));
        libm::sqrt(white + passing_sigma_m * passing_sigma_m * alike(passing_s))
    }

    fn position_of(&self, links: &[Link], expected: Option<&AreaPrior>) -> Option<RangingFix> {
        let ranged: Vec<Ranged> = links.iter().map(|link| link.ranged).collect();
        match expected {
            Some(_) => self.solver.solve_within(&ranged, expected),
            None => self.solver.solve(&ranged),
        }
    }

    /// A first position: the walker stands on the map once his direction is known.
    fn place(
        &mut self,
        carrier: &Carrier,
        time: Time,
        (level_m, covariance_m2, height): (&Vector2<f64>, &Matrix2<f64>, Option<(f64, f64)>),
        back: &Back,
    ) {
        let Some(now) = &self.reckoned else { return };
        let then = now.position_m - back.way_m;
        let direction_rad2 = if self.knows_direction(carrier) {
            now.covariance[(8, 8)] + self.noise.turn_sigma_rad * self.noise.turn_sigma_rad
        } else {
            UNKNOWN_RAD * UNKNOWN_RAD
        };
        let apart = self.searched.is_none_or(|(before, place_m)| {
            (then - place_m).xy().norm() > APART_M || (time - before).seconds() > APART_S
        });
        if !apart {
            return;
        }
        self.searched = Some((time, then));
        let fix = PositionFix {
            time,
            level_m: *level_m,
            covariance_m2: *covariance_m2,
            height: None,
            source: FixSource::Unknown,
        };
        let search = self.search.get_or_insert_default();
        search.observe(&fix, &then.xy());
        let known = direction_rad2 < FOUND_RAD * FOUND_RAD;
        if !(known || search.is_over(direction_rad2)) {
            return;
        }
        let found = search.found(&now.position_m.xy(), direction_rad2);
        let mut state = self.found(carrier, &found);
        if let Some((up_m, variance)) = height {
            state.position_m.z = up_m;
            state.forget(UP, variance);
        }
        self.bank.start(state);
        self.search = None;
        self.placed = true;
    }

    /// The state of somebody who was found.
    fn found(&self, carrier: &Carrier, found: &Found) -> State {
        let lever = found.lever_m;
        let across = Vector2::new(lever.y, -lever.x);
        let (direction, factor) = (found.direction_rad2, self.noise.factor_sigma * self.noise.factor_sigma);
        let place_m2 = Matrix2::identity() * found.mean_m2
            + across * across.transpose() * direction
            + lever * lever.transpose() * factor;
        let mut state = self.fresh(carrier, place_m2);
        state.position_m = Vector3::new(found.position_m.x, found.position_m.y, 0.0);
        state.turn_rad = found.turn_rad;
        // The error of the heading so far is part of the direction that was found.
        state.forget(HEADING, 0.0);
        state.forget(TURN, direction);
        for axis in [EAST, NORTH] {
            for (other, value) in [(TURN, across[axis] * direction), (FACTOR, lever[axis] * factor)] {
                state.covariance[(axis, other)] = value;
                state.covariance[(other, axis)] = value;
            }
        }
        state
    }

    /// Where the walker is now.
    fn tell(&mut self) -> Result<Option<Solution>, MethodError> {
        let Some(now) = &self.reckoned else { return Ok(None) };
        if self.told.is_some_and(|told| now.time <= told) {
            return Ok(None);
        }
        if !self.placed {
            if self.has_map() {
                return Ok(None);
            }
            self.told = Some(now.time);
            return Ok(Some(now.clone()));
        }
        if self.moved {
            self.moved = false;
            self.estimate = self.bank.estimate();
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
        solution.covariance.fixed_view_mut::<3, 3>(0, 0).copy_from(&estimate.covariance_m2);
        solution.covariance[(8, 8)] = state.direction_rad2();
        let fresh = self.held_until.is_some_and(|until| now.time <= until);
        solution.quality = match now.quality {
            Quality::Lost => Quality::Lost,
            _ if estimate.lost || solution.radius_95_m() > self.params.lost_m => Quality::Lost,
            _ if fresh => Quality::Fixed,
            _ => Quality::DeadReckoning,
        };
        self.told = Some(now.time);
        Ok(Some(solution))
    }
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
