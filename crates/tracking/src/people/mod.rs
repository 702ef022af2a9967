//! People, tags and who wears which.

mod record;
mod roster;

pub use record::{Assignment, Person, Subject, Tag, TagKind, Worn};
pub(crate) use roster::{PersonRecord, Roster, TagRecord};
