//! Covariance of a robust fit to few readings.
//!
//! With errors of Student's t the information of a reading is in the mean `I = E ψ' = (ν+1)/(ν+3)` of that of a normal one of the same σ (Lange, Little & Taylor 1989,
//! appendix B), and the covariance of many readings `(HᵀH I)⁻¹`. Few are worse off: weights are chosen by residuals that the fit itself has
//! shrunk. To first order in p/n, p unknowns on n readings, the covariance is larger by K² (Huber 1973, 1981, §7.6),
//!
//! ```text
//! K = 1 + (p/n) Var ψ' / (E ψ')²
//! ```
//!
//! and never larger than that of the least squares to which the fit comes where n = p, `(HᵀH)⁻¹ ν/(ν−2)`. Of unknowns with a prior p counts what the
//! readings tell of them: the trace of the share that they have in the whole information.
//!
//! With `z = e²/(ν+e²)`, a Beta(½, ν/2), `ψ' = (ν+1)/ν (1−z)(1−2z)`: its moments are those of z.

use adit_core::nalgebra::{Const, DimMin, SMatrix};

/// Covariance from `Σ g gᵀ` of the unweighted gradients over σ, the information of the priors, how many readings there are, and ν; `None` where
/// together they leave an unknown open.
pub fn covariance<const N: usize>(
    information: &SMatrix<f64, N, N>,
    prior: &SMatrix<f64, N, N>,
    readings: usize,
    dof: f64,
) -> Option<SMatrix<f64, N, N>>
where
    Const<N>: DimMin<Const<N>, Output = Const<N>>,
{
    let many = (dof + 1.0) / (dof + 3.0);
    let inverse = |share: f64| Some((information * share + prior).cholesky()?.inverse());
    let unknowns = (information * many * inverse(many)?).trace();
    let k = 1.0 + unknowns / readings.max(1) as f64 * relative_variance(dof);
    let linear = if dof > 2.0 { (dof - 2.0) / dof } else { 0.0 };
    inverse((many / (k * k)).max(linear))
}

/// `Var ψ' / (E ψ')²`.
fn relative_variance(dof: f64) -> f64 {
    // E z^k = Π (½ + j) / (½ + ν/2 + j).
    let mut moments = [1.0; 5];
    for k in 1..5 {
        let j = (k - 1) as f64;
        moments[k] = moments[k - 1] * (0.5 + j) / (0.5 + 0.5 * dof + j);
    }
    let mean =
        |weights: [f64; 5]| weights.iter().zip(moments).map(|(weight, moment)| weight * moment).sum::<f64>();
    let first = mean([1.0, -3.0, 2.0, 0.0, 0.0]);
    let second = mean([1.0, -6.0, 13.0, -12.0, 4.0]);
    (second / (first * first) - 1.0).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use adit_core::nalgebra::{Matrix2, Matrix3};

    /// By hand with ν = 4: E z = 1/5, 3/35, 1/21, 1/33; E ψ' = 5/7, E ψ'² = 0.72511; 1.4 for many readings, 2 for least squares.
    #[test]
    fn few_readings_are_as_huber_says() {
        assert!((relative_variance(4.0) - 0.725_108 / (25.0 / 49.0) + 1.0).abs() < 1e-5);
        // Normal errors: no weights, nothing lost.
        assert!(relative_variance(1e12) < 1e-9);
        let none = Matrix3::zeros();
        let of = |readings: usize, dof: f64| {
            covariance(&Matrix3::identity(), &none, readings, dof).map(|c| c[(0, 0)])
        };
        let k = 1.0 + 3.0 / 48.0 * relative_variance(4.0);
        assert!(of(48, 4.0).is_some_and(|found| (found - 1.4 * k * k).abs() < 1e-12));
        assert!(of(usize::MAX, 4.0).is_some_and(|found| (found - 1.4).abs() < 1e-9));
        assert!(of(3, 4.0).is_some_and(|found| (found - 2.0).abs() < 1e-12));
        assert!(of(3, 1e12).is_some_and(|found| (found - 1.0).abs() < 1e-9));
        // Without a second moment nothing bounds it.
        assert!(of(3, 2.0).is_some_and(|found| found > 3.0));
    }

    #[test]
    fn unknowns_that_the_prior_tells_cost_nothing() {
        let information = Matrix2::new(1.0, 0.0, 0.0, 1e-9);
        let prior = Matrix2::new(0.0, 0.0, 0.0, 1e6);
        let told = covariance(&information, &prior, 8, 4.0);
        let alone = covariance(
            &adit_core::nalgebra::Matrix1::new(1.0),
            &adit_core::nalgebra::Matrix1::zeros(),
            8,
            4.0,
        );
        let both = told.zip(alone).map(|(told, alone)| (told[(0, 0)] - alone[(0, 0)]).abs());
        assert!(both.is_some_and(|apart| apart < 1e-9), "{both:?}");
        assert_eq!(covariance(&information, &-prior, 8, 4.0), None);
    }
}
