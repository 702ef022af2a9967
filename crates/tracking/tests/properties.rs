//! Laws that hold for any sequence of inputs.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use adit_core::frames::Position;
use adit_core::solution::Quality;
use adit_core::time::Time;
use adit_mine::plan::ZoneKind;
use adit_tracking::view::Count;
use adit_tracking::{
    Activity, AlarmId, AlarmKey, Battery, Button, Charge, Command, Device, DeviceKind, Event, Fix, Heard,
    Input, LiveZone, Motion, Person, Rules, Subject, Tag, TagKind, Tracking,
};
use proptest::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

const TAGS: usize = 5;
const PEOPLE: usize = 4;

fn tag() -> impl Strategy<Value = String> {
    (0..TAGS).prop_map(|number| format!("t{number}"))
}

fn person() -> impl Strategy<Value = String> {
    (0..PEOPLE).prop_map(|number| format!("p{number}"))
}

fn zone_id() -> impl Strategy<Value = String> {
    prop_oneof![
        Just("portal"),
        Just("restricted"),
        Just("dangerous"),
        Just("shop"),
        Just("refuge"),
        Just("new")
    ]
    .prop_map(Into::into)
}

/// Places on the roadways mostly, anywhere and nowhere sometimes.
fn place() -> impl Strategy<Value = [f64; 3]> {
    prop_oneof![
        6 => (-30.0..420.0_f64, -4.0..4.0_f64).prop_map(|(x, y)| [x, y, 1.0]),
        2 => (-30.0..420.0_f64, 297.0..303.0_f64).prop_map(|(x, y)| [x, y, -49.0]),
        1 => (0.0..1.0_f64).prop_map(|s| [400.0, 300.0 * s, -50.0 * s]),
        1 => (-1e3..1e3_f64, -1e3..1e3_f64, -200.0..200.0_f64).prop_map(|(x, y, z)| [x, y, z]),
        1 => Just([f64::NAN, 0.0, 0.0]),
    ]
}

fn zone() -> impl Strategy<Value = LiveZone> {
    let kind = prop_oneof![
        Just(ZoneKind::Key),
        Just(ZoneKind::Portal),
        Just(ZoneKind::Restricted),
        Just(ZoneKind::Dangerous),
        Just(ZoneKind::Refuge)
    ];
    (zone_id(), kind, -20.0..380.0_f64, 1.0..100.0_f64, any::<bool>(), 0.0..5.0_f64, 0.0..8.0_f64).prop_map(
        |(id, kind, west, wide, upper, exit_tolerance_m, exit_delay_s)| {
            let (level, north) = if upper { ("upper", 0.0) } else { ("lower", 300.0) };
            let zone = common::zone(&id, kind, level, [west, west + wide], north);
            adit_mine::plan::Zone { exit_tolerance_m, exit_delay_s, capacity: Some(1), ..zone }.into()
        },
    )
}

