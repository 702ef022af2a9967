//! `uwb-ekf`, `uwb-rkf` and `uwb-aekf` in the laboratory of system S4: two tags on one carrier, late stamps, what cannot be used.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

use adit_core::nalgebra::Vector3;
use adit_core::solution::Solution;
use adit_core::time::Time;
use adit_estimation::methods::uwb_filter::{
    UwbAekfParams, UwbEkfParams, UwbFilterParams, UwbFilterReport, UwbRkfParams, Variant,
};
use adit_estimation::methods::{MethodError, MethodReport, MethodSettings, MethodWarning};
use adit_estimation::radio::{RadioSite, SiteAnchor};
use adit_estimation::ranging::filter::weighting::WeightingKind;
use adit_observation::{DeviceId, Observation, Radio, RangeSample};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use std::sync::Arc;

/// The anchors of `mines/lab.toml`.
fn lab() -> Arc<RadioSite> {
    let places =
        [("a1", 2.0, 0.2, 3.2), ("a2", 18.0, 0.2, 2.0), ("a3", 22.0, 15.8, 3.2), ("a4", 6.0, 15.8, 2.0)];
    let anchors = places.map(|(id, x, y, z)| SiteAnchor {
        id: id.into(),
        position_m: Vector3::new(x, y, z),
        range_offset_m: 0.0,
    });
    Arc::new(RadioSite { anchors: anchors.into(), ..RadioSite::default() })
}

fn truth(time_s: f64) -> Vector3<f64> {
    let angle = 0.1 * time_s;
    Vector3::new(12.0 + 6.0 * angle.cos(), 8.0 + 4.0 * angle.sin(), 1.3)
}

/// Ten epochs a second of each of these tags, which read too long by so much; stamped so late.
fn walk(site: &RadioSite, tags: &[(Option<&str>, f64)], late_s: f64) -> Vec<Observation> {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let mut log = Vec::new();
    for epoch in 0..600_u32 {
        for (number, anchor) in site.anchors.iter().enumerate() {
            for (k, (tag, offset_m)) in tags.iter().enumerate() {
                let time_s = 0.1 * f64::from(epoch) + 0.01 * number as f64 + 0.003 * k as f64;
                let noise: f64 = StandardNormal.sample(&mut random);
                log.push(Observation::Range(RangeSample {
                    time: Time::from_seconds(time_s + late_s).unwrap(),
                    anchor: DeviceId::new(&anchor.id).unwrap(),
                    tag: tag.map(|tag| DeviceId::new(tag).unwrap()),
                    range_m: (truth(time_s) - anchor.position_m).norm() + offset_m + 0.05 * noise,
                    sigma_m: None,
                    line_of_sight: None,
                    in_the_way: None,
                    radio: Radio::Uwb,
                    reception: None,
                }));
            }
        }
    }
    log
}

fn run<V: Variant>(
    params: UwbFilterParams<V>,
    log: &[Observation],
) -> Result<(Vec<Solution>, UwbFilterReport), MethodError> {
    let mut method = params.start()?;
    let mut all = Vec::new();
    for observation in log {
        let mut solution = method.observe(observation)?;
        while let Some(now) = solution {
            all.push(now);
            solution = method.next_due()?;
        }
    }
    while let Some(last) = method.finish_next()? {
        all.push(last);
    }
    Ok((all, method.report().clone()))
}

/// Level, of the second half.
fn rmse(solutions: &[Solution]) -> f64 {
    let late: Vec<&Solution> = solutions.iter().filter(|one| one.time.seconds() > 30.0).collect();
    let squares = late.iter().map(|one| (one.position_m - truth(one.time.seconds())).xy().norm_squared());
    (squares.sum::<f64>() / late.len() as f64).sqrt()
}

#[test]
fn each_filter_follows_the_tag_and_finds_what_it_reads_too_long() {
    let site = lab();
    let log = walk(&site, &[(None, 0.4)], 0.0);
    let runs = [
        run(UwbEkfParams::default().at_site(&site), &log).unwrap(),
        run(UwbRkfParams::default().at_site(&site), &log).unwrap(),
        run(UwbAekfParams::default().at_site(&site), &log).unwrap(),
    ];
    for (solutions, report) in runs {
        assert!(rmse(&solutions) < 0.1, "{} {report:?}", rmse(&solutions));
        let common = report.filter.common_offset.unwrap();
        assert!((common.offset_m - 0.4).abs() < 3.0 * common.sigma_m, "{common:?}");
        assert_eq!((report.heard.ranges, report.heard.epochs), (2400, 600));
        let filter = &report.filter;
        assert_eq!(filter.used + filter.refused + filter.before_start, 2400, "{filter:?}");
        assert_eq!(report.nis().unwrap().dimension, 1);
        assert!(solutions.windows(2).all(|pair| pair[0].time < pair[1].time));
    }
}

