//! The order of time: the tag's own sensors in order, what comes by radio late, twice and out of order.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use adit_core::time::{Interval, Time};
use adit_observation::files::Input;
use adit_observation::mcap_log::Packing;
use adit_observation::order::REMEMBERED;
use adit_observation::{
    DeviceId, LogReader, Observation, PressureSample, Radio, ReadOptions, SignalStrength,
};
use common::{csv_log, error_of, mcap, read_all};
use std::fmt::Write as _;

fn seconds(seconds: f64) -> Time {
    Time::from_seconds(seconds).unwrap()
}

fn signal(time_s: f64, name: &str) -> Observation {
    let transmitter = DeviceId::new(name).unwrap();
    Observation::Signal(SignalStrength {
        time: seconds(time_s),
        transmitter,
        rssi_dbm: -60.0,
        radio: Radio::Ble,
    })
}

fn pressure(time_s: f64) -> Observation {
    Observation::Pressure(PressureSample { time: seconds(time_s), pressure_pa: 1e5 })
}

/// What a log of these gives, and its warnings without their place.
fn read(log: &[Observation]) -> (Vec<Observation>, Vec<String>) {
    let (observations, warnings) = read_all("a.mcap", &mcap(log, Packing::Plain)).unwrap();
    let without_place =
        |warning: String| warning.split_once(": ").unwrap().1.split_once(": ").unwrap().1.to_owned();
    (observations, warnings.iter().map(|warning| without_place(warning.to_string())).collect())
}

#[test]
fn late_radio_passes_and_is_counted_with_its_delay() {
    let log = [
        pressure(0.0),
        pressure(70.0),
        signal(69.5, "a"),
        signal(10.0, "a"),
        signal(70.0, "a"),
        pressure(71.0),
    ];
    let (observations, warnings) = read(&log);
    assert_eq!(observations, log);
    assert_eq!(warnings, ["observations by radio came late, from here on: 2, at most 60 s"]);
}

#[test]
fn radio_ahead_of_the_clock_does_not_make_the_sensors_late() {
    let log = [
        pressure(0.0),
        signal(1000.0, "a"),
        pressure(1.0),
        signal(1.0, "a"),
        pressure(2.0),
        signal(999.0, "b"),
    ];
    assert_eq!(read(&log), (log.to_vec(), vec![]));
}

#[test]
fn radio_past_the_limit_is_dropped_where_the_sensors_tell_the_time() {
    let log = [
        pressure(0.0),
        pressure(100.0),
        signal(39.9, "a"),
        signal(0.0, "a"),
        signal(40.0, "a"),
        pressure(101.0),
    ];
    let (observations, warnings) = read(&log);
    assert_eq!(observations, [&log[..2], &log[4..]].concat());
    assert_eq!(
        warnings,
        [
            "dropped observations by radio more than 60 s late, from here on: 2, at most 100 s",
            "observations by radio came late, from here on: 1, at most 60 s"
        ]
    );
    let input = Input::from_bytes("a.mcap", &mcap(&log, Packing::Plain)).unwrap();
    let options =
        ReadOptions { late_limit: Interval::from_seconds(100.0).unwrap(), ..ReadOptions::default() };
    assert_eq!(LogReader::from_input(input, &options).unwrap().count(), 6);
}

#[test]
fn radio_past_the_limit_is_an_error_where_nothing_else_tells_the_time() {
    let text = "time_s,beacon,rssi_dBm\n100,b1,-70\n45,b2,-70\n101,b1,-71\n40.5,b1,-70\n";
    let error = error_of("a.csv", text.as_bytes());
    assert_eq!(
        error,
        "a.csv:5: time runs backwards: found 40.500000000 s, expected more than 101.000000000 s"
    );
    let (_, warnings) = read_all("a.csv", text.replace("40.5", "41").as_bytes()).unwrap();
    let warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    assert_eq!(warnings, ["a.csv:3: observations by radio came late, from here on: 2, at most 60 s"]);
}

#[test]
fn the_tags_own_sensors_never_run_backwards() {
    let error = error_of("a.mcap", &mcap(&[pressure(1.0), signal(5.0, "a"), pressure(0.5)], Packing::Plain));
    assert!(
        error.contains("time runs backwards: found 0.500000000 s, expected more than 1.000000000 s"),
        "{error}"
    );
    let (observations, warnings) = read(&[pressure(1.0), signal(0.5, "a"), pressure(1.0), pressure(2.0)]);
    assert_eq!(observations.len(), 3);
    assert!(warnings.contains(&"dropped repetitions (same source, same time), from here on: 1".to_owned()));
    // The columns of one row: the repetition of a slow barometer beside a fast inertial sensor.
    let mut text = String::new();
    for (line, pressure) in csv_log(3).lines().zip(["pressure_Pa", "99000", "", "99001"]) {
        writeln!(text, "{line},{pressure}").unwrap();
    }
    text += "0.010,0.1,0,9.8,0,0,0,1,1,1,99001\n0.005,0.1,0,9.8,0,0,0,1,1,1,99001\n";
    let error = error_of("a.csv", text.as_bytes());
    assert!(error.starts_with("a.csv:6: time runs backwards"), "{error}");
}

#[test]
fn a_repetition_is_dropped_also_when_others_came_between() {
    let between = ["b", "c", "d"].map(|name| signal(1.0, name));
    let log =
        [&[signal(1.0, "a")], &between[..], &[signal(1.0, "a"), signal(2.0, "a"), signal(1.0, "c")]].concat();
    let (observations, warnings) = read(&log);
    assert_eq!(observations, [&log[..4], &log[5..6]].concat());
    assert_eq!(warnings, ["dropped repetitions (same source, same time), from here on: 2"]);
}

#[test]
fn devices_tags_radios_and_kinds_of_one_time_are_told_apart() {
    let text = "time_s,anchor,tag,range_m,radio,reader,transmitter,rssi_dBm\n\
                1,a,t1,5,uwb,a,a,-70\n\
                1,a,t2,5,uwb,b,b,-70\n\
                1,b,t1,5,uwb,,,\n\
                1,a,,5,uwb,,,\n\
                1,a,t1,5,wifi,,a,-70\n\
                1,a,t1,7,uwb,a,a,-70\n";
    let (observations, warnings) = read_all("a.csv", text.as_bytes()).unwrap();
    // Of the last row nothing is new, whatever its values; signal strengths of a by two radios are two.
    assert_eq!(observations.len(), 5 + 2 + 3);
    let warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    assert_eq!(warnings, ["a.csv:7: dropped repetitions (same source, same time), from here on: 1"]);
}

#[test]
fn what_is_remembered_of_the_radio_is_bounded() {
    let names: Vec<String> = (0..=REMEMBERED).map(|number| format!("b{number}")).collect();
    let scan: Vec<Observation> = names.iter().map(|name| signal(1.0, name)).collect();
    let again = |index: usize| read(&[scan.as_slice(), &scan[index..=index]].concat()).0.len();
    assert_eq!(again(REMEMBERED), REMEMBERED + 1);
    assert_eq!(again(1), REMEMBERED + 1);
    // The first of all is forgotten.
    assert_eq!(again(0), REMEMBERED + 2);
}
