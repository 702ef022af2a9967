//! NEES and NIS against published bounds, scipy and a Monte Carlo draw from the model itself.

#![expect(clippy::unwrap_used, reason = "a test that cannot make its input has failed")]

use adit_core::attitude::{self, Attitude};
use adit_core::nalgebra::{Matrix2, Matrix3, SMatrix, Vector2, Vector3};
use adit_core::solution::{Quality, Solution, SolutionCovariance};
use adit_core::time::Time;
use adit_core::trajectory::{Pose, Trajectory};
use adit_evaluation::alignment::{Alignment, RigidMotion};
use adit_evaluation::consistency::{
    AverageNees, average_nees_bounds, normalised_squared_error, solution_error, solution_nees,
};
use adit_evaluation::{EvaluationError, EvaluationOptions, evaluate_solutions};

/// Standard normal draws: a splitmix64 counter through Box–Muller, so that the tests need no random number crate.
struct Normal(u64);

impl Normal {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn draw(&mut self) -> f64 {
        (-2.0 * (1.0 - self.uniform()).ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }

    fn vector(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.draw())
    }
}

#[test]
fn bounds_equal_those_of_scipy() {
    // scipy.stats.chi2.ppf(tail, d * n) / n, scipy 1.17
    for (dimension, runs, probability, lower, upper) in [
        (1, 1, 0.95, 0.000_982_069_117_175_258_3, 5.023_886_187_314_888),
        (2, 50, 0.95, 1.484_438_549_498_474_6, 2.591_223_943_716_731_7),
        (3, 1, 0.95, 0.215_795_282_623_897_93, 9.348_403_604_496_148),
        (3, 100, 0.95, 2.539_123_226_024_897_5, 3.498_744_688_299_152_6),
        (9, 50, 0.99, 7.529_667_016_194_44, 10.620_525_466_664_747),
        (15, 200, 0.95, 14.250_424_682_598_965, 15.768_517_467_994_906),
        (6, 1, 0.999, 0.299_407_699_846_329, 24.102_798_994_983_747),
    ] {
        let bounds = average_nees_bounds(dimension, runs, probability).unwrap();
        // statrs iterates on its own cumulative function, itself good to some 1e-12.
        assert!((bounds.lower - lower).abs() < 1e-9 && (bounds.upper - upper).abs() < 1e-9, "{bounds:?}");
    }
}

#[test]
fn bounds_equal_the_printed_ones_of_bar_shalom() {
    // Bar-Shalom, Li & Kirubarajan 2001, §5.4.2: 50 runs, 2 states, 95 %: [1.5, 2.6].
    let bounds = average_nees_bounds(2, 50, 0.95).unwrap();
    assert!((bounds.lower - 1.5).abs() < 0.05 && (bounds.upper - 2.6).abs() < 0.05);
}

#[test]
fn bounds_refuse_what_has_no_meaning() {
    for (dimension, runs, probability) in
        [(0, 5, 0.95), (3, 0, 0.95), (3, 5, 0.0), (3, 5, 1.0), (3, 5, f64::NAN)]
    {
        let refused = average_nees_bounds(dimension, runs, probability);
        assert!(matches!(refused, Err(EvaluationError::OutOfRange { .. })), "{refused:?}");
    }
}

#[test]
fn a_matrix_that_is_no_covariance_is_refused() {
    let refused = normalised_squared_error(&Vector2::new(1.0, 1.0), &Matrix2::new(1.0, 2.0, 2.0, 1.0));
    assert_eq!(refused, Err(EvaluationError::NotPositiveDefinite { index: 0, dimension: 2 }));
}

fn mixing() -> Matrix3<f64> {
    Matrix3::new(0.3, 0.0, 0.0, 0.2, 0.1, 0.0, -0.1, 0.05, 0.4)
}

/// Share of samples inside 95 % bounds when the stated covariance is `inflation` times the true one.
fn share_inside(inflation: f64) -> AverageNees {
    let mut normal = Normal(7);
    let stated = mixing() * mixing().transpose() * inflation;
    let mut run = || {
        (0..400).map(|_| normalised_squared_error(&(mixing() * normal.vector()), &stated).unwrap()).collect()
    };
    let runs: Vec<Vec<f64>> = (0..50).map(|_| run()).collect();
    AverageNees::over_runs(3, &runs, 0.95).unwrap()
}

#[test]
fn an_honest_covariance_lies_inside_its_bounds() {
    let nees = share_inside(1.0);
    // 20 000 samples of χ²(3): mean 3 ± 0.017; share 0.95 ± 0.011 over 400 bounds; three sigma each.
    assert!((nees.mean - 3.0).abs() < 0.052, "{}", nees.mean);
    assert!((nees.share_inside - 0.95).abs() < 0.033, "{}", nees.share_inside);
}

