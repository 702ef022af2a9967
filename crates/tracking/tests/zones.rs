//! Who is in which zone, since when.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use adit_core::time::Time;
use adit_mine::plan::{Zone, ZoneKind};
use adit_tracking::{
    Command, Entry, Event, Exit, Ignored, Input, LiveZone, Outcome, Rules, Subject, TagKind,
};
use common::{Room, at, fix, person, zone};

/// A point is on an outline within 1 µm; the slowest here goes 1 m/s.
const TOUCH_S: f64 = 1.1e-6;

/// Entries and exits, by zone, with seconds from the beginning.
fn moves(events: &[Event]) -> Vec<(&str, bool, f64)> {
    let seconds = |time: &Time| time.since(at(0.0)).seconds();
    let moves = events.iter().filter_map(|event| match event {
        Event::ZoneEntered { zone, time, .. } => Some((zone.as_str(), true, seconds(time))),
        Event::ZoneLeft { zone, time, .. } => Some((zone.as_str(), false, seconds(time))),
        _ => None,
    });
    moves.collect()
}

fn count(room: &Room, zone: &str) -> u32 {
    room.tracking.zone(zone).unwrap().count.heads()
}

#[test]
fn who_comes_and_goes_is_counted_at_the_moments_of_crossing() {
    let mut room = Room::of(1, Rules::default());
    room.main(1.0, "t1", 90.0);
    // 20 m in 10 s: the outline at x = 100 is crossed in the middle.
    room.main(11.0, "t1", 110.0);
    assert_eq!(moves(&room.told()), [("restricted", true, 6.0)]);
    assert_eq!(count(&room, "restricted"), 1);
    room.main(21.0, "t1", 125.0);
    let events = room.told();
    let [(zone, entered, left_s)] = moves(&events)[..] else { unreachable!("{events:?}") };
    assert_eq!((zone, entered), ("restricted", false));
    // x = 120 after two thirds of the way.
    assert!((left_s - (11.0 + 10.0 * 10.0 / 15.0)).abs() < TOUCH_S, "{left_s}");
    assert_eq!(count(&room, "restricted"), 0);
}

#[test]
fn a_zone_that_lies_between_two_fixes_was_entered_and_left() {
    let mut room = Room::of(1, Rules::default());
    room.main(1.0, "t1", 195.0);
    room.main(11.0, "t1", 205.0);
    let events = room.told();
    let [("dangerous", true, entered_s), ("dangerous", false, left_s)] = moves(&events)[..] else {
        unreachable!("{events:?}")
    };
    assert!((entered_s - 6.0).abs() < TOUCH_S && (left_s - 9.0).abs() < TOUCH_S, "{entered_s} {left_s}");
    assert_eq!(count(&room, "dangerous"), 0);
}

#[test]
fn a_jump_or_a_long_silence_is_no_way() {
    for (until_s, x) in [(3.0, 260.0), (40.0, 206.0)] {
        let mut room = Room::of(1, Rules::default());
        room.main(1.0, "t1", 195.0);
        room.main(until_s, "t1", x);
        assert_eq!(moves(&room.told()), [], "to {x} at {until_s} s");
    }
}

#[test]
fn who_is_first_seen_in_a_zone_has_entered_it() {
    let mut room = Room::of(1, Rules::default());
    room.main(1.0, "t1", 110.0);
    let events = room.told();
    assert_eq!(moves(&events), [("restricted", true, 1.0)]);
    assert_eq!(room.tracking.zone_of("t1"), Some("restricted"));
    assert!(events.iter().any(|event| matches!(event, Event::ZoneEntered { entry: Entry::Appeared, .. })));
    assert_eq!(room.tracking.headcount().mine.people, 1);
}

#[test]
fn nobody_leaves_before_tolerance_and_delay() {
    let mut room = Room::of(1, Rules::default());
    room.main(1.0, "t1", 319.0);
    assert_eq!(moves(&room.told()), [("shop", true, 1.0)]);
    // Within the tolerance of 2 m, for long.
    for second in 2..30 {
        room.main(f64::from(second), "t1", 321.5);
    }
    // Beyond it, and back before the delay of 5 s is over.
    room.main(30.0, "t1", 323.0);
    room.main(33.0, "t1", 321.0);
    assert_eq!(moves(&room.told()), []);
    // Beyond it for good: left when the tolerance was crossed at x = 322, told when the delay is over, without a further fix.
    room.main(34.0, "t1", 323.0);
    room.wait(38.0);
    assert_eq!(moves(&room.told()), []);
    assert_eq!(count(&room, "shop"), 1);
    room.wait(39.0);
    let events = room.told();
    let [("shop", false, left_s)] = moves(&events)[..] else { unreachable!("{events:?}") };
    assert!((left_s - 33.5).abs() < TOUCH_S, "{left_s}");
    assert_eq!(count(&room, "shop"), 0);
    assert_eq!(room.tracking.zone_of("t1"), None);
}

