//! Figures hold what they promise, for short and long, near and far, moving and still walkers.
//!
//! Each test leaves its figures in `$CARGO_TARGET_TMPDIR`, for eyes.

#![expect(clippy::unwrap_used, reason = "a test that cannot make its input has failed")]

use adit_core::attitude;
use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use adit_core::trajectory::{Pose, Trajectory};
use adit_evaluation::alignment::Alignment;
use adit_evaluation::plot::{
    AllanAxis, AllanPanel, AllanParts, DistributionCurve, ErrorDots, MAX_POINTS, MagneticCloud, PathCurve,
    RangeErrors, Role, TimeCurve, allan_figure, distribution_figure, evaluation_figure, magnetometer_figure,
    path_figure, range_figure, time_figure,
};
use adit_evaluation::statistics::Distribution;
use adit_evaluation::{EvaluationError, EvaluationOptions, evaluate};

/// A shift in a mine on grid coordinates: galleries at right angles, `wobble_m` of error that grows and breathes.
fn shift(poses: i64, step_ns: i64, wobble_m: f64) -> Trajectory {
    let at = |i: i64| {
        let t = (i * step_ns) as f64 * 1e-9;
        let (leg, along) = ((t / 90.0).floor(), (t % 90.0) * 1.3);
        let (east, north) = (leg * 40.0, if leg % 2.0 < 1.0 { along } else { 117.0 - along });
        let drift = wobble_m * t / 600.0;
        let wobble = Vector3::new(
            (0.05 * t).sin() + 0.3 * (2.1 * t).sin(),
            (0.031 * t).cos(),
            0.4 * (0.011 * t).sin(),
        );
        Pose {
            time: Time::from_nanos(1_700_000_000_000_000_000 + i * step_ns),
            position_m: Vector3::new(431_250.0 + east, 5_702_100.0 + north, -640.0 - 0.02 * t)
                + wobble * drift,
            attitude: attitude::exp(&Vector3::new(
                0.02 * wobble_m * (0.1 * t).sin(),
                0.0,
                0.01 * drift + (0.2 * t).sin(),
            )),
        }
    };
    Trajectory::new((0..poses).map(at).collect()).unwrap()
}

fn keep(name: &str, svg: &str) {
    std::fs::write(format!("{}/{name}.svg", env!("CARGO_TARGET_TMPDIR")), svg).unwrap();
}

/// Values of an attribute, one for each element that has it.
fn attributes<'s>(svg: &'s str, name: &str) -> Vec<&'s str> {
    let opening = format!(" {name}=\"");
    svg.split(opening.as_str()).skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

/// What must hold for every figure: one root, nothing outside it, no curve too long, nothing undefined.
fn assert_sound(svg: &str) {
    assert!(svg.starts_with("<svg xmlns=") && svg.trim_end().ends_with("</svg>"));
    assert_eq!((svg.matches("<svg").count(), svg.matches("</svg>").count()), (1, 1));
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    let view: Vec<f64> = attributes(svg, "viewBox")[0].split(' ').map(|v| v.parse().unwrap()).collect();
    for points in attributes(svg, "points") {
        let points: Vec<(f64, f64)> = points
            .split_whitespace()
            .map(|p| p.split_once(',').map(|(x, y)| (x.parse().unwrap(), y.parse().unwrap())).unwrap())
            .collect();
        assert!(points.len() <= MAX_POINTS, "{} points", points.len());
        assert!(points.iter().all(|(x, y)| (0.0..=view[2]).contains(x) && (0.0..=view[3]).contains(y)));
    }
}

#[test]
fn an_evaluation_of_a_long_shift_fits_one_page() {
    let (estimate, truth) = (shift(60_000, 15_000_000, 3.0), shift(18_000, 50_000_000, 0.0));
    let evaluation = evaluate(&estimate, &truth, &EvaluationOptions::default()).unwrap();
    let svg = evaluation_figure(&evaluation, "foot-ins on shift 7 against the survey").unwrap();
    keep("evaluation", &svg);
    assert_sound(&svg);
    assert!(svg.len() < 400_000, "{} bytes", svg.len());
    for text in [
        "truth",
        "estimate",
        "horizontal, RMSE",
        "heading, RMSE",
        "time (s)",
        "error (m)",
        "x − 431000 (m)",
        "start",
        "end",
    ] {
        assert!(svg.contains(text), "{text}");
    }
}

