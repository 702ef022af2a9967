//! Steps out of bumps: the rhythm of one walker.
//!
//! **A walk begins** with [`BEGIN`] bumps in a row that repeat every second one: the times and heights of the same foot agree,
//! those of the two feet may differ (a limp; a tag in one pocket). The bump before them is the push of the first step, lower than
//! the others, since a body at rest starts slowly. Whoever puts a tag into a pocket or takes it out makes bumps too, but not five
//! in rhythm.
//!
//! **On a walk** a bump in time is a step. One too early belongs to the step before (heel and sole of the same foot). A weak or a
//! late one is held: in a U-turn the body hardly rises for two or three steps. When the rhythm goes on (two bumps in time and
//! not weak) the steps between are told by the time that they had, less half a step for the pause that a turn is; when it
//! does not within [`StepParams::patience`] steps, the walk has ended, and of what is held only the step beside the
//! standing foot counts.
//!
//! A double peak is mostly gone before it comes here: the smoothing follows the rhythm ([`super::bumps::Smoother`]).

use super::bumps::Bump;
use super::{Step, StepParams};
use adit_core::time::{Interval, Time};
use alloc::collections::VecDeque;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// Bumps in rhythm that begin a walk.
pub const BEGIN: usize = 5;
/// Bumps remembered before a walk: those and some before, one of which is the first step.
const REMEMBERED: usize = 7;
/// Bumps in time after a weak stretch with which the walk goes on.
const GO_ON: usize = 2;
/// Steps over which the time of a step, and the height of a bump, are averaged.
const PERIOD_GAIN: f64 = 0.2;
const HEIGHT_GAIN: f64 = 0.2;
/// A walk whose times of a step differ by this share from one stride to the next is none.
const UNSTEADY: f64 = 0.3;
const UNSTEADY_GAIN: f64 = 0.25;
/// One step changes the time of a step by no more than this deviation allows.
const LARGEST_CHANGE: (f64, f64) = (0.7, 1.4);
/// A pause of this share of a step is no step.
const PAUSE: f64 = 0.5;

/// What is known of the walker.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
enum State {
    /// Not walking, as far as is known: the last bumps.
    Idle(VecDeque<Bump>),
    /// Walking.
    Walk(Walk),
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Walk {
    /// Mean time of a step, s, and mean height of its bump, m/s².
    period_s: f64,
    height_m_s2: f64,
    swing_m_s2: f64,
    /// The last bump that is certain, as time and height.
    last: (Time, f64),
    /// Bumps since then, weak or out of time.
    held: Vec<Bump>,
    /// The last step told.
    told: Option<Time>,
    /// The last two times of a step, s, and how much, as a share, such a time differs from that of the same foot before.
    periods_s: [f64; 2],
    unsteady: f64,
}

/// Rhythm of one walker.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Gait {
    state: State,
    /// The last step told before this walk.
    told: Option<Time>,
}

impl Default for Gait {
    fn default() -> Self {
        Self { state: State::Idle(VecDeque::with_capacity(REMEMBERED + 1)), told: None }
    }
}

impl Gait {
    /// True in the midst of a walk.
    pub fn is_walking(&self) -> bool {
        matches!(self.state, State::Walk(_))
    }

    /// Mean time of a step, s, on a walk.
    pub fn period_s(&self) -> Option<f64> {
        match &self.state {
            State::Idle(_) => None,
            State::Walk(walk) => Some(walk.period_s),
        }
    }

    /// Takes the next bump; steps that it decides go to `due`.
    pub fn observe(&mut self, params: &StepParams, bump: &Bump, due: &mut VecDeque<Step>) {
        self.rest(params, bump.time, due);
        match &mut self.state {
            State::Idle(bumps) => {
                if bumps.back().is_some_and(|before| seconds(before.time, bump.time) > params.longest_s) {
                    bumps.clear();
                }
                bumps.push_back(*bump);
                if bumps.len() > REMEMBERED {
                    bumps.pop_front();
                }
                if let Some(walk) = begin(params, bumps, self.told, due) {
                    self.state = State::Walk(walk);
                }
            }
            State::Walk(walk) => {
                walk.observe(params, bump, due);
                if walk.unsteady > UNSTEADY {
                    self.end(params, due);
                }
            }
        }
    }

