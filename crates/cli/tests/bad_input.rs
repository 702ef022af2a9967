//! Whatever is wrong with a log: one line that says where and what, exit code 1, no output file.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{G, HEADER, Outcome, adit, files, log, rest};
use flate2::Compression;
use flate2::write::GzEncoder;
use std::io::Write;
use std::path::PathBuf;

/// Tracks a file of these bytes; the error line, after checking exit code and that nothing was left behind.
fn refused(name: &str, bytes: &[u8]) -> String {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(name), bytes).unwrap();
    let args = [
        "track",
        name,
        "--method",
        "foot-ins",
        "-o",
        "walk.tum",
        "--json",
        "walk.json",
        "--covariance",
        "walk.csv.gz",
    ];
    let Outcome { code, stdout, stderr } = adit(folder.path(), &args);
    assert_eq!((code, stdout.as_str()), (1, ""), "{stderr}");
    assert_eq!(stderr.lines().count(), 1, "{stderr}");
    assert!(stderr.starts_with(&format!("adit: {name}")), "{stderr}");
    assert_eq!(files(folder.path()), [PathBuf::from(name)], "{stderr}");
    stderr.trim_end().to_owned()
}

fn refused_text(text: &str) -> String {
    refused("log.csv", text.as_bytes())
}

/// A log at rest with one row replaced; row 1 stands on line 2.
fn with_row(row: usize, text: &str) -> String {
    let mut rows = rest(2000);
    text.clone_into(&mut rows[row - 1]);
    log(&rows)
}

fn gzip(text: &str) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(text.as_bytes()).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn what_is_not_a_number_is_told_with_its_line() {
    for (row, bad) in [(1, "NaN"), (700, "inf"), (1500, "fast"), (1999, "")] {
        let time_s = f64::from(u32::try_from(row).unwrap() - 1) * 0.005;
        let error = refused_text(&with_row(row, &format!("{time_s},0,0,{G},0,{bad},0")));
        let expected =
            format!("adit: log.csv:{}: gyro_y_rad_s: found \"{bad}\", expected a finite number", row + 1);
        assert_eq!(error, expected);
    }
}

#[test]
fn time_that_runs_backwards_is_told_with_its_line() {
    let error = refused_text(&with_row(1201, &format!("5.5,0,0,{G},0,0,0")));
    assert!(error.starts_with("adit: log.csv:1202: time runs backwards: found 5.5"), "{error}");
    let error = refused_text(&with_row(3, &format!("0.001,0,0,{G},0,0,0")));
    assert!(error.starts_with("adit: log.csv:4: time runs backwards"), "{error}");
}

#[test]
fn a_line_with_a_field_too_few_is_told() {
    let error = refused_text(&with_row(10, "0.045,0,0"));
    assert_eq!(error, "adit: log.csv:11: found 3 fields, expected 7, as in the header");
}

#[test]
fn a_cut_gzip_is_told_with_the_last_line_read() {
    let whole = gzip(&log(&rest(2000)));
    let error = refused("log.csv.gz", &whole[..whole.len() - 20]);
    assert!(error.contains("the gzip file is cut"), "{error}");
    assert!(error.starts_with("adit: log.csv.gz:"), "{error}");
    // The checksum stands in the last eight bytes.
    let mut damaged = whole;
    let checksum = damaged.len() - 8;
    damaged[checksum] ^= 0xff;
    let error = refused("log.csv.gz", &damaged);
    assert!(error.contains("the gzip file is damaged"), "{error}");
}

#[test]
fn a_header_that_lacks_a_column_or_names_no_known_unit_is_told() {
    let rows = rest(10);
    let error = refused_text(&log(&rows).replace("acc_z_m_s2", "height_m"));
    assert!(error.starts_with("adit: log.csv:1: missing column acc_z_m_s2; found time_s"), "{error}");
    for (column, odd) in [("gyro_x_rad_s", "gyro_x_rpm"), ("acc_y_m_s2", "acc_y"), ("time_s", "time_min")] {
        let error = refused_text(&log(&rows).replace(column, odd));
        assert!(error.starts_with(&format!("adit: log.csv:1: column {odd}: unknown unit")), "{error}");
    }
    let error = refused_text("1,2,3,4,5,6,7\n1,2,3,4,5,6,7\n");
    assert!(error.starts_with("adit: log.csv:1: missing column time_s"), "{error}");
}

