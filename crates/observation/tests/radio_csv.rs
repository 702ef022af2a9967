//! Pressure, signal strengths, ranges and sightings in CSV: every form read, every mistake named with its line.
#![expect(clippy::unwrap_used, clippy::panic, reason = "tests")]

mod common;

use adit_observation::csv_log::{CsvLogWriter, Sensors};
use adit_observation::{
    DeviceId, ImpulseResponse, LogWarning, Observation, ObservationKind, Radio, RangeSample, Reception,
    Sighting, SignalStrength,
};
use common::{csv_log, error_of, read_all};
use std::sync::Arc;

fn observations(text: &str) -> Vec<Observation> {
    let (observations, warnings) = read_all("a.csv", text.as_bytes()).unwrap();
    assert_eq!(warnings, []);
    observations
}

fn pressures(text: &str) -> Vec<f64> {
    let pressure = |observation| match observation {
        Observation::Pressure(sample) => sample.pressure_pa,
        other => panic!("{other:?}"),
    };
    observations(text).into_iter().map(pressure).collect()
}

fn signals(text: &str) -> Vec<SignalStrength> {
    let signal = |observation| match observation {
        Observation::Signal(signal) => signal,
        other => panic!("{other:?}"),
    };
    observations(text).into_iter().map(signal).collect()
}

fn ranges(text: &str) -> Vec<RangeSample> {
    let range = |observation| match observation {
        Observation::Range(range) => range,
        other => panic!("{other:?}"),
    };
    observations(text).into_iter().map(range).collect()
}

fn device(name: &str) -> DeviceId {
    DeviceId::new(name).unwrap()
}

#[test]
fn pressure_is_read_in_its_units() {
    assert_eq!(pressures("time_s,pressure_Pa\n0,97727.73\n0.1,\n0.2,97729.5\n"), [97727.73, 97729.5]);
    assert_eq!(pressures("time_s,pressure_pa\n0,97727.73\n"), [97727.73]);
    assert_eq!(pressures("time_s,pressure_hPa\n0,977.25\n"), [97725.0]);
    assert_eq!(pressures("time_s,pressure_hpa\n0,977.25\n"), [97725.0]);
    assert_eq!(pressures("time_s,pressure_kPa\n0,97.5\n"), [97500.0]);
}

#[test]
fn a_signal_knows_its_transmitter_and_its_radio() {
    let read =
        signals("time_s,transmitter,rssi_dbm,radio\n0,ap 1,-51.5,wifi\n0,b2,-90,ble\n1,b2,,\n2,a0,-80,\n");
    let expected = |seconds: i64, name, rssi_dbm, radio| SignalStrength {
        time: adit_core::time::Time::from_nanos(seconds * 1_000_000_000),
        transmitter: device(name),
        rssi_dbm,
        radio,
    };
    assert_eq!(
        read,
        [
            expected(0, "ap 1", -51.5, Radio::Wifi),
            expected(0, "b2", -90.0, Radio::Ble),
            expected(2, "a0", -80.0, Radio::Unknown)
        ]
    );
    for (word, radio) in [("access_point", Radio::Wifi), ("beacon", Radio::Ble), ("receiver", Radio::Unknown)]
    {
        let read = signals(&format!("time_s,{word},rssi_dBm\n0,x,-51\n"));
        assert_eq!((read[0].radio, read[0].transmitter.as_str()), (radio, "x"));
    }
    assert_eq!(signals("time_s,access_point,rssi_dBm,radio\n0,x,-51,ble\n")[0].radio, Radio::Ble);
}

