//! `adit calibrate mag` and `noise` from the outside: what they print, write and refuse.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use adit_core::attitude;
use adit_core::nalgebra::{Matrix3, Vector3};
use adit_core::time::{Interval, Time};
use adit_observation::sidecar::Sidecar;
use adit_simulation::{ImuErrorModel, ImuErrors, Inertial, TriadErrors};
use common::{Outcome, adit, files};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

const MAG: &str = "time_s,mag_x_uT,mag_y_uT,mag_z_uT";
const OFFSET: [f64; 3] = [-12.0, 25.0, 8.0];
const NORM_UT: f64 = 48.0;

/// Field in the body along a hand's tumble, µT; `tilt` 1 shows every side, 0 turns about z alone.
fn field(sample: u32, tilt: f64) -> (f64, Vector3<f64>) {
    let time = f64::from(sample) * 0.02;
    let turn = |axis: Vector3<f64>, angle: f64| attitude::exp(&(axis * angle));
    let attitude = turn(Vector3::x(), tilt * (1.7 * (0.23 * time).sin() + 0.19 * time))
        * turn(Vector3::y(), tilt * 1.3 * (0.11 * time + 0.4).sin())
        * turn(Vector3::z(), 0.83 * time);
    let (sin, cos) = 66_f64.to_radians().sin_cos();
    (time, attitude.inverse() * Vector3::new(0.0, cos, -sin) * NORM_UT)
}

/// A magnetometer with iron about it, tumbled for a minute; noise by the golden ratio, 0.1 µT.
fn tumble(tilt: f64) -> String {
    let distortion = Matrix3::new(1.10, 0.03, -0.05, 0.03, 0.92, 0.04, -0.05, 0.04, 1.02);
    let mut text = format!("{MAG}\n");
    for sample in 0..3000 {
        let (time, field) = field(sample, tilt);
        let noise = |k: f64| ((f64::from(sample) * k).fract() - 0.5) * 0.35;
        let reading = distortion * field + Vector3::from(OFFSET);
        let [x, y, z] =
            [reading.x + noise(0.618_034), reading.y + noise(0.754_878), reading.z + noise(0.569_840)];
        writeln!(text, "{time:.2},{x:.3},{y:.3},{z:.3}").unwrap();
    }
    text
}

fn folder_with(name: &str, text: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join(name), text).unwrap();
    folder
}

#[test]
fn a_tumble_becomes_a_sidecar_a_table_and_a_figure() {
    let folder = folder_with("tumble.csv", &tumble(1.0));
    let args =
        ["calibrate", "mag", "tumble.csv", "-o", "tag.toml", "--plot", "tag.svg", "--field-norm", "48"];
    let Outcome { code, stdout, stderr } = adit(folder.path(), &args);
    assert_eq!(code, 0, "{stderr}");
    assert!(
        stdout.contains("3000 over 60.0 s, 0 of them outliers")
            && stdout.contains("strength    48.00 µT, given"),
        "{stdout}"
    );
    assert!(
        stderr.contains("axes of magnetometer and inertial sensor are assumed to be parallel"),
        "{stderr}"
    );
    let sidecar = Sidecar::read(&folder.path().join("tag.toml")).unwrap();
    let calibration = sidecar.magnetometer.unwrap();
    // 0.1 µT of noise over 3000 samples.
    assert!((calibration.offset_ut() - Vector3::from(OFFSET)).amax() < 0.02, "{calibration:?}");
    assert_eq!(sidecar.magnetic_field.norm_ut, Some(48.0));
    let figure = fs::read_to_string(folder.path().join("tag.svg")).unwrap();
    assert!(
        figure.starts_with("<svg") && figure.contains("x–y plane") && figure.contains("Length of the field")
    );
    assert_eq!(files(folder.path()).len(), 3);

    // The calibration holds for whoever reads the log with it.
    fs::copy(folder.path().join("tag.toml"), folder.path().join("tumble.toml")).unwrap();
    let log = adit_observation::open(folder.path().join("tumble.csv")).unwrap();
    for observation in log {
        let adit_observation::Observation::Magnetic(sample) = observation.unwrap() else { unreachable!() };
        assert!((sample.field_ut.norm() - NORM_UT).abs() < 0.5, "{sample:?}");
    }
}

#[test]
fn the_calibration_does_not_see_an_earlier_one() {
    let folder = folder_with("tumble.csv", &tumble(1.0));
    let args = ["calibrate", "mag", "tumble.csv", "-o", "tumble.toml"];
    assert_eq!(adit(folder.path(), &args).code, 0);
    let first = fs::read_to_string(folder.path().join("tumble.toml")).unwrap();
    // Now the log has a sidecar, which a reader would apply.
    assert_eq!(adit(folder.path(), &args).code, 0);
    assert_eq!(fs::read_to_string(folder.path().join("tumble.toml")).unwrap(), first);
}

