//! What holds the place: each kind of observation against every hypothesis.

use super::aiding::Aiding;
use super::carrier::Carrier;
use super::follower::Follower;
use super::foot::Seen;
use super::method::FusedReport;
use crate::place::params::PlaceParams;
use crate::place::state::{Back, EAST, NORTH, State, Stretch, Taken, UP};
use crate::ranging::listener::Link;
use crate::ranging::{Ranged, RangingFix};
use crate::weighed::{SourceWeighed, Weighed, WeighedKind};
use adit_core::nalgebra::Vector3;
use adit_core::time::{Interval, Time};
use adit_observation::{FixSource, PositionFix};
use alloc::vec::Vec;

/// People climb no faster, m/s; a height that changes by more than this beside, m, is a door.
const CLIMB_M_S: f64 = 0.7;
const DOOR_M: f64 = 0.7;
/// A place that proved wrong without another to go to is wrong by about this, m.
const REOPENED_M: f64 = 10.0;
/// Epochs in a row that contradict the place, after which it is the place that is wrong.
const MOST_OUTLIERS: u32 = 4;
/// After so long without another range the place is dead reckoning.
const RANGED_HOLD: Interval = Interval::from_nanos(2_000_000_000);
/// And after so long without another position.
const FIX_HOLD: Interval = Interval::from_nanos(30_000_000_000);

