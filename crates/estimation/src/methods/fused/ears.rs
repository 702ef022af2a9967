//! What hears at a site, made once: walkers take copies, which share all that belongs to the site (anchors, transmitters, maps of the radio).

use super::NAME;
use super::params::FusedParams;
use super::signals::Signals;
use crate::methods::MethodError;
use crate::methods::pdr::PdrRadio;
use crate::methods::pdr::radio::RadioFixes;
use crate::radio::RadioSite;
use crate::radio::site::Reader;
use crate::ranging::listener::{RangeListener, RangesParams};
use alloc::sync::Arc;

/// Listeners that have heard nothing yet.
#[derive(Debug, Clone, PartialEq)]
pub struct Ears {
    of: Option<(Arc<RadioSite>, RangesParams, PdrRadio)>,
    pub(super) ranges: Option<RangeListener>,
    pub(super) radio: Option<RadioFixes>,
    pub(super) signals: Option<Signals>,
    pub(super) readers: Arc<[Reader]>,
}

impl Ears {
    /// Those of the settings: the ones that they hold, or new ones where settings have changed since.
    pub fn new(params: &FusedParams) -> Result<Arc<Self>, MethodError> {
        match &params.ears {
            Some(ears) if ears.is_of(params) => Ok(Arc::clone(ears)),
            _ => Ok(Arc::new(Self::made(params)?)),
        }
    }

    fn is_of(&self, params: &FusedParams) -> bool {
        match (&self.of, &params.site) {
            (Some((site, ranges, radio)), Some(now)) => {
                Arc::ptr_eq(site, now) && *ranges == params.ranges && *radio == params.steps.radio
            }
            (of, now) => of.is_none() && now.is_none(),
        }
    }

    fn made(params: &FusedParams) -> Result<Self, MethodError> {
        let site = params.site.as_deref();
        let ranges = site
            .filter(|site| !site.anchors.is_empty())
            .map(|site| RangeListener::new(NAME, Some(site), params.ranges.clone()))
            .transpose()?;
        let known = site.is_some_and(RadioSite::has_signals);
        let mut steps = params.steps.clone();
        steps.site.clone_from(&params.site);
        Ok(Self {
            of: params.site.clone().map(|site| (site, params.ranges.clone(), params.steps.radio)),
            ranges,
            radio: if known { RadioFixes::new(&steps)? } else { None },
            signals: site.and_then(|site| Signals::new(site, &params.steps.radio)),
            readers: site.map(|site| site.readers.as_slice().into()).unwrap_or_default(),
        })
    }
}