fn command() -> impl Strategy<Value = Command> {
    let when = || proptest::option::of((-5.0..60.0_f64).prop_map(common::at));
    prop_oneof![
        person().prop_map(|id| Command::CreatePerson { person: Person { id, ..Person::default() } }),
        (person(), zone_id()).prop_map(|(id, zone)| Command::ChangePerson {
            person: Person { id, allowed_zones: [zone].into(), ..Person::default() }
        }),
        person().prop_map(|person| Command::RemovePerson { person }),
        (tag(), any::<bool>()).prop_map(|(id, vehicle)| {
            let kind = if vehicle { TagKind::Vehicle } else { TagKind::Person };
            Command::CreateTag { tag: Tag { id, kind, ..Tag::default() } }
        }),
        (tag(), any::<bool>()).prop_map(|(id, asset)| {
            let kind = if asset { TagKind::Asset } else { TagKind::Person };
            Command::ChangeTag { tag: Tag { id, kind, ..Tag::default() } }
        }),
        tag().prop_map(|tag| Command::RemoveTag { tag }),
        (tag(), person(), when(), when()).prop_map(|(tag, person, from, until)| Command::Assign {
            tag,
            person,
            from,
            until
        }),
        (tag(), person()).prop_map(|(tag, person)| Command::Assign { tag, person, from: None, until: None }),
        tag().prop_map(|tag| Command::Unassign { tag }),
        person().prop_map(|person| Command::MarkOut { person, note: String::new() }),
        zone().prop_map(|zone| Command::CreateZone { zone }),
        zone().prop_map(|zone| Command::ChangeZone { zone }),
        (zone_id(), proptest::option::of(0..4_u32))
            .prop_map(|(zone, capacity)| Command::SetCapacity { zone, capacity }),
        zone_id().prop_map(|zone| Command::RemoveZone { zone }),
        Just(Command::ResetZones),
        (1..20_u64).prop_map(|id| Command::Acknowledge { alarm: AlarmId(id), note: "seen".into() }),
        (1..20_u64).prop_map(|id| Command::Clear { alarm: AlarmId(id), note: String::new() }),
        (1..20_u64).prop_map(|id| Command::Comment { alarm: AlarmId(id), text: "so".into() }),
        any::<bool>().prop_map(|all| Command::StartEvacuation {
            levels: if all { BTreeSet::new() } else { ["lower".to_owned()].into() },
            note: String::new()
        }),
        Just(Command::StopEvacuation { note: String::new() }),
        any::<bool>().prop_map(|enabled| {
            let mut rules = rules();
            rules.alarms.restricted_zone.enabled = enabled;
            Command::SetRules { rules: Box::new(rules) }
        }),
    ]
}

/// An input, with how late it arrives and how long after the last one.
fn input() -> impl Strategy<Value = (f64, Input)> {
    let quality = prop_oneof![8 => Just(Quality::Fixed), 1 => Just(Quality::Lost)];
    let moving = proptest::option::of(any::<bool>());
    let fix = (tag(), place(), -4.0..3.0_f64, 0.0..20.0_f64, quality, moving).prop_map(
        |(tag, [x, y, z], late_s, radius_95_m, quality, moving)| {
            let time = Time::from_seconds(late_s).unwrap();
            let (position_m, protection_level_m) = (Position::new(x, y, z), 3.0 * radius_95_m);
            let (velocity_m_s, method) = (None, "test".into());
            Input::Fix(Fix {
                tag,
                time,
                position_m,
                velocity_m_s,
                radius_95_m,
                protection_level_m,
                quality,
                moving,
                method,
            })
        },
    );
    let time = || (-4.0..3.0_f64).prop_map(|late_s| Time::from_seconds(late_s).unwrap());
    let motion = prop_oneof![4 => Just(Motion::Still), 2 => Just(Motion::Moving), 1 => Just(Motion::Fallen)];
    let kind = prop_oneof![Just(DeviceKind::Gateway), Just(DeviceKind::Anchor)];
    let what = prop_oneof![
        20 => fix,
        3 => (tag(), time()).prop_map(|(tag, time)| Input::Heard(Heard { tag, time, gateway: Some("g".into()) })),
        1 => (tag(), time(), -0.1..1.0_f64)
            .prop_map(|(tag, time, share)| Input::Battery(Battery { tag, time, charge: Charge::Share(share) })),
        1 => (tag(), time()).prop_map(|(tag, time)| Input::Button(Button { tag, time })),
        4 => (tag(), time(), motion).prop_map(|(tag, time, motion)| Input::Activity(Activity { tag, time, motion })),
        1 => (kind, time(), any::<bool>())
            .prop_map(|(kind, time, up)| Input::Device(Device { kind, id: "d".into(), time, up })),
        10 => Just(Input::Tick),
        8 => command().prop_map(|command| Input::Command { by: "u".into(), command }),
    ];
    (prop_oneof![6 => 0.0..2.0_f64, 1 => 0.0..40.0_f64, 1 => Just(-3.0)], what)
}

