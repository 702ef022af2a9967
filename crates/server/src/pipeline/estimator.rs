//! A method at work for one tag, whichever it is.

use super::hearing::Sums;
use adit_core::solution::Solution;
use adit_estimation::methods::foot_ins::{FootIns, FootInsParams};
use adit_estimation::methods::fused::{Fused, FusedParams};
use adit_estimation::methods::marg_ins::{MargIns, MargInsParams};
use adit_estimation::methods::pdr::{Pdr, PdrParams};
use adit_estimation::methods::pdr_wifi::{PdrWifi, PdrWifiParams};
use adit_estimation::methods::uwb_filter::{UwbAekfParams, UwbEkfParams, UwbFilter, UwbRkfParams};
use adit_estimation::methods::uwb_ls::{UwbLs, UwbLsParams};
use adit_estimation::methods::uwb_pdr::{UwbPdr, UwbPdrParams};
use adit_estimation::methods::wifi::{Wifi, WifiParams};
use adit_estimation::methods::{Method, MethodError, MethodReport, MethodSettings};
use adit_estimation::weighed::SourceWeighed;
use adit_observation::Observation;
use serde::{Deserialize, Serialize};

macro_rules! estimators {
    ($($(#[$doc:meta])+ $name:ident: $params:ident makes $method:ident;)+) => {
        /// The settings of a method.
        #[derive(Debug, Clone)]
        pub enum Settings {
            $($(#[$doc])+ $name(Box<$params>),)+
        }

        $(impl From<$params> for Settings {
            fn from(params: $params) -> Self {
                Self::$name(Box::new(params))
            }
        })+

        impl Settings {
            /// Name of the method.
            pub fn name(&self) -> &'static str {
                match self {
                    $(Self::$name(_) => <$params as MethodSettings>::NAME,)+
                }
            }
        }

        /// A method at work.
        #[derive(Debug, Clone, Serialize, Deserialize)]
        pub enum Estimator {
            $($(#[$doc])+ $name(Box<$method>),)+
        }

        impl Estimator {
            /// Starts it.
            pub fn start(settings: &Settings) -> Result<Self, MethodError> {
                Ok(match settings {
                    $(Settings::$name(params) => Self::$name(Box::new($method::new(params.as_ref().clone())?)),)+
                })
            }

            /// One observation in, at most one solution out; further ones come with [`Self::next_due`].
            #[inline]
            pub fn observe(&mut self, observation: &Observation) -> Result<Option<Solution>, MethodError> {
                match self {
                    $(Self::$name(method) => Method::observe(method.as_mut(), observation),)+
                }
            }

            /// A further solution that is due, if any.
            #[inline]
            pub fn next_due(&mut self) -> Result<Option<Solution>, MethodError> {
                match self {
                    $(Self::$name(method) => Method::next_due(method.as_mut()),)+
                }
            }

            /// What it has weighed since its start.
            pub fn sums(&self) -> Sums {
                match self {
                    $(Self::$name(method) => sums_of(Method::report(method.as_ref())),)+
                }
            }

            /// The last innovation of each anchor and transmitter, of methods that hold them one by one.
            pub fn last_weighed(&self) -> Vec<SourceWeighed> {
                match self {
                    $(Self::$name(method) => Method::last_weighed(method.as_ref()),)+
                }
            }

            /// What it says about its run, as JSON.
            pub fn details(&self) -> serde_json::Value {
                let report = match self {
                    $(Self::$name(method) => serde_json::to_value(Method::report(method.as_ref())),)+
                };
                report.unwrap_or_default()
            }
        }
    };
}

estimators! {
    /// Everything at hand.
    Fused: FusedParams makes Fused;
    /// Inertial on the foot.
    FootIns: FootInsParams makes FootIns;
    /// The same with a magnetometer.
    MargIns: MargInsParams makes MargIns;
    /// Steps.
    Pdr: PdrParams makes Pdr;
    /// Steps and signal strengths, system S1.
    PdrWifi: PdrWifiParams makes PdrWifi;
    /// Signal strengths.
    Wifi: WifiParams makes Wifi;
    /// Ranges, epoch by epoch.
    UwbLs: UwbLsParams makes UwbLs;
    /// Ranges and steps, system S4.
    UwbPdr: UwbPdrParams makes UwbPdr;
    /// Ranges in a Kalman filter.
    UwbEkf: UwbEkfParams makes UwbFilter;
    /// The same, robust.
    UwbRkf: UwbRkfParams makes UwbFilter;
    /// The same, adaptive.
    UwbAekf: UwbAekfParams makes UwbFilter;
}

fn sums_of(report: &impl MethodReport) -> Sums {
    let (nis, freedom) = report.nis().map_or((0.0, 0), |nis| (nis.sum, nis.count * nis.dimension as u64));
    Sums { nis, freedom, outliers: report.outliers() }
}

impl Estimator {
    /// Without what all tags of a site have in common: to be kept, and to go on after [`Self::attach`].
    #[must_use]
    pub fn detached(self) -> Self {
        match self {
            Self::Fused(fused) => Self::Fused(Box::new(fused.detached())),
            // They keep all that they need.
            other => other,
        }
    }

    /// Gives an estimator that was read back its site again.
    pub fn attach(&mut self, settings: &Settings) -> Result<(), MethodError> {
        match (self, settings) {
            (Self::Fused(fused), Settings::Fused(params)) => fused.attach(params),
            // They keep all that they need.
            _ => Ok(()),
        }
    }
}
