//! Settings of `marg-ins`: one default for everybody, every value documented with its unit.

use super::NAME;
use crate::inertial::filter::SensorNoise;
use crate::magnetic::gate::{MagneticGateParams, ReferenceField};
use crate::methods::foot_input::Site;
use crate::methods::foot_ins::{RestGravityParams, ZeroRateParams};
use crate::methods::{MethodError, NoiseParameter};
use crate::pedestrian::stance::StanceParams;
use crate::pedestrian::stance_updates::ZeroVelocityParams;
use crate::settings::{first_unusable, not_negative, positive};
use serde::{Deserialize, Serialize};

/// Settings of [`super::MargIns`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MargInsParams {
    /// Gravity at the site, m/s².
    pub gravity_m_s2: f64,
    /// Time at the start of the log over which the sensor is levelled and its heading taken, s.
    pub alignment_s: f64,
    /// Angle from true to magnetic north, positive to the east, rad.
    pub declination_rad: f64,
    /// Longest gap between samples that is integrated over, s; after a longer one the walker counts as lost.
    pub gap_s: f64,
    /// Time without an accepted zero-velocity update after which the walker counts as lost, s.
    pub lost_after_s: f64,
    /// Correlation time `1/β` of the gyro drift, s; its random walk is that of `noise`.
    pub drift_correlation_s: f64,
    /// Mean rate of a resting foot, rad/s, above which it stands on something that turns.
    pub turning_rad_s: f64,
    /// What keeps a disturbed field out.
    pub magnetic_gate: GateKind,
    /// Stance detector.
    pub stance: StanceParams,
    /// Sensor errors.
    pub noise: SensorNoise,
    /// Uncertainty at the start.
    pub initial: StartParams,
    /// Zero velocity in stance.
    pub zero_velocity: ZeroVelocityParams,
    /// Zero angular rate at rest.
    pub zero_rate: ZeroRateParams,
    /// Tilt of `q(ε)`: the accelerometer near rest.
    pub rest_gravity: RestGravityParams,
    /// Heading of `q(ε)`: the magnetometer.
    pub heading: HeadingParams,
}

/// What keeps a disturbed field out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GateKind {
    /// Nothing, as in the paper: every reading is believed.
    None,
    /// Norm, dip and agreement with the gyro ([`crate::magnetic::gate`]).
    #[default]
    Disturbance,
}

/// Standard deviations at the start; that of the heading follows from `heading`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct StartParams {
    /// Roll and pitch, rad.
    pub tilt_rad: f64,
    /// Velocity, m/s.
    pub velocity_m_s: f64,
    /// Position, m: small, since the origin is defined by it.
    pub position_m: f64,
    /// Gyro drift beside what the gyro reads at rest, rad/s.
    pub drift_rad_s: f64,
    /// Accelerometer bias, m/s².
    pub acc_bias_m_s2: f64,
    /// Lever from the point of contact to the sensor, m.
    pub contact_m: f64,
}

/// Heading of `q(ε)`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HeadingParams {
    /// Time of a stance that passes before readings count, s: a magnetometer of 10 Hz bandwidth still sees the swing.
    pub settle_s: f64,
    /// Time over which the field of a stance is averaged for one heading, s.
    pub average_s: f64,
    /// Standard deviation of the field across the meridian from place to place, where it is good, µT.
    pub field_sigma_ut: f64,
    /// Hard iron that the calibration of the magnetometer has left, standard deviation of each axis, µT; zero: not estimated.
    pub hard_iron_ut: f64,
    /// Tilt that the filter does not know of, from the bias of the accelerometer, standard deviation, rad.
    pub tilt_sigma_rad: f64,
    /// Distance to the last heading used within which the field is not taken for a new one, m.
    pub place_m: f64,
    /// Greatest normalised innovation squared (1 degree of freedom) of the heading that is believed.
    pub gate_nis: f64,
    /// Norm and dip of the undisturbed field; learnt at the start when it is not given.
    pub reference: Option<ReferenceField>,
    /// Limits around it.
    pub disturbance: MagneticGateParams,
}

/// What tuning may search beside [`foot_input::NOISE`](crate::methods::foot_input::NOISE).
pub(super) const NOISE: [NoiseParameter; 6] = [
    // Turn-on bias from a tactical sensor's to a cheap one's in the cold; the sensor on a toe or above the ankle.
    NoiseParameter::new("initial.drift_rad_s", 1e-6, 0.1),
    NoiseParameter::new("initial.acc_bias_m_s2", 1e-3, 1.0),
    NoiseParameter::new("initial.contact_m", 1e-2, 0.5),
    // A field across the meridian of open country, and one between steel sets.
    NoiseParameter::new("heading.field_sigma_ut", 5e-2, 20.0),
    NoiseParameter::new("heading.hard_iron_ut", 1e-2, 10.0),
    NoiseParameter::new("heading.tilt_sigma_rad", 1e-4, 0.2),
];

