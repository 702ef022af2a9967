//! What raises an alarm, what ends it, and what users do with it.
#![expect(clippy::unwrap_used, reason = "tests")]
#![expect(clippy::float_cmp, reason = "positions are as they were given")]

mod common;

use adit_tracking::alarms::Note;
use adit_tracking::{
    About, AlarmId, AlarmKind, AlarmState, Battery, Button, Charge, Command, Device, DeviceKind, Event,
    Ignored, Input, Motion, Outcome, Person, Refused, Rules, Severity, WayOut,
};
use common::{Room, at, fix, person};

fn button(room: &mut Room, tag: &str, time_s: f64) -> Outcome {
    room.hear(&Input::Button(Button { tag: tag.into(), time: at(time_s) }))
}

fn battery(room: &mut Room, charge: Charge) {
    room.wait(room.now_s + 1.0);
    room.hear(&Input::Battery(Battery { tag: "t1".into(), time: at(room.now_s), charge }));
}

#[test]
fn who_is_not_allowed_raises_an_alarm_and_who_is_does_not() {
    let mut room = Room::of(2, Rules::default());
    let allowed = Person {
        id: "p2".into(),
        name: "P2".into(),
        allowed_zones: ["restricted".to_owned()].into(),
        ..Person::default()
    };
    room.command(Command::ChangePerson { person: allowed }).unwrap();
    for (second, x) in [(1.0, 95.0), (5.0, 105.0), (6.0, 106.0), (7.0, 107.0)] {
        room.main(second, "t1", x);
        room.fix("t2", x, 0.0, 1.0);
    }
    let [alarm] = room.alarms()[..] else { unreachable!("{:?}", room.alarms()) };
    assert_eq!(alarm.key.kind, AlarmKind::RestrictedZone);
    assert_eq!(alarm.key.about, person("p1").into());
    assert_eq!(alarm.key.zone.as_deref(), Some("restricted"));
    assert_eq!((alarm.since, alarm.raised_at), (at(3.0), at(5.0)));
    // Allowed from now on: the alarm ends.
    let allowed =
        Person { id: "p1".into(), allowed_zones: ["restricted".to_owned()].into(), ..Person::default() };
    room.command(Command::ChangePerson { person: allowed }).unwrap();
    assert_eq!(room.kinds(), []);
}

#[test]
fn a_dangerous_zone_is_so_for_everybody() {
    let mut room = Room::of(1, Rules::default());
    let allowed =
        Person { id: "p1".into(), allowed_zones: ["dangerous".to_owned()].into(), ..Person::default() };
    room.command(Command::ChangePerson { person: allowed }).unwrap();
    room.main(1.0, "t1", 201.0);
    assert_eq!(room.kinds(), [AlarmKind::DangerousZone]);
    assert_eq!(room.alarms()[0].severity, Severity::Critical);
    room.main(5.0, "t1", 210.0);
    assert_eq!(room.kinds(), []);
    assert_eq!(room.tracking.cleared_alarms().count(), 1);
}

#[test]
fn an_alarm_that_comes_and_goes_is_held_off() {
    let mut room = Room::of(1, Rules::default());
    let mut second = 1.0;
    // In and out of the dangerous zone every second for 20 s: hold-off is 10 s.
    for _ in 0..10 {
        room.main(second, "t1", 202.5);
        room.main(second + 1.0, "t1", 204.0);
        second += 2.0;
    }
    let raised = room.told().iter().filter(|event| matches!(event, Event::AlarmRaised { .. })).count();
    // At 1 s; cleared at 2 s; at the first entry from 12 s on; cleared a second later.
    assert_eq!(raised, 2);
    // Inside when the hold-off ends: raised then, without a further fix.
    room.main(second, "t1", 202.5);
    assert_eq!(room.kinds(), []);
    room.wait(second + 10.0);
    assert_eq!(room.kinds(), [AlarmKind::DangerousZone]);
}

