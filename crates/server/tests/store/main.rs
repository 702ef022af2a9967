//! The store from outside: what goes in comes out, once, in little room, and what is wrong is told.
#![expect(clippy::unwrap_used, reason = "tests")]

mod audit;
mod common;
mod export;
mod failure;
mod logbook;
mod once;
mod packing;
mod retention;
mod walk;
