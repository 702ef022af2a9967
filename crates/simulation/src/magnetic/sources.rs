//! Steel and currents. Equations and limits: head of [`crate::magnetic`].

use super::{Course, EarthField, largest_along};
use crate::error::{SimulationError, check_within};
use crate::motion::Motion;
use adit_core::nalgebra::Vector3;

/// `μ₀/4π`, µT·m/A.
const MU0_OVER_4PI: f64 = 0.1;
/// `1/μ₀`, (A/m)/µT.
const A_M_PER_UT: f64 = 1.0 / (4.0 * core::f64::consts::PI * MU0_OVER_4PI);
/// Largest moment: a locomotive is below 1e5 A·m².
const LARGEST_MOMENT_A_M2: f64 = 1e8;

/// A steel body as a uniformly magnetised sphere: a dipole outside.
#[derive(Debug, Clone, PartialEq)]
pub struct SteelBody {
    /// Where it is.
    pub course: Course,
    /// Permanent moment, in the body's axes (x forward along the course, y left, z up), A·m².
    pub permanent_a_m2: Vector3<f64>,
    /// Apparent volume `V` of the moment `V B_earth/μ₀` that the Earth's field induces in it, m³. A massive sphere of
    /// iron has three times its own volume (Jackson 1999, §5.11); a hollow car less than its outline.
    pub induced_m3: f64,
    /// Radius of the sphere, m.
    pub radius_m: f64,
}

impl SteelBody {
    /// A body with a permanent moment, body axes, A·m², and a radius of 0.3 m.
    pub fn new(course: Course, permanent_a_m2: Vector3<f64>) -> Self {
        Self { course, permanent_a_m2, induced_m3: 0.0, radius_m: 0.3 }
    }

    /// Made stronger or weaker so that its field is `field_ut` at `distance_m` on the axis of its moment, where it is
    /// largest; square to it, it is half. The course's first direction counts.
    pub fn with_field_at(
        self,
        earth: &EarthField,
        field_ut: f64,
        distance_m: f64,
    ) -> Result<Self, SimulationError> {
        check_within("distance_m", distance_m, 0.01, 1000.0, "0.01 to 1000 m")?;
        let (_, yaw_rad) = self.course.pose(f64::NEG_INFINITY);
        let moment_a_m2 = self.moment_a_m2(earth, yaw_rad).norm();
        let now_ut = 2.0 * MU0_OVER_4PI * moment_a_m2 / cubed(distance_m);
        self.scaled("field_ut", field_ut, now_ut)
    }

    /// Made stronger or weaker so that the largest field that the sensor of `motion` meets, looked for in steps of 5 ms and
    /// then of 0.1 ms, is `field_ut`.
    pub fn with_peak_along(
        self,
        earth: &EarthField,
        field_ut: f64,
        motion: &impl Motion,
    ) -> Result<Self, SimulationError> {
        let now_ut = largest_along(&self, earth, motion);
        self.scaled("peak_at_sensor_ut", field_ut, now_ut)
    }

    fn scaled(mut self, name: &'static str, wanted_ut: f64, now_ut: f64) -> Result<Self, SimulationError> {
        check_within(name, wanted_ut, 0.0, 1e6, "0 to 1e6 µT")?;
        let gain = wanted_ut / now_ut;
        if !gain.is_finite() {
            let expected = "a direction to make stronger: moment_a_m2 or induced_m3 above 0";
            return Err(SimulationError::Parameter { name: "moment_a_m2", found: 0.0, expected });
        }
        self.permanent_a_m2 *= gain;
        self.induced_m3 *= gain;
        self.check()?;
        Ok(self)
    }

    /// Permanent and induced moment in ENU for a body whose x axis points to `yaw_rad`, A·m².
    fn moment_a_m2(&self, earth: &EarthField, yaw_rad: f64) -> Vector3<f64> {
        let (sin, cos) = libm::sincos(yaw_rad);
        let p = self.permanent_a_m2;
        let permanent = Vector3::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y, p.z);
        permanent + earth.enu_ut() * (self.induced_m3 * A_M_PER_UT)
    }

    /// Its field at a place and time, ENU, µT.
    pub fn field_ut(&self, earth: &EarthField, position_m: &Vector3<f64>, time_s: f64) -> Vector3<f64> {
        let (centre_m, yaw_rad) = self.course.pose(time_s);
        let moment = self.moment_a_m2(earth, yaw_rad);
        let from_centre = position_m - centre_m;
        let distance_m = from_centre.norm();
        if distance_m < self.radius_m {
            return moment * (2.0 * MU0_OVER_4PI / cubed(self.radius_m));
        }
        let towards = from_centre / distance_m;
        (towards * (3.0 * moment.dot(&towards)) - moment) * (MU0_OVER_4PI / cubed(distance_m))
    }

    /// Moment and size are those of a body.
    pub fn check(&self) -> Result<(), SimulationError> {
        let (low, high) = (-LARGEST_MOMENT_A_M2, LARGEST_MOMENT_A_M2);
        for moment in self.permanent_a_m2.iter() {
            check_within("moment_a_m2", *moment, low, high, "-1e8 to 1e8 A·m²")?;
        }
        check_within("induced_m3", self.induced_m3, 0.0, 1e6, "0 to 1e6 m³")?;
        check_within("radius_m", self.radius_m, 0.001, 100.0, "0.001 to 100 m")
    }
}

fn cubed(x: f64) -> f64 {
    x * x * x
}

/// A straight conductor without end: `B = μ₀ I/2πr`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cable {
    /// A point of its axis, ENU, m.
    pub through_m: Vector3<f64>,
    /// Direction in which the current counts as positive, ENU; any length above 0.
    pub along: Vector3<f64>,
    /// Current: direct, or the amplitude of an alternating one (√2 times its effective value), A.
    pub current_a: f64,
    /// Frequency, Hz; 0 is direct current.
    pub frequency_hz: f64,
    /// Radius of the conductor, m: inside it the field falls evenly to 0 at the axis.
    pub radius_m: f64,
}

impl Cable {
    /// A bare trolley wire of 1 cm with a direct current, A.
    pub fn direct(through_m: Vector3<f64>, along: Vector3<f64>, current_a: f64) -> Self {
        Self { through_m, along, current_a, frequency_hz: 0.0, radius_m: 0.01 }
    }

    /// Its field at a place and time, ENU, µT.
    pub fn field_ut(&self, position_m: &Vector3<f64>, time_s: f64) -> Vector3<f64> {
        let axis = self.along.normalize();
        let from_cable = position_m - self.through_m;
        let outwards = from_cable - axis * axis.dot(&from_cable);
        let current_a = self.current_a * libm::cos(core::f64::consts::TAU * self.frequency_hz * time_s);
        // Right-hand rule: the field goes around the current.
        axis.cross(&outwards)
            * (2.0 * MU0_OVER_4PI * current_a / outwards.norm_squared().max(self.radius_m * self.radius_m))
    }

    /// Direction and current are those of a cable.
    pub fn check(&self) -> Result<(), SimulationError> {
        let far = |v: &Vector3<f64>| v.amax();
        check_within("through_m", far(&self.through_m), 0.0, 1e5, "-100 to 100 km")?;
        check_within("along", self.along.norm(), 1e-6, 1e6, "a direction of length 1e-6 to 1e6")?;
        check_within("current_a", self.current_a, -1e6, 1e6, "-1e6 to 1e6 A")?;
        check_within("frequency_hz", self.frequency_hz, 0.0, 1e4, "0 to 10 kHz")?;
        check_within("radius_m", self.radius_m, 1e-4, 10.0, "0.0001 to 10 m")
    }
}
