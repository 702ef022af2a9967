//! Settings of `fused`: one default for every tag and every mine; a sidecar tells where a tag is worn.

use super::ears::Ears;
use crate::methods::Worn;
use crate::methods::ahrs::AhrsParams;
use crate::methods::foot_ins::FootInsParams;
use crate::methods::ins_wifi::InsWifiParams;
use crate::methods::marg_ins::MargInsParams;
use crate::methods::pdr::PdrParams;
use crate::methods::uwb_filter::UwbRkfParams;
use crate::methods::wifi::WifiParams;
use crate::place::params::{CarrierNoise, PlaceParams};
use crate::radio::RadioSite;
use crate::ranging::listener::RangesParams;
use crate::ranging::solver::SolverParams;
use adit_observation::StartPose;
use alloc::sync::Arc;
use serde::{Deserialize, Serialize};

/// Settings of [`super::Fused`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FusedParams {
    /// Where the tag is worn; absent: the log tells.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub worn: Option<Worn>,
    /// The magnetometer of a tag on a foot is calibrated, so that its heading counts; a sidecar that has the declination or the field of the site tells.
    pub compass: bool,
    /// Pose at the first inertial sample, where somebody knows it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start: Option<StartPose>,
    /// What is beside the carrier.
    pub place: PlaceParams,
    /// How the strapdown on a foot errs.
    pub foot_noise: CarrierNoise,
    /// How steps err.
    pub steps_noise: CarrierNoise,
    /// Ranges beside a carrier.
    pub ranges: RangesParams,
    /// Positions of them at the start and after a loss.
    pub solver: SolverParams,
    /// The strapdown on a foot.
    pub foot: FootInsParams,
    /// The same with a magnetometer.
    pub marg: MargInsParams,
    /// Steps; `steps.radio` tells how signal strengths are used beside any carrier.
    pub steps: PdrParams,
    /// Strapdown between fixes, of a sensor too slow for steps.
    pub strapdown: InsWifiParams,
    /// Attitude of what nobody wears.
    pub attitude: AhrsParams,
    /// Ranges alone.
    pub ranges_alone: UwbRkfParams,
    /// Signal strengths alone.
    pub signals_alone: WifiParams,
    /// The site: anchors, transmitters, portals, roadways.
    #[serde(skip)]
    pub site: Option<Arc<RadioSite>>,
    /// What was made of the site already: walkers started from clones of these settings share it. Made by `at_site`.
    #[serde(skip)]
    pub ears: Option<Arc<Ears>>,
}

impl Default for FusedParams {
    fn default() -> Self {
        Self {
            worn: None,
            compass: false,
            start: None,
            place: PlaceParams::default(),
            foot_noise: CarrierNoise::FOOT,
            steps_noise: CarrierNoise::STEPS,
            ranges: RangesParams::default(),
            solver: SolverParams::default(),
            foot: FootInsParams::default(),
            marg: MargInsParams::default(),
            steps: PdrParams::default(),
            strapdown: InsWifiParams::default(),
            attitude: AhrsParams::default(),
            ranges_alone: UwbRkfParams::default(),
            signals_alone: WifiParams::default(),
            site: None,
            ears: None,
        }
    }
}

impl FusedParams {
    /// The first setting that cannot be worked with, by name; those of the parts are theirs.
    pub(super) fn unusable(&self) -> Option<&'static str> {
        let start = self.start.is_none_or(|start| start.is_usable());
        (!start)
            .then_some("start")
            .or_else(|| self.place.unusable())
            .or_else(|| self.foot_noise.unusable())
            .or_else(|| self.steps_noise.unusable())
            .or_else(|| self.solver.unusable())
    }
}
