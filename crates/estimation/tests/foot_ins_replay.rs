//! Streaming: one solution per sample, and a snapshot that goes on as if nothing had happened.
#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod support;

use adit_core::solution::Solution;
use adit_estimation::methods::foot_ins::{FootIns, FootInsParams, HeadingAid};
use adit_estimation::pedestrian::stance::Detector;
use adit_observation::Observation;
use support::walk::{Walk, run};

const DETECTORS: [Detector; 5] =
    [Detector::Magnitude, Detector::MovingVariance, Detector::Ared, Detector::Shoe, Detector::Adaptive];

fn with(detector: Detector) -> FootInsParams {
    let mut params = FootInsParams { heading_aid: HeadingAid::StraightLegs, ..FootInsParams::default() };
    params.stance.detector = detector;
    params
}

/// Every number of a solution, to the last bit.
fn bits(solution: &Solution) -> Vec<u64> {
    let q = solution.attitude.as_vector();
    let vectors = solution.position_m.iter().chain(&solution.velocity_m_s);
    let numbers = vectors.chain(q.iter()).chain(solution.covariance.iter()).map(|v| v.to_bits());
    core::iter::once(solution.time.nanos().cast_unsigned()).chain(numbers).collect()
}

#[test]
fn every_sample_gives_one_solution_in_order() {
    let walk = Walk::straight(6.0, 1).unwrap();
    for detector in DETECTORS {
        let (solutions, report) = run(with(detector), &walk.observations()).unwrap();
        assert!(solutions.iter().map(|s| s.time).eq(walk.samples.iter().map(|s| s.time)), "{detector:?}");
        assert_eq!(report.samples, walk.samples.len() as u64);
    }
}

#[test]
fn a_run_split_by_a_snapshot_equals_the_whole_run_bit_for_bit() {
    let walk = Walk::straight(6.0, 2).unwrap();
    let observations = walk.observations();
    for detector in DETECTORS {
        let (whole, whole_report) = run(with(detector), &observations).unwrap();
        // Before the first sample, in the alignment, just after it, in the walk, after the last sample.
        for split in [0, 30, 105, 700, 1_003, observations.len()] {
            let mut method = FootIns::new(with(detector)).unwrap();
            let mut solutions = Vec::new();
            for observation in &observations[..split] {
                solutions.extend(method.observe(observation).unwrap());
            }
            let snapshot = serde_json::to_string(&method).unwrap();
            let mut unbroken = core::mem::replace(&mut method, serde_json::from_str(&snapshot).unwrap());
            for (k, observation) in observations[split..].iter().enumerate() {
                solutions.extend(method.observe(observation).unwrap());
                if k == 0 {
                    // What a snapshot forgets may not show in the solutions: nothing at all may differ.
                    unbroken.observe(observation).unwrap();
                    let states = [&method, &unbroken].map(|m| serde_json::to_string(m).unwrap());
                    assert_eq!(states[0], states[1], "{detector:?}, split at {split}");
                }
            }
            while let Some(solution) = method.finish_next().unwrap() {
                solutions.push(solution);
            }
            assert_eq!(solutions.len(), whole.len());
            for (found, expected) in solutions.iter().zip(&whole) {
                assert_eq!(bits(found), bits(expected), "{detector:?}, split at {split}, {} s", found.time);
                assert_eq!(found.quality, expected.quality);
            }
            assert_eq!(*method.report(), whole_report);
        }
    }
}

#[test]
fn a_snapshot_after_a_gap_goes_on_as_well() {
    let mut walk = Walk::straight(6.0, 3).unwrap();
    walk.samples.drain(900..1_000);
    let observations = walk.observations();
    let (whole, _) = run(FootInsParams::default(), &observations).unwrap();
    let mut method = FootIns::new(FootInsParams::default()).unwrap();
    let mut solutions = Vec::new();
    for observation in &observations {
        solutions.extend(method.observe(observation).unwrap());
        // At every sample around the moment when the filter crosses the gap.
        if solutions.len().abs_diff(900) < 5 {
            method = serde_json::from_str(&serde_json::to_string(&method).unwrap()).unwrap();
        }
    }
    while let Some(solution) = method.finish_next().unwrap() {
        solutions.push(solution);
    }
    assert!(solutions.iter().map(bits).eq(whole.iter().map(bits)));
}

#[test]
fn the_memory_of_a_walker_does_not_grow_with_the_log() {
    let walk = Walk::straight(40.0, 4).unwrap();
    let mut method = FootIns::new(FootInsParams::default()).unwrap();
    let mut bytes = Vec::new();
    for observation in walk.observations() {
        method.observe(&observation).unwrap();
        bytes.push(method.state_bytes());
    }
    let settled = 2_000;
    assert!(
        bytes[settled..].iter().all(|b| *b == bytes[settled]),
        "{} to {:?}",
        bytes[settled],
        bytes.last()
    );
    // A mine of a thousand walkers fits into 100 MB.
    assert!(bytes[settled] < 100_000, "{} bytes", bytes[settled]);
}

#[test]
fn a_slower_rate_does_not_make_solutions_later() {
    let walk = Walk::straight(6.0, 3).unwrap();
    // 200 Hz for 4 s, then every fourth sample.
    let slowing = |k: &usize| *k < 800 || k.is_multiple_of(4);
    let samples: Vec<_> = (0..walk.samples.len()).filter(slowing).map(|k| walk.samples[k]).collect();
    for (detector, look_ahead_s) in [(Detector::Shoe, 0.0125), (Detector::Adaptive, 0.5625)] {
        let mut method = FootIns::new(with(detector)).unwrap();
        let mut late = 0.0_f64;
        for sample in &samples {
            let mut solution = method.observe(&Observation::Imu(*sample)).unwrap();
            let mut newest = None;
            while let Some(due) = solution {
                newest = Some(due.time);
                solution = method.next_due().unwrap();
            }
            if let Some(newest) = newest {
                late = late.max((sample.time - newest).seconds());
            }
        }
        // One sample at 50 Hz of slack.
        assert!(late < look_ahead_s + 0.021, "{detector:?}: {late} s");
    }
}
