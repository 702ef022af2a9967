//! How a walker comes onto the map: by a start, or by the first positions against his way.

use super::carrier::Carrier;
use super::follower::Follower;
use crate::methods::pdr::search::{FOUND_RAD, Found, UNKNOWN_RAD};
use crate::place::state::{
    BAROMETER, Back, CLOCK, COMMON, DRIFT, EAST, FACTOR, HEADING, HEARING, IRON, MISSED, NORTH, State, TURN,
    UP, Vector,
};
use adit_core::attitude;
use adit_core::nalgebra::{Matrix2, Matrix3, Vector2, Vector3};
use adit_core::solution::{Quality, Solution};
use adit_core::time::Time;
use adit_observation::{FixSource, PositionFix};
use serde::{Deserialize, Serialize};

/// The height is not known: standard deviation, m.
const ANY_HEIGHT_M: f64 = 1e3;
/// First positions count as several where the walker has moved so far between them, m.
const APART_M: f64 = 0.5;
/// And after so long, s.
const APART_S: f64 = 1.0;
/// A first position counts for so long, s.
const UNTURNED_S: f64 = 3.0;
/// Speed of who walks in an unknown direction, m/s.
const WALKING_M_S: f64 = 1.5;

/// The newest first position, while no direction is known.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Unturned {
    time: Time,
    place_m: Vector3<f64>,
    level_m2: Matrix2<f64>,
    up_m2: f64,
    /// The carrier's place in its own frame then, m.
    way_m: Vector3<f64>,
}

impl Follower {
    /// Where the walker is while nobody knows in which direction he goes: at the newest position, or as far from it as he has walked since.
    pub(super) fn tell_unturned(&self) -> Option<Solution> {
        let (now, unturned) = (self.reckoned.as_ref()?, self.unturned.as_ref()?);
        if (now.time - unturned.time).seconds() > UNTURNED_S {
            return None;
        }
        let walked_m = now.position_m - unturned.way_m;
        let Unturned { place_m, level_m2, up_m2, .. } = *unturned;
        let mut covariance = now.covariance;
        covariance.fixed_view_mut::<3, 9>(0, 0).fill(0.0);
        covariance.fixed_view_mut::<9, 3>(0, 0).fill(0.0);
        let level_m2 =
            level_m2 * self.params.stated_by_ranges + Matrix2::identity() * walked_m.xy().norm_squared();
        covariance.fixed_view_mut::<2, 2>(0, 0).copy_from(&level_m2);
        covariance[(2, 2)] = up_m2 + walked_m.z * walked_m.z;
        covariance
            .fixed_view_mut::<3, 3>(3, 3)
            .copy_from(&(Matrix3::identity() * (WALKING_M_S * WALKING_M_S)));
        covariance[(8, 8)] = UNKNOWN_RAD * UNKNOWN_RAD;
        let (position_m, velocity_m_s) = (place_m, Vector3::zeros());
        Some(Solution { position_m, velocity_m_s, covariance, quality: Quality::Fixed, ..now.clone() })
    }

    /// The first solution of the carrier: by a start it stands on the map.
    pub(super) fn begin(&mut self, carrier: &Carrier, first: &Solution) {
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
    }

    /// Somewhere, in the direction of the carrier.
    pub(super) fn fresh(&self, carrier: &Carrier, place_m2: Matrix2<f64>) -> State {
        let noise = &self.noise;
        let turn = if self.knows_direction(carrier) { noise.turn_sigma_rad } else { UNKNOWN_RAD };
        let mut sigmas = Vector::zeros();
        sigmas[UP] = ANY_HEIGHT_M;
        sigmas[TURN] = turn;
        sigmas[DRIFT] = if carrier.is_held_magnetic() { 0.0 } else { noise.drift_sigma_rad_m };
        sigmas[MISSED] = noise.missed_sigma;
        sigmas[IRON] = noise.iron_sigma_rad;
        sigmas[IRON + 1] = noise.iron_sigma_rad;
        sigmas[FACTOR] = noise.factor_sigma;
        sigmas[BAROMETER] = ANY_HEIGHT_M;
        sigmas[COMMON] = self.params.common_offset_sigma_m;
        sigmas[CLOCK] = self.params.clock_sigma_s;
        sigmas[HEARING] = self.params.hearing_sigma_db;
        let mut state = State::new(&sigmas.component_mul(&sigmas));
        state.spread(&place_m2);
        let heading = self.reckoned.as_ref().map_or(0.0, |now| now.covariance[(8, 8)]);
        if carrier.is_held_magnetic() {
            let least_rad2 = noise.magnetic_sigma_rad * noise.magnetic_sigma_rad;
            state.covariance[(HEADING, HEADING)] = heading.max(least_rad2);
        }
        state
    }

    pub(super) fn knows_direction(&self, carrier: &Carrier) -> bool {
        carrier.is_magnetic() && self.mounted
    }

    /// A first position: the walker stands on the map once his direction is known.
    pub(super) fn place(
        &mut self,
        carrier: &Carrier,
        time: Time,
        (level_m, covariance_m2, height): (&Vector2<f64>, &Matrix2<f64>, Option<(f64, f64)>),
        back: &Back,
    ) {
        let Some(now) = &self.reckoned else { return };
        let then = now.position_m - back.way_m;
        if let Some((up_m, up_m2)) = height.filter(|_| self.params.before_direction) {
            let place_m = level_m.push(up_m);
            self.unturned = Some(Unturned { time, place_m, level_m2: *covariance_m2, up_m2, way_m: then });
        }
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
        self.unturned = None;
        if self.takes_signals_alone()
            && let Some(radio) = &mut self.radio
        {
            radio.clear();
        }
    }

    /// The state of somebody who was found.
    pub(super) fn found(&self, carrier: &Carrier, found: &Found) -> State {
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
}
