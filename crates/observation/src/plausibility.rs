//! Do the numbers fit the units in the header?
//!
//! Gravity tells. Over the first [`LOOKED_AT`] inertial samples the median length of the specific force is taken, of the
//! samples with a slow gyro where there are enough of them, else of all. A real log in m/s² has it between 8 and
//! 12 at rest and well above 3 even while running; the confusions people make are factors of 9.8, 57.3 or 1000 away:
//!
//! | median, m/s² | verdict |
//! |---|---|
//! | 0.5–2 | error: g under the name m/s², or a log with gravity taken out |
//! | 70–130 | error: m/s² under the name g |
//! | 700–1300 | error: mg or cm/s² under the name m/s² |
//! | else outside 3–40 | warning |
//! | 3–40 | fine |
//!
//! An angular rate past [`FASTEST_GYRO_RAD_S`] on one axis is past the range of every MEMS gyro, in any sample of the log:
//! error, deg/s under the name rad/s. (A foot in deg/s passes it within a step; a sensor that hardly turns does not, so
//! silence proves nothing.)
//!
//! The other quantities are judged by the median of what comes meanwhile, where there are ten or more:
//!
//! | median | verdict |
//! |---|---|
//! | pressure below 30,000 Pa, the air at 9 km | error: hPa under the name Pa |
//! | signal strength above 0 dBm, what a transmitter of 1 mW gives with the antennas touching | error: no sign, or percent |
//! | range longer than 300 m, the reach of UWB and Wi-Fi in the open | warning: cm or mm under the name m? |

use crate::error::{At, LogError, Place};
use crate::observation::Observation;
use crate::source::LogSource;
use crate::warning::{LogWarning, Warnings};
use std::collections::VecDeque;
use std::path::Path;
use std::sync::Arc;

/// Inertial samples looked at before the first observation is let through.
pub const LOOKED_AT: usize = 1000;
/// Widest ranges sold are ±4000 °/s (69.8 rad/s) per axis.
pub const FASTEST_GYRO_RAD_S: f64 = 75.0;
/// With fewer samples nothing is concluded from gravity.
const FEWEST_SAMPLES: usize = 10;
/// Slower than this counts as quiet, rad/s (20 °/s); where so many are quiet, the others are left out.
const QUIET_RATE_RAD_S: f64 = 0.35;
const ENOUGH_QUIET: usize = 50;

/// The air at 9 km, above every mine.
const THINNEST_AIR_PA: f64 = 3e4;
/// The strongest signal that somebody walks about with.
const STRONGEST_SIGNAL_DBM: f64 = 0.0;
/// What UWB and Wi-Fi reach in the open.
const LONGEST_RANGE_M: f64 = 300.0;

/// A log whose units are checked against gravity, the range of gyros, the air and the reach of radios.
pub struct UnitChecked<S> {
    source: S,
    queue: VecDeque<(Observation, At)>,
    /// What the source said at the end of the queue, if it ended badly.
    failure: Option<LogError>,
    looked: bool,
}

impl<S: LogSource> UnitChecked<S> {
    /// Checks the units of `source`.
    pub fn new(source: S) -> Self {
        Self { source, queue: VecDeque::new(), failure: None, looked: false }
    }

    /// Reads ahead and gives the verdict on gravity; done by the first observation otherwise. `false`: there is none at all.
    pub fn look_ahead(&mut self, warnings: &mut Warnings) -> Result<bool, LogError> {
        if self.looked {
            return Ok(!self.queue.is_empty());
        }
        self.looked = true;
        let mut inertial = 0;
        while inertial < LOOKED_AT && self.queue.len() < 2 * LOOKED_AT {
            match self.source.next_observation(warnings) {
                Ok(Some(located)) => {
                    inertial += usize::from(specific_force(&located.0).is_some());
                    self.queue.push_back(located);
                }
                Ok(None) => break,
                Err(error) => {
                    self.failure = Some(error);
                    break;
                }
            }
        }
        if let Some(verdict) = self.gravity_verdict(warnings).or_else(|| self.other_verdicts(warnings)) {
            return Err(verdict);
        }
        match self.failure.take_if(|_| self.queue.is_empty()) {
            Some(failure) => Err(failure),
            None => Ok(!self.queue.is_empty()),
        }
    }