#[test]
fn a_sidecar_keeps_what_it_said() {
    let folder = folder_with("tumble.csv", &tumble(1.0));
    let before = "# left boot\nrate_hz = 200.0 # nominal\n\n[mounting]\nlocation = \"foot\" # laces\n";
    fs::write(folder.path().join("tag.toml"), before).unwrap();
    let args = ["calibrate", "mag", "tumble.csv", "-o", "tag.toml", "--declination", "-4.5"];
    let Outcome { code, stdout, .. } = adit(folder.path(), &args);
    assert_eq!(code, 0);
    assert!(stdout.contains("declination -4.50°, given"), "{stdout}");
    let after = fs::read_to_string(folder.path().join("tag.toml")).unwrap();
    assert!(after.starts_with(before), "{after}");
    assert!(after.contains("[magnetometer]") && after.contains("magnetic_declination_deg = -4.5"), "{after}");
}

#[test]
fn a_site_gives_declination_dip_and_strength() {
    let folder = folder_with("tumble.csv", &tumble(1.0));
    // WMM2025 report, table 6: 0 km, 80° N 0° E at 2025.0.
    let site = ["--site", "80,0", "--date", "2025-01-01"];
    let args = [&["calibrate", "mag", "tumble.csv", "-o", "tag.toml"], &site[..]].concat();
    assert_eq!(adit(folder.path(), &args).code, 0);
    let sidecar = Sidecar::read(&folder.path().join("tag.toml")).unwrap();
    let near = |found: Option<f64>, expected: f64, by: f64| (found.unwrap() - expected).abs() < by;
    // To the digits printed there.
    assert!(near(sidecar.frame.magnetic_declination_deg, 1.28, 0.006), "{sidecar:?}");
    assert!(near(sidecar.magnetic_field.dip_deg, 83.21, 0.006), "{sidecar:?}");
    assert!(near(sidecar.magnetic_field.norm_ut, 55.1785, 0.0002), "{sidecar:?}");
    // What is given goes before what the model says.
    let args = [&args[..], &["--declination", "2.5", "--field-norm", "48"]].concat();
    assert_eq!(adit(folder.path(), &args).code, 0);
    let sidecar = Sidecar::read(&folder.path().join("tag.toml")).unwrap();
    assert_eq!(sidecar.frame.magnetic_declination_deg, Some(2.5));
    assert_eq!(sidecar.magnetic_field.norm_ut, Some(48.0));
}

#[test]
fn json_is_one_object_on_stdout() {
    let folder = folder_with("tumble.csv", &tumble(1.0));
    let args = [
        "calibrate",
        "mag",
        "tumble.csv",
        "-o",
        "tag.toml",
        "--site",
        "50.92,13.34,400",
        "--date",
        "2026-11-22",
        "--json",
    ];
    let Outcome { code, stdout, .. } = adit(folder.path(), &args);
    assert_eq!(code, 0);
    let report: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    let calibration = &report["calibration"];
    assert!(calibration["after"]["sd_percent"].as_f64().unwrap() < 0.5, "{report}");
    assert!(calibration["before"]["sd_percent"].as_f64().unwrap() > 20.0, "{report}");
    assert!(calibration["held_out"]["sd_percent"].as_f64().unwrap() < 0.5, "{report}");
    assert_eq!(calibration["coverage"]["cells"], 82);
    assert_eq!(calibration["alignment"]["source"], "assumed");
    assert_eq!(report["site"]["date"], "2026-11-22");
    assert!(report["declination_deg"].as_f64().unwrap() > 3.0, "{report}");

    // The sidecar on stdout, the table on stderr.
    let Outcome { code, stdout, stderr } =
        adit(folder.path(), &["calibrate", "mag", "tumble.csv", "-o", "-"]);
    assert_eq!(code, 0);
    assert!(
        stdout.starts_with("[magnetometer]\noffset_ut = [") && stderr.contains("coverage"),
        "{stdout}\n{stderr}"
    );
}

#[test]
fn a_turntable_is_refused_and_nothing_is_written() {
    let folder = folder_with("tumble.csv", &tumble(0.0));
    let Outcome { code, stdout, stderr } =
        adit(folder.path(), &["calibrate", "mag", "tumble.csv", "-o", "tag.toml", "--plot", "tag.svg"]);
    assert_eq!((code, stdout.as_str()), (1, ""), "{stderr}");
    assert!(stderr.contains("adit: tumble.csv: the readings of the magnetometer lie within"), "{stderr}");
    assert!(stderr.contains("turned about one axis only"), "{stderr}");
    assert_eq!(files(folder.path()), ["tumble.csv"].map(std::path::PathBuf::from));
}

