//! Error models of magnetometers, from their data sheets, **after** a calibration on the tag.
//!
//! What a sheet knows is the sensor: noise, range, steps, rate. What makes headings wrong is the tag around it; a
//! calibration takes most of that away. The residue left here is chosen, not found: hard iron σ 0.3 µT (MTi-G) or
//! 0.5 µT, response and squareness of a few tenths of a per cent. At Harbin's horizontal 24.8 µT, 0.3 µT are
//! 0.7° of heading (1 σ), next to the 1.0° that the manual of the `MTi` states. The raw sensor of a tag is had by
//! [`MagnetometerModel::hard_iron_ut`] and [`MagnetometerModel::soft_iron`] on top.
//!
//! A sheet's noise `σ` at the output of a one-pole bandwidth `f` is white noise of density `N = σ/√(π f)` before it; without
//! bandwidth, at the rate `r`, `N = σ/√r`. Bias instability as in [`crate::imu_presets`]; correlation times are assumed.
//! 1 gauss = 100 µT.

use crate::imu_errors::TriadErrors;
use crate::magnetometer::MagnetometerModel;

/// 1 mG in µT.
const MILLI_GAUSS: f64 = 0.1;
const DEGREE: f64 = core::f64::consts::PI / 180.0;
/// Peak Allan deviation of a Gauss–Markov process over its stationary σ.
const MARKOV_PEAK: f64 = 0.618;

impl MagnetometerModel {
    /// The magnetometer of the Xsens MTi-G of spec S3 (*`MTi` and `MTx` User Manual*, MT0100P rev. N).
    ///
    /// Found there: axes square within 0.1°, 16-bit converters, 1.0° of static heading. From memory of its table 1:
    /// ±750 mG, 0.5 mG (1 σ) at 10 Hz bandwidth, bias stability 0.1 mG. The bandwidth delays the field by 16 ms: 6° for a
    /// foot that swings at 400 °/s.
    pub const fn xsens_mti_g() -> Self {
        Self {
            integration_s: 0.01,
            triad: TriadErrors {
                turn_on_bias: 0.3,
                bias_instability: 0.1 * MILLI_GAUSS / MARKOV_PEAK,
                bias_correlation_s: 100.0,
                // 0.05 µT/√(π · 10 Hz).
                random_walk: 0.5 * MILLI_GAUSS / 5.604_991,
                scale_factor: 0.003,
                misalignment_rad: 0.1 * DEGREE,
                range: Some(750.0 * MILLI_GAUSS),
                quantisation: Some(1500.0 * MILLI_GAUSS / 65_536.0),
                bandwidth_hz: Some(10.0),
                ..TriadErrors::none()
            },
            ..Self::ideal()
        }
    }

    /// Honeywell HMC5883L (data sheet 900405) at its default gain, 75 Hz.
    ///
    /// Found: 1090 counts per gauss, 12 bits (±2047 counts), noise floor 2 mG. From memory: the rate of 75 Hz and 6 ms
    /// a measurement. Squareness and scale after calibration are chosen.
    pub const fn hmc5883l() -> Self {
        Self {
            rate_hz: 75.0,
            integration_s: 0.006,
            triad: TriadErrors {
                turn_on_bias: 0.5,
                // 2 mG/√(75 Hz).
                random_walk: 2.0 * MILLI_GAUSS / 8.660_254,
                scale_factor: 0.005,
                misalignment_rad: 0.25 * DEGREE,
                range: Some(2047.0 / 1090.0 * 1000.0 * MILLI_GAUSS),
                quantisation: Some(1000.0 * MILLI_GAUSS / 1090.0),
                ..TriadErrors::none()
            },
            ..Self::ideal()
        }
    }

    /// Asahi Kasei AK8963 inside the MPU-9250, at 100 Hz.
    ///
    /// From memory of its data sheet: ±4912 µT, 0.15 µT a count at 16 bits, 7.2 ms a measurement. It states no noise; 0.3 µT (1 σ) a sample
    /// is assumed, and squareness and scale after calibration are chosen.
    pub const fn ak8963() -> Self {
        Self {
            rate_hz: 100.0,
            integration_s: 0.007_2,
            triad: TriadErrors {
                turn_on_bias: 0.5,
                // 0.3 µT/√(100 Hz).
                random_walk: 0.03,
                scale_factor: 0.005,
                misalignment_rad: 0.25 * DEGREE,
                range: Some(4912.0),
                quantisation: Some(0.15),
                ..TriadErrors::none()
            },
            ..Self::ideal()
        }
    }

    /// The magnetometer of the Analog Devices ADIS16448, at 51.2 Hz.
    ///
    /// Found in its data sheet: ±1.9 gauss. From memory of table 1: 142.9 µG a count, 2.4 mG (1 σ), 51.2 samples
    /// a second. Squareness and scale after calibration are chosen.
    pub const fn adis16448() -> Self {
        Self {
            rate_hz: 51.2,
            triad: TriadErrors {
                turn_on_bias: 0.5,
                // 2.4 mG/√(51.2 Hz).
                random_walk: 2.4 * MILLI_GAUSS / 7.155_418,
                scale_factor: 0.005,
                misalignment_rad: 0.25 * DEGREE,
                range: Some(1900.0 * MILLI_GAUSS),
                quantisation: Some(0.1429 * MILLI_GAUSS),
                ..TriadErrors::none()
            },
            ..Self::ideal()
        }
    }
}
