//! `ahrs` on a tag turned in closed form: what it finds, what it withstands, how sure it says it is.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "times of some minutes become indices"
)]

mod support;

use adit_core::attitude;
use adit_core::nalgebra::Vector3;
use adit_core::solution::{Quality, Solution};
use adit_estimation::methods::MethodWarning;
use adit_estimation::methods::ahrs::{Ahrs, AhrsParams, smooth};
use adit_observation::Observation;
use support::Draws;
use support::turning::{RATE_HZ, Tag, error_deg, run, worst_deg};

/// Settings that fit the world of [`Tag`]: the field is the same everywhere, and the gyro errs by noise, bias and scale.
fn in_a_plain_world() -> AhrsParams {
    let mut params = AhrsParams { field_anomaly_ut: 0.1, velocity_m_s: 0.35, ..AhrsParams::default() };
    params.noise.rate_share = 0.0;
    params.noise.gyro_bias_walk_rad_s_sqrt_s = 1e-5;
    params.noise.field_ut = 0.4;
    params
}

#[test]
fn delay_offset_bias_and_scale_are_found() {
    let tag =
        Tag { delay_s: 0.018, offset_ut: Vector3::new(0.8, -0.6, 0.5), gyro_scale: 0.004, ..Tag::default() };
    let (log, truth) = tag.record(1);
    let (solutions, report) = run(in_a_plain_world(), &log).unwrap();
    let state = &report.state;
    assert!((state.delay_s - tag.delay_s).abs() < 0.001, "{state:?}");
    assert!((state.offset_ut - tag.offset_ut).norm() < 0.15, "{state:?}");
    assert!((state.gyro_bias_rad_s - tag.gyro_bias_rad_s).norm() < 0.0005, "{state:?}");
    assert!((state.gyro_scale.z - tag.gyro_scale).abs() < 0.001, "{state:?}");
    let (heading, inclination) = worst_deg(&solutions, &truth, 40.0);
    assert!(heading < 0.7 && inclination < 0.7, "{heading} {inclination}");
}

/// The same motion with the tag mounted otherwise is the same estimate, seen from the tag: nothing prefers an axis but
/// the scale factors, which are left out here.
#[test]
fn any_mounting_does() {
    let mut params = AhrsParams::default();
    params.initial.gyro_scale = 0.0;
    let still =
        Tag { noise: (0.0, 0.0, 0.0), gyro_scale: 0.0, gyro_bias_rad_s: Vector3::zeros(), ..Tag::default() };
    let (plain, _) = run(params.clone(), &still.record(1).0).unwrap();
    for seed in 0..4 {
        let mounting = Draws::new(seed).attitude();
        let tag = Tag { mounting, ..still.clone() };
        let (solutions, _) = run(params.clone(), &tag.record(1).0).unwrap();
        for (ours, plain) in solutions.iter().zip(&plain) {
            let difference = (ours.attitude * mounting.inverse()).angle_to(&plain.attitude);
            // Rounding, through thirty thousand products of rotations.
            assert!(difference < 1e-9, "at {}: {difference}", plain.time);
        }
    }
}

#[test]
fn a_passing_disturbance_leaves_the_heading_alone() {
    // 30 µT for 20 s, growing and fading over 3 s, as a steel car gives that comes, stands and goes.
    fn car(time_s: f64) -> Vector3<f64> {
        let t = time_s - 50.0;
        let strength = (t / 3.0).clamp(0.0, 1.0) * ((20.0 - t) / 3.0).clamp(0.0, 1.0);
        Vector3::new(25.0, -10.0, 13.0) * strength
    }
    let tag = Tag { site_ut: car, duration_s: 100.0, ..Tag::default() };
    let (log, truth) = tag.record(2);
    let (solutions, report) = run(AhrsParams::default(), &log).unwrap();
    let (heading, inclination) = worst_deg(&solutions, &truth, 20.0);
    assert!(heading < 3.0 && inclination < 0.7, "{heading} {inclination}");
    let disturbed_s = report.disturbed_samples as f64 / RATE_HZ;
    assert!((12.0..30.0).contains(&disturbed_s), "{disturbed_s}");
    let quality = |time_s: f64| solutions[(time_s * RATE_HZ) as usize].quality;
    assert_eq!([40.0, 60.0, 95.0].map(quality), [Quality::Fixed, Quality::DeadReckoning, Quality::Fixed]);
}

#[test]
fn a_magnet_clipped_to_the_tag_becomes_an_offset() {
    fn magnet(time_s: f64) -> Vector3<f64> {
        if time_s > 40.0 { Vector3::new(18.0, -12.0, 9.0) } else { Vector3::zeros() }
    }
    let tag = Tag { body_ut: magnet, duration_s: 120.0, ..Tag::default() };
    let (log, truth) = tag.record(3);
    let (solutions, report) = run(AhrsParams::default(), &log).unwrap();
    let (heading, _) = worst_deg(&solutions, &truth, 20.0);
    assert!(heading < 4.0, "{heading}");
    assert!((report.state.offset_ut - magnet(100.0)).norm() < 1.5, "{:?}", report.state);
    assert_eq!(solutions[solutions.len() - 1].quality, Quality::Fixed);
}

