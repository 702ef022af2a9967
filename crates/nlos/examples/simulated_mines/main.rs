//! `simulated_mines OUT ROOMS SEED`: walks in rooms of mines that are drawn, a folder for each as `adit simulate` leaves it (`log.mcap` with ranges and their responses,
//! `ranges_truth.csv`): what `adit nlos train OUT/*` learns what is in the way from.
//!
//! Each room is a hall, 12 to 36 m by 8 to 22 m, with a drift that leaves it and turns: up to seven pillars and machines, up to two vehicles and six people, anchors on
//! its walls, mostly one in the drift. Somebody with a tag at the waist (on a cap in a fifth of the rooms: nobody is in the way there) walks, stops, turns about and goes round the corner for half
//! a minute. The radio of each room is drawn about the simulation's defaults.

mod room;

use adit_core::nalgebra::Vector3;
use adit_observation::Observation;
use adit_observation::files::AtomicFile;
use adit_observation::mcap_log::{McapLogWriter, Packing};
use adit_simulation::radio::{
    Antenna, LinkClass, Obstacle, RadioWorld, RangeDetail, RangeOutcome, Surroundings,
};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use room::{Draw, Room, Vehicle, Walker};
use std::error::Error;
use std::io::Write as _;
use std::path::Path;

/// Time between two epochs of ranges, s.
const EVERY_S: f64 = 0.1;
/// Epochs in a room.
const EPOCHS: u32 = 300;
/// From the body's axis to the tag, m.
const TAG_M: f64 = 0.2;
/// Nobody comes nearer to the wearer, m; no vehicle either.
const PERSON_M: f64 = 0.6;
const VEHICLE_M: f64 = 3.5;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [out, rooms, seed] = arguments.as_slice() else {
        return Err("usage: simulated_mines OUT ROOMS SEED".into());
    };
    let (rooms, seed): (u64, u64) = (rooms.parse()?, seed.parse()?);
    for number in 0..rooms {
        let seed = seed.wrapping_mul(1_000_003).wrapping_add(number);
        walk(seed, &Path::new(out).join(format!("room{:03}", number + 1)))?;
    }
    Ok(())
}

/// One room, one walk.
fn walk(seed: u64, folder: &Path) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(folder)?;
    let mut log = McapLogWriter::create(folder.join("log.mcap"), Packing::Lz4)?;
    let mut truth = AtomicFile::create(folder.join("ranges_truth.csv"))?;
    writeln!(truth, "time_s,anchor_id,true_range_m,class,in_the_way,loss_dB")?;
    let mut draw = Draw(ChaCha8Rng::seed_from_u64(seed));
    let room = Room::draw(&mut draw);
    let world = RadioWorld::new(room.mine.clone(), &room.spec, &[], seed)?;
    let shades = room.spec.body.shades;
    let mut tag = world.tag(1).with_detail(RangeDetail::ImpulseResponse);
    let mut wearer = Walker::draw(&room, &mut draw);
    let mut people: Vec<Walker> = (0..draw.below(7)).map(|_| Walker::draw(&room, &mut draw)).collect();
    people.retain(|_| shades);
    let mut vehicles: Vec<Vehicle> =
        (0..draw.below(3)).filter_map(|_| Vehicle::draw(&room, &mut draw)).collect();
    let mut heard = Vec::new();
    for epoch in 0..EPOCHS {
        wearer.step(EVERY_S, &mut draw);
        for person in &mut people {
            person.step(EVERY_S, &mut draw);
        }
        for vehicle in &mut vehicles {
            vehicle.step(EVERY_S, &mut draw);
        }
        let (at, heading_rad) = (wearer.place(), wearer.heading_rad);
        let forward = Vector3::new(heading_rad.sin(), heading_rad.cos(), 0.0);
        let position_m = Vector3::new(at.x, at.y, room.antenna_m) + TAG_M * forward;
        let antenna = Antenna { position_m, facing_rad: shades.then_some(heading_rad) };
        let away = |obstacle: &Obstacle| (obstacle.foot_m.xy() - at).norm();
        let people = people.iter().map(|p| Obstacle::person(Vector3::new(p.place().x, p.place().y, 0.0)));
        let vehicles = vehicles.iter().map(|vehicle| vehicle.obstacle);
        let obstacles: Vec<Obstacle> =
            people.filter(|o| away(o) > PERSON_M).chain(vehicles.filter(|o| away(o) > VEHICLE_M)).collect();
        let around = Surroundings { obstacles: &obstacles, conveyors_run: false };
        heard.clear();
        tag.ranges(&world, f64::from(epoch) * EVERY_S, &antenna, &around, &mut heard);
        for RangeOutcome { sample, truth: known } in heard.drain(..) {
            let class = match known.class {
                LinkClass::Los => "los",
                LinkClass::Nlos => "nlos",
                LinkClass::Ndp => "ndp",
            };
            let (way, loss_db) = (known.in_the_way().name(), known.loss_db);
            let (time, anchor, distance_m) = (sample.time, &sample.anchor, known.distance_m);
            writeln!(truth, "{time},{anchor},{distance_m:.4},{class},{way},{loss_db:.2}")?;
            log.push(&Observation::Range(sample))?;
        }
    }
    log.finish()?;
    truth.finish()?;
    Ok(())
}
