//! Signal strengths of a log, gathered into scans and averaged: what a position is made of.
//!
//! A receiver tells of one transmitter after the other. What comes within [`ScanParams::scan_s`] after a first signal is one scan; several
//! scans make one [`Scan`] with the mean strength of every transmitter that was heard in any of them, in dBm, and the mean time of all readings. System
//! S1 (Lu, Zhao & Xu) averages three consecutive scans for each report and reports every 5 or 10 s. No reading is used twice, so that the noise
//! of one report is not that of the next. Radios are gathered each for itself: Wi-Fi scans, BLE drips.
//!
//! **Order.** A log passes on what came late, at its place ([`adit_observation::order`]). A scan stays open for `scan_s` by the clock
//! (the newest time of anything in the log), takes what belongs to it and is then closed; what is older than the last report is counted and left.
//! Memory: [`MOST_TRANSMITTERS`] in each of a few open scans.

use crate::settings::{first_unusable, not_negative, positive};
use adit_core::time::{Interval, Time};
use adit_observation::{DeviceId, Radio, SignalStrength};
use alloc::collections::VecDeque;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// Transmitters in a scan; further ones are left out and counted.
pub const MOST_TRANSMITTERS: usize = 256;
/// Scans averaged, at most.
const MOST_AVERAGED: usize = 64;

/// How signals are gathered.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ScanParams {
    /// What comes within this after the first signal is one scan, s; it waits as long for what is late.
    pub scan_s: f64,
    /// Scans averaged into one report.
    pub averaged: usize,
    /// From one report to the next, at least, s (to half a scan); 0: as soon as there are enough scans.
    pub every_s: f64,
    /// A report does not wait longer than this for further scans, s.
    pub longest_s: f64,
}

impl Default for ScanParams {
    fn default() -> Self {
        Self { scan_s: 0.5, averaged: 3, every_s: 0.0, longest_s: 5.0 }
    }
}

impl ScanParams {
    /// The first setting that cannot be worked with, by name.
    pub(crate) fn unusable(&self) -> Option<&'static str> {
        first_unusable(&[
            ("scan.scan_s", positive(self.scan_s) && self.scan_s <= 60.0),
            ("scan.averaged", (1..=MOST_AVERAGED).contains(&self.averaged)),
            ("scan.every_s", not_negative(self.every_s)),
            ("scan.longest_s", positive(self.longest_s) && self.longest_s >= self.scan_s),
        ])
    }
}

/// Several scans of one radio, averaged.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scan {
    /// Mean time of all readings.
    pub time: Time,
    /// From the first reading to the last, s.
    pub length_s: f64,
    /// Of which radio.
    pub radio: Radio,
    /// What was heard, by name of the transmitter.
    pub heard: Vec<HeardMean>,
}

/// Mean strength of one transmitter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HeardMean {
    /// The transmitter.
    pub transmitter: DeviceId,
    /// Mean of its readings, dBm.
    pub rssi_dbm: f64,
    /// How many.
    pub readings: u32,
}

/// Gathers the signals of a log, streaming.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scanner {
    params: ScanParams,
    now: Option<Time>,
    /// One for each radio, in order of [`Radio::ALL`].
    radios: [Gathering; Radio::ALL.len()],
    late: u64,
    left_out: u64,
}

/// The open scans of one radio.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
struct Gathering {
    /// In order of time.
    open: VecDeque<Single>,
    /// First time of the newest scan that was reported.
    reported: Option<Time>,
}

/// One scan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Single {
    first: Time,
    last: Time,
    /// By name: sum of strengths, sum of times after `first` (before it where they came out of order), their number.
    sums: Vec<(DeviceId, Sums)>,
}

#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Sums {
    strength_dbm: f64,
    time_ns: i64,
    readings: u32,
}

impl Scanner {
    /// Nothing heard yet; settings must be usable.
    pub(crate) fn new(params: ScanParams) -> Self {
        Self { params, now: None, radios: Default::default(), late: 0, left_out: 0 }
    }

    /// Signals that came after the report that they belong to.
    pub fn late(&self) -> u64 {
        self.late
    }

    /// Signals of more transmitters than a scan holds.
    pub fn left_out(&self) -> u64 {
        self.left_out
    }

    /// Drops what was not reported.
    pub(crate) fn clear(&mut self) {
        self.radios = Default::default();
    }

    /// Takes a signal.
    pub fn observe(&mut self, signal: &SignalStrength) {
        if signal.fault().is_some() {
            return;
        }
        let length = Interval::from_seconds(self.params.scan_s).unwrap_or_default();
        let gathering = &mut self.radios[signal.radio as usize];
        match gathering.place(signal.time, length, self.params.averaged + 2) {
            Some(single) => self.left_out += u64::from(!single.add(signal)),
            None => self.late += 1,
        }
        self.now = self.now.max(Some(signal.time));
    }

    /// Time has come to `now`; it does not go back.
    pub fn advance(&mut self, now: Time) {
        self.now = self.now.max(Some(now));
    }

