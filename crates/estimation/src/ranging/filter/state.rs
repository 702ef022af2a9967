//! State and covariance, the motion between ranges, and the update by one range.

use super::motion::Motion;
use super::params::{ErrorParams, FilterParams};
use crate::kalman::dense::propagate;
use crate::ranging::listener::Link;
use adit_core::nalgebra::{Matrix3, SMatrix, SVector, Vector2, Vector3};
use adit_core::time::Time;
use serde::{Deserialize, Serialize};

/// Links whose offsets are estimated at once; the one that was heard least recently gives way to a further one.
pub const SLOTS: usize = 12;
/// Place, velocity, common offset, heading offset and scale of dead reckoning, two errors of each link.
pub const STATES: usize = 9 + 2 * SLOTS;

/// First of the three components of the velocity; the place is before it.
const VELOCITY: usize = 3;
/// What all ranges read too long, m.
const COMMON: usize = 6;
/// By how much dead reckoning is turned, rad.
const HEADING: usize = 7;
/// Metres walked for each metre reckoned.
const SCALE: usize = 8;
/// First of the constant errors of the links, m.
const CONSTANT: usize = 9;
/// First of those that pass, m.
const PASSING: usize = 9 + SLOTS;

/// Nearer to an anchor than this, m, a range has no direction any more.
const NEAREST_M: f64 = 0.05;

/// Normalised distance squared in place and velocity below which two estimates are one: χ² with six degrees of freedom, 1 %.
const SAME: f64 = 0.87;
/// An estimate that is surer than this, m, is not parted.
const LEAST_PARTED_M: f64 = 0.4;
/// β: how far both go, in standard deviations; what is left of the variance is 1 − β².
const PARTED: f64 = 0.9;
/// Any three anchors lie in a plane: the next ones may tell the sides apart.
const LEAST_MIRROR: f64 = 4.0;

type Vector = SVector<f64, STATES>;
type Covariance = SMatrix<f64, STATES, STATES>;

/// A link whose errors are estimated.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Slot {
    /// Which anchor, in the list of the site.
    anchor: usize,
    position_m: Vector3<f64>,
    /// Which of the tags of a carrier.
    tag: usize,
    heard: Time,
}

/// An offset and its standard deviation, m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OffsetFound {
    /// What ranges read too long, m.
    pub offset_m: f64,
    /// Its standard deviation, m.
    pub sigma_m: f64,
}

/// Estimate at a time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct State {
    pub time: Time,
    x: Vector,
    p: Covariance,
    slots: [Option<Slot>; SLOTS],
}

/// What a range says of the state before it is weighed.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Innovation {
    /// Measured minus predicted, m.
    pub value_m: f64,
    /// `H P Hᵀ`, m².
    pub predicted_m2: f64,
    /// What the range is uncertain of itself, and by the curvature of the sphere, m².
    pub noise_m2: f64,
    /// Which slot.
    pub slot: usize,
    /// Whether the slot was of another anchor before.
    pub fresh: bool,
    /// `P Hᵀ`.
    cross: Vector,
}

impl Innovation {
    /// S, m².
    pub fn variance_m2(&self) -> f64 {
        self.predicted_m2 + self.noise_m2
    }
}

impl State {
    /// At a place, going nowhere in particular; nothing is known of offsets but what is true of all radios.
    pub fn at(time: Time, place_m: Vector3<f64>, place_m2: &Matrix3<f64>, params: &FilterParams) -> Self {
        let (mut x, mut p) = (Vector::zeros(), Covariance::zeros());
        x.fixed_rows_mut::<3>(0).copy_from(&place_m);
        x[SCALE] = 1.0;
        p.fixed_view_mut::<3, 3>(0, 0).copy_from(place_m2);
        p[(COMMON, COMMON)] = square(params.errors.common_offset_sigma_m);
        let reckoning = &params.reckoning;
        p[(HEADING, HEADING)] = square(reckoning.heading_sigma_deg.to_radians());
        p[(SCALE, SCALE)] = square(reckoning.scale_sigma);
        let mut state = Self { time, x, p, slots: [None; SLOTS] };
        state.forget_velocity(params);
        state
    }

