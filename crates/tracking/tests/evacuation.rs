//! Everybody out: who is safe, who is on the way, who is missing.
#![expect(clippy::unwrap_used, reason = "tests")]
#![expect(clippy::float_cmp, reason = "lengths of straight roadways are exact")]

mod common;

use adit_mine::plan::ZoneKind;
use adit_tracking::evacuation::{EvacuationStatus, EvacuationSummary, Evacuee};
use adit_tracking::{AlarmKind, Command, Event, LiveZone, Motion, Refused, Rules};
use common::{Room, at, zone};

fn start(room: &mut Room, levels: &[&str]) {
    let levels = levels.iter().map(|&level| level.to_owned()).collect();
    room.command(Command::StartEvacuation { levels, note: "fire".into() }).unwrap();
}

fn evacuee(room: &Room, id: &str) -> Evacuee {
    let people = room.tracking.evacuation().unwrap().people;
    people.into_iter().find(|evacuee| evacuee.subject == common::person(id)).unwrap()
}

fn missing(room: &Room) -> usize {
    room.kinds().iter().filter(|kind| **kind == AlarmKind::MissingInEvacuation).count()
}

#[test]
fn each_stands_as_they_do_and_knows_the_way() {
    let mut room = Room::of(6, Rules::default());
    room.main(1.0, "t1", 0.0);
    room.fix("t2", 110.0, 0.0, 1.0);
    room.fix("t3", 390.0, 0.0, 1.0);
    room.fix("t4", 10.0, 300.0, -49.0);
    room.fix("t5", 60.0, 300.0, -49.0);
    start(&mut room, &[]);
    assert_eq!(
        room.command(Command::StartEvacuation { levels: [].into(), note: String::new() }),
        Err(Refused::Evacuating { since: at(1.0) })
    );
    // p2 goes, p3 lies, p4 sits in the refuge, p5 is not heard any more.
    for second in 2..=200 {
        room.wait(f64::from(second));
        room.main(f64::from(second), "t2", (110.0 - f64::from(second)).max(20.0));
        room.motion("t2", Motion::Moving);
        room.fix("t3", 390.0, 0.0, 1.0);
        room.motion("t3", Motion::Still);
        room.fix("t4", 10.0, 300.0, -49.0);
    }
    let view = room.tracking.evacuation().unwrap();
    // p1 was out when it began, p6 was never seen.
    let expected =
        EvacuationSummary { moving_out: 1, not_moving: 1, in_refuge: 1, unknown: 1, ..Default::default() };
    assert_eq!(view.summary, expected);
    assert_eq!((view.by.as_str(), view.note.as_str(), view.since), ("dora", "fire", at(1.0)));
    let [p2, p3, p5] = ["p2", "p3", "p5"].map(|id| evacuee(&room, id));
    assert_eq!(p2.status, EvacuationStatus::MovingOut);
    // From 110 m to 20 m along the main roadway. The portal's spot is the middle of the centre line in it: x = −15 to 10.
    let portal = p2.to_portal.unwrap();
    assert_eq!((portal.zone.as_str(), portal.length_m), ("portal", 22.5));
    // 112.5 m and 22.5 m are each a sum of two lengths: the last digit is not kept.
    assert!((p2.nearer_by_m.unwrap() - 90.0).abs() < 1e-9);
    assert_eq!((p3.status, p3.nearer_by_m), (EvacuationStatus::NotMoving, Some(0.0)));
    // To the end of the main roadway, down the ramp, along the drift to the middle of the refuge.
    let refuge_m = 10.0 + f64::hypot(300.0, 50.0) + 390.0;
    assert!((p3.to_refuge.unwrap().length_m - refuge_m).abs() < 1e-9);
    let p5_known = p5.last_known.unwrap();
    assert_eq!((p5.status, p5_known.age_s), (EvacuationStatus::Unknown, 199.0));
    assert_eq!(p5_known.radius_now_m, 0.5 + 1.5 * 199.0);
    assert_eq!(p5.to_refuge.unwrap().length_m, 50.0);
    // Out is out.
    room.wait(220.0);
    room.main(221.0, "t2", 5.0);
    assert_eq!(evacuee(&room, "p2").status, EvacuationStatus::Out);
    assert_eq!(room.tracking.evacuation().unwrap().summary.out, 1);
}

