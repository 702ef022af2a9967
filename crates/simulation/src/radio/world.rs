//! The radio of a mine: its devices, what stands still between them, when they are dead.

use super::field::{FadingField, ShadowField};
use super::keyed::Key;
use super::outage::{DeadTimes, Outage};
use super::paths::Field;
use super::scene::{Line, Shape, Surroundings};
use super::screen::Detour;
use super::spec::RadioSpec;
use super::tag::Tag;
use super::uwb::receiver::Receiver;
use super::ways::Ways;
use crate::error::SimulationError;
use adit_core::nalgebra::{Vector2, Vector3};
use adit_mine::Mine;
use adit_mine::plan::{self, AccessPoint, Anchor, PathLoss};
use adit_observation::{DeviceId, Radio};
use std::sync::Arc;

/// What a random draw is for; a purpose keeps its number, so that a further one changes no other.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Purpose {
    Shadow = 1,
    Fading = 2,
    UwbShadow = 3,
    Echoes = 4,
    AnchorOffset = 5,
    Outage = 6,
    Scan = 7,
    Exchange = 8,
    Receiver = 9,
    Sighting = 10,
    Clock = 11,
    Link = 12,
}

/// The radio of a mine. Shared by all tags; holds nothing that changes.
#[derive(Debug, Clone)]
pub struct RadioWorld {
    mine: Arc<Mine>,
    spec: RadioSpec,
    seed: u64,
    pub(crate) anchors: Vec<AnchorSite>,
    pub(crate) transmitters: Vec<TransmitterSite>,
    pub(crate) portals: Vec<PortalSite>,
    anchor_places: Vec<Vector3<f64>>,
    transmitter_places: Vec<Vector3<f64>>,
    anchor_ways: Ways,
    transmitter_ways: Ways,
    pillars: Vec<Prism>,
    doors: Vec<DoorLine>,
    belts: Vec<(Vector3<f64>, Vector3<f64>)>,
    pub(crate) receiver: Receiver,
}

#[derive(Debug, Clone)]
pub(crate) struct AnchorSite {
    pub id: DeviceId,
    pub offset_m: f64,
    pub tx_power_dbm: f64,
    pub shadow: ShadowField,
    pub dead: DeadTimes,
}

#[derive(Debug, Clone)]
pub(crate) struct TransmitterSite {
    pub id: DeviceId,
    pub radio: Radio,
    pub tx_power_dbm: f64,
    pub path_loss: Option<PathLoss>,
    pub shadow: ShadowField,
    pub fading: FadingField,
    pub dead: DeadTimes,
}

#[derive(Debug, Clone)]
pub(crate) struct PortalSite {
    pub id: DeviceId,
    pub place_m: Vector3<f64>,
    pub range_m: f64,
    pub dead: DeadTimes,
}

/// A pillar or machine that stands still.
#[derive(Debug, Clone)]
struct Prism {
    corners: Vec<Vector2<f64>>,
    middle: Vector2<f64>,
    reach_m: f64,
    band_m: (f64, f64),
    /// It reaches the roof: nothing bends over it.
    whole: bool,
}

/// A closed door.
#[derive(Debug, Clone)]
pub(crate) struct DoorLine {
    ends: [Vector2<f64>; 2],
    band_m: (f64, f64),
    pub attenuation_db: Option<f64>,
}

/// What stands in the way of one link.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Standing {
    pub detour: Detour,
    pub pillars: u8,
    pub machines: u8,
    pub people: u8,
    pub vehicles: u8,
    pub wearer: bool,
}

