//! People and vehicles that move through a mine.
//!
//! [`Population`] makes vehicles and people from a specification and a seed. A [`Person`] has an itinerary on the mine's network: errands
//! that are given ([`PersonSpec`]) or a shift that is drawn ([`ShiftSpec`]). It is asked twice over:
//!
//! * [`Person::at`]: where the body is, whither it faces, what it does: cheap, for radio, for others, for headcounts;
//! * [`Person::waist`] and [`Person::foot`]: the pose of a sensor with exact derivatives, a [`Motion`](crate::Motion), for an IMU.
//!
//! Equations stand in the modules: ways, steps, pelvis, seat, foot. Frames: mine grid for places, headings anticlockwise from east;
//! body axes x forward, y left, z up. m, s, rad.

mod body;
mod errands;
mod foot;
mod ground;
mod hermite;
mod itinerary;
mod path;
mod population;
mod posture;
mod shift;
mod steps;
mod turn;
mod vehicle;
mod vibration;
mod waist;

pub use body::Body;
pub use errands::{Errand, Pace};
pub use foot::FootMotion;
pub use ground::Place;
pub use itinerary::{Activity, Whereabouts};
pub use population::{Person, PersonSpec, Population, PopulationSpec};
pub use shift::{Shares, ShiftSpec};
pub use vehicle::{Dwell, Vehicle, VehiclePose, VehicleSpec};
pub use waist::{Belt, WaistMotion};
