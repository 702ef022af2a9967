//! What a stream of solutions amounts to, in a few numbers.

use adit_core::nalgebra::Vector3;
use adit_core::solution::Solution;
use adit_core::time::Time;
use adit_evaluation::travel::CHORD_M;

/// Sums up solutions as they pass, in bounded memory.
#[derive(Debug, Clone, Default)]
pub struct Journey {
    span: Option<(Solution, Solution)>,
    last_chord_m: Vector3<f64>,
    distance_m: f64,
    poses: u64,
}

impl Journey {
    /// Adds the next solution.
    pub fn push(&mut self, solution: &Solution) {
        self.poses += 1;
        let here = solution.position_m;
        match &mut self.span {
            None => {
                self.span = Some((solution.clone(), solution.clone()));
                self.last_chord_m = here;
            }
            Some((_, latest)) => latest.clone_from(solution),
        }
        // As adit_evaluation::travel::chord_length_m, one position at a time.
        let chord_m = (here - self.last_chord_m).xy().norm();
        if chord_m >= CHORD_M {
            self.distance_m += chord_m;
            self.last_chord_m = here;
        }
    }

    /// Number of solutions.
    pub fn poses(&self) -> u64 {
        self.poses
    }

    /// Time from the first solution to the last, s.
    pub fn duration_s(&self) -> f64 {
        self.span.as_ref().map_or(0.0, |(first, last)| (last.time - first.time).seconds())
    }

    /// Times of the first and the last solution.
    pub fn times(&self) -> Option<(Time, Time)> {
        self.span.as_ref().map(|(first, last)| (first.time, last.time))
    }

    /// Horizontal distance travelled, on chords of 0.25 m, m.
    pub fn distance_m(&self) -> f64 {
        self.distance_m
    }

    /// From the first position to the last, m.
    pub fn end_from_start_m(&self) -> Vector3<f64> {
        self.span.as_ref().map_or_else(Vector3::zeros, |(first, last)| last.position_m - first.position_m)
    }

    /// Radius that holds the last position with 95 % probability, as the method states it, m.
    pub fn radius_95_m(&self) -> Option<f64> {
        self.span.as_ref().map(|(_, last)| last.radius_95_m())
    }

    /// Standard deviation of the last heading, as the method states it, rad.
    pub fn heading_sigma_rad(&self) -> Option<f64> {
        self.span.as_ref().map(|(_, last)| last.covariance[(8, 8)].sqrt())
    }

    /// Standard deviation of the last inclination (angle between true and estimated vertical), rad.
    pub fn inclination_sigma_rad(&self) -> Option<f64> {
        self.span.as_ref().map(|(_, last)| (last.covariance[(6, 6)] + last.covariance[(7, 7)]).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use adit_core::attitude::Attitude;
    use adit_core::solution::{Quality, SolutionCovariance};
    use adit_evaluation::travel::chord_length_m;

    #[test]
    fn the_distance_is_that_of_the_evaluation() {
        let positions: Vec<Vector3<f64>> = (0..1000)
            .map(|i| f64::from(i) * 0.02)
            .map(|s| Vector3::new(s.sin() * 3.0, s + 0.05 * (20.0 * s).cos(), s.cos()))
            .collect();
        let mut journey = Journey::default();
        for (i, position_m) in (0..).zip(&positions) {
            journey.push(&Solution {
                time: Time::from_nanos(i * 5_000_000),
                position_m: *position_m,
                velocity_m_s: Vector3::zeros(),
                attitude: Attitude::identity(),
                covariance: SolutionCovariance::identity(),
                quality: Quality::DeadReckoning,
            });
        }
        assert!((journey.distance_m() - chord_length_m(&positions)).abs() < 1e-12);
        assert_eq!(journey.poses(), 1000);
        assert!((journey.duration_s() - 4.995).abs() < 1e-12);
        assert_eq!(journey.end_from_start_m(), positions[999] - positions[0]);
    }
}
