//! A bank of hypotheses, each an error-state filter held to a roadway: map matching for a walker whom nothing else sees.
//!
//! ```text
//! w_i ← w_i · N(n·(p − a); 0, nᵀP n + R)          held to a roadway: across it, upwards, at a face
//! R = (w²/12) · 2λ/d                               d walked, λ over which the place across is forgotten
//! w_j = w_i · q · N(d_j; 0, n_jᵀP n_j + R_j) · √(2πR_j)    a branch onto piece j at joint distance within 3σ
//! ```
//!
//! Each metre every hypothesis is held to its roadway (Davidson, Collin & Takala 2010, whose particles die at walls; here the uniform distribution across the width has a normal one's
//! first two moments). When the way of the last metres does not go along a hypothesis' roadway, it branches into what it can be on instead (Reid 1979): pieces whose
//! joint may have been passed, within three standard deviations along. Those that the way contradicts lose their weight; those that have become one are merged, moments kept
//! (Salmond 1990; Runnalls 2007); the most likely few are kept. Nothing ever jumps: a hypothesis moves by its own way and by Kalman updates.
//!
//! Without roadways the bank is one filter and nothing else.
//!
//! **Limits.** Who is not on the map is found to be so only by contradiction. Who knows his direction worse than by 20° is on no
//! roadway before he has walked straight for some metres.

mod branch;
mod hypothesis;
mod mixture;

pub use hypothesis::{Hypothesis, Place};
pub use mixture::Estimate;

use super::roadways::{Piece, Roadways, Room};
use super::smoother::{Recorder, Segment};
use super::state::{EAST, FACTOR, HEADING, NORTH, Seen, State, Stretch, Taken, UP};
use adit_core::nalgebra::{Vector2, Vector3};
use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec::Vec;
use mixture::Reported;
use serde::{Deserialize, Serialize};

/// How many standard deviations off a hypothesis may still be.
const DEFORMED: f64 = 3.5;
/// A way as long as this is looked at, m.
const LOOK_M: f64 = 1.0;
/// The direction of the way is that of about the last metres, m.
const RECENT_M: f64 = 3.0;
/// Looks from one merging to the next.
const MERGE_EVERY: u32 = 5;
/// Mean square at which a place is contradicted: nobody inside a roadway's walls exceeds 3, the variance of a uniform distribution taken as one.
const CONTRADICTED: f64 = 9.0;
/// The most that one measurement adds to the account of surprises.
const SURPRISE: f64 = 16.0;
/// Share of the newest in that account.
const NEWEST: f64 = 0.1;
/// What is added when all are contradicted: on the level, m; upwards, m; to the direction, rad.
const REOPENED: (f64, f64, f64) = (10.0, 2.0, 0.2);
/// After a way as long as this without contradiction a bank that was opened again is as good as any, m; before, it is opened twice as wide each time, four times as high.
const TRUSTED_M: f64 = 200.0;
/// Share of its variance at the start that is added to that of the factor.
const FORGOTTEN: f64 = 0.25;
/// Most doublings.
const WIDER: u32 = 6;
/// Standard deviation of a direction of which nothing is known: π/√3, rad.
const ANYHOW_RAD: f64 = 1.8;
/// The same where measurements contradict: a cage may have taken somebody to another level.
const CARRIED_AWAY: (f64, f64, f64) = (50.0, 100.0, 0.3);

/// What a bank goes by.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BankParams {
    /// Most hypotheses.
    pub hypotheses: usize,
    /// Height of the tag above the floor, m.
    pub tag_height_m: f64,
    /// Its standard deviation, m.
    pub tag_height_sigma_m: f64,
    /// Length over which somebody's place across a roadway is forgotten, m.
    pub forgotten_m: f64,
    /// The carrier's way has no height: it follows the roadway's slope.
    pub level_way: bool,
}

impl Default for BankParams {
    fn default() -> Self {
        Self {
            hypotheses: 8,
            tag_height_m: 1.0,
            tag_height_sigma_m: 0.4,
            forgotten_m: 10.0,
            level_way: false,
        }
    }
}

/// Hypotheses of where somebody is.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Bank {
    params: BankParams,
    #[serde(skip)]
    roadways: Option<Arc<Roadways>>,
    hypotheses: Vec<Hypothesis>,
    /// Of a whole log, to be smoothed.
    #[serde(skip)]
    recorder: Option<Box<Recorder>>,
    /// Way of the carrier since the last look, m.
    since_m: Vector2<f64>,
    /// Way of the last metres, older ones fading, m, and how long it was.
    recent_m: Vector2<f64>,
    recent_length_m: f64,
    looks: u32,
    next_id: u32,
    reported: Option<Reported>,
    lost: bool,
    /// Way since it was opened again, m, and how often that was on one way.
    reopened_m: f64,
    reopened: u32,
    /// Factor and its variance at the start: what is learnt on a wrong roadway is wrong.
    factor: (f64, f64),
}

