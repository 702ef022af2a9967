//! What walkers measure, second by second, as packets in which only name, number and time are still to be set.
//!
//! Encoding ten thousand packets a second would take the processor that the server needs. So each second of a walk is encoded once, with
//! marks in place of what changes: the number and the whole second are written as varints of five bytes, which every time of this century
//! and every number from 2²⁸ on needs. A packet is a copy with the marks overwritten.

use adit_core::time::Time;
use adit_mine::Mine;
use adit_observation::wire::{Packet, Resolution};
use adit_observation::{DeviceId, Observation};
use adit_simulation::people::{Belt, PersonSpec, Place, Roam};
use adit_simulation::workforce::{Mount, Outfit, Workforce, WorkforceSpec};
use anyhow::{Context, Result, bail};
use rayon::prelude::*;
use std::sync::Arc;

const SECOND_NS: i64 = 1_000_000_000;
/// Numbers begin here: from here on they are five bytes.
pub const FIRST_NUMBER: u64 = 1 << 28;
/// A name of seven bytes, for the place of all names.
const NAME: &str = "T000000";
/// Two marks of five bytes that differ in each; what has the one in one encoding and the other in the other is a second.
const SECONDS: [i64; 2] = [0x6284_c911, 0x54a9_11a2];
const NUMBERS: [u64; 2] = [0x768c_d931, 0x48b1_21c2];
/// Bytes of a varint between 2²⁸ and 2³⁵.
const MARK: usize = 5;

/// A second of a walk.
pub struct Template {
    bytes: Vec<u8>,
    name: usize,
    number: usize,
    seconds: Vec<usize>,
    /// Observations in it.
    pub observations: usize,
}

impl Template {
    fn new(observations: &[Observation]) -> Result<Self> {
        let encoded = |index: usize| -> Result<Vec<u8>> {
            let moved = |o: &Observation| {
                let within = o.time().nanos().rem_euclid(SECOND_NS);
                o.clone().at(Time::from_nanos(SECONDS[index] * SECOND_NS + within))
            };
            let tag = DeviceId::new(NAME).context("a name of a tag")?;
            let observations = observations.iter().map(moved).collect();
            let packet =
                Packet { tag, number: NUMBERS[index], battery: Some(0.9), distress: false, observations };
            Ok(packet.to_bytes(&Resolution::default()))
        };
        let (first, second) = (encoded(0)?, encoded(1)?);
        let marked = |marks: [[u8; MARK]; 2]| -> Vec<usize> {
            let is_mark = |at: &usize| has(&first, *at, marks[0]) && has(&second, *at, marks[1]);
            (0..first.len()).filter(is_mark).collect()
        };
        let seconds = marked(SECONDS.map(|second| varint(second.unsigned_abs())));
        let number = marked(NUMBERS.map(varint));
        let name = first.windows(NAME.len()).position(|window| window == NAME.as_bytes());
        let differing = first.iter().zip(&second).filter(|(a, b)| a != b).count();
        let (Some(name), [number]) = (name, number.as_slice()) else { bail!("a packet without its marks") };
        if first.len() != second.len() || differing != MARK * (seconds.len() + 1) {
            bail!("a packet whose times cannot be set: {differing} bytes differ, {} times", seconds.len());
        }
        Ok(Self { bytes: first, name, number: *number, seconds, observations: observations.len() })
    }

    /// The packet of a tag: its name of six digits, its number, the second in which it was measured.
    pub fn packet(&self, tag: u32, number: u64, second: i64) -> Vec<u8> {
        let mut bytes = self.bytes.clone();
        let mut digits = tag;
        for at in (self.name + 1..self.name + NAME.len()).rev() {
            bytes[at] = b'0' + u8::try_from(digits % 10).unwrap_or_default();
            digits /= 10;
        }
        bytes[self.number..self.number + MARK].copy_from_slice(&varint(number));
        let second = varint(second.unsigned_abs());
        for at in &self.seconds {
            bytes[*at..*at + MARK].copy_from_slice(&second);
        }
        bytes
    }
}

fn has(bytes: &[u8], at: usize, mark: [u8; MARK]) -> bool {
    bytes.get(at..at + MARK) == Some(&mark)
}

/// A number between 2²⁸ and 2³⁵ as protobuf writes it.
fn varint(number: u64) -> [u8; MARK] {
    std::array::from_fn(|index| {
        let group = u8::try_from((number >> (7 * index)) & 0x7f).unwrap_or_default();
        if index + 1 < MARK { group | 0x80 } else { group }
    })
}

/// The walks: for each walker, each second.
pub fn walks(
    mine: &Arc<Mine>,
    walkers: u32,
    seconds: u32,
    ranging_hz: f64,
    seed: u64,
) -> Result<Vec<Vec<Template>>> {
    let duration_s = f64::from(seconds);
    let roadway = mine
        .plan()
        .roadways
        .iter()
        .find(|roadway| roadway.walkable)
        .context("the mine has no roadway to walk on")?;
    let mut roam = Roam::on_level("", duration_s, 250.0, 0.3, [5.0, 30.0]);
    // A roadway that leads from level to level is of none: places are drawn on all.
    roam.levels = roadway.level.iter().cloned().collect();
    let start = Place::Roadway { id: roadway.id.clone(), along_m: 1.0, left_m: 0.0 };
    let person = PersonSpec::roaming(start, 5.0, roam);
    let outfit = Outfit::plain(Mount::Belt(Belt::front()), ranging_hz);
    let spec = WorkforceSpec::undisturbed(duration_s, vec![person], outfit);
    (0..walkers)
        .into_par_iter()
        .map(|walker| {
            let workforce = Workforce::new(Arc::clone(mine), spec.clone(), seed + u64::from(walker))?;
            let stream = workforce.stream(0).context("nobody walks")??;
            let mut by_second: Vec<Vec<Observation>> = (0..seconds).map(|_| Vec::new()).collect();
            for emission in stream {
                let observation = emission.observation();
                let second = observation.time().nanos().div_euclid(SECOND_NS);
                let second = usize::try_from(second).ok().and_then(|second| by_second.get_mut(second));
                if let Some(second) = second {
                    second.push(observation);
                }
            }
            by_second.iter().map(|second| Template::new(second)).collect()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use adit_core::time::Interval;
    use adit_observation::wire::PacketReader;
    use std::path::Path;

    #[test]
    fn a_packet_of_a_template_is_the_packet_that_was_meant() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../mines/two-level.toml");
        let mine = Arc::new(adit_mine::file::open(Path::new(file)).unwrap().0);
        let walks = walks(&mine, 1, 12, 5.0, 3).unwrap();
        for (index, template) in (0_u64..).zip(&walks[0]) {
            let (number, second) = (FIRST_NUMBER + index, 1_795_000_000 + i64::try_from(index).unwrap());
            let bytes = template.packet(4711, number, second);
            let packet = PacketReader::default().read(&bytes.into()).unwrap();
            assert_eq!((packet.tag.as_str(), packet.number), ("T004711", number));
            assert_eq!(packet.observations.len(), template.observations);
            let start = Time::from_nanos(second * SECOND_NS);
            let within = start..start + Interval::from_nanos(SECOND_NS);
            assert!(packet.observations.iter().all(|o| within.contains(&o.time())));
        }
    }
}
