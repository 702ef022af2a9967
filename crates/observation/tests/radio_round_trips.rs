//! What is written comes back bit for bit, of every kind, in CSV and MCAP; messages that others write are read or refused.
#![expect(clippy::unwrap_used, clippy::expect_used, reason = "tests")]

mod common;

use adit_core::nalgebra::{Matrix2, Vector2, Vector3};
use adit_core::time::Time;
use adit_observation::csv_log::{CsvLogWriter, Sensors};
use adit_observation::mcap_log::{McapLogWriter, Packing};
use adit_observation::{
    DeviceId, FixSource, HeightFix, ImpulseResponse, ImuSample, MagneticSample, Observation, PositionFix,
    PressureSample, Radio, RangeSample, Reception, Sighting, SignalStrength,
};
use common::{error_of, mcap, read_all};
use proptest::option::of;
use proptest::prelude::*;
use proptest::sample::select;
use prost::Message;
use std::collections::BTreeMap;
use std::sync::Arc;

fn device() -> impl Strategy<Value = DeviceId> {
    "[!-+\\--~]([ -+\\--~µé]{0,20}[!-+\\--~])?"
        .prop_map(|name| DeviceId::new(&name).expect("a name without a comma"))
}

fn vector() -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO)
        .prop_map(Vector3::from)
}

fn response() -> impl Strategy<Value = ImpulseResponse> {
    (prop::collection::vec(any::<[i16; 2]>(), 1..=ImpulseResponse::MOST_TAPS), any::<prop::sample::Index>())
        .prop_map(|(taps, first)| {
            let first_tap = first.index(ImpulseResponse::MOST_TAPS - taps.len() + 1);
            ImpulseResponse { first_tap: u16::try_from(first_tap).unwrap(), taps: taps.into() }
        })
}

fn reception() -> impl Strategy<Value = Reception> {
    let power = || of(-200.0_f32..=50.0);
    let tap = || of(0.0_f32..=1016.0);
    let amplitude = 0.0_f32..1e5;
    let told = (power(), power(), tap(), tap(), of(prop::array::uniform3(amplitude.clone())));
    (told, of(amplitude.clone()), of(amplitude), of(any::<u16>()), of(response())).prop_map(
        |(told, noise_std, noise_max, preamble_count, impulse_response)| Reception {
            rx_power_dbm: told.0,
            first_path_power_dbm: told.1,
            first_path_index_tap: told.2,
            peak_index_tap: told.3,
            first_path_amplitudes: told.4,
            noise_std,
            noise_max,
            preamble_count,
            impulse_response,
        },
    )
}

fn fix() -> impl Strategy<Value = PositionFix> {
    let spread = (1e-6_f64..1e3, 1e-6_f64..1e3, -0.99_f64..0.99);
    let height = of((-1e7_f64..1e7, 1e-6_f64..1e7));
    ([-1e7_f64..1e7, -1e7_f64..1e7], spread, height, select(&FixSource::ALL[..])).prop_map(
        |(level_m, (east, north, correlation), height, source)| {
            let cross = east * north * correlation;
            PositionFix {
                time: Time::ZERO,
                level_m: Vector2::from(level_m),
                covariance_m2: Matrix2::new(east * east, cross, cross, north * north),
                height: height.map(|(up_m, sigma_m)| HeightFix { up_m, sigma_m }),
                source,
            }
        },
    )
}

fn signal() -> impl Strategy<Value = SignalStrength> {
    (device(), -200.0..=50.0, select(&Radio::ALL[..])).prop_map(|(transmitter, rssi_dbm, radio)| {
        SignalStrength { time: Time::ZERO, transmitter, rssi_dbm, radio }
    })
}

fn range() -> impl Strategy<Value = RangeSample> {
    let told = (of(1e-6_f64..=1e6), of(0.0_f64..=1.0), select(&Radio::ALL[..]), of(reception()));
    (device(), of(device()), -1e3_f64..=1e6, told).prop_map(
        |(anchor, tag, range_m, (sigma_m, line_of_sight, radio, reception))| RangeSample {
            time: Time::ZERO,
            anchor,
            tag,
            range_m,
            sigma_m,
            line_of_sight,
            in_the_way: None,
            radio,
            reception: reception.map(Arc::new),
        },
    )
}

