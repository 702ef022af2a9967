//! What a tag sends, whom it hears and how well that fits: for whoever asks why a position is where it is.
//!
//! Fixed in size: at most [`MOST_SOURCES`] sources of 40 bytes, and once there are innovations [`BINS`] bins of 8 bytes; that is 0.5 to 1.3 kB a tag,
//! with some 8 anchors 1.0 kB, 10 MB for 10,000 tags. Nothing is allocated for an observation once its source is known. It is part of the snapshot.

use adit_core::time::Time;
use adit_estimation::weighed::{SourceWeighed, Weighed, WeighedKind};
use adit_observation::{DeviceId, Observation, ObservationKind};
use serde::{Deserialize, Serialize};

/// Length of a bin, s.
pub const BIN_S: i64 = 10;
/// Bins of innovations that are kept: ten minutes.
pub const BINS: usize = 60;
/// Sources that are remembered; then the one heard longest ago is forgotten.
const MOST_SOURCES: usize = 16;
/// A source that was not heard for longer is not told, s.
const HEARD_S: f64 = 60.0;
/// Rates are not told of less than this, s.
const LEAST_S: f64 = 1.0;
const NANOS_PER_BIN: i64 = BIN_S * 1_000_000_000;
/// Kinds of observations.
const KINDS: [ObservationKind; 8] = [
    ObservationKind::Imu,
    ObservationKind::Acceleration,
    ObservationKind::Magnetic,
    ObservationKind::Pressure,
    ObservationKind::Fix,
    ObservationKind::Signal,
    ObservationKind::Range,
    ObservationKind::Sighting,
];

/// Of one tag.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Hearing {
    /// The newest time of an observation.
    newest: Option<Time>,
    /// From when on the two newest bins count.
    since: Option<Time>,
    /// Observations by kind in the newest bin and in the one before.
    counts: [[u16; KINDS.len()]; 2],
    sources: Vec<Source>,
    /// The bin of each instant stands at its number modulo [`BINS`]; none before the first innovation.
    course: Vec<Bin>,
    /// Number of the newest bin of the course.
    last_bin: i64,
    /// What the method's sums were when they were looked at last.
    before: Sums,
}

/// What a source said last.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Source {
    /// Its name as the tag has it.
    pub id: DeviceId,
    /// A range or a signal strength.
    pub kind: WeighedKind,
    /// When, by the server's clock.
    pub time: Time,
    /// m or dBm.
    pub value: f32,
    /// Probability that the signal came straight, 0 to 1, where something has judged it.
    pub line_of_sight: Option<f32>,
}

/// Innovations of ten seconds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
struct Bin {
    /// Sum of the normalised innovations squared of what counted in full.
    sum: f32,
    /// Its degrees of freedom.
    freedom: u16,
    /// What did not count in full.
    outliers: u16,
}

/// What a method has weighed since its start.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Sums {
    /// Of normalised innovations squared.
    pub nis: f64,
    /// Degrees of freedom of that sum.
    pub freedom: u64,
    /// Measurements that did not count in full.
    pub outliers: u64,
}

/// A kind of observations that a tag sends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Rate {
    /// Which.
    pub kind: ObservationKind,
    /// How many a second in the last 10 to 20 s.
    pub per_s: f64,
}

/// Innovations of a bin.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct NisBin {
    /// Mean of the normalised innovations squared for each degree of freedom; 1 is expected of a method that knows its errors.
    pub mean: Option<f64>,
    /// Degrees of freedom.
    pub count: u64,
    /// Measurements that did not count in full.
    pub outliers: u64,
}

/// What is told of it.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct HearingReport {
    /// What the tag sends.
    pub sensors: Vec<Rate>,
    /// Who was heard in its last minute, in order of their names, and what the method made of it.
    pub sources: Vec<(Source, Option<Weighed>)>,
    /// End of the newest bin.
    pub until: Option<Time>,
    /// Bins of `BIN_S`, oldest first: `BINS`, or none where nothing was ever weighed.
    pub course: Vec<NisBin>,
}

