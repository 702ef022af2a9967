//! One hypothesis of where somebody is: state, covariance, and what each kind of observation does to them.
//!
//! ```text
//! x = [ p 3 | ψ | η | ρ | κ | b | c | τ | o | i 2 | s ]
//! p ← p + (κ R(ψ + η) Δ_level, Δ_up),   R(θ) = |  cos θ  sin θ |    (θ clockwise, as headings are)
//!                                             | −sin θ  cos θ |
//! η ← η + ρ Δt + s Δθ                           while the gyro alone holds the heading; for a foot Δt is the way, in m
//! η ← η exp(−Δt/T)                              while a magnetometer holds it
//! ```
//!
//! Δ is the way of the carrier in its own frame, ψ the angle that its frame is turned by, η the error of its heading, ρ the rate at which that drifts, κ the factor of its
//! lengths, b what the barometer's height reads too much, c what all ranges read too long, τ by how much their stamps are late, o by how much the tag hears every
//! signal too strong, i what iron that goes with the tag (and the tilt that nobody sees) turns its compass by where it points ahead and to the left,
//! s by what share the gyro turns too little, Δθ the turn of the carrier. Zero velocity makes all of a strapdown but position and heading observable
//! (Nilsson, Zachariah, Skog & Händel 2013): these states are what is left. The error is truth minus estimate.
//!
//! An observation that is older than the state sees `p − κ R(ψ + η) Δ'`, Δ' the way since: the errors of ψ, η and κ are in it, no history is kept.

use super::motion::Motion;
pub use super::stretch::{HeadingError, Stretch};
use crate::kalman::dense::propagate;
use crate::radio::Emitter;
use crate::radio::path_loss::{fall_db, mean_of_square_dbm};
use adit_core::attitude::angle_difference;
use adit_core::nalgebra::{Matrix2, Matrix3, SMatrix, SVector, Vector2, Vector3};
use serde::{Deserialize, Serialize};

/// States of the error.
pub const STATES: usize = 14;
/// East, the first of three components of the position.
pub const EAST: usize = 0;
/// North.
pub const NORTH: usize = 1;
/// Up.
pub const UP: usize = 2;
/// ψ: by how much the carrier's frame is turned, rad.
pub const TURN: usize = 3;
/// η: error of the carrier's heading, rad.
pub const HEADING: usize = 4;
/// ρ: how that drifts, rad for each unit of [`Stretch::drifting`].
pub const DRIFT: usize = 5;
/// κ: metres walked for each metre of the carrier's.
pub const FACTOR: usize = 6;
/// b: what the height by the barometer reads too much, m.
pub const BAROMETER: usize = 7;
/// c: what all ranges read too long, m.
pub const COMMON: usize = 8;
/// τ: by how much ranges are stamped late, s.
pub const CLOCK: usize = 9;
/// o: by how much the tag hears every signal too strong, dB.
pub const HEARING: usize = 10;
/// i: what goes with the tag ahead turns its compass by, rad: the first of two, the second is to the left.
pub const IRON: usize = 11;
/// s: share of every turn that the gyro misses.
pub const MISSED: usize = 13;

/// The factor stays a factor.
const FACTORS: (f64, f64) = (0.3, 3.0);
/// Nearer to an anchor than this, m, a range has no direction any more.
const NEAREST_M: f64 = 0.05;

/// An error state.
pub type Vector = SVector<f64, STATES>;
/// Its covariance.
pub type Covariance = SMatrix<f64, STATES, STATES>;

/// A measurement, linearised: `residual = h · δx + noise`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen<const M: usize> {
    /// Measured minus predicted.
    pub residual: SVector<f64, M>,
    /// Derivative by the error state, a row each.
    pub jacobian: SMatrix<f64, M, STATES>,
    /// Covariance of the noise.
    pub noise: SMatrix<f64, M, M>,
}

/// What the carrier did since an observation.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Back {
    /// Its way since, in its own frame, m.
    pub way_m: Vector3<f64>,
    /// Its velocity at the time of the observation, m/s.
    pub velocity_m_s: Vector3<f64>,
}

/// An expected distance.
struct Sphere {
    expected_m: f64,
    spread_m2: f64,
    jacobian: SMatrix<f64, 1, STATES>,
}

