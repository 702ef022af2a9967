//! People, vehicles and air in a mine.
#![expect(clippy::unwrap_used, clippy::float_cmp, reason = "tests; what is equal is equal to the bit")]

mod common;
mod people;
mod pressure;
mod roam;
mod vehicles;
