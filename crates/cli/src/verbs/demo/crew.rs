//! The tags of the shift: what each of them measures in a second, as the packet that it sends.

use super::story::{GATEWAY, Part, Story};
use adit_core::nalgebra::Vector3;
use adit_core::time::{Interval, Time};
use adit_mine::Mine;
use adit_observation::wire::{Packet, Resolution};
use adit_observation::{DeviceId, Observation};
use adit_simulation::Motion as _;
use adit_simulation::people::Belt;
use adit_simulation::radio::delivery::Stamped as _;
use adit_simulation::workforce::{Mount, Outfit, RadioRates, TagStream, Workforce, WorkforceSpec, Worn};
use anyhow::{Context, Result};
use rayon::prelude::*;
use std::iter::Peekable;
use std::sync::Arc;

const SECOND: Interval = Interval::from_nanos(1_000_000_000);
/// Gateways, and where on a level the east begins, m.
pub const GATEWAYS: [&str; 5] = ["gw-l300-west", "gw-l300-east", "gw-l360-west", GATEWAY, "gw-decline"];
const EAST_M: f64 = 5450.0;
/// A charge lasts a shift of ten hours and then some.
const DRAIN_PER_S: f64 = 1.0 / 57_600.0;

/// A tag with who wears it.
struct Wearer {
    stream: Peekable<TagStream>,
    motion: Arc<Worn>,
    tag: DeviceId,
    part: Part,
    comes_s: f64,
    charge: f64,
}

impl Wearer {
    fn sends(&self, time_s: f64, battery_s: f64) -> bool {
        time_s >= self.comes_s && !(self.part == Part::Silent && time_s >= battery_s)
    }
}

/// What a tag sends at the end of a second.
pub struct Sent {
    /// By which gateway, of [`GATEWAYS`].
    pub gateway: usize,
    /// The packet.
    pub packet: Vec<u8>,
    /// Observations in it.
    pub observations: usize,
}

/// All tags.
pub struct Crew {
    wearers: Vec<Wearer>,
    begin: Time,
    second: i64,
    button_s: f64,
    battery_s: f64,
}

/// Where the tags truly are.
#[derive(Clone)]
pub struct Truth {
    motions: Arc<Vec<Arc<Worn>>>,
    begin: Time,
}

impl Truth {
    /// Of a tag, by number, at a time.
    pub fn position_m(&self, wearer: usize, time: Time) -> Option<Vector3<f64>> {
        let time_s = (time - self.begin).seconds();
        self.motions.get(wearer).map(|motion| motion.at(time_s).position_m)
    }
}

impl Crew {
    /// Puts the tags on; the shift begins when [`Self::begin_at`] says.
    pub fn new(mine: &Arc<Mine>, story: &Story, length_s: f64, seed: u64) -> Result<Self> {
        let plain = Outfit::plain(Mount::Belt(Belt::front()), 1.0);
        let radio = RadioRates { scan_hz: 0.2, portal_hz: 0.0, ..plain.radio };
        let outfit = Outfit { radio, ..plain };
        let spec = WorkforceSpec {
            outages: story.outages.clone(),
            ..WorkforceSpec::undisturbed(length_s, story.persons.clone(), outfit)
        };
        let workforce = Workforce::new(Arc::clone(mine), spec, seed)?;
        let wearers = story.members.par_iter().enumerate().map(|(number, member)| {
            let stream = workforce.stream(number).context("nobody of this number")??;
            let motion = Arc::clone(stream.motion());
            let tag = DeviceId::new(&member.tag).context("a name of a tag")?;
            // Charged over the last shifts, not all of them well.
            let charge = match member.part {
                Part::Silent => 0.2 + story.times.battery * DRAIN_PER_S * 0.5,
                _ => 0.45 + 0.5 * ((number * 37) % 100) as f64 / 100.0,
            };
            let (part, comes_s) = (member.part, member.comes_s);
            Ok(Wearer { stream: stream.peekable(), motion, tag, part, comes_s, charge })
        });
        let wearers = wearers.collect::<Result<Vec<_>>>()?;
        let (button_s, battery_s) = (story.times.button, story.times.battery);
        Ok(Self { wearers, begin: Time::ZERO, second: 0, button_s, battery_s })
    }

    /// The shift begins at this time.
    pub fn begin_at(&mut self, begin: Time) {
        self.begin = begin;
    }

    /// For how long everybody has been simulated, s.
    pub fn seconds(&self) -> f64 {
        self.second as f64
    }

    /// How many tags send.
    pub fn sending(&self) -> usize {
        let now_s = self.seconds();
        self.wearers.iter().filter(|wearer| wearer.sends(now_s, self.battery_s)).count()
    }

    /// Where they truly are.
    pub fn truth(&self) -> Truth {
        let motions = self.wearers.iter().map(|wearer| Arc::clone(&wearer.motion)).collect();
        Truth { motions: Arc::new(motions), begin: self.begin }
    }

    /// What all tags send at the end of the next second.
    pub fn next_second(&mut self) -> Vec<Sent> {
        let Self { wearers, begin, second, button_s, battery_s } = self;
        let (from_s, number) = (*second as f64, second.unsigned_abs() + 1);
        *second += 1;
        let until = Time::ZERO + Interval::from_nanos(SECOND.nanos() * *second);
        let since = *begin - Time::ZERO;
        let sent = wearers.par_iter_mut().filter_map(|wearer| {
            let mut observations: Vec<Observation> = Vec::with_capacity(128);
            while let Some(emission) = wearer.stream.next_if(|emission| emission.time() < until) {
                let time = emission.time() + since;
                observations.push(emission.observation().at(time));
            }
            if !wearer.sends(from_s, *battery_s) {
                return None;
            }
            let count = observations.len();
            let packet = Packet {
                tag: wearer.tag.clone(),
                number,
                battery: Some((wearer.charge - from_s * DRAIN_PER_S).clamp(0.0, 1.0)),
                distress: wearer.part == Part::Witness && (*button_s..*button_s + 3.0).contains(&from_s),
                observations,
            };
            let packet = packet.to_bytes(&Resolution::default());
            let gateway = gateway(&wearer.motion.at(from_s).position_m);
            Some(Sent { gateway, packet, observations: count })
        });
        sent.collect()
    }
}

/// The gateway that hears a tag.
fn gateway(place_m: &Vector3<f64>) -> usize {
    let east = usize::from(place_m.x > EAST_M);
    match place_m.z {
        z if z > 130.0 => 4,
        z if z > 90.0 => east,
        _ => 2 + east,
    }
}