impl Follower {
    /// An observation holds the place.
    pub(super) fn hold(&mut self, carrier: &Carrier, aiding: &Aiding, report: &mut FusedReport) {
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
            Aiding::Radio(_) if self.takes_signals_alone() => {}
            Aiding::Radio(fix) => {
                let way_m = self.trail.at(fix.time).unwrap_or_default().xy();
                let weighed = self.radio.as_mut().map(|radio| radio.weigh(fix, &way_m).0);
                self.hold_fix(carrier, &weighed.unwrap_or(**fix), &back, report);
            }
            Aiding::Fix(fix) => self.hold_fix(carrier, fix, &back, report),
            Aiding::Height { time, height_m } => self.hold_height(*time, *height_m, &back),
            Aiding::Sighting { time, reader } => {
                let Some(reader) = self.readers.get(*reader) else { return };
                // Uniform over the disc that it sees.
                let sigma_m = 0.5 * reader.range_m;
                let fix = PositionFix::level(*time, reader.position_m.xy(), sigma_m, FixSource::Rfid);
                self.hold_fix(carrier, &fix, &back, report);
            }
        }
    }

    /// A height by the barometer. Doors hold pressure: who passes one is told of a step that he did not climb.
    pub(super) fn hold_height(&mut self, time: Time, height_m: f64, back: &Back) {
        if let Some((before, from_m)) = self.height {
            let interval_s = (time - before).seconds();
            let step_m = height_m - from_m;
            if step_m.abs() > DOOR_M + CLIMB_M_S * interval_s {
                self.bank.walk(&Stretch::jump(step_m * step_m));
            }
        }
        self.height = Some((time, height_m));
        let sigma_m = self.params.barometer_sigma_m;
        self.bank.take(|state| state.see_height(height_m, sigma_m, &back.way_m), self.params.nis_bound);
    }

    /// A heading of a compass on a foot that stands.
    pub(super) fn hold_compass(&mut self, carrier: &mut Carrier, seen: &Seen, report: &mut FusedReport) {
        let Some(sigma_rad) = seen.sigma_rad else { return };
        self.walk(carrier);
        self.estimate = None;
        let Some(best) = self.bank.best() else { return };
        let bound = self.params.nis_bound;
        let offset_rad = seen.sighting.heading_offset_rad;
        let see = |state: &State| state.see_compass(offset_rad, seen.direction_rad, sigma_rad);
        let (known, expected) = (&best.state, see(&best.state));
        let expected_rad2 = (expected.jacobian * known.covariance * expected.jacobian.transpose())[(0, 0)];
        if let Some(taken) = self.bank.take(see, bound) {
            report.note(taken.nis, 1, taken.widened);
            carrier.note(seen, expected.residual[0], expected_rad2);
        }
    }

    /// A signal strength.
    pub(super) fn hold_signal(
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
            self.weighed.note(weighed((WeighedKind::Signal, transmitter), time, &taken));
            self.held_until = self.held_until.max(Some(time + FIX_HOLD));
        }
    }

    /// A position on the level.
    pub(super) fn hold_fix(
        &mut self,
        carrier: &Carrier,
        fix: &PositionFix,
        back: &Back,
        report: &mut FusedReport,
    ) {
        report.fixes += 1;
        if !self.is_placed() {
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
    pub(super) fn hold_ranges(
        &mut self,
        carrier: &Carrier,
        time: Time,
        links: &[Link],
        back: &Back,
        report: &mut FusedReport,
    ) {
        if !self.is_placed() {
            if let Some(fix) = self.position_of(links) {
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
                self.weighed.note(weighed((WeighedKind::Range, link.anchor), link.time, &taken));
                sum += taken.nis;
                count += 1;
            }
        }
        if count == 0 {
            return;
        }
        self.ranged_until = self.ranged_until.max(Some(time + RANGED_HOLD));
        self.held_until = self.held_until.max(self.ranged_until);
        let contradicts = sum > bound * f64::from(count);
        self.outliers = if contradicts { self.outliers + 1 } else { 0 };
        if self.outliers >= MOST_OUTLIERS {
            self.outliers = 0;
            self.reopen(links, back, report);
        }
    }

    /// Epoch after epoch contradicts the place.
    pub(super) fn reopen(&mut self, links: &[Link], back: &Back, report: &mut FusedReport) {
        report.reopened += 1;
        let Some(fix) = self.position_of(links) else {
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

    /// The last innovation of each anchor and transmitter, by their names.
    pub(super) fn last_weighed(&self) -> Vec<SourceWeighed> {
        self.weighed.named(|kind, number| match kind {
            WeighedKind::Range => {
                let anchor = self.ranges.as_ref().and_then(|ranges| ranges.anchors().get(number));
                anchor.map(|anchor| anchor.id.clone()).into_iter().collect()
            }
            WeighedKind::Signal => {
                self.signals.as_ref().map(|signals| signals.names_of(number)).unwrap_or_default()
            }
        })
    }

    /// What a range is uncertain of, m: noise that is of this one alone, and what it has in common with those before it.
    pub(super) fn sigma_of(&mut self, link: &Link) -> f64 {
        let slot = self.heard.iter_mut().find(|(anchor, _)| *anchor == link.anchor);
        let elapsed_s = if let Some((_, heard)) = slot {
            let elapsed_s = (link.time - *heard).seconds();
            *heard = link.time.max(*heard);
            elapsed_s
        } else {
            self.heard.push((link.anchor, link.time));
            f64::INFINITY
        };
        let elapsed_s = elapsed_s.max(1e-3);
        let PlaceParams { passing_sigma_m, passing_s, blocked_s, .. } = self.params;
        let blocked = 1.0 - link.line_of_sight.unwrap_or(1.0);
        let told = link.ranged.model.sigma_m;
        let alike = |time_s: f64| (2.0 * time_s / elapsed_s).max(1.0);
        let white = told * told * (1.0 - blocked + blocked * alike(blocked_s));
        libm::sqrt(white + passing_sigma_m * passing_sigma_m * alike(passing_s))
    }

    pub(super) fn position_of(&self, links: &[Link]) -> Option<RangingFix> {
        let ranged: Vec<Ranged> = links.iter().map(|link| link.ranged).collect();
        self.solver.solve(&ranged)
    }
}

/// For the account, what an update did with one of a source.
fn weighed(source: (WeighedKind, usize), time: Time, taken: &Taken) -> Weighed {
    Weighed::new(source, time, (taken.residual, taken.nis), taken.widened <= 1.0)
}
