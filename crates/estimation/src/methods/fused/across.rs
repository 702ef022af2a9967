//! How far across a roadway somebody may be, by the anchors heard lately.
//!
//! Anchors hang along a roadway, so that ranges tell the place along it well and the place across it badly: by the second order of the distance from the line that the anchors are on,
//! which has a mirror image, and by errors that last. A trunk in the way lengthens a range by a quarter of a metre for as long as somebody stands there; 20 m from an anchor, 2 m aside, that is
//! 2.5 m across. A filter of one Gaussian hypothesis, to which each range is a new one, becomes sure of either side. So what is told is no narrower across than
//!
//! ```text
//! w(y) = exp(−½ Σ_a (‖p(y) − a‖ − ‖p − a‖)² / σ²)       y from wall to wall, p(y) across from the place told, p = p(0)
//! v = Σ w y² / Σ w
//! ```
//!
//! the second moment, about the place told, of a uniform distribution over the width, weighed by how well that place and this can be told apart by ranges to the anchors a, each counted once however
//! often it was heard. The filter itself, and so the place, is as without.
//!
//! In a chamber y is any direction on the floor, up to 4 m, and v that of the direction in which it is largest.
//!
//! **Limits.** Where there is no map nothing says how far somebody can be aside.

use super::follower::Follower;
use crate::place::bank::Estimate;
use crate::place::roadways::Piece;
use adit_core::nalgebra::{Matrix2, Matrix3, Vector2, Vector3};
use adit_core::time::{Interval, Time};
use serde::{Deserialize, Serialize};

/// Anchors heard within this are those of the place.
const LATELY: Interval = Interval::from_nanos(5_000_000_000);
/// So many of them count: more leave nothing open.
const ANCHORS: usize = 8;
/// Places from wall to wall.
const PLACES: u32 = 17;
/// In a chamber: so many places to each side, and how far one is from the next, m.
const ASIDE: i32 = 8;
const STEP_M: f64 = 0.5;

/// Variance across.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Across {
    /// Unit vector across the roadway; in a chamber in whichever direction least is known.
    left: Vector2<f64>,
    /// About the place told, m².
    variance_m2: f64,
}

impl Across {
    /// Makes a covariance (m²) no narrower than this across, along it stays as it is.
    pub fn widen(&self, covariance_m2: &mut Matrix3<f64>) {
        let left = self.left.push(0.0);
        let missing_m2 = self.variance_m2 - left.dot(&(*covariance_m2 * left));
        if missing_m2 > 0.0 {
            *covariance_m2 += left * left.transpose() * missing_m2;
        }
    }
}

impl Follower {
    /// How far across its roadway a place may be; `None` off the roadways, and where no anchor was heard lately.
    pub(super) fn across(&self, estimate: &Estimate, now: Time) -> Option<Across> {
        let known = self.ranges.as_ref()?.anchors();
        let mut anchors_m = [Vector3::zeros(); ANCHORS];
        let mut count = 0;
        let lately = self.heard.iter().filter(|(_, heard)| now - *heard < LATELY);
        let places = lately.filter_map(|(anchor, _)| known.get(*anchor));
        for (slot, anchor) in anchors_m.iter_mut().zip(places) {
            *slot = anchor.position_m;
            count += 1;
        }
        let (place_m, anchors_m) = (&estimate.position_m, &anchors_m[..count]);
        let sigma_m = self.params.lasting_sigma_m;
        if anchors_m.is_empty() || sigma_m <= 0.0 {
            return None;
        }
        if let Some(room) = self.bank.chamber_of(estimate.place) {
            return Some(in_chamber(|there_m| room.contains(there_m), place_m, anchors_m, sigma_m));
        }
        let piece = self.bank.piece_of(estimate.place)?;
        let variance_m2 = variance_across(piece, place_m, anchors_m, sigma_m);
        Some(Across { left: piece.left(), variance_m2 })
    }
}

/// Second moment about a place, m², of where else across a roadway somebody may be for all that ranges to these anchors tell, each wrong by `sigma_m`.
fn variance_across(piece: &Piece, place_m: &Vector3<f64>, anchors_m: &[Vector3<f64>], sigma_m: f64) -> f64 {
    let (left, half_m) = (piece.left().push(0.0), piece.half_width_m);
    let left_m = piece.on(&place_m.xy()).left_m;
    let (mut sum, mut square) = (0.0, 0.0);
    for number in 0..PLACES {
        let aside_m = half_m * (2.0 * f64::from(number) / f64::from(PLACES - 1) - 1.0) - left_m;
        let there_m = place_m + left * aside_m;
        let weight = alike([place_m, &there_m], anchors_m, sigma_m);
        sum += weight;
        square += weight * aside_m * aside_m;
    }
    // The nearest of the places is a fraction of a metre away: it weighs something.
    square / sum.max(f64::MIN_POSITIVE)
}

