//! `uwb-pdr` as one of the methods: its settings, and what it says of a run.

use super::{Environment, FusionParams, NAME, UwbPdr};
use crate::methods::alignment::Alignment;
use crate::methods::pdr::{Direction, PdrParams, PdrReport};
use crate::methods::{
    Known, Method, MethodError, MethodReport, MethodSettings, MethodWarning, NoiseParameter, RadioUse,
};
use crate::radio::RadioSite;
use crate::ranging::listener::{RangesHeard, RangesParams};
use crate::ranging::solver::SolverParams;
use adit_core::solution::Solution;
use adit_observation::Observation;
use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// Settings of [`UwbPdr`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct UwbPdrParams {
    /// Which ranges, and how they are gathered.
    pub ranges: RangesParams,
    /// How positions are made of them.
    pub solver: SolverParams,
    /// Dead reckoning.
    pub pdr: PdrParams,
    /// The weights of both.
    pub fusion: FusionParams,
    /// The anchors of the site.
    #[serde(skip)]
    pub site: Option<Arc<RadioSite>>,
}

impl Default for UwbPdrParams {
    fn default() -> Self {
        Self {
            ranges: RangesParams::default(),
            solver: SolverParams::default(),
            // At the waist.
            pdr: PdrParams { direction: Direction::Mounted, ..PdrParams::default() },
            fusion: FusionParams::default(),
            site: None,
        }
    }
}

impl UwbPdrParams {
    /// The first setting that cannot be worked with, by name; those of dead reckoning and of the ranges are theirs.
    pub(super) fn unusable(&self) -> Option<&'static str> {
        self.solver.unusable().or_else(|| self.fusion.unusable())
    }
}

/// What a run did.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct UwbPdrReport {
    /// Dead reckoning.
    pub pdr: PdrReport,
    /// What was heard.
    pub heard: RangesHeard,
    /// Positions by UWB that counted.
    pub fixes: u64,
    /// Epochs in each recognised environment.
    pub environments: EnvironmentCounts,
    /// Epochs of which no range was judged: all counted as clear.
    pub unjudged_epochs: u64,
    /// Sum of the weights of UWB, `ω_u`, over its positions.
    pub uwb_weight_sum: f64,
    /// Warnings.
    pub warnings: Vec<MethodWarning>,
}

/// Epochs in each environment.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct EnvironmentCounts {
    /// (a) [`Environment::Blocked`].
    pub blocked: u64,
    /// (b) [`Environment::PartlyBlocked`].
    pub partly_blocked: u64,
    /// (c) [`Environment::Ideal`].
    pub ideal: u64,
    /// (d) [`Environment::WithError`].
    pub with_error: u64,
}

impl UwbPdrReport {
    pub(super) fn note(&mut self, environment: Environment) {
        let counts = &mut self.environments;
        *match environment {
            Environment::Blocked => &mut counts.blocked,
            Environment::PartlyBlocked => &mut counts.partly_blocked,
            Environment::Ideal => &mut counts.ideal,
            Environment::WithError => &mut counts.with_error,
        } += 1;
    }

    pub(super) fn warn(&mut self, warning: MethodWarning) {
        if !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }

    pub(super) fn account(&mut self, alignment: &Alignment) {
        self.heard.clone_from(alignment.listener().heard());
        if let Some(pdr) = alignment.pdr() {
            self.pdr.clone_from(pdr);
            for warning in &pdr.warnings {
                self.warn(warning.clone());
            }
        }
        if let Some(warning) = self.heard.warning() {
            self.warn(warning);
        }
    }
}

impl Method for UwbPdr {
    type Report = UwbPdrReport;

    #[inline]
    fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        Self::observe(self, observation)
    }

    fn next_due(&mut self) -> Result<Option<Solution>, MethodError> {
        Self::next_due(self)
    }

    fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        Self::finish_next(self)
    }

    fn report(&self) -> &UwbPdrReport {
        Self::report(self)
    }
}

impl MethodSettings for UwbPdrParams {
    type Report = UwbPdrReport;

    const NAME: &'static str = NAME;
    const RADIO: RadioUse = RadioUse::Needed;
    const NOISE: &'static [&'static [NoiseParameter]] = &[&FusionParams::NOISE];

    fn knowing(mut self, known: &Known) -> Self {
        self.pdr = self.pdr.knowing(known);
        self
    }

    fn at_site(self, radio: &Arc<RadioSite>) -> Self {
        Self { site: Some(Arc::clone(radio)), ..self }
    }

    fn start(self) -> Result<Box<dyn Method<Report = UwbPdrReport>>, MethodError> {
        Ok(Box::new(UwbPdr::new(self)?))
    }
}

impl MethodReport for UwbPdrReport {
    fn warnings(&self) -> &[MethodWarning] {
        &self.warnings
    }
}