impl Bank {
    /// Without anybody in it; without roadways one filter.
    pub fn new(params: BankParams, roadways: Option<Arc<Roadways>>) -> Self {
        Self {
            hypotheses: Vec::new(),
            params,
            roadways,
            recorder: None,
            since_m: Vector2::zeros(),
            recent_m: Vector2::zeros(),
            recent_length_m: 0.0,
            looks: 0,
            next_id: 0,
            reported: None,
            lost: false,
            reopened_m: f64::MAX,
            reopened: 0,
            factor: (1.0, 0.0),
        }
    }

    /// Gives a bank that was read back its roadways again: those that it had. A hypothesis on what they do not have is off the map.
    pub fn attach(&mut self, roadways: Option<Arc<Roadways>>) {
        for hypothesis in &mut self.hypotheses {
            let known = match (hypothesis.place, &roadways) {
                (Place::Piece(index), Some(roadways)) => roadways.piece(index).is_some(),
                (Place::Chamber(index), Some(roadways)) => roadways.chamber(index).is_some(),
                _ => false,
            };
            if !known {
                hypothesis.place = Place::Off;
            }
        }
        self.roadways = roadways;
    }

    /// Most hypotheses that there can be.
    fn room(&self) -> usize {
        if self.roadways.is_some() { self.params.hypotheses.max(1) } else { 1 }
    }

    /// Somebody is there: on every roadway that the covariance reaches.
    pub fn start(&mut self, state: State) {
        self.reported = None;
        self.lost = false;
        self.reopened_m = f64::MAX;
        self.reopened = 0;
        self.factor = (state.factor, state.covariance[(FACTOR, FACTOR)]);
        if let Some(mut recorder) = self.recorder.take() {
            recorder.open(self.best().map(|best| (best.lineage, &best.state)));
            self.recorder = Some(recorder);
        }
        self.open(state, None);
    }

    /// Knows nothing of where the walker went for a while: standard deviations that are added on the level (m), upwards (m), to the direction (rad); and all roadways in reach.
    pub fn reopen(&mut self, level_m: f64, up_m: f64, direction_rad: f64) {
        let Some(mut state) = self.collapsed() else { return };
        let before = self.recorder.as_ref().map(|_| state.clone());
        let p = &mut state.covariance;
        for (index, sigma) in [(EAST, level_m), (NORTH, level_m), (UP, up_m), (HEADING, direction_rad)] {
            p[(index, index)] += sigma * sigma;
        }
        let (factor, variance) = self.factor;
        if (state.factor - factor).abs() > DEFORMED * libm::sqrt(variance) {
            state.forget(FACTOR, variance);
            state.factor = factor;
        } else {
            p[(FACTOR, FACTOR)] += FORGOTTEN * variance;
        }
        self.lost = true;
        self.reopened_m = 0.0;
        let mut lineage = self.best().and_then(|best| best.lineage);
        if let (Some(recorder), Some(before)) = (&mut self.recorder, before) {
            lineage = recorder.reopen(lineage, &before, &state);
        }
        self.open(state, lineage);
    }

    /// Takes a stretch of the carrier's way.
    pub fn walk(&mut self, stretch: &Stretch) {
        let roadways = self.roadways.as_deref();
        let reported = self.reported.map(|reported| reported.id);
        let goes = self.hypotheses.iter().position(|known| Some(known.id) == reported);
        let goes = goes.or_else(|| self.most_likely());
        for (index, hypothesis) in self.hypotheses.iter_mut().enumerate() {
            let piece = match (hypothesis.place, roadways) {
                (Place::Piece(index), Some(roadways)) => roadways.piece(index),
                _ => None,
            };
            let roadway = piece.map(|piece| &piece.direction);
            let before = self.recorder.as_ref().map(|_| hypothesis.state.clone());
            let walked = hypothesis.state.walk_along(stretch, roadway);
            if let Some(reported) = self.reported.as_mut().filter(|_| Some(index) == goes) {
                // The place told last goes on with the one that it was of.
                reported.position_m += walked;
            }
            if self.params.level_way
                && let Some(piece) = piece
            {
                hypothesis.state.position_m.z += piece.rise * piece.direction.dot(&walked.xy());
            }
            if let (Some(recorder), Some(before)) = (&mut self.recorder, before) {
                let way = (stretch, roadway);
                hypothesis.lineage = recorder.step(hypothesis.lineage, &before, way, &hypothesis.state);
            }
        }
        if let Some(recorder) = &mut self.recorder {
            recorder.tidy(self.hypotheses.iter_mut().map(|hypothesis| &mut hypothesis.lineage));
        }
        self.since_m += stretch.way_m.xy();
        let walked_m = self.since_m.norm();
        if walked_m >= LOOK_M
            && let Some(roadways) = self.roadways.clone()
        {
            self.look(&roadways, walked_m);
        }
    }

