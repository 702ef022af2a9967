//! The report keeps its names and says how its figures were made.

#![expect(clippy::unwrap_used, reason = "a test that cannot make its input has failed")]

use adit_core::attitude;
use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use adit_core::trajectory::{Pose, Trajectory};
use adit_evaluation::alignment::Alignment;
use adit_evaluation::{Evaluation, EvaluationError, EvaluationOptions, evaluate};
use serde_json::Value;

fn walk(error_m: f64) -> Trajectory {
    let pose = |i: i64| {
        let t = i as f64 * 0.1;
        Pose {
            time: Time::from_nanos(i * 100_000_000),
            position_m: Vector3::new(t + error_m * (0.9 * t).sin(), (0.4 * t).sin(), 0.1 * error_m * t),
            attitude: attitude::exp(&Vector3::new(0.1 * error_m * t.sin(), 0.0, 0.3 * t)),
        }
    };
    Trajectory::new((0..300).map(pose).collect()).unwrap()
}

fn judged(attitude: bool, alignment: Alignment) -> Evaluation {
    let options = EvaluationOptions { attitude, alignment, ..EvaluationOptions::default() };
    evaluate(&walk(0.4), &walk(0.0), &options).unwrap()
}

fn keys(value: &Value) -> Vec<String> {
    value.as_object().unwrap().keys().cloned().collect()
}

#[test]
fn the_names_of_the_json_are_stable() {
    let json = serde_json::to_value(judged(true, Alignment::Se2).report).unwrap();
    let mut expected: Vec<String> = [
        "association",
        "alignment",
        "poses_estimate",
        "poses_truth",
        "poses_unmarked",
        "poses_compared",
        "covered_share",
        "duration_s",
        "cep50_m",
        "cep95_m",
        "end_2d_m",
        "end_3d_m",
        "end_vertical_m",
        "end_share",
        "path_truth_m",
        "path_estimate_m",
        "path_ratio",
        "path_sum_truth_m",
        "path_sum_estimate_m",
        "rpe",
        "nees",
    ]
    .map(str::to_owned)
    .to_vec();
    for (parts, unit) in [(["2d", "3d", "vertical"], "m"), (["attitude", "heading", "inclination"], "deg")] {
        for part in parts {
            for name in ["rmse", "mean", "median", "p90", "p95", "max", "min", "std"] {
                expected.push(format!("{name}_{part}_{unit}"));
            }
            expected.push(format!("sse_{part}_{unit}2"));
        }
    }
    expected.push("bias_heading_deg".to_owned());
    expected.sort();
    let mut found = keys(&json);
    found.sort();
    assert_eq!(found, expected);
    assert_eq!(json["association"]["method"], "interpolate");
    assert_eq!(json["alignment"]["method"], "se2");
    assert_eq!(json["rpe"][0]["delta"], 1.0);
    assert_eq!(json["rpe"][0]["delta_unit"], "m");
    assert_eq!(json["rpe"][0]["frame"], "body");
    assert!(json["rpe"][0]["translation_m"]["rmse"].is_f64() && json["nees"].is_null());
}

#[test]
fn a_truth_of_positions_alone_leaves_no_attitude_in_the_json() {
    let json = serde_json::to_value(judged(false, Alignment::Start).report).unwrap();
    assert!(!keys(&json).iter().any(|key| key.ends_with("_deg")));
    assert!(json["rpe"][0]["angle_deg"].is_null());
    assert_eq!(json["rpe"][0]["frame"], "navigation");
    assert_eq!(json["alignment"]["start_distance_m"], 1.0);
}

#[test]
fn every_number_of_the_json_is_a_number() {
    fn no_null(path: &str, value: &Value) {
        match value {
            Value::Null => assert!(path.ends_with("nees") || path.ends_with("start_distance_m"), "{path}"),
            Value::Object(map) => {
                map.iter().for_each(|(key, value)| no_null(&format!("{path}/{key}"), value));
            }
            Value::Array(list) => list.iter().for_each(|value| no_null(path, value)),
            _ => {}
        }
    }
    no_null("", &serde_json::to_value(judged(true, Alignment::Se3).report).unwrap());
}

#[test]
fn the_table_states_alignment_and_association_and_fits_a_terminal() {
    for alignment in [Alignment::None, Alignment::Start, Alignment::Se2, Alignment::Se3] {
        let table = judged(true, alignment).report.to_string();
        assert!(
            table.contains("interpolated") && table.contains(&format!("aligned     {alignment}")),
            "{table}"
        );
        assert!(table.lines().all(|line| line.chars().count() <= 100), "{table}");
    }
}

#[test]
fn alignments_are_read_by_the_names_they_are_written_with() {
    for alignment in [Alignment::None, Alignment::Start, Alignment::Se2, Alignment::Se3] {
        assert_eq!(alignment.to_string().parse(), Ok(alignment));
        assert_eq!(serde_json::to_value(alignment).unwrap(), alignment.to_string());
    }
    let refused = "sim3".parse::<Alignment>();
    assert_eq!(refused, Err(EvaluationError::UnknownAlignment { found: "sim3".to_owned() }));
}
