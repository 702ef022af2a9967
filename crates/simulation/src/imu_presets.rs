//! Error models of IMUs, from their data sheets.
//!
//! Figures are "typical" ones unless the sheet gives σ; a figure of ± tolerance is taken as 2 σ of a normal draw, one
//! of "typ" or "1 σ" as σ. Bias instability `B` of a sheet is the minimum of the Allan deviation; a Gauss–Markov
//! process of stationary σ and time τ peaks at 0.618 σ near 1.9 τ (IEEE Std 952-1997, annex B: 0.437 q √τ with
//! `q = σ √(2/τ)`), so `σ = B / 0.618`. Correlation times and bias random walks are on no sheet: 100 s and 0 stand here
//! as assumptions.
//!
//! The MPU-6050 figures were read off the sheet named; those of the ADIS16448 and the 3DM-GX5-25 are quoted from memory of theirs and want
//! a check against the PDF before anything is published on them.

use crate::ideal_imu::STANDARD_GRAVITY_M_S2 as G;
use crate::imu_errors::{ImuErrorModel, TriadErrors};

const DEG_S: f64 = core::f64::consts::PI / 180.0;
const DEG_H: f64 = DEG_S / 3600.0;
/// 1 °/√h in rad/√s.
const DEG_SQRT_H: f64 = DEG_S / 60.0;
/// 1 m/s/√h in m/s/√s.
const M_S_SQRT_H: f64 = 1.0 / 60.0;
const MILLI_G: f64 = 1e-3 * G;
const MICRO_G: f64 = 1e-6 * G;
/// Peak Allan deviation of a Gauss–Markov process over its stationary σ.
const MARKOV_PEAK: f64 = 0.618;

impl ImuErrorModel {
    /// TDK `InvenSense` MPU-6050 (PS-MPU-6000A-00 rev. 3.4, §6.1 and 6.2) at ±2000 °/s and ±16 g, zeroed once at the bench.
    ///
    /// The sheet's raw zero offsets (±20 °/s, ±50 mg) and tolerances (±3 %, 2 % cross-axis) are what a factory
    /// calibration removes; a residue of 1/40 of the gyro offset, 1/5 of the accelerometer's and 1/6 of the
    /// tolerances is left.
    pub const fn mpu6050() -> Self {
        Self {
            gyro: TriadErrors {
                turn_on_bias: 0.5 * DEG_S,
                bias_instability: 20.0 * DEG_H / MARKOV_PEAK,
                bias_correlation_s: 100.0,
                bias_random_walk: 0.0,
                // 0.005 °/s/√Hz, one-sided: the same number in °/√s.
                random_walk: 0.005 * DEG_S,
                scale_factor: 0.005,
                misalignment_rad: 0.0033,
                range: Some(2000.0 * DEG_S),
                quantisation: Some(DEG_S / 16.4),
                bandwidth_hz: None,
            },
            accelerometer: TriadErrors {
                turn_on_bias: 10.0 * MILLI_G,
                bias_instability: 0.1 * MILLI_G / MARKOV_PEAK,
                bias_correlation_s: 100.0,
                bias_random_walk: 0.0,
                random_walk: 400.0 * MICRO_G,
                scale_factor: 0.005,
                misalignment_rad: 0.0033,
                range: Some(16.0 * G),
                quantisation: Some(G / 2048.0),
                bandwidth_hz: None,
            },
            // 0.1 °/s/g.
            g_sensitivity: 0.1 * DEG_S / G,
            stamp_jitter_s: 50e-6,
        }
    }

    /// `InvenSense` MPU-9250 (product specification PS-MPU-9250A-01, from memory): the tag of spec S1.
    ///
    /// As [`Self::mpu6050`], its elder, but for the noise of both sensors and the accelerometer's raw offset (±60 mg).
    pub const fn mpu9250() -> Self {
        let mut model = Self::mpu6050();
        // 0.01 °/s/√Hz, 300 µg/√Hz.
        model.gyro.random_walk = 0.01 * DEG_S;
        model.accelerometer.random_walk = 300.0 * MICRO_G;
        model.accelerometer.turn_on_bias = 12.0 * MILLI_G;
        model
    }

    /// Analog Devices ADIS16448 (data sheet, table 1): the tag of spec S2.
    pub const fn adis16448() -> Self {
        Self {
            gyro: TriadErrors {
                turn_on_bias: 0.5 * DEG_S,
                bias_instability: 14.5 * DEG_H / MARKOV_PEAK,
                bias_correlation_s: 100.0,
                bias_random_walk: 0.0,
                random_walk: 0.66 * DEG_SQRT_H,
                // ±1 %.
                scale_factor: 0.005,
                // ±0.05° axis to axis.
                misalignment_rad: 0.05 * DEG_S / 2.0,
                range: Some(1000.0 * DEG_S),
                quantisation: Some(0.04 * DEG_S),
                bandwidth_hz: None,
            },
            accelerometer: TriadErrors {
                turn_on_bias: 20.0 * MILLI_G,
                bias_instability: 0.25 * MILLI_G / MARKOV_PEAK,
                bias_correlation_s: 100.0,
                bias_random_walk: 0.0,
                random_walk: 0.11 * M_S_SQRT_H,
                // ±1 %.
                scale_factor: 0.005,
                // 0.2° axis to axis.
                misalignment_rad: 0.2 * DEG_S / 2.0,
                range: Some(18.0 * G),
                quantisation: Some(0.833 * MILLI_G),
                bandwidth_hz: None,
            },
            // 0.015 °/s/g.
            g_sensitivity: 0.015 * DEG_S / G,
            stamp_jitter_s: 10e-6,
        }
    }

