//! Sidecars: found beside the log, applied to its samples, refused with file and line.
#![expect(clippy::unwrap_used, clippy::panic, reason = "tests")]

use adit_core::nalgebra::{Matrix3, Vector3};
use adit_observation::sidecar::{
    Location, MagneticFieldReference, MagnetometerCalibration, Sidecar, SidecarEdit,
};
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
    assert!(sidecar.noise.is_some() && sidecar.magnetometer.is_some());
    assert_eq!(sidecar.magnetic_field.dip_deg, Some(67.1));
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

const CALIBRATION: &str =
    "[magnetometer]\noffset_ut = [1.0, -2.0, 3.0]\nmatrix = [[2, 0, 0], [0, 1, 0.5], [0, 0, 1]]\n";

#[test]
fn the_magnetometer_is_calibrated_before_it_is_turned() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("walk_imu.csv");
    std::fs::write(&log, LOG).unwrap();
    let text = format!("[mounting]\nrotation = \"x-forward, y-right, z-down\"\n{CALIBRATION}");
    std::fs::write(folder.path().join("walk_imu.toml"), text).unwrap();
    let observations = open(&log).unwrap().collect::<Result<Vec<_>, _>>().unwrap();
    let Observation::Magnetic(magnetic) = observations[1] else { panic!("{observations:?}") };
    // Reading (10, 20, 30) less the offset: (9, 22, 27); times the matrix: (18, 35.5, 27); then half a turn about x.
    assert_eq!(magnetic.field_ut, Vector3::new(18.0, -35.5, -27.0));
    assert!(!parse(CALIBRATION).unwrap().leaves_samples_alone());
}

#[test]
fn a_calibration_that_cannot_be_is_refused() {
    for (text, error) in [
        ("[magnetometer]\noffset_ut = [1, 2]\nmatrix = [[1,0,0],[0,1,0],[0,0,1]]\n", "w.toml:2: "),
        ("[magnetometer]\noffset_ut = [1, 2, 3]\n", "w.toml:1: missing field `matrix`"),
        (
            "[magnetometer]\noffset_ut = [0, 0, 0]\nmatrix = [[1,0,0],[0,1,0],[1,1,0]]\n",
            "w.toml:1: found a matrix with axes of length ",
        ),
        (
            "[magnetometer]\noffset_ut = [0, nan, 0]\nmatrix = [[1,0,0],[0,1,0],[0,0,1]]\n",
            "w.toml:1: found NaN",
        ),
        (
            "[magnetometer]\noffset_ut = [0, 0, 0]\nmatrix = [[inf,0,0],[0,1,0],[0,0,1]]\n",
            "w.toml:1: found inf",
        ),
        (
            "[magnetometer]\noffset_ut = [0, 0, 0]\nmatrix = [[0,0,0],[0,0,0],[0,0,0]]\n",
            "w.toml:1: found a matrix",
        ),
        ("[magnetic_field]\nnorm_ut = -1\n", "w.toml:2: found -1, expected a number above 0"),
        ("[magnetic_field]\ndip_deg = 91\n", "w.toml:2: found 91, expected a dip from -90 to 90"),
        ("[magnetic_field]\ndeclination = 3\n", "w.toml:2: unknown field `declination`"),
    ] {
        let found = parse(text).unwrap_err();
        assert!(found.starts_with(error), "{found}\n{error}");
        assert!(!found.contains('\n'), "{found}");
    }
}

#[test]
fn an_edit_keeps_what_it_does_not_change() {
    let before = "# tag 7, left boot\nrate_hz = 200.0   # nominal\n\n[mounting]\nlocation = \"foot\"\n\n[magnetometer]  # last spring\n\
                  offset_ut = [1.0, 2.0, 3.0]  # hard iron\nmatrix = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n\n[frame]\nmagnetic_declination_deg = 3.2 # mine office\n";
    let mut edit = SidecarEdit::parse(Path::new("w.toml"), before.as_bytes()).unwrap();
    let calibration =
        MagnetometerCalibration::new(Vector3::new(-1.5, 20.25, 1e-7), Matrix3::identity() * 1.25).unwrap();
    edit.set_magnetometer(&calibration);
    edit.set_declination_deg(4.0);
    edit.set_magnetic_field(&MagneticFieldReference { norm_ut: Some(49.5), dip_deg: None });
    let after = edit.text().unwrap();
    for kept in [
        "# tag 7, left boot\n",
        "rate_hz = 200.0   # nominal\n",
        "location = \"foot\"\n",
        "[magnetometer]  # last spring\n",
        "# hard iron\n",
    ] {
        assert!(after.contains(kept), "{after}");
    }
    assert!(after.contains("magnetic_declination_deg = 4.0 # mine office\n"), "{after}");
    let sidecar = parse(&after).unwrap();
    assert_eq!(sidecar.magnetometer, Some(calibration));
    assert_eq!(sidecar.magnetic_field, MagneticFieldReference { norm_ut: Some(49.5), dip_deg: None });
    assert_eq!(sidecar.rate_hz, Some(200.0));
    // The same edit again changes nothing.
    let mut again = SidecarEdit::parse(Path::new("w.toml"), after.as_bytes()).unwrap();
    again.set_magnetometer(&calibration);
    again.set_declination_deg(4.0);
    assert_eq!(again.text().unwrap(), after);
}