impl RadioWorld {
    /// The devices of a mine with these radios and failures; `seed` fixes what is random about them.
    pub fn new(
        mine: impl Into<Arc<Mine>>,
        spec: &RadioSpec,
        outages: &[Outage],
        seed: u64,
    ) -> Result<Self, SimulationError> {
        spec.check()?;
        let mine: Arc<Mine> = mine.into();
        outages.iter().try_for_each(|outage| outage.check(&mine))?;
        let plan = mine.plan();
        let anchor_places: Vec<_> = plan.anchors.iter().map(|a| *a.position_m.raw()).collect();
        let transmitter_places: Vec<_> = plan.access_points.iter().map(|a| *a.position_m.raw()).collect();
        let dead = |id: &str, place: &Vector3<f64>| {
            DeadTimes::of(id, place, &mine, outages, Key::new(seed, Purpose::Outage as u64))
        };
        let sites = Sites { spec, seed };
        let anchors = (0..)
            .zip(&plan.anchors)
            .map(|(number, anchor)| sites.anchor(number, anchor, dead(&anchor.id, anchor.position_m.raw())));
        let transmitters = (0..)
            .zip(&plan.access_points)
            .map(|(number, ap)| sites.transmitter(number, ap, dead(&ap.id, ap.position_m.raw())));
        let portals = plan.rfid_portals.iter().map(|portal| {
            let place_m = *portal.position_m.raw();
            Ok(PortalSite {
                id: id(&portal.id)?,
                place_m,
                range_m: portal.range_m,
                dead: dead(&portal.id, &place_m),
            })
        });
        let most_way_m = spec.wifi.most_way_m.max(spec.ble.most_way_m);
        let belt = |c: &plan::Conveyor| {
            let points: Vec<_> = c.points_m.iter().map(|p| *p.raw()).collect();
            points.windows(2).map(|w| (w[0], w[1])).collect::<Vec<_>>()
        };
        Ok(Self {
            anchors: anchors.collect::<Result<_, _>>()?,
            transmitters: transmitters.collect::<Result<_, _>>()?,
            portals: portals.collect::<Result<_, _>>()?,
            anchor_ways: Ways::new(&mine, &anchor_places, spec.uwb.most_way_m),
            transmitter_ways: Ways::new(&mine, &transmitter_places, most_way_m),
            anchor_places,
            transmitter_places,
            pillars: plan.pillars.iter().filter_map(|pillar| Prism::new(&mine, pillar)).collect(),
            doors: plan
                .doors
                .iter()
                .filter(|d| d.closed)
                .filter_map(|door| DoorLine::new(&mine, door))
                .collect(),
            belts: plan.conveyors.iter().flat_map(belt).collect(),
            receiver: Receiver::new(spec.uwb.receiver),
            spec: spec.clone(),
            mine: Arc::clone(&mine),
            seed,
        })
    }

    /// The tag of a person: draws of its own, whatever other tags do.
    pub fn tag(&self, person: u64) -> Tag {
        Tag::new(self.seed, person)
    }

    /// The mine.
    pub fn mine(&self) -> &Mine {
        &self.mine
    }

    /// What was set.
    pub fn spec(&self) -> &RadioSpec {
        &self.spec
    }

    pub(crate) fn key(&self, purpose: Purpose) -> Key {
        Key::new(self.seed, purpose as u64)
    }

    pub(crate) fn doors(&self) -> &[DoorLine] {
        &self.doors
    }

    /// Anchors as ranging sees them.
    pub(crate) fn anchor_field(&self) -> Field<'_> {
        Field {
            places_m: &self.anchor_places,
            ways: &self.anchor_ways,
            most_way_m: self.spec.uwb.most_way_m,
            door_loss_db: self.spec.uwb.door_loss_db,
        }
    }

    /// Transmitters as a scan sees them.
    pub(crate) fn transmitter_field(&self) -> Field<'_> {
        Field {
            places_m: &self.transmitter_places,
            ways: &self.transmitter_ways,
            most_way_m: self.spec.wifi.most_way_m.max(self.spec.ble.most_way_m),
            door_loss_db: self.spec.wifi.door_loss_db,
        }
    }

    /// What stands in the way from a tag to a place, the wearer first.
    pub(crate) fn in_the_way(
        &self,
        tag_m: &Vector3<f64>,
        to_m: &Vector3<f64>,
        wearer: Option<&super::scene::Obstacle>,
        near: &[super::scene::Obstacle],
        wavelength_m: f64,
    ) -> Standing {
        let mut found = Standing::default();
        let Some(line) = Line::new(tag_m, to_m) else { return found };
        let mut add = |detour: Detour| {
            found.detour.loss_db += detour.loss_db;
            found.detour.excess_m += detour.excess_m;
            found.detour.blocked |= detour.blocked;
            detour.blocked
        };
        // Fresnel zones of the longest waves here are some metres wide; beyond that an edge takes nothing.
        let margin_m = 1.0;
        let mut wearer_blocks = false;
        if let Some(screen) = wearer.and_then(|wearer| wearer.screen(&line)) {
            wearer_blocks = add(line.detour(&screen, wavelength_m));
        }
        let [mut people, mut vehicles, mut pillars, mut machines] = [0_u8; 4];
        for obstacle in near {
            if line.passes(&obstacle.foot_m.xy(), obstacle.reach_m() + margin_m)
                && let Some(screen) = obstacle.screen(&line)
            {
                let of = match obstacle.shape {
                    Shape::Round { .. } => &mut people,
                    Shape::Box { .. } => &mut vehicles,
                };
                *of = of.saturating_add(u8::from(add(line.detour(&screen, wavelength_m))));
            }
        }
        for prism in &self.pillars {
            if (prism.band_m.0..prism.band_m.1).contains(&tag_m.z)
                && line.passes(&prism.middle, prism.reach_m + margin_m)
                && let Some(screen) = line.screen_of(&prism.corners, prism.band_m.1)
            {
                let of = if prism.whole { &mut pillars } else { &mut machines };
                *of = of.saturating_add(u8::from(add(line.detour(&screen, wavelength_m))));
            }
        }
        Standing { pillars, machines, people, vehicles, wearer: wearer_blocks, ..found }
    }

    /// Distance from the nearest running belt, m.
    pub(crate) fn belt_distance_m(&self, place_m: &Vector3<f64>, around: &Surroundings<'_>) -> Option<f64> {
        if !around.conveyors_run {
            return None;
        }
        let distance = |(a, b): &(Vector3<f64>, Vector3<f64>)| {
            let run = b - a;
            let share = (run.dot(&(place_m - a)) / run.norm_squared().max(1e-12)).clamp(0.0, 1.0);
            (a + run * share - place_m).norm()
        };
        self.belts.iter().map(distance).min_by(f64::total_cmp)
    }
}