#[test]
fn a_zone_holds_on_its_own_level_only() {
    let mut room = Room::of(1, Rules::default());
    room.wait(1.0);
    // Under the restricted zone.
    room.fix("t1", 110.0, 0.0, -50.0);
    assert_eq!(moves(&room.told()), []);
    let head = room.tracking.headcount();
    assert_eq!([head.levels[0].1.people, head.levels[1].1.people], [0, 1]);
    // Levels change beyond their border at −25 m by the tolerance of 1 m only.
    for (second, z, level) in
        [(2.0, -24.5, "lower"), (3.0, -23.5, "upper"), (4.0, -25.5, "upper"), (5.0, -26.5, "lower")]
    {
        room.wait(second);
        room.fix("t1", 60.0, 0.0, z);
        let view = room.tracking.person("p1").unwrap().live.last_known.unwrap();
        assert_eq!(view.level.as_deref(), Some(level), "z = {z}");
    }
}

#[test]
fn who_goes_down_leaves_the_zones_above_at_the_border_of_the_levels() {
    let mut room = Room::of(1, Rules::default());
    let drawn = |id, level| LiveZone::from(zone(id, ZoneKind::Key, level, [40.0, 60.0], 0.0));
    room.command(Command::CreateZone { zone: drawn("above", "upper") }).unwrap();
    room.command(Command::CreateZone { zone: drawn("beneath", "lower") }).unwrap();
    room.wait(1.0);
    room.fix("t1", 50.0, 0.0, -20.0);
    room.told();
    // 20 m down in 2 s: the border at −25 m is crossed after a quarter of the way.
    room.wait(3.0);
    room.fix("t1", 50.0, 0.0, -40.0);
    assert_eq!(moves(&room.told()), [("above", false, 1.5), ("beneath", true, 1.5)]);
}

#[test]
fn a_fix_too_coarse_to_tell_begins_no_stay_and_ends_none() {
    let mut room = Room::of(1, Rules::default());
    room.wait(1.0);
    // Half the diagonal of the restricted zone (20 m × 10 m) is 11.2 m.
    let mut coarse = fix("t1", 1.0, [110.0, 0.0, 1.0]);
    coarse.radius_95_m = 11.3;
    room.hear(&Input::Fix(coarse.clone()));
    assert_eq!(moves(&room.told()), []);
    assert_eq!(room.tracking.zone("restricted").unwrap().possible, [person("p1")]);
    assert_eq!(room.tracking.person("p1").unwrap().live.possible_zones, ["restricted"]);
    room.main(2.0, "t1", 110.0);
    assert_eq!(moves(&room.told()), [("restricted", true, 2.0)]);
    // 10 m outside: still may be inside.
    room.wait(3.0);
    coarse = fix("t1", 3.0, [130.0, 0.0, 1.0]);
    coarse.radius_95_m = 11.3;
    room.hear(&Input::Fix(coarse.clone()));
    assert_eq!(moves(&room.told()), []);
    // 12 m outside: certainly not.
    room.wait(4.0);
    coarse = fix("t1", 4.0, [132.0, 0.0, 1.0]);
    coarse.radius_95_m = 11.3;
    room.hear(&Input::Fix(coarse));
    let events = room.told();
    assert_eq!(moves(&events), [("restricted", false, 4.0)]);
    assert!(events.iter().any(|event| matches!(event, Event::ZoneLeft { exit: Exit::Vanished, .. })));
}

#[test]
fn a_late_fix_and_one_from_the_future_change_nothing() {
    let mut room = Room::of(1, Rules::default());
    room.main(10.0, "t1", 60.0);
    room.told();
    let before = room.tracking.person("p1").unwrap();
    for (time_s, why) in [(10.0, Ignored::Late), (9.0, Ignored::Late), (13.0, Ignored::Future)] {
        let outcome = room.hear(&Input::Fix(fix("t1", time_s, [110.0, 0.0, 1.0])));
        assert_eq!(outcome, Outcome::Ignored(why));
    }
    assert_eq!(room.tracking.person("p1").unwrap(), before);
    assert_eq!(room.told(), []);
    // A clock that is a little ahead counts as now.
    room.wait(11.0);
    assert_eq!(room.hear(&Input::Fix(fix("t1", 12.5, [110.0, 0.0, 1.0]))), Outcome::Done);
    assert_eq!(room.tracking.person("p1").unwrap().live.last_known.unwrap().time, at(11.0));
}

