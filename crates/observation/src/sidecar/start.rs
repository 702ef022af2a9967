//! Site and start, checked where they are read.

use crate::start::{Site, StartPose};
use serde::de::Error;
use serde::{Deserialize, Deserializer};

pub(super) fn site<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Site>, D::Error> {
    let site = Site::deserialize(deserializer)?;
    match site.point() {
        Some(_) => Ok(Some(site)),
        None => Err(D::Error::custom(format!(
            "found latitude {}, longitude {}, height {} m, expected -89 to 89 degrees, -360 to 360 degrees, within 20 km",
            site.latitude_deg, site.longitude_deg, site.height_m
        ))),
    }
}

pub(super) fn pose<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<StartPose>, D::Error> {
    let pose = StartPose::deserialize(deserializer)?;
    if pose.is_usable() {
        return Ok(Some(pose));
    }
    Err(D::Error::custom(
        "found a value that is no place, angle or spread, expected finite ones and no spread below zero",
    ))
}