#[test]
fn too_many_in_a_zone_until_somebody_leaves_or_the_limit_is_raised() {
    let mut room = Room::of(3, Rules::default());
    room.wait(1.0);
    room.fix("t1", 310.0, 0.0, 1.0);
    assert_eq!(room.kinds(), []);
    room.fix("t2", 311.0, 0.0, 1.0);
    let [alarm] = room.alarms()[..] else { unreachable!() };
    assert_eq!((alarm.key.kind, &alarm.key.about), (AlarmKind::OverCapacity, &About::Zone("shop".into())));
    room.fix("t3", 312.0, 0.0, 1.0);
    assert_eq!(room.kinds(), [AlarmKind::OverCapacity]);
    room.command(Command::SetCapacity { zone: "shop".into(), capacity: Some(3) }).unwrap();
    assert_eq!(room.kinds(), []);
    assert_eq!(room.tracking.zone("shop").unwrap().inside.len(), 3);
    room.command(Command::SetCapacity { zone: "shop".into(), capacity: Some(2) }).unwrap();
    room.wait(62.0);
    assert_eq!(room.kinds(), [AlarmKind::OverCapacity]);
    room.command(Command::SetCapacity { zone: "shop".into(), capacity: None }).unwrap();
    assert_eq!(room.kinds(), []);
}

#[test]
fn distress_is_raised_once_for_a_press_and_cleared_by_hand_only() {
    let mut room = Room::of(1, Rules::default());
    room.main(1.0, "t1", 50.0);
    assert_eq!(button(&mut room, "t1", 1.0), Outcome::Done);
    // The gateway says it again; and a second press while the first is open.
    assert_eq!(button(&mut room, "t1", 1.0), Outcome::Ignored(Ignored::Late));
    room.wait(2.0);
    button(&mut room, "t1", 2.0);
    let [alarm] = room.alarms()[..] else { unreachable!() };
    let (id, place) = (alarm.id, alarm.position_m.unwrap());
    assert_eq!((alarm.key.kind, place.raw().x), (AlarmKind::Distress, 50.0));
    // Out of the mine it is still open.
    room.main(40.0, "t1", 5.0);
    assert_eq!(room.kinds(), [AlarmKind::Distress]);
    room.command(Command::Clear { alarm: id, note: "found, well".into() }).unwrap();
    let alarm = room.tracking.alarm(id).unwrap();
    assert_eq!(alarm.state, AlarmState::Cleared);
    assert_eq!(alarm.cleared.as_ref().unwrap().by.as_deref(), Some("dora"));
    assert_eq!(alarm.notes, [Note { by: "dora".into(), at: at(40.0), text: "found, well".into() }]);
    assert_eq!(
        room.command(Command::Clear { alarm: id, note: String::new() }),
        Err(Refused::Cleared { alarm: id })
    );
    // The next press is another alarm; one from the future is as good as any.
    button(&mut room, "t1", 1e6);
    assert_eq!(room.alarms()[0].id, AlarmId(id.0 + 1));
}

#[test]
fn a_fall_is_an_alarm_at_once_that_stays_until_cleared() {
    let mut room = Room::of(1, Rules::default());
    room.main(1.0, "t1", 50.0);
    room.motion("t1", Motion::Fallen);
    assert_eq!(room.kinds(), [AlarmKind::ManDown]);
    room.wait(2.0);
    room.motion("t1", Motion::Moving);
    assert_eq!(room.kinds(), [AlarmKind::ManDown]);
}

/// Positions that stay, and what the sensors say, each second for so long.
fn lie(room: &mut Room, for_s: f64, motion: Option<Motion>, x: impl Fn(f64) -> f64) {
    let end_s = room.now_s + for_s;
    while room.now_s < end_s {
        room.main(room.now_s + 1.0, "t1", x(room.now_s));
        if let Some(motion) = motion {
            room.motion("t1", motion);
        }
    }
    room.wait(room.now_s + 1.0);
}

#[test]
fn who_lies_still_raises_an_alarm_until_moving() {
    let mut room = Room::of(1, Rules::default());
    lie(&mut room, 299.0, Some(Motion::Still), |_| 50.0);
    assert_eq!(room.kinds(), []);
    lie(&mut room, 3.0, Some(Motion::Still), |_| 50.0);
    assert_eq!(room.kinds(), [AlarmKind::NoMotion]);
    assert_eq!(room.alarms()[0].since, at(1.0));
    // Works with the hands: no step, but motion.
    lie(&mut room, 1.0, Some(Motion::Moving), |_| 50.0);
    assert_eq!(room.kinds(), []);
}

#[test]
fn who_is_carried_out_lies_still_outside() {
    let mut room = Room::of(1, Rules::default());
    lie(&mut room, 302.0, Some(Motion::Still), |_| 12.0);
    assert_eq!(room.kinds(), [AlarmKind::NoMotion]);
    room.main(room.now_s + 1.0, "t1", 8.0);
    room.motion("t1", Motion::Still);
    assert_eq!(room.kinds(), []);
}