    /// The [`Self::adis16448`] after a turn on a rate table: scale factors known to 0.05 % (1 σ) instead of the sheet's
    /// ±1 %.
    ///
    /// A gyro 0.5 % off turns the heading by 1.8° in one round of a ring, and no zero-velocity update sees it.
    pub const fn adis16448_calibrated() -> Self {
        let mut model = Self::adis16448();
        model.gyro.scale_factor = 0.0005;
        model.accelerometer.scale_factor = 0.0005;
        model
    }

    /// `MicroStrain` (LORD, HBK) 3DM-GX5-25 (data sheet 8400-0093): the sensor of the foot-hallway logs.
    ///
    /// The gyro range is that at which the foot-vicon logs of a sister model clip, not the nominal ±300 °/s.
    pub const fn microstrain_gx5_25() -> Self {
        Self {
            gyro: TriadErrors {
                // ±0.04 °/s.
                turn_on_bias: 0.02 * DEG_S,
                bias_instability: 8.0 * DEG_H / MARKOV_PEAK,
                bias_correlation_s: 100.0,
                bias_random_walk: 0.0,
                // 0.005 °/s/√Hz.
                random_walk: 0.005 * DEG_S,
                // ±0.05 %.
                scale_factor: 0.00025,
                // ±0.05°.
                misalignment_rad: 0.05 * DEG_S / 2.0,
                range: Some(522.0 * DEG_S),
                quantisation: None,
                bandwidth_hz: None,
            },
            accelerometer: TriadErrors {
                // ±0.002 g.
                turn_on_bias: 1.0 * MILLI_G,
                bias_instability: 0.04 * MILLI_G / MARKOV_PEAK,
                bias_correlation_s: 100.0,
                bias_random_walk: 0.0,
                random_walk: 25.0 * MICRO_G,
                // ±0.05 %.
                scale_factor: 0.00025,
                // ±0.05°.
                misalignment_rad: 0.05 * DEG_S / 2.0,
                range: Some(8.0 * G),
                quantisation: None,
                bandwidth_hz: None,
            },
            g_sensitivity: 0.0,
            stamp_jitter_s: 5e-6,
        }
    }

    /// Xsens MTi-G with the gyros of ±1200 °/s: the tag of spec S3. A foot turns at up to 500 °/s, and the usual ±300 °/s
    /// would clip every stride; the paper does not say which it had.
    ///
    /// *`MTi` and `MTx` User Manual* (MT0100P rev. N, §4.3–4.5) as found: ranges, 0.1 °/s/√Hz of the ±1200 °/s gyro, axes square
    /// within 0.1°, 16-bit converters. From memory of its table 1: bandwidths of 40 and 30 Hz, 0.002 m/s²/√Hz,
    /// accelerometer bias 0.02 m/s² (1 σ), scale 0.03 %, gyro linearity 0.1 % (taken as scale, 1 σ). Turn-on bias
    /// ±0.5 °/s: the maker's note on bias repeatability, written of the successor. Assumed: bias instabilities, 40 °/h
    /// and 0.1 mg.
    pub const fn xsens_mti_g() -> Self {
        Self {
            gyro: TriadErrors {
                turn_on_bias: 0.25 * DEG_S,
                bias_instability: 40.0 * DEG_H / MARKOV_PEAK,
                bias_correlation_s: 100.0,
                bias_random_walk: 0.0,
                random_walk: 0.1 * DEG_S,
                scale_factor: 0.001,
                misalignment_rad: 0.1 * DEG_S / 2.0,
                range: Some(1200.0 * DEG_S),
                quantisation: Some(2400.0 / 65_536.0 * DEG_S),
                bandwidth_hz: Some(40.0),
            },
            accelerometer: TriadErrors {
                turn_on_bias: 0.02,
                bias_instability: 0.1 * MILLI_G / MARKOV_PEAK,
                bias_correlation_s: 100.0,
                bias_random_walk: 0.0,
                random_walk: 0.002,
                scale_factor: 0.0003,
                misalignment_rad: 0.1 * DEG_S / 2.0,
                range: Some(50.0),
                quantisation: Some(100.0 / 65_536.0),
                bandwidth_hz: Some(30.0),
            },
            g_sensitivity: 0.0,
            stamp_jitter_s: 10e-6,
        }
    }
}
