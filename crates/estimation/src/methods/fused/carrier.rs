//! What carries the estimate from moment to moment: dead reckoning by what the tag itself feels.

use super::foot::{Foot, Seen};
use super::params::FusedParams;
use crate::methods::marg_ins::MargIns;
use crate::methods::pdr::{Direction, Pdr};
use crate::methods::{Method, MethodError, MethodWarning};
use crate::place::params::CarrierNoise;
use adit_core::solution::Solution;
use adit_observation::Observation;
use alloc::boxed::Box;
use serde::{Deserialize, Serialize};

/// Dead reckoning of one kind.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum Carrier {
    /// Strapdown on the foot, held by zero velocity; where it has a compass, that is told beside.
    Foot(Foot),
    /// The same with the heading of a magnetometer.
    Marg(Box<MargIns>),
    /// Steps, their length and direction.
    Steps(Box<Pdr>),
}

/// Which, before it is started.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CarrierKind {
    /// Strapdown on the foot.
    Foot,
    /// The same with a magnetometer.
    Marg,
    /// Steps of a tag on the body.
    Steps,
}

impl Carrier {
    /// Started by the settings.
    pub fn new(kind: CarrierKind, params: &FusedParams) -> Result<Self, MethodError> {
        Ok(match kind {
            CarrierKind::Foot => Self::Foot(Foot::new(params)?),
            CarrierKind::Marg => Self::Marg(Box::new(MargIns::new(params.marg.clone())?)),
            CarrierKind::Steps => {
                let mut steps = params.steps.clone();
                steps.fixes.used = false;
                steps.radio.used = false;
                steps.site = None;
                Self::Steps(Box::new(Pdr::new(steps)?))
            }
        })
    }

    /// How it errs.
    pub fn noise(&self, params: &FusedParams) -> CarrierNoise {
        match self {
            Self::Foot(_) | Self::Marg(_) => params.foot_noise,
            Self::Steps(_) => params.steps_noise,
        }
    }

    /// Whether it stands on the map from the start: one that was told a start pose.
    pub fn starts_on_map(&self, params: &FusedParams) -> bool {
        matches!(self, Self::Steps(_)) && params.steps.start.is_some()
    }

    /// Whether its forward direction is that of the wearer, so that a magnetometer tells where north is.
    pub fn is_mounted(&self, params: &FusedParams) -> bool {
        match self {
            Self::Foot(_) | Self::Marg(_) => true,
            Self::Steps(_) => params.steps.direction == Direction::Mounted,
        }
    }

    /// Whether north is that of a magnetometer.
    pub fn is_magnetic(&self) -> bool {
        match self {
            Self::Foot(foot) => foot.is_magnetic(),
            Self::Marg(marg) => marg.report().magnetic_heading,
            Self::Steps(steps) => steps.report().magnetic_heading,
        }
    }

    /// Whether that magnetometer goes on holding the heading.
    pub fn is_held_magnetic(&self) -> bool {
        !matches!(self, Self::Foot(_)) && self.is_magnetic()
    }

    /// Its heading when it stood last, rad, where a gyro alone holds it.
    pub fn heading_rad(&self) -> f64 {
        match self {
            Self::Foot(foot) => foot.heading_rad,
            Self::Marg(_) | Self::Steps(_) => 0.0,
        }
    }

    /// Somebody else holds place and heading.
    #[inline]
    pub fn hand_over(&mut self) {
        if let Self::Foot(foot) = self {
            foot.hand_over();
        }
    }

    /// A heading that its compass has just told beside, once.
    #[inline]
    pub fn seen(&mut self) -> Option<Seen> {
        match self {
            Self::Foot(foot) => foot.seen(),
            Self::Marg(_) | Self::Steps(_) => None,
        }
    }

    /// Hears by how much that was off, rad, and of which variance that was to be expected without its own noise, rad².
    pub fn note(&mut self, seen: &Seen, off_rad: f64, expected_rad2: f64) {
        if let Self::Foot(foot) = self {
            foot.note(seen, off_rad, expected_rad2);
        }
    }

    /// What its own run has to say.
    pub fn warnings(&self) -> &[MethodWarning] {
        match self {
            Self::Foot(foot) => &foot.ins.report().warnings,
            Self::Marg(marg) => &marg.report().warnings,
            Self::Steps(steps) => &steps.report().warnings,
        }
    }

    /// One observation in, at most one solution out.
    #[inline]
    pub fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        match self {
            Self::Foot(foot) => foot.observe(observation),
            Self::Marg(marg) => marg.observe(observation),
            Self::Steps(steps) => steps.observe(observation),
        }
    }

    /// A further solution that is due, if any.
    #[inline]
    pub fn next_due(&mut self) -> Result<Option<Solution>, MethodError> {
        match self {
            Self::Foot(foot) => foot.next_due(),
            Self::Marg(marg) => marg.next_due(),
            Self::Steps(steps) => Ok(steps.next_due()),
        }
    }

    /// After the last observation: the solutions still due, one at a time, then `None`.
    pub fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        match self {
            Self::Foot(foot) => foot.finish_next(),
            Self::Marg(marg) => marg.finish_next(),
            Self::Steps(steps) => steps.finish_next(),
        }
    }
}
