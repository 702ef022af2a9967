//! Readings at even times, as counts, each less the one before it of its axis.

use super::WireError;
use crate::imu::{ImuSample, MagneticSample};
use crate::observation::Observation;
use crate::protobuf;
use crate::protobuf::schema::message;
use adit_core::nalgebra::Vector3;
use adit_core::time::Time;

/// What a count is worth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resolution {
    /// Of the gyro, rad/s.
    pub rate_rad_s: f64,
    /// Of the accelerometer, m/s².
    pub force_m_s2: f64,
    /// Of the magnetometer, µT.
    pub field_ut: f64,
}

/// A tenth of what 16 bits resolve at 2,000 °/s, 16 g and 4,900 µT: below the noise of every sensor that is worn.
impl Default for Resolution {
    fn default() -> Self {
        Self { rate_rad_s: 1e-4, force_m_s2: 5e-4, field_ut: 0.015 }
    }
}

/// Two readings are this far apart at most, ns.
const LONGEST_INTERVAL_NS: u64 = 10_000_000_000;
/// A run of fewer would be longer than the single readings.
const SHORTEST_RUN: usize = 2;
const AXES: usize = 3;

/// Observations of a packet: those that form runs, and the others.
pub(super) struct Runs<'a> {
    pub inertial: Vec<message::InertialRun>,
    pub magnetic: Vec<message::MagneticRun>,
    pub others: Vec<&'a Observation>,
}

impl<'a> Runs<'a> {
    pub fn of(observations: &'a [Observation], resolution: &Resolution) -> Self {
        let mut runs = Self { inertial: Vec::new(), magnetic: Vec::new(), others: Vec::new() };
        let inertial = |o: &&'a Observation| matches!(o, Observation::Imu(_));
        let magnetic = |o: &&'a Observation| matches!(o, Observation::Magnetic(_));
        for run in even(observations.iter().filter(inertial).collect()) {
            match inertial_run(&run, resolution) {
                Some(packed) => runs.inertial.push(packed),
                None => runs.others.extend(run),
            }
        }
        for run in even(observations.iter().filter(magnetic).collect()) {
            match magnetic_run(&run, resolution) {
                Some(packed) => runs.magnetic.push(packed),
                None => runs.others.extend(run),
            }
        }
        runs.others.extend(observations.iter().filter(|o| !inertial(o) && !magnetic(o)));
        runs
    }
}

/// Parts of the readings within each of which all intervals are the same.
fn even(readings: Vec<&Observation>) -> Vec<Vec<&Observation>> {
    let mut parts: Vec<Vec<&Observation>> = Vec::new();
    for reading in readings {
        let fits = parts.last().is_some_and(|part| match part.as_slice() {
            [only] => reading.time() > only.time() && interval_ns(only, reading).is_some(),
            [.., before, last] => interval_ns(last, reading) == interval_ns(before, last),
            [] => true,
        });
        match parts.last_mut().filter(|_| fits) {
            Some(part) => part.push(reading),
            None => parts.push(vec![reading]),
        }
    }
    parts
}

fn interval_ns(from: &Observation, to: &Observation) -> Option<u64> {
    let ns = u64::try_from((to.time() - from.time()).nanos()).ok()?;
    (1..=LONGEST_INTERVAL_NS).contains(&ns).then_some(ns)
}

fn inertial_run(run: &[&Observation], resolution: &Resolution) -> Option<message::InertialRun> {
    let (first, interval_ns) = head(run)?;
    let (mut rate, mut force) = (Counts::default(), Counts::default());
    for observation in run {
        let Observation::Imu(sample) = observation else { return None };
        rate.push(&sample.angular_rate_rad_s, resolution.rate_rad_s)?;
        force.push(&sample.specific_force_m_s2, resolution.force_m_s2)?;
    }
    Some(message::InertialRun {
        first: Some(protobuf::timestamp(first)),
        interval_ns,
        rate_resolution_rad_s: resolution.rate_rad_s,
        force_resolution_m_s2: resolution.force_m_s2,
        rate: rate.differences,
        force: force.differences,
    })
}

fn magnetic_run(run: &[&Observation], resolution: &Resolution) -> Option<message::MagneticRun> {
    let (first, interval_ns) = head(run)?;
    let mut field = Counts::default();
    for observation in run {
        let Observation::Magnetic(sample) = observation else { return None };
        field.push(&sample.field_ut, resolution.field_ut)?;
    }
    Some(message::MagneticRun {
        first: Some(protobuf::timestamp(first)),
        interval_ns,
        resolution_ut: resolution.field_ut,
        field: field.differences,
    })
}

fn head(run: &[&Observation]) -> Option<(Time, u64)> {
    let [first, second, ..] = run else { return None };
    (run.len() >= SHORTEST_RUN).then_some(())?;
    Some((first.time(), interval_ns(first, second)?))
}

/// Counts being written: the last of each axis, and the differences.
#[derive(Default)]
struct Counts {
    last: [i32; AXES],
    differences: Vec<i32>,
}

