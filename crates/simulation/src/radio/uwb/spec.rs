//! What can be set about UWB ranging.

use crate::error::{SimulationError, check_within};
use crate::radio::spec::check_share;
use serde::{Deserialize, Serialize};

/// How UWB anchors answer, and how well.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct UwbSpec {
    /// Centre frequency, GHz: 6.4896 is channel 5, 3.9936 channel 2.
    pub frequency_ghz: f64,
    /// Radiated power where the mine's file has none, dBm: −14.3 is −41.3 dBm/MHz over 499.2 MHz.
    pub tx_power_dbm: f64,
    /// Gain of the receiving antenna, dB.
    pub antenna_gain_db: f64,
    /// Path-loss exponent of the direct path.
    pub exponent: f64,
    /// Standard deviation of its shadowing, dB.
    pub shadowing_sigma_db: f64,
    /// Distance over which that forgets to 1/e, m.
    pub shadowing_correlation_m: f64,
    /// Loss of a bend by a right angle, dB; others by `1 − cos` of their angle.
    pub corner_loss_db: f64,
    /// Loss of a closed door that has none in the mine's file, dB.
    pub door_loss_db: f64,
    /// Power of the whole signal at which half of the frames are received, dBm.
    pub sensitivity_dbm: f64,
    /// Anchors with a longer way through the openings are not asked, m.
    pub most_way_m: f64,
    /// Anchors asked in one epoch, the strongest first.
    pub most_anchors: usize,
    /// Mean of the way that the first arrival is longer because something is in between, beyond what the obstacle's geometry says, m:
    /// gamma distributed with shape 1 (exponential), the same at the same place; 0 for none.
    pub obstruction_excess_m: f64,
    /// What every range has too much, m: antenna delays that nobody calibrated.
    pub offset_m: f64,
    /// The same of each anchor, standard deviation, m; anchors with `range_offset_m` in the mine's file have that instead.
    pub offset_sigma_m: f64,
    /// White noise of a range beside that of the leading edge, m: clocks, quantisation of stamps.
    pub noise_m: f64,
    /// How much of the bias by received power (Decawave APS011, table 2) is left in the range: 0 for a device that corrects it.
    pub power_bias: f64,
    /// Share of exchanges that fail for other reasons: collisions, busy anchors.
    pub missed: f64,
    /// Share of ranges that are wrong altogether.
    pub outliers: f64,
    /// How far they are off, mean of an exponential, m, always too long.
    pub outlier_mean_m: f64,
    /// Echoes.
    pub multipath: MultipathSpec,
    /// The receiver.
    pub receiver: ReceiverSpec,
}

/// Echoes after Saleh & Valenzuela (1987) as IEEE 802.15.4a has it (Molisch et al. 2006), and how they change over space.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MultipathSpec {
    /// Mean power of all echoes together against the free direct path, dB.
    pub echoes_db: f64,
    /// Its standard deviation from place to place, dB.
    pub echoes_sigma_db: f64,
    /// Mean power of one strong early echo (floor, wall, the device itself) against the free direct path, dB.
    pub early_db: f64,
    /// Its mean delay, ns.
    pub early_ns: f64,
    /// Rays per nanosecond. More than one per pulse look alike.
    pub rays_per_ns: f64,
    /// Clusters per nanosecond, Λ.
    pub clusters_per_ns: f64,
    /// Decay of the clusters' power, Γ, ns.
    pub cluster_decay_ns: f64,
    /// Decay of the rays' power in a cluster, γ, ns.
    pub ray_decay_ns: f64,
    /// Spread of the clusters' power, dB.
    pub cluster_sigma_db: f64,
    /// Nakagami m of a ray's amplitude.
    pub nakagami_m: f64,
    /// Decay of the rays of a blocked link, `γ_1` of 802.15.4a, ns.
    pub blocked_decay_ns: f64,
    /// How long its echoes take to rise, `γ_rise`, ns.
    pub blocked_rise_ns: f64,
    /// Share of the rays that rise so, `χ`.
    pub blocked_share: f64,
    /// How many dB the echoes lose for each dB that an obstacle takes from the direct path.
    pub blocked_echo_loss: f64,
    /// Distance over which the echoes of one place give way to those of the next, m.
    pub patch_m: f64,
}

