//! Everything that comes in, one entry after the other, on disk before it is acknowledged.
//!
//! An [`Entry`] has a position, counted from 1, and the time at which it arrived. Whatever the server knows of tags and people is a
//! function of the entries in their order ([`crate::pipeline`]); after a crash they are read again from the last snapshot on.
//!
//! **Files.** `journal/<position of the first entry, 20 digits>.seg`; each begins with [`HEAD`], then records: length of the body
//! (`u32`, little endian), CRC-32 of position and body (`u32`), body (protobuf, [`Entry`]). A record that is cut or does not fit its CRC at
//! the end of the last file was being written when the power went: nobody was told that it is stored, and it is cut off. Anywhere
//! else it is damage, and an error that names file and byte.
//!
//! **Writing.** [`Committer`] gathers what waits, writes it at once, calls `fdatasync` once, and only then acknowledges: under load
//! hundreds of entries share one sync.

mod committer;
mod entry;
mod seen;
mod segments;

pub use committer::{Appended, Committed, Committer, Gateways, Group, NotStored, Numbered, Waiting};
pub use entry::{Entry, GatewayBatch, GatewayStatus, OutsidePosition, UserCommand, What};
pub use seen::{Seen, Spans};
pub use segments::{HEAD, Journal};

/// Where an entry stands, from 1; 0 is before all.
pub type Position = u64;