#[test]
fn a_new_site_keeps_the_heading_and_the_old_one_is_known_again() {
    // A hall whose field is 30 % stronger and turned by 25°, entered at 40 s and left at 90 s.
    fn hall(time_s: f64) -> Vector3<f64> {
        if (40.0..90.0).contains(&time_s) { Vector3::new(11.0, 3.0, -12.0) } else { Vector3::zeros() }
    }
    let tag = Tag { site_ut: hall, duration_s: 130.0, ..Tag::default() };
    let (log, truth) = tag.record(4);
    let (solutions, report) = run(AhrsParams::default(), &log).unwrap();
    let (heading, _) = worst_deg(&solutions, &truth, 20.0);
    assert!(heading < 4.0, "{heading}");
    // Both fields were held, and at the end it is the first again.
    assert_eq!(solutions[(85.0 * RATE_HZ) as usize].quality, Quality::Fixed);
    assert!(report.state.local_declination_rad.abs() < 1e-12, "{:?}", report.state);
    assert_eq!(solutions[solutions.len() - 1].quality, Quality::Fixed);
}

#[test]
fn at_rest_the_heading_stays_whatever_the_field_does() {
    fn wandering(time_s: f64) -> Vector3<f64> {
        Vector3::new(10.0, 4.0, 3.0) * (0.1 * (time_s - 20.0)).clamp(0.0, 1.0)
    }
    let tag = Tag { rest_s: 1e9, site_ut: wandering, duration_s: 120.0, ..Tag::default() };
    let (log, truth) = tag.record(5);
    let (solutions, report) = run(AhrsParams::default(), &log).unwrap();
    assert!(report.still_samples as f64 > 0.95 * report.samples as f64);
    let first = error_deg(&solutions[(15.0 * RATE_HZ) as usize], &truth[0]).0;
    let last = error_deg(&solutions[solutions.len() - 1], &truth[0]).0;
    assert!((last - first).abs() < 1.0, "{first} {last}");
}

#[test]
fn without_a_magnetometer_the_tilt_is_as_good_and_the_heading_starts_at_north() {
    let (log, truth) = Tag::default().record(6);
    let inertial: Vec<Observation> = log.into_iter().filter(|o| matches!(o, Observation::Imu(_))).collect();
    let (solutions, report) = run(AhrsParams::default(), &inertial).unwrap();
    assert!(!report.magnetic_heading);
    assert!(attitude::heading(&solutions[0].attitude).abs() < 1e-3);
    let (_, inclination) = worst_deg(&solutions, &truth, 20.0);
    assert!(inclination < 0.9, "{inclination}");
}

#[test]
fn the_declination_turns_the_estimate() {
    let (log, _) = Tag::default().record(7);
    let (plain, _) = run(AhrsParams::default(), &log).unwrap();
    let params = AhrsParams { declination_rad: 0.1, ..AhrsParams::default() };
    let (turned, _) = run(params, &log).unwrap();
    for (turned, plain) in turned.iter().zip(&plain) {
        let east = attitude::turn_navigation(&plain.attitude, &Vector3::new(0.0, 0.0, -0.1));
        assert!(turned.attitude.angle_to(&east) < 1e-9);
    }
}

#[test]
fn the_smoother_is_better_and_ends_where_the_filter_ends() {
    let tag = Tag { delay_s: 0.015, offset_ut: Vector3::new(-0.7, 0.4, 0.6), ..Tag::default() };
    let (log, truth) = tag.record(8);
    let (filtered, _) = run(AhrsParams::default(), &log).unwrap();
    let (smoothed, report) = smooth(AhrsParams::default(), &log, &mut |_| ()).unwrap();
    assert_eq!((smoothed.len(), report.samples as usize), (truth.len(), truth.len()));
    let rms = |solutions: &[Solution]| {
        let squares = solutions.iter().zip(&truth).map(|(s, t)| s.attitude.angle_to(t).powi(2));
        (squares.sum::<f64>() / truth.len() as f64).sqrt()
    };
    assert!(rms(&smoothed) < 0.6 * rms(&filtered), "{} {}", rms(&smoothed), rms(&filtered));
    let last = truth.len() - 1;
    // Equal to first order in the last correction, of a hundredth of a degree.
    let seam = smoothed[last].attitude.angle_to(&filtered[last].attitude);
    assert!(seam < 1e-6, "{seam}");
    // No seam between intervals: from sample to sample it turns as the gyro says, to the noise of the gyro.
    for (smoothed, filtered) in smoothed.windows(2).zip(truth.windows(2)) {
        let step = smoothed[0].attitude.inverse() * smoothed[1].attitude;
        let true_step = filtered[0].inverse() * filtered[1];
        assert!(step.angle_to(&true_step) < 1e-3, "at {}", smoothed[1].time);
    }
}

