//! Rows per second of every reader and writer of logs, on 200,000 rows in memory with the digits of a real log.
#![expect(clippy::unwrap_used, reason = "a benchmark may stop")]

use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use adit_observation::csv_log::{CsvLogWriter, Sensors};
use adit_observation::files::Input;
use adit_observation::mcap_log::{McapLogWriter, Packing};
use adit_observation::{
    DeviceId, ImuSample, LogReader, MagneticSample, Observation, Radio, RangeSample, ReadOptions, Reception,
    SignalStrength,
};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use std::path::Path;
use std::sync::Arc;

const ROWS: u32 = 200_000;

fn observations(magnetic: bool) -> Vec<Observation> {
    let round = |v: f64, digits: f64| (v * digits).round() / digits;
    let mut observations = Vec::new();
    for row in 0..ROWS {
        let time = Time::from_nanos(i64::from(row) * 5_000_000);
        let phase = f64::from(row) * 0.01;
        let wave = |shift: f64, digits| round((phase + shift).sin(), digits);
        observations.push(Observation::Imu(ImuSample {
            time,
            angular_rate_rad_s: Vector3::new(wave(0.0, 1e6), wave(1.0, 1e6), wave(2.0, 1e6)),
            specific_force_m_s2: Vector3::new(
                wave(3.0, 1e5),
                wave(4.0, 1e5),
                round(9.8 + wave(5.0, 1e5), 1e5),
            ),
        }));
        if magnetic {
            let field_ut =
                Vector3::new(round(20.0 + phase.sin(), 1e3), wave(1.0, 1e3), round(-45.0 - phase.cos(), 1e3));
            observations.push(Observation::Magnetic(MagneticSample { time, field_ut }));
        }
    }
    observations
}

/// Ranges to twenty anchors at 10 Hz each, with the reception that a DW1000 tells; no impulse responses.
fn ranges() -> Vec<Observation> {
    let anchors: Vec<DeviceId> =
        (0..20).map(|anchor| DeviceId::new(&format!("anchor {anchor}")).unwrap()).collect();
    (0..ROWS)
        .map(|row| {
            let phase = f64::from(row) * 0.01;
            let power = -80.0 + (row % 97) as f32 / 16.0;
            let reception = Reception {
                rx_power_dbm: Some(power),
                first_path_power_dbm: Some(power - 1.5),
                first_path_index_tap: Some(745.0 + (row % 64) as f32 / 64.0),
                noise_std: Some(48.0),
                preamble_count: Some(230),
                ..Reception::default()
            };
            Observation::Range(RangeSample {
                time: Time::from_nanos(i64::from(row) * 5_000_000),
                anchor: anchors[row as usize % anchors.len()].clone(),
                tag: None,
                range_m: (20_000.0 + 10_000.0 * phase.sin()).round() / 1e3,
                sigma_m: Some(0.1),
                line_of_sight: None,
                in_the_way: None,
                radio: Radio::Uwb,
                reception: Some(Arc::new(reception)),
            })
        })
        .collect()
}

/// Scans of fifty access points, all of a scan at one time.
fn signals() -> Vec<Observation> {
    let names: Vec<DeviceId> =
        (0..50).map(|ap| DeviceId::new(&format!("00:1b:2c:3d:4e:{ap:02x}")).unwrap()).collect();
    (0..ROWS)
        .map(|row| {
            Observation::Signal(SignalStrength {
                time: Time::from_nanos(i64::from(row / 50) * 1_000_000_000),
                transmitter: names[row as usize % names.len()].clone(),
                rssi_dbm: f64::from(-40 - i32::try_from(row % 53).unwrap()),
                radio: Radio::Wifi,
            })
        })
        .collect()
}

fn write_csv(path: &Path, observations: &[Observation], sensors: Sensors) {
    let mut writer = CsvLogWriter::create(path, sensors).unwrap();
    for observation in observations {
        writer.push(observation).unwrap();
    }
    writer.finish().unwrap();
}

fn write_mcap(path: &Path, observations: &[Observation], packing: Packing) {
    let mut writer = McapLogWriter::create(path, packing).unwrap();
    for observation in observations {
        writer.push(observation).unwrap();
    }
    writer.finish().unwrap();
}

fn speeds(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let (six, nine) = (observations(false), observations(true));
    let mut group = criterion.benchmark_group("rows");
    group.throughput(Throughput::Elements(u64::from(ROWS))).sample_size(10);

    write_csv(&at("six.csv"), &six, Sensors::Imu);
    write_csv(&at("nine.csv"), &nine, Sensors::ImuMagnetic);
    write_csv(&at("nine.csv.gz"), &nine, Sensors::ImuMagnetic);
    write_mcap(&at("nine_lz4.mcap"), &nine, Packing::Lz4);
    write_mcap(&at("nine_plain.mcap"), &nine, Packing::Plain);
    let (ranges, signals) = (ranges(), signals());
    write_csv(&at("ranges.csv"), &ranges, Sensors::Ranges);
    write_csv(&at("signals.csv"), &signals, Sensors::Signals);
    write_mcap(&at("ranges_lz4.mcap"), &ranges, Packing::Lz4);
    write_mcap(&at("signals_lz4.mcap"), &signals, Packing::Lz4);
    for name in [
        "six.csv",
        "nine.csv",
        "nine.csv.gz",
        "nine_lz4.mcap",
        "nine_plain.mcap",
        "ranges.csv",
        "ranges_lz4.mcap",
        "signals.csv",
        "signals_lz4.mcap",
    ] {
        let bytes = std::fs::read(at(name)).unwrap();
        println!("{name}: {} bytes", bytes.len());
        group.bench_function(format!("read {name}"), |bencher| {
            bencher.iter(|| {
                let input = Input::from_bytes(name, &bytes).unwrap();
                let log = LogReader::from_input(input, &ReadOptions::default()).unwrap();
                log.fold(0, |sum, observation| sum ^ black_box(observation.unwrap()).time().nanos())
            });
        });
    }
    group.bench_function("write nine.csv", |b| {
        b.iter(|| write_csv(&at("w.csv"), &nine, Sensors::ImuMagnetic));
    });
    group.bench_function("write nine_lz4.mcap", |b| {
        b.iter(|| write_mcap(&at("w.mcap"), &nine, Packing::Lz4));
    });
    group.bench_function("write ranges.csv", |b| {
        b.iter(|| write_csv(&at("w.csv"), &ranges, Sensors::Ranges));
    });
    group.bench_function("write ranges_lz4.mcap", |b| {
        b.iter(|| write_mcap(&at("w.mcap"), &ranges, Packing::Lz4));
    });
    group.finish();
}

criterion_group!(benches, speeds);
criterion_main!(benches);
