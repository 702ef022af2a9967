//! The walk of `kind = "roadway-walk"`: a level walk on the rotating Earth, position fixes, and what is told of the start.

use super::{Run, Scenario};
use adit_core::geodesy::{Geodetic, meridian_radius_m, prime_vertical_radius_m};
use adit_observation::sidecar::Sidecar;
use adit_observation::{FixSource, Site, StartPose};
use adit_simulation::{
    FixModel, RoadwayGenerator, RoadwayPlan, RoadwayRanges, RoadwayWalk, StartErrors, ToldStart,
};
use anyhow::Result;
use serde::Deserialize;

const MINUTES_IN_DEGREE: f64 = 60.0;

/// The table `[roadway]`.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoadwayEntry {
    site: Site,
    duration_s: f64,
    speed_m_s: [f64; 2],
    straight_m: [f64; 2],
    turn_deg: [f64; 2],
    stop_probability: f64,
    stop_s: [f64; 2],
    speed_change_s: f64,
    turn_s: f64,
    fix: FixEntry,
    start: StartEntry,
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct FixEntry {
    every_s: f64,
    sigma_m: f64,
    #[serde(default)]
    source: FixSource,
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct StartEntry {
    /// Of latitude and of longitude, minutes of arc.
    position_arcmin: f64,
    attitude_deg: f64,
}

impl Scenario {
    /// Puts sensors and fixes on a walk along roadways.
    pub(super) fn roadway_walk(&self, seed: u64) -> Result<Run> {
        let entries = &self.entries;
        self.only(&["roadway"])?;
        let spanned = self.needed("roadway", entries.roadway.as_ref())?;
        let entry = spanned.get_ref();
        let refused = |error| self.source.refused(&spanned.span(), &error);
        let wrong_site = "the site is no place on Earth, or lies at a pole: latitude -89 to 89, longitude -360 to 360 degrees";
        let origin = entry.site.point().ok_or_else(|| self.source.error(&spanned.span(), wrong_site))?;

        let plan = RoadwayPlan::random(&entry.ranges(), seed).map_err(refused)?;
        let walk = RoadwayWalk::new(&plan, origin, entry.duration_s).map_err(refused)?;
        let (errors, _) = self.sensor()?;
        let (fixes, start) = (entry.fixes(), entry.start_errors(&origin));
        let rate_hz = self.rate_hz()?;
        let generator =
            RoadwayGenerator::new(walk, &errors, rate_hz, fixes, &start, seed).map_err(refused)?;
        let sidecar = Sidecar {
            rate_hz: Some(rate_hz),
            noise: Some(errors.specification()),
            site: Some(entry.site),
            start: Some(told(generator.told(), &start)),
            ..Sidecar::default()
        };
        Ok(Run { duration_s: entry.duration_s, sidecar: Some(sidecar), emissions: Box::new(generator) })
    }
}

impl RoadwayEntry {
    fn ranges(&self) -> RoadwayRanges {
        RoadwayRanges {
            duration_s: self.duration_s,
            speed_m_s: self.speed_m_s,
            straight_m: self.straight_m,
            turn_rad: self.turn_deg.map(f64::to_radians),
            stop_probability: self.stop_probability,
            stop_s: self.stop_s,
            speed_change_s: self.speed_change_s,
            turn_s: self.turn_s,
        }
    }

    fn fixes(&self) -> FixModel {
        let FixEntry { every_s, sigma_m, source } = self.fix;
        FixModel { every_s, sigma_m, source }
    }

    fn start_errors(&self, origin: &Geodetic) -> StartErrors {
        let angle = (self.start.position_arcmin / MINUTES_IN_DEGREE).to_radians();
        let parallel_m = prime_vertical_radius_m(origin.latitude_rad) * origin.latitude_rad.cos();
        StartErrors {
            position_m: [angle * parallel_m, angle * meridian_radius_m(origin.latitude_rad)],
            attitude_rad: self.start.attitude_deg.to_radians(),
        }
    }
}

/// A told start as a sidecar has it.
pub(super) fn told(start: &ToldStart, errors: &StartErrors) -> StartPose {
    let [heading_deg, pitch_deg, roll_deg] = StartPose::angles_deg(&start.attitude);
    StartPose {
        position_m: start.position_m.into(),
        position_sigma_m: errors.position_m,
        heading_deg,
        pitch_deg,
        roll_deg,
        attitude_sigma_deg: errors.attitude_rad.to_degrees(),
    }
}