/// Errors against stated covariance, 40 tags, every 5 s of motion: mean NEES of the attitude, of 3 degrees of freedom.
fn nees(params: &AhrsParams) -> f64 {
    let mut sum = 0.0;
    let mut count = 0.0;
    for seed in 0..40 {
        let mut draws = Draws::new(1000 + seed);
        let tag = Tag {
            duration_s: 60.0,
            delay_s: 0.01 * draws.normal(),
            offset_ut: draws.vector(0.5),
            gyro_bias_rad_s: draws.vector(0.01),
            gyro_scale: 0.003 * draws.normal(),
            ..Tag::default()
        };
        let (log, truth) = tag.record(seed);
        let (solutions, _) = run(params.clone(), &log).unwrap();
        for k in (5..12).map(|five| (5.0 * f64::from(five) * RATE_HZ) as usize) {
            let error = attitude::log(&(truth[k] * solutions[k].attitude.inverse()));
            let covariance = solutions[k].covariance.fixed_view::<3, 3>(6, 6).into_owned();
            sum += error.dot(&(covariance.try_inverse().unwrap() * error));
            count += 1.0;
        }
    }
    sum / count
}

#[test]
fn the_stated_certainty_is_honest() {
    // In the world that the settings describe; but for the velocity, which is a swing here and no random walk, so that the
    // tilt is better than it is said to be.
    let matched = nees(&in_a_plain_world());
    assert!((1.0..3.5).contains(&matched), "{matched}");
    // The defaults allow for what real wearers do to the gyro and real halls to the field: too careful here.
    let careful = nees(&AhrsParams::default());
    assert!((0.1..1.5).contains(&careful), "{careful}");
}

/// A blow that the accelerometer clips leaves a velocity that is none: 140 m/s² for 20 ms, 2.8 m/s.
#[test]
fn a_blow_does_not_tilt_it() {
    let (mut log, truth) = Tag::default().record(11);
    for observation in &mut log {
        if let Observation::Imu(imu) = observation
            && (50.0..50.02).contains(&imu.time.seconds())
        {
            imu.specific_force_m_s2 += Vector3::new(140.0, 0.0, 0.0);
        }
    }
    let (solutions, _) = run(AhrsParams::default(), &log).unwrap();
    let (heading, inclination) = worst_deg(&solutions, &truth, 20.0);
    assert!(heading < 2.0 && inclination < 1.2, "{heading} {inclination}");
}

#[test]
fn a_gap_is_told_and_survived() {
    let (log, truth) = Tag::default().record(9);
    let gapped: Vec<(usize, &Observation)> =
        log.iter().enumerate().filter(|(_, o)| !(50.0..52.0).contains(&o.time().seconds())).collect();
    let observations: Vec<Observation> = gapped.iter().map(|(_, o)| (*o).clone()).collect();
    let kept: Vec<_> =
        gapped.iter().filter(|(_, o)| matches!(o, Observation::Imu(_))).map(|(k, _)| truth[k / 2]).collect();
    for (solutions, report) in [
        run(AhrsParams::default(), &observations).unwrap(),
        smooth(AhrsParams::default(), &observations, &mut |_| ()).unwrap(),
    ] {
        assert!(
            matches!(report.warnings[..], [MethodWarning::Gap { length_s, .. }] if (length_s - 2.0).abs() < 0.01)
        );
        assert_eq!(solutions.len(), kept.len());
        let (heading, inclination) = worst_deg(&solutions, &kept, 80.0);
        assert!(heading < 3.0 && inclination < 1.0, "{heading} {inclination}");
    }
}

#[test]
fn a_run_split_by_a_snapshot_equals_the_whole_run_bit_for_bit() {
    let (log, _) = Tag { duration_s: 20.0, rest_s: 3.0, delay_s: 0.01, ..Tag::default() }.record(10);
    let (whole, _) = run(AhrsParams::default(), &log).unwrap();
    for split in [0, 7, 41, 1000, 3001, log.len()] {
        let mut first = Ahrs::new(AhrsParams::default()).unwrap();
        let mut solutions = Vec::new();
        let mut feed = |ahrs: &mut Ahrs, part: &[Observation]| {
            for observation in part {
                let mut solution = ahrs.observe(observation).unwrap();
                while let Some(now) = solution {
                    solutions.push(now);
                    solution = ahrs.next_due().unwrap();
                }
            }
        };
        feed(&mut first, &log[..split]);
        let mut second: Ahrs = serde_json::from_str(&serde_json::to_string(&first).unwrap()).unwrap();
        feed(&mut second, &log[split..]);
        while let Some(last) = second.finish_next().unwrap() {
            solutions.push(last);
        }
        assert_eq!(solutions, whole, "split at {split}");
    }
}
