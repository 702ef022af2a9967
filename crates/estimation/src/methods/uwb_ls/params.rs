//! Settings of `uwb-ls`.

use crate::radio::RadioSite;
use crate::ranging::listener::RangesParams;
use crate::ranging::solver::SolverParams;
use alloc::sync::Arc;
use serde::{Deserialize, Serialize};

/// Settings of [`UwbLs`](super::UwbLs).
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct UwbLsParams {
    /// Which ranges, and how they are gathered.
    pub ranges: RangesParams,
    /// How positions are made of them.
    pub solver: SolverParams,
    /// The anchors of the site.
    #[serde(skip)]
    pub site: Option<Arc<RadioSite>>,
}
