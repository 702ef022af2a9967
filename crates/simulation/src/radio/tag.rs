//! One person's tag: what it remembers, its own random draws, and the portals that see it.

use super::keyed::{Key, uniform};
use super::paths::Paths;
use super::scene::{Antenna, Obstacle, Surroundings, wearer};
use super::uwb::echoes::Echoes;
use super::uwb::{Heard, RangeDetail};
use super::world::{Purpose, RadioWorld};
use adit_core::frames::Position;
use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use adit_observation::Sighting;
use rand_chacha::ChaCha8Rng;

/// Obstacles farther away than this do not count, m.
const NEAR_M: f64 = 60.0;
/// So many of them at most, the first in the list.
const MOST_NEAR: usize = 64;

/// A tag: ask it in the order of time. Memory is bounded: some dozen devices and their echoes.
#[derive(Debug, Clone)]
pub struct Tag {
    pub(crate) scan_rng: ChaCha8Rng,
    pub(crate) exchange_rng: ChaCha8Rng,
    /// Noise of receptions: each begins at a block of its own, so that what is written of one does not change the next.
    pub(crate) receiver_rng: ChaCha8Rng,
    pub(crate) receptions: u64,
    sighting_rng: ChaCha8Rng,
    pub(crate) anchor_paths: Paths,
    pub(crate) transmitter_paths: Paths,
    pub(crate) echoes: Echoes,
    pub(crate) near: Vec<Obstacle>,
    pub(crate) heard: Vec<Heard>,
    pub(crate) detail: RangeDetail,
}

impl Tag {
    pub(crate) fn new(seed: u64, person: u64) -> Self {
        let stream = |purpose: Purpose| Key::new(seed, purpose as u64).with(person).stream();
        Self {
            scan_rng: stream(Purpose::Scan),
            exchange_rng: stream(Purpose::Exchange),
            receiver_rng: stream(Purpose::Receiver),
            receptions: 0,
            sighting_rng: stream(Purpose::Sighting),
            anchor_paths: Paths::default(),
            transmitter_paths: Paths::default(),
            echoes: Echoes::default(),
            near: Vec::with_capacity(MOST_NEAR),
            heard: Vec::new(),
            detail: RangeDetail::default(),
        }
    }

    /// How much is told of each range from now on; the ranges themselves are the same with any.
    #[must_use]
    pub fn with_detail(mut self, detail: RangeDetail) -> Self {
        self.detail = detail;
        self
    }

    /// Keeps the obstacles that can matter here.
    pub(crate) fn look_around(&mut self, antenna: &Antenna, around: &Surroundings<'_>) {
        self.near.clear();
        let here = antenna.position_m;
        let near = around.obstacles.iter().filter(|o| (o.foot_m - here).norm() < NEAR_M + o.reach_m());
        self.near.extend(near.take(MOST_NEAR));
    }

    /// Polls all portals once, at `time_s` after the start; appends who saw the tag.
    pub fn sightings(
        &mut self,
        world: &RadioWorld,
        time_s: f64,
        antenna: &Antenna,
        around: &Surroundings<'_>,
        out: &mut Vec<Sighting>,
    ) {
        let Some(time) = Time::from_seconds(time_s) else { return };
        let here = antenna.position_m;
        let reached = |place: &Vector3<f64>, range_m: f64| (place - here).norm() <= range_m;
        let portals =
            world.portals.iter().filter(|p| reached(&p.place_m, p.range_m) && !p.dead.dead_at(time_s));
        let mut looked = false;
        for portal in portals {
            if !looked {
                self.look_around(antenna, around);
                looked = true;
            }
            let ends = [here, portal.place_m].map(Position::from_raw);
            let rock_m = world.mine().excavation().rock_m(&ends[0], &ends[1]);
            if rock_m > super::paths::EMBEDDED_M {
                continue;
            }
            let trunk = wearer(antenna, &world.spec().body);
            let wavelength_m = world.spec().uwb.wavelength_m();
            let found = world.in_the_way(&here, &portal.place_m, trunk.as_ref(), &self.near, wavelength_m);
            let portals = &world.spec().portals;
            let seen = if found.detour.blocked { portals.seen_blocked } else { portals.seen };
            if uniform(&mut self.sighting_rng) < seen {
                out.push(Sighting { time, reader: portal.id.clone() });
            }
        }
    }
}
