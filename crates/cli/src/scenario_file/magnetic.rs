//! The magnetic part of a scenario file: the Earth's field, steel, cables, and the magnetometer that reads them.

use super::{Preset, Source, named};
use adit_core::nalgebra::Vector3;
use adit_simulation::{
    Cable, Course, EarthField, FootWalk, MagneticWorld, MagnetometerModel, Motion, Move, SimulationError,
    SteelBody, Tumble,
};
use anyhow::Result;
use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Spanned;

/// The table `[magnetic]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Magnetic {
    /// Name of the magnetometer.
    sensor: Spanned<String>,
    /// Samples per second, in place of the sensor's own.
    rate_hz: Option<Spanned<f64>>,
    /// Hard iron of the tag, µT, magnetometer axes.
    hard_iron_ut: Option<Spanned<[f64; 3]>>,
    /// Soft iron of the tag, row by row.
    soft_iron: Option<Spanned<[[f64; 3]; 3]>>,
    /// The field of the site.
    field: Option<Spanned<Field>>,
    /// Bodies of steel.
    #[serde(default)]
    steel: Vec<Spanned<Steel>>,
    /// Conductors.
    #[serde(default)]
    cables: Vec<Spanned<Conductor>>,
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Field {
    norm_ut: f64,
    dip_deg: f64,
    declination_deg: f64,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Steel {
    at_m: Option<[f64; 3]>,
    start_s: Option<f64>,
    #[serde(default)]
    course: Vec<Move>,
    beside: Option<Beside>,
    moment_a_m2: Option<[f64; 3]>,
    induced_m3: Option<f64>,
    peak_at_sensor_ut: Option<f64>,
    peak: Option<Peak>,
    radius_m: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Beside {
    offset_m: [f64; 3],
    from_s: f64,
    until_s: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Peak {
    field_ut: f64,
    distance_m: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Conductor {
    through_m: [f64; 3],
    along: [f64; 3],
    current_a: f64,
    #[serde(default)]
    frequency_hz: f64,
    radius_m: Option<f64>,
}

const MAGNETOMETERS: [Preset<MagnetometerModel>; 5] = [
    ("ideal", MagnetometerModel::ideal),
    ("xsens-mti-g", MagnetometerModel::xsens_mti_g),
    ("hmc5883l", MagnetometerModel::hmc5883l),
    ("ak8963", MagnetometerModel::ak8963),
    ("adis16448", MagnetometerModel::adis16448),
];

impl Magnetic {
    /// The magnetometer: a preset or one of the file's, with the changes of this table.
    pub fn magnetometer(
        &self,
        own: &BTreeMap<String, Spanned<MagnetometerModel>>,
        source: &Source,
    ) -> Result<MagnetometerModel> {
        let mut model = named("magnetometer", &self.sensor, own, &MAGNETOMETERS, source)?;
        let check =
            |model: &MagnetometerModel, span| model.check().map_err(|error| source.refused(&span, &error));
        check(&model, own.get(self.sensor.get_ref()).map_or_else(|| self.sensor.span(), Spanned::span))?;
        if let Some(rate_hz) = &self.rate_hz {
            model.rate_hz = *rate_hz.get_ref();
            check(&model, rate_hz.span())?;
        }
        if let Some(hard_iron) = &self.hard_iron_ut {
            model.hard_iron_ut = *hard_iron.get_ref();
            check(&model, hard_iron.span())?;
        }
        if let Some(soft_iron) = &self.soft_iron {
            model.soft_iron = *soft_iron.get_ref();
            check(&model, soft_iron.span())?;
        }
        Ok(model)
    }

    /// The world of many motions.
    pub fn standing_world(&self, source: &Source) -> Result<MagneticWorld> {
        for steel in &self.steel {
            if steel.get_ref().peak_at_sensor_ut.is_some() {
                let what = "peak_at_sensor_ut is that of one sensor, here are many: give peak = { field_ut, distance_m }";
                return Err(source.error(&steel.span(), what));
            }
        }
        self.world(&Tumble::still(1.0, 1.0), None, source)
    }

    /// The world around a motion; `walk` is that motion when somebody walks.
    pub fn world(
        &self,
        motion: &impl Motion,
        walk: Option<&FootWalk>,
        source: &Source,
    ) -> Result<MagneticWorld> {
        let mut world = MagneticWorld::undisturbed(EarthField::default());
        if let Some(field) = &self.field {
            let Field { norm_ut, dip_deg, declination_deg } = *field.get_ref();
            let (dip_rad, declination_rad) = (dip_deg.to_radians(), declination_deg.to_radians());
            world.earth = EarthField { norm_ut, dip_rad, declination_rad };
            world.earth.check().map_err(|error| source.refused(&field.span(), &error))?;
        }
        for entry in &self.steel {
            let steel = entry.get_ref();
            if let Some(what) = steel.contradiction(walk.is_some()) {
                return Err(source.error(&entry.span(), what));
            }
            let body = steel.body(&world.earth, motion, walk);
            world.steel.push(body.map_err(|error| source.refused(&entry.span(), &error))?);
        }
        for entry in &self.cables {
            let cable = entry.get_ref().cable();
            cable.check().map_err(|error| source.refused(&entry.span(), &error))?;
            world.cables.push(cable);
        }
        Ok(world)
    }
}

impl Steel {
    /// What is missing or said twice.
    fn contradiction(&self, walking: bool) -> Option<&'static str> {
        let moving = !self.course.is_empty() || self.start_s.is_some();
        match (&self.at_m, &self.beside) {
            (None, None) => {
                return Some(
                    "steel needs a place: at_m = [east, north, up], or beside = { offset_m, from_s, until_s }",
                );
            }
            (Some(_), Some(_)) => return Some("steel is at_m or beside the walker, not both: remove one"),
            (None, Some(_)) if moving => {
                return Some("steel beside the walker has no course of its own: remove course and start_s");
            }
            (None, Some(_)) if !walking => {
                return Some("nobody walks here: give at_m = [east, north, up] in place of beside");
            }
            _ => {}
        }
        if self.moment_a_m2.is_none() && self.induced_m3.is_none() {
            return Some("steel needs a moment: moment_a_m2 = [forward, left, up], or induced_m3");
        }
        if self.peak_at_sensor_ut.is_some() && self.peak.is_some() {
            return Some("steel has one strength: remove peak or peak_at_sensor_ut");
        }
        None
    }

    fn body(
        &self,
        earth: &EarthField,
        motion: &impl Motion,
        walk: Option<&FootWalk>,
    ) -> Result<SteelBody, SimulationError> {
        let course = match (&self.beside, walk) {
            (Some(beside), Some(walk)) => {
                Course::beside(walk, beside.offset_m, beside.from_s, beside.until_s)?
            }
            _ => Course::moving(self.at_m.unwrap_or_default(), self.start_s.unwrap_or(0.0), &self.course)?,
        };
        let mut body = SteelBody::new(course, Vector3::from(self.moment_a_m2.unwrap_or_default()));
        body.induced_m3 = self.induced_m3.unwrap_or(body.induced_m3);
        body.radius_m = self.radius_m.unwrap_or(body.radius_m);
        body.check()?;
        if let Some(Peak { field_ut, distance_m }) = self.peak {
            body = body.with_field_at(earth, field_ut, distance_m)?;
        }
        if let Some(peak_ut) = self.peak_at_sensor_ut {
            body = body.with_peak_along(earth, peak_ut, motion)?;
        }
        Ok(body)
    }
}

impl Conductor {
    fn cable(&self) -> Cable {
        let direct = Cable::direct(Vector3::from(self.through_m), Vector3::from(self.along), self.current_a);
        Cable {
            frequency_hz: self.frequency_hz,
            radius_m: self.radius_m.unwrap_or(direct.radius_m),
            ..direct
        }
    }
}
