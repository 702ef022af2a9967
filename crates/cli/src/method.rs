//! The methods by name: the one place where the command line meets the estimation crate.
//!
//! A new method is a name here and an arm of [`with_settings!`]; everything else is the business of its
//! [`MethodSettings`].

use crate::config;
use adit_estimation::magnetic::gate::ReferenceField;
use adit_estimation::methods::{
    Estimates, Known, MethodReport, MethodSettings, MethodWarning, NoiseParameter, RadioUse, Worn,
};
use adit_observation::sidecar::{Location, Sidecar};
use anyhow::{Context, Result};
use clap::ValueEnum;
use serde::Deserialize;
use std::path::Path;

/// How to position.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MethodName {
    /// Everything at hand in one estimator: foot or body, ranges, signal strengths, barometer, portals, roadways
    Fused,
    /// Inertial sensor on the foot: zero velocity whenever the foot stands; no infrastructure
    FootIns,
    /// Inertial sensor and magnetometer on the foot: as foot-ins, heading by the field where it is undisturbed
    MargIns,
    /// One gyro, two accelerometers and position fixes on a level walk: ten error states; needs a start
    ReducedInsWifi,
    /// Six axes and position fixes: eighteen error states; needs a start
    FullInsWifi,
    /// Steps of a tag worn at the waist, in a pocket or in the hand, their length and direction; position fixes where there are
    Pdr,
    /// Positions by signal strength alone; needs --mine or --radio
    Wifi,
    /// Steps of a tag at the waist and positions by signal strength, as system S1 joins them; needs --mine or --radio
    PdrWifi,
    /// Positions by ranges alone, one epoch of them at a time; needs --mine
    UwbLs,
    /// UWB ranges and steps of a tag at the waist, weighed by what is in the way, as system S4 joins them; needs --mine
    UwbPdr,
    /// UWB ranges in an extended Kalman filter that finds offsets of the anchors; needs --mine
    UwbEkf,
    /// The same, robust: the farther off a range is, the less it counts; needs --mine
    UwbRkf,
    /// The same, adaptive: noise that follows the innovations; needs --mine
    UwbAekf,
    /// Attitude alone, of a tag worn anywhere: gyro, accelerometer and, where there is one, magnetometer
    Ahrs,
}

/// Evaluates an expression in which `$settings` is the type of the settings of the method of that name.
macro_rules! with_settings {
    ($name:expr, $settings:ident => $body:expr) => {
        match $name {
            $crate::method::MethodName::Fused => {
                type $settings = adit_estimation::methods::fused::FusedParams;
                $body
            }
            $crate::method::MethodName::FootIns => {
                type $settings = adit_estimation::methods::foot_ins::FootInsParams;
                $body
            }
            $crate::method::MethodName::MargIns => {
                type $settings = adit_estimation::methods::marg_ins::MargInsParams;
                $body
            }
            $crate::method::MethodName::ReducedInsWifi => {
                type $settings = adit_estimation::methods::ins_wifi::ReducedInsWifiParams;
                $body
            }
            $crate::method::MethodName::FullInsWifi => {
                type $settings = adit_estimation::methods::ins_wifi::FullInsWifiParams;
                $body
            }
            $crate::method::MethodName::Pdr => {
                type $settings = adit_estimation::methods::pdr::PdrParams;
                $body
            }
            $crate::method::MethodName::Wifi => {
                type $settings = adit_estimation::methods::wifi::WifiParams;
                $body
            }
            $crate::method::MethodName::PdrWifi => {
                type $settings = adit_estimation::methods::pdr_wifi::PdrWifiParams;
                $body
            }
            $crate::method::MethodName::UwbLs => {
                type $settings = adit_estimation::methods::uwb_ls::UwbLsParams;
                $body
            }
            $crate::method::MethodName::UwbPdr => {
                type $settings = adit_estimation::methods::uwb_pdr::UwbPdrParams;
                $body
            }
            $crate::method::MethodName::UwbEkf => {
                type $settings = adit_estimation::methods::uwb_filter::UwbEkfParams;
                $body
            }
            $crate::method::MethodName::UwbRkf => {
                type $settings = adit_estimation::methods::uwb_filter::UwbRkfParams;
                $body
            }
            $crate::method::MethodName::UwbAekf => {
                type $settings = adit_estimation::methods::uwb_filter::UwbAekfParams;
                $body
            }
            $crate::method::MethodName::Ahrs => {
                type $settings = adit_estimation::methods::ahrs::AhrsParams;
                $body
            }
        }
    };
}
pub(crate) use with_settings;

