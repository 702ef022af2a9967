//! A small mine and a hand to drive it.
#![allow(dead_code, reason = "each test binary uses a part")]
#![expect(clippy::unwrap_used, reason = "tests")]

use adit_core::frames::Position;
use adit_core::solution::Quality;
use adit_core::time::{Interval, Time};
use adit_mine::Mine;
use adit_mine::plan::{Grid, Level, MinePlan, Roadway, RoadwayKind, Zone, ZoneKind};
use adit_tracking::{
    Activity, Alarm, AlarmKind, Command, Event, Fix, Heard, Input, Motion, Outcome, Person, Refused, Rules,
    Subject, Tag, Tracking,
};
use std::sync::Arc;

/// When the tests begin: a Unix time, so that nothing works only near zero.
pub const BEGIN_S: i64 = 1_795_000_000;

pub fn at(seconds: f64) -> Time {
    Time::from_nanos(BEGIN_S * 1_000_000_000) + Interval::from_seconds(seconds).unwrap()
}

pub fn zone(id: &str, kind: ZoneKind, level: &str, [west, east]: [f64; 2], north: f64) -> Zone {
    let (low, high) = (north - 5.0, north + 5.0);
    Zone {
        id: id.into(),
        name: None,
        kind,
        level: level.into(),
        capacity: None,
        exit_tolerance_m: 0.0,
        exit_delay_s: 0.0,
        outline_m: vec![[west, low], [east, low], [east, high], [west, high]],
    }
}

fn roadway(id: &str, points: &[[f64; 3]]) -> Roadway {
    Roadway {
        id: id.into(),
        name: None,
        level: None,
        kind: RoadwayKind::Drift,
        width_m: 5.0,
        height_m: 3.0,
        max_slope_percent: None,
        walkable: true,
        points_m: points.iter().map(|[x, y, z]| Position::new(*x, *y, *z)).collect(),
    }
}

/// A main roadway on the upper level from the portal at x = 0 to x = 400, a ramp to the lower level, and a drift back
/// there at y = 300 to a refuge for two at its end.
///
/// ```text
/// y = 0    portal ── restricted (100–120) ── dangerous (200–203) ── shop (300–320) ── 400      z = 0
///                                                                                      │ ramp
/// y = 300  refuge (0–20) ───────────────────────────────────────────────────────────── 400      z = −50
/// ```
pub fn plan() -> MinePlan {
    let mut plan = MinePlan::new("test", Grid::Local {});
    let level = |id: &str, elevation_m| Level { id: id.into(), name: None, elevation_m };
    plan.levels = vec![level("upper", 0.0), level("lower", -50.0)];
    plan.roadways = vec![
        roadway("main", &[[-15.0, 0.0, 0.0], [400.0, 0.0, 0.0]]),
        roadway("ramp", &[[400.0, 0.0, 0.0], [400.0, 300.0, -50.0]]),
        roadway("drift", &[[400.0, 300.0, -50.0], [0.0, 300.0, -50.0]]),
    ];
    plan.zones = vec![
        zone("portal", ZoneKind::Portal, "upper", [-20.0, 10.0], 0.0),
        zone("restricted", ZoneKind::Restricted, "upper", [100.0, 120.0], 0.0),
        zone("dangerous", ZoneKind::Dangerous, "upper", [200.0, 203.0], 0.0),
        Zone {
            exit_tolerance_m: 2.0,
            exit_delay_s: 5.0,
            capacity: Some(1),
            ..zone("shop", ZoneKind::Key, "upper", [300.0, 320.0], 0.0)
        },
        Zone { capacity: Some(2), ..zone("refuge", ZoneKind::Refuge, "lower", [0.0, 20.0], 300.0) },
    ];
    plan
}

pub fn mine() -> Arc<Mine> {
    Arc::new(Mine::new(plan()).unwrap())
}

/// A tracking with its clock.
pub struct Room {
    pub tracking: Tracking,
    pub now_s: f64,
    pub events: Vec<Event>,
}

impl Default for Room {
    fn default() -> Self {
        Self::with(Rules::default())
    }
}

