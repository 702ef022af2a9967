//! Every method on the same scans.

use super::data::{DataKind, RadioData, RadioFile};
use super::judge::Judged;
use adit_core::nalgebra::Vector2;
use adit_core::time::Time;
use adit_estimation::radio::walk::{Walk, WalkParams, smooth};
use adit_estimation::radio::{MapParams, PlaceFix, RadioMap, Reading};
use rayon::prelude::*;

/// A walk is judged this often, s.
const EPOCH_S: f64 = 0.5;
/// Methods without memory get the medians of this long, s.
const WINDOW_S: f64 = 3.0;

/// What a method looks at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Uses {
    /// Signal strengths.
    Strengths,
    /// Ranges.
    Ranges,
}

/// A method without memory: readings to a fix.
type FixOf<'a> = Box<dyn Fn(&[Reading]) -> Option<PlaceFix> + Send + Sync + 'a>;

/// A method.
pub struct Contestant<'a> {
    /// Its name in reports.
    pub name: &'static str,
    /// What it looks at.
    pub uses: Uses,
    /// How it works.
    pub fix: FixOf<'a>,
}

/// A method that follows a walk over a map.
pub struct Follower<'a> {
    /// Its name in reports.
    pub name: &'static str,
    /// The map.
    pub map: &'a RadioMap,
    /// Forwards and backwards over the whole walk, or online.
    pub smoothed: bool,
}

/// A scan and where it was made.
struct Asked {
    readings: Vec<Reading>,
    truth_m: Vector2<f64>,
    floor: i32,
}

/// Every contestant and follower on a test, in their order.
pub fn run(test: &RadioData, contestants: &[Contestant<'_>], followers: &[Follower<'_>]) -> Vec<Judged> {
    let mut judged = Vec::new();
    for contestant in contestants {
        let asked = match (test.kind, contestant.uses) {
            (DataKind::Walks, Uses::Strengths) => test.files.iter().flat_map(windows).collect(),
            (DataKind::Walks, Uses::Ranges) => Vec::new(),
            (DataKind::Surveys, Uses::Strengths) => scans(&test.strengths()),
            (DataKind::Surveys, Uses::Ranges) => scans(&test.ranges()),
        };
        let fixes: Vec<Option<PlaceFix>> =
            asked.par_iter().map(|asked| (contestant.fix)(&asked.readings)).collect();
        judged.push(judge(contestant.name, &asked, &fixes));
    }
    for follower in followers {
        let mut all = Judged::new(follower.name);
        for file in &test.files {
            let (asked, fixes) = follow(file, follower);
            all.add(&judge(follower.name, &asked, &fixes));
        }
        judged.push(all);
    }
    judged
}

fn judge(name: &'static str, asked: &[Asked], fixes: &[Option<PlaceFix>]) -> Judged {
    let mut judged = Judged::new(name);
    for (asked, fix) in asked.iter().zip(fixes) {
        judged.record(fix.as_ref(), &asked.truth_m, asked.floor);
    }
    judged
}

fn scans(scans: &[adit_tuning::radio::SurveyedScan]) -> Vec<Asked> {
    let asked = |scan: &adit_tuning::radio::SurveyedScan| Asked {
        readings: scan.readings.clone(),
        truth_m: scan.position_m.xy(),
        floor: scan.floor,
    };
    scans.iter().map(asked).collect()
}

/// The epochs of a walk: for each, the packets that came in it and where the tag was in the mean.
fn epochs(file: &RadioFile) -> Vec<(f64, Asked)> {
    let start = file.times.first().copied().unwrap_or_default();
    let seconds = |time: Time| (time - start).seconds();
    let mut epochs: Vec<(f64, Asked)> = Vec::new();
    let mut index = 0;
    while index < file.times.len() {
        let end = (seconds(file.times[index]) / EPOCH_S).floor() * EPOCH_S + EPOCH_S;
        let count = file.times[index..].iter().take_while(|time| seconds(**time) < end).count().max(1);
        let packets = &file.strengths[index..index + count];
        let truth_m =
            packets.iter().map(|packet| packet.position_m.xy()).sum::<Vector2<f64>>() / count as f64;
        let readings = packets.iter().flat_map(|packet| packet.readings.iter().copied()).collect();
        epochs.push((end, Asked { readings, truth_m, floor: packets[0].floor }));
        index += count;
    }
    epochs
}

/// The same with medians over the last seconds, one to a transmitter.
fn windows(file: &RadioFile) -> Vec<Asked> {
    let epochs = epochs(file);
    let window = |(index, (end, asked)): (usize, &(f64, Asked))| {
        let mut heard: std::collections::BTreeMap<usize, Vec<f64>> = std::collections::BTreeMap::new();
        for (_, earlier) in epochs[..=index].iter().rev().take_while(|(at, _)| end - at < WINDOW_S) {
            for reading in &earlier.readings {
                heard.entry(reading.transmitter).or_default().push(reading.value);
            }
        }
        let median = |(transmitter, mut values): (usize, Vec<f64>)| {
            values.sort_by(f64::total_cmp);
            let half = values.len() / 2;
            let value = 0.5 * (values[half] + values[(values.len() - 1) / 2]);
            Reading { transmitter, value }
        };
        Asked {
            readings: heard.into_iter().map(median).collect(),
            truth_m: asked.truth_m,
            floor: asked.floor,
        }
    };
    epochs.iter().enumerate().map(window).collect()
}

fn follow(file: &RadioFile, follower: &Follower<'_>) -> (Vec<Asked>, Vec<Option<PlaceFix>>) {
    let epochs = epochs(file);
    let params = WalkParams::default();
    let lattice = follower.map.lattice();
    let mut before = epochs.first().map_or(0.0, |(end, _)| *end);
    let mut heard = Vec::with_capacity(epochs.len());
    let mut log_likelihood = Vec::new();
    for (end, asked) in &epochs {
        follower.map.log_likelihood(&asked.readings, &MapParams::PACKETS, &mut log_likelihood);
        heard.push((end - before, log_likelihood.clone()));
        before = *end;
    }
    let fixes = if follower.smoothed {
        smooth(lattice, params, &heard)
    } else {
        let mut walk = Walk::new(lattice.clone(), params);
        let online = heard.iter().map(|(interval_s, log_likelihood)| {
            walk.wander(*interval_s);
            walk.hear(log_likelihood);
            walk.fix()
        });
        online.collect()
    };
    (epochs.into_iter().map(|(_, asked)| asked).collect(), fixes)
}
