//! The mixture that the hypotheses are: weights, merging, what is reported of it.

use super::hypothesis::nearest_air;
use super::{Bank, Hypothesis, Place};
use crate::place::roadways::Roadways;
use crate::place::state::{EAST, State};
use adit_core::nalgebra::{Matrix2, Matrix3, Vector3};
use adit_core::solution::radius_95_m;
use serde::{Deserialize, Serialize};

/// Logarithm of the weight below which a hypothesis is dropped.
const DROPPED: f64 = -12.0;
/// What somebody off the map weighs at first where the map fits badly, as a logarithm.
pub(super) const OFF_SHARE: f64 = -3.0;
/// Square over what is to be expected from which a start fits badly.
const BAD_START: f64 = 9.0;
/// Distance that 95 % of a normal distribution on a line are within, squared, in variances.
const LINE_95: f64 = 3.841_458_820_694_124;

/// A place no farther than this beside its roadway is still on that, however sure it is, m.
const OUT_M: f64 = 0.25;

/// Within this radius fixes hold a place, m: dead reckoning alone exceeds it within some ten metres.
const HELD_M: f64 = 0.5;
/// The longest step of what is told, in radii that were told before: a carrier's own step comes to it.
const MOST_STEP: f64 = 0.9;

/// What a bank says of where somebody is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// Reported place, in the air of a roadway where the hypothesis is on one, m.
    pub position_m: Vector3<f64>,
    /// Second moment of the whole mixture about it, m².
    pub covariance_m2: Matrix3<f64>,
    /// What the reported hypothesis is held to.
    pub place: Place,
    /// How many hypotheses there are.
    pub hypotheses: usize,
    /// Weight of the reported one.
    pub share: f64,
    /// The map is contradicted.
    pub lost: bool,
}

/// What was said last.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Reported {
    pub id: u32,
    pub position_m: Vector3<f64>,
    pub radius_m: f64,
}

impl Bank {
    /// Where somebody is. The place of one hypothesis is reported, with the second moment of all about it, so that its radius holds the others too; another is reported
    /// when it weighs more **and** the radius that was stated last reaches it. Until then the radius grows and the place walks on with the old one. The same holds of one hypothesis
    /// that is corrected: no jump is larger than the radius stated before it.
    pub fn estimate(&mut self) -> Option<Estimate> {
        let roadways = self.roadways.as_deref();
        let best = self.hypotheses.get(self.most_likely()?)?;
        let (of_best, on_best) = best.told(roadways);
        let last = self.reported;
        let kept = last.and_then(|last| self.hypotheses.iter().find(|known| known.id == last.id));
        let reaches = |place_m: &Vector3<f64>| {
            let step_m = |last: Reported| (place_m - last.position_m).xy().norm();
            last.is_none_or(|last| step_m(last) <= MOST_STEP * last.radius_m)
        };
        let of_kept = kept.map(|kept| (kept, kept.told(roadways)));
        let (shown, (position_m, place)) = match (last, of_kept) {
            _ if reaches(&of_best) => (best, (of_best, on_best)),
            (_, Some(of_kept)) if reaches(&of_kept.1.0) => of_kept,
            // Corners are rounder than the map has them, which only fixes can tell.
            _ if best.is_held() && reaches(&best.state.position_m) => {
                (best, (best.at_height(of_best.z), on_best))
            }
            (Some(last), _) => {
                let shown = kept.unwrap_or(best);
                (shown, nearest_air(shown.place, last.position_m, roadways))
            }
            (None, _) => (best, (of_best, on_best)),
        };
        let mut covariance_m2 = Matrix3::zeros();
        for hypothesis in &self.hypotheses {
            let off = hypothesis.state.position_m - position_m;
            let about = hypothesis.state.position_covariance_m2() + off * off.transpose();
            covariance_m2 += about * hypothesis.weight();
        }
        // As it is it is where it goes: only who is told elsewhere has a step before him.
        let as_it_is = position_m.xy() == best.state.position_m.xy();
        let jump: Vector3<f64> = if as_it_is { Vector3::zeros() } else { of_best - position_m };
        let mut radius_m = radius_95_m(&level(&covariance_m2));
        if jump.xy().norm() > radius_m {
            // Whatever the weights: where it will go next is inside.
            covariance_m2 += jump * jump.transpose() / LINE_95;
            radius_m = radius_95_m(&level(&covariance_m2));
        }
        let estimate = Estimate {
            position_m,
            covariance_m2,
            place,
            hypotheses: self.hypotheses.len(),
            share: shown.weight(),
            lost: self.lost,
        };
        self.reported = Some(Reported { id: shown.id, position_m, radius_m });
        Some(estimate)
    }

    /// Starts the bank anew from one state.
    pub(super) fn open(&mut self, state: State, lineage: Option<u32>) {
        self.hypotheses.clear();
        let roadways = self.roadways.clone();
        let fit = roadways.as_deref().and_then(|roadways| self.seed(roadways, &state, 0.0, lineage));
        if fit.is_none_or(|fit| fit > BAD_START) {
            self.next_id = self.next_id.wrapping_add(1);
            let off = Hypothesis {
                id: self.next_id,
                place: Place::Off,
                log_weight: self.hypotheses.iter().map(|known| known.log_weight).fold(0.0, f64::max)
                    + OFF_SHARE,
                strain: 1.0,
                surprise: 1.0,
                elsewhere: false,
                walls: 0.0,
                lineage,
                state,
            };
            self.insert(off);
        }
        self.settle();
    }

