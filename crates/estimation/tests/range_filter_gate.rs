//! The filter on ranges when it is wrong: gates, recovery, mirror images.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

#[path = "support/ranges.rs"]
mod ranges;

use adit_core::nalgebra::{Matrix3, Vector3};
use adit_estimation::ranging::filter::gate::{GateKind, GateParams};
use adit_estimation::ranging::filter::weighting::WeightingKind;
use adit_estimation::ranging::filter::{ErrorParams, FilterParams, HeightParams, RangeFilter};
use ranges::{LAB, Normal, at_height, filter, link, place, round, seconds};

/// Four anchors in a drift: two on the southern wall, in view from the start, and two on the northern one, behind a vehicle for 20 s.
const DRIFT: [[f64; 3]; 4] = [[0.0, 0.0, 2.0], [30.0, 0.0, 2.0], [15.0, 8.0, 2.4], [45.0, 8.0, 2.4]];

/// Along the northern wall; the start is told, on the wrong side of the southern one. Largest error of the last 20 s, and the filter.
fn wrong_side(gate: GateKind, kind: WeightingKind) -> (f64, RangeFilter) {
    let params = FilterParams {
        height: at_height(1.1, 0.1),
        gate: GateParams { kind: gate, ..GateParams::default() },
        ..FilterParams::default()
    };
    let (mut filter, mut noise) = (filter(params, kind), Normal::new(5));
    let truth = |time_s: f64| Vector3::new(4.0 + 0.5 * time_s, 6.0, 1.1);
    let image = truth(0.0).component_mul(&Vector3::new(1.0, -1.0, 1.0));
    filter.start_at(seconds(0.0), image, &(Matrix3::identity() * 0.25));
    let mut worst: f64 = 0.0;
    for tick in 0..2400_u32 {
        let (time_s, anchor) = (0.025 * f64::from(tick), (tick % 4) as usize);
        if anchor >= 2 && time_s < 20.0 {
            continue;
        }
        let distance = (truth(time_s) - place(DRIFT[anchor])).norm();
        filter.observe(&link(&DRIFT, anchor, time_s, distance + noise.draw(0.05), 0.08), 0);
        if time_s > 40.0 {
            worst = worst.max((filter.solution().unwrap().position_m - truth(time_s)).xy().norm());
        }
    }
    (worst, filter)
}

#[test]
fn a_plain_gate_locks_itself_out_and_ours_does_not() {
    for kind in [WeightingKind::Equal, WeightingKind::Huber, WeightingKind::Igg3, WeightingKind::Adaptive] {
        let (worst, locked) = wrong_side(GateKind::Plain, kind);
        // Every range of the northern anchors, 40 s of 20 a second each, refused to the end; the place is its mirror image.
        assert!(worst > 11.0 && locked.report().refused == 800, "{kind:?}: {worst} {:?}", locked.report());
        let (worst, ours) = wrong_side(GateKind::Recovering, kind);
        assert!(worst < 0.3, "{kind:?}: {worst} {:?}", ours.report());
        assert_eq!(ours.report().recovered, 1, "{kind:?}: {:?}", ours.report());
        assert!(ours.report().refused < 40, "{kind:?}: {:?}", ours.report());
    }
}

/// The filter is right and half of the anchors are not: it must not go to them.
#[test]
fn two_wrong_anchors_of_five_do_not_take_the_filter_along() {
    let five = [LAB[0], LAB[1], LAB[2], LAB[3], [12.0, 16.0, 2.5]];
    let params = FilterParams { height: at_height(1.1, 0.1), ..FilterParams::default() };
    for kind in [WeightingKind::Equal, WeightingKind::Huber, WeightingKind::Igg3, WeightingKind::Adaptive] {
        let (mut filter, mut noise) = (filter(params, kind), Normal::new(6));
        let mut worst: f64 = 0.0;
        for tick in 0..3000_u32 {
            let (time_s, anchor) = (0.02 * f64::from(tick), (tick % 5) as usize);
            let behind = if anchor < 2 && time_s > 20.0 { 4.0 } else { 0.0 };
            let distance = (round(time_s) - place(five[anchor])).norm();
            filter.observe(&link(&five, anchor, time_s, distance + behind + noise.draw(0.05), 0.08), 0);
            if time_s > 20.0 {
                worst = worst.max((filter.solution().unwrap().position_m - round(time_s)).xy().norm());
            }
        }
        assert!(worst < 0.5, "{kind:?}: {worst} {:?}", filter.report());
        assert_eq!(filter.report().recovered, 0, "{kind:?}");
    }
}