    /// The next report that is due, if any.
    pub fn pop(&mut self) -> Option<Scan> {
        let now = self.now?;
        let params = self.params;
        self.radios.iter_mut().zip(Radio::ALL).find_map(|(radio, kind)| radio.due(now, &params, kind))
    }

    /// After the last observation: what is left, one report after the other.
    pub fn finish(&mut self) -> Option<Scan> {
        let most = self.params.averaged;
        self.radios.iter_mut().zip(Radio::ALL).find_map(|(radio, kind)| radio.take(usize::MAX, most, kind))
    }
}

impl Gathering {
    /// The scan that a signal of this time belongs to, made where there is none; `None` where it has been reported.
    fn place(&mut self, time: Time, length: Interval, most: usize) -> Option<&mut Single> {
        if self.reported.is_some_and(|first| time - first < length) {
            return None;
        }
        let fits = |single: &Single| {
            (time >= single.first && time - single.first < length)
                || (time < single.first && single.last - time < length)
        };
        let known = self.open.iter().position(fits);
        if known.is_none() && self.open.len() >= most {
            // Nobody asks for reports: the oldest goes.
            self.open.pop_front();
        }
        let index = known.unwrap_or_else(|| self.open.partition_point(|single| single.first < time));
        if known.is_none() {
            self.open.insert(index, Single { first: time, last: time, sums: Vec::new() });
        }
        self.open.get_mut(index)
    }

    fn due(&mut self, now: Time, params: &ScanParams, radio: Radio) -> Option<Scan> {
        while let Some(oldest) = self.open.front() {
            let waited_s = (now - oldest.first).seconds();
            let closed = self.open.iter().take_while(|one| (now - one.first).seconds() >= params.scan_s);
            let closed = closed.count();
            let newest = self.open.get(closed.checked_sub(1)?)?.first;
            let ready = self
                .reported
                .is_none_or(|before| (newest - before).seconds() >= params.every_s - 0.5 * params.scan_s);
            if ready && (closed >= params.averaged || waited_s >= params.longest_s) {
                return self.take(closed, params.averaged, radio);
            }
            if closed <= params.averaged && waited_s < params.longest_s {
                return None;
            }
            self.open.pop_front();
        }
        None
    }

    /// The newest `averaged` of the oldest `closed` scans as one; `None` of none.
    fn take(&mut self, closed: usize, averaged: usize, radio: Radio) -> Option<Scan> {
        let closed = closed.min(self.open.len());
        self.reported = self.open.get(closed.checked_sub(1)?)?.first.into();
        let skipped = closed.saturating_sub(averaged);
        self.open.drain(..skipped);
        let first = self.open.front()?.first;
        let (mut last, mut all) = (first, Vec::new());
        for single in self.open.drain(..closed - skipped) {
            last = last.max(single.last);
            let offset_ns = (single.first - first).nanos();
            for (transmitter, sums) in single.sums {
                let later = offset_ns.saturating_mul(i64::from(sums.readings));
                let sums = Sums { time_ns: sums.time_ns.saturating_add(later), ..sums };
                entry(&mut all, &transmitter, usize::MAX)?.add(&sums);
            }
        }
        let total = all.iter().fold(Sums::default(), |mut total, (_, sums)| {
            total.add(sums);
            total
        });
        let mean_ns = total.time_ns / i64::from(total.readings.max(1));
        let heard = all.into_iter().map(|(transmitter, sums)| HeardMean {
            transmitter,
            rssi_dbm: sums.strength_dbm / f64::from(sums.readings),
            readings: sums.readings,
        });
        Some(Scan {
            time: first + Interval::from_nanos(mean_ns),
            length_s: (last - first).seconds(),
            radio,
            heard: heard.collect(),
        })
    }
}

impl Single {
    /// Takes a signal; false where there is no room for its transmitter.
    fn add(&mut self, signal: &SignalStrength) -> bool {
        let Some(sums) = entry(&mut self.sums, &signal.transmitter, MOST_TRANSMITTERS) else { return false };
        let time_ns = (signal.time - self.first).nanos();
        sums.add(&Sums { strength_dbm: signal.rssi_dbm, time_ns, readings: 1 });
        self.last = self.last.max(signal.time);
        true
    }
}

impl Sums {
    fn add(&mut self, other: &Self) {
        self.strength_dbm += other.strength_dbm;
        self.time_ns = self.time_ns.saturating_add(other.time_ns);
        self.readings = self.readings.saturating_add(other.readings);
    }
}

/// The sums of a transmitter, made where there are none and room is.
fn entry<'a>(all: &'a mut Vec<(DeviceId, Sums)>, name: &DeviceId, most: usize) -> Option<&'a mut Sums> {
    let index = match all.binary_search_by(|(known, _)| known.cmp(name)) {
        Ok(index) => index,
        Err(_) if all.len() >= most => return None,
        Err(index) => {
            all.insert(index, (name.clone(), Sums::default()));
            index
        }
    };
    all.get_mut(index).map(|(_, sums)| sums)
}
