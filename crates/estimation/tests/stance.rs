//! The streaming stance detector against the formulas of its page, evaluated plainly.

mod support;

use adit_core::nalgebra::Vector3;
use adit_core::time::{Interval, Time};
use adit_estimation::pedestrian::stance::{Detector, Stance, StanceDetector, StanceParams};
use adit_observation::ImuSample;
use support::Draws;

const GRAVITY: f64 = 9.80665;
const DETECTORS: [Detector; 5] =
    [Detector::Magnitude, Detector::MovingVariance, Detector::Ared, Detector::Shoe, Detector::Adaptive];

fn params(detector: Detector) -> StanceParams {
    StanceParams {
        detector,
        window_s: 0.045,
        acc_scale_m_s2: 0.2,
        gyro_scale_rad_s: 0.15,
        threshold: 30.0,
        reach_s: 0.4,
        look_ahead_s: 0.3,
        gain: 3.0,
        floor: 2.0,
        ceiling: 500.0,
    }
}

/// Motion that comes and goes, at 200 Hz: evenly, or with jitter, lost samples and a pause.
fn motion(count: usize, even: bool, seed: u64) -> Vec<ImuSample> {
    let mut draws = Draws::new(seed);
    let mut time = Time::ZERO;
    let span = |seconds: f64| Interval::from_seconds(seconds).unwrap_or_default();
    (0..count)
        .map(|k| {
            let jitter_s = if even { 0.0 } else { (draws.normal() * 5e-4).clamp(-4e-3, 4e-3) };
            let lost_s = if even || k % 37 != 5 { 0.0 } else { 0.005 * (k % 4) as f64 };
            let pause_s = if even || k != count / 2 { 0.0 } else { 1.5 };
            time = time + span(0.005 + jitter_s + lost_s + pause_s);
            let vigour = (k as f64 * 0.03).sin().powi(4) * 5.0 + 0.02;
            ImuSample {
                time,
                angular_rate_rad_s: draws.vector(vigour),
                specific_force_m_s2: Vector3::new(0.5, 0.3, GRAVITY) + draws.vector(vigour),
            }
        })
        .collect()
}

fn nearer_than(span_s: f64, a: &ImuSample, b: &ImuSample) -> bool {
    let span = Interval::from_seconds(span_s).unwrap_or_default().nanos();
    (a.time - b.time).nanos().abs() <= span
}

/// The table of the module, in the plainest terms.
fn statistic(samples: &[ImuSample], at: usize, params: &StanceParams, gravity: f64) -> f64 {
    let window: Vec<_> =
        samples.iter().filter(|s| nearer_than(params.window_s / 2.0, s, &samples[at])).collect();
    let count = window.len() as f64;
    let mean = window.iter().fold(Vector3::zeros(), |sum, s| sum + s.specific_force_m_s2) / count;
    let force = |centre: Vector3<f64>| {
        let square = |s: &&ImuSample| (s.specific_force_m_s2 - centre).norm_squared();
        window.iter().map(square).sum::<f64>() / params.acc_scale_m_s2.powi(2)
    };
    let rate = |s: &ImuSample| s.angular_rate_rad_s.norm_squared() / params.gyro_scale_rad_s.powi(2);
    let rates = window.iter().map(|s| rate(s)).sum::<f64>();
    match params.detector {
        Detector::Magnitude => window
            .iter()
            .map(|s| {
                let excess = (s.specific_force_m_s2.norm() - gravity) / params.acc_scale_m_s2;
                rate(s).max(excess * excess)
            })
            .fold(0.0, f64::max),
        Detector::MovingVariance => force(mean) / count,
        Detector::Ared => rates / count,
        Detector::Shoe | Detector::Adaptive => (force(mean.normalize() * gravity) + rates) / count,
    }
}

fn expected(samples: &[ImuSample], params: &StanceParams, gravity: f64) -> Vec<Stance> {
    let statistics: Vec<f64> = (0..samples.len()).map(|k| statistic(samples, k, params, gravity)).collect();
    let judge = |(at, sample): (usize, &ImuSample)| {
        let statistic = statistics[at];
        if params.detector != Detector::Adaptive {
            return Stance { statistic, threshold: params.threshold, least: statistic };
        }
        let within = samples.iter().zip(&statistics).filter(|(s, _)| {
            let reach_s = if s.time < sample.time { params.reach_s } else { params.look_ahead_s };
            nearer_than(reach_s, s, sample)
        });
        let least = within.map(|(_, statistic)| *statistic).fold(f64::INFINITY, f64::min);
        let threshold = (params.gain * least).max(params.floor).min(params.ceiling);
        Stance { statistic, threshold, least }
    };
    samples.iter().enumerate().map(judge).collect()
}