    /// Nothing is known of the velocity but how people move.
    fn forget_velocity(&mut self, params: &FilterParams) {
        for axis in VELOCITY..COMMON {
            self.x[axis] = 0.0;
            self.forget(axis);
        }
        let (level, climb) = (square(params.motion.speed_m_s), square(params.height.climb_m_s));
        self.p[(VELOCITY, VELOCITY)] = level;
        self.p[(VELOCITY + 1, VELOCITY + 1)] = level;
        self.p[(VELOCITY + 2, VELOCITY + 2)] = climb;
    }

    fn forget(&mut self, index: usize) {
        self.p.row_mut(index).fill(0.0);
        self.p.column_mut(index).fill(0.0);
    }

    /// Elsewhere, by a fit.
    pub fn moved_to(&mut self, place_m: &Vector3<f64>, place_m2: &Matrix3<f64>, params: &FilterParams) {
        self.x.fixed_rows_mut::<3>(0).copy_from(place_m);
        (0..3).for_each(|axis| self.forget(axis));
        self.p.fixed_view_mut::<3, 3>(0, 0).copy_from(place_m2);
        self.forget_velocity(params);
        // Where the place was wrong, what was learnt of the offsets there was wrong too.
        for index in (PASSING..STATES).chain(CONSTANT..PASSING).chain([COMMON]) {
            self.x[index] = 0.0;
            self.forget(index);
        }
        self.p[(COMMON, COMMON)] = square(params.errors.common_offset_sigma_m);
        self.slots = [None; SLOTS];
    }

    pub fn place_m(&self) -> Vector3<f64> {
        self.x.fixed_rows::<3>(0).into_owned()
    }

    pub fn velocity_m_s(&self) -> Vector3<f64> {
        self.x.fixed_rows::<3>(VELOCITY).into_owned()
    }

    /// Of place and velocity, m, m/s.
    pub fn motion_covariance(&self) -> SMatrix<f64, 6, 6> {
        self.p.fixed_view::<6, 6>(0, 0).into_owned()
    }

    pub fn place_covariance_m2(&self) -> Matrix3<f64> {
        self.p.fixed_view::<3, 3>(0, 0).into_owned()
    }

    pub fn is_finite(&self) -> bool {
        self.x.iter().all(|value| value.is_finite())
            && self.p.diagonal().iter().all(|value| value.is_finite() && *value >= 0.0)
    }

    pub fn common_offset(&self) -> OffsetFound {
        OffsetFound { offset_m: self.x[COMMON], sigma_m: root(self.p[(COMMON, COMMON)]) }
    }

    /// Constant offsets of the links in the slots, with the common one: anchor, tag, offset.
    pub fn offsets(&self) -> impl Iterator<Item = (usize, usize, OffsetFound)> {
        self.slots.iter().enumerate().filter_map(|(slot, held)| {
            let (held, index) = (held.as_ref()?, CONSTANT + slot);
            let variance = self.p[(COMMON, COMMON)] + 2.0 * self.p[(COMMON, index)] + self.p[(index, index)];
            let offset_m = self.x[COMMON] + self.x[index];
            Some((held.anchor, held.tag, OffsetFound { offset_m, sigma_m: root(variance) }))
        })
    }

    /// Mean height of the anchors in the slots, m.
    fn hung_m(&self) -> Option<f64> {
        let held = || self.slots.iter().flatten();
        let count = held().count();
        (count > 0).then(|| held().map(|slot| slot.position_m.z).sum::<f64>() / count as f64)
    }