fn observation() -> impl Strategy<Value = Observation> {
    let time = Time::ZERO;
    prop_oneof![
        (vector(), vector()).prop_map(move |(angular_rate_rad_s, specific_force_m_s2)| {
            Observation::Imu(ImuSample { time, angular_rate_rad_s, specific_force_m_s2 })
        }),
        vector().prop_map(move |field_ut| Observation::Magnetic(MagneticSample { time, field_ut })),
        (1e3..=2e5).prop_map(move |pressure_pa| Observation::Pressure(PressureSample { time, pressure_pa })),
        fix().prop_map(Observation::Fix),
        signal().prop_map(Observation::Signal),
        range().prop_map(Observation::Range),
        device().prop_map(move |reader| Observation::Sighting(Sighting { time, reader })),
    ]
}

/// At times that rise, from before the origin on; half of the steps are of one nanosecond.
fn timed(observations: Vec<Observation>, first: i64) -> Vec<Observation> {
    let time = |index: usize| {
        let index = i64::try_from(index).unwrap();
        Time::from_nanos(first + index / 2 * 1_000_003 + index % 2)
    };
    observations.into_iter().enumerate().map(|(index, observation)| observation.at(time(index))).collect()
}

/// Through a log, with the checks of order but not of units: the numbers are anything.
fn through(write: impl FnOnce(&std::path::Path)) -> Vec<Observation> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log");
    write(&path);
    let options = adit_observation::ReadOptions { check_units: false, ..Default::default() };
    adit_observation::open_with(&path, &options).unwrap().map(Result::unwrap).collect()
}

/// What CSV holds of it: no impulse response, and of a reception without anything nothing.
fn as_csv_holds_it(observation: &Observation) -> Observation {
    let mut observation = observation.clone();
    if let Observation::Range(range) = &mut observation {
        let told = range.reception.take().map(|told| Reception { impulse_response: None, ..(*told).clone() });
        range.reception = told.filter(|told| *told != Reception::default()).map(Arc::new);
    }
    observation
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_mixture_survives_mcap(
        observations in prop::collection::vec(observation(), 1..20),
        first in -1_000_000_000_i64..4_000_000_000_000_000_000,
        packing in select(vec![Packing::Plain, Packing::Lz4]),
    ) {
        let written = timed(observations, first);
        let read = through(|path| {
            let mut writer = McapLogWriter::create(path, packing).unwrap();
            for observation in &written {
 writer.push(observation).unwrap();
}
            writer.finish().unwrap();
        });
        // As text too, which tells -0 from 0.
        prop_assert_eq!(format!("{read:?}"), format!("{written:?}"));
    }

    #[test]
    fn any_log_of_one_kind_survives_csv(
        observations in prop::collection::vec(observation(), 40),
        first in -1_000_000_000_i64..4_000_000_000_000_000_000,
    ) {
        let all = timed(observations, first);
        for sensors in [
            Sensors::Imu, Sensors::Magnetic, Sensors::Pressure, Sensors::Fixes, Sensors::Signals, Sensors::Ranges,
            Sensors::Sightings,
        ] {
            let of_kind = |observation: &&Observation| matches!(
                (observation, sensors),
                (Observation::Imu(_), Sensors::Imu)
                    | (Observation::Magnetic(_), Sensors::Magnetic)
                    | (Observation::Pressure(_), Sensors::Pressure)
                    | (Observation::Fix(_), Sensors::Fixes)
                    | (Observation::Signal(_), Sensors::Signals)
                    | (Observation::Range(_), Sensors::Ranges)
                    | (Observation::Sighting(_), Sensors::Sightings)
            );
            let written: Vec<&Observation> = all.iter().filter(of_kind).collect();
            let read = through(|path| {
                let mut writer = CsvLogWriter::create(path, sensors).unwrap();
                for observation in &written {
 writer.push(observation).unwrap();
}
                writer.finish().unwrap();
            });
            let expected: Vec<Observation> = written.into_iter().map(as_csv_holds_it).collect();
            prop_assert_eq!(format!("{read:?}"), format!("{expected:?}"));
        }
    }
}

