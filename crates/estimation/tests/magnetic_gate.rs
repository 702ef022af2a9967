//! The magnetic gate: what it refuses, when it believes again, and what it never learns.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

use adit_core::nalgebra::Vector3;
use adit_estimation::magnetic::gate::{MagneticGate, MagneticGateParams, ReferenceField, Sighting};
use adit_estimation::magnetic::heading::LevelField;

const STRIDE_M: f64 = 1.3;
const NORM_UT: f64 = 50.0;
const DIP_RAD: f64 = 1.15;

/// A walker with a gate; sightings come once a stride or, standing, twice a second.
struct Walker {
    gate: MagneticGate,
    walked_m: f64,
}

impl Walker {
    fn new(reference: Option<ReferenceField>) -> Self {
        Self { gate: MagneticGate::new(MagneticGateParams::default(), reference), walked_m: 0.0 }
    }

    fn started(disturbance_ut: Vector3<f64>) -> Self {
        let mut walker = Self::new(None);
        walker.gate.start(&level(disturbance_ut));
        walker
    }

    /// A sighting of the Earth's field with something added; was it believed, and did the heading have to be opened?
    fn see(
        &mut self,
        stride_m: f64,
        disturbance_ut: Vector3<f64>,
        heading_error_rad: f64,
    ) -> (bool, Option<f64>) {
        self.walked_m += stride_m;
        let field = level(disturbance_ut);
        let sighting = Sighting {
            field,
            heading_offset_rad: field.heading_offset_rad(0.0) - heading_error_rad,
            walked_m: self.walked_m,
            interval_s: if stride_m > 0.0 { 1.2 } else { 0.5 },
        };
        let good = self.gate.judge(&sighting);
        // A gyro heading known to a few degrees.
        let agreed = good && sighting.heading_offset_rad.abs() < 0.15;
        (good, self.gate.note(&sighting, agreed))
    }
}

fn level(disturbance_ut: Vector3<f64>) -> LevelField {
    let (sin, cos) = DIP_RAD.sin_cos();
    LevelField::new(&(Vector3::new(0.0, NORM_UT * cos, -NORM_UT * sin) + disturbance_ut)).unwrap()
}

fn none() -> Vector3<f64> {
    Vector3::zeros()
}

#[test]
fn steel_is_refused_by_norm_or_by_dip_and_believed_again_after_settling() {
    // 30 µT down changes the norm, 15 µT south the dip; 5 µT up only the norm, by 9 %.
    for disturbance in [Vector3::z() * -30.0, Vector3::y() * -15.0, Vector3::z() * 5.0] {
        let mut walker = Walker::started(none());
        assert!(walker.see(STRIDE_M, none(), 0.0).0);
        assert!(!walker.see(STRIDE_M, disturbance, 0.0).0, "{disturbance}");
        // Within the limits, but not within 0.7 of them, however long.
        let edge = disturbance.normalize() * 3.4;
        for _ in 0..20 {
            assert!(!walker.see(0.0, edge, 0.0).0, "{edge}");
        }
        // Half seconds: the two seconds of settling are full at the fourth.
        let believed: Vec<bool> = (0..5).map(|_| walker.see(0.0, none(), 0.0).0).collect();
        assert_eq!(believed, [false, false, false, true, true]);
        // Back to the edge: what is believed stays believed up to the limit itself.
        assert!(walker.see(0.0, edge, 0.0).0);
    }
}

#[test]
fn a_disturbance_across_the_meridian_counts_by_what_is_seen_of_the_others() {
    let mut walker = Walker::started(none());
    walker.see(STRIDE_M, none(), 0.0);
    assert!(walker.gate.across_ut(&level(none()), 0.0) < 1e-9);
    let off = level(Vector3::new(0.0, 0.0, -3.0));
    // 3 µT downward: all of it seen, and as much again, over √2, expected across.
    assert!((walker.gate.across_ut(&off, 0.0) - 3.0 / 2.0_f64.sqrt()).abs() < 0.02);
    // Less what the sensor itself does, 1 µT an axis then and now.
    assert!((walker.gate.across_ut(&off, 1.0) - (5.0_f64 / 2.0).sqrt()).abs() < 0.03);
    assert!(walker.gate.across_ut(&off, 2.0) < 1e-12);
    // A stride in bad surroundings is remembered over the next metres, not after a hundred.
    walker.see(STRIDE_M, Vector3::z() * -30.0, 0.0);
    let after = walker.gate.across_ut(&level(none()), 0.0);
    assert!(after > 5.0, "{after}");
    for _ in 0..80 {
        walker.see(STRIDE_M, none(), 0.0);
    }
    assert!(walker.gate.across_ut(&level(none()), 0.0) < 0.2);
}

