//! The filter of system S1: how far dead reckoning is off the fixes (Lu, Zhao & Xu, eq. 5–12, 17, 18).
//!
//! ```text
//! x = [δx δy δvx δvy]           dead reckoning minus truth: position, m, and velocity, m/s
//! x ← F x,   F = I + Δt on the velocities            P ← F P Fᵀ + Q Δt                        eq. 11, 12
//! z = [x_pdr − x_wifi, …, vx_pdr − vx_wifi, …] = x + v                                        eq. 5–7
//! K = P (P + R)⁻¹,   x ← x + K (z − x),   P ← (I − K) P                                       eq. 8–10
//! Q = diag(q_best) Q₀,   R = diag(b_best) R₀                                                  eq. 17, 18
//! ```
//!
//! Velocities are the differences of positions between two fixes, of dead reckoning and of the fixes alike. Everything is
//! diagonal, so that east and north are two filters of two states, and a measurement is two scalar ones: 4 numbers of state and
//! 6 of covariance, not 4 + 16. The paper restarts dead reckoning at each fused position (its step 4); the difference between
//! the two is what δ holds, and the result is the same.
//!
//! Where the paper is silent: Q₀ is a density in time, so that a filter tuned on reports every 10 s serves for every 5 s; R₀ of a
//! velocity is that of the difference of two fixes, `2 σ² / Δt²`. The errors of that velocity and of the position hang together, which the paper's R
//! cannot hold: the covariance is what the filter needs for its gain, not a statement about errors (`docs/methods/pdr-wifi.md`).

use crate::methods::NoiseParameter;
use crate::settings::{first_unusable, positive};
use adit_core::nalgebra::{Vector2, Vector4};
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// One number for each component of the state.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Components {
    /// Of the position to the east.
    pub east: f64,
    /// Of the position to the north.
    pub north: f64,
    /// Of the velocity to the east.
    pub east_velocity: f64,
    /// Of the velocity to the north.
    pub north_velocity: f64,
}

impl Default for Components {
    fn default() -> Self {
        Self { east: 1.0, north: 1.0, east_velocity: 1.0, north_velocity: 1.0 }
    }
}

/// Random errors that the filter reckons with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FusionParams {
    /// Q₀ of the positions: random walk of dead reckoning, m²/s.
    pub position_walk_m2_s: f64,
    /// Q₀ of the velocities: random walk of its velocity's error, m²/s³.
    pub velocity_walk_m2_s3: f64,
    /// R₀: a fix, standard deviation, m.
    pub fix_sigma_m: f64,
    /// Error of the velocity of dead reckoning at the start, standard deviation, m/s.
    pub velocity_sigma_m_s: f64,
    /// Factors on Q₀, `q_best`.
    pub process_scale: Components,
    /// Factors on R₀, `b_best`.
    pub measurement_scale: Components,
}

impl Default for FusionParams {
    fn default() -> Self {
        Self {
            // 5 % of the way at 1.5 m/s in each second.
            position_walk_m2_s: 0.005,
            // A tenth of a metre a second after 100 s.
            velocity_walk_m2_s3: 1e-4,
            fix_sigma_m: 4.0,
            velocity_sigma_m_s: 0.1,
            process_scale: Components::default(),
            measurement_scale: Components::default(),
        }
    }
}

impl FusionParams {
    /// What tuning searches: the factors `q_best` and `b_best`, in the order of [`Self::set_noise`].
    pub const NOISE: [NoiseParameter; 8] = [
        NoiseParameter::new("fusion.process_scale.east", 1e-4, 1e4),
        NoiseParameter::new("fusion.process_scale.north", 1e-4, 1e4),
        NoiseParameter::new("fusion.process_scale.east_velocity", 1e-4, 1e4),
        NoiseParameter::new("fusion.process_scale.north_velocity", 1e-4, 1e4),
        NoiseParameter::new("fusion.measurement_scale.east", 1e-4, 1e4),
        NoiseParameter::new("fusion.measurement_scale.north", 1e-4, 1e4),
        NoiseParameter::new("fusion.measurement_scale.east_velocity", 1e-4, 1e4),
        NoiseParameter::new("fusion.measurement_scale.north_velocity", 1e-4, 1e4),
    ];

