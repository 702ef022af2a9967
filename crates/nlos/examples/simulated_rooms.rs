//! `simulated_rooms OUT ROOMS SEED`: labelled responses of simulated rooms, laid out as `adit nlos train --also OUT` reads them.
//!
//! Each room has one anchor and one tag 1 to 9 m apart, a third of them with nothing, a narrow or a wide pillar in between; the radio of each room (power of
//! its echoes, of an early one, what a pillar takes of them) is drawn about that of the flat in which `uwb-cir` was recorded
//! (`crates/simulation/examples/radio_realism`). The truth of each range is the simulation's own, not the pillar's.

use adit_core::frames::Position;
use adit_core::nalgebra::Vector3;
use adit_mine::Mine;
use adit_mine::plan::{Anchor, Chamber, Grid, Level, MinePlan, Pillar, Roadway, RoadwayKind};
use adit_nlos::window;
use adit_observation::ImpulseResponse;
use adit_observation::csv_log::labelled::{FIRST_TAP, TAPS};
use adit_simulation::radio::{Antenna, LinkClass, RadioSpec, RadioWorld, RangeDetail, Surroundings, UwbSpec};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Uniform};
use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;

/// Exchanges in a room.
const EXCHANGES: u32 = 30;
/// Antenna delay, as range.
const OFFSET_M: f64 = 0.2;

struct Room {
    distance_m: f64,
    /// Width of the pillar and where it stands, share of the way.
    pillar: Option<(f64, f64)>,
    spec: RadioSpec,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [out, rooms, seed] = arguments.as_slice() else {
        return Err("usage: simulated_rooms OUT ROOMS SEED".into());
    };
    let (rooms, seed): (u64, u64) = (rooms.parse()?, seed.parse()?);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut table = String::from(
        "geometry_id,nlos,true_range_m,range_m,first_path_index_tap,preamble_count,rx_power_dBm,first_path_power_dBm,peak_index_tap,\
         pre_first_path_amplitude_std\n",
    );
    let mut responses = Vec::new();
    for number in 0..rooms {
        let room = draw(number, &mut random)?;
        exchanges(&room, number, seed, &mut table, &mut responses)?;
    }
    std::fs::create_dir_all(out)?;
    std::fs::write(Path::new(out).join("meta.csv"), table)?;
    std::fs::write(Path::new(out).join("cir_i16le.bin"), responses)?;
    Ok(())
}

fn draw(number: u64, random: &mut ChaCha8Rng) -> Result<Room, Box<dyn Error>> {
    let mut between = |low: f64, high: f64| Ok::<_, Box<dyn Error>>(Uniform::new(low, high)?.sample(random));
    let pillar = match number % 3 {
        0 => None,
        1 => Some((between(0.3, 1.3)?, between(0.2, 0.8)?)),
        _ => Some((between(1.2, 2.5)?, between(0.3, 0.7)?)),
    };
    let mut spec = RadioSpec {
        uwb: UwbSpec {
            missed: 0.0,
            outliers: 0.0,
            obstruction_excess_m: 0.0,
            antenna_gain_db: 0.0,
            most_way_m: 100.0,
            ..UwbSpec::default()
        },
        ..RadioSpec::default()
    };
    spec.uwb.multipath.echoes_db = between(-4.5, 1.5)?;
    spec.uwb.multipath.early_db = between(-4.0, 2.0)?;
    spec.uwb.multipath.early_ns = between(1.5, 4.0)?;
    spec.uwb.multipath.blocked_echo_loss = between(0.4, 0.9)?;
    spec.uwb.offset_m = OFFSET_M;
    Ok(Room { distance_m: between(1.0, 9.0)?, pillar, spec })
}