#[test]
fn who_neither_moves_nor_is_safe_is_missing_after_a_time() {
    let mut room = Room::of(2, Rules::default());
    room.main(1.0, "t1", 110.0);
    room.fix("t2", 110.0, 0.0, 1.0);
    start(&mut room, &[]);
    let mut x = 110.0;
    while room.now_s < 331.0 {
        // p1 goes slowly, p2 lies from the beginning: still for the 30 s that count from 31 s on, missing 300 s later.
        x -= 0.1;
        room.main(room.now_s + 1.0, "t1", x);
        room.motion("t1", Motion::Moving);
        room.motion("t2", Motion::Still);
    }
    assert_eq!(missing(&room), 0);
    room.wait(room.now_s + 3.0);
    assert_eq!(missing(&room), 1);
    assert!(evacuee(&room, "p2").missing && !evacuee(&room, "p1").missing);
    // p1 moves, but the way of 112.5 m was to be done in 161 s by 0.7 m/s, and 300 s later somebody has to look.
    while room.now_s < 461.0 {
        x -= 0.1;
        room.main(room.now_s + 1.0, "t1", x);
        room.motion("t1", Motion::Moving);
        room.motion("t2", Motion::Still);
    }
    assert_eq!(missing(&room), 1);
    room.wait(463.0);
    assert_eq!(missing(&room), 2);
    // Found: in the portal.
    room.main(470.0, "t1", 0.0);
    room.wait(471.0);
    assert_eq!(missing(&room), 1);
    room.told();
    room.command(Command::StopEvacuation { note: "drill".into() }).unwrap();
    assert_eq!(missing(&room), 0);
    let told = room.told();
    let [Event::EvacuationStopped { id: 1, summary, .. }, ..] = &told[..] else { unreachable!("{told:?}") };
    assert_eq!((summary.out, summary.missing), (1, 1));
    assert!(room.tracking.evacuation().is_none());
    assert_eq!(room.command(Command::StopEvacuation { note: String::new() }), Err(Refused::NotEvacuating));
}

#[test]
fn a_level_is_left_for_any_other_and_who_comes_onto_it_is_concerned() {
    let mut room = Room::of(2, Rules::default());
    room.main(1.0, "t1", 50.0);
    room.fix("t2", 100.0, 300.0, -49.0);
    start(&mut room, &["lower"]);
    assert_eq!(room.tracking.evacuation().unwrap().people.len(), 1);
    room.wait(60.0);
    room.fix("t2", 400.0, 10.0, -1.0);
    assert_eq!(evacuee(&room, "p2").status, EvacuationStatus::OtherLevel);
    room.fix("t1", 200.0, 300.0, -49.0);
    room.wait(61.0);
    assert_eq!(evacuee(&room, "p1").status, EvacuationStatus::MovingOut);
}

#[test]
fn a_refuge_drawn_meanwhile_counts() {
    let mut room = Room::of(1, Rules::default());
    room.main(1.0, "t1", 250.0);
    start(&mut room, &[]);
    assert_eq!(evacuee(&room, "p1").to_portal.unwrap().length_m, 252.5);
    let refuge = LiveZone::from(zone("niche", ZoneKind::Refuge, "upper", [260.0, 270.0], 0.0));
    room.command(Command::CreateZone { zone: refuge }).unwrap();
    let to_refuge = evacuee(&room, "p1").to_refuge.unwrap();
    assert_eq!((to_refuge.zone.as_str(), to_refuge.length_m), ("niche", 15.0));
    room.main(20.0, "t1", 265.0);
    assert_eq!(evacuee(&room, "p1").status, EvacuationStatus::InRefuge);
}
