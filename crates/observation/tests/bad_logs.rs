//! Bad logs: each a clear error with file and line, or a documented warning where work can go on.
#![expect(clippy::unwrap_used, clippy::panic, reason = "tests")]

mod common;

use adit_observation::{LogWarning, Observation, ReadOptions, open, open_with};
use common::{csv_log, error_of, gzip, read_all};

const HEADER: &str = "time_s,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s\n";

fn rows_of(count: i32, row: impl Fn(i32) -> String) -> String {
    (0..count).map(row).collect()
}

fn with_rows(rows: &str) -> Vec<u8> {
    format!("{HEADER}{rows}").into_bytes()
}

#[test]
fn an_empty_file_is_named_as_such() {
    assert_eq!(
        error_of("a.csv", b""),
        "a.csv: the file is empty, expected a header such as time_s,acc_x_m_s2,…"
    );
    assert!(error_of("a.csv", b"\n\n").contains("the file is empty"));
    assert!(error_of("a.csv.gz", &gzip(b"")).contains("the file is empty"));
}

#[test]
fn a_header_without_rows_is_no_log() {
    assert_eq!(error_of("a.csv", HEADER.as_bytes()), "a.csv: the file ends before the first observation");
}

#[test]
fn a_missing_column_is_named_with_what_was_found() {
    let text = HEADER.replace(",gyro_y_rad_s", "") + "0,0,0,9.8,0,0\n";
    assert_eq!(
        error_of("a.csv", text.as_bytes()),
        "a.csv:1: missing column gyro_y_rad_s; found time_s, acc_x_m_s2, acc_y_m_s2, acc_z_m_s2, gyro_x_rad_s, gyro_z_rad_s"
    );
    assert!(error_of("a.csv", b"acc_x_m_s2\n1\n").contains("missing column time_s; found acc_x_m_s2"));
    assert!(error_of("a.csv", b"\x00\xff\xfe\n1\n").contains("missing column time_s"));
}

#[test]
fn an_unknown_unit_is_named_with_those_accepted() {
    let text = HEADER.replace("acc_x_m_s2", "acc_x_ft_s2") + "0,0,0,9.8,0,0,0\n";
    assert_eq!(
        error_of("a.csv", text.as_bytes()),
        "a.csv:1: column acc_x_ft_s2: unknown unit, expected acc_x_m_s2, acc_x_g"
    );
    for (bad, accepted) in [
        ("time_min", "time_s, time_ms, time_us, time_ns"),
        ("time", "time_s, time_ms, time_us, time_ns"),
        ("gyro_x_rpm", "gyro_x_rad_s, gyro_x_deg_s"),
        ("gyro_x", "gyro_x_rad_s, gyro_x_deg_s"),
        ("mag_x_T", "mag_x_uT, mag_x_nT, mag_x_gauss, mag_x_mT"),
    ] {
        let header = if bad.starts_with("time") { bad.to_owned() } else { format!("time_s,{bad}") };
        let error = error_of("a.csv", format!("{header}\n").as_bytes());
        assert_eq!(error, format!("a.csv:1: column {bad}: unknown unit, expected {accepted}"));
    }
}

#[test]
fn two_columns_for_one_quantity_are_refused() {
    let text = HEADER.replace("acc_y_m_s2", "acc_x_g");
    assert!(
        error_of("a.csv", text.as_bytes()).contains("columns acc_x_m_s2 and acc_x_g give the same quantity")
    );
    let text = HEADER.replace("acc_y_m_s2", "time_ns");
    assert!(error_of("a.csv", text.as_bytes()).contains("columns time_s and time_ns give the same quantity"));
}

