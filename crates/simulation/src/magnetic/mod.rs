//! The magnetic field where the sensor is: the Earth's, and what steel and currents add to it.
//!
//! `B(p, t) = B_earth + Σ B_steel(p, t) + Σ B_cable(p, t)`
//!
//! Every term is closed-form, curl-free and divergence-free outside its source, and finite everywhere:
//!
//! | source | outside | inside |
//! |---|---|---|
//! | [`EarthField`] | the same everywhere | – |
//! | [`SteelBody`], a uniformly magnetised sphere | `μ₀/4π (3 (m·r̂) r̂ − m)/r³` | `μ₀/4π 2 m/a³` (Jackson 1999, §5.10) |
//! | [`Cable`], an infinite straight conductor | `μ₀ I/2πr`, around it | grows evenly with `r` (Jackson 1999, §5.3) |
//!
//! Bodies stand still or move along a [`Course`]; steel is there from the first sample to the last, wherever its course
//! has brought it.
//!
//! # Frames and units
//! ENU, the frame of the motion: origin at the sensor's first place, y to **true** north, m, s. Field in µT of magnetic
//! flux density, moments in A·m². `μ₀/4π` is 1e-7 T·m/A within 1e-9 (CODATA 2018).
//!
//! # Limits
//! A real car is no dipole at its own length: closer than that its field is patchier than here. Steel does not shield or
//! bend the field of other steel; eddy currents in moving steel are left out.

mod course;
mod earth;
mod sources;

pub use course::{Course, Move};
pub use earth::EarthField;
pub use sources::{Cable, SteelBody};

use crate::error::SimulationError;
use crate::motion::Motion;
use adit_core::nalgebra::Vector3;

/// Steps at which the largest disturbance along a motion is looked for: everywhere, then around the largest found, s. A
/// swinging foot moves 2 cm in the first, 0.4 mm in the second.
const PEAK_STEP_S: f64 = 0.005;
const PEAK_FINE_STEP_S: f64 = 1e-4;

/// The Earth's field and everything that disturbs it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MagneticWorld {
    /// The undisturbed field.
    pub earth: EarthField,
    /// Bodies of steel.
    pub steel: Vec<SteelBody>,
    /// Conductors.
    pub cables: Vec<Cable>,
}

impl MagneticWorld {
    /// A world without steel and currents.
    pub fn undisturbed(earth: EarthField) -> Self {
        Self { earth, steel: Vec::new(), cables: Vec::new() }
    }

    /// The whole field at a place and time, ENU, µT.
    pub fn field_ut(&self, position_m: &Vector3<f64>, time_s: f64) -> Vector3<f64> {
        self.earth.enu_ut() + self.disturbance_ut(position_m, time_s)
    }

    /// What steel and currents add there, ENU, µT.
    pub fn disturbance_ut(&self, position_m: &Vector3<f64>, time_s: f64) -> Vector3<f64> {
        let steel = self.steel.iter().map(|body| body.field_ut(&self.earth, position_m, time_s));
        let cables = self.cables.iter().map(|cable| cable.field_ut(position_m, time_s));
        steel.chain(cables).sum()
    }

    /// All parameters make sense.
    pub fn check(&self) -> Result<(), SimulationError> {
        self.earth.check()?;
        self.steel.iter().try_for_each(SteelBody::check)?;
        self.cables.iter().try_for_each(Cable::check)
    }
}

/// The largest field of one body along a motion, µT.
fn largest_along(body: &SteelBody, earth: &EarthField, motion: &impl Motion) -> f64 {
    let norm_ut = |time_s: f64| body.field_ut(earth, &motion.at(time_s).position_m, time_s).norm();
    let end_s = motion.duration_s();
    let search = |from_s: f64, until_s: f64, step_s: f64| {
        let mut most = (norm_ut(until_s), until_s);
        let (mut steps, mut time_s) = (0.0, from_s);
        while time_s < until_s {
            let here = (norm_ut(time_s), time_s);
            if here.0 > most.0 {
                most = here;
            }
            steps += 1.0;
            time_s = from_s + steps * step_s;
        }
        most
    };
    let (_, near_s) = search(0.0, end_s, PEAK_STEP_S);
    let (from_s, until_s) = ((near_s - PEAK_STEP_S).max(0.0), (near_s + PEAK_STEP_S).min(end_s));
    search(from_s, until_s, PEAK_FINE_STEP_S).0
}