    /// To a later time, by what is known of how people move; an earlier one changes nothing.
    pub fn propagate(&mut self, to: Time, params: &FilterParams) {
        let dt = (to - self.time).seconds();
        if dt <= 0.0 {
            return;
        }
        self.time = to;
        let motion = Motion::over(dt, params);
        let mean_m = params.height.mean_m(self.hung_m()).unwrap_or(self.x[2]);
        let [constant, passing] = self.fading(dt, &params.errors);
        let transition = |x: &Vector| {
            let mut next = *x;
            motion.level.apply(&mut next, 0);
            motion.level.apply(&mut next, 1);
            motion.vertical.apply(&mut next, 2);
            next.fixed_rows_mut::<SLOTS>(CONSTANT).scale_mut(constant);
            next.fixed_rows_mut::<SLOTS>(PASSING).scale_mut(passing);
            next
        };
        self.x[2] -= mean_m;
        self.x = transition(&self.x);
        self.x[2] += mean_m;
        propagate(&mut self.p, transition);
        for (axis, pair) in [(0, &motion.level), (1, &motion.level), (2, &motion.vertical)] {
            self.add_noise(axis, pair.noise);
        }
        self.fade(constant, passing, &params.errors);
    }

    /// To a later time, along a way that dead reckoning tells, m (east, north as it takes them): `p ← p + k R(δ) Δ`.
    ///
    /// Only the height moves by itself. The way is uncertain by `reckoning.way_share` of its length, and whoever stands shifts about.
    pub fn propagate_by(&mut self, way_m: &Vector2<f64>, to: Time, params: &FilterParams) {
        let dt = (to - self.time).seconds();
        if dt < 0.0 {
            return;
        }
        self.time = to;
        let motion = Motion::over(dt, params);
        let mean_m = params.height.mean_m(self.hung_m()).unwrap_or(self.x[2]);
        let [constant, passing] = self.fading(dt, &params.errors);
        let (sin, cos) = libm::sincos(self.x[HEADING]);
        let turned = Vector2::new(cos * way_m.x - sin * way_m.y, sin * way_m.x + cos * way_m.y);
        let scale = self.x[SCALE];
        let by_heading = Vector2::new(-turned.y, turned.x) * scale;
        let transition = |x: &Vector| {
            let mut next = *x;
            next[0] += by_heading.x * x[HEADING] + turned.x * x[SCALE];
            next[1] += by_heading.y * x[HEADING] + turned.y * x[SCALE];
            motion.vertical.apply(&mut next, 2);
            next.fixed_rows_mut::<SLOTS>(CONSTANT).scale_mut(constant);
            next.fixed_rows_mut::<SLOTS>(PASSING).scale_mut(passing);
            next
        };
        let way = turned * scale;
        self.x[0] += way.x;
        self.x[1] += way.y;
        self.x[2] -= mean_m;
        motion.vertical.apply(&mut self.x, 2);
        self.x[2] += mean_m;
        self.x.fixed_rows_mut::<SLOTS>(CONSTANT).scale_mut(constant);
        self.x.fixed_rows_mut::<SLOTS>(PASSING).scale_mut(passing);
        propagate(&mut self.p, transition);
        let reckoning = &params.reckoning;
        let level = square(reckoning.way_share * way.norm()) + square(reckoning.standing_m_sqrt_s) * dt;
        self.p[(0, 0)] += level;
        self.p[(1, 1)] += level;
        self.add_noise(2, motion.vertical.noise);
        self.p[(HEADING, HEADING)] += square(reckoning.heading_walk_deg_sqrt_s.to_radians()) * dt;
        self.fade(constant, passing, &params.errors);
        if dt > 0.0 {
            // The way tells how fast, not the state; it serves ranges that come a little late.
            let speed = way / dt;
            self.x[VELOCITY] = speed.x;
            self.x[VELOCITY + 1] = speed.y;
        }
    }

    fn add_noise(&mut self, axis: usize, [place, cross, velocity]: [f64; 3]) {
        self.p[(axis, axis)] += place;
        self.p[(axis, VELOCITY + axis)] += cross;
        self.p[(VELOCITY + axis, axis)] += cross;
        self.p[(VELOCITY + axis, VELOCITY + axis)] += velocity;
    }

    /// What is left of both errors of an anchor after a time.
    #[expect(clippy::unused_self, reason = "reads as the state's own")]
    fn fading(&self, dt: f64, errors: &ErrorParams) -> [f64; 2] {
        [errors.offset_s, errors.correlation_s].map(|time_s| libm::exp(-dt / time_s))
    }

