//! One run through a blackout in a few numbers.

use crate::tracked::{Moment, Nis, Scenario, Simulated};
use adit_core::solution::Quality;
use adit_evaluation::travel::chord_length_m;
use anyhow::{Context, Result};
use core::f64::consts::TAU;
use serde::Serialize;
use toml::Value;

/// A method may take so long from the beginning before its radius counts, s.
const SETTLED_S: f64 = 60.0;
/// Farther than this above or below the truth is another level, m.
const OTHER_LEVEL_M: f64 = 10.0;
/// Found again: no farther than this from the truth, m, and fixed by its own word.
const FOUND_M: f64 = 3.0;

/// When everything is off.
#[derive(Debug, Clone, Copy)]
pub struct Dark {
    /// From, s.
    pub from_s: f64,
    /// Until, s.
    pub until_s: f64,
}

/// A part of a run.
#[derive(Debug, Clone, Serialize)]
pub struct Part {
    /// Share of the moments, of those not lost, with the truth inside the radius; none where all are lost or there are none.
    pub within_share: Option<f64>,
    /// Mean NEES of east and north of the same moments; 2 is honest.
    pub nees: Option<f64>,
    /// Mean distance from the truth, m.
    pub mean_m: Option<f64>,
    /// Largest, m.
    pub largest_m: Option<f64>,
}

/// Found again.
#[derive(Debug, Clone, Serialize)]
pub struct Back {
    /// After the return, s.
    pub seconds: f64,
    /// Epochs of ranges since the return, with this one.
    pub fixes: u32,
}

/// A run.
#[derive(Debug, Clone, Serialize)]
pub struct DarkHour {
    /// Its seed.
    pub seed: u64,
    /// Way truly walked in the blackout, m.
    pub walked_m: f64,
    /// With infrastructure, settled.
    pub before: Part,
    /// In the blackout.
    pub dark: Part,
    /// After the return.
    pub after: Part,
    /// Distance from the truth at the end of the blackout, m.
    pub end_m: f64,
    /// Largest in it, m.
    pub largest_m: f64,
    /// Share of the blackout on another level than the truth.
    pub wrong_level_share: f64,
    /// Share of all settled moments at which it said that it was lost.
    pub lost_share: f64,
    /// How often the track went farther than its radius, more than the walker did, from one judged moment to the next.
    pub jumps: u32,
    /// The largest such step, as a share of the radius before it.
    pub largest_jump: f64,
    /// How fast the heading turned away from the truth before and in the blackout, deg/h, anticlockwise; means nothing of a method without
    /// attitude.
    pub heading_deg_h: [f64; 2],
    /// Mean normalised innovation squared by degree of freedom, as the method tells it; 1 is honest.
    pub nis: Option<f64>,
    /// When it was found again; none when it never was.
    pub back: Option<Back>,
}

impl Dark {
    /// The longest time without everything.
    pub fn of(scenario: &Scenario) -> Result<Self> {
        let outages = scenario.of_mine("outages").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
        let number = |outage: &Value, key: &str| outage.get(key).and_then(Value::as_float);
        outages
            .iter()
            .filter(|outage| outage.get("dead").and_then(Value::as_str) == Some("everything"))
            .filter_map(|outage| {
                Some(Self { from_s: number(outage, "from_s")?, until_s: number(outage, "until_s")? })
            })
            .max_by(|a, b| (a.until_s - a.from_s).total_cmp(&(b.until_s - b.from_s)))
            .context("an outage of everything, with an end")
    }

    fn holds(&self, time_s: f64) -> bool {
        (self.from_s..self.until_s).contains(&time_s)
    }
}

impl Part {
    fn of<'a>(moments: impl Iterator<Item = &'a Moment> + Clone) -> Self {
        let sure = moments.clone().filter(|moment| moment.quality != Quality::Lost);
        let mean = |values: &mut dyn Iterator<Item = f64>| {
            let (count, sum) = values.fold((0_u32, 0.0), |(count, sum), value| (count + 1, sum + value));
            (count > 0).then(|| sum / f64::from(count))
        };
        let within = |moment: &Moment| f64::from(u8::from(moment.error_m.norm() <= moment.radius_m));
        Self {
            within_share: mean(&mut sure.clone().map(within)),
            nees: mean(&mut sure.filter_map(|moment| moment.nees)),
            mean_m: mean(&mut moments.clone().map(|moment| moment.error_m.norm())),
            largest_m: moments.map(|moment| moment.error_m.norm()).reduce(f64::max),
        }
    }
}

