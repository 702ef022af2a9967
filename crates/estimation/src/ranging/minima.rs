//! Of several minima the one to tell, and what the others make of its covariance.

use super::RangingFix;
use adit_core::nalgebra::{Matrix3, Vector3};

/// A place where the cost is least.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// East, north, height, m.
    pub position_m: Vector3<f64>,
    /// Of its own, m².
    pub covariance_m2: Matrix3<f64>,
    /// Negative logarithm of the likelihood.
    pub cost: f64,
}

/// A place that is not sure to this, m, is none.
const NOT_TOLD_M: f64 = 1e4;
/// Minima whose costs differ by less are equally good.
const EQUAL: f64 = 1e-6;
/// A minimum less probable than this is none.
const UNLIKELY: f64 = 1e-3;
/// So many standard deviations apart, squared, two searches have ended in two minima.
const APART: f64 = 9.0;

/// The best of them.
pub fn best(spots: &[Option<Spot>]) -> Option<Spot> {
    spots.iter().flatten().min_by(|a, b| a.cost.total_cmp(&b.cost)).copied()
}

/// The best, the lower of equally good ones; a second adds to its covariance by its share of the probability. `None` where nothing is told.
pub fn tell(spots: &[Option<Spot>]) -> Option<RangingFix> {
    let first = best(spots)?;
    let apart = |one: &Spot| {
        let away = one.position_m - first.position_m;
        first.covariance_m2.cholesky().is_some_and(|root| away.dot(&root.solve(&away)) > APART)
    };
    let second = spots.iter().flatten().filter(|one| apart(one));
    let second = second.min_by(|a, b| a.cost.total_cmp(&b.cost)).copied();
    let below = |other: &Spot| other.position_m.z < first.position_m.z;
    let swapped = second.filter(|other| other.cost - first.cost < EQUAL && below(other));
    let (taken, other) = swapped.map_or((first, second), |lower| (lower, Some(first)));
    let fix = mixture(&taken, other.as_ref());
    let told = fix.covariance_m2.trace() < NOT_TOLD_M * NOT_TOLD_M;
    told.then_some(fix)
}

fn mixture(taken: &Spot, other: Option<&Spot>) -> RangingFix {
    let alone =
        RangingFix { position_m: taken.position_m, covariance_m2: taken.covariance_m2, other_m: None };
    let Some(other) = other else { return alone };
    let share = 1.0 / (1.0 + libm::exp((other.cost - taken.cost).max(0.0)));
    if share < UNLIKELY {
        return alone;
    }
    let away = other.position_m - taken.position_m;
    let covariance_m2 =
        taken.covariance_m2 * (1.0 - share) + (other.covariance_m2 + away * away.transpose()) * share;
    RangingFix { covariance_m2, other_m: Some(other.position_m), ..alone }
}
