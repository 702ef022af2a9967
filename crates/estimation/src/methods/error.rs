//! What can go wrong in a method, and what is only worth a warning: the same for all of them.

use adit_core::time::Time;
use alloc::string::String;
use serde::{Deserialize, Serialize};

/// Why a method cannot go on.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MethodError {
    /// A setting is negative, zero or not finite where it must not be.
    #[error("setting {name} of {method} cannot be used: it must be a finite number in its range")]
    Setting {
        /// Name of the method.
        method: &'static str,
        /// Name of the setting.
        name: &'static str,
    },
    /// The method has no smoother of this kind.
    #[error("{method} does not smooth over {over}")]
    NoSmoother {
        /// Name of the method.
        method: &'static str,
        /// What was to be smoothed over.
        over: &'static str,
    },
    /// A sample holds a NaN, an infinity, or a number past every sensor.
    #[error(
        "IMU sample at {time} s holds a value that no sensor gives: not finite, or above 1000 rad/s or 1e5 m/s²"
    )]
    NoReading {
        /// Time of the sample.
        time: Time,
    },
    /// Samples do not come in rising order of time.
    #[error("IMU sample at {found} s does not come after the one at {before} s")]
    TimeNotRising {
        /// Time of the sample.
        found: Time,
        /// Time of the one before.
        before: Time,
    },
    /// The specific force at the start cannot be gravity.
    #[error(
        "mean specific force at the start is {found:.3} m/s², expected about {expected:.3} (is it in g, or is the sensor in free fall?)"
    )]
    NotGravity {
        /// Length of the mean specific force, m/s².
        found: f64,
        /// Gravity at the site, m/s².
        expected: f64,
    },
    /// The specific force at the start has no direction.
    #[error("mean specific force at the start is zero or not a number: the sensor cannot be levelled")]
    NoForce,
    /// The estimate has left the range of numbers.
    #[error("the estimate at {time} s is not finite any more")]
    Diverged {
        /// Time of the sample.
        time: Time,
    },
    /// What is known of the site does not allow what the method does.
    #[error("{method} needs {needs}")]
    NoRadio {
        /// Name of the method.
        method: &'static str,
        /// What it needs, and where that comes from.
        needs: &'static str,
    },
    /// The log holds no signal strength that tells a position.
    #[error(
        "no position: of {signals} signal strengths in the log, {unknown} are of transmitters that are not known{names}"
    )]
    NoPosition {
        /// Signals in the log.
        signals: u64,
        /// Of these, from unknown transmitters.
        unknown: u64,
        /// The first of them in brackets; empty of none.
        names: String,
    },
    /// The log holds no ranges that tell a position.
    #[error(
        "no position: of {ranges} ranges in the log, {unknown} are to anchors that are not known{names}; a position needs ranges to several known anchors at about one time"
    )]
    NoRangeFix {
        /// Ranges in the log.
        ranges: u64,
        /// Of these, to unknown anchors.
        unknown: u64,
        /// The first of them in brackets; empty of none.
        names: String,
    },
    /// A walk of which nothing tells where on the map it was.
    #[error(
        "the walk has no place in the mine: {ranges} ranges, {signals} signal strengths and {fixes} positions with known places in the log do not tell one; without the mine it is told in a frame of its own"
    )]
    NeverPlaced {
        /// Ranges to known anchors.
        ranges: u64,
        /// Signal strengths of known transmitters.
        signals: u64,
        /// Positions from outside.
        fixes: u64,
    },
    /// The log ended before the first sample.
    #[error("the log holds no IMU sample")]
    Empty,
}