/// A DW1000.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ReceiverSpec {
    /// Preamble symbols accumulated at most.
    pub most_symbols: u16,
    /// Amplitude at which accumulation ends, in units of the accumulator.
    pub full_amplitude: f64,
    /// Received power above which the gain control flattens what is told, dBm.
    pub compression_dbm: f64,
    /// How sharply.
    pub compression_order: f64,
    /// Noise of one symbol, in units of the accumulator, each of I and Q.
    pub noise_per_symbol: f64,
    /// Noise by the signal itself (quantisation), share of its amplitude per symbol.
    pub self_noise: f64,
    /// Noise multiplier of the leading edge's threshold (NTM).
    pub noise_multiplier: f64,
    /// Amplitude of a signal, in units per symbol, from which the chip takes its own echoes for noise.
    pub noise_growth: f64,
}

impl Default for UwbSpec {
    /// DW1000, channel 5, 64 MHz, 110 kbit/s, in a roadway.
    fn default() -> Self {
        Self {
            frequency_ghz: 6.4896,
            tx_power_dbm: -14.3,
            antenna_gain_db: 2.0,
            exponent: 1.8,
            shadowing_sigma_db: 2.0,
            shadowing_correlation_m: 3.0,
            corner_loss_db: 15.0,
            door_loss_db: 12.0,
            sensitivity_dbm: -101.0,
            most_way_m: 60.0,
            most_anchors: 6,
            obstruction_excess_m: 0.1,
            offset_m: 0.0,
            offset_sigma_m: 0.05,
            noise_m: 0.02,
            power_bias: 1.0,
            missed: 0.02,
            outliers: 0.001,
            outlier_mean_m: 5.0,
            multipath: MultipathSpec::default(),
            receiver: ReceiverSpec::default(),
        }
    }
}

impl Default for MultipathSpec {
    /// Decays and clusters of 802.15.4a's office (CM3, CM4), whose delays come nearest to the recorded set.
    fn default() -> Self {
        Self {
            echoes_db: -1.0,
            echoes_sigma_db: 2.0,
            early_db: -4.0,
            early_ns: 3.0,
            rays_per_ns: 0.5,
            clusters_per_ns: 0.03,
            cluster_decay_ns: 14.6,
            ray_decay_ns: 5.5,
            cluster_sigma_db: 3.0,
            nakagami_m: 1.0,
            blocked_decay_ns: 10.0,
            blocked_rise_ns: 8.0,
            blocked_share: 0.78,
            blocked_echo_loss: 0.6,
            patch_m: 2.0,
        }
    }
}

impl Default for ReceiverSpec {
    /// As read off the recorded set (`docs/simulation/radio.md`); NTM 13 as in Decawave's driver.
    fn default() -> Self {
        Self {
            most_symbols: 1024,
            full_amplitude: 18_000.0,
            compression_dbm: -78.0,
            compression_order: 0.7,
            noise_per_symbol: 4.0,
            self_noise: 0.13,
            noise_multiplier: 13.0,
            noise_growth: 330.0,
        }
    }
}

impl UwbSpec {
    /// Wavelength at the centre frequency, m.
    pub fn wavelength_m(&self) -> f64 {
        super::super::LIGHT_M_PER_NS / self.frequency_ghz
    }

