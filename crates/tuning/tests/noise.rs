//! Allan deviation against the published test suite and allantools; the parts against simulated noise; what is rest.
#![expect(clippy::unwrap_used, reason = "tests")]

mod support;

use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use adit_tuning::noise::{AllanPoint, InertialNoise, NoiseModel, measure, overlapping};
use adit_tuning::{Series, TuningError};
use support::Noise;

/// The 1000 points of NIST SP 1065, section 12.4.
fn test_suite() -> Vec<f64> {
    let mut n = 1_234_567_890_u64;
    (0..1000)
        .map(|_| {
            let value = n as f64 / 2_147_483_647.0;
            n = 16_807 * n % 2_147_483_647;
            value
        })
        .collect()
}

#[test]
fn the_published_deviations_come_out() {
    let curve = overlapping(&test_suite(), 1.0);
    // Riley 2008, table 31, overlapping Allan deviation; factors 10 and 100 are not among the averaging times, 1 is.
    assert!((curve[0].deviation - 2.922_319e-1).abs() < 5e-8, "{:?}", curve[0]);
}

#[test]
fn allantools_finds_the_same() {
    let white = test_suite();
    let mut sum = 0.0;
    let walk: Vec<f64> = white
        .iter()
        .map(|w| {
            sum += w - 0.5;
            sum
        })
        .collect();
    let mut compared = 0;
    for line in include_str!("reference/allan.csv").lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let readings = if fields[0] == "white" { &white } else { &walk };
        let (samples, expected): (usize, f64) = (fields[1].parse().unwrap(), fields[2].parse().unwrap());
        let curve = overlapping(readings, 0.01);
        let point = curve.iter().find(|p| p.samples == samples).unwrap();
        // Sums of 1000 doubles: ten digits agree at least.
        assert!((point.deviation / expected - 1.0).abs() < 1e-9, "{line} {point:?}");
        compared += 1;
    }
    assert_eq!(compared, 2 * overlapping(&white, 0.01).len());
}

/// A sensor at rest for `seconds` at 100 Hz with these parts on each axis.
fn rest(seconds: u32, gyro: &NoiseModel, force: &NoiseModel, seed: u64) -> (Series, Series) {
    let mut noise = Noise::new(seed);
    let interval = 0.01_f64;
    let (mut rates, mut forces) = (Series::default(), Series::default());
    let (mut rate_bias, mut force_bias) = (noise.vector(0.01), noise.vector(0.1));
    let (mut rate_step, mut force_step) = (Vector3::zeros(), Vector3::zeros());
    for i in 0..i64::from(seconds) * 100 {
        let mut reading =
            |model: &NoiseModel, bias: &mut Vector3<f64>, step: &mut Vector3<f64>, mean: Vector3<f64>| {
                *bias += noise.vector(model.walk * interval.sqrt());
                // Quantisation is white noise on the integral of the reading.
                let next = noise.vector(model.quantisation);
                let quantised = (next - *step) / interval;
                *step = next;
                mean + *bias + noise.vector(model.white / interval.sqrt()) + quantised
            };
        let time = Time::from_nanos(i * 10_000_000);
        rates.push(time, reading(gyro, &mut rate_bias, &mut rate_step, Vector3::zeros())).unwrap();
        forces.push(time, reading(force, &mut force_bias, &mut force_step, Vector3::z() * 9.81)).unwrap();
    }
    (rates, forces)
}

const GYRO: NoiseModel = NoiseModel { quantisation: 5e-6, white: 1e-4, instability: 0.0, walk: 3e-6 };
const FORCE: NoiseModel = NoiseModel { quantisation: 0.0, white: 1e-3, instability: 0.0, walk: 5e-5 };