#[test]
fn who_stands_where_they_work_or_rides_is_not_down() {
    // The sensors see motion, the position stays.
    let mut room = Room::of(1, Rules::default());
    lie(&mut room, 2000.0, Some(Motion::Moving), |_| 50.0);
    assert_eq!(room.kinds(), []);
    // The sensors see rest, the position goes on.
    let mut room = Room::of(1, Rules::default());
    lie(&mut room, 600.0, Some(Motion::Still), |s| 20.0 + 0.5 * s);
    assert!(!room.kinds().contains(&AlarmKind::NoMotion));
}

#[test]
fn without_sensors_positions_must_stay_for_longer() {
    let mut room = Room::of(1, Rules::default());
    lie(&mut room, 898.0, None, |s| 50.0 + (s * 0.7).sin());
    assert_eq!(room.kinds(), []);
    lie(&mut room, 4.0, None, |_| 50.0);
    assert_eq!(room.kinds(), [AlarmKind::NoMotion]);
}

#[test]
fn silence_is_not_rest() {
    let mut room = Room::of(1, Rules::default());
    lie(&mut room, 200.0, Some(Motion::Still), |_| 50.0);
    room.wait(600.0);
    assert_eq!(room.kinds(), [AlarmKind::LostContact]);
}

#[test]
fn in_a_refuge_people_may_sit() {
    let mut room = Room::of(1, Rules::default());
    for _ in 0..400 {
        room.wait(room.now_s + 1.0);
        room.fix("t1", 10.0, 300.0, -49.0);
        room.motion("t1", Motion::Still);
    }
    assert_eq!(room.kinds(), []);
}

#[test]
fn who_is_not_heard_below_is_lost_until_heard_and_who_is_out_is_not() {
    let mut room = Room::of(2, Rules::default());
    room.main(1.0, "t1", 50.0);
    room.main(1.0, "t2", 5.0);
    room.told();
    room.wait(121.0);
    assert_eq!(room.kinds(), []);
    room.wait(122.0);
    let [alarm] = room.alarms()[..] else { unreachable!() };
    assert_eq!((alarm.key.kind, &alarm.key.about), (AlarmKind::LostContact, &person("p1").into()));
    assert_eq!(alarm.since, at(1.0));
    assert_eq!(room.tracking.headcount().out_of_contact, 1);
    room.heard("t1");
    assert_eq!(room.kinds(), []);
    let (lost, regained) = (
        Event::ContactLost { subject: person("p1"), last_heard: at(1.0) },
        Event::ContactRegained { subject: person("p1"), last_heard: at(1.0), time: at(122.0) },
    );
    let told = room.told();
    assert!(told.contains(&lost) && told.contains(&regained), "{told:?}");
}

#[test]
fn silence_of_everybody_is_one_alarm() {
    let mut room = Room::of(6, Rules::default());
    let all = ["t1", "t2", "t3", "t4", "t5", "t6"];
    room.wait(1.0);
    for tag in all {
        room.fix(tag, 50.0, 0.0, 1.0);
    }
    room.wait(600.0);
    assert_eq!(room.kinds(), [AlarmKind::Silence]);
    assert_eq!(room.alarms()[0].key.about, About::Mine);
    assert_eq!(room.alarms()[0].since, at(1.0));
    // One is heard again: the fault is gone, and the others have their time to be heard.
    room.wait_hearing(700.0, &["t1"]);
    assert_eq!(room.kinds(), []);
    room.wait_hearing(800.0, &["t1"]);
    assert_eq!(room.kinds(), [AlarmKind::LostContact; 5]);
}

#[test]
fn time_in_which_nobody_listened_is_not_held_against_anybody() {
    let mut room = Room::of(1, Rules::default());
    room.main(1.0, "t1", 50.0);
    // The server stood still for ten minutes.
    room.now_s = 601.0;
    room.hear(&Input::Tick);
    assert_eq!(room.kinds(), []);
    room.wait(721.0);
    assert_eq!(room.kinds(), []);
    room.wait(722.0);
    assert_eq!(room.kinds(), [AlarmKind::LostContact]);
}