    /// The variance that both errors of each anchor in a slot take up anew.
    fn fade(&mut self, constant: f64, passing: f64, errors: &ErrorParams) {
        let anew = |left: f64, sigma: f64| (1.0 - left * left) * sigma * sigma;
        for slot in (0..SLOTS).filter(|slot| self.slots[*slot].is_some()) {
            self.p[(CONSTANT + slot, CONSTANT + slot)] += anew(constant, errors.anchor_offset_sigma_m);
            self.p[(PASSING + slot, PASSING + slot)] += anew(passing, errors.passing_sigma_m);
        }
    }

    /// The slot of a link, which gets one where it has none, and whether that is new.
    fn slot(&mut self, link: &Link, tag: usize, errors: &ErrorParams) -> (usize, bool) {
        let same = |held: Slot| (held.anchor, held.tag) == (link.anchor, tag);
        let known = self.slots.iter().position(|held| held.is_some_and(same));
        let position_m = link.ranged.position_m;
        let fresh = Slot { anchor: link.anchor, position_m, tag, heard: link.time };
        if let Some(slot) = known {
            self.slots[slot] = Some(fresh);
            return (slot, false);
        }
        let oldest = (0..SLOTS).min_by_key(|slot| self.slots[*slot].map(|held| held.heard)).unwrap_or(0);
        self.slots[oldest] = Some(fresh);
        for (index, sigma) in
            [(CONSTANT + oldest, errors.anchor_offset_sigma_m), (PASSING + oldest, errors.passing_sigma_m)]
        {
            self.x[index] = 0.0;
            self.forget(index);
            self.p[(index, index)] = sigma * sigma;
        }
        (oldest, true)
    }

    /// Compares a range with the state.
    ///
    /// `r = ‖p − v a − p_i‖ + ½ tr(M P_pp) + b + c_i + n_i`, of a range that is a seconds older than the state; `M = (I − u uᵀ)/d`, the
    /// curvature of the sphere, whose second moment `½ tr(M P_pp M P_pp)` is noise (Athans, Wishner & Bertolini 1968; Jazwinski 1970, §9.3).
    pub fn compare(&mut self, link: &Link, tag: usize, params: &FilterParams) -> Innovation {
        let (slot, fresh) = self.slot(link, tag, &params.errors);
        let age = (self.time - link.time).seconds().max(0.0);
        let model = &link.ranged.model;
        let place = self.place_m() - self.velocity_m_s() * age;
        let away = place - link.ranged.position_m;
        let distance = away.norm().max(NEAREST_M);
        let toward = away / distance;
        let curvature = (Matrix3::identity() - toward * toward.transpose()) / distance;
        let bent = curvature * self.place_covariance_m2();
        let (bias, spread) = (0.5 * bent.trace(), 0.5 * (bent * bent).trace());
        let errors = [COMMON, CONSTANT + slot, PASSING + slot];
        let measured = (link.ranged.range_m - model.offset_m) / model.scale;
        let predicted = distance + bias + errors.iter().map(|index| self.x[*index]).sum::<f64>();
        // P Hᵀ of the few columns that count.
        let mut cross = Vector::zeros();
        for axis in 0..3 {
            cross += self.p.column(axis) * toward[axis];
            if age > 0.0 {
                cross -= self.p.column(VELOCITY + axis) * (toward[axis] * age);
            }
        }
        for index in errors {
            cross += self.p.column(index);
        }
        let mut seen = errors.iter().map(|index| cross[*index]).sum::<f64>();
        for axis in 0..3 {
            seen += toward[axis] * (cross[axis] - age * cross[VELOCITY + axis]);
        }
        let own = model.sigma_m / model.scale;
        // Part of what a device says of its ranges passes slowly, and is a state.
        let white =
            (own * own - square(params.errors.passing_sigma_m)).max(square(params.errors.least_sigma_m));
        Innovation {
            value_m: measured - predicted,
            predicted_m2: seen.max(0.0),
            noise_m2: white + spread,
            slot,
            fresh,
            cross,
        }
    }