    /// Sets the noise parameter of this number in [`Self::NOISE`]; beyond the last nothing happens.
    pub fn set_noise(&mut self, number: usize, value: f64) {
        let (q, r) = (&mut self.process_scale, &mut self.measurement_scale);
        let all = [
            &mut q.east,
            &mut q.north,
            &mut q.east_velocity,
            &mut q.north_velocity,
            &mut r.east,
            &mut r.north,
            &mut r.east_velocity,
            &mut r.north_velocity,
        ];
        if let Some(place) = all.into_iter().nth(number) {
            *place = value;
        }
    }

    /// The first setting that cannot be worked with, by name.
    pub(super) fn unusable(&self) -> Option<&'static str> {
        let all = |scale: &Components| {
            [scale.east, scale.north, scale.east_velocity, scale.north_velocity].into_iter().all(positive)
        };
        first_unusable(&[
            ("fusion.position_walk_m2_s", positive(self.position_walk_m2_s)),
            ("fusion.velocity_walk_m2_s3", positive(self.velocity_walk_m2_s3)),
            ("fusion.fix_sigma_m", positive(self.fix_sigma_m)),
            ("fusion.velocity_sigma_m_s", positive(self.velocity_sigma_m_s)),
            ("fusion.process_scale", all(&self.process_scale)),
            ("fusion.measurement_scale", all(&self.measurement_scale)),
        ])
    }
}

/// What a tag reports: where dead reckoning has come to, and where its radio puts it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// Time since any fixed instant, s; rising.
    pub time_s: f64,
    /// East and north by dead reckoning, m.
    pub reckoned_m: Vector2<f64>,
    /// East and north by radio, m.
    pub fix_m: Vector2<f64>,
}

/// What the filter makes of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fused {
    /// East and north, m.
    pub position_m: Vector2<f64>,
    /// Error of dead reckoning that was taken off, m.
    pub offset_m: Vector2<f64>,
    /// And of its velocity, m/s.
    pub rate_m_s: Vector2<f64>,
    /// Normalised innovation squared of the report, of four degrees of freedom; `None` of the first, which has no velocity.
    pub nis: Option<f64>,
}

/// One axis: offset and rate, their covariance, and the noise that the settings give it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Axis {
    offset: f64,
    rate: f64,
    /// Variances of offset and rate, and their covariance.
    p: [f64; 3],
    /// Q of offset and rate, for each second.
    q: [f64; 2],
    /// R of a position, m², and of a difference of positions, m².
    r: [f64; 2],
}

impl Axis {
    #[inline]
    fn predict(&mut self, dt: f64) {
        let [offset, rate, both] = self.p;
        self.offset += self.rate * dt;
        self.p = [
            offset + dt * (2.0 * both + dt * rate) + self.q[0] * dt,
            rate + self.q[1] * dt,
            both + dt * rate,
        ];
    }

    /// A measurement of the offset; its normalised innovation squared.
    #[inline]
    fn position(&mut self, z: f64) -> f64 {
        let [offset, rate, both] = self.p;
        let inverse = 1.0 / (offset + self.r[0]);
        let innovation = z - self.offset;
        self.offset += offset * inverse * innovation;
        self.rate += both * inverse * innovation;
        // R / S and not 1 − K: never negative.
        let left = self.r[0] * inverse;
        self.p = [offset * left, rate - both * both * inverse, both * left];
        innovation * innovation * inverse
    }

    /// A measurement of the rate over `dt`; its normalised innovation squared.
    #[inline]
    fn velocity(&mut self, z: f64, dt: f64) -> f64 {
        let [offset, rate, both] = self.p;
        let r = self.r[1] / (dt * dt);
        let inverse = 1.0 / (rate + r);
        let innovation = z - self.rate;
        self.offset += both * inverse * innovation;
        self.rate += rate * inverse * innovation;
        let left = r * inverse;
        self.p = [offset - both * both * inverse, rate * left, both * left];
        innovation * innovation * inverse
    }
}