impl MethodName {
    /// As on the command line.
    pub fn name(self) -> &'static str {
        with_settings!(self, S => S::NAME)
    }

    /// Whether it smooths over a fixed lag.
    pub fn has_fixed_lag(self) -> bool {
        with_settings!(self, S => S::FIXED_LAG)
    }

    /// Whether it smooths over the whole log.
    pub fn has_whole_log(self) -> bool {
        with_settings!(self, S => S::WHOLE_LOG)
    }

    /// Whether it estimates positions, not attitude alone.
    pub fn estimates_path(self) -> bool {
        with_settings!(self, S => S::ESTIMATES != Estimates::Attitude)
    }

    /// What it does with the radio of a site.
    pub fn radio(self) -> RadioUse {
        with_settings!(self, S => S::RADIO)
    }

    /// The settings that tuning may search.
    pub fn noise_parameters(self) -> impl Iterator<Item = &'static NoiseParameter> {
        with_settings!(self, S => S::NOISE).iter().copied().flatten()
    }

    /// What a sidecar says that does not suit the method.
    pub fn objection(self, sidecar: &Sidecar) -> Option<String> {
        match (self, sidecar.mounting.location) {
            (Self::Pdr | Self::PdrWifi | Self::UwbPdr, Some(Location::Foot)) => Some(format!(
                "the sidecar puts the sensor on the foot, {} expects it above the knee",
                self.name()
            )),
            (_, None | Some(Location::Foot))
            | (
                Self::Fused
                | Self::Pdr
                | Self::Wifi
                | Self::PdrWifi
                | Self::UwbLs
                | Self::UwbPdr
                | Self::UwbEkf
                | Self::UwbRkf
                | Self::UwbAekf
                | Self::Ahrs
                | Self::ReducedInsWifi
                | Self::FullInsWifi,
                _,
            ) => None,
            (Self::FootIns | Self::MargIns, Some(other)) => {
                let (place, name) = (other.name(), self.name());
                Some(format!("the sidecar puts the sensor at \"{place}\", {name} expects it on the foot"))
            }
        }
    }
}

/// Settings of a method: the defaults, over them what a sidecar knows, over these what a TOML file says.
pub fn settings<S: MethodSettings>(sidecar: Option<&Sidecar>, config: Option<&Path>) -> Result<S> {
    let settings = knowing::<S>(sidecar);
    config.map_or_else(|| Ok(settings.clone()), |path| config::overlay(&settings, path))
}

/// Settings of a method: the defaults, and over them what a sidecar knows.
pub fn knowing<S: MethodSettings>(sidecar: Option<&Sidecar>) -> S {
    sidecar.map_or_else(S::default, |sidecar| S::default().knowing(&known(sidecar)))
}

fn known(sidecar: &Sidecar) -> Known {
    Known {
        specification: sidecar.noise,
        declination_rad: sidecar.frame.magnetic_declination_deg.map(f64::to_radians),
        field: reference_field(sidecar),
        site: sidecar.site,
        start: sidecar.start,
        mounted: sidecar.mounting.rotation.is_some(),
        worn: sidecar.mounting.location.and_then(worn),
    }
}

/// On a foot, elsewhere on the body, or on no body.
fn worn(location: Location) -> Option<Worn> {
    match location {
        Location::Foot => Some(Worn::Foot),
        Location::Vehicle | Location::Other => None,
        _ => Some(Worn::Body),
    }
}

/// Norm and dip of the field where the sidecar has both.
fn reference_field(sidecar: &Sidecar) -> Option<ReferenceField> {
    let field = &sidecar.magnetic_field;
    Some(ReferenceField { norm_ut: field.norm_ut?, dip_rad: field.dip_deg?.to_radians() })
}

/// A method's own report as JSON.
pub fn details(report: &impl MethodReport) -> Result<serde_json::Value> {
    serde_json::to_value(report.details()).context("the report of the method cannot be written")
}

/// One line for each kind of warning: the log itself has told of every gap already.
pub fn warnings(warnings: &[MethodWarning]) -> Vec<String> {
    let is_gap = |warning: &&MethodWarning| matches!(warning, MethodWarning::Gap { .. });
    let gaps = warnings.iter().filter(is_gap).count();
    let others = warnings.iter().filter(|warning| !is_gap(warning)).map(MethodWarning::text);
    let first_gap = warnings.iter().find(is_gap).map(|first| match gaps {
        1 => first.text(),
        _ => format!("{} ({gaps} gaps, this is the first)", first.text()),
    });
    others.chain(first_gap).collect()
}