/// Their epochs overlap: a range of one comes after later ones of the other.
#[test]
fn two_tags_on_one_carrier_have_offsets_of_their_own() {
    let site = lab();
    let log = walk(&site, &[(Some("left"), 0.35), (Some("right"), 0.45)], 0.0);
    let (solutions, report) = run(UwbRkfParams::default().at_site(&site), &log).unwrap();
    assert!(rmse(&solutions) < 0.1, "{}", rmse(&solutions));
    assert_eq!((report.filter.offsets.len(), report.filter.too_old), (8, 0));
    for pair in report.filter.offsets.chunks(2) {
        let [left, right] = pair else { unreachable!() };
        assert_eq!((&left.anchor, left.tag.as_ref().unwrap().as_str()), (&right.anchor, "left"));
        // Each is the mean of 600 ranges with an error of 5 cm, most of it taken for one that passes.
        let apart = right.found.offset_m - left.found.offset_m;
        assert!((apart - 0.1).abs() < 0.02, "{left:?} {right:?}");
    }
    let one = UwbRkfParams::default().at_site(&site);
    let ranges =
        adit_estimation::ranging::listener::RangesParams { tag: Some("left".into()), ..one.ranges.clone() };
    let (_, report) = run(UwbRkfParams { ranges, ..one }, &log).unwrap();
    assert_eq!((report.heard.ranges, report.filter.offsets.len()), (2400, 4));
}

#[test]
fn stamps_that_are_late_are_put_right() {
    let site = lab();
    let log = walk(&site, &[(None, 0.0)], 0.5);
    let plain = UwbRkfParams::default().at_site(&site);
    let (late, _) = run(plain.clone(), &log).unwrap();
    let (right, _) = run(UwbRkfParams { latency_s: 0.5, ..plain }, &log).unwrap();
    // Half a second at 0.5 m/s.
    assert!(rmse(&right) < 0.1 && rmse(&late) > 0.2, "{} {}", rmse(&right), rmse(&late));
}

#[test]
fn settings_and_sites_that_cannot_be_used_are_told() {
    let site = lab();
    let plain = UwbEkfParams::default().at_site(&site);
    for (params, expected) in [
        (UwbEkfParams { latency_s: f64::NAN, ..plain.clone() }, "latency_s"),
        (
            {
                let mut params = plain.clone();
                params.filter.motion.speed_m_s = 0.0;
                params
            },
            "filter.motion.speed_m_s",
        ),
        (
            {
                let mut params = plain.clone();
                params.weighting.memory = 1.0;
                params
            },
            "weighting.memory",
        ),
    ] {
        let error = params.start().err().unwrap();
        assert!(
            matches!(error, MethodError::Setting { method: "uwb-ekf", name } if name == expected),
            "{error}"
        );
    }
    let error = UwbAekfParams::default().start().err().unwrap();
    assert_eq!(error.to_string(), "uwb-aekf needs the places of the anchors (--mine)");
    let mut log = walk(&site, &[(None, 0.0)], 0.0);
    for observation in &mut log {
        if let Observation::Range(range) = observation {
            range.anchor = DeviceId::new("x9").unwrap();
        }
    }
    let error = run(plain.clone(), &log).unwrap_err();
    assert!(matches!(error, MethodError::NoRangeFix { ranges: 2400, unknown: 2400, .. }), "{error}");
    let known = walk(&site, &[(None, 0.0)], 0.0);
    log.truncate(1);
    log.extend(known);
    let (_, report) = run(plain, &log).unwrap();
    assert!(matches!(report.warnings(), [MethodWarning::UnknownAnchors { anchors: 1, ranges: 1, .. }]));
}

#[test]
fn the_three_differ_by_their_weighting() {
    let kinds = [
        UwbEkfParams::default().weighting.kind,
        UwbRkfParams::default().weighting.kind,
        UwbAekfParams::default().weighting.kind,
    ];
    assert_eq!(kinds, [WeightingKind::Equal, WeightingKind::Igg3, WeightingKind::Adaptive]);
    let text = serde_json::to_string(&UwbRkfParams::default()).unwrap();
    assert_eq!(serde_json::from_str::<UwbRkfParams>(&text).unwrap(), UwbRkfParams::default());
}