impl Hearing {
    /// An observation, at the server's time.
    #[inline]
    pub fn hear(&mut self, observation: &Observation, time: Time) {
        self.count(observation.kind(), time);
        let (id, kind, value, line_of_sight) = match observation {
            Observation::Range(range) => {
                (&range.anchor, WeighedKind::Range, range.range_m, range.line_of_sight)
            }
            Observation::Signal(signal) => (&signal.transmitter, WeighedKind::Signal, signal.rssi_dbm, None),
            _ => return,
        };
        #[expect(clippy::cast_possible_truncation, reason = "a page shows centimetres and percents")]
        let (value, line_of_sight) = (value as f32, line_of_sight.map(|p| p as f32));
        let full = self.sources.len() >= MOST_SOURCES;
        if let Some(known) = self.sources.iter_mut().find(|known| known.kind == kind && known.id == *id) {
            if time >= known.time {
                (known.time, known.value, known.line_of_sight) = (time, value, line_of_sight);
            }
            return;
        }
        let new = Source { id: id.clone(), kind, time, value, line_of_sight };
        if let Some(oldest) = self.sources.iter_mut().min_by_key(|known| known.time).filter(|_| full) {
            *oldest = new;
        } else {
            self.sources.push(new);
        }
    }

    #[inline]
    fn count(&mut self, kind: ObservationKind, time: Time) {
        let bin = bin_of(time);
        let newest = self.newest.map(bin_of);
        match newest {
            Some(newest) if bin <= newest => {}
            Some(newest) if bin == newest + 1 => {
                // What counts begins with the bin before, or later where the tag came in it.
                self.since = self.since.max(Some(Time::from_nanos(newest * NANOS_PER_BIN)));
                self.counts = [[0; KINDS.len()], self.counts[0]];
            }
            _ => {
                self.since = Some(time);
                self.counts = [[0; KINDS.len()]; 2];
            }
        }
        let back = newest.map_or(0, |newest| newest.max(bin) - bin);
        self.newest = self.newest.max(Some(time));
        if let (Some(counts), Some(index)) = (
            usize::try_from(back).ok().and_then(|back| self.counts.get_mut(back)),
            KINDS.iter().position(|known| *known == kind),
        ) {
            counts[index] = counts[index].saturating_add(1);
        }
    }

    /// What the method has weighed until now: what is new in it counts for this time.
    pub fn weigh(&mut self, sums: Sums) {
        let Some(time) = self.newest else { return };
        let before = std::mem::replace(&mut self.before, sums);
        // A method that began anew counts from nothing.
        let before = if sums.freedom < before.freedom || sums.outliers < before.outliers {
            Sums::default()
        } else {
            before
        };
        let (freedom, outliers) = (sums.freedom - before.freedom, sums.outliers - before.outliers);
        if freedom == 0 && outliers == 0 {
            return;
        }
        if self.course.is_empty() {
            self.course = vec![Bin::default(); BINS];
            self.last_bin = bin_of(time);
        }
        self.advance(bin_of(time));
        let bin = &mut self.course[slot(self.last_bin)];
        #[expect(clippy::cast_possible_truncation, reason = "a mean of ten seconds needs no more digits")]
        let nis = (sums.nis - before.nis) as f32;
        bin.sum += nis;
        bin.freedom = bin.freedom.saturating_add(u16::try_from(freedom).unwrap_or(u16::MAX));
        bin.outliers = bin.outliers.saturating_add(u16::try_from(outliers).unwrap_or(u16::MAX));
    }

    /// The newest bin is this one; those passed over are empty.
    fn advance(&mut self, to: i64) {
        let passed = usize::try_from(to - self.last_bin).unwrap_or(0).min(BINS);
        for step in 0..passed {
            self.course[slot(to - i64::try_from(step).unwrap_or_default())] = Bin::default();
        }
        self.last_bin = self.last_bin.max(to);
    }

