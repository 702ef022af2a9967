//! Valid files with bits flipped, ends cut, pieces moved and numbers swapped: no panic, no unbounded memory, an answer
//! or one clear line. The short run of the fuzz targets in `fuzz/` that needs nothing but stable Rust.
//!
//! Each parser gets a second of mutations from a fixed seed; `ADIT_MUTATION_SECONDS` makes it longer.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;
#[path = "../../../fuzz/src/lib.rs"]
mod parsers;

use adit_observation::mcap_log::Packing;
use adit_observation::{ImpulseResponse, LogError, Observation};
use common::{csv_log, gzip, mcap, read_all};
use parsers::{
    check, parse_log, parse_sensor_rows, parse_sidecar, parse_solution_csv, parse_truth, parse_tum,
};
use proptest::prelude::Rng;
use proptest::test_runner::{RngAlgorithm, TestRng};
use std::fmt::Write;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// What mutations like to put in place of text.
const TOKENS: [&[u8]; 16] = [
    b"NaN",
    b"inf",
    b"-",
    b"1e308",
    b"1e-320",
    b",",
    b"\n",
    b"\"",
    b"#",
    b"0",
    b"-0",
    b"99999999999999999999",
    b"\x00",
    b"\xff\xfe",
    b"time_s",
    b"=",
];

struct Mutator(TestRng);

impl Mutator {
    fn below(&mut self, limit: usize) -> usize {
        usize::try_from(self.0.next_u64() % limit.max(1) as u64).unwrap()
    }

    fn mutate(&mut self, bytes: &mut Vec<u8>, other: &[u8]) {
        for _ in 0..=self.below(3) {
            let at = self.below(bytes.len());
            match self.below(8) {
                0 => bytes.truncate(at),
                1 | 2 if !bytes.is_empty() => bytes[at] ^= 1 << self.below(8),
                3 if !bytes.is_empty() => bytes[at] = self.below(256).to_le_bytes()[0],
                4 => {
                    // A piece of another file of the same kind.
                    let from = self.below(other.len());
                    let to = from + self.below((other.len() - from).min(400));
                    bytes.splice(at..at, other[from..to].iter().copied());
                }
                5 => {
                    let end = at + self.below((bytes.len() - at).min(200));
                    bytes.drain(at..end);
                }
                6 => {
                    let token = TOKENS[self.below(TOKENS.len())];
                    let end = (at + self.below(6)).min(bytes.len());
                    bytes.splice(at..end, token.iter().copied());
                }
                _ => {
                    // A length field gone mad.
                    let end = (at + 8).min(bytes.len());
                    let value = self.0.next_u64() >> self.below(64);
                    bytes.splice(at..end, value.to_le_bytes());
                }
            }
        }
    }
}

/// Mutates the seeds for a second; the parser must take every seed as it is, and answer to everything else.
fn drive(name: &str, parse: fn(&[u8]) -> Result<usize, LogError>, seeds: &[Vec<u8>]) {
    for seed in seeds {
        assert!(parse(seed).unwrap() > 0, "a seed is a valid file");
    }
    // The fuzz targets start from the same files.
    if let Some(folder) = std::env::var_os("ADIT_SEEDS") {
        let target = name.split_once(' ').map_or(name, |(target, _)| target);
        let folder = std::path::Path::new(&folder).join(target);
        std::fs::create_dir_all(&folder).unwrap();
        for (number, seed) in seeds.iter().enumerate() {
            std::fs::write(folder.join(format!("{name} {number}")), seed).unwrap();
        }
    }
    let seconds = std::env::var("ADIT_MUTATION_SECONDS").ok().and_then(|s| s.parse().ok()).unwrap_or(1.0);
    let end = Instant::now() + Duration::from_secs_f64(seconds);
    let mut mutator = Mutator(TestRng::from_seed(RngAlgorithm::ChaCha, &[7; 32]));
    let (mut runs, mut accepted) = (0, 0);
    while Instant::now() < end {
        let mut bytes = seeds[mutator.below(seeds.len())].clone();
        let other = &seeds[mutator.below(seeds.len())];
        mutator.mutate(&mut bytes, other);
        accepted += usize::from(check(parse(&bytes)).is_some());
        runs += 1;
    }
    println!("{runs} mutations, {accepted} of them still valid");
    assert!(runs > 50 && accepted < runs);
}

#[test]
fn csv_logs() {
    let plain = csv_log(30).into_bytes();
    let other = b"time_us,gyro_z_deg_s,gyro_y_deg_s,gyro_x_deg_s,acc_x_g,acc_y_g,acc_z_g,extra\n1e3,0,0,0,0,0,1,x\n2e3,1,0,0,0,0,1,\n";
    drive("log csv", parse_log, &[plain, other.to_vec()]);
}

