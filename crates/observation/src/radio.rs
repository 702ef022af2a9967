//! What a radio said: signal strengths, ranges, how the signal came in, and who passed a reader.

use crate::device::DeviceId;
use adit_core::time::Time;
use alloc::boxed::Box;
use alloc::sync::Arc;
use core::ops::RangeInclusive;
use serde::{Deserialize, Serialize};

/// Signal strength of one transmitter, heard by the tag (or of the tag, heard by one receiver).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SignalStrength {
    /// When it was heard.
    pub time: Time,
    /// The access point or beacon at the other end: its id in the mine, or its MAC address.
    pub transmitter: DeviceId,
    /// Received signal strength, dBm.
    pub rssi_dbm: f64,
    /// Of which kind of radio.
    pub radio: Radio,
}

/// One distance measured between the tag and an anchor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RangeSample {
    /// Time of validity.
    pub time: Time,
    /// The anchor.
    pub anchor: DeviceId,
    /// Which tag, where one carrier wears several.
    pub tag: Option<DeviceId>,
    /// The distance as measured, m; may be negative by noise and antenna delay.
    pub range_m: f64,
    /// Its standard deviation where the device tells, m.
    pub sigma_m: Option<f64>,
    /// Probability that the signal came straight, where something has judged it: 0 to 1.
    pub line_of_sight: Option<f64>,
    /// Probability of each of [`InTheWay::ALL`], in that order, where something has judged what stands in the way; not written to files.
    pub in_the_way: Option<[f32; InTheWay::COUNT]>,
    /// Of which kind of radio.
    pub radio: Radio,
    /// How the signal came in, where the device tells.
    pub reception: Option<Arc<Reception>>,
}

/// What stands between a tag and an anchor: the four environments of system S4, which it tells apart by their obstacles (Jia et al. 2024). What the paper
/// leaves open, ours: what counts is the shadow that an obstacle casts, since that is what a receiver can see.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum InTheWay {
    /// Nothing: the straight line is free (S4: ideal).
    Nothing,
    /// A shallow shadow, up to [`Self::DEEP_DB`]: somebody, the wearer as a rule, or the edge of something solid (S4: with error).
    Shallow,
    /// A deep one: a machine, a vehicle, a pillar, several people (S4: no line of sight).
    Deep,
    /// Rock: the signal came round a corner (S4: no line of sight).
    Rock,
}

/// Which radio.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Radio {
    /// Not told.
    #[default]
    Unknown,
    /// Wi-Fi.
    Wifi,
    /// Bluetooth low energy.
    Ble,
    /// Ultra-wideband.
    Uwb,
}

/// How a signal came in, in the terms of a DW1000 (Decawave, *DW1000 User Manual*, 2017, §4.7); what a device does not tell is
/// `None`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Reception {
    /// Power of the whole signal, dBm.
    pub rx_power_dbm: Option<f32>,
    /// Power of the first path, dBm.
    pub first_path_power_dbm: Option<f32>,
    /// Where in the channel impulse response the first path stands, taps of [`ImpulseResponse::TAP_NS`]; with a fraction.
    pub first_path_index_tap: Option<f32>,
    /// Where its largest amplitude stands, taps.
    pub peak_index_tap: Option<f32>,
    /// Amplitudes of the three taps from the first path on, as the device scales them.
    pub first_path_amplitudes: Option<[f32; 3]>,
    /// Standard deviation of the noise before the first path, in the same scale.
    pub noise_std: Option<f32>,
    /// Largest amplitude of that noise.
    pub noise_max: Option<f32>,
    /// Preamble symbols accumulated.
    pub preamble_count: Option<u16>,
    /// The channel impulse response.
    pub impulse_response: Option<ImpulseResponse>,
}

/// A channel impulse response as a DW1000's accumulator holds it: complex amplitudes, one tap every 1.0016 ns.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ImpulseResponse {
    /// Index in the accumulator of the first tap kept here.
    pub first_tap: u16,
    /// In-phase and quadrature amplitude of each tap, in the device's scale.
    pub taps: Box<[[i16; 2]]>,
}

/// A reader at a portal saw the tag pass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sighting {
    /// When.
    pub time: Time,
    /// The reader: its id in the mine.
    pub reader: DeviceId,
}

/// A fault of a quantity: its name, its value, what is expected.
type Fault = (&'static str, f64, &'static str);

/// Powers a receiver tells, dBm: from below the thermal noise of 1 Hz (−174 dBm) to more than a transmitter may send.
const POWER_DBM: RangeInclusive<f64> = -200.0..=50.0;

impl SignalStrength {
    /// What cannot be right, if anything: (name of the quantity, its value, what is expected).
    ///
    /// Scans mark what they did not hear by values such as +100: no power of a received signal.
    pub fn fault(&self) -> Option<Fault> {
        let possible = POWER_DBM.contains(&self.rssi_dbm);
        (!possible).then_some(("rssi_dbm", self.rssi_dbm, "-200 to 50 dBm"))
    }
}