/// What a user should know of a run that went on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum MethodWarning {
    /// The foot moves at the start of the log: the walk begins, with its origin, at the first stance.
    NoRestAtStart,
    /// Samples are missing: nothing was integrated over the gap.
    Gap {
        /// Time of the sample after the gap.
        time: Time,
        /// Length, s.
        length_s: f64,
    },
    /// The log has no magnetometer, or none at the start: the sensor's x axis is taken for north.
    NoMagnetometer,
    /// The log has an accelerometer alone: steps can be counted, but nothing is known of their direction.
    NoGyro,
    /// Nobody declared how the tag is mounted: which way its wearer goes is unknown until fixes tell.
    ForwardUnknown,
    /// Fix after fix contradicted the path: where it lies and which way it goes was sought anew.
    PathReopened {
        /// When it was found out.
        time: Time,
    },
    /// The body's x axis, which is to point forward, is steep: another axis serves as forward.
    SteepForward,
    /// The field at the start is not the Earth's, or not that of the reference: the heading is uncertain.
    DisturbedAtStart {
        /// Its norm, µT.
        norm_ut: f64,
    },
    /// Signals of transmitters that the site does not know: left.
    UnknownTransmitters {
        /// How many transmitters, at least.
        transmitters: usize,
        /// How many signals.
        signals: u64,
        /// The first of them.
        names: String,
    },
    /// Ranges to anchors that the site does not know: left.
    UnknownAnchors {
        /// How many anchors, at least.
        anchors: usize,
        /// How many ranges.
        ranges: u64,
        /// The first of them.
        names: String,
    },
    /// Nothing had judged whether the signals of these ranges came straight.
    Unjudged {
        /// Epochs of ranges.
        epochs: u64,
    },
    /// Nothing smooths what carries this log: the solutions are those of a stream.
    NotSmoothed,
    /// A field that was refused proved right: the heading was off, and so is the path until then.
    HeadingOpened {
        /// When it was found out.
        time: Time,
        /// By how much the heading was off, deg.
        offset_deg: f64,
    },
}

impl MethodWarning {
    /// One line for people.
    pub fn text(&self) -> String {
        match self {
            Self::NoRestAtStart => String::from(
                "the foot is not at rest at the start of the log: the path begins at the first stance, with roll and pitch from it",
            ),
            Self::Gap { time, length_s } => alloc::format!(
                "samples are missing for {length_s:.3} s before {time} s: position is uncertain from there on"
            ),
            Self::NoMagnetometer => String::from(
                "the log has no magnetometer at the start: the sensor's x axis there counts as north",
            ),
            Self::NoGyro => String::from(
                "the log has no gyro: steps and distance are estimated, but the path goes straight along the heading of the start",
            ),
            Self::ForwardUnknown => String::from(
                "no mounting is declared: the sensor's x axis counts as forward, and the path is turned by an unknown angle until fixes tell",
            ),
            Self::PathReopened { time } => alloc::format!(
                "fix after fix contradicted the path until {time} s: place and direction were sought anew from there (is the sensor's x axis forward?)"
            ),
            Self::SteepForward => String::from(
                "the sensor's x axis, which is to point forward, is steep: the axis nearest to the horizon counts as forward (the sidecar's mounting can tell)",
            ),
            Self::DisturbedAtStart { norm_ut } => alloc::format!(
                "the magnetic field at the start, {norm_ut:.1} µT, is not the Earth's: the heading is uncertain until it is"
            ),
            Self::UnknownTransmitters { transmitters, signals, names } => alloc::format!(
                "{signals} signal strengths of {transmitters} unknown transmitters ({names}) were left: neither the mine nor the radio model has them"
            ),
            Self::UnknownAnchors { anchors, ranges, names } => alloc::format!(
                "{ranges} ranges to {anchors} unknown anchors ({names}) were left: the mine has none of that name"
            ),
            Self::Unjudged { epochs } => alloc::format!(
                "nothing tells whether the ranges of {epochs} epochs came straight: all were believed (--nlos judges them)"
            ),
            Self::NotSmoothed => String::from(
                "nothing smooths what this log is of (it has no dead reckoning that is held by a map, and no foot without a magnetometer): the solutions are those of a stream",
            ),
            Self::HeadingOpened { time, offset_deg } => alloc::format!(
                "the heading was off by about {offset_deg:.0}° until {time} s, when the magnetic field proved right: the path before is turned"
            ),
        }
    }
}
