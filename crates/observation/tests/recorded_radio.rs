//! The recorded sets of radios and barometers open as they are.
#![expect(clippy::unwrap_used, clippy::panic, reason = "tests")]

mod common;

use adit_core::time::Time;
use adit_observation::mcap_log::Packing;
use adit_observation::{DeviceId, ImpulseResponse, Observation, Radio, RangeSample, Reception, open};
use common::{data_set, files_with, mcap, read_all};
use std::collections::BTreeSet;
use std::io::Read as _;
use std::path::Path;
use std::sync::Arc;

/// Observations of a log and its warnings, without the file's name.
fn read(path: &Path) -> (Vec<Observation>, Vec<String>) {
    let mut log = open(path).unwrap();
    let observations = log.by_ref().collect::<Result<Vec<_>, _>>().unwrap();
    assert_eq!(Some(log.bytes_read()), log.bytes_total(), "{}", path.display());
    let place = format!("{}:", path.display());
    let warnings = log.warnings().iter().map(|warning| warning.to_string().replace(&place, "")).collect();
    (observations, warnings)
}

/// The fields of a file's rows, for a count that owes nothing to the reader.
fn rows(path: &Path) -> Vec<Vec<String>> {
    let mut text = String::new();
    adit_observation::files::Input::open(path).unwrap().reader.read_to_string(&mut text).unwrap();
    text.lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

fn range(observation: &Observation) -> &RangeSample {
    match observation {
        Observation::Range(range) => range,
        other => panic!("{other:?}"),
    }
}

#[test]
fn uwb_imu_walk_has_ranges_with_their_reception() {
    let Some(folder) = data_set("uwb-imu-walk") else { return };
    let path = folder.join("walk1_ranges.csv.gz");
    let (observations, warnings) = read(&path);
    assert_eq!(warnings, ["1: ignored columns that are not known: epoch, timeout_count"]);
    let rows = rows(&path);
    let valid: Vec<_> = rows.iter().filter(|row| row[9] == "1").collect();
    assert!(observations.len() == valid.len() && valid.len() < rows.len() && valid.len() > 4000);
    for (observation, row) in observations.iter().zip(valid) {
        let range = range(observation);
        assert_eq!((range.anchor.as_str(), range.range_m), (row[2].as_str(), row[3].parse().unwrap()));
        let told = range.reception.as_ref().unwrap();
        let powers = [told.first_path_power_dbm, told.rx_power_dbm, told.noise_std, told.noise_max];
        assert_eq!(powers, [4, 5, 6, 7].map(|column| Some(row[column].parse().unwrap())));
        assert_eq!((told.preamble_count, told.first_path_amplitudes), (None, None));
    }
}

#[test]
fn uwb_outdoor_has_ranges_with_two_powers() {
    let Some(folder) = data_set("uwb-outdoor") else { return };
    let files = files_with(&folder, "case");
    let files: Vec<_> = files.iter().filter(|path| path.to_string_lossy().contains("_ranges.csv")).collect();
    assert_eq!(files.len(), 4);
    for path in files {
        let (observations, warnings) = read(path);
        assert!(observations.len() == rows(path).len() && warnings.is_empty(), "{warnings:?}");
        let powers = |o| range(o).reception.as_ref().unwrap().rx_power_dbm;
        let told: Vec<f32> = observations.iter().filter_map(powers).collect();
        assert!(told.iter().all(|power| *power < -60.0));
        // One row has a power of -inf.
        let silent = usize::from(path.to_string_lossy().contains("nlos_a_case2"));
        assert_eq!(told.len() + silent, observations.len());
    }
    // Measured at marked spots, without time: a table, no log.
    let error = open(folder.join("static_ranges.csv.gz")).err().unwrap().to_string();
    assert!(error.contains(":1: missing column time_s"), "{error}");
}

#[test]
fn uwb_imu_rig_has_ranges_of_two_tags() {
    let Some(folder) = data_set("uwb-imu-rig") else { return };
    let path = folder.join("loop-2d-fast_s1_ranges.csv.gz");
    let (observations, warnings) = read(&path);
    assert_eq!(
        warnings,
        ["1: ignored columns that are not known: first_path_power1_dBm, first_path_power2_dBm, skew1, skew2"]
    );
    assert_eq!(observations.len(), rows(&path).len());
    let tags: BTreeSet<_> = observations.iter().map(|o| range(o).tag.clone().unwrap()).collect();
    assert_eq!(tags.iter().map(DeviceId::as_str).collect::<Vec<_>>(), ["1", "2"]);
    let path = folder.join("loop-3d_s5_ranges.csv");
    let (observations, warnings) = read(&path);
    assert!(observations.len() == rows(&path).len() && warnings.is_empty(), "{warnings:?}");
}

#[test]
fn uwb_person_has_a_column_for_each_anchor() {
    let Some(folder) = data_set("uwb-person") else { return };
    let files = files_with(&folder, "_ranges.csv");
    assert_eq!(files.len(), 16);
    for path in files {
        let (observations, warnings) = read(&path);
        let told: usize =
            rows(&path).iter().map(|row| row[1..].iter().filter(|field| !field.is_empty()).count()).sum();
        assert_eq!(observations.len(), told, "{}: {warnings:?}", path.display());
        let anchors: BTreeSet<_> = observations.iter().map(|o| range(o).anchor.to_string()).collect();
        assert!(anchors.into_iter().eq(["a0", "a1", "a2", "a3"]));
    }
}

#[test]
fn ble_tracks_are_heard_by_twelve_receivers() {
    let Some(folder) = data_set("ble-tracks") else { return };
    let files = files_with(&folder, "_rssi.csv");
    assert_eq!(files.len(), 5);
    for path in files {
        let (observations, warnings) = read(&path);
        assert!(observations.len() == rows(&path).len() && warnings.is_empty(), "{warnings:?}");
        let receivers: BTreeSet<_> = observations.iter().map(|o| transmitter(o).0).collect();
        assert_eq!(receivers.len(), 12);
    }
}

fn transmitter(observation: &Observation) -> (&str, Radio) {
    match observation {
        Observation::Signal(signal) => (signal.transmitter.as_str(), signal.radio),
        other => panic!("{other:?}"),
    }
}

#[test]
fn phone_walks_have_wifi_ble_and_a_barometer() {
    let Some(folder) = data_set("phone-walks") else { return };
    for (part, radio) in [("_wifi.csv", Radio::Wifi), ("_ble.csv", Radio::Ble)] {
        for path in files_with(&folder, part) {
            let (observations, warnings) = read(&path);
            println!(
                "{}: {} of {} rows; {warnings:?}",
                path.display(),
                observations.len(),
                rows(&path).len()
            );
            assert!(observations.len() > 100 && observations.iter().all(|o| transmitter(o).1 == radio));
        }
    }
    for path in files_with(&folder, "_baro.csv") {
        let (observations, warnings) = read(&path);
        println!("{}: {} of {} rows; {warnings:?}", path.display(), observations.len(), rows(&path).len());
        assert!(observations.len() > 1000);
        let pressure = |observation: &Observation| match observation {
            Observation::Pressure(sample) => (97_000.0..99_000.0).contains(&sample.pressure_pa),
            _ => false,
        };
        assert!(observations.iter().all(pressure));
    }
}

/// Bytes of a number as a `sint32` of protobuf.
fn varint_bytes(value: i16) -> usize {
    let zigzag = (i32::from(value) << 1) ^ (i32::from(value) >> 15);
    (32 - zigzag.leading_zeros()).div_ceil(7).max(1) as usize
}

#[test]
fn uwb_cir_responses_survive_mcap_in_little_more_than_varints_would_take() {
    const TAPS: usize = 200;
    let Some(folder) = data_set("uwb-cir") else { return };
    let mut bytes = Vec::new();
    let file = folder.join("cir_i16le.bin.gz");
    adit_observation::files::Input::open(file).unwrap().reader.read_to_end(&mut bytes).unwrap();
    let numbers: Vec<i16> = bytes.as_chunks().0.iter().map(|pair| i16::from_le_bytes(*pair)).collect();
    let taps: Vec<[i16; 2]> = numbers.as_chunks().0.to_vec();
    let varints: usize = numbers.iter().copied().map(varint_bytes).sum();
    let ratio = bytes.len() as f64 / varints as f64;
    println!("{} responses, {ratio:.3} times the varints", taps.len() / TAPS);
    assert!(ratio < 1.15);

    let range = |(index, taps): (usize, &[[i16; 2]])| {
        let impulse_response = Some(ImpulseResponse { first_tap: 700, taps: taps.into() });
        Observation::Range(RangeSample {
            time: Time::from_nanos(i64::try_from(index).unwrap() * 100_000_000),
            anchor: DeviceId::new("a0").unwrap(),
            tag: None,
            range_m: 5.0,
            sigma_m: None,
            line_of_sight: None,
            in_the_way: None,
            radio: Radio::Uwb,
            reception: Some(Arc::new(Reception { impulse_response, ..Reception::default() })),
        })
    };
    let written: Vec<Observation> = taps.chunks_exact(TAPS).enumerate().map(range).collect();
    assert!(written.len() > 7000);
    let (back, warnings) = read_all("cir.mcap", &mcap(&written, Packing::Lz4)).unwrap();
    assert!(back == written && warnings.is_empty());
}

#[test]
fn fingerprint_tables_are_no_logs() {
    for (set, part) in [("rssi-corridor", "_train.csv"), ("rssi-floors", "_train.csv")] {
        let Some(folder) = data_set(set) else { continue };
        for path in files_with(&folder, part) {
            let error = open(&path).err().unwrap().to_string();
            assert!(error.contains(":1: missing column time_s"), "{error}");
        }
    }
}
