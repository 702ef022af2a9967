//! The positioning methods, one module each, and what they have in common.
//!
//! A method is three structs: its settings ([`MethodSettings`], serialisable, the defaults serve everybody), its state
//! (whatever implements [`Method`]; serialisable, so that a run can be stopped and continued bit for bit) and its
//! [`MethodReport`]. Whoever drives one hands it observations and takes [`Solution`]s; nothing here reads a file.
//!
//! ```
//! use adit_estimation::methods::{Method, MethodSettings, foot_ins::FootInsParams};
//! # fn run(log: impl Iterator<Item = adit_observation::Observation>) -> Result<(), adit_estimation::methods::MethodError> {
//! let mut method = FootInsParams::default().start()?;
//! for observation in log {
//!     let mut solution = method.observe(&observation)?;
//!     while let Some(now) = solution {
//!         assert!(now.position_m.norm() >= 0.0);
//!         solution = method.next_due()?;
//!     }
//! }
//! while let Some(last) = method.finish_next()? {
//!     assert!(last.position_m.norm() >= 0.0);
//! }
//! # Ok(())
//! # }
//! # run(core::iter::empty()).unwrap_err();
//! ```

pub mod ahrs;
pub mod alignment;
mod error;
mod foot_input;
pub mod foot_ins;
pub mod fused;
pub mod ins_wifi;
pub mod marg_ins;
pub mod pdr;
pub mod pdr_wifi;
mod somewhere;
mod tunable;
pub mod uwb_filter;
pub mod uwb_ls;
pub mod uwb_pdr;
pub mod wifi;

pub use error::{MethodError, MethodWarning};
pub use tunable::NoiseParameter;

use crate::magnetic::gate::ReferenceField;
use crate::radio::RadioSite;
use crate::weighed::SourceWeighed;
use adit_core::solution::Solution;
use adit_observation::{ImuSpecification, Observation, Site, StartPose};
use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::fmt::Debug;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// Which parts of a [`Solution`] a method estimates; the others are zero and mean nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Estimates {
    /// Position, velocity and attitude.
    Path,
    /// Position alone: the attitude is none, nothing is known of velocity and attitude but what is true of everybody.
    Position,
    /// Attitude alone: position and velocity are zero, with zero covariance.
    Attitude,
}

/// What a method does with the radio of a site: places of transmitters, path loss, maps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RadioUse {
    /// Nothing.
    Unused,
    /// Positions by signal strength, where something is known.
    Optional,
    /// Nothing works without.
    Needed,
}

/// Where a tag is worn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Worn {
    /// On a foot.
    Foot,
    /// Anywhere else on somebody who walks: waist, chest, head, pocket, hand.
    Body,
    /// On nobody's body: a tool, a vehicle, a hand that turns it about.
    Elsewhere,
}

/// What is known of a sensor and a site beside the log; a method takes what it can use.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Known {
    /// Noise of the inertial sensor.
    pub specification: Option<ImuSpecification>,
    /// Angle from true to magnetic north, positive to the east, rad.
    pub declination_rad: Option<f64>,
    /// Norm and dip of the Earth's field at the site.
    pub field: Option<ReferenceField>,
    /// Where the origin of the level frame lies on Earth.
    pub site: Option<Site>,
    /// Pose at the first inertial sample.
    pub start: Option<StartPose>,
    /// The body's axes are those of the wearer (x forward, y left, z up): somebody declared how the tag is mounted.
    pub mounted: bool,
    /// Where the tag is worn.
    pub worn: Option<Worn>,
}

/// A method at work: observations in, solutions out, in bounded memory.
pub trait Method {
    /// What it says about its run.
    type Report: MethodReport;

    /// Takes the next observation; a solution may be late and carries its own time.
    fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError>;

    /// A further solution that the observations so far make due, if any.
    fn next_due(&mut self) -> Result<Option<Solution>, MethodError>;

    /// After the last observation: the solutions still owed, one by one, then `None`.
    fn finish_next(&mut self) -> Result<Option<Solution>, MethodError>;

    /// What the run did so far.
    fn report(&self) -> &Self::Report;

    /// The last innovation of each anchor and transmitter that was heard lately; none of a method that does not hold them one by one.
    fn last_weighed(&self) -> Vec<SourceWeighed> {
        Vec::new()
    }
}

/// What a method says about its run.
pub trait MethodReport: Clone + Serialize {
    /// All it has to say, for a report in JSON.
    fn details(&self) -> impl Serialize {
        self
    }

    /// Share of the inertial samples at which the sensor was at rest or the foot stood, 0 to 1; `None` where the method does not tell.
    fn share_at_rest(&self) -> Option<f64> {
        None
    }

    /// Odd things that the method met.
    fn warnings(&self) -> &[MethodWarning];

    /// Normalised innovations squared of the measurements used.
    fn nis(&self) -> Option<Nis> {
        None
    }

    /// Measurements that did not count in full and are not in [`Self::nis`]: refused, weighed down, or with widened noise.
    fn outliers(&self) -> u64 {
        0
    }
}

/// Normalised innovations squared over a run: their sum is χ² with `count · dimension` degrees of freedom when the filter is
/// consistent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Nis {
    /// Degrees of freedom of each.
    pub dimension: usize,
    /// How many.
    pub count: u64,
    /// Their sum.
    pub sum: f64,
}

/// All that is fixed before the first observation, and the start of the method.
pub trait MethodSettings: Clone + Debug + Default + Serialize + DeserializeOwned {
    /// What a run leaves behind.
    type Report: MethodReport;

    /// Name on the command line.
    const NAME: &'static str;
    /// What the solutions hold.
    const ESTIMATES: Estimates = Estimates::Path;
    /// Whether [`Self::start_fixed_lag`] exists.
    const FIXED_LAG: bool = false;
    /// Whether [`Self::smooth`] exists.
    const WHOLE_LOG: bool = false;
    /// What [`Self::at_site`] is good for.
    const RADIO: RadioUse = RadioUse::Unused;
    /// The settings that tuning may search, in parts.
    const NOISE: &'static [&'static [NoiseParameter]] = &[];

    /// These settings with what is known of the sensor and the site.
    #[must_use]
    fn knowing(self, known: &Known) -> Self;

    /// These settings with the radio of the site; it is no setting itself and is never written with them.
    #[must_use]
    fn at_site(self, radio: &Arc<RadioSite>) -> Self {
        let _ = radio;
        self
    }

    /// Starts the method, streaming.
    fn start(self) -> Result<Box<dyn Method<Report = Self::Report>>, MethodError>;

    /// Starts the method with solutions smoothed over `lag_s` seconds, still streaming.
    fn start_fixed_lag(self, lag_s: f64) -> Result<Box<dyn Method<Report = Self::Report>>, MethodError> {
        let _ = lag_s;
        Err(MethodError::NoSmoother { method: Self::NAME, over: "a fixed lag" })
    }

    /// Runs the method over a whole log and smooths it.
    ///
    /// `progress` hears of the work done, from 0 to twice the number of observations.
    fn smooth(
        self,
        log: &[Observation],
        progress: &mut dyn FnMut(usize),
    ) -> Result<(Vec<Solution>, Self::Report), MethodError> {
        let _ = (log, progress);
        Err(MethodError::NoSmoother { method: Self::NAME, over: "the whole log" })
    }
}
