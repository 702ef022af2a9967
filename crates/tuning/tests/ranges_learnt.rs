//! Corrections learnt from simulated halls whose errors are known.
#![expect(clippy::unwrap_used, reason = "tests")]

use adit_core::time::Time;
use adit_estimation::ranging::correction::Diagnostic;
use adit_observation::csv_log::labelled::LinkClass;
use adit_observation::{DeviceId, Radio, RangeSample, Reception};
use adit_tuning::TuningError;
use adit_tuning::ranges::{KnownRange, held_out, learn, measures};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal, StudentT, Uniform};
use std::sync::Arc;

/// What a hall does to its ranges.
struct Hall {
    offset_m: f64,
    anchor_sigma_m: f64,
    /// Error of signals that did not come straight, at −80 dBm and for each dB below.
    blocked: Option<(f64, f64)>,
    noise_m: f64,
    told: bool,
}

const QUIET: Hall = Hall { offset_m: 0.0, anchor_sigma_m: 0.0, blocked: None, noise_m: 0.05, told: true };

impl Hall {
    /// Twelve places, six anchors, twenty ranges each.
    fn ranges(&self, seed: u64) -> Vec<KnownRange> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let unit = Normal::new(0.0, 1.0).unwrap();
        let tail = StudentT::new(4.0).unwrap();
        let anywhere = Uniform::new(2.0, 25.0).unwrap();
        let share = Uniform::new(0.0, 1.0).unwrap();
        let of_anchor: Vec<f64> =
            (0..6).map(|_| self.offset_m + self.anchor_sigma_m * unit.sample(&mut random)).collect();
        let mut ranges = Vec::new();
        for group in 0..12 {
            for (anchor, offset) in of_anchor.iter().enumerate() {
                let true_m = anywhere.sample(&mut random);
                let blocked = self.blocked.filter(|_| share.sample(&mut random) < 0.6);
                let power = blocked.map_or(-80.0, |_| -80.0 - 20.0 * share.sample(&mut random));
                let error = blocked.map_or(0.0, |(at, slope)| at + slope * (-80.0 - power));
                // What the place itself does to a link, the same for all its ranges.
                let of_link = blocked.map_or(0.3, |_| 1.0) * self.noise_m * unit.sample(&mut random);
                for _ in 0..20 {
                    let rx = power + 0.5 * unit.sample(&mut random);
                    #[expect(clippy::cast_possible_truncation, reason = "a power")]
                    let rx_power_dbm = self.told.then_some(rx as f32);
                    let reception = Reception { rx_power_dbm, ..Reception::default() };
                    let noise = of_link + self.noise_m * tail.sample(&mut random);
                    let range = RangeSample {
                        time: Time::ZERO,
                        anchor: DeviceId::new(&format!("a{anchor}")).unwrap(),
                        tag: None,
                        range_m: true_m + offset + error + noise,
                        sigma_m: None,
                        line_of_sight: None,
                        in_the_way: None,
                        radio: Radio::Uwb,
                        reception: Some(Arc::new(reception)),
                    };
                    let class = Some(if blocked.is_some() { LinkClass::Nlos } else { LinkClass::Los });
                    ranges.push(KnownRange { range, true_m, group, class });
                }
            }
        }
        ranges
    }
}

#[test]
fn where_nothing_is_wrong_nothing_is_taken_off() {
    for seed in 1..6 {
        let ranges = QUIET.ranges(seed);
        let learnt = learn(&ranges).unwrap();
        assert_eq!(
            (learnt.offsets.chosen.as_str(), learnt.unjudged.chosen.as_str()),
            ("none", "nothing"),
            "{seed}"
        );
        assert!(learnt.nlos.is_none());
        for one in &ranges {
            let told = learnt.correction.correct(&one.range);
            assert_eq!(told.distance_m.to_bits(), one.range.range_m.to_bits());
        }
    }
}