/// The filter, report by report.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fusion {
    axes: [Axis; 2],
    last: Option<Report>,
}

impl Fusion {
    /// A filter at a place that is known to `start_sigma_m` (east, north); dead reckoning begins there.
    pub fn new(params: &FusionParams, start_sigma_m: Vector2<f64>) -> Self {
        let FusionParams { process_scale: q, measurement_scale: r, .. } = params;
        let variance = params.fix_sigma_m * params.fix_sigma_m;
        let axis = |start: f64, q: [f64; 2], r: [f64; 2]| Axis {
            offset: 0.0,
            rate: 0.0,
            p: [start * start, params.velocity_sigma_m_s * params.velocity_sigma_m_s, 0.0],
            q: [q[0] * params.position_walk_m2_s, q[1] * params.velocity_walk_m2_s3],
            r: [r[0] * variance, 2.0 * r[1] * variance],
        };
        Self {
            axes: [
                axis(start_sigma_m.x, [q.east, q.east_velocity], [r.east, r.east_velocity]),
                axis(start_sigma_m.y, [q.north, q.north_velocity], [r.north, r.north_velocity]),
            ],
            last: None,
        }
    }

    /// Takes a report; one that is not newer than the last changes nothing.
    #[inline]
    pub fn observe(&mut self, report: &Report) -> Fused {
        let mut nis = None;
        match self.last {
            None => {
                for (axis, z) in self.axes.iter_mut().zip(&(report.reckoned_m - report.fix_m)) {
                    axis.position(*z);
                }
                self.last = Some(*report);
            }
            Some(last) if report.time_s > last.time_s => {
                let dt = report.time_s - last.time_s;
                let z = report.reckoned_m - report.fix_m;
                let velocity = (z - (last.reckoned_m - last.fix_m)) / dt;
                let mut sum = 0.0;
                for ((axis, z), v) in self.axes.iter_mut().zip(&z).zip(&velocity) {
                    axis.predict(dt);
                    sum += axis.position(*z) + axis.velocity(*v, dt);
                }
                nis = Some(sum);
                self.last = Some(*report);
            }
            Some(_) => {}
        }
        let offset_m = self.offset_m();
        let rate_m_s = Vector2::new(self.axes[0].rate, self.axes[1].rate);
        Fused { position_m: report.reckoned_m - offset_m, offset_m, rate_m_s, nis }
    }

    /// What dead reckoning is off by, as of the last report, m.
    pub fn offset_m(&self) -> Vector2<f64> {
        Vector2::new(self.axes[0].offset, self.axes[1].offset)
    }

    /// What dead reckoning is off by some time after the last report, m, with the variances of both components, m², and the same of its velocity.
    pub fn ahead(&self, dt: f64) -> ([Vector2<f64>; 2], Vector4<f64>) {
        let [mut east, mut north] = self.axes;
        if dt > 0.0 {
            east.predict(dt);
            north.predict(dt);
        }
        let offset = Vector2::new(east.offset, north.offset);
        let rate = Vector2::new(east.rate, north.rate);
        ([offset, rate], Vector4::new(east.p[0], north.p[0], east.p[1], north.p[1]))
    }
}

/// Sum of squared errors of the filter over walks whose truth is known, m²: the inverse of S1's fitness (eq. 19).
///
/// Each walk is its reports with the true position at each. 192 reports take some microseconds: this is what an optimiser calls.
pub fn squared_error_m2(params: &FusionParams, start_sigma_m: Vector2<f64>, walks: &[Walk]) -> f64 {
    let mut sum = 0.0;
    for walk in walks {
        let mut fusion = Fusion::new(params, start_sigma_m);
        for (report, truth_m) in &walk.reports {
            sum += (fusion.observe(report).position_m - truth_m).norm_squared();
        }
    }
    sum
}

/// The reports of one walk, each with the true position, m.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Walk {
    /// In order of time.
    pub reports: Vec<(Report, Vector2<f64>)>,
}