    /// What is told, with what the method weighed last of each source.
    pub fn told(&self, weighed: &[SourceWeighed]) -> HearingReport {
        let Some(newest) = self.newest else { return HearingReport::default() };
        let since = self.since.unwrap_or(newest);
        let seconds = (newest - since).seconds().max(LEAST_S);
        let sum = |index: usize| u32::from(self.counts[0][index]) + u32::from(self.counts[1][index]);
        let sensors = KINDS.iter().enumerate().map(|(index, kind)| (kind, sum(index)));
        let sensors = sensors.filter(|(_, count)| *count > 0);
        let sensors =
            sensors.map(|(kind, count)| Rate { kind: *kind, per_s: f64::from(count) / seconds }).collect();
        let made_of = |source: &Source| {
            let same = |known: &&SourceWeighed| {
                known.last.kind == source.kind && known.names.iter().any(|name| name == source.id.as_str())
            };
            weighed.iter().find(same).map(|known| known.last)
        };
        let lately = |source: &&Source| (newest - source.time).seconds() <= HEARD_S;
        let mut sources: Vec<_> =
            self.sources.iter().filter(lately).map(|source| (source.clone(), made_of(source))).collect();
        sources.sort_by(|(a, _), (b, _)| a.id.cmp(&b.id));
        let mut now = self.clone();
        let mut course = Vec::new();
        if !now.course.is_empty() {
            now.advance(bin_of(newest));
            let bins = (0..BINS).rev().map(|back| now.last_bin - i64::try_from(back).unwrap_or_default());
            course.extend(bins.map(|number| now.course[slot(number)].told()));
        }
        let until = (!course.is_empty()).then(|| Time::from_nanos((now.last_bin + 1) * NANOS_PER_BIN));
        HearingReport { sensors, sources, until, course }
    }
}

impl Bin {
    fn told(self) -> NisBin {
        let mean = (self.freedom > 0).then(|| f64::from(self.sum) / f64::from(self.freedom));
        NisBin { mean, count: self.freedom.into(), outliers: self.outliers.into() }
    }
}

fn bin_of(time: Time) -> i64 {
    time.nanos().div_euclid(NANOS_PER_BIN)
}