#[test]
fn a_field_that_is_no_finite_number_is_named_with_its_line() {
    for bad in ["", "NaN", "inf", "-inf", "1.2.3", "abc", "1e999", "0x1p3"] {
        let error = error_of("a.csv", &with_rows(&format!("0,0,0,9.8,0,0,0\n0.005,0,{bad},9.8,0,0,0\n")));
        assert_eq!(error, format!("a.csv:3: acc_y_m_s2: found \"{bad}\", expected a finite number"));
    }
    for bad in ["", "noon", "nan", "1e40"] {
        let error = error_of("a.csv", &with_rows(&format!("{bad},0,0,9.8,0,0,0\n")));
        assert!(error.starts_with(&format!("a.csv:2: time_s: found \"{bad}\", expected a time")), "{error}");
    }
}

#[test]
fn a_line_of_other_length_is_named() {
    let error = error_of("a.csv", &with_rows("0,0,0,9.8,0,0,0\n0.005,0,0,9.8,0\n"));
    assert_eq!(error, "a.csv:3: found 5 fields, expected 7, as in the header");
}

#[test]
fn time_running_backwards_is_an_error_with_both_times() {
    let error = error_of("a.csv", &with_rows("0,0,0,9.8,0,0,0\n0.01,0,0,9.8,0,0,0\n0.005,0,0,9.8,0,0,0\n"));
    assert_eq!(error, "a.csv:4: time runs backwards: found 0.005000000 s, expected more than 0.010000000 s");
}

#[test]
fn repeated_rows_are_dropped_and_counted() {
    let text = csv_log(4)
        + "0.015,0.1,0,9.8,0,0,0,1,1,1\n"
        + "0.015,0.1,0,9.8,0,0,0,1,1,1\n"
        + "0.02,0.1,0,9.8,0,0,0,1,1,1\n";
    let (observations, warnings) = read_all("a.csv", text.as_bytes()).unwrap();
    let imu = observations.iter().filter(|o| matches!(o, Observation::Imu(_))).count();
    assert_eq!(imu, 5);
    let text: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    assert_eq!(text, ["a.csv:6: dropped repetitions (same source, same time), from here on: 2"]);
}

#[test]
fn a_gap_is_a_warning_with_its_length() {
    let (observations, warnings) =
        read_all("a.csv", &with_rows("0,0,0,9.8,0,0,0\n0.005,0,0,9.8,0,0,0\n1.005,0,0,9.8,0,0,0\n")).unwrap();
    assert_eq!(observations.len(), 3);
    assert!(matches!(warnings[..], [LogWarning::Gap { .. }]));
    assert_eq!(
        warnings[0].to_string(),
        "a.csv:4: no inertial sample for 1 s (from 0.005000000 s to 1.005000000 s, limit 0.25 s)"
    );
}

#[test]
fn many_gaps_are_counted_in_bounded_memory() {
    let rows = rows_of(10_000, |s| format!("{s},0,0,9.8,0,0,0\n"));
    let (_, warnings) = read_all("a.csv", &with_rows(&rows)).unwrap();
    assert_eq!(warnings.len(), 21);
    assert_eq!(warnings[20].to_string(), "a.csv: 9979 more gaps, the longest of 1 s");
}

#[test]
fn a_cut_gzip_log_gives_its_rows_and_then_the_line_reached() {
    let packed = gzip(csv_log(20_000).as_bytes());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.csv.gz");
    std::fs::write(&path, &packed[..packed.len() / 2]).unwrap();
    let mut log = open(&path).unwrap();
    let good = log.by_ref().take_while(Result::is_ok).count();
    assert!(good > 5000, "{good}");
    assert!(log.next().is_none());

    let error = error_of("cut.csv.gz", &packed[..packed.len() / 2]);
    assert!(error.starts_with("cut.csv.gz:") && error.contains("the gzip file is cut"), "{error}");
    let line: usize = error.split(':').nth(1).unwrap().parse().unwrap();
    // A row with a magnetic reading gives two observations.
    assert!(line.abs_diff(good * 2 / 3) < 5, "{line} {good}");

    let error = error_of("cut.csv.gz", &packed[..5]);
    assert!(error.contains("the gzip file is cut"), "{error}");
}

#[test]
fn a_damaged_gzip_log_is_an_error() {
    let mut packed = gzip(csv_log(5000).as_bytes());
    let end = packed.len() - 6;
    packed[end] ^= 0xff;
    let error = error_of("a.csv.gz", &packed);
    assert!(error.contains("the gzip file is damaged"), "{error}");
}

