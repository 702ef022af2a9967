//! Sidecars: found beside the log, applied to its samples, refused with file and line.
#![expect(clippy::unwrap_used, clippy::panic, reason = "tests")]

use adit_core::nalgebra::Vector3;
use adit_observation::sidecar::{Location, Sidecar};
use adit_observation::{Observation, open};
use std::path::Path;
use std::sync::Arc;

const LOG: &str = "time_s,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,mag_x_uT,mag_y_uT,mag_z_uT\n\
                   0,1,2,-9.5,0.1,0.2,0.3,10,20,30\n";

fn parse(text: &str) -> Result<Sidecar, String> {
    Sidecar::parse(&Arc::from(Path::new("w.toml")), text.as_bytes()).map_err(|e| e.to_string())
}

#[test]
fn the_documented_example_parses() {
    let source = include_str!("../src/sidecar/mod.rs");
    let example: String = source
        .lines()
        .skip_while(|l| *l != "//! ```toml")
        .skip(1)
        .take_while(|l| *l != "//! ```")
        .map(|l| l.trim_start_matches("//!").trim_start().to_owned() + "\n")
        .collect();
    let sidecar = parse(&example).unwrap();
    assert_eq!(sidecar.rate_hz, Some(200.0));
    assert_eq!(sidecar.mounting.location, Some(Location::Foot));
    assert!(sidecar.noise.is_some());
    assert_eq!(parse("").unwrap(), Sidecar::default());
}

#[test]
fn all_ways_to_give_a_rotation_agree() {
    let turned = |rotation: &str| {
        let sidecar = parse(&format!("[mounting]\nrotation = {rotation}\n")).unwrap();
        *sidecar.mounting.rotation.unwrap().matrix()
    };
    // A sensor upside down: half a turn about x.
    let axes = turned("\"x-forward, y-right, z-down\"");
    assert_eq!(axes * Vector3::new(1.0, 2.0, 3.0), Vector3::new(1.0, -2.0, -3.0));
    assert_eq!(turned("[[1, 0, 0], [0, -1, 0], [0, 0, -1]]"), axes);
    assert!((turned("[0, 1, 0, 0]") - axes).amax() < 1e-15);
    // A quarter turn about z: the sensor's x axis points left.
    let quarter = turned("\"x-left, y-backward, z-up\"");
    assert_eq!(quarter * Vector3::x(), Vector3::y());
    assert!((turned("[0.7071, 0.0, 0.0, 0.7071]") - quarter).amax() < 1e-15);
}

#[test]
fn errors_name_file_and_line() {
    for (text, error) in [
        ("\nrate_hz = 0\n", "w.toml:2: found 0, expected a number above 0"),
        (
            "[mounting]\nplace = \"foot\"\n",
            "w.toml:2: unknown field `place`, expected `location` or `rotation`",
        ),
        ("[noise]\nangle_random_walk_deg = 1\n", "w.toml:2: unknown field `angle_random_walk_deg`"),
        (
            "[mounting]\nrotation = \"x-forward, y-left, z-down\"\n",
            "w.toml:2: the axes \"x-forward, y-left, z-down\" are not a right-handed frame",
        ),
        (
            "[mounting]\nrotation = \"x-forward, y-left\"\n",
            "w.toml:2: found \"x-forward, y-left\", expected all three axes",
        ),
        (
            "[mounting]\nrotation = \"x-north, y-left, z-up\"\n",
            "w.toml:2: found \"x-north\", expected x, y or z",
        ),
        (
            "[mounting]\nrotation = [2, 0, 0, 0]\n",
            "w.toml:2: found a quaternion of length 2, expected length 1",
        ),
        ("[mounting]\nrotation = [[1,0,0],[0,1,0],[0,0,-1]]\n", "w.toml:2: found a reflection"),
        ("[mounting]\nrotation = [[1,0,0],[0,1,0],[0,0,nan]]\n", "w.toml:2: found NaN in the matrix"),
        (
            "[mounting]\nrotation = [[1,0,0],[0,1,0],[0,0,2]]\n",
            "w.toml:2: found rows that are off orthonormal by 3",
        ),
        ("[mounting]\nrotation = [[inf,0,0],[0,1,0],[0,0,1]]\n", "w.toml:2: found inf in the matrix"),
        ("[mounting]\nrotation = [1, 2]\n", "w.toml:2: expected four numbers"),
        ("[mounting]\nlocation = \"moon\"\n", "w.toml:2: unknown variant `moon`"),
        ("rate_hz = 1\nrate_hz = 2\n", "w.toml:2: duplicate key"),
        ("rate_hz 200\n", "w.toml:1: "),
    ] {
        let found = parse(text).unwrap_err();
        assert!(found.starts_with(error), "{found}\n{error}");
        assert!(!found.contains('\n'), "{found}");
    }
}

#[test]
fn the_reader_applies_the_sidecar_it_finds() {
    for name in ["walk_imu.toml", "walk_imu.csv.toml"] {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("walk_imu.csv");
        std::fs::write(&log, LOG).unwrap();
        let text =
            "[mounting]\nrotation = \"x-forward, y-right, z-down\"\n[frame]\nacceleration = \"gravity\"\n";
        std::fs::write(folder.path().join(name), text).unwrap();
        let reader = open(&log).unwrap();
        assert!(reader.sidecar().is_some());
        let observations = reader.collect::<Result<Vec<_>, _>>().unwrap();
        let [Observation::Imu(imu), Observation::Magnetic(magnetic)] = observations[..] else {
            panic!("{observations:?}")
        };
        assert_eq!(imu.specific_force_m_s2, Vector3::new(-1.0, 2.0, -9.5));
        assert_eq!(imu.angular_rate_rad_s, Vector3::new(0.1, -0.2, -0.3));
        assert_eq!(magnetic.field_ut, Vector3::new(10.0, -20.0, -30.0));
    }
}

#[test]
fn two_sidecars_are_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("walk_imu.csv");
    std::fs::write(&log, LOG).unwrap();
    std::fs::write(folder.path().join("walk_imu.toml"), "").unwrap();
    std::fs::write(folder.path().join("walk_imu.csv.toml"), "").unwrap();
    assert!(open(&log).err().unwrap().to_string().contains("this log has two sidecars"));
}