#[test]
fn overtime_after_the_limit_of_the_person_or_the_rule() {
    let mut room = Room::of(2, Rules::default());
    let short = Person { id: "p2".into(), shift_limit_h: Some(1.0), ..Person::default() };
    room.command(Command::ChangePerson { person: short }).unwrap();
    room.main(1.0, "t1", 50.0);
    room.main(1.0, "t2", 50.0);
    let over = |room: &Room| -> Vec<About> {
        let alarms = room.tracking.open_alarms().filter(|alarm| alarm.key.kind == AlarmKind::Overtime);
        alarms.map(|alarm| alarm.key.about.clone()).collect()
    };
    room.wait(3601.0);
    assert_eq!(over(&room), []);
    room.wait(3602.0);
    assert_eq!(over(&room), [person("p2").into()]);
    room.wait(36002.0);
    assert_eq!(over(&room), [person("p2").into(), person("p1").into()]);
    // Out, and below again within the break: the same shift.
    room.main(36010.0, "t2", 5.0);
    assert_eq!(over(&room), [person("p1").into()]);
    room.told();
    room.main(37000.0, "t2", 50.0);
    room.wait(37001.0);
    let went = room.told().into_iter().find(|event| matches!(event, Event::WentBelow { .. })).unwrap();
    assert!(matches!(went, Event::WentBelow { shift_since, .. } if shift_since == at(1.0)));
    assert_eq!(over(&room), [person("p1").into(), person("p2").into()]);
}

#[test]
fn a_battery_is_low_until_it_is_fine() {
    let mut room = Room::of(1, Rules::default());
    for (charge, open) in [
        (Charge::Share(0.25), false),
        (Charge::Share(0.2), true),
        (Charge::Share(0.25), true),
        (Charge::Share(0.3), false),
        (Charge::Volts(3.5), false),
    ] {
        battery(&mut room, charge);
        assert_eq!(room.kinds().contains(&AlarmKind::LowBattery), open, "{charge:?}");
    }
    // The last one is held off, and comes when ten minutes are over.
    room.wait(610.0);
    assert!(room.kinds().contains(&AlarmKind::LowBattery));
}

#[test]
fn gateways_and_anchors_go_and_come() {
    let mut room = Room::default();
    for (kind, alarm) in
        [(DeviceKind::Gateway, AlarmKind::GatewayDown), (DeviceKind::Anchor, AlarmKind::AnchorDown)]
    {
        let device = |up, time_s| Input::Device(Device { kind, id: "a1".into(), time: at(time_s), up });
        room.wait(room.now_s + 1.0);
        assert_eq!(room.hear(&device(true, room.now_s)), Outcome::Done);
        assert_eq!(room.kinds(), []);
        room.wait(room.now_s + 1.0);
        room.hear(&device(false, room.now_s));
        room.hear(&device(false, room.now_s));
        assert_eq!(room.kinds(), [alarm]);
        // An old word does not bring it back.
        assert_eq!(room.hear(&device(true, room.now_s - 2.0)), Outcome::Ignored(Ignored::Late));
        room.wait(room.now_s + 1.0);
        room.hear(&device(true, room.now_s));
        assert_eq!(room.kinds(), []);
    }
    room.command(Command::ForgetDevice { kind: DeviceKind::Gateway, id: "a1".into() }).unwrap();
    assert_eq!(room.tracking.devices().count(), 1);
}

#[test]
fn two_tags_on_one_person_are_an_alarm_and_the_heard_one_leads() {
    let mut room = Room::of(1, Rules::default());
    room.tag("spare");
    room.main(1.0, "t1", 50.0);
    room.wait(2.0);
    room.give("spare", "p1").unwrap();
    assert_eq!(room.kinds(), [AlarmKind::TwoTags]);
    // The spare was never heard: the other one still tells where they are.
    room.main(3.0, "t1", 52.0);
    let place = |room: &Room| room.tracking.person("p1").unwrap().live.last_known.unwrap().position_m.raw().x;
    assert_eq!(place(&room), 52.0);
    // Now it is, and was given last.
    room.main(4.0, "spare", 60.0);
    room.main(5.0, "t1", 53.0);
    assert_eq!(place(&room), 60.0);
    assert_eq!(room.tracking.headcount().mine.heads(), 1);
    // It falls silent: the other one leads again.
    room.wait_hearing(130.0, &["t1"]);
    room.main(131.0, "t1", 54.0);
    assert_eq!(place(&room), 54.0);
    room.command(Command::Unassign { tag: "spare".into() }).unwrap();
    assert_eq!(room.kinds(), []);
}

