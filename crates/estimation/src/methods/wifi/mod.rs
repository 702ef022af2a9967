//! `wifi`: positions by signal strength alone.
//!
//! ```text
//! signal strengths → scans, averaged (radio::scan) → a position each (radio::locator) → solutions
//! ```
//!
//! One solution for each averaged scan, at the mean time of its readings, with the covariance that the locator tells; nothing is assumed of how
//! people move, and none is filtered. Velocity is that of anybody on foot, attitude that of anybody: not known.
//! Frame: that of the site. Needs no sensors of the tag.
//! Limits: those of the locator ([`crate::radio`]).

use crate::methods::somewhere::somewhere;
use crate::methods::{
    Estimates, Known, Method, MethodError, MethodReport, MethodSettings, MethodWarning, RadioUse,
};
use crate::radio::locator::LocatorParams;
use crate::radio::scan::ScanParams;
use crate::radio::{HeardReport, Listener, RadioSite};
use adit_core::nalgebra::Matrix3;
use adit_core::solution::Solution;
use adit_core::time::Time;
use adit_observation::{Observation, PositionFix};
use alloc::boxed::Box;
use alloc::collections::VecDeque;
use alloc::sync::Arc;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// Name of the method.
const NAME: &str = "wifi";

/// Settings of [`Wifi`].
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct WifiParams {
    /// How signals are gathered.
    pub scan: ScanParams,
    /// How positions are made of them.
    pub locator: LocatorParams,
    /// The radio of the site.
    #[serde(skip)]
    pub site: Option<Arc<RadioSite>>,
}

/// What a run did.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct WifiReport {
    /// What was heard.
    pub heard: HeardReport,
    /// Radius of 95 % of the positions, mean, m.
    pub mean_radius_95_m: f64,
    /// Warnings.
    pub warnings: Vec<MethodWarning>,
}

/// One tag, streaming.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Wifi {
    listener: Listener,
    /// Time of the last solution: another radio's may come for an earlier time.
    told: Option<Time>,
    due: VecDeque<Solution>,
    radius_sum_m: f64,
    report: WifiReport,
}

impl Wifi {
    /// A tag that has heard nothing.
    pub fn new(params: WifiParams) -> Result<Self, MethodError> {
        let WifiParams { scan, locator, site } = params;
        Ok(Self {
            listener: Listener::new(NAME, site.as_deref(), scan, locator)?,
            told: None,
            due: VecDeque::new(),
            radius_sum_m: 0.0,
            report: WifiReport::default(),
        })
    }

    fn tell(&mut self, fix: &PositionFix) {
        if self.told.is_some_and(|told| fix.time <= told) {
            return;
        }
        self.told = Some(fix.time);
        let mut covariance_m2 = Matrix3::zeros();
        covariance_m2.fixed_view_mut::<2, 2>(0, 0).copy_from(&fix.covariance_m2);
        let solution = somewhere(fix.time, fix.level_m.push(0.0), &covariance_m2);
        self.radius_sum_m += solution.radius_95_m();
        self.due.push_back(solution);
    }

    fn account(&mut self) {
        self.report.heard = self.listener.report().clone();
        self.report.mean_radius_95_m = self.radius_sum_m / self.report.heard.fixes.max(1) as f64;
    }
}

impl Method for Wifi {
    type Report = WifiReport;

    fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        match observation {
            Observation::Signal(signal) => self.listener.observe(signal),
            // What comes by radio may be ahead of the tag's clock.
            other if other.kind().is_wired() => self.listener.advance(other.time()),
            _ => {}
        }
        while let Some(fix) = self.listener.pop() {
            self.tell(&fix);
        }
        if !self.due.is_empty() {
            self.account();
        }
        Ok(self.due.pop_front())
    }

    fn next_due(&mut self) -> Result<Option<Solution>, MethodError> {
        Ok(self.due.pop_front())
    }

    fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        while let Some(fix) = self.listener.finish() {
            self.tell(&fix);
        }
        self.account();
        let heard = &self.report.heard;
        if self.told.is_none() {
            return Err(heard.no_position());
        }
        if self.report.warnings.is_empty() {
            self.report.warnings.extend(heard.warning());
        }
        Ok(self.due.pop_front())
    }

    fn report(&self) -> &WifiReport {
        &self.report
    }
}

impl MethodSettings for WifiParams {
    type Report = WifiReport;

    const NAME: &'static str = NAME;
    const ESTIMATES: Estimates = Estimates::Position;
    const RADIO: RadioUse = RadioUse::Needed;

    fn knowing(self, _: &Known) -> Self {
        self
    }

    fn at_site(self, radio: &Arc<RadioSite>) -> Self {
        Self { site: Some(Arc::clone(radio)), ..self }
    }

    fn start(self) -> Result<Box<dyn Method<Report = WifiReport>>, MethodError> {
        Ok(Box::new(Wifi::new(self)?))
    }
}

impl MethodReport for WifiReport {
    fn warnings(&self) -> &[MethodWarning] {
        &self.warnings
    }
}