/// Times short enough to be met within a hundred inputs.
fn rules() -> Rules {
    let mut rules = Rules::default();
    rules.contact.lost_after_s = 15.0;
    rules.contact.silence_from_people = 2;
    rules.contact.unregistered_tags = 3;
    rules.motion.still_after_s = 10.0;
    rules.motion.still_position_after_s = 20.0;
    rules.shifts.limit_h = 0.01;
    rules.shifts.break_s = 5.0;
    rules.evacuation.missing_after_s = 10.0;
    rules.escalation.critical_after_s = vec![5.0, 10.0];
    rules
}

/// Runs the inputs, each stamped by when it arrives.
fn run(
    tracking: &mut Tracking,
    now_s: &mut f64,
    inputs: &[(f64, Input)],
    mut seen: impl FnMut(&Tracking, &[Event]),
) {
    for (step_s, input) in inputs {
        *now_s += step_s;
        let now = common::at(*now_s);
        let mut input = input.clone();
        match &mut input {
            Input::Fix(Fix { time, .. })
            | Input::Heard(Heard { time, .. })
            | Input::Battery(Battery { time, .. })
            | Input::Button(Button { time, .. })
            | Input::Activity(Activity { time, .. })
            | Input::Device(Device { time, .. }) => *time = now + time.since(Time::ZERO),
            Input::Tick | Input::Command { .. } => {}
        }
        let mut events = Vec::new();
        let before = matches!(input, Input::Command { .. }).then(|| tracking.clone());
        let outcome = tracking.hear(now, &input, &mut events);
        if let (Err(_), Some(mut before)) = (outcome, before) {
            assert!(events.is_empty(), "{input:?}");
            // What is refused changes nothing but the time, as does what is ignored.
            let ignored = Fix { tag: String::new(), ..common::fix("", 0.0, [0.0; 3]) };
            before.hear(now, &Input::Fix(ignored), &mut events).unwrap();
            assert_eq!(bytes(&before), bytes(tracking), "{input:?}");
        }
        seen(tracking, &events);
    }
}

fn bytes(tracking: &Tracking) -> Vec<u8> {
    rmp_serde::to_vec_named(tracking).unwrap()
}

fn fresh() -> Tracking {
    Tracking::new(common::mine(), rules()).unwrap()
}

fn of<'a>(count: &'a mut Count, subject: &Subject, kind: TagKind) -> &'a mut u32 {
    match (subject, kind) {
        (Subject::Person(_), _) => &mut count.people,
        (Subject::Tag(_), TagKind::Person) => &mut count.unassigned_tags,
        (Subject::Tag(_), TagKind::Vehicle) => &mut count.vehicles,
        (Subject::Tag(_), TagKind::Asset) => &mut count.assets,
    }
}

/// Counts made of events alone.
#[derive(Default)]
struct Ledger {
    mine: Count,
    levels: BTreeMap<String, Count>,
    zones: BTreeMap<String, Count>,
    inside: BTreeSet<(String, Subject)>,
}