#[test]
fn an_alarm_that_nobody_sees_goes_up_and_one_that_somebody_has_seen_does_not() {
    let mut room = Room::of(2, Rules::default());
    room.main(1.0, "t1", 201.0);
    room.main(1.0, "t2", 202.0);
    let (first, second) = (room.alarms()[0].id, room.alarms()[1].id);
    room.wait(30.0);
    room.command(Command::Acknowledge { alarm: second, note: String::new() }).unwrap();
    assert_eq!(
        room.command(Command::Acknowledge { alarm: second, note: String::new() }),
        Err(Refused::Acknowledged { alarm: second, by: "dora".into() })
    );
    let levels = |room: &Room| [first, second].map(|id| room.tracking.alarm(id).unwrap().escalation);
    for (until_s, level) in [(60.0, 0), (61.0, 1), (100.0, 1)] {
        room.wait_hearing(until_s, &["t1", "t2"]);
        assert_eq!(levels(&room), [level, 0], "at {until_s} s");
    }
    room.wait_hearing(181.0, &["t1", "t2"]);
    assert_eq!(levels(&room), [2, 0]);
    let escalated = room.told().iter().filter(|event| matches!(event, Event::AlarmEscalated { .. })).count();
    assert_eq!(escalated, 2);
    assert_eq!(room.tracking.alarm(second).unwrap().state, AlarmState::Acknowledged);
    assert_eq!(
        room.command(Command::Clear { alarm: first, note: String::new() }),
        Err(Refused::EndsByItself { alarm: first })
    );
}

#[test]
fn comments_are_kept_also_after_the_end() {
    let mut room = Room::of(1, Rules::default());
    room.main(1.0, "t1", 201.0);
    let alarm = room.alarms()[0].id;
    room.command(Command::Comment { alarm, text: "called".into() }).unwrap();
    room.main(5.0, "t1", 220.0);
    room.command(Command::Acknowledge { alarm, note: "seen too late".into() }).unwrap();
    let notes: Vec<&str> =
        room.tracking.alarm(alarm).unwrap().notes.iter().map(|note| note.text.as_str()).collect();
    assert_eq!(notes, ["called", "seen too late"]);
    assert_eq!(room.tracking.alarm(alarm).unwrap().state, AlarmState::Cleared);
    let unknown = AlarmId(99);
    assert_eq!(
        room.command(Command::Comment { alarm: unknown, text: "?".into() }),
        Err(Refused::UnknownAlarm { alarm: unknown })
    );
}

#[test]
fn what_is_switched_off_is_not_raised_and_comes_when_switched_on() {
    let mut rules = Rules::default();
    rules.alarms.dangerous_zone.enabled = false;
    let mut room = Room::of(1, rules.clone());
    room.main(1.0, "t1", 201.0);
    assert_eq!(room.kinds(), []);
    rules.alarms.dangerous_zone.enabled = true;
    room.command(Command::SetRules { rules: Box::new(rules.clone()) }).unwrap();
    assert_eq!(room.kinds(), [AlarmKind::DangerousZone]);
    rules.alarms.dangerous_zone.enabled = false;
    room.command(Command::SetRules { rules: Box::new(rules.clone()) }).unwrap();
    assert_eq!(room.kinds(), []);
    rules.contact.lost_after_s = f64::NAN;
    assert!(matches!(room.command(Command::SetRules { rules: Box::new(rules) }), Err(Refused::Rules(_))));
}

#[test]
fn somebody_seen_outside_is_out_until_a_tag_says_otherwise() {
    let mut room = Room::of(1, Rules::default());
    room.main(1.0, "t1", 110.0);
    assert_eq!(room.kinds(), [AlarmKind::RestrictedZone]);
    room.told();
    room.wait(2.0);
    let out = || Command::MarkOut { person: "p1".into(), note: "at the gate".into() };
    room.command(out()).unwrap();
    assert!(room.told().iter().any(|event| matches!(event, Event::CameOut { way: WayOut::Commanded, .. })));
    assert_eq!((room.kinds(), room.tracking.headcount().mine.heads()), (vec![], 0));
    assert_eq!(room.command(out()), Err(Refused::PersonNotBelow { person: "p1".into() }));
    room.wait(3.0);
    room.hear(&Input::Fix(fix("t1", 3.0, [60.0, 0.0, 1.0])));
    assert_eq!(room.tracking.headcount().mine.people, 1);
}
