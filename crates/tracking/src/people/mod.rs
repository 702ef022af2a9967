//! People, tags and who wears which.

mod record;

pub use record::{Assignment, Person, Subject, Tag, TagKind, Worn};