impl Ledger {
    fn write(&mut self, event: &Event) {
        match event {
            Event::ZoneEntered { zone, subject, kind, .. } => {
                assert!(self.inside.insert((zone.clone(), subject.clone())), "in twice: {event:?}");
                *of(self.zones.entry(zone.clone()).or_default(), subject, *kind) += 1;
            }
            Event::ZoneLeft { zone, subject, kind, entered, time, .. } => {
                assert!(entered <= time, "{event:?}");
                assert!(self.inside.remove(&(zone.clone(), subject.clone())), "out without in: {event:?}");
                *of(self.zones.entry(zone.clone()).or_default(), subject, *kind) -= 1;
            }
            Event::LevelChanged { subject, kind, from, to, .. } => {
                if let Some(from) = from {
                    *of(self.levels.entry(from.clone()).or_default(), subject, *kind) -= 1;
                }
                if let Some(to) = to {
                    *of(self.levels.entry(to.clone()).or_default(), subject, *kind) += 1;
                }
            }
            Event::WentBelow { subject, kind, .. } => *of(&mut self.mine, subject, *kind) += 1,
            Event::CameOut { subject, kind, .. } => *of(&mut self.mine, subject, *kind) -= 1,
            _ => {}
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn counts_are_entries_minus_exits(inputs in proptest::collection::vec(input(), 1..150)) {
        let mut ledger = Ledger::default();
        run(&mut fresh(), &mut 0.0, &inputs, |tracking, events| {
            for event in events {
                ledger.write(event);
            }
            let head = tracking.headcount();
            assert_eq!(head.mine, ledger.mine);
            for (level, count) in &head.levels {
                assert_eq!(*count, ledger.levels.get(level).copied().unwrap_or_default(), "level {level}");
            }
            for (zone, count) in &head.zones {
                assert_eq!(*count, ledger.zones.get(zone).copied().unwrap_or_default(), "zone {zone}");
            }
            // The lists agree with the counts.
            for zone in tracking.zones() {
                let sum = zone.count.people + zone.count.unassigned_tags + zone.count.vehicles + zone.count.assets;
                assert_eq!(zone.inside.len(), sum as usize);
                assert!(zone.inside.iter().all(|subject| ledger.inside.contains(&(zone.live.zone.id.clone(), subject.clone()))));
                assert_eq!(tracking.zone(&zone.live.zone.id).unwrap(), zone);
            }
            let below = head.mine.heads() + head.mine.vehicles + head.mine.assets;
            assert_eq!(tracking.below().count(), below as usize);
        });
    }

    #[test]
    fn one_alarm_is_open_for_a_key_and_events_tell_which(inputs in proptest::collection::vec(input(), 1..150)) {
        let mut open: BTreeMap<AlarmKey, AlarmId> = BTreeMap::new();
        let mut last = 0;
        run(&mut fresh(), &mut 0.0, &inputs, |tracking, events| {
            for event in events {
                match event {
                    Event::AlarmRaised { alarm } => {
                        assert_eq!(open.insert(alarm.key.clone(), alarm.id), None, "raised twice: {alarm:?}");
                        assert_eq!(alarm.id.0, last + 1);
                        last += 1;
                    }
                    Event::AlarmCleared { alarm } => assert_eq!(open.remove(&alarm.key), Some(alarm.id)),
                    _ => {}
                }
            }
            let told: BTreeMap<AlarmKey, AlarmId> =
                tracking.open_alarms().map(|alarm| (alarm.key.clone(), alarm.id)).collect();
            assert_eq!(told, open);
        });
    }

    #[test]
    fn a_split_run_is_the_whole_run(inputs in proptest::collection::vec(input(), 2..120), cut in any::<proptest::sample::Index>()) {
        let cut = cut.index(inputs.len());
        let (mut whole, mut whole_events) = (fresh(), Vec::new());
        run(&mut whole, &mut 0.0, &inputs, |_, events| whole_events.extend_from_slice(events));
        let (mut first, mut events, mut now_s) = (fresh(), Vec::new(), 0.0);
        run(&mut first, &mut now_s, &inputs[..cut], |_, told| events.extend_from_slice(told));
        let saved = bytes(&first);
        let mut second: Tracking = rmp_serde::from_slice(&saved).unwrap();
        second.attach(common::mine());
        run(&mut second, &mut now_s, &inputs[cut..], |_, told| events.extend_from_slice(told));
        prop_assert_eq!(events, whole_events);
        prop_assert_eq!(bytes(&second), bytes(&whole));
        prop_assert_eq!(second.headcount(), whole.headcount());
    }
}