#[test]
fn numbers_that_contradict_their_unit_are_told() {
    let in_g = log(&rest(2000)).replace(&format!(",{G},"), ",1,");
    let error = refused_text(&in_g);
    assert!(error.contains("this looks like g, not m/s²"), "{error}");
    let error = refused_text(&log(&rest(2000)).replace("m_s2", "g"));
    assert!(error.contains("this looks like m/s², not g"), "{error}");
    let error = refused_text(&with_row(1700, &format!("8.495,0,0,{G},0,200,0")));
    assert!(error.starts_with("adit: log.csv:1701: angular rate") && error.contains("deg/s"), "{error}");
}

#[test]
fn a_log_with_nothing_in_it_is_told() {
    assert!(refused_text("").contains("the file is empty"));
    assert!(refused_text(&format!("{HEADER}\n")).contains("the file ends before the first observation"));
    let magnetic_only = "time_s,mag_x_uT,mag_y_uT,mag_z_uT\n0,20,0,40\n0.1,20,0,40\n";
    let error = refused_text(magnetic_only);
    assert!(error.contains("no IMU sample"), "{error}");
}

#[test]
fn a_file_that_is_no_log_is_told() {
    assert!(refused("log.mcap", b"\x89MCAP0\r\n").contains("the MCAP file is cut"));
    let noise: Vec<u8> =
        (0..100_000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8 | 0x80).collect();
    refused("log.csv", &noise);
}

#[test]
fn a_log_that_is_not_there_or_a_folder_is_told() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("logs")).unwrap();
    for (name, expected) in [("none.csv", "No such file"), ("logs", "is a directory")] {
        let Outcome { code, stderr, .. } =
            adit(folder.path(), &["track", name, "--method", "foot-ins", "-o", "walk.tum"]);
        assert_eq!(code, 1);
        assert!(
            stderr.starts_with(&format!("adit: {name}: cannot ")) && stderr.contains(expected),
            "{stderr}"
        );
        assert_eq!(stderr.matches(expected).count(), 1, "{stderr}");
        assert!(!folder.path().join("walk.tum").exists());
    }
}

#[test]
fn an_output_that_cannot_be_made_is_told_and_an_old_one_survives_a_bad_log() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("log.csv"), log(&rest(2000))).unwrap();
    let Outcome { code, stderr, .. } =
        adit(folder.path(), &["track", "log.csv", "--method", "foot-ins", "-o", "none/walk.tum"]);
    assert!(code == 1 && stderr.starts_with("adit: none/walk.tum: cannot create it"), "{stderr}");

    std::fs::write(path("walk.tum"), "precious").unwrap();
    std::fs::write(path("bad.csv"), with_row(1500, "7.495,0")).unwrap();
    let Outcome { code, .. } =
        adit(folder.path(), &["track", "bad.csv", "--method", "foot-ins", "-o", "walk.tum"]);
    assert_eq!(code, 1);
    assert_eq!(std::fs::read_to_string(path("walk.tum")).unwrap(), "precious");
}

#[test]
fn a_config_with_an_unknown_name_is_told_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("log.csv"), log(&rest(2000))).unwrap();
    std::fs::write(folder.path().join("foot.toml"), "# mine\nboots = 2\n").unwrap();
    let args = ["track", "log.csv", "--method", "foot-ins", "-o", "walk.tum", "--config", "foot.toml"];
    let Outcome { code, stderr, .. } = adit(folder.path(), &args);
    assert_eq!(code, 1);
    assert!(stderr.starts_with("adit: foot.toml:2: unknown field `boots`"), "{stderr}");
    assert_eq!(stderr.lines().count(), 1, "{stderr}");
    assert!(!folder.path().join("walk.tum").exists());
}