fn mine(room: &Room) -> Result<Mine, Box<dyn Error>> {
    let mut plan = MinePlan::new("a room", Grid::Local {});
    plan.levels.push(Level { id: "room".into(), name: None, elevation_m: 0.0 });
    let (far, wide) = (room.distance_m + 8.0, 8.0);
    plan.chambers.push(Chamber {
        id: "hall".into(),
        name: None,
        floor_m: 0.0,
        height_m: 6.0,
        outline_m: vec![[-8.0, -wide], [far, -wide], [far, wide], [-8.0, wide]],
    });
    plan.roadways.push(Roadway {
        id: "path".into(),
        name: None,
        level: Some("room".into()),
        kind: RoadwayKind::Drift,
        width_m: 2.0,
        height_m: 3.0,
        max_slope_percent: None,
        walkable: true,
        points_m: vec![Position::new(-1.0, 0.0, 0.0), Position::new(1.0, 0.0, 0.0)],
    });
    plan.anchors.push(Anchor {
        id: "anchor".into(),
        position_m: Position::new(room.distance_m, 0.0, 1.6),
        range_offset_m: Some(OFFSET_M),
        antenna_delay_ns: None,
        tx_power_dbm: None,
    });
    let Some((width_m, share)) = room.pillar else { return Ok(Mine::new(plan)?) };
    let (at, half) = (share * room.distance_m, 0.5 * width_m);
    plan.pillars.push(Pillar {
        id: "pillar".into(),
        level: "room".into(),
        height_m: Some(3.0),
        outline_m: vec![[at - 0.1, -half], [at + 0.1, -half], [at + 0.1, half], [at - 0.1, half]],
    });
    Ok(Mine::unchecked(plan))
}

fn exchanges(
    room: &Room,
    number: u64,
    seed: u64,
    table: &mut String,
    responses: &mut Vec<u8>,
) -> Result<(), Box<dyn Error>> {
    let seed = seed.wrapping_mul(1_000_003).wrapping_add(number);
    let world = RadioWorld::new(mine(room)?, &room.spec, &[], seed)?;
    let mut tag = world.tag(seed).with_detail(RangeDetail::ImpulseResponse);
    let mut out = Vec::new();
    for epoch in 0..EXCHANGES {
        let time_s = f64::from(epoch);
        let sway = Vector3::new((1.3 * time_s).sin(), (0.7 * time_s).cos(), 0.0) * 0.01;
        let antenna = Antenna { position_m: Vector3::new(0.0, 0.0, 1.2) + sway, facing_rad: None };
        out.clear();
        tag.ranges(&world, time_s, &antenna, &Surroundings::default(), &mut out);
        for outcome in &out {
            let Some(reception) = outcome.sample.reception.as_deref() else { continue };
            let (Some(response), Some(_)) = (&reception.impulse_response, window::of(reception)) else {
                continue;
            };
            let nlos = u8::from(outcome.truth.class != LinkClass::Los);
            let number_of = |value: Option<f32>| value.map_or(String::new(), |v| v.to_string());
            let symbols = reception.preamble_count.map_or(String::new(), |v| v.to_string());
            writeln!(
                table,
                "{number},{nlos},{:.4},{:.4},{},{symbols},{},{},{},{}",
                outcome.truth.distance_m,
                outcome.sample.range_m,
                number_of(reception.first_path_index_tap),
                number_of(reception.rx_power_dbm),
                number_of(reception.first_path_power_dbm),
                number_of(reception.peak_index_tap),
                number_of(reception.noise_std),
            )?;
            responses.extend(bytes(response));
        }
    }
    Ok(())
}

/// The taps of the layout; those that were not kept are silent.
fn bytes(response: &ImpulseResponse) -> impl Iterator<Item = u8> {
    (0..TAPS).flat_map(|k| {
        let at = (usize::from(FIRST_TAP) + k).checked_sub(response.first_tap.into());
        let [i, q] = at.and_then(|at| response.taps.get(at)).copied().unwrap_or_default();
        let ([a, b], [c, d]) = (i.to_le_bytes(), q.to_le_bytes());
        [a, b, c, d]
    })
}
