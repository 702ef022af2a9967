//! Smoothing of `fused` over a whole log.
//!
//! ```text
//! forward   as it streams, but the bank records (place::smoother)
//! backward  the smoothed states, at the bank's steps
//! between   p = p_a + κ R (way − way_a) + s (p_b − p_a − κ R (way_b − way_a)),   s the share of the time
//! before    from the first smoothed place back along the carrier's way
//! ```
//!
//! The carrier keeps its own filter and is not smoothed itself, but for a foot that nothing holds: then the solutions are those of `foot-ins`' own smoother.

use super::carrier::{Carrier, CarrierKind};
use super::evidence::{Evidence, Process};
use super::follower::{Follower, TICK, Walked};
use super::repeats::Repeats;
use super::{Fused, FusedParams, FusedReport};
use crate::methods::{Method, MethodError, MethodReport, MethodWarning, ahrs, foot_ins};
use crate::place::smoother::Segment;
use crate::place::state::State;
use adit_core::attitude;
use adit_core::nalgebra::{Matrix3, Vector3};
use adit_core::solution::{Quality, Solution};
use adit_observation::Observation;
use alloc::vec::Vec;

/// Observations from one word of progress to the next.
const SPOKEN: usize = 4096;

/// Smooths a whole log (fixed interval): every solution knows everything before and after it.
///
/// `progress` hears of the observations done, from 0 to twice their number. What has no smoother (ranges alone, signal strengths alone, strapdown between fixes, a magnetometer on a
/// foot or steps that nothing holds) gives the solutions of a stream and a warning.
pub fn smooth(
    params: FusedParams,
    log: &[Observation],
    progress: &mut dyn FnMut(usize),
) -> Result<(Vec<Solution>, FusedReport), MethodError> {
    // Refuses what cannot be worked with.
    let streaming = Fused::new(params.clone())?;
    let kind = match process(&params, log) {
        Process::Carried(kind) => kind,
        Process::Attitude => {
            let (solutions, alone) = ahrs::smooth(params.attitude, log, progress)?;
            return Ok(of_one(solutions, Process::Attitude, alone.warnings()));
        }
        Process::Strapdown | Process::Ranges | Process::Signals => return stream(streaming, log, progress),
    };
    let mut run = Run::new(kind, &params)?;
    run.forward(log, progress)?;
    let segments = run.follower.bank.finish();
    if !segments.is_empty() {
        return Ok(run.backward(&segments, params.place.lost_m));
    }
    if kind != CarrierKind::Foot || run.follower.has_map() {
        return stream(streaming, log, progress);
    }
    let (solutions, alone) = foot_ins::smooth(params.foot, log, &mut |done| progress(log.len() + done / 2))?;
    Ok(of_one(solutions, Process::Carried(kind), alone.warnings()))
}

/// What one method alone smoothed.
fn of_one(
    solutions: Vec<Solution>,
    process: Process,
    warnings: &[MethodWarning],
) -> (Vec<Solution>, FusedReport) {
    let warnings = warnings.to_vec();
    let mut report = FusedReport { process: Some(process), warnings, ..FusedReport::default() };
    for solution in &solutions {
        report.count(solution);
    }
    (solutions, report)
}

/// How the tag of a log is carried: told from its beginning, as it streams.
fn process(params: &FusedParams, log: &[Observation]) -> Process {
    let mut evidence = Evidence::default();
    let told = log.iter().find_map(|observation| evidence.observe(observation, params));
    told.unwrap_or_else(|| evidence.verdict(params))
}

/// What has no smoother.
fn stream(
    mut method: Fused,
    log: &[Observation],
    progress: &mut dyn FnMut(usize),
) -> Result<(Vec<Solution>, FusedReport), MethodError> {
    let mut solutions = Vec::new();
    for (index, observation) in log.iter().enumerate() {
        let mut solution = method.observe(observation)?;
        while let Some(now) = solution {
            solutions.push(now);
            solution = method.next_due()?;
        }
        if index.is_multiple_of(SPOKEN) {
            progress(log.len() + index);
        }
    }
    while let Some(last) = Method::finish_next(&mut method)? {
        solutions.push(last);
    }
    let mut report = method.report().clone();
    report.warnings.push(MethodWarning::NotSmoothed);
    Ok((solutions, report))
}

/// A run that is recorded.
struct Run {
    carrier: Carrier,
    follower: Follower,
    report: FusedReport,
    /// The carrier's solutions, each an instant, and what quality the place had as it streamed.
    reckoned: Vec<(Solution, Option<Quality>)>,
}

/// A smoothed state of the bank.
struct Node {
    at: usize,
    there: Walked,
    state: State,
}

impl Run {
    fn new(kind: CarrierKind, params: &FusedParams) -> Result<Self, MethodError> {
        let carrier = Carrier::new(kind, params)?;
        let mut follower = Follower::new(params, &carrier)?;
        follower.bank.record();
        let report = FusedReport { process: Some(Process::Carried(kind)), ..FusedReport::default() };
        Ok(Self { carrier, follower, report, reckoned: Vec::new() })
    }

