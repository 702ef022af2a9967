//! `pdr-wifi` as one of the methods: its settings, and what it says of a run.

use super::fusion::{Fused, FusionParams, Report};
use super::{NAME, PdrWifi};
use crate::methods::pdr::{Direction, PdrParams, PdrReport};
use crate::methods::{
    Known, Method, MethodError, MethodReport, MethodSettings, MethodWarning, Nis, NoiseParameter, RadioUse,
};
use crate::radio::locator::{LocatorMethod, LocatorParams};
use crate::radio::scan::ScanParams;
use crate::radio::{HeardReport, Listener, RadioSite};
use adit_core::nalgebra::Vector2;
use adit_core::solution::Solution;
use adit_observation::Observation;
use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec::Vec;
use serde::{Deserialize, Serialize};

/// Degrees of freedom of a report.
const REPORT_DIMENSION: usize = 4;

/// Settings of [`PdrWifi`]: the defaults are those of system S1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PdrWifiParams {
    /// Dead reckoning.
    pub pdr: PdrParams,
    /// How signals are gathered into reports.
    pub scan: ScanParams,
    /// How a position is made of them.
    pub locator: LocatorParams,
    /// The filter.
    pub fusion: FusionParams,
    /// The radio of the site.
    #[serde(skip)]
    pub site: Option<Arc<RadioSite>>,
}

impl Default for PdrWifiParams {
    fn default() -> Self {
        Self {
            pdr: PdrParams {
                // At the waist.
                direction: Direction::Mounted,
                ..PdrParams::default()
            },
            // "Three samples in a row, averaged", every 5 s.
            scan: ScanParams { averaged: 3, every_s: 5.0, ..ScanParams::default() },
            locator: LocatorParams { method: LocatorMethod::InnerPointsImproved, ..LocatorParams::default() },
            fusion: FusionParams::default(),
            site: None,
        }
    }
}

impl PdrWifiParams {
    /// The first setting that cannot be worked with, by name; those of the halves are theirs.
    pub(super) fn unusable(&self) -> Option<&'static str> {
        self.fusion.unusable()
    }

    /// How well the start is known, m (east, north); `None` where nobody told it.
    pub fn start_sigma_m(&self) -> Option<Vector2<f64>> {
        self.pdr.start.map(|start| Vector2::from(start.position_sigma_m))
    }
}

/// What a run did.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct PdrWifiReport {
    /// Dead reckoning.
    pub pdr: PdrReport,
    /// What was heard.
    pub heard: HeardReport,
    /// Reports that the filter took.
    pub reports: u64,
    /// Positions by radio older than the state: left out.
    pub late_fixes: u64,
    /// What dead reckoning was off by at the last report, m (east, north).
    pub offset_m: [f64; 2],
    /// The same of its velocity, m/s.
    pub rate_m_s: [f64; 2],
    /// Sum of the normalised innovations squared (4 degrees of freedom each).
    pub nis_sum: f64,
    /// Reports in that sum.
    pub nis_count: u64,
    /// Warnings.
    pub warnings: Vec<MethodWarning>,
    /// The reports, oldest first, as the filter took them: what `adit tune` runs it over. Kept where [`PdrWifi::keeping_reports`] asked for it.
    #[serde(skip)]
    pub kept: Option<Vec<Report>>,
}

impl PdrWifiReport {
    pub(super) fn note(&mut self, report: &Report, fused: &Fused) {
        self.reports += 1;
        self.offset_m = fused.offset_m.into();
        self.rate_m_s = fused.rate_m_s.into();
        if let Some(nis) = fused.nis {
            self.nis_sum += nis;
            self.nis_count += 1;
        }
        if let Some(kept) = &mut self.kept {
            kept.push(*report);
        }
    }

    pub(super) fn account(&mut self, listener: &Listener, pdr: &PdrReport) {
        self.heard = listener.report().clone();
        self.pdr = pdr.clone();
        if self.warnings.is_empty() {
            self.warnings.extend(pdr.warnings.iter().cloned());
            self.warnings.extend(self.heard.warning());
        }
    }
}

impl PdrWifi {
    /// Has the report keep every report of the tag: 48 bytes each.
    #[must_use]
    pub fn keeping_reports(mut self) -> Self {
        self.report.kept = Some(Vec::new());
        self
    }
}

impl Method for PdrWifi {
    type Report = PdrWifiReport;

    #[inline]
    fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
        Self::observe(self, observation)
    }

    fn next_due(&mut self) -> Result<Option<Solution>, MethodError> {
        Ok(Self::next_due(self))
    }

    fn finish_next(&mut self) -> Result<Option<Solution>, MethodError> {
        Self::finish_next(self)
    }

    fn report(&self) -> &PdrWifiReport {
        Self::report(self)
    }
}

impl MethodSettings for PdrWifiParams {
    type Report = PdrWifiReport;

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

    fn start(self) -> Result<Box<dyn Method<Report = PdrWifiReport>>, MethodError> {
        Ok(Box::new(PdrWifi::new(self)?))
    }
}

impl MethodReport for PdrWifiReport {
    fn warnings(&self) -> &[MethodWarning] {
        &self.warnings
    }

    fn nis(&self) -> Option<Nis> {
        let (count, sum) = (self.nis_count, self.nis_sum);
        (count > 0).then_some(Nis { dimension: REPORT_DIMENSION, count, sum })
    }
}