struct Sites<'s> {
    spec: &'s RadioSpec,
    seed: u64,
}

impl Sites<'_> {
    fn key(&self, purpose: Purpose, number: u64) -> Key {
        Key::new(self.seed, purpose as u64).with(number)
    }

    fn anchor(&self, number: u64, anchor: &Anchor, dead: DeadTimes) -> Result<AnchorSite, SimulationError> {
        let uwb = &self.spec.uwb;
        let drawn = uwb.offset_sigma_m * self.key(Purpose::AnchorOffset, number).draws().normal();
        Ok(AnchorSite {
            id: id(&anchor.id)?,
            offset_m: uwb.offset_m + anchor.range_offset_m.unwrap_or(drawn),
            tx_power_dbm: anchor.tx_power_dbm.unwrap_or(uwb.tx_power_dbm),
            shadow: ShadowField::new(self.key(Purpose::UwbShadow, number), uwb.shadowing_correlation_m),
            dead,
        })
    }

    fn transmitter(
        &self,
        number: u64,
        ap: &AccessPoint,
        dead: DeadTimes,
    ) -> Result<TransmitterSite, SimulationError> {
        let (radio, spec) = match ap.radio {
            plan::Radio::Wifi => (Radio::Wifi, &self.spec.wifi),
            plan::Radio::Ble => (Radio::Ble, &self.spec.ble),
        };
        Ok(TransmitterSite {
            id: id(ap.mac.as_deref().unwrap_or(&ap.id))?,
            radio,
            tx_power_dbm: ap.tx_power_dbm.unwrap_or(spec.tx_power_dbm),
            path_loss: ap.path_loss,
            shadow: ShadowField::new(self.key(Purpose::Shadow, number), spec.shadowing_correlation_m),
            fading: FadingField::new(self.key(Purpose::Fading, number), spec.wavelength_m()),
            dead,
        })
    }
}

/// A name as logs have it.
fn id(name: &str) -> Result<DeviceId, SimulationError> {
    DeviceId::new(name).ok_or(SimulationError::Parameter {
        name: "length of a device's id",
        found: name.len() as f64,
        expected: "1 to 64 bytes without control characters",
    })
}

impl Prism {
    fn new(mine: &Mine, pillar: &plan::Pillar) -> Option<Self> {
        let (low, high) = mine.band_m(&pillar.level)?;
        let level = mine.plan().levels.iter().find(|level| level.id == pillar.level)?;
        // A pillar that reaches the roof has no top to bend over.
        let top = pillar.height_m.map_or(high, |height| (level.elevation_m + height).min(high));
        let corners: Vec<_> = pillar.outline_m.iter().map(|c| Vector2::from(*c)).collect();
        let middle = corners.iter().sum::<Vector2<f64>>() / corners.len() as f64;
        let reach_m = corners.iter().map(|c| (c - middle).norm()).fold(0.0, f64::max);
        Some(Self { corners, middle, reach_m, band_m: (low, top.min(1e7)), whole: top >= high })
    }
}

impl DoorLine {
    fn new(mine: &Mine, door: &plan::Door) -> Option<Self> {
        let band_m = mine.band_m(&door.level)?;
        Some(Self { ends: door.ends_m.map(Vector2::from), band_m, attenuation_db: door.attenuation_db })
    }

    /// Does a line go through it?
    pub fn crossed(&self, a: &Vector3<f64>, b: &Vector3<f64>) -> bool {
        let [c, d] = self.ends;
        let (run, door, off) = (b.xy() - a.xy(), d - c, c - a.xy());
        let turn = run.perp(&door);
        if turn == 0.0 {
            return false;
        }
        let (s, t) = (off.perp(&door) / turn, off.perp(&run) / turn);
        let inside = (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t);
        inside && (self.band_m.0..self.band_m.1).contains(&(a.z + s * (b.z - a.z)))
    }
}