/// What an update did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Taken {
    /// Measured less expected, the first of them.
    pub residual: f64,
    /// Normalised innovation squared, before any widening.
    pub nis: f64,
    /// Logarithm of the likelihood, of a Student distribution where the update was robust.
    pub log_likelihood: f64,
    /// By what the noise was widened, 1 or more.
    pub widened: f64,
}

/// State and covariance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// East, north, up, m.
    pub position_m: Vector3<f64>,
    /// ψ + η, rad clockwise.
    pub turn_rad: f64,
    /// The part of it that is η, rad: what drifted, and what corrections gave to it.
    pub heading_rad: f64,
    /// ρ, rad/s or rad/m.
    pub drift_rad: f64,
    /// κ.
    pub factor: f64,
    /// b, m.
    pub barometer_m: f64,
    /// c, m.
    pub common_m: f64,
    /// τ, s.
    pub clock_s: f64,
    /// o, dB.
    pub hearing_db: f64,
    /// i, rad.
    pub iron_rad: Vector2<f64>,
    /// s.
    pub missed: f64,
    /// Covariance of the error.
    pub covariance: Covariance,
}

impl State {
    /// At the origin of nowhere: all variances as given (m, rad, rad/s or rad/m, 1, m, m, s, dB, rad, 1; squared).
    pub fn new(variances: &Vector) -> Self {
        Self {
            position_m: Vector3::zeros(),
            turn_rad: 0.0,
            heading_rad: 0.0,
            drift_rad: 0.0,
            factor: 1.0,
            barometer_m: 0.0,
            common_m: 0.0,
            clock_s: 0.0,
            hearing_db: 0.0,
            iron_rad: Vector2::zeros(),
            missed: 0.0,
            covariance: Covariance::from_diagonal(variances),
        }
    }

    /// A way of the carrier as it is on the map, less its errors: turned and stretched, m.
    pub fn on_map(&self, way_m: &Vector3<f64>) -> Vector3<f64> {
        let (sin, cos) = libm::sincos(self.turn_rad);
        let (east, north) = (cos * way_m.x + sin * way_m.y, cos * way_m.y - sin * way_m.x);
        Vector3::new(self.factor * east, self.factor * north, way_m.z)
    }

    /// Where somebody was before this way of the carrier, m.
    pub fn before(&self, way_m: &Vector3<f64>) -> Vector3<f64> {
        self.position_m - self.on_map(way_m)
    }

    /// Moves along a stretch; gives the displacement, m.
    pub fn walk(&mut self, stretch: &Stretch) -> Vector3<f64> {
        self.walk_along(stretch, None)
    }

    /// The same of somebody on a roadway in this direction (unit vector, either sense): the covariance is that of a way along it.
    ///
    /// Taken at the estimated direction, an error of the heading would make the length of the way seem to be seen across the roadway; and always too short, for what zigzags
    /// fits better when it shrinks (an inconsistent linearisation as in Huang, Mourikis & Roumeliotis 2010).
    pub fn walk_along(&mut self, stretch: &Stretch, roadway: Option<&Vector2<f64>>) -> Vector3<f64> {
        let motion = Motion::new(self, stretch, roadway);
        let turned_rad = motion.turned_rad(self);
        self.position_m += motion.walked_m;
        self.turn_rad += turned_rad;
        self.heading_rad += turned_rad;
        propagate(&mut self.covariance, |error| motion.carry(error));
        motion.spread(&mut self.covariance);
        motion.walked_m
    }

    /// Adds to the covariance of the level position, m².
    pub fn spread(&mut self, covariance_m2: &Matrix2<f64>) {
        let mut block = self.covariance.fixed_view_mut::<2, 2>(EAST, EAST);
        block += covariance_m2;
    }

    /// Derivative of the position before a way of the carrier by the error state: 3×14.
    fn before_by(&self, way_m: &Vector3<f64>) -> SMatrix<f64, 3, STATES> {
        let since = self.on_map(way_m);
        let mut by = SMatrix::<f64, 3, STATES>::zeros();
        by.fixed_view_mut::<3, 3>(0, EAST).copy_from(&Matrix3::identity());
        for (axis, turned) in [(EAST, since.y), (NORTH, -since.x)] {
            by[(axis, TURN)] = -turned;
            by[(axis, HEADING)] = -turned;
            by[(axis, FACTOR)] = -since[axis] / self.factor;
        }
        by
    }

