//! Calibration fits: what a sensor's own recordings tell about its errors.
//!
//! | fit | module | in → out |
//! |---|---|---|
//! | hard and soft iron, axes | [`magnetometer`] | a tumble in a constant field → offset, matrix, how sure |
//! | white noise, bias instability, random walk | [`noise`] | a sensor at rest → Allan deviation, densities |
//! | path loss of transmitters, offsets of ranges | [`radio`] | a survey → models, robust, pooled |
//! | how ranges err | [`ranges`] | ranges with a known distance → offsets, polynomial |
//! | radio map | [`fingerprint`] | a survey → mean, spread and chance of hearing at every place |
//! | declination, dip, strength of the Earth's field | [`geomagnetic`] | place and day → World Magnetic Model |
//!
//! [`optimise`] finds the parameters of anything by trial: bat, sine cosine, both together as in system S1, and CMA-ES.
//!
//! Readings come in as [`Series`], in sensor axes and SI units (field in µT), before any sidecar. What comes out fits into a sidecar
//! ([`adit_observation::sidecar`]). Nothing here reads or writes files; memory is that of the readings and a few numbers for each.

mod error;
pub mod fingerprint;
pub mod geomagnetic;
pub mod magnetometer;
pub mod noise;
pub mod optimise;
pub mod radio;
pub mod ranges;
mod robust;
mod series;

pub use error::TuningError;
pub use series::Series;
