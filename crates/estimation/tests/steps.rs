//! Steps of walkers that are known in closed form, and of what is no walk.
#![expect(clippy::unwrap_used, reason = "tests")]

mod support;

use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use adit_estimation::pedestrian::steps::{Detector, Step, StepDetector, StepParams};
use adit_observation::Observation;
use core::f64::consts::TAU;
use proptest::prelude::*;
use support::Draws;
use support::strides::{GRAVITY_M_S2, Strides};

type Sample = (Time, Vector3<f64>);

fn forces(walk: &Strides, seed: u64) -> Vec<Sample> {
    let inertial = |observation: &Observation| match observation {
        Observation::Imu(imu) => Some((imu.time, imu.specific_force_m_s2)),
        _ => None,
    };
    walk.record(seed).0.iter().filter_map(inertial).collect()
}

fn steps_with(params: &StepParams, samples: &[Sample]) -> Vec<Step> {
    let mut detector = StepDetector::new(params);
    let mut steps = Vec::new();
    for (time, force) in samples {
        detector.observe(*time, force);
        steps.extend(core::iter::from_fn(|| detector.pop()));
    }
    detector.end();
    steps.extend(core::iter::from_fn(|| detector.pop()));
    assert!(steps.windows(2).all(|pair| pair[0].time < pair[1].time), "out of order");
    steps
}

fn steps(samples: &[Sample]) -> Vec<Step> {
    steps_with(&StepParams::default(), samples)
}

fn at(time_s: f64) -> Time {
    Time::from_seconds(time_s).unwrap()
}

/// A tag whose norm of the specific force is this.
fn norm(duration_s: f64, rate_hz: f64, of: impl Fn(f64) -> f64) -> Vec<Sample> {
    let times = (0..).map(|index| f64::from(index) / rate_hz).take_while(|time_s| *time_s < duration_s);
    times.map(|time_s| (at(time_s), Vector3::new(0.0, 0.6, 0.8) * of(time_s))).collect()
}

#[test]
fn counts_every_step_of_every_cadence_and_loudness() {
    for cadence_hz in [0.9, 1.2, 1.5, 1.8, 2.2, 2.6, 3.0] {
        // The body rises and falls by this much, whatever the cadence.
        for rise_m in [0.03, 0.05, 0.1] {
            let bounce_m_s2 = 0.5 * rise_m * (TAU * cadence_hz).powi(2);
            let walk =
                Strides { cadence_hz, bounce_m_s2, second_m_s2: 0.2 * bounce_m_s2, ..Strides::default() };
            let found = steps(&forces(&walk, 1));
            assert_eq!(found.len(), 40, "{cadence_hz} steps/s, {rise_m} m");
            for step in &found[2..38] {
                assert!((step.period_s * cadence_hz - 1.0).abs() < 0.1, "{cadence_hz} steps/s: {step:?}");
                assert!(step.seen);
            }
        }
    }
}

#[test]
fn a_limp_and_a_tag_in_one_pocket_are_walks() {
    for limp in [0.3, 0.5, 0.6] {
        let walk = Strides { limp, bounce_m_s2: 4.0, ..Strides::default() };
        assert_eq!(steps(&forces(&walk, 2)).len(), 40, "one foot louder by {limp}");
    }
}

#[test]
fn two_peaks_a_step_are_one_step() {
    // The second harmonic is as strong as the first: two peaks a step, which a threshold would count as two.
    for cadence_hz in [1.3, 1.6, 1.9, 2.3] {
        let walk = Strides { cadence_hz, second_m_s2: 2.5, ..Strides::default() };
        let found = steps(&forces(&walk, 3)).len();
        assert!((39..=41).contains(&found), "{found} steps of 40 at {cadence_hz} steps/s");
    }
}

#[test]
fn weak_steps_within_a_walk_are_told_by_its_rhythm() {
    // A U-turn: for 4 of 30 steps the body hardly rises.
    let signal = |t: f64| {
        let phase = (t - 3.0) * 1.8;
        let walks = (0.0..30.0).contains(&phase);
        let weak = (14.0..18.0).contains(&phase);
        let amplitude = if weak { 0.25 } else { 2.5 };
        GRAVITY_M_S2 - if walks { amplitude * (TAU * phase).cos() } else { 0.0 }
    };
    let found = steps(&norm(24.0, 100.0, signal));
    // One of the four is taken for the pause that a turn is.
    assert!((29..=30).contains(&found.len()), "{}", found.len());
    assert!(found.iter().any(|step| !step.seen));
}