#[test]
fn half_a_tumble_is_refused_with_what_is_missing() {
    // Only rows with the field in the lower half of the sensor.
    let text = tumble(1.0);
    let kept = text.lines().filter(|line| {
        line.rsplit(',').next().and_then(|z| z.parse::<f64>().ok()).is_none_or(|z| z < OFFSET[2])
    });
    let folder = folder_with("tumble.csv", &(kept.collect::<Vec<_>>().join("\n") + "\n"));
    let Outcome { code, stderr, .. } =
        adit(folder.path(), &["calibrate", "mag", "tumble.csv", "-o", "tag.toml"]);
    assert_eq!(code, 1);
    assert!(
        stderr.contains("directions of the field") && stderr.contains("Missing is the field along +z"),
        "{stderr}"
    );
    assert_eq!(stderr.lines().count(), 1, "{stderr}");
}

#[test]
fn broken_files_are_told_with_their_line() {
    let good = tumble(1.0);
    let rest = common::log(&common::rest(100));
    let cases: [(&str, &str, &str); 6] = [
        ("a.csv", "", "a.csv: the file is empty"),
        ("a.csv", "time_s,mag_x_uT,mag_y_uT\n0,1,2\n", "a.csv:1: missing column mag_z_uT"),
        ("a.csv", "time_s,mag_x_uT,mag_y_uT,mag_z_uT\n0,1,2,oops\n", "a.csv:2: mag_z_uT: found \"oops\""),
        ("a.csv", "time_s,mag_x_uT,mag_y_uT,mag_z_uT\n1,1,2,3\n0,1,2,3\n", "a.csv:3: time runs backwards"),
        ("a.csv", &rest, "a.csv: 0 readings of the magnetometer, expected 200 or more"),
        ("a.csv", "time_s,mag_x_uT,mag_y_uT,mag_z_uT\n", "a.csv: 0 readings of the magnetometer"),
    ];
    for (name, text, expected) in cases {
        let folder = folder_with(name, text);
        let Outcome { code, stderr, .. } = adit(folder.path(), &["calibrate", "mag", name, "-o", "tag.toml"]);
        assert_eq!(code, 1, "{stderr}");
        assert!(stderr.lines().any(|line| line.starts_with("adit: ") && line.contains(expected)), "{stderr}");
        assert!(!folder.path().join("tag.toml").exists());
    }
    // The sidecar to be completed is no sidecar, or cannot be made.
    let folder = folder_with("tumble.csv", &good);
    fs::write(folder.path().join("notes.toml"), "title = 1\n").unwrap();
    let Outcome { code, stderr, .. } =
        adit(folder.path(), &["calibrate", "mag", "tumble.csv", "-o", "notes.toml"]);
    assert!(code == 1 && stderr.contains("notes.toml:1: unknown field `title`"), "{stderr}");
    let Outcome { code, stderr, .. } =
        adit(folder.path(), &["calibrate", "mag", "tumble.csv", "-o", "no/such/tag.toml"]);
    assert!(code == 1 && stderr.contains("no/such/tag.toml: cannot create it"), "{stderr}");
    // One recording twice.
    let Outcome { code, stderr, .. } =
        adit(folder.path(), &["calibrate", "mag", "tumble.csv", "tumble.csv", "-o", "tag.toml"]);
    assert!(code == 1 && stderr.contains("its magnetometer overlaps that of another log"), "{stderr}");
}

#[test]
fn wrong_usage_is_one_line_and_exit_code_2() {
    let here = Path::new(".");
    for (flags, expected) in [
        (&["--site", "91,0"][..], "expected a latitude from -90 to 90"),
        (&["--site", "50"], "expected LAT,LON or LAT,LON,HEIGHT_M"),
        (&["--site", "50,north"], "expected LAT,LON or LAT,LON,HEIGHT_M"),
        (&["--site", "50,13,99999"], "expected a height from -5000 to 9000 m"),
        (&["--date", "2026-11-22"], "--site"),
        (&["--site", "50,13", "--date", "tomorrow"], "expected a day as in 2026-11-22"),
        (&["--declination", "east"], "expected degrees from -180 to 180"),
        (&["--field-norm", "-50"], "expected microtesla from 1 to 1000"),
        (&["--out", "-", "--json"], "cannot both go to stdout"),
    ] {
        let out: &[&str] = if flags.contains(&"--out") { &[] } else { &["-o", "tag.toml"] };
        let args = [&["calibrate", "mag", "a.csv"], out, flags].concat();
        let Outcome { code, stdout, stderr } = adit(here, &args);
        assert_eq!((code, stdout.as_str()), (2, ""), "{args:?}: {stderr}");
        assert!(stderr.contains(expected) && stderr.lines().count() == 1, "{args:?}: {stderr}");
    }
    // A day that the calendar or the model does not have is no matter of usage: the model says so.
    let folder = folder_with("tumble.csv", &tumble(1.0));
    for day in ["2026-02-30", "2031-01-01"] {
        let args = ["calibrate", "mag", "tumble.csv", "-o", "tag.toml", "--site", "50,13", "--date", day];
        let Outcome { code, stderr, .. } = adit(folder.path(), &args);
        assert!(code == 1 && stderr.contains("no magnetic model for this place and day"), "{stderr}");
    }
}