#[test]
fn a_boast_and_a_bluff_are_found_out() {
    for (inflation, mean) in [(0.5, 6.0), (2.0, 1.5)] {
        let nees = share_inside(inflation);
        assert!((nees.mean - mean).abs() < 0.11, "{}", nees.mean);
        assert!(nees.share_inside < 0.05, "{}", nees.share_inside);
    }
}

#[test]
fn runs_of_unequal_length_are_refused() {
    let refused = AverageNees::over_runs(3, &[vec![1.0, 2.0], vec![1.0]], 0.95);
    assert_eq!(refused, Err(EvaluationError::RunsDiffer { run: 1, found: 1, expected: 2 }));
}

fn true_pose(i: i64) -> Pose {
    let s = i as f64 * 0.05;
    Pose {
        time: Time::from_nanos(i * 50_000_000),
        position_m: Vector3::new(8.0 * (0.3 * s).sin(), 1.2 * s, 0.5 * (0.2 * s).cos()),
        attitude: attitude::exp(&Vector3::new(0.1 * s.sin(), 0.05, 0.3 * s)),
    }
}

/// Solutions whose errors are drawn from the covariance they state, seen from a frame turned by `motion` backwards.
fn honest_solutions(motion: &RigidMotion) -> (Vec<Solution>, Trajectory) {
    let mut normal = Normal(11);
    let truth: Vec<Pose> = (0..2000).map(true_pose).collect();
    let back = motion.rotation.inverse();
    let solutions = truth.iter().map(|pose| {
        let (position, attitude) = (mixing() * normal.vector(), 0.05 * normal.vector());
        let mut covariance = SolutionCovariance::identity();
        let turned: Matrix3<f64> = (back.to_rotation_matrix() * mixing() * mixing().transpose())
            * back.inverse().to_rotation_matrix();
        covariance.fixed_view_mut::<3, 3>(0, 0).copy_from(&turned);
        covariance.fixed_view_mut::<3, 3>(6, 6).fill_diagonal(0.0025);
        Solution {
            time: pose.time,
            position_m: back * (pose.position_m - position - motion.to_m) + motion.from_m,
            velocity_m_s: Vector3::zeros(),
            attitude: back * attitude::exp(&attitude).inverse() * pose.attitude,
            covariance,
            quality: Quality::DeadReckoning,
        }
    });
    (solutions.collect(), Trajectory::new(truth.clone()).unwrap())
}

#[test]
fn solutions_drawn_from_their_covariance_are_consistent_in_any_frame() {
    let motion = RigidMotion {
        rotation: attitude::exp(&Vector3::new(0.5, -0.9, 1.3)),
        from_m: Vector3::new(3.0, 1.0, -2.0),
        to_m: Vector3::new(500.0, -40.0, 12.0),
    };
    let (solutions, truth) = honest_solutions(&motion);
    let nees = solution_nees(&solutions, &truth, &motion, true, 0.95).unwrap();
    for (part, dimension) in [(nees.horizontal, 2.0), (nees.position, 3.0), (nees.attitude, 3.0)] {
        let part = part.unwrap();
        // 2 000 independent samples: mean d ± √(2d/2000), three sigma.
        assert!((part.mean - dimension).abs() < 3.0 * (2.0 * dimension / 2000.0_f64).sqrt(), "{part:?}");
        assert!((part.share_inside - 0.95).abs() < 0.015, "{part:?}");
    }
}

#[test]
fn a_report_of_solutions_carries_nees_and_one_without_covariance_does_not() {
    let (mut solutions, truth) = honest_solutions(&RigidMotion::identity());
    let options = EvaluationOptions { alignment: Alignment::None, ..EvaluationOptions::default() };
    let nees = evaluate_solutions(&solutions, &truth, &options).unwrap().report.nees.unwrap();
    assert_eq!(nees.position.unwrap().samples, 2000);
    for solution in &mut solutions {
        solution.covariance = SolutionCovariance::zeros();
    }
    assert_eq!(evaluate_solutions(&solutions, &truth, &options).unwrap().report.nees, None);
}

#[test]
fn the_error_of_a_solution_has_the_blocks_of_its_covariance() {
    let turn = Vector3::new(0.01, -0.02, 0.3);
    let truth = Pose { attitude: attitude::exp(&turn), ..true_pose(0) };
    let solution = Solution {
        time: truth.time,
        position_m: truth.position_m - Vector3::new(1.0, 2.0, 3.0),
        velocity_m_s: Vector3::new(0.5, 0.0, 0.0),
        attitude: Attitude::identity(),
        covariance: SMatrix::identity(),
        quality: Quality::Fixed,
    };
    let error = solution_error(&solution, &truth, &Vector3::new(0.75, 0.0, 0.25));
    let expected = [1.0, 2.0, 3.0, 0.25, 0.0, 0.25, 0.01, -0.02, 0.3];
    for (found, expected) in error.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-14, "{error}");
    }
}