impl Counts {
    /// `None` when the value has no count.
    fn push(&mut self, value: &Vector3<f64>, resolution: f64) -> Option<()> {
        for (last, value) in self.last.iter_mut().zip(value.iter()) {
            let count = (value / resolution).round();
            // Half of the range, so that no difference overflows.
            if count.is_nan() || count.abs() > f64::from(i32::MAX / 2) {
                return None;
            }
            #[expect(clippy::cast_possible_truncation, reason = "checked to fit")]
            let count = count as i32;
            self.differences.push(count - *last);
            *last = count;
        }
        Some(())
    }
}

pub(super) fn read_inertial(
    run: &message::InertialRun,
    into: &mut Vec<Observation>,
) -> Result<(), WireError> {
    let times = Times::of(run.first, run.interval_ns, run.rate.len(), "inertial run")?;
    if run.force.len() != run.rate.len() {
        return Err(WireError::new("inertial run: counts of force", run.force.len(), "as many as of rate"));
    }
    let mut rates = Values::new(&run.rate, run.rate_resolution_rad_s, "rate_resolution_rad_s")?;
    let mut forces = Values::new(&run.force, run.force_resolution_m_s2, "force_resolution_m_s2")?;
    for index in 0..times.count {
        let (Some(angular_rate_rad_s), Some(specific_force_m_s2)) = (rates.next(), forces.next()) else {
            break;
        };
        let time = times.at(index)?;
        into.push(Observation::Imu(ImuSample { time, angular_rate_rad_s, specific_force_m_s2 }));
    }
    Ok(())
}

pub(super) fn read_magnetic(
    run: &message::MagneticRun,
    into: &mut Vec<Observation>,
) -> Result<(), WireError> {
    let times = Times::of(run.first, run.interval_ns, run.field.len(), "magnetic run")?;
    let mut fields = Values::new(&run.field, run.resolution_ut, "resolution_ut")?;
    for index in 0..times.count {
        let Some(field_ut) = fields.next() else { break };
        into.push(Observation::Magnetic(MagneticSample { time: times.at(index)?, field_ut }));
    }
    Ok(())
}

/// Times of a run.
struct Times {
    first: Time,
    interval_ns: i64,
    count: i64,
}

impl Times {
    fn of(
        first: Option<protobuf::schema::Timestamp>,
        interval_ns: u64,
        counts: usize,
        what: &str,
    ) -> Result<Self, WireError> {
        let first = protobuf::time(first).map_err(|bad| WireError::of(bad, what))?;
        let interval =
            i64::try_from(interval_ns).ok().filter(|_| (1..=LONGEST_INTERVAL_NS).contains(&interval_ns));
        let Some(interval_ns) = interval else {
            return Err(WireError::new(&format!("{what}: interval_ns"), interval_ns, "1 to 10000000000"));
        };
        match i64::try_from(counts / AXES) {
            Ok(count) if counts.is_multiple_of(AXES) => Ok(Self { first, interval_ns, count }),
            _ => Err(WireError::new(&format!("{what}: counts"), counts, "three for each reading")),
        }
    }

    fn at(&self, index: i64) -> Result<Time, WireError> {
        let after = index.checked_mul(self.interval_ns).and_then(|ns| self.first.nanos().checked_add(ns));
        after
            .map(Time::from_nanos)
            .ok_or_else(|| WireError::new("run: time", self.first, "a time within ±292 years"))
    }
}

/// Values of counts being read.
struct Values<'a> {
    differences: std::slice::Iter<'a, i32>,
    last: [i32; AXES],
    resolution: f64,
}

impl<'a> Values<'a> {
    fn new(differences: &'a [i32], resolution: f64, what: &str) -> Result<Self, WireError> {
        if resolution.is_finite() && resolution > 0.0 {
            return Ok(Self { differences: differences.iter(), last: [0; AXES], resolution });
        }
        Err(WireError::new(what, resolution, "a number above 0"))
    }

    fn next(&mut self) -> Option<Vector3<f64>> {
        for last in &mut self.last {
            *last = last.wrapping_add(*self.differences.next()?);
        }
        Some(Vector3::from(self.last).map(|count| f64::from(count) * self.resolution))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use adit_core::time::Interval;

    #[test]
    fn what_is_not_even_is_cut_where_it_is_not() {
        let at = |ms: i64| {
            let time = Time::ZERO + Interval::from_nanos(ms * 1_000_000);
            Observation::Imu(ImuSample {
                time,
                angular_rate_rad_s: Vector3::zeros(),
                specific_force_m_s2: Vector3::z(),
            })
        };
        let log: Vec<_> = [0, 10, 20, 31, 41, 51, 51, 60].map(at).into();
        let lengths: Vec<_> = even(log.iter().collect()).iter().map(Vec::len).collect();
        assert_eq!(lengths, [3, 3, 2]);
    }
}