#[test]
fn an_edit_finds_tables_however_they_are_written() {
    let noise = adit_observation::ImuSpecification {
        angle_random_walk_rad_sqrt_s: 8.7e-5,
        velocity_random_walk_m_s_sqrt_s: 9.8e-4,
        gyro_bias_walk_rad_s_sqrt_s: 1e-6,
        acc_bias_walk_m_s2_sqrt_s: 0.0,
    };
    for before in [
        "",
        "frame.magnetic_declination_deg = 1.0\n",
        "frame = { magnetic_declination_deg = 1.0 }\n",
        "[noise]\nangle_random_walk_rad_sqrt_s = 1.0\nvelocity_random_walk_m_s_sqrt_s = 1.0\ngyro_bias_walk_rad_s_sqrt_s = 1.0\nacc_bias_walk_m_s2_sqrt_s = 1.0",
    ] {
        let mut edit = SidecarEdit::parse(Path::new("w.toml"), before.as_bytes()).unwrap();
        edit.set_noise(&noise);
        edit.set_declination_deg(-7.5);
        let sidecar = parse(&edit.text().unwrap()).unwrap();
        assert_eq!(sidecar.noise, Some(noise), "{before}");
        assert_eq!(sidecar.frame.magnetic_declination_deg, Some(-7.5), "{before}");
    }
}

#[test]
fn a_file_that_is_no_sidecar_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("notes.toml");
    std::fs::write(&path, "title = \"my notes\"\n").unwrap();
    assert!(
        SidecarEdit::open(&path).unwrap_err().to_string().contains("notes.toml:1: unknown field `title`")
    );
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "title = \"my notes\"\n");
    // Where there is none, one is made, whole.
    let fresh = folder.path().join("tag.toml");
    let mut edit = SidecarEdit::open(&fresh).unwrap();
    edit.set_declination_deg(3.0);
    assert!(!fresh.exists());
    edit.write().unwrap();
    assert_eq!(Sidecar::read(&fresh).unwrap().frame.magnetic_declination_deg, Some(3.0));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn site_and_start_are_read_written_and_checked() {
    use adit_observation::{Site, StartPose};
    let sidecar = parse(
        "[site]\nlatitude_deg = 45.7\nlongitude_deg = 121.3833\n[start]\nposition_m = [1.5, -2]\n\
         position_sigma_m = [26.0, 37.0]\nheading_deg = 91.25\nattitude_sigma_deg = 0.6\n",
    )
    .unwrap();
    let (site, start) = (sidecar.site.unwrap(), sidecar.start.unwrap());
    assert_eq!(site, Site { latitude_deg: 45.7, longitude_deg: 121.3833, height_m: 0.0 });
    assert_eq!((start.position_m, start.heading_deg, start.pitch_deg), ([1.5, -2.0], 91.25, 0.0));

    let mut edit = SidecarEdit::parse(Path::new("w.toml"), b"rate_hz = 10.0 # of the gyro\n").unwrap();
    edit.set_site(&site);
    edit.set_start(&start);
    let text = edit.text().unwrap();
    assert!(text.contains("# of the gyro"));
    let back = parse(&text).unwrap();
    assert_eq!((back.site, back.start), (Some(site), Some(start)));

    // Angles go to an attitude and back.
    let turned = StartPose { pitch_deg: -3.0, roll_deg: 5.0, ..start };
    let [heading, pitch, roll] = StartPose::angles_deg(&turned.attitude());
    assert!((heading - 91.25).abs() + (pitch + 3.0).abs() + (roll - 5.0).abs() < 1e-12);

    let refused = |text: &str| parse(text).unwrap_err();
    assert!(
        refused("[site]\nlatitude_deg = 90.0\nlongitude_deg = 0.0\n").contains("expected -89 to 89 degrees")
    );
    let negative =
        "[start]\nposition_m = [0, 0]\nposition_sigma_m = [-1, 1]\nheading_deg = 0\nattitude_sigma_deg = 1\n";
    assert!(refused(negative).contains("w.toml:1: found a value that is no place"));
    assert!(refused("[start]\nheading_deg = 0\n").contains("missing field"));
}