impl Room {
    pub fn with(rules: Rules) -> Self {
        Self { tracking: Tracking::new(mine(), rules).unwrap(), now_s: 0.0, events: Vec::new() }
    }

    /// A room with people who wear a tag each: person `p1` wears `t1`.
    pub fn of(people: usize, rules: Rules) -> Self {
        let mut room = Self::with(rules);
        for number in 1..=people {
            room.person(&format!("p{number}"));
            room.tag(&format!("t{number}"));
            room.give(&format!("t{number}"), &format!("p{number}")).unwrap();
        }
        room.events.clear();
        room
    }

    pub fn hear(&mut self, input: &Input) -> Outcome {
        self.tracking.hear(at(self.now_s), input, &mut self.events).unwrap()
    }

    pub fn command(&mut self, command: Command) -> Result<Outcome, Refused> {
        let input = Input::Command { by: "dora".into(), command };
        self.tracking.hear(at(self.now_s), &input, &mut self.events)
    }

    pub fn person(&mut self, id: &str) {
        let person = Person { id: id.into(), name: id.to_uppercase(), ..Person::default() };
        self.command(Command::CreatePerson { person }).unwrap();
    }

    pub fn tag(&mut self, id: &str) {
        self.command(Command::CreateTag { tag: Tag { id: id.into(), ..Tag::default() } }).unwrap();
    }

    pub fn give(&mut self, tag: &str, person: &str) -> Result<Outcome, Refused> {
        self.command(Command::Assign { tag: tag.into(), person: person.into(), from: None, until: None })
    }

    /// Ticks each second until this one.
    pub fn wait(&mut self, until_s: f64) {
        while self.now_s + 1.0 <= until_s {
            self.now_s += 1.0;
            self.hear(&Input::Tick);
        }
        self.now_s = until_s;
    }

    /// The same while tags are heard, but not placed, every ten seconds.
    pub fn wait_hearing(&mut self, until_s: f64, tags: &[&str]) {
        while self.now_s < until_s {
            for tag in tags {
                self.heard(tag);
            }
            self.wait((self.now_s + 10.0).min(until_s));
        }
    }

    pub fn heard(&mut self, tag: &str) -> Outcome {
        let heard = Heard { tag: tag.into(), time: at(self.now_s), gateway: Some("gw".into()) };
        self.hear(&Input::Heard(heard))
    }

    pub fn motion(&mut self, tag: &str, motion: Motion) -> Outcome {
        let activity = Activity { tag: tag.into(), time: at(self.now_s), motion };
        self.hear(&Input::Activity(activity))
    }

    /// A fix now, within half a metre.
    pub fn fix(&mut self, tag: &str, x: f64, y: f64, z: f64) -> Outcome {
        let fix = fix(tag, self.now_s, [x, y, z]);
        self.hear(&Input::Fix(fix))
    }

    /// Waits until then and has a fix on the main roadway.
    pub fn main(&mut self, until_s: f64, tag: &str, x: f64) -> Outcome {
        self.wait(until_s);
        self.fix(tag, x, 0.0, 1.0)
    }

    /// What happened since it was asked last.
    pub fn told(&mut self) -> Vec<Event> {
        core::mem::take(&mut self.events)
    }

    pub fn alarms(&self) -> Vec<&Alarm> {
        self.tracking.open_alarms().collect()
    }

    pub fn kinds(&self) -> Vec<AlarmKind> {
        self.tracking.open_alarms().map(|alarm| alarm.key.kind).collect()
    }
}

pub fn fix(tag: &str, time_s: f64, [x, y, z]: [f64; 3]) -> Fix {
    Fix {
        tag: tag.into(),
        time: at(time_s),
        position_m: Position::new(x, y, z),
        velocity_m_s: None,
        radius_95_m: 0.5,
        protection_level_m: 1.5,
        quality: Quality::Fixed,
        moving: None,
        method: "test".into(),
    }
}

pub fn person(id: &str) -> Subject {
    Subject::Person(id.into())
}