#[test]
fn standing_beside_a_car_for_an_hour_teaches_nothing() {
    let mut walker = Walker::started(none());
    for _ in 0..5 {
        walker.see(STRIDE_M, none(), 0.0);
    }
    let car = Vector3::new(20.0, -15.0, 12.0);
    for _ in 0..7200 {
        assert_eq!(walker.see(0.0, car, 0.0), (false, None));
    }
    let reference = walker.gate.reference().unwrap();
    assert!((reference.norm_ut - NORM_UT).abs() < 1e-9);
    walker.see(STRIDE_M, none(), 0.0);
    assert!(walker.see(STRIDE_M, none(), 0.0).0, "the Earth's field is believed again two strides on");
}

#[test]
fn a_start_beside_steel_is_corrected_after_some_metres() {
    // The heading was taken in the disturbed field: off by what that field is turned.
    let steel = Vector3::new(15.0, -5.0, 10.0);
    let heading_error = level(steel).heading_offset_rad(0.0);
    let mut walker = Walker::started(steel);
    assert!(walker.see(0.0, steel, heading_error).0);
    let mut opened = None;
    while opened.is_none() && walker.walked_m < 100.0 {
        opened = walker.see(STRIDE_M, none(), heading_error).1;
    }
    assert!((walker.walked_m - 15.0).abs() <= 2.0 * STRIDE_M, "{}", walker.walked_m);
    assert!((opened.unwrap() + heading_error).abs() < 1e-9, "{opened:?} {heading_error}");
    assert!((walker.gate.reference().unwrap().norm_ut - NORM_UT).abs() < 1e-9);
    assert!(walker.see(STRIDE_M, none(), 0.0).0);
}

#[test]
fn a_field_that_cannot_be_the_earths_is_no_reference() {
    let mut walker = Walker::started(Vector3::z() * -60.0);
    assert!(walker.gate.is_disturbed() && walker.gate.reference().is_none());
    let mut opened = None;
    while opened.is_none() && walker.walked_m < 100.0 {
        opened = walker.see(STRIDE_M, none(), 0.8).1;
    }
    assert!(walker.walked_m < 20.0 && (walker.gate.reference().unwrap().norm_ut - NORM_UT).abs() < 1e-9);
}

#[test]
fn a_roadway_lined_with_steel_is_not_learnt_after_a_longer_good_walk() {
    let mut walker = Walker::started(none());
    for _ in 0..60 {
        assert!(walker.see(STRIDE_M, none(), 0.0).0);
    }
    let steel = Vector3::new(12.0, 8.0, -6.0);
    for _ in 0..50 {
        assert_eq!(walker.see(STRIDE_M, steel, 0.0), (false, None));
    }
    assert!((walker.gate.reference().unwrap().norm_ut - NORM_UT).abs() < 1e-9);
}

#[test]
fn a_changing_field_is_never_learnt() {
    let mut walker = Walker::started(none());
    for k in 0..500 {
        let turn = f64::from(k) * 0.7;
        let steel = Vector3::new(12.0 * turn.cos(), 14.0 * turn.sin(), 9.0 * (1.3 * turn).sin() - 12.0);
        let (_, opened) = walker.see(STRIDE_M, steel, 0.0);
        assert_eq!(opened, None, "{k}");
    }
}

#[test]
fn a_gyro_that_has_lost_the_heading_is_told_by_a_good_field() {
    let mut walker = Walker::started(none());
    for _ in 0..60 {
        walker.see(STRIDE_M, none(), 0.0);
    }
    let from_m = walker.walked_m;
    let mut opened = None;
    while opened.is_none() && walker.walked_m < from_m + 100.0 {
        opened = walker.see(STRIDE_M, none(), 0.7).1;
    }
    assert!(walker.walked_m - from_m < 15.0 + 2.0 * STRIDE_M);
    assert!((opened.unwrap() + 0.7).abs() < 1e-9);
}

#[test]
fn a_given_reference_is_never_replaced() {
    let given = ReferenceField { norm_ut: NORM_UT, dip_rad: DIP_RAD };
    let mut walker = Walker::new(Some(given));
    let steel = Vector3::new(12.0, 8.0, -6.0);
    walker.gate.start(&level(steel));
    assert!(walker.gate.is_disturbed());
    for _ in 0..500 {
        assert_eq!(walker.see(STRIDE_M, steel, 0.0), (false, None));
    }
    assert_eq!(walker.gate.reference(), Some(given));
}