/// Fixes beside inertial samples and alone, with every column that they may have.
const FIXES: [&str; 2] = [
    "time_s,fix_east_m,fix_north_m,fix_cov_e_e_m2,fix_cov_e_n_m2,fix_cov_n_n_m2,fix_up_m,fix_up_sigma_m,fix_source\n\
     0,1,2,0.25,0.01,0.5,-3,0.1,wifi\n1,1,2,0.25,-0.01,0.5,,,uwb\n",
    "time_s,acc_x_g,acc_y_g,acc_z_g,gyro_x_deg_s,gyro_y_deg_s,gyro_z_deg_s,fix_east_m,fix_north_m,fix_sigma_m\n\
     0,0,0,1,0,0,0,,,\n0.1,0,0,1,0,0,0,12.5,-3,0.086\n",
];

#[test]
fn logs_with_fixes() {
    drive("log fixes", parse_log, &FIXES.map(|text| text.as_bytes().to_vec()));
    let observations = FIXES.map(|text| read_all("seed.csv", text.as_bytes()).unwrap().0);
    drive("log fixes mcap", parse_log, &observations.map(|log| mcap(&log, Packing::Plain)));
}

/// What comes by radio: alone, beside inertial samples, with all that a device may tell, late and twice.
const RADIO: [&str; 4] = [
    "time_s,tag_id,anchor_id,range_m,range_sigma_m,line_of_sight,valid,radio,rx_power_dBm,first_path_power_dBm,\
     first_path_index_tap,peak_index_tap,first_path_amp1,first_path_amp2,first_path_amp3,noise_std,noise_max,preamble_count\n\
     0,1,7475,3.23,0.1,0.25,1,uwb,-79.5,-81.25,745.312,747,14808,14198,9559,48,1236,230\n\
     0,1,7475,3.25,0.1,0.25,1,uwb,-inf,,,,,,,,,\n1,2,a,-0.5,,,0,,,,,,,,,,,\n0.5,2,a,1e3,,,1,,,,,,,,,,,\n",
    "time_ms,range_a0_m,range_a1_mm,tag,reader,radio\n0,3.3,4787,t,,uwb\n104,,5000,t,portal,\n50,1,,,portal,wifi\n",
    "time_s,acc_x_g,acc_y_g,acc_z_g,gyro_x_deg_s,gyro_y_deg_s,gyro_z_deg_s,pressure_hPa,beacon,rssi_dBm\n\
     0,0,0,1,0,0,0,1013.25,b1,-70\n0.1,0,0,1,0,0,0,,b2,-71\n0.2,0,0,1,0,0,0,1013.3,b1,\n",
    "time_s,access_point,rssi_dBm,radio,pressure_Pa\n60,ap,-60.5,wifi,97727.73\n60,ap2,-70,,\n5,ap,-60,,\n60.1,ap,-60,ble,97727.7\n",
];

#[test]
fn logs_with_radio() {
    drive("log radio", parse_log, &RADIO.map(|text| text.as_bytes().to_vec()));
    drive(
        "sensor_rows radio",
        parse_sensor_rows,
        &RADIO[2..].iter().map(|text| text.as_bytes().to_vec()).collect::<Vec<_>>(),
    );
}

#[test]
fn mcap_logs_with_radio() {
    let mut logs = RADIO.map(|text| read_all("seed.csv", text.as_bytes()).unwrap().0);
    if let Observation::Range(range) = &mut logs[0][0] {
        let taps = (0..60).map(|tap| [tap * 300, -tap]).collect();
        let mut told = range.reception.as_deref().cloned().unwrap_or_default();
        told.impulse_response = Some(ImpulseResponse { first_tap: 700, taps });
        range.reception = Some(Arc::new(told));
    }
    drive("log radio mcap", parse_log, &logs.clone().map(|log| without_checksum(mcap(&log, Packing::Plain))));
    drive("log radio packed", parse_log, &logs.map(|log| mcap(&log, Packing::Lz4)));
}

#[test]
fn logs_of_one_sensor() {
    let force = b"time_s,acc_x_g,acc_y_g,acc_z_g\n0,0,0,1\n0.01,0,0.5,1\n0.02,0,0,1\n";
    let mixed = b"time_ms,gyro_x_deg_s,gyro_y_deg_s,gyro_z_deg_s,mag_x_nT,mag_y_nT,mag_z_nT\n0,1,2,3,,,\n10,1,2,3,4,5,6\n";
    let observations = read_all("seed.csv", csv_log(20).as_bytes()).unwrap().0;
    drive(
        "sensor_rows",
        parse_sensor_rows,
        &[force.to_vec(), mixed.to_vec(), mcap(&observations, Packing::Plain)],
    );
}

