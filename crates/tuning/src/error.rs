//! Why a calibration cannot be made.

use crate::magnetometer::{Coverage, Direction};
use adit_core::time::Time;
use std::fmt::Write as _;

/// Why a calibration cannot be made: what was found, what is needed, what to do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TuningError {
    /// Readings of one sensor do not come in rising order of time.
    #[error("a reading at {found} s does not come after the one at {before} s")]
    TimeNotRising {
        /// Time of the reading.
        found: Time,
        /// Time of the one before.
        before: Time,
    },
    /// A reading holds a NaN or an infinity.
    #[error("the reading at {time} s holds a value that is not a finite number")]
    NotFinite {
        /// Its time.
        time: Time,
    },
    /// Not enough readings for the fit.
    #[error("{found} readings of the {sensor}, expected {expected} or more")]
    TooFewReadings {
        /// Which sensor.
        sensor: &'static str,
        /// How many there are.
        found: usize,
        /// How many are needed.
        expected: usize,
    },
    /// A range or a distance that is none.
    #[error("a range or distance of {found} m, expected a finite number")]
    Range {
        /// What was found, m.
        found: f64,
    },
    /// Nothing is left to judge on.
    #[error(
        "the ranges are of {found} places, geometries or walks, expected {expected} or more: what some tell is judged on others"
    )]
    FewGroups {
        /// How many there are.
        found: usize,
        /// How many are needed.
        expected: usize,
    },
    /// The magnetometer was hardly turned, or about one axis only.
    #[error(
        "the readings of the magnetometer lie within {thickness_percent:.1} % of a plane (normal {normal} of the sensor): it was turned \
         about one axis only. Turn the sensor about all axes: hold each of its six sides up in turn and turn it once around there"
    )]
    Flat {
        /// Thinnest over widest extent of the readings, %.
        thickness_percent: f64,
        /// Normal of the plane.
        normal: Direction,
    },
    /// Readings do not lie on an ellipsoid.
    #[error(
        "the readings of the magnetometer do not lie on an ellipsoid ({what}): was the sensor turned about all axes, away from steel \
         and motors?"
    )]
    NoEllipsoid {
        /// What went wrong.
        what: String,
    },
    /// The motion showed too few directions of the field.
    #[error("{}", shortfall(coverage))]
    Coverage {
        /// What was seen and what is missing.
        coverage: Box<Coverage>,
    },
    /// The rest is shorter than the fit needs.
    #[error(
        "the longest rest lasts {found_s:.0} s (from {from_s:.1} s on, until {ended_by}), expected {expected_s:.0} s or more; an hour is better"
    )]
    ShortRest {
        /// Its length, s.
        found_s: f64,
        /// What is needed, s.
        expected_s: f64,
        /// When it began, s.
        from_s: f64,
        /// What ended it.
        ended_by: String,
    },
    /// The sensor never was at rest.
    #[error(
        "the sensor was never at rest: even in the quietest tenth of the log its {sensor} varies by {found:.2e} {unit} within a second, \
         expected less than {expected:.0e} {unit}"
    )]
    NoRest {
        /// Which sensor.
        sensor: &'static str,
        /// Standard deviation within a second.
        found: f64,
        /// The limit.
        expected: f64,
        /// Unit of both.
        unit: &'static str,
    },
    /// An axis whose readings never change has no noise to be measured.
    #[error(
        "the {axis} axis of the {sensor} reads the same all the time: its steps are too coarse, or it is not connected"
    )]
    Frozen {
        /// Which sensor.
        sensor: &'static str,
        /// Which axis.
        axis: &'static str,
    },
    /// A search that cannot begin, or not go on from where it was.
    #[error("{what}: found {found}, expected {expected}")]
    Search {
        /// Which setting.
        what: &'static str,
        /// What was found.
        found: String,
        /// What is needed.
        expected: String,
    },
    /// The World Magnetic Model has no answer there and then.
    #[error("no magnetic model for this place and day: {reason}")]
    NoMagneticModel {
        /// What the model said.
        reason: String,
    },
}

fn shortfall(coverage: &Coverage) -> String {
    let mut text = format!(
        "the motion showed the sensor {} of {} directions of the field: the calibrated field would be off by up to {}, expected 2 % or less",
        coverage.cells_seen,
        coverage.cells,
        if coverage.worst_error_percent < 100.0 {
            format!("{:.1} %", coverage.worst_error_percent)
        } else {
            "any amount".to_owned()
        }
    );
    let mut names: Vec<String> = coverage.missing.iter().map(ToString::to_string).collect();
    names.dedup();
    // Writing to a String does not fail.
    let _ = write!(
        text,
        ". Missing is the field along {} of the sensor: point each of these along the field (in the northern hemisphere down and to the \
         north, in the southern up and to the north) and turn the sensor about it",
        names.join(", ")
    );
    text
}