/// A cage takes the tag 200 m away while nothing is heard.
#[test]
fn who_was_carried_away_unheard_is_found_again() {
    let shift = Vector3::new(200.0, -40.0, 0.0);
    let far = LAB.map(|[x, y, z]| [x + shift.x, y + shift.y, z]);
    let both = [LAB, far].concat();
    let params = FilterParams { height: at_height(1.1, 0.1), ..FilterParams::default() };
    for kind in [WeightingKind::Equal, WeightingKind::Igg3, WeightingKind::Adaptive] {
        let (mut filter, mut noise) = (filter(params, kind), Normal::new(7));
        let mut worst: f64 = 0.0;
        for tick in (0..2400_u32).filter(|tick| !(800..1200).contains(tick)) {
            let (time_s, near) = (0.025 * f64::from(tick), (tick % 4) as usize);
            let carried = tick >= 1200;
            let (anchor, truth) =
                if carried { (near + 4, round(time_s) + shift) } else { (near, round(time_s)) };
            let distance = (truth - place(both[anchor])).norm();
            filter.observe(&link(&both, anchor, time_s, distance + noise.draw(0.05), 0.08), 0);
            if time_s > 35.0 {
                worst = worst.max((filter.solution().unwrap().position_m - truth).xy().norm());
            }
        }
        // 5 s after ranges came back.
        assert!(worst < 0.5, "{kind:?}: {worst} {:?}", filter.report());
    }
}

/// Anchors on a vehicle, three of them in a plane; the fourth tells the side by 0.3 m, and somebody stands before it for the first 3 s, which makes it tell the other one.
#[test]
fn the_right_side_of_a_vehicle_is_found_by_walking() {
    let vehicle = [[2.6, 0.9, 2.0], [2.6, -0.9, 2.0], [2.6, -0.9, 0.5], [2.3, 0.9, 0.5]];
    let params = FilterParams { height: at_height(1.0, 0.2), ..FilterParams::default() };
    let (mut other_sides, mut ambiguous) = (0, 0);
    for seed in 0..20_u64 {
        let (mut filter, mut noise) = (filter(params, WeightingKind::Igg3), Normal::new(seed));
        let truth =
            |time_s: f64| Vector3::new(-3.4 + 2.0 * (0.2 * time_s).sin(), 5.0 * (0.1 * time_s).cos(), 1.0);
        let mut doubt_m: f64 = 0.0;
        for tick in 0..4800_u32 {
            let (time_s, anchor) = (0.025 * f64::from(tick), (tick % 4) as usize);
            let distance = (truth(time_s) - place(vehicle[anchor])).norm();
            let behind = if anchor == 3 && time_s < 3.0 { 0.5 } else { 0.0 };
            filter.observe(&link(&vehicle, anchor, time_s, distance + behind + noise.draw(0.05), 0.08), 0);
            if let Some(first) = filter.solution().filter(|_| time_s < 2.0) {
                doubt_m = doubt_m.max(first.covariance[(0, 0)].sqrt());
            }
        }
        let off = filter.solution().unwrap().position_m - truth(119.975);
        // The mirror image is 12 m away.
        assert!(off.xy().norm() < 3.0, "{seed}: {off} {:?}", filter.report());
        other_sides += filter.report().other_sides;
        if filter.report().ambiguous_starts > 0 {
            ambiguous += 1;
            assert!(doubt_m > 2.0, "{seed}: {doubt_m}");
        }
    }
    // Without a second place to follow, most would have stayed where they began.
    assert!(other_sides > 10 && ambiguous > 15, "{other_sides} {ambiguous}");
}

/// Four anchors in one plane, and the tag told to be in it: what is below and what is above have the same ranges.
#[test]
fn an_estimate_across_a_mirror_is_both_its_sides() {
    let ceiling = LAB.map(|[x, y, _]| [x, y, 2.0]);
    let params = FilterParams {
        height: HeightParams { below_anchors_m: 0.0, ..HeightParams::default() },
        // What all ranges read too long looks much like a height.
        errors: ErrorParams { common_offset_sigma_m: 0.05, ..ErrorParams::default() },
        ..FilterParams::default()
    };
    let (mut filter, mut noise) = (filter(params, WeightingKind::Igg3), Normal::new(12));
    let truth = |time_s: f64| round(time_s).xy().push(-0.5);
    filter.start_at(seconds(0.0), truth(0.0).xy().push(2.0), &(Matrix3::identity() * 4.0));
    for tick in 0..1200_u32 {
        let (time_s, anchor) = (0.025 * f64::from(tick), (tick % 4) as usize);
        let distance = (truth(time_s) - place(ceiling[anchor])).norm();
        filter.observe(&link(&ceiling, anchor, time_s, distance + noise.draw(0.05), 0.08), 0);
    }
    let (found, end) = (filter.solution().unwrap(), truth(29.975));
    assert!(filter.report().partings > 0, "{:?}", filter.report());
    let off = found.position_m - end;
    let sides = [off, off - Vector3::z() * 5.0];
    assert!(sides.iter().any(|side| side.norm() < 1.0), "{off}");
    // Half of the probability is 5 m away.
    assert!(found.covariance[(2, 2)].sqrt() > 2.0, "{}", found.covariance[(2, 2)]);
}