impl RangeSample {
    /// Ranges that can be, m.
    pub(crate) const POSSIBLE_M: RangeInclusive<f64> = -1e3..=1e6;

    /// What cannot be right, if anything: (name of the quantity, its value, what is expected).
    ///
    /// Noise and antenna delay make short ranges negative by metres, never by more than a kilometre (the light of 3.3 µs); and no ranging
    /// radio reaches 1,000 km.
    pub fn fault(&self) -> Option<Fault> {
        let checks = [
            ("range_m", Some(self.range_m), Self::POSSIBLE_M, "-1,000 to 1,000,000 m"),
            ("range_sigma_m", self.sigma_m, 1e-6..=1e6, "1 µm to 1,000 km"),
            ("line_of_sight", self.line_of_sight, 0.0..=1.0, "a probability, 0 to 1"),
        ];
        first_outside(checks).or_else(|| self.reception.as_deref()?.fault())
    }
}

impl Reception {
    /// What cannot be right, if anything: (name of the quantity, its value, what is expected).
    pub fn fault(&self) -> Option<Fault> {
        const TAPS: RangeInclusive<f64> = 0.0..=ImpulseResponse::MOST_TAPS as f64;
        const AMPLITUDE: RangeInclusive<f64> = 0.0..=f32::MAX as f64;
        let (power, tap, amplitude) = (
            "-200 to 50 dBm",
            "0 to 1016, the taps of the accumulator",
            "an amplitude: a finite number, 0 or more",
        );
        let wide = |value: Option<f32>| value.map(f64::from);
        let [first, second, third] = self.first_path_amplitudes.map_or([None; 3], |a| a.map(Some));
        let checks = [
            ("rx_power_dbm", wide(self.rx_power_dbm), POWER_DBM, power),
            ("first_path_power_dbm", wide(self.first_path_power_dbm), POWER_DBM, power),
            ("first_path_index_tap", wide(self.first_path_index_tap), TAPS, tap),
            ("peak_index_tap", wide(self.peak_index_tap), TAPS, tap),
            ("first_path_amp1", wide(first), AMPLITUDE, amplitude),
            ("first_path_amp2", wide(second), AMPLITUDE, amplitude),
            ("first_path_amp3", wide(third), AMPLITUDE, amplitude),
            ("noise_std", wide(self.noise_std), AMPLITUDE, amplitude),
            ("noise_max", wide(self.noise_max), AMPLITUDE, amplitude),
        ];
        first_outside(checks).or_else(|| self.impulse_response.as_ref()?.fault())
    }
}

fn first_outside<const N: usize>(
    checks: [(&'static str, Option<f64>, RangeInclusive<f64>, &'static str); N],
) -> Option<Fault> {
    checks.into_iter().find_map(|(name, value, possible, expected)| {
        let value = value?;
        (!possible.contains(&value)).then_some((name, value, expected))
    })
}

impl InTheWay {
    /// How many there are.
    pub const COUNT: usize = 4;
    /// All of them, in order of [`RangeSample::in_the_way`].
    pub const ALL: [Self; Self::COUNT] = [Self::Nothing, Self::Shallow, Self::Deep, Self::Rock];
    /// From here on a shadow is deep, dB that it takes from the direct path: more than a trunk takes by itself.
    pub const DEEP_DB: f64 = 15.0;

    /// As written in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::Shallow => "shallow",
            Self::Deep => "deep",
            Self::Rock => "rock",
        }
    }

    /// From its name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|way| way.name() == name)
    }
}

impl Radio {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Unknown, Self::Wifi, Self::Ble, Self::Uwb];

    /// As written in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Unknown => "unknown",
            Self::Wifi => "wifi",
            Self::Ble => "ble",
            Self::Uwb => "uwb",
        }
    }

    /// From its name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|radio| radio.name() == name)
    }
}

impl ImpulseResponse {
    /// Time from tap to tap, ns: half a period of the DW1000's 499.2 MHz.
    pub const TAP_NS: f64 = 1e3 / (2.0 * 499.2);
    /// Taps of a DW1000's accumulator at a pulse repetition frequency of 64 MHz.
    pub const MOST_TAPS: usize = 1016;

    /// What cannot be right, if anything: (name of the quantity, its value, what is expected).
    pub fn fault(&self) -> Option<Fault> {
        let (count, first) = (self.taps.len(), usize::from(self.first_tap));
        if !(1..=Self::MOST_TAPS).contains(&count) {
            return Some(("impulse_response taps", count as f64, "1 to 1016"));
        }
        let room = Self::MOST_TAPS - count;
        let expected = "one that leaves room for all taps in an accumulator of 1016";
        (first > room).then_some(("impulse_response first_tap", first as f64, expected))
    }
}