#[test]
fn surveyed_points_without_attitude_leave_the_attitude_out() {
    let truth = shift(70, 4_000_000_000, 0.0);
    let options =
        EvaluationOptions { attitude: false, alignment: Alignment::Start, ..EvaluationOptions::default() };
    let evaluation = evaluate(&shift(30_000, 10_000_000, 1.0), &truth, &options).unwrap();
    let svg = evaluation_figure(&evaluation, "pdr against 70 floor marks").unwrap();
    keep("marks", &svg);
    assert_sound(&svg);
    assert!(!svg.contains("heading"));
    println!("{}", evaluation.report);
}

#[test]
fn a_path_without_truth_stands_alone() {
    let walk = shift(20_000, 20_000_000, 2.0);
    let svg = path_figure(&[PathCurve { label: "foot-ins", role: Role::Estimate(0), trajectory: &walk }], "")
        .unwrap();
    keep("alone", &svg);
    assert_sound(&svg);
    assert!(!svg.contains("truth"));
}

#[test]
fn somebody_who_stands_still_can_be_drawn() {
    let still = Trajectory::new(vec![shift(1, 1, 0.0).poses()[0]]).unwrap();
    let svg = path_figure(
        &[PathCurve { label: "<tag & 7>", role: Role::Estimate(1), trajectory: &still }],
        "Still",
    )
    .unwrap();
    keep("still", &svg);
    assert_sound(&svg);
    assert!(svg.contains("&lt;tag &amp; 7&gt;"));
}

#[test]
fn nothing_to_draw_is_said_so() {
    let nothing = Trajectory::default();
    let empty = path_figure(&[PathCurve { label: "", role: Role::Truth, trajectory: &nothing }], "");
    assert!(matches!(empty, Err(EvaluationError::TooFewPoses { .. })), "{empty:?}");
}

#[test]
fn a_coordinate_beyond_all_measure_is_refused() {
    let mut poses = shift(3, 1_000_000_000, 0.0).poses().to_vec();
    poses[0].position_m.x = -1e308;
    poses[2].position_m.x = 1e308;
    let far = Trajectory::new(poses).unwrap();
    let refused = path_figure(&[PathCurve { label: "far", role: Role::Truth, trajectory: &far }], "");
    assert!(matches!(refused, Err(EvaluationError::Plot { .. })), "{refused:?}");
}

#[test]
fn many_methods_share_a_figure_without_losing_their_names() {
    let methods = ["foot-ins", "marg-ins", "pdr", "reduced-ins-wifi", "full-ins-wifi", "uwb-ls", "uwb-ekf"];
    let curves = methods.iter().enumerate().map(|(n, name)| {
        let error =
            |i: u32| 0.1 * (1.0 + n as f64) * (f64::from(i) * 0.618).fract().powf(0.4 + 0.1 * n as f64);
        let mut errors: Vec<f64> = (0..700).map(error).collect();
        errors.push(7.41);
        DistributionCurve { label: (*name).to_owned(), distribution: Distribution::of(&errors).unwrap() }
    });
    let svg =
        distribution_figure(&curves.collect::<Vec<_>>(), "Seven methods, scenario s3, 20 seeds").unwrap();
    keep("distribution", &svg);
    assert_sound(&svg);
    for method in methods {
        assert!(svg.contains(method));
    }
    assert!(svg.contains("the largest, 7.41 m, lies beyond"));
}

#[test]
fn a_signed_curve_shows_its_zero() {
    let curve = |label: &str, phase: f64| TimeCurve {
        label: label.to_owned(),
        points: (0..100_000)
            .map(|i| (f64::from(i) * 0.01, (f64::from(i) * 0.001 + phase).sin() * 0.02))
            .collect(),
    };
    let svg =
        time_figure(&[curve("bias x", 0.0), curve("bias y", 1.0)], "Gyroscope bias", "bias (°/s)").unwrap();
    keep("signed", &svg);
    assert_sound(&svg);
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let walk = shift(5000, 20_000_000, 2.0);
    let figure =
        || path_figure(&[PathCurve { label: "a", role: Role::Truth, trajectory: &walk }], "twice").unwrap();
    assert_eq!(figure(), figure());
}

/// A magnetometer with an offset, turned every way.
fn cloud(samples: u32) -> (Vec<f64>, Vec<[f64; 3]>, Vec<[f64; 3]>) {
    let field = |i: u32| {
        let (a, b) = (f64::from(i) * 0.031, f64::from(i) * 0.0071);
        [50.0 * a.cos() * b.sin(), 50.0 * a.sin() * b.sin(), 50.0 * b.cos()]
    };
    let calibrated: Vec<[f64; 3]> = (0..samples).map(field).collect();
    let raw = calibrated.iter().map(|[x, y, z]| [1.2 * x - 15.0, y + 20.0, 0.9 * z]).collect();
    ((0..samples).map(|i| f64::from(i) * 0.01).collect(), raw, calibrated)
}