#[test]
fn simulated_parts_are_found_within_their_stated_errors() {
    let (mut white, mut walk, mut quantisation, mut count) = (0.0, 0.0, 0.0, 0.0);
    for seed in 0..20 {
        let (rates, forces) = rest(3600, &GYRO, &FORCE, seed);
        let InertialNoise { gyro, accelerometer, .. } = measure(&rates, &forces).unwrap();
        for (sensor, truth) in [(&gyro, GYRO), (&accelerometer, FORCE)] {
            for axis in &sensor.axes {
                let (found, sd) = (axis.fit.model, axis.fit.sd);
                white += ((found.white - truth.white) / sd.white).powi(2);
                assert!((found.white / truth.white - 1.0).abs() < 0.03, "{axis:?}");
                assert!((found.walk / truth.walk - 1.0).abs() < 0.6, "{axis:?}");
                walk += ((found.walk / truth.walk) - 1.0).powi(2);
                count += 1.0;
            }
        }
        for axis in &gyro.axes {
            quantisation += (axis.fit.model.quantisation / GYRO.quantisation - 1.0).powi(2) / 60.0;
        }
    }
    // Mean of 120 normalised squares, 1 ± 0.13 if σ is right, its root 1 ± 0.06; how much neighbours on the curve share is a rule
    // of thumb, to be good within 30 %.
    let ratio = (white / count).sqrt();
    assert!((0.7..1.3).contains(&ratio), "σ of the white noise off by {ratio}");
    println!(
        "white noise: errors over their stated σ {ratio:.2}; walk: σ {:.0} %",
        100.0 * (walk / count).sqrt()
    );
    // An hour holds some twenty independent differences where the walk rules: about 20 %.
    assert!((walk / count).sqrt() < 0.3, "{}", (walk / count).sqrt());
    assert!(quantisation.sqrt() < 0.1, "{}", quantisation.sqrt());
}

#[test]
fn the_stated_scatter_of_the_curve_is_what_seeds_show() {
    let curves: Vec<_> = (0..20)
        .flat_map(|seed| {
            let (rates, forces) = rest(600, &GYRO, &FORCE, seed);
            measure(&rates, &forces).unwrap().accelerometer.axes
        })
        .map(|axis| axis.curve)
        .collect();
    for point in 0..curves[0].len() {
        let truth = FORCE.deviation(curves[0][point].tau_s);
        let square = |curve: &Vec<AllanPoint>| {
            let AllanPoint { deviation, sd, .. } = curve[point];
            // The relative σ, at the true deviation.
            ((deviation - truth) / (sd / deviation * truth)).powi(2)
        };
        let mean = curves.iter().map(square).sum::<f64>() / curves.len() as f64;
        // 60 normalised squares: 1 ± 0.18, 3 σ either way; the table's kinds are pure, this curve is a sum of two.
        assert!((0.45..1.55).contains(&mean), "{} s: {mean}", curves[0][point].tau_s);
    }
}

#[test]
fn flicker_is_read_as_bias_instability() {
    // A sum of Gauss–Markov processes an octave apart, each with the variance B² ln 2/π of an octave of a spectrum B²/(2π f).
    let instability = 2e-4;
    let mut noise = Noise::new(4);
    let mut parts = vec![[0.0_f64; 3]; 22];
    let (mut rates, mut forces) = (Series::default(), Series::default());
    let sigma = instability * (std::f64::consts::LN_2 / std::f64::consts::PI).sqrt();
    for part in &mut parts {
        *part = noise.vector(sigma).into();
    }
    for i in 0..360_000_i64 {
        let mut flicker = Vector3::zeros();
        for (octave, part) in parts.iter_mut().enumerate() {
            let keep = (-0.01 / (0.005 * f64::from(2_u32.pow(u32::try_from(octave).unwrap())))).exp();
            let fresh = noise.vector(sigma * (1.0 - keep * keep).sqrt());
            for axis in 0..3 {
                part[axis] = part[axis] * keep + fresh[axis];
            }
            flicker += Vector3::from(*part);
        }
        let time = Time::from_nanos(i * 10_000_000);
        rates.push(time, flicker + noise.vector(1e-3)).unwrap();
        forces.push(time, noise.vector(1e-2)).unwrap();
    }
    for axis in &measure(&rates, &forces).unwrap().gyro.axes {
        let found = axis.fit.model.instability;
        println!("bias instability: found over simulated {:.3}", found / instability);
        // The sum of Gauss–Markov processes ripples by 2 % about a flat spectrum; an hour's own scatter is 3 %.
        assert!((found / instability - 1.0).abs() < 0.1, "{:?}", axis.fit);
    }
}