    /// A position on the level, m, with its covariance, m², from before `way_m`.
    pub fn see_place(
        &self,
        place_m: &Vector2<f64>,
        covariance_m2: &Matrix2<f64>,
        way_m: &Vector3<f64>,
    ) -> Seen<2> {
        Seen {
            residual: place_m - self.before(way_m).xy(),
            jacobian: self.before_by(way_m).fixed_rows::<2>(0).into_owned(),
            noise: *covariance_m2,
        }
    }

    /// How far along a direction (unit vector) the position before `way_m` lies from a point, m; it is known to be `value_m` by `sigma_m`.
    pub fn see_along(
        &self,
        (point_m, direction): (&Vector3<f64>, &Vector3<f64>),
        (value_m, sigma_m): (f64, f64),
        way_m: &Vector3<f64>,
    ) -> Seen<1> {
        let predicted = direction.dot(&(self.before(way_m) - point_m));
        Seen {
            residual: SVector::<f64, 1>::new(value_m - predicted),
            jacobian: direction.transpose() * self.before_by(way_m),
            noise: SMatrix::<f64, 1, 1>::new(sigma_m * sigma_m),
        }
    }

    /// A height by the barometer, m.
    pub fn see_height(&self, height_m: f64, sigma_m: f64, way_m: &Vector3<f64>) -> Seen<1> {
        let mut seen =
            self.see_along((&Vector3::zeros(), &Vector3::z()), (height_m - self.barometer_m, sigma_m), way_m);
        seen.jacobian[(0, BAROMETER)] = 1.0;
        seen
    }

    /// What a compass adds to the heading of the carrier, rad: `ψ + η − i_x sin θ + i_y cos θ`, θ the direction of its body from magnetic north.
    ///
    /// A field m that goes with the tag lies at `(m_x sin θ − m_y cos θ)` to the magnetic east, by which over the horizontal field the needle turns clockwise.
    pub fn see_compass(&self, offset_rad: f64, direction_rad: f64, sigma_rad: f64) -> Seen<1> {
        let (sin, cos) = libm::sincos(direction_rad);
        let predicted = self.turn_rad - self.iron_rad.x * sin + self.iron_rad.y * cos;
        let mut jacobian = SMatrix::<f64, 1, STATES>::zeros();
        jacobian[(0, TURN)] = 1.0;
        jacobian[(0, HEADING)] = 1.0;
        jacobian[(0, IRON)] = -sin;
        jacobian[(0, IRON + 1)] = cos;
        Seen {
            residual: SVector::<f64, 1>::new(angle_difference(offset_rad, predicted)),
            jacobian,
            noise: SMatrix::<f64, 1, 1>::new(sigma_rad * sigma_rad),
        }
    }

    /// A range to an anchor, m: `r = ‖p − v τ − a‖ + ½ tr(M P) + c + e`.
    ///
    /// `M = (I − u uᵀ)/d` is the curvature of the sphere; its second moment `½ tr(M P M P)` is noise (Jazwinski 1970, §9.3).
    pub fn see_range(&self, anchor_m: &Vector3<f64>, (range_m, sigma_m): (f64, f64), back: &Back) -> Seen<1> {
        let sphere = self.sphere(anchor_m, back);
        let mut jacobian = sphere.jacobian;
        jacobian[(0, COMMON)] = 1.0;
        Seen {
            residual: SVector::<f64, 1>::new(range_m - sphere.expected_m - self.common_m),
            jacobian,
            noise: SMatrix::<f64, 1, 1>::new(sigma_m * sigma_m + sphere.spread_m2),
        }
    }

