//! Radio in the simulated mine: signal strengths, UWB ranges with their channel impulse responses, portals.
//!
//! ```text
//! Mine ─┐                    ┌─ Tag::scan      → SignalStrength
//! RadioSpec ─ RadioWorld ────┼─ Tag::ranges    → RangeOutcome (range, reception, truth)
//! Outages ─┘     Antenna, ───┼─ Tag::sightings → Sighting
//!            Surroundings    └─ delivery: clocks, losses, duplicates, delays
//! ```
//!
//! [`RadioWorld`] holds what is the same for everybody; a [`Tag`] per person holds draws and memory of its own, so that people can
//! be simulated in any order and on any number of threads. What belongs to a place (shadowing, echoes) is keyed by seed, device and place:
//! a second visit finds it again. Who stands where is asked from outside ([`Surroundings`]).
//!
//! | subject | module |
//! |---|---|
//! | rock, corners, shortest way round | `paths`, `ways` |
//! | people, vehicles, pillars, the wearer | [`scene`], `screen` |
//! | signal strength | [`wifi`] |
//! | ranges, echoes, receiver | [`uwb`] |
//! | what fails when | [`outage`] |
//! | what arrives when | [`delivery`] |
//!
//! Frames: axes of the mine's grid, m; headings from north, clockwise, rad; time in s after the start of the simulation.
//! Equations, sources and comparison with recorded sets: `docs/simulation/radio.md`.

mod field;
mod keyed;
mod paths;
mod screen;
mod tag;
mod ways;
mod world;

pub mod delivery;
pub mod outage;
pub mod scene;
pub mod spec;
pub mod uwb;
pub mod wifi;

pub use outage::{Dead, Outage};
pub use scene::{Antenna, Obstacle, Shape, Surroundings};
pub use spec::{BodySpec, PortalSpec, RadioSpec};
pub use tag::Tag;
pub use uwb::spec::{MultipathSpec, ReceiverSpec, UwbSpec};
pub use uwb::{Blockers, LinkClass, RangeDetail, RangeOutcome, RangeTruth};
pub use wifi::spec::RssiSpec;
pub use world::RadioWorld;

/// Speed of light, m/ns.
pub(crate) const LIGHT_M_PER_NS: f64 = 0.299_792_458;
