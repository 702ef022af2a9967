//! What users may want, and what they get.

use crate::alarms::AlarmId;
use crate::input::DeviceKind;
use crate::people::{Person, Tag};
use crate::rules::Rules;
use crate::zones::LiveZone;
use adit_core::time::Time;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// What a user wants. Each is done whole or refused whole.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "command", rename_all = "kebab-case")]
pub enum Command {
    /// A new person.
    CreatePerson {
        /// The person.
        person: Person,
    },
    /// Replaces what is known of a person.
    ChangePerson {
        /// The person.
        person: Person,
    },
    /// Removes a person who is not below and wears no tag.
    RemovePerson {
        /// Id of the person.
        person: String,
    },
    /// A new tag. One that was heard before it was registered becomes registered.
    CreateTag {
        /// The tag.
        tag: Tag,
    },
    /// Replaces what is known of a tag.
    ChangeTag {
        /// The tag.
        tag: Tag,
    },
    /// Removes a tag that nobody wears.
    RemoveTag {
        /// Id of the tag.
        tag: String,
    },
    /// Gives a tag to a person.
    Assign {
        /// Id of the tag.
        tag: String,
        /// Id of the person.
        person: String,
        /// From when; from now on where it is not given or past.
        #[serde(default)]
        from: Option<Time>,
        /// Until when; for good where it is not given.
        #[serde(default)]
        until: Option<Time>,
    },
    /// Takes a tag back now, and forgets assignments to come. Who is below stays below, at the last known position.
    Unassign {
        /// Id of the tag.
        tag: String,
    },
    /// The person was seen outside, whatever the tags say.
    MarkOut {
        /// Id of the person.
        person: String,
        /// How this is known.
        #[serde(default)]
        note: String,
    },
    /// A new zone.
    CreateZone {
        /// The zone.
        zone: LiveZone,
    },
    /// Replaces a zone. Who is in the new outline is in it from now on, who is not has left.
    ChangeZone {
        /// The zone.
        zone: LiveZone,
    },
    /// How many people the zone may hold from now on.
    SetCapacity {
        /// Id of the zone.
        zone: String,
        /// How many; any number where it is not given.
        capacity: Option<u32>,
    },
    /// Removes a zone.
    RemoveZone {
        /// Id of the zone.
        zone: String,
    },
    /// Takes the zones from the mine's plan again, in place of all that were edited.
    ResetZones,
    /// Somebody has seen the alarm and takes care of it; its escalation ends.
    Acknowledge {
        /// The alarm.
        alarm: AlarmId,
        /// What they say to it.
        #[serde(default)]
        note: String,
    },
    /// Clears an alarm whose end nobody but a human can tell (distress, man down).
    Clear {
        /// The alarm.
        alarm: AlarmId,
        /// Why.
        #[serde(default)]
        note: String,
    },
    /// Writes a note to an alarm.
    Comment {
        /// The alarm.
        alarm: AlarmId,
        /// The note.
        text: String,
    },
    /// Everybody out.
    StartEvacuation {
        /// Ids of the levels to leave; the whole mine where it is empty.
        #[serde(default)]
        levels: BTreeSet<String>,
        /// Why.
        #[serde(default)]
        note: String,
    },
    /// The evacuation is over.
    StopEvacuation {
        /// How it ended.
        #[serde(default)]
        note: String,
    },
    /// A gateway or an anchor was taken away for good.
    ForgetDevice {
        /// What it is.
        kind: DeviceKind,
        /// Its id.
        id: String,
    },
    /// Other rules from now on.
    SetRules {
        /// The rules.
        rules: Box<Rules>,
    },
}

/// What became of an input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// It was taken.
    Done,
    /// The live state stays as it was.
    Ignored(Ignored),
}

/// Why an input left the live state as it was.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ignored {
    /// Older than what is known already, or as old.
    Late,
    /// From further in the future than the rules bear.
    Future,
    /// An id that is none.
    BadId,
    /// The state was read back and not attached to its mine.
    NoMine,
    /// A coordinate, a radius or a charge that is none.
    NotANumber,
    /// The method itself says that it has lost the tag: it counts as heard, the last known position stays.
    Lost,
    /// Too many tags that nobody has registered.
    TooManyTags,
}
