//! The account of what was sent and what came of it.

use super::walks::FIRST_NUMBER;
use crate::args::LoadArgs;
use hdrhistogram::Histogram;
use serde::Serialize;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// What was sent and what came of it, as it goes.
#[derive(Default)]
pub struct Account(Mutex<Books>);

#[derive(Default)]
struct Books {
    batches: u64,
    failed: u64,
    bytes: u64,
    observations: u64,
    packets: u64,
    /// Seconds of which the packets of tags were acknowledged, by the first of the tags.
    acknowledged: BTreeMap<u32, (Range<u32>, Vec<u32>)>,
    /// When the last packet of a tag was sent, until a position follows it.
    handed: Vec<Option<Instant>>,
    acknowledgements: Times,
    positions: Times,
    viewer_losses: u64,
}

/// How long things took.
struct Times(Option<Histogram<u64>>);

impl Default for Times {
    fn default() -> Self {
        // µs, to three digits; it grows by itself.
        Self(Histogram::new(3).ok())
    }
}

impl Times {
    fn add(&mut self, time: Duration) {
        if let Some(times) = &mut self.0 {
            // It grows to what is recorded: nothing is too long.
            let _ = times.record(u64::try_from(time.as_micros()).unwrap_or(u64::MAX));
        }
    }

    fn summary(&self) -> Summary {
        let Some(times) = &self.0 else { return Summary::default() };
        let ms = |quantile: f64| times.value_at_quantile(quantile) as f64 / 1e3;
        Summary { count: times.len(), p50_ms: ms(0.5), p90_ms: ms(0.9), p99_ms: ms(0.99), max_ms: ms(1.0) }
    }
}

impl Account {
    fn books(&self) -> MutexGuard<'_, Books> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A batch is on its way.
    pub fn sent(&self, tags: &Range<u32>, handed: Instant, bytes: usize, observations: u64) {
        let mut books = self.books();
        books.batches += 1;
        books.bytes += bytes as u64;
        books.observations += observations;
        if books.handed.len() < tags.end as usize {
            books.handed.resize(tags.end as usize, None);
        }
        books.handed[tags.start as usize..tags.end as usize].fill(Some(handed));
    }

    /// A batch did not get through; it is sent again.
    pub fn failed(&self) {
        self.books().failed += 1;
    }

    /// A batch was acknowledged: from now on the server answers for it.
    pub fn acknowledged(&self, tags: &Range<u32>, second: u32, after: Duration) {
        let mut books = self.books();
        books.packets += u64::from(tags.end - tags.start);
        books.acknowledgements.add(after);
        books.acknowledged.entry(tags.start).or_insert_with(|| (tags.clone(), Vec::new())).1.push(second);
    }

    /// A tag moved: how long after its last packet was sent, once for each packet. Beyond a second this tells nothing: the next packet is on its
    /// way then.
    pub fn moved(&self, tag: &str, arrived: Instant) {
        let mut books = self.books();
        let number = tag.strip_prefix('T').and_then(|digits| digits.parse::<usize>().ok());
        let handed = number.and_then(|number| books.handed.get_mut(number)).and_then(Option::take);
        if let Some(handed) = handed {
            books.positions.add(arrived.saturating_duration_since(handed));
        }
    }

    /// The viewer was cut off, or did not get through.
    pub fn viewer_lost(&self) {
        self.books().viewer_losses += 1;
    }
}

/// What came of a load.
#[derive(Debug, Serialize)]
pub struct LoadReport {
    tags: u32,
    seconds: u32,
    batches: u64,
    /// Tries of a batch that failed; each was sent again.
    failed_tries: u64,
    /// Packets acknowledged: one of each tag each second, if all went well.
    packets: u64,
    /// Packets acknowledged of which the server knows nothing.
    pub lost_packets: u64,
    observations_per_s: f64,
    bytes_per_s: f64,
    /// From the sending of a batch to its acknowledgement.
    acknowledgement: Summary,
    /// From the sending of a tag's packet to a position of it at the viewer.
    position: Summary,
    /// How often the viewer was cut off or did not get through.
    viewer_losses: u64,
}

/// How long something took.
#[derive(Debug, Default, Serialize)]
struct Summary {
    count: u64,
    p50_ms: f64,
    p90_ms: f64,
    p99_ms: f64,
    max_ms: f64,
}

impl LoadReport {
    /// With the packets that came, as the server tells.
    pub fn new(args: &LoadArgs, account: &Account, came: &BTreeMap<String, Vec<[u64; 2]>>) -> Self {
        let books = account.books();
        let none = Vec::new();
        let mut lost_packets = 0;
        for (tags, seconds) in books.acknowledged.values() {
            for tag in tags.clone() {
                let spans = came.get(&format!("T{tag:06}")).unwrap_or(&none);
                let has = |number: u64| spans.iter().any(|[first, last]| (*first..=*last).contains(&number));
                let lost = seconds.iter().filter(|second| !has(FIRST_NUMBER + u64::from(**second)));
                lost_packets += lost.count() as u64;
            }
        }
        Self {
            tags: args.tags,
            seconds: args.seconds,
            batches: books.batches,
            failed_tries: books.failed,
            packets: books.packets,
            lost_packets,
            observations_per_s: books.observations as f64 / f64::from(args.seconds),
            bytes_per_s: books.bytes as f64 / f64::from(args.seconds),
            acknowledgement: books.acknowledgements.summary(),
            position: books.positions.summary(),
            viewer_losses: books.viewer_losses,
        }
    }

    /// For eyes.
    pub fn summary(&self) -> String {
        let line = |name: &str, value: String| format!("{name:<18}{value}\n");
        let times = |times: &Summary| {
            let Summary { count, p50_ms, p90_ms, p99_ms, max_ms } = times;
            format!(
                "{count} times, 50 % within {p50_ms:.0} ms, 90 % {p90_ms:.0}, 99 % {p99_ms:.0}, all {max_ms:.0}"
            )
        };
        let expected = u64::from(self.tags) * u64::from(self.seconds);
        line("load", format!("{} tags for {} s", self.tags, self.seconds))
            + &line(
                "sent",
                format!(
                    "{} batches, {:.0} observations/s, {:.2} MB/s; {} tries failed",
                    self.batches,
                    self.observations_per_s,
                    self.bytes_per_s / 1e6,
                    self.failed_tries
                ),
            )
            + &line("acknowledged", format!("{} of {expected} packets", self.packets))
            + &line("lost", format!("{} packets", self.lost_packets))
            + &line("acknowledgement", times(&self.acknowledgement))
            + &line("position", times(&self.position))
            + &line("viewer", format!("cut off {} times", self.viewer_losses))
    }
}