#[test]
fn a_range_has_what_its_row_tells() {
    let read = ranges(
        "time_s,tag_id,anchor_id,range_m,range_sigma_m,line_of_sight,valid,radio,rx_power_dBm,first_path_power_dBm,first_path_index_tap,\
         peak_index_tap,first_path_amp1,first_path_amp2,first_path_amp3,noise_std,noise_max,preamble_count\n\
         0,1,7475,3.23,0.1,0.25,1,uwb,-79.5,-81.25,745.312,747,14808,14198,9559,48,1236,230\n\
         1,,7475,-0.5,,,1,,,,,,,,,,,\n\
         2,,7475,4,,,0,zigbee,x,,,,,,,,,\n\
         3,,7475,,x,,1,,,,,,,,,,,\n",
    );
    assert_eq!(read.len(), 2, "a row that is not valid or has no range is not looked at");
    let RangeSample { anchor, tag, range_m, sigma_m, line_of_sight, radio, reception, .. } = read[0].clone();
    assert_eq!((anchor, tag, range_m, sigma_m), (device("7475"), Some(device("1")), 3.23, Some(0.1)));
    assert_eq!((line_of_sight, radio), (Some(0.25), Radio::Uwb));
    let expected = Reception {
        rx_power_dbm: Some(-79.5),
        first_path_power_dbm: Some(-81.25),
        first_path_index_tap: Some(745.312),
        peak_index_tap: Some(747.0),
        first_path_amplitudes: Some([14808.0, 14198.0, 9559.0]),
        noise_std: Some(48.0),
        noise_max: Some(1236.0),
        preamble_count: Some(230),
        impulse_response: None,
    };
    assert_eq!(reception.as_deref(), Some(&expected));
    let RangeSample { tag, range_m, sigma_m, line_of_sight, radio, reception, .. } = &read[1];
    assert_eq!((tag, range_m, sigma_m, line_of_sight, radio), (&None, &-0.5, &None, &None, &Radio::Unknown));
    assert_eq!(*reception, None);
    let silent = ranges("time_s,anchor,range_m,rx_power_dBm,noise_std\n0,a,3,-inf,2\n1,a,3,-inf,\n");
    let heard =
        |range: &RangeSample| range.reception.as_ref().map(|told| (told.rx_power_dbm, told.noise_std));
    assert_eq!([heard(&silent[0]), heard(&silent[1])], [Some((None, Some(2.0))), None]);
    for text in ["time_s,anchor,tag,range_mm\n0,a,t,3230\n", "time_s,anchor,range_cm\n0,a,323\n"] {
        assert_eq!(Some(ranges(text)[0].range_m), Some(3.23));
    }
}

#[test]
fn a_column_for_each_anchor_is_a_range_to_each() {
    let read = ranges(
        "time_s,range_a0_m,range_sigma_m,range_a_1_m,range_a2_mm\n0,3.354,0.1,4.787,6746\n1,,0.2,4.5,\n",
    );
    let told: Vec<_> = read.iter().map(|r| (r.anchor.as_str(), r.range_m, r.sigma_m)).collect();
    assert_eq!(
        told,
        [
            ("a0", 3.354, Some(0.1)),
            ("a_1", 4.787, Some(0.1)),
            ("a2", 6.746, Some(0.1)),
            ("a_1", 4.5, Some(0.2))
        ]
    );
    // Beside a range and its anchor such a column is something else.
    let (read, warnings) = read_all("a.csv", b"time_s,anchor,range_m,range_true_m\n0,a0,3,2.5\n").unwrap();
    assert_eq!(read.len(), 1);
    assert_eq!(warnings[0].to_string(), "a.csv:1: ignored columns that are not known: range_true_m");
}

#[test]
fn a_reader_sees_who_passes() {
    let read = observations("time_s,reader\n0,portal north\n0,portal south\n1,\n2,portal north\n");
    assert_eq!(read.len(), 3);
    let Observation::Sighting(Sighting { time, reader }) = &read[2] else { panic!("{read:?}") };
    assert_eq!((time.seconds(), reader.as_str()), (2.0, "portal north"));
}

#[test]
fn a_row_gives_its_observations_in_the_order_of_their_kinds() {
    let mut lines = csv_log(12).lines().map(str::to_owned).collect::<Vec<_>>();
    for (nth, line) in lines.iter_mut().enumerate() {
        *line += match nth {
            0 => ",reader,range_a0_m,transmitter,rssi_dBm,fix_east_m,fix_north_m,fix_sigma_m,pressure_Pa",
            5 => ",r,3,ap,-50,1,2,0.1,101325",
            _ => ",,,,,,,,",
        };
    }
    let kinds: Vec<_> = observations(&lines.join("\n"))
        .iter()
        .filter(|o| o.time().nanos() == 20_000_000)
        .map(Observation::kind)
        .collect();
    // A row with a gyro has no accelerometer that is alone.
    let inertial = |kind: &ObservationKind| *kind != ObservationKind::Acceleration;
    let all: Vec<_> = ObservationKind::ALL.into_iter().filter(inertial).collect();
    assert_eq!(kinds, all);
}

