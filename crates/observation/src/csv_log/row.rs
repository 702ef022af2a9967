//! One row of a log of one kind, as text: the columns of [`super::Sensors::header`].

use crate::device::DeviceId;
use crate::files::decimal::ShortSeconds;
use crate::fix::{HeightFix, PositionFix};
use crate::observation::Observation;
use crate::radio::{RangeSample, Reception};
use std::fmt::{self, Display};
use std::io::{self, Write};

/// A value, or the empty field of one that is not told.
struct Told<T>(Option<T>);

impl<T: Display> Display for Told<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.as_ref().map_or(Ok(()), |value| value.fmt(f))
    }
}

/// The name of a device that no field can hold: fields end at a comma, and there are no quotes.
pub(super) fn unwritable_name(observation: &Observation) -> Option<&DeviceId> {
    let names = match observation {
        Observation::Signal(signal) => [Some(&signal.transmitter), None],
        Observation::Range(range) => [Some(&range.anchor), range.tag.as_ref()],
        Observation::Sighting(sighting) => [Some(&sighting.reader), None],
        _ => [None, None],
    };
    names.into_iter().flatten().find(|name| name.as_str().contains(','))
}

/// Writes the row of anything but inertial and magnetic samples, which share rows.
pub(super) fn write(file: &mut impl Write, observation: &Observation) -> io::Result<()> {
    let time = ShortSeconds(observation.time());
    match observation {
        Observation::Imu(_) | Observation::Acceleration(_) | Observation::Magnetic(_) => Ok(()),
        Observation::Pressure(sample) => writeln!(file, "{time},{}", sample.pressure_pa),
        Observation::Fix(fix) => write_fix(file, time, fix),
        Observation::Signal(signal) => {
            writeln!(file, "{time},{},{},{}", signal.transmitter, signal.rssi_dbm, signal.radio.name())
        }
        Observation::Range(range) => write_range(file, time, range),
        Observation::Sighting(sighting) => writeln!(file, "{time},{}", sighting.reader),
    }
}

fn write_fix(file: &mut impl Write, time: ShortSeconds, fix: &PositionFix) -> io::Result<()> {
    let PositionFix { level_m, covariance_m2: p, height, source, .. } = fix;
    let (ee, en, nn) = (p[(0, 0)], p[(0, 1)], p[(1, 1)]);
    write!(file, "{time},{},{},{ee},{en},{nn},", level_m.x, level_m.y)?;
    let (up_m, sigma_m) = height.map(|HeightFix { up_m, sigma_m }| (up_m, sigma_m)).unzip();
    writeln!(file, "{},{},{}", Told(up_m), Told(sigma_m), source.name())
}

fn write_range(file: &mut impl Write, time: ShortSeconds, range: &RangeSample) -> io::Result<()> {
    let RangeSample { anchor, tag, range_m, sigma_m, line_of_sight, radio, reception, .. } = range;
    let (tag, sigma_m, line_of_sight) = (Told(tag.as_ref()), Told(*sigma_m), Told(*line_of_sight));
    write!(file, "{time},{anchor},{tag},{range_m},{sigma_m},{line_of_sight},{}", radio.name())?;
    let none = Reception::default();
    let reception = reception.as_deref().unwrap_or(&none);
    let [first, second, third] = reception.first_path_amplitudes.map_or([None; 3], |a| a.map(Some));
    for value in [
        reception.rx_power_dbm,
        reception.first_path_power_dbm,
        reception.first_path_index_tap,
        reception.peak_index_tap,
        first,
        second,
        third,
        reception.noise_std,
        reception.noise_max,
    ] {
        write!(file, ",{}", Told(value))?;
    }
    writeln!(file, ",{}", Told(reception.preamble_count))
}
