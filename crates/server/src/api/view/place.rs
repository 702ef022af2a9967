//! People, tags and where they are.

use super::{who, word};
use crate::api::Timestamp;
use crate::api::v1::people::PersonBody;
use crate::api::v1::tags::TagBody;
use adit_tracking::Charge;
use adit_tracking::view::{DeviceView, LastKnown, MotionView, PersonView, SubjectView, TagView, Whereabouts};
use serde::Serialize;
use utoipa::ToSchema;

/// The last that is known of where somebody is.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(as = Where)]
pub struct WhereJson {
    /// The tag that says so.
    pub tag: String,
    /// When.
    pub time: Timestamp,
    /// East, north, height on the mine's grid, m.
    pub position_m: [f64; 3],
    /// East, north, up, m/s.
    pub velocity_m_s: Option<[f64; 3]>,
    /// Radius that held them then with 95 % probability, m.
    pub radius_95_m: f64,
    /// Radius that holds them now: grown by the way that they may have gone since, m.
    pub radius_now_m: f64,
    /// Radius outside which they are with a probability of 10⁻³ at most, m.
    pub protection_level_m: f64,
    /// `fixed`, `dead-reckoning` or `lost`.
    pub quality: String,
    /// Method or system that says so.
    pub method: String,
    /// Id of the level.
    pub level: Option<String>,
    /// For how long nothing newer has come, s.
    pub age_s: f64,
}

impl From<LastKnown> for WhereJson {
    fn from(known: LastKnown) -> Self {
        Self {
            tag: known.tag,
            time: known.time.into(),
            position_m: (*known.position_m.raw()).into(),
            velocity_m_s: known.velocity_m_s.map(|velocity| (*velocity.raw()).into()),
            radius_95_m: known.radius_95_m,
            radius_now_m: known.radius_now_m,
            protection_level_m: known.protection_level_m,
            quality: word(&known.quality),
            method: known.method.to_string(),
            level: known.level,
            age_s: known.age_s,
        }
    }
}

/// Whether somebody moves.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(as = Motion)]
pub struct MotionJson {
    /// What is known of it.
    motion: String,
    /// Since when without a break.
    since: Timestamp,
}

impl From<MotionView> for MotionJson {
    fn from(view: MotionView) -> Self {
        Self { motion: word(&view.motion), since: view.since.into() }
    }
}

/// A zone that somebody is in.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(as = Stay)]
pub struct StayJson {
    zone: String,
    since: Timestamp,
}

/// Somebody, or a tag that nobody is known to wear, as is known now.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(as = Live)]
pub struct LiveJson {
    /// Id of the person.
    pub person: Option<String>,
    /// Id of the tag that nobody is known to wear.
    pub tag: Option<String>,
    /// `person`, `vehicle` or `asset`: what kind of tag they are followed by.
    pub kind: String,
    /// `below`, `out` or `unseen`.
    pub state: String,
    /// Since when they are below or out.
    pub since: Option<Timestamp>,
    /// Where.
    pub last_known: Option<WhereJson>,
    /// Zones that they are in.
    pub zones: Vec<StayJson>,
    /// Zones that they may be in: nobody can tell.
    pub possible_zones: Vec<String>,
    /// One of their tags is heard.
    pub in_contact: bool,
    /// When one was heard last.
    pub last_heard: Option<Timestamp>,
    /// By which gateway.
    pub gateway: Option<String>,
    /// Whether they move.
    pub motion: Option<MotionJson>,
    /// Numbers of the open alarms about them.
    pub alarms: Vec<u64>,
}

impl From<SubjectView> for LiveJson {
    fn from(view: SubjectView) -> Self {
        let (person, tag) = who(&view.subject);
        let (state, since) = match view.whereabouts {
            Whereabouts::Unseen => ("unseen", None),
            Whereabouts::Below { shift_since } => ("below", Some(shift_since)),
            Whereabouts::Out { since } => ("out", Some(since)),
        };
        let stays = view.zones.into_iter();
        Self {
            person,
            tag,
            kind: word(&view.kind),
            state: state.into(),
            since: since.map(Timestamp),
            last_known: view.last_known.map(WhereJson::from),
            zones: stays.map(|stay| StayJson { zone: stay.zone, since: stay.since.into() }).collect(),
            possible_zones: view.possible_zones,
            in_contact: view.in_contact,
            last_heard: view.last_heard.map(Timestamp),
            gateway: view.gateway,
            motion: view.motion.map(MotionJson::from),
            alarms: view.alarms.into_iter().map(|id| id.0).collect(),
        }
    }
}

/// A person with all that is known.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = PersonNow)]
pub(in crate::api) struct PersonJson {
    /// As entered.
    person: PersonBody,
    /// Ids of the tags they wear.
    tags: Vec<String>,
    /// Where they are.
    live: LiveJson,
}

impl From<PersonView> for PersonJson {
    fn from(view: PersonView) -> Self {
        Self { person: view.person.into(), tags: view.tags, live: view.live.into() }
    }
}

/// Who wears a tag from when until when.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Assignment)]
pub(in crate::api) struct AssignmentJson {
    tag: String,
    person: String,
    from: Timestamp,
    until: Option<Timestamp>,
}

/// How full a battery is.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Battery)]
pub(in crate::api) struct BatteryJson {
    /// When that was measured.
    time: Timestamp,
    /// 0 to 1, where the tag tells it.
    share: Option<f64>,
    /// V, where the tag tells it.
    volts: Option<f64>,
}

/// A tag with all that is known.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = TagNow)]
pub(in crate::api) struct TagJson {
    /// As entered.
    tag: TagBody,
    /// Somebody has entered it; else it was only heard.
    registered: bool,
    /// Who wears it now.
    person: Option<String>,
    /// This assignment and those to come.
    assignments: Vec<AssignmentJson>,
    /// Where it is.
    last_known: Option<WhereJson>,
    /// It is heard.
    in_contact: bool,
    /// When it was heard last.
    last_heard: Option<Timestamp>,
    /// By which gateway.
    gateway: Option<String>,
    /// How full its battery is.
    battery: Option<BatteryJson>,
    /// Whether it moves.
    motion: Option<MotionJson>,
}

impl From<TagView> for TagJson {
    fn from(view: TagView) -> Self {
        let assignments = view.assignments.into_iter().map(|assignment| AssignmentJson {
            tag: assignment.tag,
            person: assignment.person,
            from: assignment.from.into(),
            until: assignment.until.map(Timestamp),
        });
        let battery = view.battery.map(|(time, charge)| {
            let (share, volts) = match charge {
                Charge::Share(share) => (Some(share), None),
                Charge::Volts(volts) => (None, Some(volts)),
            };
            BatteryJson { time: time.into(), share, volts }
        });
        Self {
            assignments: assignments.collect(),
            tag: view.tag.into(),
            registered: view.registered,
            person: view.person,
            last_known: view.last_known.map(WhereJson::from),
            in_contact: view.in_contact,
            last_heard: view.last_heard.map(Timestamp),
            gateway: view.gateway,
            battery,
            motion: view.motion.map(MotionJson::from),
        }
    }
}

/// A gateway or an anchor.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Device)]
pub(in crate::api) struct DeviceJson {
    /// `gateway` or `anchor`.
    kind: String,
    id: String,
    /// It works.
    up: bool,
    /// Since when.
    since: Timestamp,
}

impl From<DeviceView> for DeviceJson {
    fn from(view: DeviceView) -> Self {
        Self { kind: word(&view.kind), id: view.id, up: view.up, since: view.since.into() }
    }
}