#[test]
fn what_cannot_be_is_an_error_with_its_line() {
    let bad =
        |header: &str, row: &str| error_of("a.csv", format!("{header}\n# a comment\n{row}\n").as_bytes());
    assert_eq!(
        bad("time_s,pressure_Pa", "0,977.2"),
        "a.csv:3: pressure_pa: found 977.2, expected 1,000 to 200,000 Pa (1,013.25 hPa are 101,325 Pa)"
    );
    assert!(
        bad("time_s,pressure_hPa", "0,97720")
            .contains("pressure_pa: found 9772000, expected 1,000 to 200,000")
    );
    assert_eq!(
        bad("time_s,pressure_Pa", "0,1e5x"),
        "a.csv:3: pressure_Pa: found \"1e5x\", expected a finite number"
    );
    let signal = |row| bad("time_s,transmitter,rssi_dBm,radio", row);
    // What scans write for "not heard".
    assert_eq!(signal("0,ap,100,wifi"), "a.csv:3: rssi_dbm: found 100, expected -200 to 50 dBm");
    assert_eq!(signal("0,ap,NaN,wifi"), "a.csv:3: rssi_dBm: found \"NaN\", expected a finite number");
    assert_eq!(signal("0,ap,-50,zigbee"), "a.csv:3: radio: found zigbee, expected unknown, wifi, ble, uwb");
    assert_eq!(
        signal("0,,-50,wifi"),
        "a.csv:3: transmitter: found \"\", expected a name of a device: 1 to 64 bytes, no blanks around, no control characters"
    );
    assert!(
        signal(&format!("0,{},-50,wifi", "x".repeat(65))).starts_with("a.csv:3: transmitter: found \"xxx")
    );
    let range =
        |row| bad("time_s,anchor_id,range_m,range_sigma_m,line_of_sight,valid,noise_std,preamble_count", row);
    assert_eq!(range("0,a,1e7,,,1,,"), "a.csv:3: range_m: found 10000000, expected -1,000 to 1,000,000 m");
    assert_eq!(range("0,a,5,0,,1,,"), "a.csv:3: range_sigma_m: found 0, expected 1 µm to 1,000 km");
    assert_eq!(range("0,a,5,,1.5,1,,"), "a.csv:3: line_of_sight: found 1.5, expected a probability, 0 to 1");
    assert_eq!(range("0,a,5,,,yes,,"), "a.csv:3: valid: found \"yes\", expected 0 or 1");
    assert_eq!(
        range("0,a,5,,,1,-2,"),
        "a.csv:3: noise_std: found -2, expected an amplitude: a finite number, 0 or more"
    );
    assert_eq!(range("0,a,5,,,1,1e39,"), "a.csv:3: noise_std: found \"1e39\", expected a finite number");
    assert_eq!(
        range("0,a,5,,,1,,65536"),
        "a.csv:3: preamble_count: found \"65536\", expected a whole number, 0 to 65535"
    );
    assert!(range("0,,5,,,1,,").starts_with("a.csv:3: anchor_id: found \"\", expected a name"));
    let taps = bad("time_s,range_a0_m,first_path_amp1", "0,x,1");
    assert_eq!(taps, "a.csv:3: range_a0_m: found \"x\", expected a finite number");
    let taps = bad("time_s,anchor,range_m,peak_index_tap", "0,a,1,1017");
    assert_eq!(taps, "a.csv:3: peak_index_tap: found 1017, expected 0 to 1016, the taps of the accumulator");
    assert!(
        bad("time_s,reader", "0,a\u{7}").starts_with("a.csv:3: reader: found \"a\\u{7}\", expected a name")
    );
}

#[test]
fn columns_that_are_missing_or_strange_are_named() {
    let of = |header: &str| error_of("a.csv", format!("{header}\n0\n").as_bytes());
    assert_eq!(
        of("time_s,pressure_bar"),
        "a.csv:1: column pressure_bar: unknown unit, expected pressure_Pa, pressure_hPa, pressure_kPa"
    );
    assert_eq!(of("time_s,rssi,beacon"), "a.csv:1: column rssi: unknown unit, expected rssi_dBm");
    assert_eq!(
        of("time_s,range_ft,anchor"),
        "a.csv:1: column range_ft: unknown unit, expected range_m, range_cm, range_mm"
    );
    assert_eq!(
        of("time_s,rssi_dBm"),
        "a.csv:1: missing column transmitter or access_point or beacon or receiver; found time_s, rssi_dBm"
    );
    assert_eq!(
        of("time_s,range_m,tag_id"),
        "a.csv:1: missing column anchor_id or anchor; found time_s, range_m, tag_id"
    );
    assert_eq!(
        of("time_s,range_m,anchor,first_path_amp1,first_path_amp3"),
        "a.csv:1: missing column first_path_amp2; found time_s, range_m, anchor, first_path_amp1, first_path_amp3"
    );
    for (header, first, second) in [
        ("time_s,pressure_Pa,pressure_hPa", "pressure_Pa", "pressure_hPa"),
        ("time_s,rssi_dBm,beacon,access_point", "beacon", "access_point"),
        ("time_s,range_m,anchor,anchor_id", "anchor", "anchor_id"),
        ("time_s,range_a0_m,range_a0_mm", "range_a0_m", "range_a0_mm"),
        ("time_s,range_m,anchor,rx_power_dBm,rx_power_dbm", "rx_power_dBm", "rx_power_dbm"),
        ("time_s,reader,reader", "reader", "reader"),
    ] {
        assert_eq!(of(header), format!("a.csv:1: columns {first} and {second} give the same quantity"));
    }
    // Neither a range nor a signal strength: nothing but time.
    assert!(of("time_s,anchor,rx_power_dBm,radio").contains("missing column acc_x_m_s2"));
}

