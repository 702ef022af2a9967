//! Logs of any one sensor, as it said it.
#![expect(clippy::unwrap_used, reason = "tests")]

use adit_core::nalgebra::Vector3;
use adit_observation::csv_log::Row;
use adit_observation::files::Input;
use adit_observation::mcap_log::{McapLogWriter, Packing};
use adit_observation::{LogError, MagneticSample, Observation, SensorRows};

fn rows(text: &str) -> Result<(Vec<Row>, usize), LogError> {
    let mut rows = SensorRows::from_input(Input::from_bytes("log.csv", text.as_bytes())?)?;
    let read = rows.by_ref().collect::<Result<Vec<Row>, LogError>>()?;
    Ok((read, rows.warnings().len()))
}

#[test]
fn an_accelerometer_alone_is_read() {
    let (rows, warnings) = rows("time_s,acc_x_g,acc_y_g,acc_z_g\n0,0,0,1\n0.01,0,1,0\n").unwrap();
    assert_eq!(rows[1].specific_force_m_s2, Some(Vector3::y() * 9.80665));
    assert_eq!((rows[0].angular_rate_rad_s, rows[0].field_ut, rows.len(), warnings), (None, None, 2, 0));
}

#[test]
fn a_gyro_with_a_slow_magnetometer_is_read() {
    let header = "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,mag_x_uT,mag_y_uT,mag_z_uT\n";
    let (rows, _) = rows(&format!("{header}0,1,2,3,,,\n0.01,1,2,3,4,5,6\n")).unwrap();
    assert_eq!((rows[0].field_ut, rows[1].field_ut), (None, Some(Vector3::new(4.0, 5.0, 6.0))));
}

#[test]
fn order_is_checked_and_repetitions_are_dropped() {
    let text = |times: [&str; 3]| {
        format!(
            "time_s,mag_x_uT,mag_y_uT,mag_z_uT\n{},1,2,3\n{},1,2,3\n{},1,2,3\n",
            times[0], times[1], times[2]
        )
    };
    let (read, warnings) = rows(&text(["0", "0", "1"])).unwrap();
    assert_eq!((read.len(), warnings), (2, 1));
    let error = rows(&text(["0", "2", "1"])).unwrap_err().to_string();
    assert!(error.starts_with("log.csv:4: time runs backwards"), "{error}");
}

#[test]
fn no_sidecar_is_applied() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("walk.csv");
    std::fs::write(&log, "time_s,mag_x_uT,mag_y_uT,mag_z_uT\n0,1,2,3\n").unwrap();
    std::fs::write(
        folder.path().join("walk.toml"),
        "[mounting]\nrotation = \"x-forward, y-right, z-down\"\n",
    )
    .unwrap();
    let row = SensorRows::open(&log).unwrap().next().unwrap().unwrap();
    assert_eq!(row.field_ut, Some(Vector3::new(1.0, 2.0, 3.0)));
}

#[test]
fn an_mcap_log_gives_a_row_for_each_message() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.mcap");
    let mut log = McapLogWriter::create(&path, Packing::Lz4).unwrap();
    let field_ut = Vector3::new(1.0, 2.0, 3.0);
    log.push(&Observation::Magnetic(MagneticSample { time: adit_core::time::Time::ZERO, field_ut })).unwrap();
    log.finish().unwrap();
    let rows: Vec<Row> = SensorRows::open(&path).unwrap().map(Result::unwrap).collect();
    assert_eq!((rows.len(), rows[0].field_ut, rows[0].specific_force_m_s2), (1, Some(field_ut), None));
}

#[test]
fn what_is_broken_is_said_once() {
    let mut rows = SensorRows::from_input(
        Input::from_bytes("log.csv", b"time_s,mag_x_uT,mag_y_uT,mag_z_uT\n0,1,x,3\n1,1,2,3\n").unwrap(),
    )
    .unwrap();
    assert!(rows.next().unwrap().unwrap_err().to_string().starts_with("log.csv:2: mag_y_uT: found \"x\""));
    assert!(rows.next().is_none());
}

#[test]
fn a_barometer_is_read_and_what_comes_by_radio_is_passed_over() {
    let header = "time_s,pressure_hPa,anchor,range_m\n";
    // A late range, one without a name, one at the time of a reading that repeats.
    let (read, warnings) =
        rows(&format!("{header}1,1013,,\n0.5,,a,5\n2,,,5\n3,1013.5,a,5\n3,1014,a,5\n")).unwrap();
    let told: Vec<_> = read.iter().map(|row| (row.time.seconds(), row.pressure_pa)).collect();
    assert_eq!((told, warnings), (vec![(1.0, Some(101_300.0)), (3.0, Some(101_350.0))], 1));
    let error = rows(&format!("{header}1,1013,,\n0.5,1013,a,5\n")).unwrap_err().to_string();
    assert!(error.starts_with("log.csv:3: time runs backwards"), "{error}");
}