    /// Lets a hypothesis in, unless there is one like it that is as likely.
    pub(super) fn admit(&mut self, roadways: &Roadways, mut child: Hypothesis) {
        child.strain = 1.0;
        child.elsewhere = false;
        child.walls = 0.0;
        if let Some(known) = self.hypotheses.iter_mut().find(|known| known.is_like(&child, roadways)) {
            if child.log_weight > known.log_weight {
                child.id = known.id;
                *known = child;
            }
            return;
        }
        self.next_id = self.next_id.wrapping_add(1);
        child.id = self.next_id;
        self.insert(child);
    }

    /// In a full bank instead of the least likely, but not of the one that is reported.
    fn insert(&mut self, child: Hypothesis) {
        if self.hypotheses.len() < self.room() {
            // Most of the time there are one or two.
            self.hypotheses.reserve_exact(1);
            self.hypotheses.push(child);
            return;
        }
        let reported = self.reported.map(|reported| reported.id);
        let others = self.hypotheses.iter_mut().filter(|known| Some(known.id) != reported);
        if let Some(least) = others.min_by(|a, b| a.log_weight.total_cmp(&b.log_weight))
            && least.log_weight < child.log_weight
        {
            *least = child;
        }
    }

    /// Weights sum to one; what hardly weighs anything is dropped, but not what is reported.
    pub(super) fn settle(&mut self) {
        let Some(best) = self.most_likely() else { return };
        let highest = self.hypotheses[best].log_weight;
        let reported = self.reported.map(|reported| reported.id);
        self.hypotheses.retain(|known| known.log_weight - highest > DROPPED || Some(known.id) == reported);
        self.hypotheses.shrink_to_fit();
        let sum: f64 = self.hypotheses.iter().map(|known| libm::exp(known.log_weight - highest)).sum();
        let norm = highest + libm::log(sum);
        for hypothesis in &mut self.hypotheses {
            hypothesis.log_weight -= norm;
        }
    }

    /// Joins those that have become alike.
    pub(super) fn merge(&mut self, roadways: &Roadways) {
        let mut first = 0;
        while first < self.hypotheses.len() {
            let mut second = first + 1;
            while second < self.hypotheses.len() {
                if self.hypotheses[first].is_like(&self.hypotheses[second], roadways) {
                    let other = self.hypotheses.remove(second);
                    let reported = self.reported.is_some_and(|reported| reported.id == other.id);
                    self.hypotheses[first].join(&other);
                    if reported {
                        self.hypotheses[first].id = other.id;
                    }
                } else {
                    second += 1;
                }
            }
            first += 1;
        }
    }

    /// One state with the moments of all.
    pub(super) fn collapsed(&self) -> Option<State> {
        let mut all = self.best()?.clone();
        let best = all.id;
        for other in self.hypotheses.iter().filter(|known| known.id != best) {
            all.join(other);
        }
        Some(all.state)
    }
}

fn level(matrix: &Matrix3<f64>) -> Matrix2<f64> {
    matrix.fixed_view::<2, 2>(EAST, EAST).into_owned()
}

impl Hypothesis {
    /// What is told of it: the nearest place in the air of its roadway; of another, where it has left its own farther than it is uncertain and is about to be found there.
    fn told(&self, roadways: Option<&Roadways>) -> (Vector3<f64>, Place) {
        let (here, air) = (self.state.position_m, self.in_air(roadways));
        let reach_m = radius_95_m(&level(&self.state.position_covariance_m2())).max(OUT_M);
        let left = (air - here).xy().norm() > reach_m;
        if left { nearest_air(self.place, here, roadways) } else { (air, self.place) }
    }

    /// Fixes hold it.
    fn is_held(&self) -> bool {
        radius_95_m(&level(&self.state.position_covariance_m2())) < HELD_M
    }

    /// Its place on the map, at this height, m.
    fn at_height(&self, up_m: f64) -> Vector3<f64> {
        self.state.position_m.xy().push(up_m)
    }

    /// Takes another in, so that mean and covariance stay those of the two (Salmond 1990; Runnalls 2007, eq. 2–4).
    fn join(&mut self, other: &Self) {
        let (a, b) = (self.weight(), other.weight());
        let share = if a + b > 0.0 { b / (a + b) } else { 0.5 };
        if other.log_weight > self.log_weight {
            self.place = other.place;
            self.strain = other.strain;
            self.surprise = other.surprise;
            self.lineage = other.lineage;
        }
        self.state.join(&other.state, share);
        let highest = self.log_weight.max(other.log_weight);
        let sum = libm::exp(self.log_weight - highest) + libm::exp(other.log_weight - highest);
        self.log_weight = highest + libm::log(sum);
    }
}
