//! What a real magnetometer makes of the field.
//!
//! With the field `B` at the sensor, body axes, averaged over the integration time that ends `latency` before the stamp:
//!
//! `y = Q( sat( F( (I + diag(s) + M) S R B + h + b₀ + b_gm(t) + b_rw(t) + n ) ) )`
//!
//! | term | model | parameter |
//! |---|---|---|
//! | `R` axes turned against the IMU's | rotation by a vector, constant | the vector |
//! | `S` soft iron (with it scale and cross-axis response) | matrix, constant | its nine terms |
//! | `h` hard iron | constant | the vector |
//! | `b₀` residual hard iron, `s`, `M` residual response | normal, constant in a run | σ, as [`TriadErrors`] |
//! | `b_gm` bias instability, `b_rw` drift, `n` white noise, `F` bandwidth, `sat`, `Q` | as [`TriadErrors`] | as there |
//!
//! Known constants (`h`, `S`, `R`) are for a log to be calibrated; drawn ones (`b₀`, `s`, `M`) for what a calibration
//! leaves. Source of the linear model: Vasconcelos et al., *Geometric approach to strapdown magnetometer calibration in
//! sensor frame* (IEEE T-AES 47(2), 2011), eq. 1.
//!
//! Frames and units: IMU body axes to magnetometer axes, µT, s, rad.
//! Limits: no temperature, no hysteresis of the sensor, no current of the tag's own battery, the same figures for all axes.
//!
//! # Order of the random draws
//! `ChaCha8` of the seed, **stream 2**, so that a magnetometer changes neither the IMU (stream 0) nor the walk (stream 1).
//! At the start `b₀` x y z, `s` x y z, `M` xy xz yx yz zx zy, `b_gm` x y z; per sample `b_gm`, `b_rw`, `n` (x y z each),
//! then the jitter of the stamp.

use crate::error::{SimulationError, check_within};
use crate::imu_errors::{JITTER_LIMIT, Triad, TriadErrors, check_all};
use adit_core::attitude;
use adit_core::nalgebra::{Matrix3, Vector3};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

/// Errors and timing of a three-axis magnetometer. The default is faultless, at 100 Hz.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MagnetometerModel {
    /// Samples per second; need not divide the rate of the IMU.
    pub rate_hz: f64,
    /// Time over which the field is averaged, s; 0 reads it at one moment.
    pub integration_s: f64,
    /// The stamp is later than the end of the integration by this much, s.
    pub latency_s: f64,
    /// Jitter of the stamps, σ, s.
    pub stamp_jitter_s: f64,
    /// Hard iron, magnetometer axes, µT.
    pub hard_iron_ut: [f64; 3],
    /// Soft iron, scale and cross-axis response, row by row; the identity changes nothing.
    pub soft_iron: [[f64; 3]; 3],
    /// Rotation vector from the IMU's axes to the magnetometer's, rad.
    pub axes_turned_rad: [f64; 3],
    /// Errors drawn for each run, and range, steps and bandwidth; U = µT.
    pub triad: TriadErrors,
}

const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

impl MagnetometerModel {
    /// Without errors, at this rate.
    pub const fn ideal() -> Self {
        Self {
            rate_hz: 100.0,
            integration_s: 0.0,
            latency_s: 0.0,
            stamp_jitter_s: 0.0,
            hard_iron_ut: [0.0; 3],
            soft_iron: IDENTITY,
            axes_turned_rad: [0.0; 3],
            triad: TriadErrors::none(),
        }
    }

    /// All figures are numbers in the range of a magnetometer, and the soft iron can be undone.
    pub fn check(&self) -> Result<(), SimulationError> {
        check_within("rate_hz", self.rate_hz, 0.1, 10_000.0, "0.1 to 10000 Hz")?;
        check_within("integration_s", self.integration_s, 0.0, 1.0, "0 to 1 s")?;
        check_within("latency_s", self.latency_s, 0.0, 10.0, "0 to 10 s")?;
        check_all(
            &[("stamp_jitter_s", self.stamp_jitter_s)],
            |v| v >= 0.0 && v.is_finite(),
            "not below 0 s",
        )?;
        for found in self.hard_iron_ut {
            check_within("hard_iron_ut", found, -1e6, 1e6, "-1e6 to 1e6 µT")?;
        }
        for found in self.soft_iron.into_iter().flatten() {
            check_within("soft_iron", found, -10.0, 10.0, "terms of -10 to 10")?;
        }
        let determinant = matrix(&self.soft_iron).determinant();
        check_within("soft_iron", determinant, 1e-3, 1e3, "a determinant of 0.001 to 1000")?;
        for found in self.axes_turned_rad {
            check_within("axes_turned_rad", found, -3.2, 3.2, "-3.2 to 3.2 rad")?;
        }
        self.triad.check()
    }
}

impl Default for MagnetometerModel {
    fn default() -> Self {
        Self::ideal()
    }
}

fn matrix(rows: &[[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|row, column| rows[row][column])
}

/// Errors of one magnetometer in one run: constants drawn, processes under way.
#[derive(Debug, Clone)]
pub struct Magnetometer {
    triad: Triad,
    /// `S R`.
    soft_iron: Matrix3<f64>,
    hard_iron_ut: Vector3<f64>,
    stamp_jitter_s: f64,
    rng: ChaCha8Rng,
}

impl Magnetometer {
    /// Draws the constants of the run.
    pub fn new(model: &MagnetometerModel, seed: u64) -> Result<Self, SimulationError> {
        model.check()?;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(2);
        let turn = attitude::exp(&-Vector3::from(model.axes_turned_rad));
        Ok(Self {
            triad: Triad::new(model.triad, &mut rng),
            soft_iron: matrix(&model.soft_iron) * turn.to_rotation_matrix().into_inner(),
            hard_iron_ut: Vector3::from(model.hard_iron_ut),
            stamp_jitter_s: model.stamp_jitter_s,
            rng,
        })
    }

    /// The response `A = (I + diag(s) + M) S R` of this run: what a calibration should find in `y = A B + b`.
    pub fn response(&self) -> Matrix3<f64> {
        self.triad.response() * self.soft_iron
    }

    /// The offset `b` of this run at the last sample (hard iron, residual and drift), µT.
    pub fn offset_ut(&self) -> Vector3<f64> {
        self.hard_iron_ut + self.triad.bias()
    }

    /// The reading in place of a field in IMU body axes (µT), `span_s` after the one before.
    pub fn apply(&mut self, field_ut: &Vector3<f64>, span_s: f64) -> Vector3<f64> {
        self.triad.apply(&(self.soft_iron * field_ut), &self.hard_iron_ut, span_s, &mut self.rng)
    }

    /// How much this sample's stamp is off, s.
    pub(crate) fn jitter_s(&mut self, span_s: f64) -> f64 {
        let draw: f64 = StandardNormal.sample(&mut self.rng);
        let limit_s = JITTER_LIMIT * span_s;
        (draw * self.stamp_jitter_s).clamp(-limit_s, limit_s)
    }
}
