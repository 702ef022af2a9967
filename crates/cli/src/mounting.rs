//! Is the tag worn the way its sidecar says?
//!
//! The body frame is x forward, y left, z up. Where a sidecar declares the rotation from sensor to body, the specific force
//! at rest has to point up in body axes, as far as the part of the body allows; a tag worn upside down or sideways would
//! otherwise give a wrong heading without a word. Without a declared rotation there is nothing to contradict: the methods
//! level the sensor by gravity, whatever way it is mounted.

use adit_core::nalgebra::Vector3;
use adit_estimation::inertial::rest::{Rest, RestFinder};
use adit_observation::ImuSample;
use adit_observation::sidecar::{AccelerationSign, Location, MountingRotation, Sidecar};

/// Standard gravity, m/s².
const GRAVITY_M_S2: f64 = 9.80665;
/// Tilt from which on a sensor is called upside down, deg.
const UPSIDE_DOWN_DEG: f64 = 135.0;
/// Where the part of the body says nothing of how it is held, only upside down is refused, deg.
const LOOSE_DEG: f64 = 120.0;

/// Watches one log.
#[derive(Debug, Clone)]
pub struct MountingCheck {
    rotation: MountingRotation,
    acceleration: AccelerationSign,
    location: Option<Location>,
    largest_deg: f64,
    rests: RestFinder,
    confirmed: bool,
    turned_over: bool,
}

/// What a sample shows.
#[derive(Debug, Clone, PartialEq)]
pub enum Finding {
    /// Nothing against the mounting.
    Fits,
    /// The first rest contradicts the mounting: why.
    Refused(String),
    /// A later rest contradicts what the first confirmed: how. Told once.
    TurnedOver(String),
}

impl MountingCheck {
    /// A check where the sidecar declares a rotation, and its location is not one that points anywhere.
    pub fn of(sidecar: &Sidecar) -> Option<Self> {
        let location = sidecar.mounting.location;
        Some(Self {
            rotation: sidecar.mounting.rotation?,
            acceleration: sidecar.frame.acceleration,
            location,
            largest_deg: largest_tilt_deg(location)?,
            rests: RestFinder::default(),
            confirmed: false,
            turned_over: false,
        })
    }

    /// Takes a sample in body axes.
    pub fn observe(&mut self, sample: &ImuSample) -> Finding {
        let Some(Rest { time, specific_force_m_s2 }) = self.rests.observe(sample, GRAVITY_M_S2) else {
            return Finding::Fits;
        };
        let tilt_deg = specific_force_m_s2.angle(&Vector3::z()).to_degrees();
        if tilt_deg <= self.largest_deg {
            self.confirmed = true;
            return Finding::Fits;
        }
        let at_s = time.seconds();
        if !self.confirmed {
            return Finding::Refused(self.refusal(&specific_force_m_s2, tilt_deg, at_s));
        }
        if self.turned_over {
            return Finding::Fits;
        }
        self.turned_over = true;
        let how = "worn as declared before, the sensor has turned over";
        Finding::TurnedOver(format!("at {at_s:.2} s the body's up is {tilt_deg:.0}° off the vertical: {how}"))
    }

    fn refusal(&self, force: &Vector3<f64>, tilt_deg: f64, at_s: f64) -> String {
        let way = if tilt_deg > UPSIDE_DOWN_DEG { "upside down" } else { "sideways" };
        let place = self
            .location
            .map_or_else(String::new, |l| format!(" at the {}", format!("{l:?}").to_lowercase()));
        let sensor_up = self.rotation.matrix().transpose() * force;
        let (axis, points) = vertical_axis(&sensor_up);
        let mut text = format!(
            "the sensor is worn {way}: with the rotation \"{declared}\" of its sidecar, gravity at rest (at {at_s:.2} s) puts the \
             body's up {tilt_deg:.0}° off the vertical, expected at most {largest:.0}°{place}; the sensor's {axis} axis points \
             {points}: rotation = \"{fitting}\" would fit",
            declared = self.rotation,
            largest = self.largest_deg,
            fitting = self.fitting(&sensor_up),
        );
        if tilt_deg > UPSIDE_DOWN_DEG {
            text += match self.acceleration {
                AccelerationSign::SpecificForce => {
                    ", or acceleration = \"gravity\" if this log's accelerometer reads down at rest"
                }
                AccelerationSign::Gravity => {
                    ", or acceleration = \"specific-force\" if this log's accelerometer reads up at rest"
                }
            };
        }
        text
    }

    /// The rotation along the axes that levels the sensor and leaves forward, then left, most as declared: gravity cannot
    /// tell which way a level sensor faces.
    fn fitting(&self, sensor_up: &Vector3<f64>) -> MountingRotation {
        let up = sensor_up.normalize();
        let declared = self.rotation.matrix();
        let score = |candidate: &MountingRotation| {
            let m = candidate.matrix();
            let kept = |axis: usize| m.row(axis).dot(&declared.row(axis));
            100.0 * (m * up).z + 10.0 * kept(0) + kept(1)
        };
        let best = MountingRotation::along_axes().max_by(|a, b| score(a).total_cmp(&score(b)));
        best.unwrap_or(self.rotation)
    }
}

/// The sensor axis nearest to the vertical, and where it points.
fn vertical_axis(sensor_up: &Vector3<f64>) -> (&'static str, &'static str) {
    let axis = sensor_up.iamax();
    (["x", "y", "z"][axis], if sensor_up[axis] > 0.0 { "up" } else { "down" })
}