impl DarkHour {
    /// Of the moments of a run.
    pub fn of(seed: u64, moments: &[Moment], nis: Nis, simulated: &Simulated, dark: &Dark) -> Self {
        let settled = || moments.iter().filter(|moment| moment.time_s >= SETTLED_S);
        let inside = || moments.iter().filter(|moment| dark.holds(moment.time_s));
        let count = |some: usize, of: usize| some as f64 / of.max(1) as f64;
        let in_the_dark = Part::of(inside());
        let walked = simulated.truth.poses().iter().filter(|pose| dark.holds(pose.time.seconds()));
        let walked: Vec<_> = walked.map(|pose| pose.position_m).collect();
        let steps = moments
            .windows(2)
            .filter(|pair| pair[0].time_s >= SETTLED_S)
            .map(|pair| (pair[1].error_m - pair[0].error_m).norm() / pair[0].radius_m.max(f64::MIN_POSITIVE));
        let found = |moment: &&Moment| {
            moment.time_s >= dark.until_s
                && moment.quality == Quality::Fixed
                && moment.error_m.norm() <= FOUND_M
        };
        let back = moments.iter().find(found).map(|moment| {
            let since = simulated.epochs_s.iter().filter(|t| (dark.until_s..=moment.time_s).contains(*t));
            let fixes = u32::try_from(since.count()).unwrap_or(u32::MAX);
            Back { seconds: moment.time_s - dark.until_s, fixes }
        });
        Self {
            seed,
            walked_m: chord_length_m(&walked),
            before: Part::of(settled().filter(|moment| moment.time_s < dark.from_s)),
            after: Part::of(settled().filter(|moment| moment.time_s >= dark.until_s)),
            end_m: inside().next_back().map_or(f64::NAN, |moment| moment.error_m.norm()),
            largest_m: in_the_dark.largest_m.unwrap_or(f64::NAN),
            dark: in_the_dark,
            wrong_level_share: count(
                inside().filter(|moment| moment.above_m.abs() > OTHER_LEVEL_M).count(),
                inside().count(),
            ),
            lost_share: count(
                settled().filter(|moment| moment.quality == Quality::Lost).count(),
                settled().count(),
            ),
            jumps: u32::try_from(steps.clone().filter(|share| *share > 1.0).count()).unwrap_or(u32::MAX),
            largest_jump: steps.fold(0.0, f64::max),
            heading_deg_h: [
                turning_deg_h(moments, SETTLED_S, dark.from_s),
                turning_deg_h(moments, dark.from_s, dark.until_s),
            ],
            nis: (nis.count > 0.0).then(|| nis.sum / nis.count),
            back,
        }
    }
}

/// Turn of the heading's error from one time to another, deg/h: of the mean over half a minute after the one and before the other.
fn turning_deg_h(moments: &[Moment], from_s: f64, until_s: f64) -> f64 {
    const ENDS_S: f64 = 30.0;
    let (mut unwrapped, mut last, mut ends) = (0.0, None, [(0.0, 0.0); 2]);
    for moment in moments.iter().filter(|moment| (from_s..until_s).contains(&moment.time_s)) {
        let step = moment.turned_rad - last.unwrap_or(moment.turned_rad);
        unwrapped += step - TAU * (step / TAU).round();
        last = Some(moment.turned_rad);
        for (end, inside) in
            ends.iter_mut().zip([moment.time_s < from_s + ENDS_S, moment.time_s > until_s - ENDS_S])
        {
            if inside {
                *end = (end.0 + unwrapped, end.1 + 1.0);
            }
        }
    }
    let [before, after] = ends.map(|(sum, count): (f64, f64)| sum / count);
    (after - before).to_degrees() * 3600.0 / (until_s - from_s - ENDS_S)
}