    /// No bump came until `time`: a walk may have ended.
    pub fn rest(&mut self, params: &StepParams, time: Time, due: &mut VecDeque<Step>) {
        if let State::Walk(walk) = &self.state
            && seconds(walk.last.0, time) > params.patience * walk.period_s
        {
            self.end(params, due);
        }
    }

    /// The walk is over, or the log is.
    pub fn end(&mut self, params: &StepParams, due: &mut VecDeque<Step>) {
        let State::Walk(walk) = &mut self.state else { return };
        let mut left = VecDeque::with_capacity(REMEMBERED + 1);
        let last = walk.last_step(params);
        if let Some(bump) = last {
            walk.tell(params, bump.time, Some(&bump), due);
        }
        let after = last.map_or(walk.last.0, |bump| bump.time);
        let kept = walk.held.iter().filter(|bump| bump.time > after);
        let surplus = kept.clone().count().saturating_sub(REMEMBERED);
        left.extend(kept.skip(surplus).copied());
        self.told = walk.told;
        self.state = State::Idle(left);
    }

    /// Until when nothing is told any more, if the bump under way may be as early as `undecided`.
    pub fn settled(&self, params: &StepParams, undecided: Time) -> Time {
        match &self.state {
            State::Walk(walk) => walk.last.0,
            State::Idle(bumps) => {
                let alive = bumps.back().is_some_and(|b| seconds(b.time, undecided) <= params.longest_s);
                let oldest = bumps.get((bumps.len() + 1).saturating_sub(REMEMBERED));
                let before = |time: Time| time - Interval::from_nanos(1);
                match oldest {
                    Some(oldest) if alive => before(oldest.time.min(undecided)),
                    _ => before(undecided),
                }
            }
        }
    }
}

impl Walk {
    fn observe(&mut self, params: &StepParams, bump: &Bump, due: &mut VecDeque<Step>) {
        let (height, since_s) = (bump.height_m_s2(), seconds(self.last.0, bump.time));
        let strong = height >= params.weak_share * self.height_m_s2;
        if self.held.is_empty() {
            if since_s < params.early * self.period_s {
                if height > self.last.1 {
                    self.last = (bump.time, height);
                }
                return;
            }
            if strong && since_s <= params.late * self.period_s {
                self.tell(params, bump.time, Some(bump), due);
                let (least, most) = LARGEST_CHANGE;
                let period_s = since_s.clamp(least * self.period_s, most * self.period_s);
                self.period_s += PERIOD_GAIN * (period_s - self.period_s);
                let change = libm::fabs(libm::log(since_s / self.periods_s[0]));
                self.unsteady += UNSTEADY_GAIN * (change - self.unsteady);
                self.periods_s = [self.periods_s[1], since_s];
                self.certain(bump);
                return;
            }
        }
        self.held.push(*bump);
        self.go_on(params, due);
    }

    /// After a weak stretch: does the walk go on?
    fn go_on(&mut self, params: &StepParams, due: &mut VecDeque<Step>) {
        let Some(first) = self.held.len().checked_sub(GO_ON) else { return };
        let resumed = &self.held[first..];
        let (early_s, late_s) = (params.early * self.period_s, params.late * self.period_s);
        let strong = |bump: &Bump| bump.height_m_s2() >= params.weak_share * self.height_m_s2;
        let in_time = |pair: &[Bump]| (early_s..=late_s).contains(&seconds(pair[0].time, pair[1].time));
        if !resumed.iter().all(strong) || !resumed.windows(2).all(in_time) {
            return;
        }
        let from = self.last.0;
        let gap_s = seconds(from, resumed[0].time);
        let unseen = if gap_s > late_s {
            (libm::round(gap_s / self.period_s - PAUSE) - 1.0).clamp(0.0, params.patience)
        } else {
            0.0
        };
        let mut count = 1.0;
        while count <= unseen {
            let share = Interval::from_seconds(gap_s * count / (unseen + 1.0)).unwrap_or_default();
            self.tell(params, from + share, None, due);
            count += 1.0;
        }
        // The first of them may still belong to the last certain step.
        let late = usize::from(gap_s < early_s);
        let held = core::mem::take(&mut self.held);
        for bump in held.iter().skip(first + late) {
            self.tell(params, bump.time, Some(bump), due);
        }
        if let Some(bump) = held.last() {
            self.certain(bump);
        }
    }