#[test]
fn offsets_are_found_common_or_of_each_anchor() {
    let common = Hall { offset_m: 0.4, ..QUIET };
    let learnt = learn(&common.ranges(1)).unwrap();
    assert_eq!(learnt.offsets.chosen, "common");
    // The median of 72 links of 1.5 cm and of 5 cm over √20: 2.5 mm.
    assert!((learnt.correction.offset_m - 0.4).abs() < 0.01, "{}", learnt.correction.offset_m);
    let each = Hall { offset_m: 0.4, anchor_sigma_m: 0.2, ..QUIET };
    let ranges = each.ranges(2);
    let learnt = learn(&ranges).unwrap();
    assert_eq!(learnt.offsets.chosen, "each anchor");
    assert_eq!(learnt.correction.anchors.len(), 6);
    let errors = measures::of(&ranges, &held_out(&ranges).unwrap());
    // Mean size of Student's t of 4 degrees of freedom is σ; 1.5 cm of the link beside it.
    assert!(errors[0].raw.mae_m > 0.3 && errors[0].corrected.mae_m < 0.06, "{:?}", errors[0]);
}

#[test]
fn errors_are_told_by_the_power_that_causes_them() {
    let hall = Hall { blocked: Some((0.1, 0.06)), ..QUIET };
    let ranges = hall.ranges(3);
    let learnt = learn(&ranges).unwrap();
    let curve = learnt.correction.unjudged.curve.as_ref().unwrap();
    assert_eq!(curve.of, Diagnostic::RxPower);
    for power in [-98.0, -92.0, -86.0] {
        let (error, sigma) = curve.at_value(power).unwrap();
        let truth = 0.1 + 0.06 * (-80.0 - power);
        // Knots stand 3 dB apart.
        assert!((error - truth).abs() < 0.08, "{power}: {error}, {truth}");
        // Of one range: its noise, √(ν/(ν−2)) of 5 cm, and 5 cm of its link.
        assert!((0.06..0.16).contains(&sigma), "{power}: {sigma}");
    }
    let errors = measures::of(&ranges, &held_out(&ranges).unwrap());
    assert_eq!(
        errors.iter().map(|one| one.class).collect::<Vec<_>>(),
        [None, Some(LinkClass::Los), Some(LinkClass::Nlos)]
    );
    assert!(errors[0].raw.mae_m > 0.4 && errors[0].corrected.mae_m < 0.1, "{:?}", errors[0]);
    // Standard deviations of ranges held out, told without them.
    assert!((0.7..1.5).contains(&errors[0].normalised_square), "{:?}", errors[0]);
}

/// A device that tells nothing: only who knows that the signal did not come straight takes off what it then is too long.
#[test]
fn without_diagnostics_the_class_alone_helps() {
    let hall = Hall { blocked: Some((0.8, 0.0)), told: false, ..QUIET };
    let ranges = hall.ranges(4);
    let learnt = learn(&ranges).unwrap();
    assert!(!learnt.unjudged.chosen.contains("power"), "{}", learnt.unjudged.chosen);
    let errors = measures::of(&ranges, &held_out(&ranges).unwrap());
    let known = errors[0].class_known.unwrap();
    assert!(known.mae_m < 0.09 && errors[0].corrected.mae_m > 0.3, "{:?}", errors[0]);
    let nlos = learnt.correction.nlos.as_ref().unwrap();
    assert!(nlos.curve.is_some() || nlos.polynomial.is_some());
}

#[test]
fn groups_are_held_out_whole() {
    let ranges = Hall { blocked: Some((0.1, 0.06)), ..QUIET }.ranges(5);
    let held = held_out(&ranges).unwrap();
    // Changing the truth of a group changes what is told of the others, never what is told of itself.
    let mut changed = ranges.clone();
    for one in changed.iter_mut().filter(|one| one.group == 3) {
        one.true_m -= 2.0;
    }
    let after = held_out(&changed).unwrap();
    for (one, (before, after)) in ranges.iter().zip(held.iter().zip(&after)) {
        if one.group == 3 {
            assert_eq!(before, after);
        }
    }
    assert_ne!(held, after);
}

#[test]
fn one_group_or_a_distance_that_is_none_is_refused() {
    let mut ranges = QUIET.ranges(6);
    ranges[7].true_m = f64::INFINITY;
    assert_eq!(learn(&ranges).unwrap_err(), TuningError::Range { found: f64::INFINITY });
    ranges.retain(|one| one.group == 1);
    assert_eq!(learn(&ranges).unwrap_err(), TuningError::FewGroups { found: 1, expected: 2 });
    assert_eq!(held_out(&ranges).unwrap_err(), TuningError::FewGroups { found: 1, expected: 3 });
    assert_eq!(learn(&[]).unwrap_err(), TuningError::FewGroups { found: 0, expected: 2 });
}