    fn forward(&mut self, log: &[Observation], progress: &mut dyn FnMut(usize)) -> Result<(), MethodError> {
        let mut repeats = Repeats::default();
        for (index, observation) in log.iter().enumerate() {
            if repeats.is_repeated(observation) {
                continue;
            }
            self.follower.observe(observation, &mut self.report);
            let mut reckoned = self.carrier.observe(observation)?;
            while let Some(now) = reckoned {
                self.reckon(now)?;
                reckoned = self.carrier.next_due()?;
            }
            if index.is_multiple_of(SPOKEN) {
                progress(index);
            }
        }
        self.follower.finish(&mut self.report);
        while let Some(now) = self.carrier.finish_next()? {
            self.reckon(now)?;
        }
        self.report.hear_out(&self.carrier);
        progress(log.len());
        Ok(())
    }

    fn reckon(&mut self, now: Solution) -> Result<(), MethodError> {
        let newer = self.reckoned.last().is_none_or(|(last, _)| now.time > last.time);
        if newer {
            self.reckoned.push((now.clone(), None));
        }
        self.follower.bank.at(self.reckoned.len() - 1);
        let told = self.follower.reckon(&mut self.carrier, now, &mut self.report)?;
        if let (Some(told), Some((_, quality))) = (told, self.reckoned.last_mut()) {
            *quality = Some(told.quality);
        }
        Ok(())
    }

    /// From the end to the beginning: the carrier's solutions become those on the map.
    fn backward(mut self, segments: &[Segment], lost_m: f64) -> (Vec<Solution>, FusedReport) {
        let mut until = self.reckoned.len();
        let mut first: Option<Node> = None;
        for segment in segments.iter().rev() {
            let mut later: Option<Node> = None;
            segment.smooth(|at, state| {
                // What the carrier told at an instant is gone once its place on the map is.
                let known = later.as_ref().or(first.as_ref()).filter(|known| known.at == at);
                let there = known.map_or_else(|| Walked::of(&self.reckoned[at].0, 0.0), |known| known.there);
                let node = Node { at, there, state };
                let end = later.as_ref().map_or(until, |later| later.at.min(until));
                for (reckoned, _) in self.reckoned.iter_mut().take(end).skip(at) {
                    let (place_m, covariance_m2) = node.toward(later.as_ref(), reckoned);
                    on_map(reckoned, &node.state, place_m, &covariance_m2);
                }
                later = Some(node);
            });
            until = segment.begun;
            first = later;
        }
        if let Some(first) = first {
            self.before(first);
        }
        let Self { reckoned, mut report, .. } = self;
        let smoothed = reckoned.into_iter().map(|(mut solution, streamed)| {
            solution.quality = match (solution.quality, streamed) {
                (Quality::Lost, _) => Quality::Lost,
                _ if solution.radius_95_m() > lost_m => Quality::Lost,
                (_, Some(Quality::Fixed)) => Quality::Fixed,
                _ => Quality::DeadReckoning,
            };
            report.count(&solution);
            solution
        });
        let solutions = smoothed.collect();
        (solutions, report)
    }

    /// Before the first place: back along the carrier's way.
    fn before(&mut self, first: Node) {
        let Node { at, mut there, mut state } = first;
        for index in (0..at).rev() {
            let here = Walked::of(&self.reckoned[index].0, there.heading_rad);
            if there.time - here.time >= TICK || index == 0 {
                state.walk(&self.follower.stretch(&self.carrier, &here, &there).back());
                there = here;
            }
            let place_m = state.before(&(there.way_m - here.way_m));
            on_map(&mut self.reckoned[index].0, &state, place_m, &state.position_covariance_m2());
        }
    }
}

impl Node {
    /// Place and covariance at a solution of the carrier between this step and a later one.
    fn toward(&self, later: Option<&Self>, now: &Solution) -> (Vector3<f64>, Matrix3<f64>) {
        let place_m = self.state.position_m + self.state.on_map(&(now.position_m - self.there.way_m));
        let Some(later) = later else { return (place_m, self.state.position_covariance_m2()) };
        let whole_s = (later.there.time - self.there.time).seconds();
        let share = if whole_s > 0.0 { (now.time - self.there.time).seconds() / whole_s } else { 0.0 };
        let walked = self.state.on_map(&(later.there.way_m - self.there.way_m));
        let missing_m = later.state.position_m - self.state.position_m - walked;
        let [here, there] = [&self.state, &later.state].map(State::position_covariance_m2);
        (place_m + missing_m * share, here * (1.0 - share) + there * share)
    }
}

/// A solution of the carrier as it is on the map.
fn on_map(solution: &mut Solution, state: &State, place_m: Vector3<f64>, covariance_m2: &Matrix3<f64>) {
    solution.position_m = place_m;
    solution.velocity_m_s = state.on_map(&solution.velocity_m_s);
    solution.attitude = attitude::exp(&(Vector3::z() * -state.turn_rad)) * solution.attitude;
    let told = &mut solution.covariance;
    told.fixed_view_mut::<3, 9>(0, 0).fill(0.0);
    told.fixed_view_mut::<9, 3>(0, 0).fill(0.0);
    told.fixed_view_mut::<3, 3>(0, 0).copy_from(covariance_m2);
    told[(8, 8)] = state.direction_rad2();
}
