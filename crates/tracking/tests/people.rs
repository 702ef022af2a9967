//! People, tags, and who wears which.
#![expect(clippy::unwrap_used, reason = "tests")]
#![expect(clippy::float_cmp, reason = "numbers are as they were given, or exact sums of halves")]

mod common;

use adit_tracking::view::Whereabouts;
use adit_tracking::{Command, Event, Ignored, Input, Motion, Outcome, Person, Refused, Rules, Tag, TagKind};
use common::{Room, at, fix};

#[test]
fn what_cannot_be_is_refused_with_the_reason() {
    let mut room = Room::of(2, Rules::default());
    let refusals = [
        (
            Command::Assign { tag: "t1".into(), person: "nobody".into(), from: None, until: None },
            "there is no person 'nobody'",
        ),
        (
            Command::Assign { tag: "none".into(), person: "p1".into(), from: None, until: None },
            "there is no tag 'none'",
        ),
        (
            Command::Assign { tag: "t1".into(), person: "p2".into(), from: None, until: None },
            "tag 't1' is worn by person 'p1' then; take it back first",
        ),
        (Command::RemovePerson { person: "p1".into() }, "person 'p1' wears tag 't1'; take it back first"),
        (Command::RemoveTag { tag: "t1".into() }, "tag 't1' is worn by person 'p1' then; take it back first"),
        (
            Command::ChangeTag { tag: Tag { id: "t1".into(), kind: TagKind::Vehicle, ..Tag::default() } },
            "tag 't1' is worn by person 'p1' then; take it back first",
        ),
        (
            Command::CreatePerson { person: Person { id: "p1".into(), ..Person::default() } },
            "person 'p1' exists already",
        ),
        (
            Command::CreatePerson { person: Person { id: String::new(), ..Person::default() } },
            "the id of a person has 1 to 128 characters and no control characters among them, found ''",
        ),
        (
            Command::ChangePerson {
                person: Person { id: "p1".into(), shift_limit_h: Some(f64::NAN), ..Person::default() },
            },
            "shift_limit_h is expected above 0 and at most 100 000 h, found NaN",
        ),
        (Command::Unassign { tag: "other".into() }, "there is no tag 'other'"),
        (Command::RemoveZone { zone: "none".into() }, "there is no zone 'none'"),
        (Command::StopEvacuation { note: String::new() }, "no evacuation runs"),
        (
            Command::StartEvacuation { levels: ["deep".to_owned()].into(), note: String::new() },
            "the mine has no level 'deep'",
        ),
    ];
    for (command, why) in refusals {
        let before = serde_json::to_string(&room.tracking).unwrap();
        let refused = room.command(command.clone()).unwrap_err();
        assert_eq!(refused.to_string(), why, "{command:?}");
        assert_eq!(serde_json::to_string(&room.tracking).unwrap(), before, "{command:?} changed something");
    }
    assert_eq!(room.told(), []);
}

#[test]
fn an_assignment_begins_and_ends_at_its_times() {
    let mut room = Room::default();
    for id in ["p1", "p2"] {
        room.person(id);
    }
    room.tag("t");
    let give = |person: &str, from_s: f64, until_s: Option<f64>| Command::Assign {
        tag: "t".into(),
        person: person.into(),
        from: Some(at(from_s)),
        until: until_s.map(at),
    };
    room.command(give("p1", 10.0, Some(20.0))).unwrap();
    assert!(matches!(room.command(give("p2", 15.0, None)), Err(Refused::TagWorn { .. })));
    assert!(matches!(room.command(give("p2", 30.0, Some(30.0))), Err(Refused::EndsBeforeItBegins { .. })));
    room.command(give("p2", 20.0, None)).unwrap();
    for (until_s, wearer) in [(9.0, None), (10.0, Some("p1")), (19.0, Some("p1")), (20.0, Some("p2"))] {
        room.wait(until_s);
        assert_eq!(room.tracking.wearer("t"), wearer, "at {until_s} s");
    }
    let told = room.told();
    assert!(told.contains(&Event::TagReturned { tag: "t".into(), person: "p1".into(), time: at(20.0) }));
    assert!(told.contains(&Event::TagAssigned { tag: "t".into(), person: "p2".into(), time: at(20.0) }));
}