    /// The difference of two ranges, to the first anchor less to the second, m.
    pub fn see_difference(
        &self,
        [first_m, second_m]: [&Vector3<f64>; 2],
        (difference_m, sigma_m): (f64, f64),
        back: &Back,
    ) -> Seen<1> {
        let (first, second) = (self.sphere(first_m, back), self.sphere(second_m, back));
        Seen {
            residual: SVector::<f64, 1>::new(difference_m - (first.expected_m - second.expected_m)),
            jacobian: first.jacobian - second.jacobian,
            noise: SMatrix::<f64, 1, 1>::new(sigma_m * sigma_m + first.spread_m2 + second.spread_m2),
        }
    }

    /// A signal strength, dBm: `P(‖p − a‖) + o + e`, P the path loss, over a level distance and a height above the tag.
    ///
    /// Near the transmitter the logarithm bends; what is not known of the place smooths it, and its second moment is noise.
    pub fn see_signal(
        &self,
        emitter: &Emitter,
        (rssi_dbm, sigma_db): (f64, f64),
        way_m: &Vector3<f64>,
    ) -> Seen<1> {
        let away = self.before(way_m).xy() - emitter.position_m.xy();
        let spread_m2 = self.covariance.fixed_view::<2, 2>(EAST, EAST).trace();
        let square_m2 = away.norm_squared() + emitter.position_m.z * emitter.position_m.z;
        let smooth_m2 = (square_m2 + spread_m2).max(NEAREST_M * NEAREST_M);
        let fall_db = fall_db(&emitter.path_loss, libm::sqrt(smooth_m2));
        let slope = away * (-fall_db / smooth_m2);
        let mut jacobian = slope.transpose() * self.before_by(way_m).fixed_rows::<2>(0);
        jacobian[(0, HEARING)] = 1.0;
        let bent_db = 0.5 * fall_db * spread_m2 / smooth_m2;
        Seen {
            residual: SVector::<f64, 1>::new(
                rssi_dbm - mean_of_square_dbm(&emitter.path_loss, square_m2) - self.hearing_db,
            ),
            jacobian,
            noise: SMatrix::<f64, 1, 1>::new(sigma_db * sigma_db + bent_db * bent_db),
        }
    }

    /// What a distance from an anchor is expected to be.
    fn sphere(&self, anchor_m: &Vector3<f64>, back: &Back) -> Sphere {
        let velocity_m_s = self.on_map(&back.velocity_m_s);
        let away = self.before(&back.way_m) - velocity_m_s * self.clock_s - anchor_m;
        let distance_m = away.norm().max(NEAREST_M);
        let toward = away / distance_m;
        let curvature = (Matrix3::identity() - toward * toward.transpose()) / distance_m;
        let bent = curvature * self.position_covariance_m2();
        let mut jacobian = toward.transpose() * self.before_by(&back.way_m);
        jacobian[(0, CLOCK)] = -toward.dot(&velocity_m_s);
        Sphere {
            expected_m: distance_m + 0.5 * bent.trace(),
            spread_m2: 0.5 * (bent * bent).trace(),
            jacobian,
        }
    }

    /// Takes a measurement. Where its normalised innovation squared exceeds `bound` its noise grows until it does not (Huber 1964): an outlier pulls no more than one at the
    /// bound. `None` when the covariance of the innovation has no Cholesky factor; nothing changes then.
    pub fn take<const M: usize>(&mut self, seen: &Seen<M>, bound: f64) -> Option<Taken> {
        let cross = self.covariance * seen.jacobian.transpose();
        let innovation = seen.jacobian * cross + seen.noise;
        let factor = innovation.cholesky()?;
        let nis = seen.residual.dot(&factor.solve(&seen.residual));
        let widened = (nis / bound).max(1.0);
        let log_root: f64 = (0..M).map(|i| libm::log(factor.l_dirty()[(i, i)])).sum();
        let dimension = M as f64;
        let log_likelihood = -log_root - 0.5 * (DOF + dimension) * libm::log1p(nis / DOF);
        let gain = factor.solve(&cross.transpose()).transpose() / widened;
        // P ← P − K S K', and with a widened S: K = P H'/(w S), P ← P − w K S K'.
        self.covariance -= gain * cross.transpose();
        symmetrise(&mut self.covariance);
        self.feed_back(&(gain * seen.residual));
        Some(Taken { residual: seen.residual[0], nis, log_likelihood, widened })
    }

