//! The offline estimate: the filter's record, run backward.
//!
//! The filter keeps what it did once an interval; the modified Bryson–Frazier recursion
//! ([`crate::kalman::blocks::BlockAdjoint`]) carries back what later measurements say. Attitudes between two corrections
//! get the correction interpolated between the ends of the interval: it differs there by the gyro's bias alone.

use crate::attitude::Forgotten;
use crate::attitude::state::{ATTITUDE, AttitudeState, BLOCKS, DOWN, FIELD, HORIZONTAL, VELOCITY};
use crate::kalman::blocks::{BlockAdjoint, BlockCovariance, BlockUpdate, Coupling};
use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::{Matrix3, UnitQuaternion, Vector3};
use alloc::boxed::Box;
use alloc::vec::Vec;

/// Takes what the filter did in an interval; the unit type keeps nothing.
pub trait Recorder {
    /// State and covariance predicted for the end of the interval, and the transition that led there.
    fn predicted(
        &mut self,
        _state: &AttitudeState,
        _covariance: &BlockCovariance<BLOCKS>,
        _couplings: &[Coupling; 4],
    ) {
    }
    /// Update with the rate at rest.
    fn rest(&mut self, _update: &BlockUpdate<BLOCKS, 1>) {}
    /// Update with the bounded velocity.
    fn velocity(&mut self, _update: &BlockUpdate<BLOCKS, 1>) {}
    /// Components that were forgotten.
    fn forgot(&mut self, _what: Forgotten) {}
    /// The frame was turned to the north, its heading and field forgotten; the covariance is that after it.
    fn found_north(&mut self, _turn: &UnitQuaternion<f64>, _covariance: &BlockCovariance<BLOCKS>) {}
    /// Update with the field.
    fn field(&mut self, _update: &BlockUpdate<BLOCKS, 3>) {}
}

impl Recorder for () {}

/// One step of the filter within an interval.
#[derive(Debug, Clone)]
enum Event {
    One(BlockUpdate<BLOCKS, 1>),
    Three(BlockUpdate<BLOCKS, 3>),
    Forgot(Forgotten),
    North(Box<North>),
}

/// The frame was turned to the north.
#[derive(Debug, Clone)]
struct North {
    turn: UnitQuaternion<f64>,
    covariance: BlockCovariance<BLOCKS>,
}

/// What the filter did in one interval.
#[derive(Debug, Clone)]
struct Step {
    predicted: Attitude,
    covariance: BlockCovariance<BLOCKS>,
    couplings: [Coupling; 4],
    events: Vec<Event>,
    /// A gap follows: what comes later says nothing of this interval.
    before_gap: bool,
}

/// Record of a whole log.
#[derive(Debug, Clone, Default)]
pub struct Record {
    steps: Vec<Step>,
}

/// Smoothed attitude at the end of an interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Smoothed {
    /// Body to ENU.
    pub attitude: Attitude,
    /// Covariance of its error, rotation vector in ENU, rad².
    pub covariance: Matrix3<f64>,
}

impl Record {
    /// Intervals so far.
    pub fn intervals(&self) -> usize {
        self.steps.len()
    }

    /// Notes that samples are missing after the last interval.
    pub fn gap(&mut self) {
        if let Some(step) = self.steps.last_mut() {
            step.before_gap = true;
        }
    }

    /// Runs backward; `progress` hears of every interval.
    pub fn smooth(&self, mut progress: impl FnMut(usize)) -> Vec<Smoothed> {
        let mut adjoint = BlockAdjoint::<BLOCKS>::default();
        let mut smoothed = Vec::with_capacity(self.steps.len());
        // Frame of what was recorded before north was found, seen from the one after.
        let mut frame = UnitQuaternion::identity();
        for (done, step) in self.steps.iter().rev().enumerate() {
            if step.before_gap {
                adjoint = BlockAdjoint::default();
            }
            for event in step.events.iter().rev() {
                match event {
                    Event::One(update) => adjoint.through_update(update),
                    Event::Three(update) => adjoint.through_update(update),
                    Event::Forgot((block, components)) => adjoint.through_forgetting(*block, components),
                    Event::North(north) => {
                        let heading = adjoint.correction(&north.covariance, ATTITUDE).z;
                        frame = frame * attitude::exp(&Vector3::new(0.0, 0.0, heading)) * north.turn;
                        adjoint.through_forgetting(FIELD, &[HORIZONTAL, DOWN]);
                        adjoint.through_forgetting(ATTITUDE, &[2]);
                        let rotation = north.turn.to_rotation_matrix().into_inner();
                        adjoint.through_turn(VELOCITY, &rotation);
                        adjoint.through_turn(ATTITUDE, &rotation);
                    }
                }
            }
            let correction: Vector3<f64> = adjoint.correction(&step.covariance, ATTITUDE);
            smoothed.push(Smoothed {
                attitude: frame * attitude::turn_navigation(&step.predicted, &correction),
                covariance: adjoint.smoothed(&step.covariance, ATTITUDE),
            });
            adjoint.through_prediction(&step.couplings);
            progress(done);
        }
        smoothed.reverse();
        smoothed
    }

    fn push(&mut self, event: Event) {
        if let Some(step) = self.steps.last_mut() {
            step.events.push(event);
        }
    }
}

impl Recorder for Record {
    fn predicted(
        &mut self,
        state: &AttitudeState,
        covariance: &BlockCovariance<BLOCKS>,
        couplings: &[Coupling; 4],
    ) {
        self.steps.push(Step {
            predicted: state.attitude,
            covariance: covariance.clone(),
            couplings: *couplings,
            events: Vec::with_capacity(2),
            before_gap: false,
        });
    }

    fn rest(&mut self, update: &BlockUpdate<BLOCKS, 1>) {
        self.push(Event::One(update.clone()));
    }

    fn velocity(&mut self, update: &BlockUpdate<BLOCKS, 1>) {
        self.push(Event::One(update.clone()));
    }

    fn forgot(&mut self, what: Forgotten) {
        self.push(Event::Forgot(what));
    }

    fn found_north(&mut self, turn: &UnitQuaternion<f64>, covariance: &BlockCovariance<BLOCKS>) {
        self.push(Event::North(Box::new(North { turn: *turn, covariance: covariance.clone() })));
    }

    fn field(&mut self, update: &BlockUpdate<BLOCKS, 3>) {
        self.push(Event::Three(update.clone()));
    }
}
