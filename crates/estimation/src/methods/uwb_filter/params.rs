//! Settings of `uwb-ekf`, `uwb-rkf` and `uwb-aekf`: one filter, three weightings.

use crate::methods::pdr::PdrParams;
use crate::radio::RadioSite;
use crate::ranging::filter::FilterParams;
use crate::ranging::filter::weighting::{Weighting, WeightingKind};
use crate::ranging::listener::RangesParams;
use alloc::sync::Arc;
use core::fmt::Debug;
use core::marker::PhantomData;
use serde::{Deserialize, Serialize};

/// Which of the three: its name and its weighting.
pub trait Variant: Debug + Clone + Copy + Default + PartialEq + 'static {
    /// Name of the method.
    const NAME: &'static str;
    /// Rule of the weighting where none is set.
    const KIND: WeightingKind;
}

/// Extended Kalman filter: what the gate lets in counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Plain;
/// Robust Kalman filter: the farther off, the less a range counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Robust;
/// Adaptive Kalman filter: noise that follows the innovations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Adaptive;

impl Variant for Plain {
    const NAME: &'static str = "uwb-ekf";
    const KIND: WeightingKind = WeightingKind::Equal;
}

impl Variant for Robust {
    const NAME: &'static str = "uwb-rkf";
    const KIND: WeightingKind = WeightingKind::Igg3;
}

impl Variant for Adaptive {
    const NAME: &'static str = "uwb-aekf";
    const KIND: WeightingKind = WeightingKind::Adaptive;
}

/// Settings of `uwb-ekf`.
pub type UwbEkfParams = UwbFilterParams<Plain>;
/// Settings of `uwb-rkf`.
pub type UwbRkfParams = UwbFilterParams<Robust>;
/// Settings of `uwb-aekf`.
pub type UwbAekfParams = UwbFilterParams<Adaptive>;

/// Settings of a filter on ranges.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, bound = "")]
pub struct UwbFilterParams<V: Variant> {
    /// Which ranges, and how they are gathered.
    pub ranges: RangesParams,
    /// Dead reckoning by steps instead of the motion of anybody; absent: no sensor of the tag is used.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steps: Option<PdrParams>,
    /// How late ranges are stamped, s: the place is that of so long before.
    pub latency_s: f64,
    /// The filter.
    pub filter: FilterParams,
    /// How much each range counts.
    pub weighting: Weighting,
    /// The anchors of the site.
    #[serde(skip)]
    pub site: Option<Arc<RadioSite>>,
    #[serde(skip)]
    /// Which of the three.
    pub variant: PhantomData<V>,
}

impl<V: Variant> Default for UwbFilterParams<V> {
    fn default() -> Self {
        Self {
            // Noise, and what passes: both are told apart in the filter.
            ranges: RangesParams { sigma_m: 0.08, ..RangesParams::default() },
            steps: None,
            latency_s: 0.0,
            filter: FilterParams::default(),
            weighting: Weighting { kind: V::KIND, ..Weighting::default() },
            site: None,
            variant: PhantomData,
        }
    }
}