/// How far the up of a part of the body leans from the vertical when its owner stands, walks or sits, deg; `None` for parts
/// that point anywhere.
fn largest_tilt_deg(location: Option<Location>) -> Option<f64> {
    match location {
        // An instep falls off forward by 20–40°, and feet stand on slopes and sit under chairs; a shin of a sitting person
        // slants by 30°.
        Some(Location::Foot | Location::Shank) => Some(65.0),
        // Trunk and belly lean by 30°, a person working bent by 50°.
        Some(Location::Waist | Location::Chest) => Some(60.0),
        // The steepest drivable slope is about 20°.
        Some(Location::Vehicle) => Some(35.0),
        // A head looks up and down, a sitting person's thigh lies level, and the rest is not said.
        Some(Location::Head | Location::Thigh | Location::Other) | None => Some(LOOSE_DEG),
        Some(Location::Wrist | Location::Hand | Location::Pocket | Location::Bag) => None,
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use adit_core::attitude;
    use adit_core::time::Time;

    fn check(rotation: &str, location: Location) -> MountingCheck {
        let mut sidecar = Sidecar::default();
        sidecar.mounting.rotation = Some(MountingRotation::from_axes(rotation).unwrap());
        sidecar.mounting.location = Some(location);
        MountingCheck::of(&sidecar).unwrap()
    }

    /// The findings of half a second at rest from `start_ms` on, with this specific force in body axes.
    fn rest(check: &mut MountingCheck, start_ms: i64, force: Vector3<f64>) -> Vec<Finding> {
        (0..100)
            .map(|i| ImuSample {
                time: Time::from_nanos((start_ms + 5 * i) * 1_000_000),
                angular_rate_rad_s: Vector3::zeros(),
                specific_force_m_s2: force,
            })
            .map(|sample| check.observe(&sample))
            .filter(|finding| *finding != Finding::Fits)
            .collect()
    }

    #[test]
    fn every_declared_rotation_is_told_which_would_fit_for_every_way_it_is_really_worn() {
        for declared in MountingRotation::along_axes() {
            for worn in MountingRotation::along_axes() {
                let mut check = check(&declared.to_string(), Location::Foot);
                // What the sensor reads, and what the declared rotation makes of it.
                let sensor = worn.matrix().transpose() * Vector3::z() * GRAVITY_M_S2;
                let findings = rest(&mut check, 0, declared.matrix() * sensor);
                if (declared.matrix() * sensor).z > 9.0 {
                    assert!(findings.is_empty(), "{declared} {worn}: {findings:?}");
                    continue;
                }
                let Some(Finding::Refused(why)) = findings.first() else { unreachable!("{declared} {worn}") };
                let quoted = why.split("rotation = \"").nth(1).unwrap().split('"').next().unwrap();
                let fitting = MountingRotation::from_axes(quoted).unwrap();
                assert!((fitting.matrix() * sensor).z > 9.0, "{declared} {worn}: {why}");
                // Forward stays forward unless it is the axis that has become vertical.
                let forward = declared.matrix().transpose() * Vector3::x();
                if forward.dot(&sensor).abs() < 1.0 {
                    assert!((fitting.matrix() * forward).x > 0.9, "{declared} {worn}: {why}");
                }
            }
        }
    }

    #[test]
    fn a_lean_that_the_part_of_the_body_allows_is_no_contradiction() {
        let lean = |deg: f64| {
            attitude::exp(&(Vector3::new(0.6, 0.8, 0.0) * deg.to_radians())) * Vector3::z() * GRAVITY_M_S2
        };
        for (location, allowed_deg, refused_deg) in [
            (Location::Foot, 60.0, 70.0),
            (Location::Waist, 55.0, 65.0),
            (Location::Vehicle, 30.0, 40.0),
            (Location::Head, 115.0, 125.0),
        ] {
            let mut check = check("x-forward, y-left, z-up", location);
            assert!(rest(&mut check.clone(), 0, lean(allowed_deg)).is_empty(), "{location:?}");
            let findings = rest(&mut check, 0, lean(refused_deg));
            assert!(matches!(findings[..], [Finding::Refused(_), ..]), "{location:?}: {findings:?}");
        }
    }

    #[test]
    fn a_hand_and_an_undeclared_rotation_are_not_checked() {
        let mut sidecar = Sidecar::default();
        sidecar.mounting.location = Some(Location::Foot);
        assert!(MountingCheck::of(&sidecar).is_none());
        sidecar.mounting.rotation = Some(MountingRotation::from_axes("x-forward, y-left, z-up").unwrap());
        sidecar.mounting.location = Some(Location::Hand);
        assert!(MountingCheck::of(&sidecar).is_none());
    }

    #[test]
    fn turning_over_later_is_told_once() {
        let mut check = check("x-forward, y-left, z-up", Location::Waist);
        assert!(rest(&mut check, 0, Vector3::z() * GRAVITY_M_S2).is_empty());
        let findings = rest(&mut check, 1000, -Vector3::z() * GRAVITY_M_S2);
        assert!(matches!(&findings[..], [Finding::TurnedOver(how)] if how.contains("180°")), "{findings:?}");
        assert!(rest(&mut check, 2000, -Vector3::z() * GRAVITY_M_S2).is_empty());
    }
}