#[test]
fn what_is_no_number_is_left_out() {
    let mut room = Room::of(1, Rules::default());
    room.wait(1.0);
    for position in [[f64::NAN, 0.0, 0.0], [0.0, f64::INFINITY, 0.0], [0.0, 0.0, 1e300]] {
        assert_eq!(room.hear(&Input::Fix(fix("t1", 1.0, position))), Outcome::Ignored(Ignored::NotANumber));
    }
    let mut radius = fix("t1", 1.0, [0.0, 0.0, 0.0]);
    radius.radius_95_m = f64::NAN;
    assert_eq!(room.hear(&Input::Fix(radius)), Outcome::Ignored(Ignored::NotANumber));
    assert_eq!(room.told(), []);
}

#[test]
fn a_zone_drawn_round_people_holds_them_and_one_moved_away_loses_them() {
    let mut room = Room::of(2, Rules::default());
    room.main(1.0, "t1", 50.0);
    room.main(1.0, "t2", 70.0);
    room.told();
    let drawn = |range| LiveZone::from(zone("new", ZoneKind::Key, "upper", range, 0.0));
    room.command(Command::CreateZone { zone: drawn([40.0, 60.0]) }).unwrap();
    assert_eq!(moves(&room.told()), [("new", true, 1.0)]);
    assert_eq!(room.tracking.zone("new").unwrap().inside, [person("p1")]);
    // The one who is in both stays in it.
    room.command(Command::ChangeZone { zone: drawn([40.0, 80.0]) }).unwrap();
    assert_eq!(moves(&room.told()), [("new", true, 1.0)]);
    room.wait(2.0);
    room.command(Command::ChangeZone { zone: drawn([65.0, 80.0]) }).unwrap();
    assert_eq!(moves(&room.told()), [("new", false, 2.0)]);
    assert_eq!(room.tracking.zone("new").unwrap().inside, [person("p2")]);
    room.command(Command::RemoveZone { zone: "new".into() }).unwrap();
    assert_eq!(moves(&room.told()), [("new", false, 2.0)]);
    assert!(room.tracking.zone("new").is_none());
    room.command(Command::CreateZone { zone: drawn([65.0, 80.0]) }).unwrap();
    room.command(Command::ResetZones).unwrap();
    assert!(room.tracking.zone("new").is_none());
    assert_eq!(room.tracking.zones().len(), common::plan().zones.len());
}

#[test]
fn a_portal_drawn_round_people_lets_them_out() {
    let mut room = Room::of(1, Rules::default());
    room.main(1.0, "t1", 50.0);
    let portal = LiveZone::from(zone("raise", ZoneKind::Portal, "upper", [40.0, 60.0], 0.0));
    room.command(Command::CreateZone { zone: portal.clone() }).unwrap();
    assert_eq!(room.tracking.headcount().mine.people, 0);
    let key = LiveZone::from(Zone { kind: ZoneKind::Key, ..portal.zone });
    room.command(Command::ChangeZone { zone: key }).unwrap();
    assert_eq!(room.tracking.headcount().mine.people, 1);
    assert_eq!(room.tracking.zone("raise").unwrap().count.people, 1);
}

#[test]
fn a_tag_that_nobody_wears_counts_as_somebody_and_a_vehicle_does_not() {
    let mut room = Room::default();
    let tag = adit_tracking::Tag { id: "lhd".into(), kind: TagKind::Vehicle, ..Default::default() };
    room.command(Command::CreateTag { tag }).unwrap();
    room.main(1.0, "lhd", 201.0);
    room.main(1.0, "found", 202.0);
    let count = room.tracking.zone("dangerous").unwrap().count;
    assert_eq!((count.people, count.unassigned_tags, count.vehicles, count.heads()), (0, 1, 1, 1));
    // Only the one who may be somebody is in danger.
    let [alarm] = room.alarms()[..] else { unreachable!() };
    assert_eq!(alarm.key.about, Subject::Tag("found".into()).into());
    // Given to somebody, they are who is there.
    room.person("p");
    room.give("found", "p").unwrap();
    let count = room.tracking.zone("dangerous").unwrap().count;
    assert_eq!((count.people, count.unassigned_tags), (1, 0));
    let [alarm] = room.alarms()[..] else { unreachable!() };
    assert_eq!(alarm.key.about, person("p").into());
}