    /// Takes a measurement, of each hypothesis as it sees it; gives what it did to the most likely.
    pub fn take<const M: usize>(&mut self, see: impl Fn(&State) -> Seen<M>, bound: f64) -> Option<Taken> {
        let best = self.most_likely()?;
        let mut of_best = None;
        for (index, hypothesis) in self.hypotheses.iter_mut().enumerate() {
            let seen = see(&hypothesis.state);
            let Some(taken) = hypothesis.state.take(&seen, bound) else { continue };
            hypothesis.log_weight += taken.log_likelihood;
            let surprise = (taken.nis / M as f64).min(SURPRISE);
            hypothesis.surprise += NEWEST * (surprise - hypothesis.surprise);
            if index == best {
                of_best = Some(taken);
            }
        }
        self.settle();
        if self.roadways.is_some()
            && self.hypotheses.iter().all(|hypothesis| hypothesis.surprise > CONTRADICTED)
        {
            self.reopen(CARRIED_AWAY.0, CARRIED_AWAY.1, CARRIED_AWAY.2);
        }
        of_best
    }

    /// Keeps from now on what [`Self::finish`] smooths, 1 kB for each step of each hypothesis that is alive or has descendants. Before the start.
    pub fn record(&mut self) {
        self.recorder = Some(Box::default());
    }

    /// The bank is at, or comes next to, this instant of a log that is recorded.
    pub fn at(&mut self, instant: usize) {
        if let Some(recorder) = &mut self.recorder {
            recorder.instant = instant;
        }
    }

    /// What was recorded, in order of time; nothing is from now on.
    pub fn finish(&mut self) -> Vec<Segment> {
        let best = self.best().map(|best| (best.lineage, best.state.clone()));
        let last = best.as_ref().map(|(lineage, state)| (*lineage, state));
        self.recorder.take().map(|recorder| recorder.finish(last)).unwrap_or_default()
    }

    /// All hypotheses, in no order.
    pub fn hypotheses(&self) -> &[Hypothesis] {
        &self.hypotheses
    }

    /// The most likely hypothesis; `None` before the start.
    pub fn best(&self) -> Option<&Hypothesis> {
        self.hypotheses.get(self.most_likely()?)
    }

    /// No hypothesis on the map fits: somebody is off it, or the bank has just been opened again.
    pub fn is_lost(&self) -> bool {
        self.lost
    }

    /// The piece of roadway that a place is on, if on any.
    pub fn piece_of(&self, place: Place) -> Option<&Piece> {
        let Place::Piece(index) = place else { return None };
        self.roadways.as_deref()?.piece(index)
    }

    /// The chamber that a place is in, if in any.
    pub fn chamber_of(&self, place: Place) -> Option<&Room> {
        let Place::Chamber(index) = place else { return None };
        self.roadways.as_deref()?.chamber(index)
    }

    /// Bytes that it takes, without the roadways.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + self.hypotheses.capacity() * size_of::<Hypothesis>()
    }

    fn most_likely(&self) -> Option<usize> {
        let weights = self.hypotheses.iter().map(|hypothesis| hypothesis.log_weight).enumerate();
        weights.reduce(|best, next| if next.1 > best.1 { next } else { best }).map(|(index, _)| index)
    }

    /// Holds all to their places and branches.
    fn look(&mut self, roadways: &Roadways, walked_m: f64) {
        let fading = libm::exp(-walked_m / RECENT_M);
        self.recent_m = self.recent_m * fading + self.since_m;
        self.recent_length_m = self.recent_length_m * fading + walked_m;
        self.since_m = Vector2::zeros();
        self.looks = self.looks.wrapping_add(1);
        self.reopened_m += walked_m;
        if self.reopened_m > TRUSTED_M {
            self.reopened = 0;
        }
        self.branch(roadways);
        let straight = self.is_straight();
        for hypothesis in &mut self.hypotheses {
            hypothesis.hold(roadways, &self.params, walked_m, straight);
        }
        if self.looks.is_multiple_of(MERGE_EVERY) {
            self.merge(roadways);
        }
        self.settle();
        let on_map = |hypothesis: &&Hypothesis| hypothesis.place != Place::Off;
        let off = self.best().is_some_and(|best| best.place == Place::Off);
        self.lost = off || self.reopened_m < 2.0 * self.params.forgotten_m;
        let mut held = self.hypotheses.iter().filter(on_map).peekable();
        if held.peek().is_some() && held.all(|hypothesis| hypothesis.strain > CONTRADICTED) {
            let wider = f64::from(1_u32 << self.reopened.min(WIDER));
            // A direction is the last thing to be doubted.
            let turned_rad = (REOPENED.2 * (wider / 4.0).max(1.0)).min(ANYHOW_RAD);
            self.reopen(REOPENED.0 * wider, REOPENED.1 * wider * wider, turned_rad);
            self.reopened += 1;
        }
    }

    /// The way of the last metres had one direction.
    fn is_straight(&self) -> bool {
        let length_m = self.recent_m.norm();
        self.recent_length_m > 0.6 * RECENT_M && length_m > STRAIGHT * self.recent_length_m
    }

    /// That direction as a hypothesis has it.
    fn recent_direction(&self, state: &State) -> Vector2<f64> {
        state.on_map(&Vector3::new(self.recent_m.x, self.recent_m.y, 0.0)).xy().normalize()
    }
}

/// Length of the way over its parts' from which it is straight: two halves at a right angle have 0.71.
const STRAIGHT: f64 = 0.75;