/// The same in a chamber, in the direction in which it is largest.
fn in_chamber(
    contains: impl Fn(&Vector2<f64>) -> bool,
    place_m: &Vector3<f64>,
    anchors_m: &[Vector3<f64>],
    sigma_m: f64,
) -> Across {
    let (mut sum, mut moment) = (1.0, Matrix2::zeros());
    for (column, row) in (-ASIDE..=ASIDE).flat_map(|column| (-ASIDE..=ASIDE).map(move |row| (column, row))) {
        let aside = Vector2::new(f64::from(column), f64::from(row)) * STEP_M;
        if (column, row) == (0, 0) || !contains(&(place_m.xy() + aside)) {
            continue;
        }
        let weight = alike([place_m, &(place_m + aside.push(0.0))], anchors_m, sigma_m);
        sum += weight;
        moment += aside * aside.transpose() * weight;
    }
    let (a, b, c) = (moment[(0, 0)], moment[(0, 1)], moment[(1, 1)]);
    let half_gap = libm::hypot(0.5 * (a - c), b);
    // Of a symmetric matrix: the angle of the major axis, and its variance.
    let (sin, cos) = libm::sincos(0.5 * libm::atan2(2.0 * b, a - c));
    Across { left: Vector2::new(cos, sin), variance_m2: (0.5 * (a + c) + half_gap) / sum }
}

/// How well ranges to these anchors, each wrong by `sigma_m`, fit two places alike: 1 where they cannot tell them apart.
fn alike([here_m, there_m]: [&Vector3<f64>; 2], anchors_m: &[Vector3<f64>], sigma_m: f64) -> f64 {
    let apart = |anchor_m: &Vector3<f64>| (there_m - anchor_m).norm() - (here_m - anchor_m).norm();
    let misfit: f64 = anchors_m.iter().map(apart).map(|apart_m| apart_m * apart_m).sum();
    libm::exp(-0.5 * misfit / (sigma_m * sigma_m))
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use alloc::vec::Vec;

    /// A grid of 17 places has the moments of a uniform distribution but for its steps: `w²/12 (1 + 2/16)`.
    const STEPS: f64 = 1.125;

    fn roadway() -> Piece {
        Piece::between([Vector3::zeros(), Vector3::new(100.0, 0.0, 0.0)], 2.0).unwrap()
    }

    fn variance(place: [f64; 3], anchors: &[[f64; 3]]) -> f64 {
        let anchors: Vec<Vector3<f64>> = anchors.iter().map(|anchor| Vector3::from(*anchor)).collect();
        variance_across(&roadway(), &Vector3::from(place), &anchors, 0.25)
    }

    #[test]
    fn anchors_far_ahead_leave_the_whole_width_open() {
        let far = variance([50.0, 0.0, 1.0], &[[0.0, 0.0, 1.0], [100.0, 0.0, 1.0]]);
        assert!((far / (4.0 * 4.0 / 12.0 * STEPS) - 1.0).abs() < 0.05, "{far} m²");
    }

    #[test]
    fn an_anchor_on_the_line_leaves_both_sides_open() {
        // 1.5 m aside of the line, 3 m from the anchor: the mirror image is 3 m away and weighs as much.
        let both = variance([50.0, 1.5, 1.0], &[[52.6, 0.0, 1.0]]);
        assert!((3.0..9.0).contains(&both), "{both} m²");
    }

    #[test]
    fn anchors_abeam_on_the_wall_tell_the_place_across() {
        // Nothing but what lasts is left: 0.25 m over √2 anchors.
        let abeam = variance([50.0, 0.0, 1.0], &[[50.0, 2.0, 1.0], [50.0, -2.0, 1.0]]);
        assert!((abeam / (0.25 * 0.25 / 2.0) - 1.0).abs() < 0.1, "{abeam} m²");
    }

    #[test]
    fn only_what_is_missing_is_added_and_only_across() {
        let across = Across { left: Vector2::new(0.0, 1.0), variance_m2: 1.0 };
        let mut narrow = Matrix3::from_diagonal(&Vector3::new(0.1, 0.2, 0.3));
        across.widen(&mut narrow);
        assert!((narrow - Matrix3::from_diagonal(&Vector3::new(0.1, 1.0, 0.3))).norm() < 1e-12, "{narrow}");
        let wide = Matrix3::from_diagonal(&Vector3::new(0.1, 2.0, 0.3));
        let mut same = wide;
        across.widen(&mut same);
        assert!((same - wide).norm() < 1e-12, "{same}");
    }
}
