//! The covariance in blocks against the same algebra on dense matrices, and its smoother against Rauch–Tung–Striebel.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod support;

use adit_core::nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use adit_estimation::kalman::blocks::{BlockAdjoint, BlockCovariance, BlockUpdate, Coupling};
use adit_estimation::kalman::{Derivative, Linearised};
use support::Draws;

const B: usize = 4;
const N: usize = 3 * B;
type Dense = SMatrix<f64, N, N>;
type State = SVector<f64, N>;

fn dense(covariance: &BlockCovariance<B>) -> Dense {
    let mut out = Dense::zeros();
    for row in 0..B {
        for column in 0..B {
            out.fixed_view_mut::<3, 3>(3 * row, 3 * column).copy_from(covariance.block(row, column));
        }
    }
    out
}

fn couplings(draws: &mut Draws) -> [Coupling; 3] {
    let mut coupling = |to, from| Coupling { to, from, matrix: draws.matrix() * 0.3 };
    [coupling(2, 0), coupling(0, 1), coupling(0, 3)]
}

fn transition(couplings: &[Coupling]) -> Dense {
    couplings.iter().fold(Dense::identity(), |f, coupling| {
        let mut step = Dense::identity();
        step.fixed_view_mut::<3, 3>(3 * coupling.to, 3 * coupling.from).copy_from(&coupling.matrix);
        step * f
    })
}

fn measurement(draws: &mut Draws) -> Linearised<2> {
    Linearised {
        residual: draws.vector(1.0),
        jacobian: [(0, Derivative::Matrix(draws.matrix())), (2, Derivative::Identity)],
        noise: draws.variance(0.5),
    }
}

fn jacobian<const M: usize>(linearised: &Linearised<M>) -> SMatrix<f64, 3, N> {
    let mut h = SMatrix::<f64, 3, N>::zeros();
    for (block, derivative) in &linearised.jacobian {
        h.fixed_view_mut::<3, 3>(0, 3 * block).copy_from(&derivative.matrix());
    }
    h
}

fn initial(draws: &mut Draws) -> BlockCovariance<B> {
    let mut covariance = BlockCovariance::from_variances(&[Vector3::repeat(1.0); B]);
    // Correlated by a step of anything.
    covariance.propagate(&couplings(draws));
    covariance
}

#[test]
fn a_prediction_is_the_congruence_with_the_transition() {
    let mut draws = Draws::new(1);
    for _ in 0..50 {
        let mut covariance = initial(&mut draws);
        let (before, couplings) = (dense(&covariance), couplings(&mut draws));
        covariance.propagate(&couplings);
        let f = transition(&couplings);
        let expected = f * before * f.transpose();
        // A dozen products of numbers of order one.
        assert!((dense(&covariance) - expected).abs().max() < 1e-13);
        assert_eq!(dense(&covariance), dense(&covariance).transpose());
    }
}

#[test]
fn an_update_is_the_one_of_joseph() {
    let mut draws = Draws::new(2);
    for _ in 0..50 {
        let mut covariance = initial(&mut draws);
        let before = dense(&covariance);
        let linearised = measurement(&mut draws);
        let h = jacobian(&linearised);
        let update = covariance.update(linearised.clone(), f64::INFINITY).unwrap();
        let s = h * before * h.transpose() + linearised.noise;
        let gain = before * h.transpose() * s.try_inverse().unwrap();
        let kept = Dense::identity() - gain * h;
        let expected = kept * before * kept.transpose() + gain * linearised.noise * gain.transpose();
        assert!((dense(&covariance) - expected).abs().max() < 1e-13);
        let expected = gain * linearised.residual;
        for (block, correction) in update.correction().iter().enumerate() {
            assert!((correction - expected.fixed_rows::<3>(3 * block)).amax() < 1e-13);
        }
        assert_eq!(dense(&covariance), dense(&covariance).transpose());
    }
}

#[test]
fn an_outlier_weighs_no_more_than_a_value_at_the_bound() {
    let mut draws = Draws::new(3);
    let start = initial(&mut draws);
    let linearised = measurement(&mut draws);
    let pull = |factor: f64| {
        let mut far = linearised.clone();
        far.residual *= factor;
        let update = start.clone().update(far, 9.0).unwrap();
        (update.innovation.accepted, update.correction()[1].norm())
    };
    let nis = start.clone().update(linearised.clone(), f64::INFINITY).unwrap().innovation.nis;
    let at_bound = (9.0 / nis).sqrt();
    let (accepted, bound) = pull(0.999 * at_bound);
    assert!(accepted);
    for factor in [3.0, 10.0, 100.0] {
        let (accepted, pulled) = pull(factor * at_bound);
        assert!(!accepted);
        // The direction of the gain turns a little with the noise; the pull falls with the distance.
        assert!(pulled < 1.2 * bound, "{factor}: {pulled} against {bound}");
    }
}