fn streamed(mut detector: StanceDetector, samples: &[ImuSample]) -> Vec<(ImuSample, Stance)> {
    let mut left = Vec::new();
    for sample in samples {
        detector.push(*sample);
        left.extend(core::iter::from_fn(|| detector.pop()));
    }
    left.extend(core::iter::from_fn(|| detector.drain()));
    left
}

fn same(found: &[(ImuSample, Stance)], expected: &[Stance]) {
    assert_eq!(found.len(), expected.len());
    for (k, ((_, a), b)) in found.iter().zip(expected).enumerate() {
        let pairs = [(a.statistic, b.statistic), (a.threshold, b.threshold), (a.least, b.least)];
        for (a, b) in pairs {
            // Sums of squares of 10 m/s² over 0.2 m/s² cancel to the statistic: 2500 × W × 2⁻⁵³.
            assert!((a - b).abs() < 1e-10 + 1e-12 * b.abs(), "sample {k}: {a} instead of {b}");
        }
    }
}

#[test]
fn every_statistic_and_threshold_is_that_of_its_formula() {
    for detector in DETECTORS {
        for even in [true, false] {
            let samples = motion(800, even, 1);
            let params = params(detector);
            let found = streamed(StanceDetector::new(params.clone(), GRAVITY), &samples);
            same(&found, &expected(&samples, &params, GRAVITY));
        }
    }
}

#[test]
fn the_motion_of_these_tests_holds_stances_and_swings_for_every_detector() {
    for detector in DETECTORS {
        let found = streamed(StanceDetector::new(params(detector), GRAVITY), &motion(800, false, 1));
        let still = found.iter().filter(|(_, stance)| stance.is_still()).count();
        assert!((80..720).contains(&still), "{detector:?}: {still} of 800 still");
    }
}

#[test]
fn samples_leave_in_order_and_each_exactly_once() {
    for detector in DETECTORS {
        let samples = motion(1_000, false, 2);
        let left = streamed(StanceDetector::new(params(detector), GRAVITY), &samples);
        assert!(left.iter().map(|(sample, _)| sample).eq(&samples), "{detector:?}");
    }
}

#[test]
fn a_sample_leaves_as_soon_as_window_and_look_ahead_are_complete() {
    for detector in DETECTORS {
        let params = params(detector);
        let look_ahead_s = if detector == Detector::Adaptive { params.look_ahead_s } else { 0.0 };
        let delay = Interval::from_seconds(look_ahead_s + params.window_s / 2.0).unwrap_or_default();
        let samples = motion(1_000, false, 3);
        let mut detector = StanceDetector::new(params, GRAVITY);
        let mut left = 0;
        for (latest, sample) in samples.iter().enumerate() {
            detector.push(*sample);
            left += core::iter::from_fn(|| detector.pop()).count();
            let due = samples.iter().take_while(|s| s.time + delay <= sample.time).count();
            assert_eq!(left, due, "at {} s", sample.time);
            assert!(detector.waiting().eq(&samples[left..=latest]));
        }
    }
}

#[test]
fn a_drained_detector_is_empty() {
    for detector in DETECTORS {
        let samples = motion(300, true, 4);
        let mut detector = StanceDetector::new(params(detector), GRAVITY);
        for sample in &samples {
            detector.push(*sample);
        }
        assert_eq!(core::iter::from_fn(|| detector.drain()).count(), samples.len());
        assert_eq!(detector.waiting().count(), 0);
        assert!(detector.pop().is_none());
    }
}

#[test]
fn another_force_at_rest_judges_the_waiting_samples_anew() {
    // 50 mg too much.
    let read = GRAVITY * 1.05;
    for detector in DETECTORS {
        let samples = motion(600, false, 5);
        let params = params(detector);
        let mut streaming = StanceDetector::new(params.clone(), GRAVITY);
        let (waiting, later) = samples.split_at(60);
        for sample in waiting {
            streaming.push(*sample);
        }
        streaming.set_rest_force(read);
        same(&streamed(streaming, later), &expected(&samples, &params, read));
    }
}

#[test]
fn memory_does_not_grow_with_the_log() {
    for kind in DETECTORS {
        let mut detector = StanceDetector::new(params(kind), GRAVITY);
        let mut bytes = Vec::new();
        for (k, sample) in motion(100_000, true, 6).iter().enumerate() {
            detector.push(*sample);
            while detector.pop().is_some() {}
            if k + 1 == 10_000 || k + 1 == 100_000 {
                bytes.push(detector.heap_bytes());
            }
        }
        assert_eq!(bytes[0], bytes[1], "{kind:?}");
        assert!(bytes[0] > 0);
    }
}
