//! What can be set about signal strengths.

use crate::error::{SimulationError, check_within};
use crate::radio::spec::check_share;
use serde::{Deserialize, Serialize};

/// How signal strength falls off, varies and gets lost.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RssiSpec {
    /// Centre frequency, GHz.
    pub frequency_ghz: f64,
    /// Transmit power where the mine's file has none, dBm.
    pub tx_power_dbm: f64,
    /// Path-loss exponent near the transmitter, where its file entry has no path loss of its own.
    pub exponent: f64,
    /// Where the wave guided by the tunnel takes over, m.
    pub breakpoint_m: f64,
    /// Exponent beyond it.
    pub exponent_beyond: f64,
    /// Loss of a bend by a right angle, dB; others by `1 − cos` of their angle.
    pub corner_loss_db: f64,
    /// Loss of a closed door that has none in the mine's file, dB.
    pub door_loss_db: f64,
    /// Standard deviation of shadowing, dB.
    pub shadowing_sigma_db: f64,
    /// Distance over which shadowing forgets to 1/e, m.
    pub shadowing_correlation_m: f64,
    /// Ratio of the constant to the scattered part of small-scale fading in sight, dB; around corners there is no constant part.
    pub rician_k_db: f64,
    /// Doppler spread (σ) of what scatters, Hz: how fast the value at one place changes.
    pub drift_hz: f64,
    /// White noise of a reading, dB.
    pub noise_db: f64,
    /// Noise near a running conveyor, dB: scale of a Student t of 3 degrees of freedom (heavy tails).
    pub conveyor_noise_db: f64,
    /// Distance from the belt over which it falls to 1/e, m.
    pub conveyor_reach_m: f64,
    /// Signal strength at which half of the beacons are received, dBm.
    pub sensitivity_dbm: f64,
    /// Steepness of that, dB: the logistic scale.
    pub sensitivity_spread_db: f64,
    /// Share of beacons that a scan misses anyway.
    pub missed: f64,
    /// Step of what the receiver tells, dB; 0 for none.
    pub step_db: f64,
    /// No transmitter is heard over a longer way through the openings, m.
    pub most_way_m: f64,
}

impl RssiSpec {
    /// Wi-Fi at 2.4 GHz in a rough roadway.
    ///
    /// Exponents: 2.1 to 2.3 near and below 2 where the roadway guides the wave (Boutin et al. 2008; Hrovat, Kandus & Javornik
    /// 2014); shadowing as in the recorded sets of `docs/simulation/radio.md`.
    pub const fn wifi() -> Self {
        Self {
            frequency_ghz: 2.44,
            tx_power_dbm: 18.0,
            exponent: 2.2,
            breakpoint_m: 30.0,
            exponent_beyond: 1.7,
            corner_loss_db: 15.0,
            door_loss_db: 10.0,
            shadowing_sigma_db: 3.0,
            shadowing_correlation_m: 3.0,
            rician_k_db: 6.0,
            drift_hz: 0.004,
            noise_db: 0.8,
            conveyor_noise_db: 2.5,
            conveyor_reach_m: 6.0,
            sensitivity_dbm: -90.0,
            sensitivity_spread_db: 1.5,
            missed: 0.05,
            step_db: 1.0,
            most_way_m: 250.0,
        }
    }

    /// Bluetooth beacons: 0 dBm, one of three channels at a time, so that a reading has hardly any diversity.
    pub const fn ble() -> Self {
        Self {
            tx_power_dbm: 0.0,
            rician_k_db: 2.0,
            drift_hz: 0.3,
            noise_db: 1.5,
            sensitivity_dbm: -95.0,
            missed: 0.2,
            most_way_m: 80.0,
            ..Self::wifi()
        }
    }

    /// Wavelength, m.
    pub fn wavelength_m(&self) -> f64 {
        super::super::LIGHT_M_PER_NS / self.frequency_ghz
    }

    pub(crate) fn check(&self) -> Result<(), SimulationError> {
        check_within("frequency_ghz", self.frequency_ghz, 0.1, 60.0, "0.1 to 60 GHz")?;
        check_within("tx_power_dbm", self.tx_power_dbm, -60.0, 60.0, "-60 to 60 dBm")?;
        check_within("exponent", self.exponent, 0.1, 10.0, "0.1 to 10")?;
        check_within("breakpoint_m", self.breakpoint_m, 1.0, 1e4, "1 to 10000 m")?;
        check_within("exponent_beyond", self.exponent_beyond, 0.1, 10.0, "0.1 to 10")?;
        check_within("drift_hz", self.drift_hz, 0.0, 1e3, "0 to 1000 Hz")?;
        for (name, found) in [
            ("corner_loss_db", self.corner_loss_db),
            ("door_loss_db", self.door_loss_db),
            ("shadowing_sigma_db", self.shadowing_sigma_db),
            ("noise_db", self.noise_db),
            ("conveyor_noise_db", self.conveyor_noise_db),
            ("step_db", self.step_db),
        ] {
            check_within(name, found, 0.0, 100.0, "0 to 100 dB")?;
        }
        check_within("shadowing_correlation_m", self.shadowing_correlation_m, 0.1, 1e3, "0.1 to 1000 m")?;
        check_within("rician_k_db", self.rician_k_db, -100.0, 100.0, "-100 to 100 dB")?;
        check_within("conveyor_reach_m", self.conveyor_reach_m, 0.1, 1e3, "0.1 to 1000 m")?;
        check_within("sensitivity_dbm", self.sensitivity_dbm, -150.0, 50.0, "-150 to 50 dBm")?;
        check_within("sensitivity_spread_db", self.sensitivity_spread_db, 0.01, 50.0, "0.01 to 50 dB")?;
        check_share("missed", self.missed)?;
        check_within("most_way_m", self.most_way_m, 1.0, 2e3, "1 to 2000 m")
    }
}

impl Default for RssiSpec {
    fn default() -> Self {
        Self::wifi()
    }
}