/// A random linear system, filtered in blocks and smoothed by the adjoint; the same by Rauch–Tung–Striebel on dense
/// matrices (Rauch, Tung & Striebel 1965), which shares nothing with it.
#[test]
fn the_adjoint_smooths_as_rauch_tung_and_striebel_do() {
    struct Step {
        couplings: [Coupling; 3],
        predicted: BlockCovariance<B>,
        filtered: Dense,
        mean_predicted: State,
        mean_filtered: State,
        update: BlockUpdate<B, 2>,
    }
    let mut draws = Draws::new(4);
    let mut covariance = initial(&mut draws);
    let mut mean = State::zeros();
    let mut steps = Vec::new();
    for _ in 0..12 {
        let couplings = couplings(&mut draws);
        covariance.propagate(&couplings);
        for block in 0..B {
            covariance.inflate(block, &(Matrix3::identity() * 0.05));
        }
        mean = transition(&couplings) * mean;
        let (predicted, mean_predicted) = (covariance.clone(), mean);
        let mut linearised = measurement(&mut draws);
        // In the closed loop the residual is what the state at hand leaves.
        linearised.residual -= jacobian(&linearised) * mean;
        let update = covariance.update(linearised, f64::INFINITY).unwrap();
        for (block, correction) in update.correction().iter().enumerate() {
            let mut part = mean.fixed_rows_mut::<3>(3 * block);
            part += correction;
        }
        steps.push(Step {
            couplings,
            predicted,
            filtered: dense(&covariance),
            mean_predicted,
            mean_filtered: mean,
            update,
        });
    }

    let last = steps.len() - 1;
    let mut smoothed = vec![(steps[last].mean_filtered, steps[last].filtered)];
    for k in (0..last).rev() {
        let next = &steps[k + 1];
        let predicted = dense(&next.predicted);
        let gain =
            steps[k].filtered * transition(&next.couplings).transpose() * predicted.try_inverse().unwrap();
        let (later_mean, later) = smoothed[smoothed.len() - 1];
        let now = steps[k].mean_filtered + gain * (later_mean - next.mean_predicted);
        smoothed.push((now, steps[k].filtered + gain * (later - predicted) * gain.transpose()));
    }
    smoothed.reverse();

    let mut adjoint = BlockAdjoint::<B>::default();
    for (step, (mean, covariance)) in steps.iter().zip(&smoothed).rev() {
        adjoint.through_update(&step.update);
        for block in 0..B {
            let ours =
                step.mean_predicted.fixed_rows::<3>(3 * block) + adjoint.correction(&step.predicted, block);
            // The dense smoother inverts a 12×12 matrix at each of twelve steps.
            assert!((ours - mean.fixed_rows::<3>(3 * block)).amax() < 1e-9);
            let theirs = covariance.fixed_view::<3, 3>(3 * block, 3 * block);
            assert!((adjoint.smoothed(&step.predicted, block) - theirs).amax() < 1e-9);
        }
        adjoint.through_prediction(&step.couplings);
    }
}

#[test]
fn what_is_forgotten_has_its_variance_and_no_correlation() {
    let mut covariance = initial(&mut Draws::new(5));
    covariance.forget(0, &[2], 7.0);
    let all = dense(&covariance);
    for other in 0..N {
        let expected = if other == 2 { 7.0 } else { 0.0 };
        assert!((all[(2, other)] - expected).abs() + (all[(other, 2)] - expected).abs() == 0.0);
    }
}

#[test]
fn turning_the_axes_keeps_the_covariance() {
    let mut draws = Draws::new(6);
    let mut covariance = initial(&mut draws);
    let before = dense(&covariance);
    let rotation = draws.attitude().to_rotation_matrix().into_inner();
    covariance.turn(2, &rotation);
    let mut turn = Dense::identity();
    turn.fixed_view_mut::<3, 3>(6, 6).copy_from(&rotation);
    assert!((dense(&covariance) - turn * before * turn.transpose()).abs().max() < 1e-14);
}

#[test]
fn a_snapshot_is_exact_and_one_of_another_size_is_refused() {
    let covariance = initial(&mut Draws::new(7));
    let text = serde_json::to_string(&covariance).unwrap();
    assert_eq!(serde_json::from_str::<BlockCovariance<B>>(&text).unwrap(), covariance);
    assert!(
        serde_json::from_str::<BlockCovariance<3>>(&text).unwrap_err().to_string().contains("3×3 blocks")
    );
}