#[test]
fn g_under_the_name_of_metres_per_second_squared_is_found_by_gravity() {
    let rows: String = rows_of(100, |i| format!("{},0.02,0.01,0.999,0,0,0\n", f64::from(i) / 100.0));
    let error = error_of("a.csv", &with_rows(&rows));
    assert_eq!(
        error,
        "a.csv:101: specific force at rest: found a median of 0.999 m/s² after conversion, expected about 9.8 m/s²: \
         this looks like g, not m/s² (or gravity has been taken out)"
    );
    let rows = rows_of(100, |i| format!("{},0.2,0.1,9.8,0,0,0\n", f64::from(i) / 100.0));
    let text = (HEADER.to_owned() + &rows).replace("_m_s2", "_g");
    assert!(error_of("a.csv", text.as_bytes()).contains("this looks like m/s², not g"));
}

#[test]
fn degrees_under_the_name_of_radians_are_found_when_too_fast() {
    let rows = rows_of(100, |i| format!("{},0.2,0.1,9.8,0,{i},0\n", f64::from(i) / 100.0));
    let error = error_of("a.csv", &with_rows(&rows));
    assert_eq!(
        error,
        "a.csv:78: angular rate: found 76.0 rad/s on one axis, expected at most 75 rad/s: this looks like deg/s, not rad/s"
    );
}

#[test]
fn units_are_not_judged_when_told_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    let rows: String = rows_of(100, |i| format!("{},0.02,0.01,0.999,0,0,0\n", f64::from(i) / 100.0));
    std::fs::write(&path, with_rows(&rows)).unwrap();
    let options = ReadOptions { check_units: false, ..ReadOptions::default() };
    assert_eq!(open_with(&path, &options).unwrap().count(), 100);
}

#[test]
fn a_line_without_an_end_does_not_fill_the_memory() {
    let mut text = HEADER.as_bytes().to_vec();
    text.resize(10_000_000, b'1');
    let error = error_of("a.csv", &text);
    assert_eq!(error, "a.csv:1: a line of more than 65536 bytes follows: this is not a text log");
}

#[test]
fn what_is_no_file_is_an_error_with_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let error = open(folder.path()).err().unwrap().to_string();
    assert!(error.contains("cannot read it"), "{error}");
    let absent = folder.path().join("absent.csv");
    let error = open(&absent).err().unwrap().to_string();
    assert!(error.starts_with(&format!("{}: cannot open it", absent.display())), "{error}");
}

#[test]
fn columns_may_come_in_any_order_with_other_units_and_strangers_between() {
    let text = "temperature_degC,gyro_z_deg_s,gyro_y_deg_s,gyro_x_deg_s,time_us,acc_x_g,acc_y_g,acc_z_g,mag_x_nT,mag_y_gauss,mag_z_mT\r\n\
                # a comment\r\n\
                21,180,90,-180,1511374923123456.789,0,0.5,1,45123,0.25,0.05\r\n";
    let (observations, warnings) = read_all("a.csv", text.as_bytes()).unwrap();
    let [Observation::Imu(imu), Observation::Magnetic(magnetic)] = observations[..] else {
        panic!("{observations:?}")
    };
    let pi = std::f64::consts::PI;
    assert_eq!(imu.time.nanos(), 1_511_374_923_123_456_789);
    assert_eq!(imu.angular_rate_rad_s.as_slice(), [-pi, pi / 2.0, pi]);
    assert_eq!(imu.specific_force_m_s2.as_slice(), [0.0, 4.903_325, 9.806_65]);
    assert_eq!(magnetic.field_ut.as_slice(), [45.123, 25.0, 50.0]);
    assert_eq!(magnetic.time, imu.time);
    assert_eq!(
        warnings.iter().map(ToString::to_string).collect::<Vec<_>>(),
        ["a.csv:1: ignored columns that are not known: temperature_degC"]
    );
}