#[test]
fn observations_of_one_time_by_different_devices_survive() {
    let at = |name: &str| {
        let transmitter = DeviceId::new(name).unwrap();
        Observation::Signal(SignalStrength {
            time: Time::ZERO,
            transmitter,
            rssi_dbm: -70.0,
            radio: Radio::Wifi,
        })
    };
    // Late ones too: written as they come.
    let scan = [at("ap1"), at("ap2"), at("ap3").at(Time::from_nanos(5)), at("ap4")];
    let read = through(|path| {
        let mut writer = CsvLogWriter::create(path, Sensors::Signals).unwrap();
        for signal in &scan {
            writer.push(signal).unwrap();
        }
        writer.finish().unwrap();
    });
    assert_eq!(read, scan);
}

#[test]
fn what_cannot_be_read_back_is_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = McapLogWriter::create(folder.path().join("a.mcap"), Packing::Plain).unwrap();
    let warm = Observation::Pressure(PressureSample { time: Time::ZERO, pressure_pa: 21.5 });
    let error = writer.push(&warm).unwrap_err().to_string();
    assert!(
        error.contains("Pressure at 0.000000000 s: pressure_pa is 21.5, expected 1,000 to 200,000 Pa"),
        "{error}"
    );
}

/// A range as a later version of adit, or somebody else, might write it: a new field, a new radio, numbers out of range.
#[derive(Clone, PartialEq, Message)]
struct ForeignRange {
    #[prost(message, optional, tag = "1")]
    timestamp: Option<prost_types::Timestamp>,
    #[prost(string, tag = "2")]
    anchor: String,
    #[prost(string, tag = "3")]
    tag: String,
    #[prost(double, optional, tag = "4")]
    range_m: Option<f64>,
    #[prost(double, optional, tag = "6")]
    line_of_sight: Option<f64>,
    #[prost(int32, tag = "7")]
    radio: i32,
    #[prost(message, optional, tag = "8")]
    reception: Option<ForeignReception>,
    #[prost(string, tag = "900")]
    remark: String,
}

#[derive(Clone, PartialEq, Message)]
struct ForeignReception {
    #[prost(float, optional, tag = "5")]
    first_path_amp1: Option<f32>,
    #[prost(uint32, optional, tag = "10")]
    preamble_count: Option<u32>,
    #[prost(message, optional, tag = "11")]
    impulse_response: Option<ForeignResponse>,
}

#[derive(Clone, PartialEq, Message)]
struct ForeignResponse {
    #[prost(uint32, tag = "1")]
    first_tap: u32,
    #[prost(bytes = "vec", tag = "2")]
    taps: Vec<u8>,
}

fn foreign() -> ForeignRange {
    ForeignRange {
        timestamp: Some(prost_types::Timestamp { seconds: 1, nanos: 5 }),
        anchor: "a7".to_owned(),
        range_m: Some(7.5),
        radio: 17,
        remark: "of a later version".to_owned(),
        ..ForeignRange::default()
    }
}

/// An MCAP file with one message on a topic of another name.
fn foreign_file(message: &ForeignRange) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut writer = mcap::Writer::new(&mut bytes).unwrap();
    let schema = writer.add_schema("adit.v1.RangeSample", "protobuf", b"").unwrap();
    let channel_id = writer.add_channel(schema, "/uwb/left", "protobuf", &BTreeMap::new()).unwrap();
    let header = mcap::records::MessageHeader { channel_id, sequence: 0, log_time: 0, publish_time: 0 };
    writer.write_to_known_channel(&header, &message.encode_to_vec()).unwrap();
    writer.finish().unwrap();
    drop(writer);
    bytes.into_inner()
}