#[test]
fn units_that_the_numbers_contradict_are_found() {
    let rows = |row: &dyn Fn(i32) -> String| (0..12).map(row).collect::<String>();
    let text = "time_s,pressure_Pa\n".to_owned() + &rows(&|i| format!("{i},1013.{i}\n"));
    assert_eq!(
        error_of("a.csv", text.as_bytes()),
        "a.csv:13: air pressure: found a median of 1013.4 Pa after conversion, expected about 100,000 Pa: \
         this looks like hPa, not Pa"
    );
    let text = "time_s,beacon,rssi_dBm\n".to_owned() + &rows(&|i| format!("{i},b,{}\n", 40 + i % 3));
    assert_eq!(
        error_of("a.csv", text.as_bytes()),
        "a.csv:13: signal strength: found a median of 41.0 dBm, expected -100 to -30 dBm: \
         this looks like a signal strength without its sign, or in percent, not dBm"
    );
    let text = "time_s,anchor,range_m\n".to_owned() + &rows(&|i| format!("{i},b,{}\n", 335 + i));
    let (_, warnings) = read_all("a.csv", text.as_bytes()).unwrap();
    assert!(matches!(warnings[..], [LogWarning::UnlikelyRange { median_mm: 341_000, .. }]), "{warnings:?}");
    assert_eq!(
        warnings[0].to_string(),
        "a.csv:13: the ranges have a median of 341 m up to here, longer than a radio indoors reaches: are they in cm or mm?"
    );
    // One loud packet, one echo and one dip of a door that slams are none of it.
    let text = "time_s,anchor,range_m,rssi_dBm,transmitter,pressure_Pa\n".to_owned()
        + &rows(&|i| {
            if i == 4 { "4,b,900,3,b,25000\n".to_owned() } else { format!("{i},b,9,-60,b,99000\n") }
        });
    observations(&text);
}

#[test]
fn a_csv_log_of_one_kind_takes_nothing_that_it_could_not_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ranges.csv");
    let mut writer = CsvLogWriter::create(&path, Sensors::Ranges).unwrap();
    let mut refused = |range: &RangeSample| {
        writer.push(&Observation::Range(range.clone())).map_err(|error| error.to_string()).unwrap_err()
    };
    let good = ranges("time_s,anchor,range_m\n0,a0,3\n").remove(0);
    let comma = refused(&RangeSample { tag: Some(device("t,1")), ..good.clone() });
    assert!(comma.contains("Range at 0.000000000 s: the name t,1 has a comma in it"), "{comma}");
    let far = refused(&RangeSample { range_m: f64::NAN, ..good.clone() });
    assert!(far.contains("range_m is NaN, expected -1,000 to 1,000,000 m"), "{far}");
    let response = ImpulseResponse { first_tap: 1000, taps: vec![[1, -1]; 17].into() };
    let reception =
        Reception { noise_std: Some(2.0), impulse_response: Some(response), ..Reception::default() };
    let deep = refused(&RangeSample { reception: Some(Arc::new(reception.clone())), ..good.clone() });
    assert!(deep.contains("impulse_response first_tap is 1000"), "{deep}");

    // An impulse response has no column.
    let response = ImpulseResponse { first_tap: 999, taps: vec![[1, -1]; 17].into() };
    let told = Reception { impulse_response: Some(response), ..reception };
    writer
        .push(&Observation::Range(RangeSample { reception: Some(Arc::new(told.clone())), ..good.clone() }))
        .unwrap();
    writer.finish().unwrap();
    let back = ranges(&std::fs::read_to_string(&path).unwrap()).remove(0);
    let expected = Reception { impulse_response: None, ..told };
    assert_eq!(back, RangeSample { reception: Some(Arc::new(expected)), ..good });
}