    /// Update by a range whose innovation has this variance, m².
    pub fn correct(&mut self, innovation: &Innovation, variance_m2: f64) {
        let cross = &innovation.cross;
        self.x += cross * (innovation.value_m / variance_m2);
        for column in 0..STATES {
            let gain = cross[column] / variance_m2;
            for row in 0..=column {
                let value = self.p[(row, column)] - cross[row] * gain;
                self.p[(row, column)] = value;
                self.p[(column, row)] = value;
            }
        }
    }

    /// Whether it is the same estimate as another, in place and velocity.
    pub fn is_as(&self, other: &Self) -> bool {
        let away = (self.x - other.x).fixed_rows::<6>(0).into_owned();
        let both = self.motion_covariance() + other.motion_covariance();
        both.cholesky().is_some_and(|root| away.dot(&root.solve(&away)) < SAME)
    }

    /// Where the estimate lies across the plane, wall or row of its anchors, it goes to one side of it; the estimate on the other side.
    ///
    /// `x ± β P n/σ`, `P ← P − β² P n nᵀ P/σ²`, `σ² = nᵀ P n`, n the direction in which the place is most uncertain: the two have together the mean and the covariance of
    /// the one. Only where ranges to the anchors cannot tell the two apart.
    pub fn part(&mut self, errors: &ErrorParams) -> Option<Self> {
        if self.place_covariance_m2().trace() < LEAST_PARTED_M * LEAST_PARTED_M {
            return None;
        }
        let eigen = self.place_covariance_m2().symmetric_eigen();
        let at = eigen.eigenvalues.imax();
        let (normal, sigma) = (eigen.eigenvectors.column(at).into_owned(), root(eigen.eigenvalues[at]));
        if sigma < LEAST_PARTED_M {
            return None;
        }
        let mut along = Vector::zeros();
        for axis in 0..3 {
            along += self.p.column(axis) * normal[axis];
        }
        let step = along * (PARTED / sigma);
        let variance = square(errors.passing_sigma_m) + square(errors.anchor_offset_sigma_m);
        if !self.looks_alike(&step.fixed_rows::<3>(0).into_owned(), variance) {
            return None;
        }
        self.p -= step * step.transpose();
        let mut image = self.clone();
        // Down first: anchors hang above people.
        let down = if step[2] > 0.0 { -step } else { step };
        self.x += down;
        image.x -= down;
        Some(image)
    }

    /// Whether the places a step to both sides of the estimate have the same ranges to the anchors, and others than the estimate has: by more than this variance, m².
    fn looks_alike(&self, step_m: &Vector3<f64>, variance_m2: f64) -> bool {
        let [here, between, there] = [1.0, 0.0, -1.0].map(|share| self.place_m() + step_m * share);
        let held = || self.slots.iter().flatten();
        let count = held().count() as f64;
        let (mut apart, mut bent) = (0.0, 0.0);
        for slot in held() {
            let [here, between, there] = [here, between, there].map(|place| (place - slot.position_m).norm());
            apart += square(here - there) / count;
            bent += (0.5 * (here + there) - between) / count;
        }
        count >= LEAST_MIRROR && apart < variance_m2 && bent * bent > variance_m2
    }

    /// The place may be off by this, standard deviation, m, and the velocity is open.
    pub fn doubt(&mut self, sigma_m: f64, params: &FilterParams) {
        for axis in 0..3 {
            self.p[(axis, axis)] += sigma_m * sigma_m;
        }
        self.p[(VELOCITY, VELOCITY)] += square(params.motion.speed_m_s);
        self.p[(VELOCITY + 1, VELOCITY + 1)] += square(params.motion.speed_m_s);
    }

    /// The covariance of place and velocity grows by a factor, and so does what hangs together with it, by its root.
    pub fn fade_memory(&mut self, factor: f64) {
        let root = libm::sqrt(factor);
        for index in 0..COMMON {
            self.p.row_mut(index).scale_mut(root);
            self.p.column_mut(index).scale_mut(root);
        }
    }
}

fn square(value: f64) -> f64 {
    value * value
}

fn root(variance: f64) -> f64 {
    libm::sqrt(variance.max(0.0))
}