#[test]
fn what_a_later_version_adds_does_not_matter() {
    let (observations, warnings) = read_all("a.mcap", &foreign_file(&foreign())).unwrap();
    let expected = RangeSample {
        time: Time::from_nanos(1_000_000_005),
        anchor: DeviceId::new("a7").unwrap(),
        tag: None,
        range_m: 7.5,
        sigma_m: None,
        line_of_sight: None,
        in_the_way: None,
        radio: Radio::Unknown,
        reception: None,
    };
    assert_eq!((observations, warnings.len()), (vec![Observation::Range(expected)], 0));
}

#[test]
fn a_message_that_cannot_be_is_named_with_its_record() {
    let error = |message: &ForeignRange| {
        let error = error_of("a.mcap", &foreign_file(message));
        let (place, what) = error.split_once(": ").unwrap();
        assert_eq!(place, "a.mcap");
        what.split_once(": ").unwrap().1.to_owned()
    };
    let reception = |reception| ForeignRange { reception: Some(reception), ..foreign() };
    let response = |first_tap, taps: usize| {
        let impulse_response = Some(ForeignResponse { first_tap, taps: vec![1; taps] });
        reception(ForeignReception { impulse_response, ..ForeignReception::default() })
    };
    let name = "expected a name of a device: 1 to 64 bytes, no blanks around, no control characters";
    for (message, expected) in [
        (ForeignRange { anchor: String::new(), ..foreign() }, "anchor: found nothing, expected a value"),
        (ForeignRange { anchor: " a".to_owned(), ..foreign() }, &*format!("anchor: found \" a\", {name}")),
        (ForeignRange { tag: "a\n".to_owned(), ..foreign() }, &*format!("tag: found \"a\\n\", {name}")),
        (ForeignRange { range_m: None, ..foreign() }, "range_m: found nothing, expected a value"),
        (
            ForeignRange { range_m: Some(f64::NAN), ..foreign() },
            "range_m: found NaN, expected a finite number",
        ),
        (
            ForeignRange { range_m: Some(-2e3), ..foreign() },
            "range_m: found -2000, expected -1,000 to 1,000,000 m",
        ),
        (
            ForeignRange { line_of_sight: Some(f64::NAN), ..foreign() },
            "line_of_sight: found NaN, expected a probability, 0 to 1",
        ),
        (
            reception(ForeignReception { first_path_amp1: Some(1.0), ..Default::default() }),
            "first_path_amp2: found nothing, expected a value",
        ),
        (
            reception(ForeignReception { preamble_count: Some(65536), ..Default::default() }),
            "preamble_count: found 65536, expected at most 65535",
        ),
        (response(0, 0), "impulse_response taps: found 0, expected 1 to 1016"),
        (response(0, 6), "impulse_response taps: found 6, expected 4 bytes for each of at most 1016 taps"),
        (
            response(0, 4 * 1017),
            "impulse_response taps: found 4068, expected 4 bytes for each of at most 1016 taps",
        ),
        (
            response(1000, 68),
            "impulse_response first_tap: found 1000, expected one that leaves room for all taps in an accumulator of 1016",
        ),
        (response(70_000, 4), "impulse_response first_tap: found 70000, expected at most 65535"),
        (ForeignRange { timestamp: None, ..foreign() }, "timestamp: found nothing, expected a value"),
    ] {
        assert_eq!(error(&message), expected);
    }
}

#[test]
fn a_full_impulse_response_takes_four_bytes_a_tap() {
    let response =
        ImpulseResponse { first_tap: 0, taps: vec![[-12, 345]; ImpulseResponse::MOST_TAPS].into() };
    let range = |reception: Option<Reception>| {
        Observation::Range(RangeSample {
            time: Time::ZERO,
            anchor: DeviceId::new("a").unwrap(),
            tag: None,
            range_m: 1.0,
            sigma_m: None,
            line_of_sight: None,
            in_the_way: None,
            radio: Radio::Uwb,
            reception: reception.map(Arc::new),
        })
    };
    let with = mcap(
        &[range(Some(Reception { impulse_response: Some(response), ..Reception::default() }))],
        Packing::Plain,
    );
    let without = mcap(&[range(None)], Packing::Plain);
    let grown = with.len() - without.len();
    // Tags and lengths of reception, response and bytes.
    assert!((4 * 1016..4 * 1016 + 12).contains(&grown), "{grown}");
}
