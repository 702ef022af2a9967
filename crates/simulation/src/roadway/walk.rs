//! The walk as a function of time on the rotating ellipsoid, and what an ideal IMU reads on it.
//!
//! # Path
//! Every change of velocity, of speed or of direction, is one blend from `w₀` to `w₁` (plane vectors) over `T`:
//! `w(u) = w₀ + (w₁ − w₀) s(u)`, `u = t/T`, with the septic step `s` of [`crate::foot_motion`], so that the way is a polynomial,
//! `x(u) = x₀ + T (w₀ u + (w₁ − w₀) S(u))`, `S(u) = ∫s = 7u⁵ − 14u⁶ + 10u⁷ − 2.5u⁸`. Position is C⁴; in a turn by α the speed
//! falls to `cos(α/2)` of its value in the corner. The body's x axis points along `w` (along the leg at rest), level.
//!
//! # Earth
//! The plane coordinates are scaled longitude and latitude: `λ = λ₀ + x / (R_N cos L₀)`, `L = L₀ + y / R_M(L₀)`, height 0 above the
//! origin's. Metres are true at the origin and within 1e-4 of it at 600 m; what is called velocity below is the true one.
//! With `r(L, λ, h)` the Earth-centred position and its exact derivatives ([`crate::jet`]), `Ω` the Earth's rate and `γ` normal
//! gravity (centrifugal part included):
//!
//! ```text
//! f = r̈ + 2 Ω × ṙ − γ            ω_ib = ω_ie + ω_en + ψ̇        (Earth axes; then turned into the body)
//! ```
//!
//! Coriolis and transport terms come out of `r̈` and `Ω × ṙ`; no mechanisation in level axes is used, and none shared with a
//! filter.

use super::plan::{RoadwayLeg, RoadwayPlan};
use crate::error::SimulationError;
use crate::ideal_imu::{Inertial, quadrature};
use crate::jet::{Jet, JetVector};
use adit_core::attitude::{self, Attitude};
use adit_core::geodesy::{
    EARTH_RATE_RAD_S, ECCENTRICITY_SQUARED, Geodetic, SEMI_MAJOR_AXIS_M, gravity_at_height_m_s2,
    meridian_radius_m, prime_vertical_radius_m,
};
use adit_core::level_frame::LevelFrame;
use adit_core::nalgebra::{Matrix3, RowVector3, Vector2, Vector3};
use core::f64::consts::FRAC_PI_2;

/// A blend of velocity, or a velocity that stays.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    start_s: f64,
    length_s: f64,
    start_m: Vector2<f64>,
    from_m_s: Vector2<f64>,
    to_m_s: Vector2<f64>,
    /// Direction (clockwise from north) where the velocity has none of its own.
    heading_rad: f64,
    turns: bool,
}

/// State of the walker at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EarthState {
    /// Position.
    pub point: Geodetic,
    /// Position in the level frame of the origin, m.
    pub position_m: Vector3<f64>,
    /// Velocity against the Earth, level axes at the walker, m/s.
    pub velocity_m_s: Vector3<f64>,
    /// Body to the level axes at the walker.
    pub attitude: Attitude,
    /// At rest.
    pub standing: bool,
    /// What an ideal IMU reads.
    pub inertial: Inertial,
}

/// A walk.
#[derive(Debug, Clone)]
pub struct RoadwayWalk {
    frame: LevelFrame,
    /// Plane metres to radians: longitude, latitude.
    per_metre: [f64; 2],
    pieces: Vec<Piece>,
    duration_s: f64,
}

impl RoadwayWalk {
    /// The walk of a plan from `origin`, cut or standing on to last `duration_s`.
    pub fn new(plan: &RoadwayPlan, origin: Geodetic, duration_s: f64) -> Result<Self, SimulationError> {
        plan.check()?;
        crate::error::check_within(
            "latitude_rad",
            origin.latitude_rad,
            -1.55,
            1.55,
            "-1.55 to 1.55 rad (89°)",
        )?;
        crate::error::check_within("duration_s", duration_s, 1.0, 1e6, "1 to 1e6 s")?;
        let parallel_m =
            (prime_vertical_radius_m(origin.latitude_rad) + origin.height_m) * libm::cos(origin.latitude_rad);
        let meridian_m = meridian_radius_m(origin.latitude_rad) + origin.height_m;
        let per_metre = [1.0 / parallel_m, 1.0 / meridian_m];
        let pieces = pieces(plan);
        Ok(Self { frame: LevelFrame::new(origin), per_metre, pieces, duration_s })
    }