#[test]
fn motion_cuts_the_rest_and_the_longest_part_is_used() {
    let (rates, mut forces) = rest(1000, &GYRO, &FORCE, 1);
    let mut moved = Series::default();
    for (time, rate) in rates.times().iter().zip(rates.readings()) {
        // Somebody moves the sensor from 300 s to 310 s.
        let hand =
            if (300.0..310.0).contains(&time.seconds()) { 0.5 * (7.0 * time.seconds()).sin() } else { 0.0 };
        moved.push(*time, rate + Vector3::new(hand, 0.0, 0.0)).unwrap();
    }
    let noise = measure(&moved, &forces).unwrap();
    assert!(noise.interrupted);
    assert!((310.0..313.0).contains(&noise.from_s) && noise.from_s + noise.duration_s > 998.0, "{noise}");
    assert!((noise.gyro.white / GYRO.white - 1.0).abs() < 0.05, "{noise}");

    // Put down with another side up: nothing but the mean of the accelerometer changes.
    let mut turned = Series::default();
    for (time, force) in forces.times().iter().zip(forces.readings()) {
        let side = if time.seconds() < 400.0 { Vector3::zeros() } else { Vector3::new(9.81, 0.0, -9.81) };
        turned.push(*time, force + side).unwrap();
    }
    forces = turned;
    let noise = measure(&rates, &forces).unwrap();
    assert!((400.0..403.0).contains(&noise.from_s), "{noise}");
}

#[test]
fn a_short_rest_is_refused_with_the_time_needed() {
    let (rates, forces) = rest(200, &GYRO, &FORCE, 1);
    let error = measure(&rates, &forces).unwrap_err();
    assert!(matches!(error, TuningError::ShortRest { .. }), "{error}");
    let said = error.to_string();
    assert!(said.contains("lasts 200 s") || said.contains("lasts 199 s"), "{said}");
    assert!(said.contains("expected 300 s") && said.contains("the end of the log"), "{said}");
}

#[test]
fn a_sensor_in_motion_is_refused() {
    let bench = support::Bench { samples: 60_000, ..support::Bench::default() };
    let tumble = bench.tumble(1);
    let error = measure(&tumble.angular_rate_rad_s, &tumble.specific_force_m_s2).unwrap_err().to_string();
    assert!(error.contains("never at rest") || error.contains("longest rest"), "{error}");
}

#[test]
fn a_hole_in_the_log_ends_the_rest() {
    let (rates, forces) = rest(500, &GYRO, &FORCE, 1);
    let with_hole = |series: &Series| {
        let mut cut = Series::default();
        for (time, reading) in series.times().iter().zip(series.readings()) {
            if !(250.0..260.0).contains(&time.seconds()) {
                cut.push(*time, *reading).unwrap();
            }
        }
        cut
    };
    let error = measure(&with_hole(&rates), &with_hole(&forces)).unwrap_err().to_string();
    assert!(error.contains("a hole at 250"), "{error}");
}

#[test]
fn an_axis_that_never_changes_is_refused() {
    let (rates, forces) = rest(400, &GYRO, &FORCE, 1);
    let mut frozen = Series::default();
    for (time, force) in forces.times().iter().zip(forces.readings()) {
        frozen.push(*time, Vector3::new(force.x, 0.0, force.z)).unwrap();
    }
    let error = measure(&rates, &frozen).unwrap_err().to_string();
    assert!(error.contains("the y axis of the accelerometer reads the same all the time"), "{error}");
}

#[test]
fn nothing_is_no_rest() {
    assert!(measure(&Series::default(), &Series::default()).is_err());
    let mut one = Series::default();
    one.push(Time::ZERO, Vector3::zeros()).unwrap();
    assert!(measure(&one, &one).is_err());
}
