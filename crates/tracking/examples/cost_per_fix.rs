//! What a fix costs: ten thousand people at one fix a second among fifty zones, as they walk, and while the mine is evacuated.
//!
//! `cargo run --release -p adit-tracking --example cost_per_fix`
#![expect(clippy::unwrap_used, clippy::print_stdout, reason = "an example")]

use adit_core::frames::Position;
use adit_core::solution::Quality;
use adit_core::time::Time;
use adit_mine::Mine;
use adit_mine::plan::{Grid, Level, MinePlan, Roadway, RoadwayKind, Zone, ZoneKind};
use adit_tracking::{Activity, Command, Fix, Input, Motion, Person, Rules, Tag, Tracking};
use std::sync::Arc;
use std::time::{Duration, Instant};

const PEOPLE: u32 = 10_000;
const SECONDS: u32 = 60;
/// Roadways of 2 km, one beside the other every 50 m, with crosscuts at both ends.
const ROADWAYS: u32 = 40;
const LENGTH_M: f64 = 2000.0;

fn plan() -> MinePlan {
    let mut plan = MinePlan::new("grid", Grid::Local {});
    plan.levels.push(Level { id: "l".into(), name: None, elevation_m: 0.0 });
    let mut roadway = |id: String, points: [[f64; 2]; 2]| {
        plan.roadways.push(Roadway {
            id,
            name: None,
            level: Some("l".into()),
            kind: RoadwayKind::Drift,
            width_m: 5.0,
            height_m: 3.0,
            max_slope_percent: None,
            walkable: true,
            points_m: points.iter().map(|[x, y]| Position::new(*x, *y, 0.0)).collect(),
        });
    };
    for number in 0..ROADWAYS {
        let y = 50.0 * f64::from(number);
        roadway(format!("r{number}"), [[0.0, y], [LENGTH_M, y]]);
        if number > 0 {
            roadway(format!("w{number}"), [[0.0, y - 50.0], [0.0, y]]);
            roadway(format!("e{number}"), [[LENGTH_M, y - 50.0], [LENGTH_M, y]]);
        }
    }
    for number in 0..50_u32 {
        let kind = match number % 5 {
            0 => ZoneKind::Restricted,
            1 => ZoneKind::Dangerous,
            2 => ZoneKind::Refuge,
            _ => ZoneKind::Key,
        };
        let kind = if number == 0 { ZoneKind::Portal } else { kind };
        let (x, y) = (40.0 * f64::from(number), 50.0 * f64::from(number % ROADWAYS));
        plan.zones.push(Zone {
            id: format!("z{number:02}"),
            name: None,
            kind,
            level: "l".into(),
            capacity: Some(20),
            exit_tolerance_m: 1.0,
            exit_delay_s: 3.0,
            outline_m: vec![[x, y - 4.0], [x + 25.0, y - 4.0], [x + 25.0, y + 4.0], [x, y + 4.0]],
        });
    }
    plan
}

/// Where somebody is: up and down their roadway at their own speed.
fn place(person: u32, second: u32) -> [f64; 2] {
    let speed_m_s = 0.5 + f64::from(person % 97) / 97.0;
    let way_m = f64::from(person.wrapping_mul(7919) % 4000) + speed_m_s * f64::from(second);
    let along_m = way_m % (2.0 * LENGTH_M);
    let x = if along_m < LENGTH_M { along_m } else { 2.0 * LENGTH_M - along_m };
    [x, 50.0 * f64::from(person % ROADWAYS)]
}

