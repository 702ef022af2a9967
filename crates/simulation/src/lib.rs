//! Truth and sensor errors from closed-form motion.
//!
//! A simulation is a chain of four parts, each usable alone:
//!
//! 1. [`WalkPlan`]: legs (straight, arc, turn, ramp, stairs, stand) become footprints;
//! 2. [`FootWalk`]: the pose of a foot-mounted sensor as a C³ function of time, with exact derivatives;
//! 3. [`IdealImu`]: what a faultless IMU would read over a sample's interval;
//! 4. [`ImuErrors`]: what a real one makes of it.
//!
//! [`generate`] runs them for a [`FootWalkScenario`] and streams samples with the truth. Beside them stand
//!
//! 5. [`Tumble`]: a tag turned by hand or worn on a waist; any [`Motion`] can carry the sensors ([`Generator::new`]);
//! 6. [`MagneticWorld`]: the Earth's field, steel that stands or moves, cables;
//! 7. [`Magnetometer`]: what a real one makes of that field.
//!
//! [`radio`] is what radios say in a mine: signal strengths, ranges, channel impulse responses.
//! [`people`] and [`pressure`] are a mine's: who walks, works and rides where, sensors on them, and the air that they breathe.
//! [`workforce`] joins them all: the log of everybody in a mine.
//!
//! [`roadway`] is a world of its own: a level walk on the rotating ellipsoid, with position fixes.
//!
//! [`generate_marg`] adds the last two to a walk, [`Generator::with_magnetometer`] to any motion. Frames are those of
//! [`adit_core`]: ENU, z up. This crate never uses the estimators, and shares no mechanisation with them: it has no
//! strapdown integration at all.

mod blend;
mod emission;
mod error;
mod gait;
mod jet;
mod motion;
mod walk_plan;

pub mod foot_motion;
pub mod ideal_imu;
pub mod imu_errors;
pub mod imu_presets;
pub mod magnetic;
pub mod magnetometer;
pub mod magnetometer_presets;
pub mod marg;
pub mod people;
pub mod pressure;
pub mod radio;
pub mod roadway;
pub mod scenario;
mod told_start;
pub mod tumble;
pub mod workforce;

pub use emission::Emission;
pub use error::SimulationError;
pub use foot_motion::FootWalk;
pub use gait::{Foot, Gait};
pub use ideal_imu::{IdealImu, Inertial, STANDARD_GRAVITY_M_S2, Sampling};
pub use imu_errors::{ImuErrorModel, ImuErrors, TriadErrors};
pub use magnetic::{Cable, Course, EarthField, MagneticWorld, Move, SteelBody};
pub use magnetometer::{Magnetometer, MagnetometerModel};
pub use marg::{MagneticTruth, MargGenerator, generate_marg};
pub use motion::{Motion, MotionState};
pub use people::{Person, Population, PopulationSpec};
pub use pressure::{Barometer, BarometerModel, MineAir};
pub use radio::{RadioSpec, RadioWorld, Tag};
pub use roadway::{FixModel, RoadwayGenerator, RoadwayLeg, RoadwayPlan, RoadwayRanges, RoadwayWalk};
pub use scenario::{FootWalkScenario, Generator, TruthState, generate};
pub use told_start::{StartErrors, ToldStart};
pub use tumble::{Swing, Tumble};
pub use walk_plan::{Footprint, Leg, Stride, WalkPlan};