fn slot(bin: i64) -> usize {
    let bins = i64::try_from(BINS).unwrap_or(i64::MAX);
    usize::try_from(bin.rem_euclid(bins)).unwrap_or_default()
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use adit_core::nalgebra::Vector3;
    use adit_observation::{AccelerationSample, Radio, SignalStrength};

    #[expect(clippy::cast_possible_truncation, reason = "tests: some thousand seconds")]
    fn at(seconds: f64) -> Time {
        Time::from_nanos(1_795_000_000_000_000_000 + (seconds * 1e9) as i64)
    }

    fn felt(seconds: f64) -> Observation {
        let specific_force_m_s2 = Vector3::new(0.0, 0.0, 9.8);
        Observation::Acceleration(AccelerationSample { time: at(seconds), specific_force_m_s2 })
    }

    fn signal(name: &str, seconds: f64, rssi_dbm: f64) -> Observation {
        let transmitter = DeviceId::new(name).unwrap();
        Observation::Signal(SignalStrength { time: at(seconds), transmitter, rssi_dbm, radio: Radio::Wifi })
    }

    fn take(hearing: &mut Hearing, observation: &Observation) {
        hearing.hear(observation, observation.time());
    }

    #[test]
    fn rates_are_those_of_the_last_seconds_whenever_the_tag_began() {
        for begin in [0.0, 3.7, 9.9] {
            let mut hearing = Hearing::default();
            for sample in 0..3000 {
                take(&mut hearing, &felt(begin + 0.02 * f64::from(sample)));
                let told = hearing.told(&[]).sensors;
                // Over a second or more a sample at either end is 2 % of 50 Hz, and less later.
                let tolerance = 50.0 / f64::from(sample.max(50)) + 0.05;
                if sample >= 50 {
                    assert!((told[0].per_s - 50.0).abs() <= tolerance + 1.0, "{sample}: {told:?}");
                }
            }
            // Silence, then half as fast: nothing of before counts.
            for sample in 0..200 {
                take(&mut hearing, &felt(begin + 100.0 + 0.04 * f64::from(sample)));
            }
            assert!((hearing.told(&[]).sensors[0].per_s - 25.0).abs() < 0.5);
        }
    }

    #[test]
    fn the_last_of_each_source_of_a_minute_is_told() {
        let mut hearing = Hearing::default();
        for second in 0..20 {
            take(&mut hearing, &signal("w1", f64::from(second), -60.0 - f64::from(second)));
        }
        take(&mut hearing, &signal("w2", 80.0, -50.0));
        take(&mut hearing, &signal("w2", 79.0, -90.0));
        let told = hearing.told(&[]);
        let names: Vec<_> = told.sources.iter().map(|(source, _)| source.id.as_str()).collect();
        assert_eq!(names, ["w2"], "w1 has been silent for 61 s");
        assert!((told.sources[0].0.value + 50.0).abs() < 1e-6, "what came late is not the last");
        for source in 0..40 {
            take(&mut hearing, &signal(&format!("x{source}"), 81.0 + f64::from(source), -50.0));
        }
        assert_eq!(hearing.sources.len(), MOST_SOURCES);
        assert!(hearing.told(&[]).sources.iter().any(|(source, _)| source.id.as_str() == "x39"));
    }

    #[test]
    fn ten_minutes_of_innovations_stay_and_a_method_that_begins_anew_counts_from_nothing() {
        let mut hearing = Hearing::default();
        let mut sums = Sums::default();
        for second in 0..1200 {
            take(&mut hearing, &felt(f64::from(second)));
            sums.nis += if second < 900 { 4.0 } else { 2.0 };
            sums.freedom += 2;
            sums.outliers += u64::from(second % 100 == 0);
            hearing.weigh(sums);
        }
        let course = hearing.told(&[]).course;
        assert_eq!(course.len(), BINS);
        let (old, new) = (course[5], course[55]);
        assert_eq!((old.mean, new.mean, new.count), (Some(2.0), Some(1.0), 20));
        assert_eq!(course.iter().map(|bin| bin.outliers).sum::<u64>(), 6);
        let fresh = Sums { nis: 3.0, freedom: 3, outliers: 0 };
        take(&mut hearing, &felt(1210.0));
        hearing.weigh(fresh);
        let course = hearing.told(&[]).course;
        assert_eq!((course[59].count, course[59].mean), (3, Some(1.0)));
        // Five minutes without anything weighed are empty, and what was before is still there.
        take(&mut hearing, &felt(1510.0));
        let course = hearing.told(&[]).course;
        assert_eq!((course[59].count, course[40].mean, course[29].count), (0, None, 3));
        assert!(course[0].mean.is_some());
        // An hour later nothing is left.
        take(&mut hearing, &felt(5000.0));
        assert!(hearing.told(&[]).course.iter().all(|bin| bin.count == 0));
    }

    #[test]
    fn it_takes_a_kilobyte_and_comes_back_from_a_snapshot_as_it_was() {
        let mut hearing = Hearing::default();
        for second in 0..100_i32 {
            take(&mut hearing, &signal(&format!("x{}", second % 30), f64::from(second), -50.0));
            hearing.weigh(Sums {
                nis: f64::from(second),
                freedom: 1 + u64::from(second.unsigned_abs()),
                outliers: 0,
            });
        }
        let bytes = size_of::<Hearing>()
            + hearing.sources.capacity() * size_of::<Source>()
            + hearing.course.capacity() * size_of::<Bin>();
        println!("{bytes} bytes at most, {} of them inline", size_of::<Hearing>());
        assert!(bytes <= 1300, "{bytes} bytes");
        let kept = rmp_serde::to_vec_named(&hearing).unwrap();
        let back: Hearing = rmp_serde::from_slice(&kept).unwrap();
        assert_eq!(back, hearing);
    }
}
