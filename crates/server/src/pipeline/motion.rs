//! Whether who wears a tag moves, by what its inertial sensors feel: for alarms that must not hang on a position alone.
//!
//! Per packet: the standard deviations of the norm of the specific force and of the angular rate. Who walks shakes a tag by 2 to 4 m/s²; on a table it is the
//! sensor's noise, some 0.01 to 0.05; who lies and breathes is below 0.1. Who works on one spot shakes it by 0.12 to 0.36 only, but turns
//! the trunk by 0.14 to 0.7 rad/s, who stands by 0.01 to 0.03 (simulated work and standing at the belt, MPU-6050, seconds of two minutes). A tag whose mounting is
//! declared and whose axis of the body is more than [`LYING_DEG`] from the vertical while it is still lies: fallen.

use adit_core::nalgebra::Vector3;
use adit_observation::Observation;
use adit_tracking::Motion;

/// Above this standard deviation somebody moves, m/s².
pub const MOVING_M_S2: f64 = 0.25;
/// Above this one of the angular rate somebody moves too, rad/s.
pub const TURNING_RAD_S: f64 = 0.1;
/// From here on from the vertical a body lies, deg.
pub const LYING_DEG: f64 = 60.0;
/// Readings that make a judgement.
const FEWEST: u32 = 10;

/// What the accelerometer of a packet says; `None` without one. `upright` tells that the z axis is that of a standing body.
pub fn of_packet<'a>(observations: impl Iterator<Item = &'a Observation>, upright: bool) -> Option<Motion> {
    let (mut count, mut mean, mut squares) = (0_u32, 0.0, 0.0);
    let mut sum = Vector3::zeros();
    let (mut turns, mut mean_rate, mut rate_squares) = (0_u32, Vector3::zeros(), 0.0);
    for observation in observations {
        let force = match observation {
            Observation::Imu(sample) => {
                turns += 1;
                let off: Vector3<f64> = sample.angular_rate_rad_s - mean_rate;
                mean_rate += off / f64::from(turns);
                rate_squares += off.dot(&(sample.angular_rate_rad_s - mean_rate));
                sample.specific_force_m_s2
            }
            Observation::Acceleration(sample) => sample.specific_force_m_s2,
            _ => continue,
        };
        // Welford (1962).
        count += 1;
        let norm = force.norm();
        let off = norm - mean;
        mean += off / f64::from(count);
        squares += off * (norm - mean);
        sum += force;
    }
    if count < FEWEST {
        return None;
    }
    let turns_rad_s = (rate_squares / f64::from(turns.max(1))).sqrt();
    if (squares / f64::from(count)).sqrt() > MOVING_M_S2 || turns_rad_s > TURNING_RAD_S {
        return Some(Motion::Moving);
    }
    let inclination_deg = (sum.z / sum.norm()).clamp(-1.0, 1.0).acos().to_degrees();
    Some(if upright && inclination_deg > LYING_DEG { Motion::Fallen } else { Motion::Still })
}

#[cfg(test)]
mod tests {
    use super::*;
    use adit_core::time::Time;
    use adit_observation::{AccelerationSample, ImuSample};

    fn packet(force: impl Fn(f64) -> Vector3<f64>) -> Vec<Observation> {
        let sample = |i: i32| {
            let time = Time::from_nanos(i64::from(i) * 10_000_000);
            Observation::Acceleration(AccelerationSample { time, specific_force_m_s2: force(f64::from(i)) })
        };
        (0..100).map(sample).collect()
    }

    #[test]
    fn a_walk_moves_a_table_is_still_and_who_lies_has_fallen() {
        let walk = packet(|i| Vector3::new(0.0, 0.0, 9.81 + 3.0 * (0.12 * i).sin()));
        let table = packet(|i| Vector3::new(0.02 * (1.7 * i).sin(), 0.0, 9.81 + 0.03 * (2.3 * i).cos()));
        let lies = packet(|i| Vector3::new(9.7, 0.5, 0.4 + 0.03 * (2.3 * i).cos()));
        assert_eq!(of_packet(walk.iter(), true), Some(Motion::Moving));
        assert_eq!(of_packet(table.iter(), true), Some(Motion::Still));
        assert_eq!(of_packet(lies.iter(), true), Some(Motion::Fallen));
        assert_eq!(of_packet(lies.iter(), false), Some(Motion::Still));
        assert_eq!(of_packet(table[..5].iter(), true), None);
    }

    #[test]
    fn who_works_on_one_spot_moves_and_who_stands_is_still_whatever_the_gyro_reads_at_rest() {
        let packet = |swing_rad_s: f64| {
            let sample = |i: i32| {
                let time = Time::from_nanos(i64::from(i) * 10_000_000);
                let specific_force_m_s2 = Vector3::new(0.1, 0.0, 9.81 + 0.15 * (0.1 * f64::from(i)).sin());
                let angular_rate_rad_s = Vector3::new(0.2, swing_rad_s * (0.1 * f64::from(i)).cos(), 0.0);
                Observation::Imu(ImuSample { time, angular_rate_rad_s, specific_force_m_s2 })
            };
            (0..100).map(sample).collect::<Vec<_>>()
        };
        assert_eq!(of_packet(packet(0.4).iter(), true), Some(Motion::Moving));
        assert_eq!(of_packet(packet(0.03).iter(), true), Some(Motion::Still));
    }
}
