//! People, vehicles and air in a mine.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;
mod people;
mod pressure;
mod vehicles;