    fn gravity_verdict(&self, warnings: &mut Warnings) -> Option<LogError> {
        let observations = || self.queue.iter().map(|(observation, _)| observation);
        let mut forces: Vec<f64> =
            observations().filter(|observation| is_quiet(observation)).filter_map(specific_force).collect();
        if forces.len() < ENOUGH_QUIET {
            forces = observations().filter_map(specific_force).collect();
        }
        let median = median(forces)?;
        let place = Place::new(self.source.file(), self.queue.back()?.1);
        let verdict = match median {
            0.5..=2.0 => "this looks like g, not m/s² (or gravity has been taken out)",
            70.0..=130.0 => "this looks like m/s², not g",
            700.0..=1300.0 => "this looks like mg or cm/s², not m/s²",
            3.0..=40.0 => return None,
            _ => {
                warnings.push(LogWarning::UnlikelyGravity { place, median_mm_s2: thousandths(median) });
                return None;
            }
        };
        Some(LogError::ImplausibleUnit {
            place,
            quantity: "specific force at rest",
            found: format!("a median of {median:.3} m/s² after conversion"),
            expected: "about 9.8 m/s²",
            verdict,
        })
    }

    fn other_verdicts(&self, warnings: &mut Warnings) -> Option<LogError> {
        let pressures = self.median_of(|observation| match observation {
            Observation::Pressure(sample) => Some(sample.pressure_pa),
            _ => None,
        });
        if let Some((median, at)) = pressures.filter(|(median, _)| *median < THINNEST_AIR_PA) {
            return Some(LogError::ImplausibleUnit {
                place: Place::new(self.source.file(), at),
                quantity: "air pressure",
                found: format!("a median of {median:.1} Pa after conversion"),
                expected: "about 100,000 Pa",
                verdict: "this looks like hPa, not Pa",
            });
        }
        let signals = self.median_of(|observation| match observation {
            Observation::Signal(signal) => Some(signal.rssi_dbm),
            _ => None,
        });
        if let Some((median, at)) = signals.filter(|(median, _)| *median > STRONGEST_SIGNAL_DBM) {
            return Some(LogError::ImplausibleUnit {
                place: Place::new(self.source.file(), at),
                quantity: "signal strength",
                found: format!("a median of {median:.1} dBm"),
                expected: "-100 to -30 dBm",
                verdict: "this looks like a signal strength without its sign, or in percent, not dBm",
            });
        }
        let ranges = self.median_of(|observation| match observation {
            Observation::Range(range) => Some(range.range_m),
            _ => None,
        });
        if let Some((median, at)) = ranges.filter(|(median, _)| *median > LONGEST_RANGE_M) {
            let place = Place::new(self.source.file(), at);
            warnings.push(LogWarning::UnlikelyRange { place, median_mm: thousandths(median) });
        }
        None
    }

    /// The median of a quantity over what was read ahead, and where the last of it stands.
    fn median_of(&self, quantity: impl Fn(&Observation) -> Option<f64>) -> Option<(f64, At)> {
        let values = self.queue.iter().filter_map(|(observation, _)| quantity(observation)).collect();
        let last = self.queue.iter().rev().find(|(observation, _)| quantity(observation).is_some());
        Some((median(values)?, last?.1))
    }
}

/// The upper median; `None` of too few.
fn median(mut values: Vec<f64>) -> Option<f64> {
    if values.len() < FEWEST_SAMPLES {
        return None;
    }
    let middle = values.len() / 2;
    let (_, median, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
    Some(*median)
}

#[expect(clippy::cast_possible_truncation, reason = "a float saturates when it becomes an integer")]
fn thousandths(value: f64) -> i64 {
    (value * 1000.0).round() as i64
}

/// Length of the specific force, m/s², where an accelerometer said something.
fn specific_force(observation: &Observation) -> Option<f64> {
    match observation {
        Observation::Imu(sample) => Some(sample.specific_force_m_s2.norm()),
        Observation::Acceleration(sample) => Some(sample.specific_force_m_s2.norm()),
        _ => None,
    }
}

/// The gyro tells that the sensor hardly turns.
fn is_quiet(observation: &Observation) -> bool {
    matches!(observation, Observation::Imu(sample) if sample.angular_rate_rad_s.norm() < QUIET_RATE_RAD_S)
}

impl<S: LogSource> LogSource for UnitChecked<S> {
    fn next_observation(&mut self, warnings: &mut Warnings) -> Result<Option<(Observation, At)>, LogError> {
        if !self.looked {
            self.look_ahead(warnings)?;
        }
        let next = match (self.queue.pop_front(), self.failure.take()) {
            (Some(located), failure) => {
                self.failure = failure;
                Some(located)
            }
            (None, Some(failure)) => return Err(failure),
            (None, None) => self.source.next_observation(warnings)?,
        };
        if let Some((Observation::Imu(sample), at)) = &next {
            let fastest = sample.angular_rate_rad_s.amax();
            if fastest > FASTEST_GYRO_RAD_S {
                return Err(LogError::ImplausibleUnit {
                    place: Place::new(self.source.file(), *at),
                    quantity: "angular rate",
                    found: format!("{fastest:.1} rad/s on one axis"),
                    expected: "at most 75 rad/s",
                    verdict: "this looks like deg/s, not rad/s",
                });
            }
        }
        Ok(next)
    }

    fn file(&self) -> &Arc<Path> {
        self.source.file()
    }
}