impl MargInsParams {
    /// What the alignment needs to know.
    pub(super) fn site(&self) -> Site {
        Site {
            gravity_m_s2: self.gravity_m_s2,
            alignment_s: self.alignment_s,
            declination_rad: self.declination_rad,
        }
    }

    /// Checks that every number is in its range.
    pub(super) fn check(&self) -> Result<(), MethodError> {
        let (i, h, d) = (&self.initial, &self.heading, &self.heading.disturbance);
        let checks = [
            ("gravity_m_s2", positive(self.gravity_m_s2)),
            ("alignment_s", not_negative(self.alignment_s)),
            ("declination_rad", self.declination_rad.is_finite()),
            ("gap_s", positive(self.gap_s)),
            ("lost_after_s", positive(self.lost_after_s)),
            ("turning_rad_s", not_negative(self.turning_rad_s)),
            ("drift_correlation_s", positive(self.drift_correlation_s)),
            ("initial.tilt_rad", positive(i.tilt_rad)),
            ("initial.velocity_m_s", positive(i.velocity_m_s)),
            ("initial.position_m", positive(i.position_m)),
            ("initial.drift_rad_s", positive(i.drift_rad_s)),
            ("initial.acc_bias_m_s2", not_negative(i.acc_bias_m_s2)),
            ("initial.contact_m", not_negative(i.contact_m)),
            ("heading.settle_s", not_negative(h.settle_s)),
            ("heading.average_s", not_negative(h.average_s)),
            ("heading.field_sigma_ut", positive(h.field_sigma_ut)),
            ("heading.hard_iron_ut", not_negative(h.hard_iron_ut)),
            ("heading.tilt_sigma_rad", not_negative(h.tilt_sigma_rad)),
            ("heading.place_m", not_negative(h.place_m)),
            ("heading.gate_nis", positive(h.gate_nis)),
            ("heading.reference.norm_ut", h.reference.is_none_or(|r| positive(r.norm_ut))),
            ("heading.reference.dip_rad", h.reference.is_none_or(|r| r.dip_rad.is_finite())),
            ("heading.disturbance.norm_share", positive(d.norm_share)),
            ("heading.disturbance.dip_rad", positive(d.dip_rad)),
            ("heading.disturbance.settle_s", not_negative(d.settle_s)),
            ("heading.disturbance.steady_heading_rad", positive(d.steady_heading_rad)),
            ("heading.disturbance.relearn_m", positive(d.relearn_m)),
        ];
        let name = first_unusable(&checks)
            .or_else(|| self.stance.unusable())
            .or_else(|| self.noise.unusable())
            .or_else(|| self.zero_velocity.unusable())
            .or_else(|| self.zero_rate.unusable())
            .or_else(|| self.rest_gravity.unusable());
        match name {
            Some(name) => Err(MethodError::Setting { method: NAME, name }),
            None => Ok(()),
        }
    }
}

impl Default for MargInsParams {
    fn default() -> Self {
        Self {
            gravity_m_s2: 9.80665,
            alignment_s: 0.5,
            declination_rad: 0.0,
            gap_s: 0.25,
            lost_after_s: 10.0,
            drift_correlation_s: 1000.0,
            turning_rad_s: 0.02,
            magnetic_gate: GateKind::Disturbance,
            stance: StanceParams::default(),
            noise: SensorNoise::default(),
            initial: StartParams::default(),
            zero_velocity: ZeroVelocityParams::default(),
            zero_rate: ZeroRateParams::default(),
            rest_gravity: RestGravityParams::default(),
            heading: HeadingParams::default(),
        }
    }
}

impl Default for StartParams {
    fn default() -> Self {
        Self {
            tilt_rad: 0.04,
            velocity_m_s: 0.01,
            position_m: 1e-4,
            drift_rad_s: 2.2e-3,
            acc_bias_m_s2: 0.3,
            contact_m: 0.2,
        }
    }
}

impl Default for HeadingParams {
    fn default() -> Self {
        Self {
            settle_s: 0.1,
            average_s: 0.05,
            field_sigma_ut: 0.8,
            hard_iron_ut: 0.6,
            tilt_sigma_rad: 0.01,
            place_m: 5.0,
            gate_nis: 6.6,
            reference: None,
            disturbance: MagneticGateParams::default(),
        }
    }
}