#[test]
fn what_is_no_walk_has_no_steps() {
    let mut draws = Draws::new(7);
    let still = norm(60.0, 100.0, |_| GRAVITY_M_S2);
    assert_eq!(steps(&still).len(), 0);
    let noisy: Vec<Sample> = still.iter().map(|(t, f)| (*t, f + draws.vector(0.3))).collect();
    assert_eq!(steps(&noisy).len(), 0, "noise at rest");
    let vehicle =
        norm(60.0, 200.0, |t| GRAVITY_M_S2 + 4.0 * (TAU * 9.0 * t).sin() + 2.0 * (TAU * 14.3 * t).sin());
    assert_eq!(steps(&vehicle).len(), 0, "a vehicle");
    let sway = norm(60.0, 100.0, |t| GRAVITY_M_S2 + 1.5 * (TAU * 0.3 * t).sin());
    assert_eq!(steps(&sway).len(), 0, "slow sway");
    let taps = norm(60.0, 100.0, |t| GRAVITY_M_S2 + if t % 2.5 < 0.1 { 20.0 } else { 0.0 });
    assert_eq!(steps(&taps).len(), 0, "taps");
}

#[test]
fn of_steady_fidgeting_most_is_no_walk() {
    // Bumps of random height and time, as a hand makes them that puts a tag into a pocket: 20 minutes of it.
    let mut draws = Draws::new(11);
    let mut bumps = Vec::new();
    let mut time_s = 0.0;
    while time_s < 1200.0 {
        time_s += 0.25 + 0.5 * draws.normal().abs();
        bumps.push((time_s, (1.0 + draws.normal()).abs() * 3.0, 0.1 + 0.1 * draws.normal().abs()));
    }
    let mut first = 0;
    let samples: Vec<Sample> = (0..120_000)
        .map(|index| {
            let t = f64::from(index) / 100.0;
            while first < bumps.len() && bumps[first].0 < t - 3.0 {
                first += 1;
            }
            let near = bumps[first..].iter().take_while(|bump| bump.0 < t + 3.0);
            let sum: f64 = near.map(|(at, height, width)| height * (-((t - at) / width).powi(2)).exp()).sum();
            (at(t), Vector3::z() * (GRAVITY_M_S2 + sum))
        })
        .collect();
    let (ours, crossings) = (steps(&samples).len(), steps_with(&crossing(), &samples).len());
    // Bumps that come by chance in the rhythm of steps for some seconds remain.
    assert!(ours * 3 < crossings, "{ours} against {crossings}");
}

fn crossing() -> StepParams {
    StepParams { detector: Detector::ZeroCrossing, ..StepParams::default() }
}

#[test]
fn zero_crossings_count_a_plain_walk() {
    for cadence_hz in [1.4, 1.8, 2.4] {
        let walk = Strides { cadence_hz, second_m_s2: 0.3, ..Strides::default() };
        let found = steps_with(&crossing(), &forces(&walk, 5)).len();
        assert!((39..=41).contains(&found), "{found} at {cadence_hz} steps/s");
    }
    let still = norm(60.0, 100.0, |_| GRAVITY_M_S2);
    assert_eq!(steps_with(&crossing(), &still).len(), 0);
}

#[test]
fn the_rate_of_the_log_does_not_matter_nor_do_its_stamps() {
    let walk = |rate_hz| Strides { rate_hz, limp: 0.3, ..Strides::default() };
    for rate_hz in [25.0, 33.0, 50.0, 100.0, 200.0, 1000.0] {
        assert_eq!(steps(&forces(&walk(rate_hz), 8)).len(), 40, "{rate_hz} Hz");
    }
    // Stamps off by up to 40 % of the interval.
    let mut draws = Draws::new(9);
    let even = forces(&walk(100.0), 8);
    let jittered: Vec<Sample> = even
        .iter()
        .map(|(time, force)| (at(time.seconds() + draws.normal().clamp(-2.0, 2.0) * 0.002), *force))
        .collect();
    assert_eq!(steps(&jittered).len(), 40);
}