#[test]
fn a_calibration_shows_before_and_after() {
    let none = MagneticCloud { time_s: &[], raw_ut: &[], calibrated_ut: &[], norm_ut: 50.0 };
    assert!(matches!(magnetometer_figure(&none, ""), Err(EvaluationError::TooFewPoses { .. })));
    let zero =
        MagneticCloud { time_s: &[0.0], raw_ut: &[[0.0; 3]], calibrated_ut: &[[0.0; 3]], norm_ut: 50.0 };
    assert_sound(&magnetometer_figure(&zero, "").unwrap());
    for samples in [1, 2, 300, 200_000] {
        let (time_s, raw_ut, calibrated_ut) = cloud(samples);
        let cloud =
            MagneticCloud { time_s: &time_s, raw_ut: &raw_ut, calibrated_ut: &calibrated_ut, norm_ut: 50.0 };
        let svg = magnetometer_figure(&cloud, "tag 7").unwrap();
        keep(&format!("magnetometer-{samples}"), &svg);
        assert_sound(&svg);
        for shown in ["raw, sd", "calibrated, sd", "x–y plane", "y–z plane", "deviation (%)"] {
            assert!(svg.contains(shown), "{shown}");
        }
        assert!(svg.len() < 600_000, "{} bytes", svg.len());
    }
}

#[test]
fn errors_of_ranges_show_what_is_taken_off() {
    for count in [1, 2, 50_000] {
        let points: Vec<(f64, f64)> = (0..count)
            .map(|i| {
                let power = -105.0 + 25.0 * f64::from(i) / f64::from(count);
                (power, 0.3 * (-power / 90.0).powi(8) + 0.1 * (f64::from(i) * 0.7).sin())
            })
            .collect();
        let sizes: Vec<f64> = points.iter().map(|p| p.1.abs()).collect();
        let distribution = |label: &str| DistributionCurve {
            label: label.to_owned(),
            distribution: Distribution::of(&sizes).unwrap(),
        };
        let errors = RangeErrors {
            of: "received power (dBm)".to_owned(),
            dots: vec![ErrorDots { label: "not straight".to_owned(), points }],
            taken_off: vec![(-105.0, 0.9, 0.3), (-80.0, 0.1, 0.1)],
            distributions: vec![distribution("as measured"), distribution("corrected")],
        };
        let svg = range_figure(&errors, "hall").unwrap();
        keep(&format!("ranges-{count}"), &svg);
        assert_sound(&svg);
        for shown in ["received power (dBm)", "error (m)", "not straight", "taken off", "share of ranges"] {
            assert!(svg.contains(shown), "{shown}");
        }
        assert!(svg.len() < 600_000, "{} bytes", svg.len());
        let none = RangeErrors { dots: Vec::new(), ..errors };
        assert!(matches!(range_figure(&none, ""), Err(EvaluationError::Plot { .. })));
    }
}

#[test]
fn an_allan_deviation_shows_curve_and_parts_by_decades() {
    let parts = AllanParts { quantisation: 1e-6, white: 1e-4, instability: 0.0, walk: 2e-6 };
    let curve = (0..40)
        .map(|i| {
            let tau = 0.01 * 2_f64.powf(f64::from(i) * 0.25);
            let deviation = (1e-8 / tau + 4e-12 * tau / 3.0).sqrt();
            // As far as the whole deviation: a bar that reaches zero has no logarithm.
            (tau, deviation, deviation * f64::from(i) / 39.0)
        })
        .collect();
    let axes = vec![AllanAxis { name: "x", curve, parts }];
    let panel = |heading| AllanPanel { heading, unit: "rad/s", axes: axes.clone() };
    let svg = allan_figure(&[panel("Gyro"), panel("Accelerometer")], "rest").unwrap();
    keep("allan", &svg);
    assert_sound(&svg);
    for shown in ["Allan deviation (rad/s)", "averaging time (s)", "10⁻⁴", "10⁰", "Gyro", "Accelerometer"]
    {
        assert!(svg.contains(shown), "{shown}");
    }
    // Nothing to draw is an error, not a panic.
    let empty = AllanPanel { heading: "Gyro", unit: "rad/s", axes: Vec::new() };
    assert!(matches!(allan_figure(&[empty], "rest"), Err(EvaluationError::Plot { .. })));
}