fn main() {
    let begin = Instant::now();
    let mine = Arc::new(Mine::new(plan()).unwrap());
    println!("mine of {} edges read in {:?}", mine.network().edges().len(), begin.elapsed());
    let begin = Instant::now();
    let mut tracking = Tracking::new(mine.clone(), Rules::default()).unwrap();
    println!("attached to it, with the ways to all refuges, in {:?}", begin.elapsed());
    let at = |second: u32| Time::from_nanos(1_795_000_000_000_000_000 + i64::from(second) * 1_000_000_000);
    let mut events = Vec::new();
    let command = |command| Input::Command { by: "u".into(), command };
    let tags: Vec<String> = (0..PEOPLE).map(|number| format!("tag-{number:05}")).collect();
    for (number, tag) in tags.iter().enumerate() {
        let person = Person {
            id: format!("person-{number:05}"),
            name: "Somebody Or Other".into(),
            ..Person::default()
        };
        let id = person.id.clone();
        tracking.hear(at(0), &command(Command::CreatePerson { person }), &mut events).unwrap();
        let new = Tag { id: tag.clone(), ..Tag::default() };
        tracking.hear(at(0), &command(Command::CreateTag { tag: new }), &mut events).unwrap();
        let give = Command::Assign { tag: tag.clone(), person: id, from: None, until: None };
        tracking.hear(at(0), &command(give), &mut events).unwrap();
    }
    for evacuated in [false, true] {
        let (mut fixes, mut activities, mut ticks) = (Duration::ZERO, Duration::ZERO, Duration::ZERO);
        let mut told = 0;
        let first = if evacuated { SECONDS } else { 0 };
        if evacuated {
            let begin = Instant::now();
            let all = Command::StartEvacuation { levels: [].into(), note: String::new() };
            tracking.hear(at(first), &command(all), &mut events).unwrap();
            println!("evacuation started in {:?}", begin.elapsed());
        }
        for second in first..first + SECONDS {
            let inputs: Vec<Input> = (0..PEOPLE)
                .zip(&tags)
                .map(|(person, tag)| {
                    let [x, y] = place(person, second);
                    Input::Fix(Fix {
                        tag: tag.clone(),
                        time: at(second),
                        position_m: Position::new(x, y, 1.0),
                        velocity_m_s: None,
                        radius_95_m: 0.5,
                        protection_level_m: 1.5,
                        quality: Quality::Fixed,
                        moving: Some(true),
                        method: "fused".into(),
                    })
                })
                .collect();
            let moving: Vec<Input> = tags
                .iter()
                .map(|tag| {
                    Input::Activity(Activity { tag: tag.clone(), time: at(second), motion: Motion::Moving })
                })
                .collect();
            let mut heard = |inputs: &[Input]| {
                events.clear();
                let begin = Instant::now();
                for input in inputs {
                    tracking.hear(at(second), input, &mut events).unwrap();
                }
                told += events.len();
                begin.elapsed()
            };
            fixes += heard(&inputs);
            activities += heard(&moving);
            ticks += heard(&[Input::Tick]);
        }
        let each = |all: Duration| all / (PEOPLE * SECONDS);
        println!(
            "{}: {:?} a fix, {:?} an activity, {:?} a tick; {told} events; {:.2} % of a core",
            if evacuated { "evacuated" } else { "at work" },
            each(fixes),
            each(activities),
            ticks / SECONDS,
            100.0 * (fixes + activities + ticks).as_secs_f64() / f64::from(SECONDS)
        );
    }
    let begin = Instant::now();
    let (headcount, zones) = (tracking.headcount(), tracking.zones());
    println!(
        "{} below, counted with all {} zones in {:?}",
        headcount.mine.heads(),
        zones.len(),
        begin.elapsed()
    );
    let begin = Instant::now();
    let everybody = tracking.below().count();
    println!("all {everybody} viewed in {:?}", begin.elapsed());
    let begin = Instant::now();
    let people = tracking.evacuation().unwrap().people.len();
    println!("evacuation of {people} viewed in {:?}", begin.elapsed());
    let begin = Instant::now();
    let saved = rmp_serde::to_vec_named(&tracking).unwrap();
    println!("saved in {:?}: {} bytes a person", begin.elapsed(), saved.len() / PEOPLE as usize);
}