    /// The step beside the standing foot, at the end of a walk.
    fn last_step(&self, params: &StepParams) -> Option<Bump> {
        let since_s = |bump: &&Bump| seconds(self.last.0, bump.time);
        let bump = self.held.iter().find(|bump| since_s(bump) >= params.early * self.period_s)?;
        let in_time = since_s(&bump) <= params.late * self.period_s;
        (in_time && bump.height_m_s2() >= params.last_share * self.height_m_s2).then_some(*bump)
    }

    fn certain(&mut self, bump: &Bump) {
        let height = bump.height_m_s2();
        self.height_m_s2 += HEIGHT_GAIN * (height - self.height_m_s2);
        self.swing_m_s2 += HEIGHT_GAIN * (bump.swing_m_s2() - self.swing_m_s2);
        self.last = (bump.time, height);
    }

    fn tell(&mut self, params: &StepParams, time: Time, bump: Option<&Bump>, due: &mut VecDeque<Step>) {
        let since_s = self.told.map(|told| seconds(told, time));
        let in_time = since_s.filter(|since_s| *since_s <= params.late * self.period_s);
        due.push_back(Step {
            time,
            period_s: in_time.unwrap_or(self.period_s),
            swing_m_s2: bump.map_or(self.swing_m_s2, Bump::swing_m_s2),
            seen: bump.is_some(),
        });
        self.told = Some(time);
    }
}

/// A walk, if the last bumps are its beginning.
fn begin(
    params: &StepParams,
    bumps: &VecDeque<Bump>,
    told: Option<Time>,
    due: &mut VecDeque<Step>,
) -> Option<Walk> {
    let start = bumps.len().checked_sub(BEGIN)?;
    let rhythm: [Bump; BEGIN] = core::array::from_fn(|index| bumps[start + index]);
    if !is_rhythm(params, &rhythm) {
        return None;
    }
    let [first, .., last] = &rhythm;
    let mean = |of: fn(&Bump) -> f64| rhythm.iter().map(of).sum::<f64>() / BEGIN as f64;
    let mut walk = Walk {
        period_s: seconds(first.time, last.time) / (BEGIN - 1) as f64,
        height_m_s2: mean(Bump::height_m_s2),
        swing_m_s2: mean(Bump::swing_m_s2),
        last: (last.time, last.height_m_s2()),
        held: Vec::new(),
        told,
        periods_s: [seconds(rhythm[2].time, rhythm[3].time), seconds(rhythm[3].time, last.time)],
        unsteady: 0.0,
    };
    let (early_s, late_s) = (params.early * walk.period_s, params.late * walk.period_s);
    let before = bumps.iter().take(start).rev().find(|bump| seconds(bump.time, first.time) >= early_s);
    let push = before.filter(|bump| {
        seconds(bump.time, first.time) <= late_s
            && bump.height_m_s2() >= params.first_share * walk.height_m_s2
            && told.is_none_or(|told| seconds(told, bump.time) >= early_s)
    });
    for bump in push.into_iter().chain(&rhythm) {
        walk.tell(params, bump.time, Some(bump), due);
    }
    Some(walk)
}

/// Bumps that repeat every second one.
fn is_rhythm(params: &StepParams, bumps: &[Bump; BEGIN]) -> bool {
    let heights = bumps.map(|bump| bump.height_m_s2());
    let mut periods = [0.0; BEGIN - 1];
    for (period, pair) in periods.iter_mut().zip(bumps.windows(2)) {
        *period = seconds(pair[0].time, pair[1].time);
    }
    let apart = |values: &[f64], by: usize, most: f64| {
        values.iter().zip(&values[by..]).all(|(a, b)| a.max(*b) <= most * a.min(*b))
    };
    let least = heights.iter().fold(f64::INFINITY, |least, height| least.min(*height));
    let most = heights.iter().fold(0.0, |most: f64, height| most.max(*height));
    periods.iter().all(|period| (params.shortest_s..=params.longest_s).contains(period))
        && apart(&periods, 2, 1.0 + params.irregularity)
        && apart(&periods, 1, params.limp)
        && least >= params.least_bump_m_s2
        && apart(&heights, 2, params.foot_ratio)
        && most <= params.largest_ratio * least
}

fn seconds(from: Time, to: Time) -> f64 {
    (to - from).seconds()
}