#[test]
fn help_reads_as_it_should() {
    let here = Path::new(".");
    insta::assert_snapshot!("help_calibrate", adit(here, &["calibrate", "--help"]).stdout);
    insta::assert_snapshot!("help_calibrate_mag", adit(here, &["calibrate", "mag", "--help"]).stdout);
    insta::assert_snapshot!("help_calibrate_noise", adit(here, &["calibrate", "noise", "--help"]).stdout);
}

/// A resting sensor as the simulator makes it, 100 Hz.
fn resting_log(seconds: u32, model: &ImuErrorModel) -> String {
    let mut errors = ImuErrors::new(model, 3).unwrap();
    let mut text = format!("{}\n", common::HEADER);
    for i in 0..i64::from(seconds) * 100 {
        let ideal =
            Inertial { angular_rate_rad_s: Vector3::zeros(), specific_force_m_s2: Vector3::z() * common::G };
        let sample = errors.apply(&ideal, Time::from_nanos(i * 10_000_000), Interval::from_nanos(10_000_000));
        let (f, w) = (sample.specific_force_m_s2, sample.angular_rate_rad_s);
        let time = sample.time.seconds();
        writeln!(text, "{time:.6},{:.7},{:.7},{:.7},{:.9},{:.9},{:.9}", f.x, f.y, f.z, w.x, w.y, w.z)
            .unwrap();
    }
    text
}

#[test]
fn a_rest_becomes_the_densities_that_made_it() {
    let model = ImuErrorModel {
        gyro: TriadErrors {
            random_walk: 8.7e-5,
            bias_random_walk: 4e-6,
            turn_on_bias: 0.01,
            ..TriadErrors::default()
        },
        accelerometer: TriadErrors {
            random_walk: 9.8e-4,
            bias_random_walk: 6e-5,
            turn_on_bias: 0.1,
            ..TriadErrors::default()
        },
        ..ImuErrorModel::default()
    };
    let folder = folder_with("rest.csv", &resting_log(1800, &model));
    let args = ["calibrate", "noise", "rest.csv", "-o", "tag.toml", "--plot", "allan.svg", "--json"];
    let Outcome { code, stdout, stderr } = adit(folder.path(), &args);
    assert_eq!(code, 0, "{stderr}");
    let report: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!(report["noise"]["gyro"]["axes"].as_array().unwrap().len(), 3);
    let noise = Sidecar::read(&folder.path().join("tag.toml")).unwrap().noise.unwrap();
    // White noise of half an hour is known within 0.5 %, the worst of three axes lies above the mean; a walk within 40 %.
    assert!((noise.angle_random_walk_rad_sqrt_s / 8.7e-5 - 1.0).abs() < 0.03, "{noise:?}");
    assert!((noise.velocity_random_walk_m_s_sqrt_s / 9.8e-4 - 1.0).abs() < 0.03, "{noise:?}");
    assert!((noise.gyro_bias_walk_rad_s_sqrt_s / 4e-6 - 1.0).abs() < 0.8, "{noise:?}");
    assert!((noise.acc_bias_walk_m_s2_sqrt_s / 6e-5 - 1.0).abs() < 0.8, "{noise:?}");
    let figure = fs::read_to_string(folder.path().join("allan.svg")).unwrap();
    assert!(figure.contains("Allan deviation (rad/s)") && figure.contains("10⁻³"));
}

#[test]
fn what_is_no_rest_is_refused() {
    let model = ImuErrorModel::default();
    let folder = folder_with("rest.csv", &resting_log(60, &model));
    let Outcome { code, stderr, .. } =
        adit(folder.path(), &["calibrate", "noise", "rest.csv", "-o", "tag.toml"]);
    assert_eq!(code, 1);
    assert!(stderr.contains("rest.csv: the longest rest lasts"), "{stderr}");
    assert!(stderr.contains("expected 300 s or more; an hour is better"), "{stderr}");
    assert!(!folder.path().join("tag.toml").exists());
    let folder = folder_with("mag.csv", &tumble(1.0));
    let Outcome { code, stderr, .. } =
        adit(folder.path(), &["calibrate", "noise", "mag.csv", "-o", "tag.toml"]);
    assert!(code == 1 && stderr.contains("0 readings of the gyro"), "{stderr}");
}