    /// How long it lasts, s.
    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// The level frame of its start.
    pub fn frame(&self) -> &LevelFrame {
        &self.frame
    }

    /// The state at `time_s` after the start.
    pub fn at(&self, time_s: f64) -> EarthState {
        let index = self.pieces.partition_point(|piece| piece.start_s <= time_s).saturating_sub(1);
        let piece = &self.pieces[index];
        let ([x, y], heading) = piece.at(time_s);
        let origin = *self.frame.origin();
        let longitude = Jet::constant(origin.longitude_rad) + x * self.per_metre[0];
        let latitude = Jet::constant(origin.latitude_rad) + y * self.per_metre[1];
        let point = Geodetic {
            latitude_rad: latitude.value,
            longitude_rad: longitude.value,
            height_m: origin.height_m,
        };

        let position = earth_centred(latitude, longitude, origin.height_m);
        let level = level_axes(&point);
        let earth = Vector3::new(0.0, 0.0, EARTH_RATE_RAD_S);
        let gravity = gravity_at_height_m_s2(point.latitude_rad, point.height_m);
        let force = level * (position.second() + 2.0 * earth.cross(&position.first()))
            + Vector3::new(0.0, 0.0, gravity);
        // The level axes turn about the Earth's axis with λ̇ and about west with L̇.
        let level_rate = level * (earth + Vector3::z() * longitude.first) - Vector3::x() * latitude.first;
        let attitude = attitude::exp(&(Vector3::z() * (FRAC_PI_2 - heading.value)));
        let inertial = Inertial {
            angular_rate_rad_s: attitude.inverse_transform_vector(&level_rate) - Vector3::z() * heading.first,
            specific_force_m_s2: attitude.inverse_transform_vector(&force),
        };
        EarthState {
            point,
            position_m: self.frame.position_m(&point),
            velocity_m_s: level * position.first(),
            attitude,
            standing: piece.stands(),
            inertial,
        }
    }

    /// Mean of the ideal readings from `start_s` to `end_s`, each in the body axes of its moment.
    pub fn mean_reading(&self, start_s: f64, end_s: f64) -> Inertial {
        let none = Inertial { angular_rate_rad_s: Vector3::zeros(), specific_force_m_s2: Vector3::zeros() };
        quadrature(start_s, end_s).fold(none, |mut mean, (time_s, weight)| {
            let inertial = self.at(time_s).inertial;
            mean.angular_rate_rad_s += inertial.angular_rate_rad_s * weight;
            mean.specific_force_m_s2 += inertial.specific_force_m_s2 * weight;
            mean
        })
    }
}

impl Piece {
    fn stands(&self) -> bool {
        self.from_m_s == Vector2::zeros() && self.to_m_s == Vector2::zeros()
    }

    /// Plane position with its derivatives, and the heading.
    fn at(&self, time_s: f64) -> ([Jet; 2], Jet) {
        let u = ((time_s - self.start_s) / self.length_s).clamp(0.0, 1.0);
        let (v, u4) = (1.0 - u, u * u * u * u);
        let way = u4 * u * (7.0 + u * (-14.0 + u * (10.0 - 2.5 * u)));
        let step = u4 * (35.0 + u * (-84.0 + u * (70.0 - 20.0 * u)));
        let slope = 140.0 * u * u * u * v * v * v / self.length_s;
        let change = self.to_m_s - self.from_m_s;
        let position = self.start_m + (self.from_m_s * u + change * way) * self.length_s;
        let velocity = self.from_m_s + change * step;
        let acceleration = change * slope;
        let axis = |i: usize| Jet { value: position[i], first: velocity[i], second: acceleration[i] };
        let heading = if self.turns {
            let squared = velocity.norm_squared();
            let rate = (acceleration.x * velocity.y - velocity.x * acceleration.y) / squared;
            Jet { value: libm::atan2(velocity.x, velocity.y), first: rate, second: 0.0 }
        } else {
            Jet::constant(self.heading_rad)
        };
        ([axis(0), axis(1)], heading)
    }