    /// Normalised innovation squared, and the logarithm of the likelihood, of a measurement that is not taken.
    pub fn judge<const M: usize>(&self, seen: &Seen<M>) -> Option<(f64, f64)> {
        let innovation = seen.jacobian * self.covariance * seen.jacobian.transpose() + seen.noise;
        let factor = innovation.cholesky()?;
        let nis = seen.residual.dot(&factor.solve(&seen.residual));
        let log_root: f64 = (0..M).map(|i| libm::log(factor.l_dirty()[(i, i)])).sum();
        Some((nis, -log_root - 0.5 * (DOF + M as f64) * libm::log1p(nis / DOF)))
    }

    /// Adds a correction of the error; the covariance stays.
    pub(super) fn feed_back(&mut self, correction: &Vector) {
        self.position_m += correction.fixed_rows::<3>(EAST);
        self.turn_rad += correction[TURN] + correction[HEADING];
        self.heading_rad += correction[HEADING];
        self.drift_rad += correction[DRIFT];
        self.factor = (self.factor + correction[FACTOR]).clamp(FACTORS.0, FACTORS.1);
        self.barometer_m += correction[BAROMETER];
        self.common_m += correction[COMMON];
        self.clock_s += correction[CLOCK];
        self.hearing_db += correction[HEARING];
        self.iron_rad += correction.fixed_rows::<2>(IRON);
        self.missed += correction[MISSED];
    }

    /// The estimate as one vector, in the order of the error.
    pub(super) fn mean(&self) -> Vector {
        let p = &self.position_m;
        let turn_rad = self.turn_rad - self.heading_rad;
        Vector::from([
            p.x,
            p.y,
            p.z,
            turn_rad,
            self.heading_rad,
            self.drift_rad,
            self.factor,
            self.barometer_m,
            self.common_m,
            self.clock_s,
            self.hearing_db,
            self.iron_rad.x,
            self.iron_rad.y,
            self.missed,
        ])
    }

    /// The state of such a vector.
    pub(super) fn of_mean(mean: &Vector, covariance: &Covariance) -> Self {
        Self {
            position_m: mean.fixed_rows::<3>(EAST).into_owned(),
            turn_rad: mean[TURN] + mean[HEADING],
            heading_rad: mean[HEADING],
            drift_rad: mean[DRIFT],
            factor: mean[FACTOR],
            barometer_m: mean[BAROMETER],
            common_m: mean[COMMON],
            clock_s: mean[CLOCK],
            hearing_db: mean[HEARING],
            iron_rad: mean.fixed_rows::<2>(IRON).into_owned(),
            missed: mean[MISSED],
            covariance: *covariance,
        }
    }

    /// Nothing is known of a state but this variance: its error is that of nothing else.
    pub fn forget(&mut self, index: usize, variance: f64) {
        self.covariance.row_mut(index).fill(0.0);
        self.covariance.column_mut(index).fill(0.0);
        self.covariance[(index, index)] = variance;
    }

    /// Covariance of the position, m².
    pub fn position_covariance_m2(&self) -> Matrix3<f64> {
        self.covariance.fixed_view::<3, 3>(EAST, EAST).into_owned()
    }

    /// Variance of the direction of the way, ψ + η, rad².
    pub fn direction_rad2(&self) -> f64 {
        let p = &self.covariance;
        p[(TURN, TURN)] + 2.0 * p[(TURN, HEADING)] + p[(HEADING, HEADING)]
    }

    /// No number has been lost.
    pub fn is_finite(&self) -> bool {
        self.position_m.iter().chain(self.covariance.iter()).all(|value| value.is_finite())
            && [self.turn_rad, self.drift_rad, self.factor, self.barometer_m, self.common_m]
                .iter()
                .all(|value| value.is_finite())
    }
}

/// Degrees of freedom of Student's t by which hypotheses are compared: one wrong measurement must not decide.
const DOF: f64 = 4.0;

/// Rounding leaves the halves a bit apart, and what is apart grows.
pub(super) fn symmetrise(matrix: &mut Covariance) {
    for column in 0..STATES {
        for row in 0..column {
            let mean = 0.5 * (matrix[(row, column)] + matrix[(column, row)]);
            matrix[(row, column)] = mean;
            matrix[(column, row)] = mean;
        }
    }
}
