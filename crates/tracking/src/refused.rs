//! Why a command was refused.

use crate::alarms::AlarmId;
use adit_core::time::Time;

/// Why a command was refused; nothing has changed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Refused {
    /// No such person.
    #[error("there is no person '{person}'")]
    UnknownPerson {
        /// The id given.
        person: String,
    },
    /// No such tag.
    #[error("there is no tag '{tag}'")]
    UnknownTag {
        /// The id given.
        tag: String,
    },
    /// No such zone.
    #[error("there is no zone '{zone}'")]
    UnknownZone {
        /// The id given.
        zone: String,
    },
    /// No such level.
    #[error("the mine has no level '{level}'")]
    UnknownLevel {
        /// The id given.
        level: String,
    },
    /// No such alarm, or one that was cleared long ago.
    #[error("there is no alarm {alarm} among the open and the last cleared ones")]
    UnknownAlarm {
        /// The id given.
        alarm: AlarmId,
    },
    /// No such gateway or anchor was ever heard of.
    #[error("nothing was ever heard of the device '{id}'")]
    UnknownDevice {
        /// The id given.
        id: String,
    },
    /// The id is taken.
    #[error("{what} '{id}' exists already")]
    Exists {
        /// Person, tag or zone.
        what: &'static str,
        /// The id given.
        id: String,
    },
    /// An id that is none.
    #[error(
        "the id of a {what} has 1 to {limit} characters and no control characters among them, found '{id}'"
    )]
    BadId {
        /// Person, tag or zone.
        what: &'static str,
        /// The id given, shortened.
        id: String,
        /// How long it may be.
        limit: usize,
    },
    /// Somebody else has the tag at that time.
    #[error("tag '{tag}' is worn by person '{person}' then; take it back first")]
    TagWorn {
        /// The tag.
        tag: String,
        /// Who has it.
        person: String,
    },
    /// The tag is on no person.
    #[error("tag '{tag}' is worn by nobody")]
    TagNotWorn {
        /// The tag.
        tag: String,
    },
    /// A tag of a vehicle or a thing is given to nobody.
    #[error("tag '{tag}' is not one that people wear")]
    NotWorn {
        /// The tag.
        tag: String,
    },
    /// The end does not come after the beginning.
    #[error("an assignment ends after it begins, found from {from} until {until}")]
    EndsBeforeItBegins {
        /// Beginning.
        from: Time,
        /// End.
        until: Time,
    },
    /// Who is below is not removed.
    #[error("person '{person}' is below")]
    PersonBelow {
        /// The person.
        person: String,
    },
    /// Who is out is not marked so.
    #[error("person '{person}' is not below")]
    PersonNotBelow {
        /// The person.
        person: String,
    },
    /// Who wears a tag is not removed.
    #[error("person '{person}' wears tag '{tag}'; take it back first")]
    PersonWears {
        /// The person.
        person: String,
        /// The tag.
        tag: String,
    },
    /// The outline of a zone is none.
    #[error("the outline of a zone has 3 corners or more, finite and within 10⁷ m, found {found}")]
    BadOutline {
        /// What is wrong.
        found: String,
    },
    /// A number that cannot be.
    #[error("{what} is expected {expected}, found {found}")]
    BadNumber {
        /// Its name.
        what: &'static str,
        /// What it may be.
        expected: &'static str,
        /// What it is.
        found: f64,
    },
    /// A text that is too long.
    #[error("{what} has at most {limit} characters, found {found}")]
    TooLong {
        /// What it is.
        what: &'static str,
        /// How long it may be.
        limit: usize,
        /// How long it is.
        found: usize,
    },
    /// The alarm has as many notes as are kept.
    #[error("alarm {alarm} has {limit} notes already")]
    TooManyNotes {
        /// The alarm.
        alarm: AlarmId,
        /// How many are kept.
        limit: usize,
    },
    /// Somebody was faster.
    #[error("alarm {alarm} was acknowledged by {by} already")]
    Acknowledged {
        /// The alarm.
        alarm: AlarmId,
        /// By whom.
        by: String,
    },
    /// The alarm is over.
    #[error("alarm {alarm} is cleared already")]
    Cleared {
        /// The alarm.
        alarm: AlarmId,
    },
    /// The alarm ends by itself.
    #[error("alarm {alarm} ends by itself when its condition does")]
    EndsByItself {
        /// The alarm.
        alarm: AlarmId,
    },
    /// There is an evacuation already.
    #[error("an evacuation runs since {since}")]
    Evacuating {
        /// Since when.
        since: Time,
    },
    /// There is none to stop.
    #[error("no evacuation runs")]
    NotEvacuating,
    /// The state was read back and not attached to its mine.
    #[error("tracking was not attached to its mine")]
    NoMine,
    /// The rules cannot be.
    #[error(transparent)]
    Rules(#[from] crate::rules::RulesError),
}