#[test]
fn gzip_logs() {
    drive("log gzip", parse_log, &[gzip(csv_log(60).as_bytes()), gzip(csv_log(2).as_bytes())]);
}

#[test]
fn plain_mcap_logs() {
    let observations = read_all("seed.csv", csv_log(20).as_bytes()).unwrap().0;
    drive(
        "log mcap",
        parse_log,
        &[mcap(&observations, Packing::Plain), mcap(&observations[..3], Packing::Plain)],
    );
}

#[test]
fn mcap_chunks_without_a_checksum() {
    // Past the checksum, mutations reach the records and messages themselves.
    let observations = read_all("seed.csv", csv_log(20).as_bytes()).unwrap().0;
    let unchecked = |packing| without_checksum(mcap(&observations, packing));
    drive("log unchecked", parse_log, &[unchecked(Packing::Plain), unchecked(Packing::Lz4)]);
}

/// The file with a first chunk that has no checksum.
fn without_checksum(mut bytes: Vec<u8>) -> Vec<u8> {
    let chunk = first_chunk(&bytes);
    // Times (16 bytes) and size (8 bytes) stand before the checksum; zero means none.
    bytes[chunk + 24..chunk + 28].fill(0);
    bytes
}

/// Where the body of the first chunk record starts.
fn first_chunk(bytes: &[u8]) -> usize {
    let mut at = 8;
    while bytes[at] != mcap::records::op::CHUNK {
        at += 9 + usize::try_from(u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap())).unwrap();
    }
    at + 9
}

#[test]
fn packed_mcap_logs() {
    let observations = read_all("seed.csv", csv_log(200).as_bytes()).unwrap().0;
    drive(
        "log packed",
        parse_log,
        &[mcap(&observations, Packing::Lz4), mcap(&observations[..9], Packing::Lz4)],
    );
}

#[test]
fn tum_trajectories() {
    let mut text = String::from("# t x y z qx qy qz qw\n");
    for i in 0..20 {
        writeln!(text, "15113749{i:02}.123456789 {i} -0.5 1e-3 0 0 0.6 0.8").unwrap();
    }
    drive("tum", parse_tum, &[text.into_bytes(), b"0 1 2 3 0 0 0 1\n".to_vec()]);
}

#[test]
fn truth_files() {
    let full =
        "time_s,x_m,y_m,z_m,qw,qx,qy,qz,moving\n0,1,2,3,1,0,0,0,0\n0.01,,,,,,,,1\n0.02,1,2,3,0,1,0,0,1\n";
    drive("truth", parse_truth, &[full.into(), b"time_ms,x_m,y_m,floor\n0,1,2,-2\n5,1,2,-2\n".to_vec()]);
}

#[test]
fn solution_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    let mut writer = adit_observation::solution_csv::SolutionWriter::create(&path).unwrap();
    for nanos in 0..5 {
        let mut solution = adit_core::solution::Solution {
            time: adit_core::time::Time::from_nanos(nanos * 5_000_000),
            position_m: adit_core::nalgebra::Vector3::new(1.0, 2.0, 3.0),
            velocity_m_s: adit_core::nalgebra::Vector3::zeros(),
            attitude: adit_core::attitude::Attitude::identity(),
            covariance: adit_core::solution::SolutionCovariance::identity(),
            quality: adit_core::solution::Quality::DeadReckoning,
        };
        solution.covariance *= 0.25;
        writer.push(&solution).unwrap();
    }
    writer.finish().unwrap();
    drive("solution_csv", parse_solution_csv, &[std::fs::read(&path).unwrap()]);
}

#[test]
fn sidecar_files() {
    let full = "rate_hz = 200\n[mounting]\nlocation = \"foot\"\nrotation = \"x-forward, y-right, z-down\"\n[frame]\nacceleration = \"gravity\"\n\
                [noise]\nangle_random_walk_rad_sqrt_s = 1e-4\nvelocity_random_walk_m_s_sqrt_s = 1e-3\ngyro_bias_walk_rad_s_sqrt_s = 1e-6\nacc_bias_walk_m_s2_sqrt_s = 1e-5\n";
    let matrix = "[mounting]\nrotation = [[1, 0, 0], [0, -1, 0], [0, 0, -1]]\n";
    let quaternion = "[mounting]\nrotation = [0.6, 0, 0, 0.8]\n";
    let calibrated = "mounting.location = \"foot\"\nmagnetic_field = { norm_ut = 49.5, dip_deg = 66 }\nframe = { magnetic_declination_deg = 3 }\n\
                      [magnetometer] # tumbled\noffset_ut = [1, -2.5, 3e0] # hard\nmatrix = [[1, 0, 0], [0, 1.1, 0], [0, 0, 0.9]]\n";
    drive("sidecar", parse_sidecar, &[full.into(), matrix.into(), quaternion.into(), calibrated.into()]);
}
