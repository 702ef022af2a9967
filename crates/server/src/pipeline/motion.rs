//! Whether who wears a tag moves, by what its accelerometer feels: for alarms that must not hang on a position alone.
//!
//! Per packet: the standard deviation of the norm of the specific force. Who walks shakes a tag by 2 to 4 m/s², who works by
//! some tenths and more; on a table it is the sensor's noise, some 0.01 to 0.05; who lies and breathes is below 0.1. A tag whose mounting is declared
//! and whose axis of the body is more than [`LYING_DEG`] from the vertical while it is still lies: fallen.

use adit_core::nalgebra::Vector3;
use adit_observation::Observation;
use adit_tracking::Motion;

/// Above this standard deviation somebody moves, m/s².
pub const MOVING_M_S2: f64 = 0.25;
/// From here on from the vertical a body lies, deg.
pub const LYING_DEG: f64 = 60.0;
/// Readings that make a judgement.
const FEWEST: u32 = 10;

/// What the accelerometer of a packet says; `None` without one. `upright` tells that the z axis is that of a standing body.
pub fn of_packet<'a>(observations: impl Iterator<Item = &'a Observation>, upright: bool) -> Option<Motion> {
    let (mut count, mut mean, mut squares) = (0_u32, 0.0, 0.0);
    let mut sum = Vector3::zeros();
    for observation in observations {
        let force = match observation {
            Observation::Imu(sample) => sample.specific_force_m_s2,
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
    if (squares / f64::from(count)).sqrt() > MOVING_M_S2 {
        return Some(Motion::Moving);
    }
    let inclination_deg = (sum.z / sum.norm()).clamp(-1.0, 1.0).acos().to_degrees();
    Some(if upright && inclination_deg > LYING_DEG { Motion::Fallen } else { Motion::Still })
}

#[cfg(test)]
mod tests {
    use super::*;
    use adit_core::time::Time;
    use adit_observation::AccelerationSample;

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
}