#[test]
fn the_shift_begins_below_and_ends_in_the_portal() {
    let mut room = Room::of(1, Rules::default());
    let whereabouts = |room: &Room| room.tracking.person("p1").unwrap().live.whereabouts;
    assert_eq!(whereabouts(&room), Whereabouts::Unseen);
    room.main(1.0, "t1", 0.0);
    assert_eq!(whereabouts(&room), Whereabouts::Out { since: at(1.0) });
    assert_eq!(room.tracking.headcount().mine.heads(), 0);
    // The portal ends at x = 10: left at 11 s, to the micrometre that touches an outline.
    room.main(21.0, "t1", 20.0);
    let Whereabouts::Below { shift_since } = whereabouts(&room) else { unreachable!() };
    assert!(shift_since.since(at(11.0)).seconds().abs() < 1.1e-6);
    room.told();
    room.main(41.0, "t1", 0.0);
    assert_eq!(whereabouts(&room), Whereabouts::Out { since: at(31.0) });
    let levels: Vec<Event> =
        room.told().into_iter().filter(|event| matches!(event, Event::LevelChanged { .. })).collect();
    assert!(
        matches!(&levels[..], [Event::LevelChanged { from: Some(from), to: None, .. }] if from == "upper")
    );
}

#[test]
fn who_gives_the_tag_back_below_stays_at_the_last_known_position() {
    let mut room = Room::of(1, Rules::default());
    room.main(1.0, "t1", 50.0);
    room.command(Command::Unassign { tag: "t1".into() }).unwrap();
    let live = room.tracking.person("p1").unwrap().live;
    assert_eq!(live.last_known.unwrap().position_m.raw().x, 50.0);
    assert_eq!(room.tracking.headcount().mine.people, 1);
    assert_eq!(
        room.command(Command::RemovePerson { person: "p1".into() }),
        Err(Refused::PersonBelow { person: "p1".into() })
    );
    // Whoever carries the tag on is somebody else.
    room.main(2.0, "t1", 51.0);
    assert_eq!(room.tracking.headcount().mine.heads(), 2);
}

#[test]
fn strangers_are_followed_up_to_a_limit() {
    let mut rules = Rules::default();
    rules.contact.unregistered_tags = 2;
    let mut room = Room::with(rules);
    room.wait(1.0);
    assert_eq!(room.fix("a", 50.0, 0.0, 1.0), Outcome::Done);
    assert_eq!(room.fix("b", 50.0, 0.0, 1.0), Outcome::Done);
    assert_eq!(room.fix("c", 50.0, 0.0, 1.0), Outcome::Ignored(Ignored::TooManyTags));
    assert_eq!(room.fix("\n", 50.0, 0.0, 1.0), Outcome::Ignored(Ignored::BadId));
    room.tag("a");
    assert_eq!(room.fix("c", 50.0, 0.0, 1.0), Outcome::Done);
    assert!(room.tracking.tag("a").unwrap().registered);
    room.command(Command::RemoveTag { tag: "b".into() }).unwrap();
    assert_eq!(room.tracking.headcount().mine.unassigned_tags, 2);
    assert_eq!(room.fix("d", 50.0, 0.0, 1.0), Outcome::Done);
}

#[test]
fn the_radius_grows_by_walking_as_long_as_nobody_is_known_to_rest() {
    let mut room = Room::of(1, Rules::default());
    room.main(10.0, "t1", 50.0);
    let radius = |room: &Room| room.tracking.person("p1").unwrap().live.last_known.unwrap().radius_now_m;
    assert_eq!(radius(&room), 0.5);
    room.wait(30.0);
    assert_eq!(radius(&room), 0.5 + 1.5 * 20.0);
    // Heard to rest from 30 s to 40 s: not grown meanwhile, grown on since.
    for second in 30..=40 {
        room.wait(f64::from(second));
        room.motion("t1", Motion::Still);
    }
    assert_eq!(radius(&room), 0.5 + 1.5 * 20.0);
    room.wait(50.0);
    assert_eq!(radius(&room), 0.5 + 1.5 * 30.0);
    // Nobody is farther than the mine goes: bounds from x = −20 to 402.5 and from y = −5 to 305.
    room.wait(5000.0);
    let corner_m = f64::hypot(352.5, 305.0);
    assert!((radius(&room) - corner_m).abs() < 1e-9, "{}", radius(&room));
    // A fix ends it.
    room.hear(&Input::Fix(fix("t1", 5000.0, [60.0, 0.0, 1.0])));
    assert_eq!(radius(&room), 0.5);
}

#[test]
fn a_state_that_was_read_back_waits_for_its_mine() {
    let mut room = Room::of(1, Rules::default());
    room.main(1.0, "t1", 50.0);
    let saved = serde_json::to_string(&room.tracking).unwrap();
    room.tracking = serde_json::from_str(&saved).unwrap();
    assert_eq!(room.fix("t1", 51.0, 0.0, 1.0), Outcome::Ignored(Ignored::NoMine));
    assert_eq!(room.command(Command::ResetZones), Err(Refused::NoMine));
    room.tracking.attach(common::mine());
    assert_eq!(room.tracking.headcount().mine.people, 1);
    assert_eq!(serde_json::to_string(&room.tracking).unwrap(), saved);
}
