//! A log longer than the memory it may take: reading and writing stream.
//!
//! One test in a process of its own, since the high-water mark of memory is the process's.
#![cfg(target_os = "linux")]
#![expect(clippy::unwrap_used, reason = "tests")]

use adit_observation::files::Input;
use adit_observation::mcap_log::{McapLogWriter, Packing};
use adit_observation::{LogReader, ReadOptions, open};
use std::fmt::Write as _;
use std::io::Read;
use std::path::Path;
use std::sync::Arc;

const ROWS: usize = 250_000;
/// Fixed buffers, the samples looked at first and one MCAP chunk packed and unpacked; the log itself has 40 MB as MCAP.
const ALLOWED_KIB: usize = 12 * 1024;

/// A CSV log made as it is read, never whole in memory.
struct Endless {
    text: String,
    given: usize,
    row: usize,
}

impl Read for Endless {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        if self.given == self.text.len() && self.row < ROWS {
            self.text.clear();
            self.given = 0;
            for row in self.row..(self.row + 100).min(ROWS) {
                let wobble = (row % 977) as f64 * 1e-4;
                writeln!(
                    self.text,
                    "{}.{:03},0.1,{wobble},9.8123,0.0123,-0.4567,{wobble},1.5,2.5,-45.678",
                    row / 1000,
                    row % 1000
                )
                .unwrap();
            }
            self.row += 100;
        }
        let mut rest = &self.text.as_bytes()[self.given..];
        let count = rest.read(buffer)?;
        self.given += count;
        Ok(count)
    }
}

fn high_water_kib() -> usize {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|l| l.starts_with("VmHWM:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse().unwrap()
}

#[test]
fn long_logs_stream_from_csv_to_mcap_and_back() {
    let header = "time_s,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,mag_x_uT,mag_y_uT,mag_z_uT\n";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.mcap");
    let before = high_water_kib();

    let endless = Endless { text: header.to_owned(), given: 0, row: 0 };
    let input = Input::new(Arc::from(Path::new("endless.csv")), Box::new(endless), None).unwrap();
    let mut writer = McapLogWriter::create(&path, Packing::Plain).unwrap();
    for observation in LogReader::from_input(input, &ReadOptions::default()).unwrap() {
        writer.push(&observation.unwrap()).unwrap();
    }
    writer.finish().unwrap();
    assert!(path.metadata().unwrap().len() > 40_000_000);
    assert_eq!(open(&path).unwrap().map(Result::unwrap).count(), 2 * ROWS);

    let grown = high_water_kib() - before;
    println!("memory grew by {grown} KiB");
    assert!(grown < ALLOWED_KIB, "{grown} KiB");
}
