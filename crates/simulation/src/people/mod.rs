//! People and vehicles that move through a mine.
//!
//! [`Population`] makes vehicles and people from a specification and a seed. A [`Person`] has an itinerary on the mine's network: errands
//! that are given ([`PersonSpec`]) or a shift that is drawn ([`ShiftSpec`]). It is asked twice over:
//!
//! * [`Person::at`]: where the body is, whither it faces, what it does: cheap, for radio, for others, for headcounts;
//! * [`Person::waist`] and [`Person::foot`]: the pose of a sensor with exact derivatives, a [`Motion`](crate::Motion), for an IMU.
//!
//! # Against recorded lower backs
//! 10 %, median and 90 % of 119 straight walks of `gait-lowback` (ten people, tag on the back), and of 18 simulated ones at 0.95 to 1.45 m/s and
//! 1.65 to 1.85 m (`cargo run -p adit-simulation --example waist_figures`):
//!
//! | figure | recorded | simulated |
//! |---|---|---|
//! | step time, s | 0.494 0.548 0.587 | 0.499 0.552 0.599 |
//! | vertical, peak to peak in a step, m/s² | 6.084 8.746 18.736 | 5.372 9.036 11.891 |
//! | vertical, rms, m/s² | 1.509 2.076 4.356 | 1.271 2.042 2.753 |
//! | forward, rms, m/s² | 1.094 1.500 3.498 | 0.952 1.528 2.020 |
//! | sideways, rms, m/s² | 1.032 1.432 2.508 | 0.488 0.742 0.945 |
//! | vertical at step frequency, m/s² | 1.340 1.926 4.226 | 1.444 2.188 3.015 |
//! | vertical at twice that, m/s² | 0.263 0.480 1.268 | 0.280 0.431 0.615 |
//! | forward at step frequency, m/s² | 0.887 1.274 2.912 | 0.880 1.204 1.520 |
//! | forward at twice that, m/s² | 0.335 0.598 2.086 | 0.287 0.440 0.639 |
//! | sideways at stride frequency, m/s² | 0.195 0.486 0.897 | 0.322 0.384 0.463 |
//! | sideways at thrice that, m/s² | 0.179 0.436 1.216 | 0.260 0.351 0.457 |
//! | harmonic ratio, vertical | 3.488 5.392 8.397 | 5.291 5.966 6.693 |
//! | harmonic ratio, sideways | 1.467 2.531 4.284 | 1.475 1.797 2.317 |
//! | rate about the vertical, rms, rad/s | 0.235 0.368 0.816 | 0.236 0.314 0.370 |
//! | rate about sideways, rms, rad/s | 0.201 0.321 0.861 | 0.126 0.168 0.202 |
//! | rate about forward, rms, rad/s | 0.219 0.370 0.617 | 0.189 0.254 0.301 |
//! | speed, m/s | 0.938 1.160 1.443 | 0.950 1.250 1.450 |
//!
//! # Where what stands
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
mod roam;
mod shift;
mod steps;
mod stretches;
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
pub use roam::Roam;
pub use shift::{Shares, ShiftSpec};
pub use vehicle::{Dwell, Vehicle, VehiclePose, VehicleSpec};
pub use waist::{Belt, WaistMotion};
