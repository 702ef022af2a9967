//! What comes twice counts once.
//!
//! A gateway that sends again, or two gateways that heard the same, make copies: same kind, same device, same time. What is wired comes in order, so that a copy has the time of
//! the one before. What comes by radio is remembered for the last [`MOST`] observations; ranges are told apart within their epoch
//! ([`crate::ranging::epochs`]).

use adit_core::time::Time;
use adit_observation::{Observation, ObservationKind};
use alloc::collections::VecDeque;
use serde::{Deserialize, Serialize};

/// How many are remembered.
pub const MOST: usize = 64;

/// What came lately.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Repeats {
    /// The last of each kind that is wired.
    wired: [Option<Time>; 4],
    /// Digest of kind and device, and the time.
    heard: VecDeque<(u64, Time)>,
}

impl Repeats {
    /// Whether it came before; remembers it.
    #[inline]
    pub fn is_repeated(&mut self, observation: &Observation) -> bool {
        let time = observation.time();
        match observation {
            Observation::Imu(_) => self.wired[0].replace(time) == Some(time),
            Observation::Acceleration(_) => self.wired[1].replace(time) == Some(time),
            Observation::Magnetic(_) => self.wired[2].replace(time) == Some(time),
            Observation::Pressure(_) => self.wired[3].replace(time) == Some(time),
            Observation::Signal(signal) => {
                self.is_known(digest(observation.kind(), signal.transmitter.as_str()), time)
            }
            Observation::Sighting(sighting) => {
                self.is_known(digest(observation.kind(), sighting.reader.as_str()), time)
            }
            Observation::Fix(fix) => self.is_known(digest(observation.kind(), fix.source.name()), time),
            Observation::Range(_) => false,
        }
    }

    fn is_known(&mut self, device: u64, time: Time) -> bool {
        if self.heard.contains(&(device, time)) {
            return true;
        }
        if self.heard.len() == MOST {
            self.heard.pop_front();
        }
        self.heard.push_back((device, time));
        false
    }
}

/// FNV-1a, 64 bits (Fowler, Noll & Vo): two devices are one only if they have the same one and the same nanosecond.
fn digest(kind: ObservationKind, device: &str) -> u64 {
    let bytes = [kind as u8].into_iter().chain(device.bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |sum, byte| (sum ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}