    fn end_m(&self) -> Vector2<f64> {
        self.start_m + (self.from_m_s + self.to_m_s) * (0.5 * self.length_s)
    }
}

/// Pieces one after the other, the last without end.
fn pieces(plan: &RoadwayPlan) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::new();
    let mut heading_rad = plan.heading_rad;
    let (mut time_s, mut place, mut velocity) = (0.0, Vector2::zeros(), Vector2::zeros());
    let mut push = |length_s: f64, to_m_s: Vector2<f64>, velocity: &mut Vector2<f64>, heading_rad, turns| {
        if length_s > 0.0 {
            let (start_s, start_m, from_m_s) = (time_s, place, *velocity);
            let piece = Piece { start_s, length_s, start_m, from_m_s, to_m_s, heading_rad, turns };
            place = piece.end_m();
            time_s += length_s;
            *velocity = to_m_s;
            pieces.push(piece);
        }
    };
    let along = |heading: f64, speed: f64| {
        let (sin, cos) = libm::sincos(heading);
        Vector2::new(sin, cos) * speed
    };
    for leg in &plan.legs {
        match *leg {
            RoadwayLeg::Stand { seconds } => {
                if velocity != Vector2::zeros() {
                    push(plan.speed_change_s, Vector2::zeros(), &mut velocity, heading_rad, false);
                }
                push(seconds, Vector2::zeros(), &mut velocity, heading_rad, false);
            }
            RoadwayLeg::Straight { length_m, speed_m_s } => {
                let wanted = along(heading_rad, speed_m_s);
                push(plan.speed_change_s, wanted, &mut velocity, heading_rad, false);
                push(length_m / speed_m_s, wanted, &mut velocity, heading_rad, false);
            }
            RoadwayLeg::Turn { turn_rad } => {
                heading_rad += turn_rad;
                let speed = velocity.norm();
                if speed > 0.0 {
                    push(plan.turn_s, along(heading_rad, speed), &mut velocity, heading_rad, true);
                }
            }
        }
    }
    if velocity != Vector2::zeros() {
        push(plan.speed_change_s, Vector2::zeros(), &mut velocity, heading_rad, false);
    }
    push(f64::MAX, Vector2::zeros(), &mut velocity, heading_rad, false);
    pieces
}

/// Earth-centred, Earth-fixed position with its derivatives, m (TR8350.2, chapter 4).
fn earth_centred(latitude: Jet, longitude: Jet, height_m: f64) -> JetVector {
    let (sin_lat, cos_lat) = latitude.sin_cos();
    let (sin_lon, cos_lon) = longitude.sin_cos();
    let term = Jet::constant(1.0) - sin_lat * sin_lat * ECCENTRICITY_SQUARED;
    let root = libm::sqrt(term.value);
    // R_N = a term^(−1/2), by the chain rule.
    let inverse = 1.0 / root;
    let radius = term.chain(inverse, -0.5 * inverse / term.value, 0.75 * inverse / (term.value * term.value))
        * SEMI_MAJOR_AXIS_M;
    let height = Jet::constant(height_m);
    let from_axis = (radius + height) * cos_lat;
    JetVector([
        from_axis * cos_lon,
        from_axis * sin_lon,
        (radius * (1.0 - ECCENTRICITY_SQUARED) + height) * sin_lat,
    ])
}

/// Rows are east, north and up in Earth axes.
fn level_axes(point: &Geodetic) -> Matrix3<f64> {
    let (sin_lat, cos_lat) = libm::sincos(point.latitude_rad);
    let (sin_lon, cos_lon) = libm::sincos(point.longitude_rad);
    Matrix3::from_rows(&[
        RowVector3::new(-sin_lon, cos_lon, 0.0),
        RowVector3::new(-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat),
        RowVector3::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat),
    ])
}
