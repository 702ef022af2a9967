//! What happened, told as it happens.

use crate::alarms::{Alarm, AlarmId, Note};
use crate::evacuation::EvacuationSummary;
use crate::input::DeviceKind;
use crate::people::{Subject, TagKind};
use adit_core::time::Time;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// What happened. Times are those at which it happened by the fixes, which may lie before the moment it was told.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "event", rename_all = "kebab-case")]
pub enum Event {
    /// Somebody or something came into a zone.
    ZoneEntered {
        /// Id of the zone.
        zone: String,
        /// Who.
        subject: Subject,
        /// What kind of tag they are followed by: only people are counted.
        kind: TagKind,
        /// When.
        time: Time,
        /// How this is known.
        entry: Entry,
    },
    /// Somebody or something left a zone.
    ZoneLeft {
        /// Id of the zone.
        zone: String,
        /// Who.
        subject: Subject,
        /// What kind of tag they are followed by.
        kind: TagKind,
        /// When they had come.
        entered: Time,
        /// When they left.
        time: Time,
        /// How this is known.
        exit: Exit,
    },
    /// Somebody or something came onto a level, left it, or changed it. Who is in a portal is on no level.
    LevelChanged {
        /// Who.
        subject: Subject,
        /// What kind of tag they are followed by.
        kind: TagKind,
        /// From which level.
        from: Option<String>,
        /// To which level.
        to: Option<String>,
        /// When.
        time: Time,
    },
    /// Somebody or something is below from now on: out of a portal, or seen for the first time.
    WentBelow {
        /// Who.
        subject: Subject,
        /// What kind of tag they are followed by.
        kind: TagKind,
        /// When.
        time: Time,
        /// Since when their shift runs: before `time` where they were out for a moment only.
        shift_since: Time,
    },
    /// Somebody or something is out.
    CameOut {
        /// Who.
        subject: Subject,
        /// What kind of tag they are followed by.
        kind: TagKind,
        /// When.
        time: Time,
        /// Since when their shift ran.
        shift_since: Time,
        /// How this is known.
        way: WayOut,
    },
    /// Somebody below is not heard any more, by none of their tags.
    ContactLost {
        /// Who.
        subject: Subject,
        /// When they were heard last.
        last_heard: Time,
    },
    /// Somebody is heard again.
    ContactRegained {
        /// Who.
        subject: Subject,
        /// When they had been heard last.
        last_heard: Time,
        /// When they were heard again.
        time: Time,
    },
    /// A tag that nobody has registered was heard for the first time.
    TagAppeared {
        /// Id of the tag.
        tag: String,
        /// When.
        time: Time,
    },
    /// Somebody wears a tag from now on.
    TagAssigned {
        /// Id of the tag.
        tag: String,
        /// Id of the person.
        person: String,
        /// When.
        time: Time,
    },
    /// Somebody wears a tag no more.
    TagReturned {
        /// Id of the tag.
        tag: String,
        /// Id of the person.
        person: String,
        /// When.
        time: Time,
    },
    /// A gateway or an anchor went.
    DeviceDown {
        /// What it is.
        kind: DeviceKind,
        /// Its id.
        id: String,
        /// When.
        time: Time,
    },
    /// A gateway or an anchor came, or came back.
    DeviceUp {
        /// What it is.
        kind: DeviceKind,
        /// Its id.
        id: String,
        /// When.
        time: Time,
    },
    /// An alarm was raised.
    AlarmRaised {
        /// The alarm.
        alarm: Alarm,
    },
    /// Nobody acknowledged an alarm in time.
    AlarmEscalated {
        /// The alarm, with its new level of escalation.
        alarm: Alarm,
    },
    /// Somebody takes care of an alarm.
    AlarmAcknowledged {
        /// The alarm.
        alarm: Alarm,
    },
    /// Somebody said something to an alarm.
    AlarmCommented {
        /// The alarm.
        alarm: AlarmId,
        /// What was said.
        note: Note,
    },
    /// An alarm is over.
    AlarmCleared {
        /// The alarm.
        alarm: Alarm,
    },
    /// Everybody out.
    EvacuationStarted {
        /// Number of the evacuation.
        id: u64,
        /// By whom.
        by: String,
        /// Why.
        note: String,
        /// Levels to leave; the whole mine where it is empty.
        levels: BTreeSet<String>,
        /// When.
        time: Time,
    },
    /// The evacuation is over.
    EvacuationStopped {
        /// Number of the evacuation.
        id: u64,
        /// By whom.
        by: String,
        /// How it ended.
        note: String,
        /// When.
        time: Time,
        /// How everybody stood.
        summary: EvacuationSummary,
    },
}

/// How an entry is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Entry {
    /// The way between two fixes leads in; the time is that of the crossing.
    Crossed,
    /// A fix lies inside and no way leads there: the first one, one after a long silence, or a jump.
    Appeared,
    /// The zone was drawn round them, or the tag was given to them there.
    Commanded,
}

/// How an exit is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Exit {
    /// The way between two fixes leads out; the time is that of the crossing.
    Crossed,
    /// A fix lies outside and no way leads there.
    Vanished,
    /// The zone was changed, the tag was given to somebody, or somebody was seen outside.
    Commanded,
}

/// How it is known that somebody is out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum WayOut {
    /// They are in a portal.
    Portal,
    /// A user says so, or the tag was given to somebody who takes their place.
    Commanded,
}