#[test]
fn odd_samples_are_left_out() {
    let samples = forces(&Strides::default(), 4);
    let clean = steps(&samples);
    let mut spoilt = Vec::new();
    for (index, sample) in samples.iter().enumerate() {
        spoilt.push(*sample);
        match index % 50 {
            3 => spoilt.push(*sample),
            13 => spoilt.push((sample.0, Vector3::repeat(f64::NAN))),
            23 => spoilt.push((at(sample.0.seconds() - 0.5), sample.1)),
            33 => spoilt.push((at(sample.0.seconds() + 0.001), Vector3::repeat(f64::INFINITY))),
            _ => {}
        }
    }
    assert_eq!(steps(&spoilt), clean);
    let mut detector = StepDetector::new(&StepParams::default());
    detector.end();
    for nanos in [i64::MIN, 0, i64::MAX - 5, i64::MAX] {
        detector.observe(Time::from_nanos(nanos), &Vector3::repeat(1e150));
    }
    detector.end();
    assert_eq!(detector.pop(), None);
}

#[test]
fn a_gap_ends_the_walk_and_begins_another() {
    let samples = forces(&Strides { steps: 60, ..Strides::default() }, 6);
    // 5 s of 33 s are missing: 9 of 60 steps.
    let cut: Vec<Sample> =
        samples.into_iter().filter(|(time, _)| !(15.0..20.0).contains(&time.seconds())).collect();
    let found = steps(&cut);
    assert!((49..=52).contains(&found.len()), "{}", found.len());
    assert!(found.iter().all(|step| !(15.1..19.9).contains(&step.time.seconds())));
}

#[test]
fn what_is_settled_stays_so_and_comes_soon() {
    let walk = Strides { steps: 30, ..Strides::default() };
    let samples = forces(&walk, 10);
    let mut detector = StepDetector::new(&StepParams::default());
    let mut late_s: Vec<f64> = Vec::new();
    for (time, force) in &samples {
        let settled = detector.settled();
        detector.observe(*time, force);
        while let Some(step) = detector.pop() {
            assert!(settled.is_none_or(|settled| step.time > settled), "{step:?} before {settled:?}");
            late_s.push((*time - step.time).seconds());
        }
        assert!(detector.settled() >= settled);
        // Standing or walking, the answer is at most some seconds behind.
        let behind_s = (*time - detector.settled().unwrap_or(samples[0].0)).seconds();
        assert!(behind_s < 4.0, "{behind_s} s behind at {time} s");
    }
    let steady = &late_s[6..29];
    assert!(steady.iter().all(|late_s| *late_s < 1.0), "{steady:?}");
}

proptest! {
    #[test]
    fn no_rotation_of_the_tag_changes_anything(
        seed in 0_u64..1000, cadence_hz in 1.2..2.6, limp in 0.0..0.5, second in 0.0..1.5,
    ) {
        let walk = Strides { cadence_hz, limp, second_m_s2: second, steps: 20, ..Strides::default() };
        let samples = forces(&walk, seed);
        let mounting = Draws::new(seed).attitude();
        let turned: Vec<Sample> = samples.iter().map(|(time, force)| (*time, mounting * force)).collect();
        let (straight, turned) = (steps(&samples), steps(&turned));
        prop_assert_eq!(straight.len(), turned.len());
        for (a, b) in straight.iter().zip(&turned) {
            // Rounding of the norm, 1e-15, over the curvature of a flat top.
            prop_assert!((a.time - b.time).seconds().abs() < 1e-6);
            prop_assert!((a.swing_m_s2 - b.swing_m_s2).abs() < 1e-9);
        }
    }

    #[test]
    fn a_split_run_is_the_whole_run(seed in 0_u64..1000, split in 0_usize..2600) {
        let samples = forces(&Strides::default(), seed);
        let mut whole = StepDetector::new(&StepParams::default());
        let mut parts = whole.clone();
        for (index, (time, force)) in samples.iter().enumerate() {
            if index == split {
                let text = serde_json::to_string(&parts).unwrap();
                parts = serde_json::from_str(&text).unwrap();
            }
            whole.observe(*time, force);
            parts.observe(*time, force);
            prop_assert_eq!(whole.pop(), parts.pop());
        }
        prop_assert_eq!(whole, parts);
    }

    #[test]
    fn any_samples_are_survived(
        samples in prop::collection::vec((any::<i64>(), prop::array::uniform3(any::<f64>())), 0..60),
    ) {
        let mut detector = StepDetector::new(&StepParams::default());
        for (nanos, force) in samples {
            detector.observe(Time::from_nanos(nanos), &Vector3::from(force));
        }
        detector.end();
        while detector.pop().is_some() {}
    }
}