    pub(crate) fn check(&self) -> Result<(), SimulationError> {
        check_within("frequency_ghz", self.frequency_ghz, 0.1, 60.0, "0.1 to 60 GHz")?;
        check_within("tx_power_dbm", self.tx_power_dbm, -60.0, 40.0, "-60 to 40 dBm")?;
        check_within("antenna_gain_db", self.antenna_gain_db, -40.0, 40.0, "-40 to 40 dB")?;
        check_within("exponent", self.exponent, 0.1, 10.0, "0.1 to 10")?;
        check_within("shadowing_sigma_db", self.shadowing_sigma_db, 0.0, 40.0, "0 to 40 dB")?;
        check_within("shadowing_correlation_m", self.shadowing_correlation_m, 0.1, 1e3, "0.1 to 1000 m")?;
        check_within("corner_loss_db", self.corner_loss_db, 0.0, 200.0, "0 to 200 dB")?;
        check_within("door_loss_db", self.door_loss_db, 0.0, 200.0, "0 to 200 dB")?;
        check_within("sensitivity_dbm", self.sensitivity_dbm, -130.0, 0.0, "-130 to 0 dBm")?;
        check_within("most_way_m", self.most_way_m, 1.0, 500.0, "1 to 500 m")?;
        check_within("most_anchors", self.most_anchors as f64, 1.0, 64.0, "1 to 64")?;
        check_within("obstruction_excess_m", self.obstruction_excess_m, 0.0, 100.0, "0 to 100 m")?;
        check_within("offset_m", self.offset_m, -500.0, 500.0, "-500 to 500 m")?;
        check_within("offset_sigma_m", self.offset_sigma_m, 0.0, 100.0, "0 to 100 m")?;
        check_within("noise_m", self.noise_m, 0.0, 10.0, "0 to 10 m")?;
        check_within("power_bias", self.power_bias, -10.0, 10.0, "-10 to 10")?;
        check_share("missed", self.missed)?;
        check_share("outliers", self.outliers)?;
        check_within("outlier_mean_m", self.outlier_mean_m, 0.0, 1e3, "0 to 1000 m")?;
        self.multipath.check()?;
        self.receiver.check()
    }
}

impl MultipathSpec {
    fn check(&self) -> Result<(), SimulationError> {
        for (name, found) in [("echoes_db", self.echoes_db), ("early_db", self.early_db)] {
            check_within(name, found, -100.0, 40.0, "-100 to 40 dB")?;
        }
        for (name, found) in
            [("echoes_sigma_db", self.echoes_sigma_db), ("cluster_sigma_db", self.cluster_sigma_db)]
        {
            check_within(name, found, 0.0, 20.0, "0 to 20 dB")?;
        }
        check_within("rays_per_ns", self.rays_per_ns, 0.01, 5.0, "0.01 to 5 per ns")?;
        check_within("clusters_per_ns", self.clusters_per_ns, 0.0, 1.0, "0 to 1 per ns")?;
        for (name, found) in [
            ("early_ns", self.early_ns),
            ("cluster_decay_ns", self.cluster_decay_ns),
            ("ray_decay_ns", self.ray_decay_ns),
            ("blocked_decay_ns", self.blocked_decay_ns),
            ("blocked_rise_ns", self.blocked_rise_ns),
        ] {
            check_within(name, found, 0.1, 500.0, "0.1 to 500 ns")?;
        }
        check_within("nakagami_m", self.nakagami_m, 0.1, 100.0, "0.1 to 100")?;
        check_share("blocked_share", self.blocked_share)?;
        check_within("blocked_echo_loss", self.blocked_echo_loss, 0.0, 2.0, "0 to 2")?;
        check_within("patch_m", self.patch_m, 0.1, 100.0, "0.1 to 100 m")
    }
}

impl ReceiverSpec {
    fn check(&self) -> Result<(), SimulationError> {
        check_within("most_symbols", f64::from(self.most_symbols), 16.0, 4096.0, "16 to 4096")?;
        check_within("full_amplitude", self.full_amplitude, 100.0, 25_000.0, "100 to 25000")?;
        check_within("compression_dbm", self.compression_dbm, -120.0, 40.0, "-120 to 40 dBm")?;
        check_within("compression_order", self.compression_order, 0.2, 20.0, "0.2 to 20")?;
        check_within("noise_per_symbol", self.noise_per_symbol, 0.0, 1e3, "0 to 1000")?;
        check_within("self_noise", self.self_noise, 0.0, 10.0, "0 to 10")?;
        check_within("noise_multiplier", self.noise_multiplier, 1.0, 31.0, "1 to 31")?;
        check_within("noise_growth", self.noise_growth, 1.0, 1e9, "above 1")
    }
}
