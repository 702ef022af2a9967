#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

use super::{Batch, DeviceStatus, Packet, PacketReader, Resolution};
use crate::fix::{FixSource, PositionFix};
use crate::protobuf::schema::message;
use crate::{DeviceId, ImuSample, MagneticSample, Observation, PressureSample, Radio, RangeSample};
use crate::{Sighting, SignalStrength};
use adit_core::nalgebra::{Vector2, Vector3};
use adit_core::time::Time;
use proptest::prelude::*;
use prost::Message;
use prost::bytes::Bytes;

fn device(name: &str) -> DeviceId {
    DeviceId::new(name).unwrap()
}

/// A second of a tag on the belt: six axes at 100 Hz, a compass at 25 Hz, four ranges, everything else once.
fn second(tag: &str) -> Packet {
    let start = 1_795_000_000_000_000_000_i64;
    let at = |ms: i64| Time::from_nanos(start + ms * 1_000_000);
    let mut observations = Vec::new();
    for i in 0..100_i32 {
        let phase = f64::from(i) * 0.12;
        let (s, c) = phase.sin_cos();
        // The jitter of a sensor's last digits.
        let jitter = f64::from((i * 7919) % 31 - 15) * 1e-3;
        observations.push(Observation::Imu(ImuSample {
            time: at(i64::from(i) * 10),
            angular_rate_rad_s: Vector3::new(0.6 * s + jitter, 0.3 * c - jitter, 0.2 * s * c + jitter),
            specific_force_m_s2: Vector3::new(1.5 * s + jitter, 0.7 * c, 9.81 + 2.0 * s + 3.0 * jitter),
        }));
    }
    for i in 0..25_i32 {
        let field_ut = Vector3::new(20.0, -5.0, 40.0 + 0.15 * f64::from(i % 3));
        observations.push(Observation::Magnetic(MagneticSample { time: at(i64::from(i) * 40), field_ut }));
    }
    for anchor in ["A-101", "A-102", "A-103", "A-104"] {
        observations.push(Observation::Range(RangeSample {
            time: at(500),
            anchor: device(anchor),
            tag: None,
            range_m: 17.25,
            sigma_m: Some(0.1),
            line_of_sight: None,
            in_the_way: None,
            radio: Radio::Uwb,
            reception: None,
        }));
    }
    observations.push(Observation::Pressure(PressureSample { time: at(700), pressure_pa: 104_321.25 }));
    let signal =
        SignalStrength { time: at(800), transmitter: device("ap-3"), rssi_dbm: -61.0, radio: Radio::Wifi };
    observations.push(Observation::Signal(signal));
    observations.push(Observation::Sighting(Sighting { time: at(900), reader: device("portal-1") }));
    let fix = PositionFix::level(at(950), Vector2::new(5000.5, 3000.25), 2.0, FixSource::Wifi);
    observations.push(Observation::Fix(fix));
    observations.sort_by_key(|o| (o.time(), o.kind() as usize));
    Packet { tag: device(tag), number: 7, battery: Some(0.75), distress: false, observations }
}

#[test]
fn a_packet_comes_back_as_it_was_but_for_half_a_count() {
    let packet = second("T-1");
    let resolution = Resolution::default();
    let read = PacketReader::default().read(&packet.to_bytes(&resolution).into()).unwrap();
    assert_eq!((&read.tag, read.number, read.battery, read.distress), (&device("T-1"), 7, Some(0.75), false));
    assert_eq!(read.observations.len(), packet.observations.len());
    for (sent, got) in packet.observations.iter().zip(&read.observations) {
        match (sent, got) {
            (Observation::Imu(sent), Observation::Imu(got)) => {
                assert_eq!(sent.time, got.time);
                let rate = (sent.angular_rate_rad_s - got.angular_rate_rad_s).amax();
                let force = (sent.specific_force_m_s2 - got.specific_force_m_s2).amax();
                assert!(rate <= 0.5001 * resolution.rate_rad_s && force <= 0.5001 * resolution.force_m_s2);
            }
            (Observation::Magnetic(sent), Observation::Magnetic(got)) => {
                assert_eq!(sent.time, got.time);
                assert!((sent.field_ut - got.field_ut).amax() <= 0.5001 * resolution.field_ut);
            }
            _ => assert_eq!(sent, got),
        }
    }
    // Counts of counts are the same counts.
    let again = Packet { observations: read.observations.clone(), ..packet };
    assert_eq!(PacketReader::default().read(&again.to_bytes(&resolution).into()).unwrap(), read);
}

#[test]
fn runs_are_a_fifth_of_single_readings() {
    let mut packet = second("T-1");
    packet.observations.retain(|observation| matches!(observation, Observation::Imu(_)));
    let runs = packet.to_bytes(&Resolution::default()).len();
    // A resolution in which nothing has a count leaves all readings single.
    let singles =
        packet.to_bytes(&Resolution { rate_rad_s: 1e-300, force_m_s2: 1e-300, field_ut: 1e-300 }).len();
    println!("a second of six axes at 100 Hz: {runs} bytes, {singles} as single readings");
    assert!(5 * runs < singles, "{runs} {singles}");
}

#[test]
fn the_envelopes_are_what_the_schema_says() {
    let packet = second("T-1");
    let mut batch = Batch::new(0xfeed_5eed, 12).with_packet(&packet, &Resolution::default());
    batch.sent = Some(Time::from_nanos(1_795_000_001_000_000_000));
    batch.devices.push(DeviceStatus { device: device("A-101"), up: false, battery: Some(0.25) });
    let bytes = batch.to_bytes();
    let by_schema = message::ObservationBatch::decode(bytes.as_slice()).unwrap();
    assert_eq!((by_schema.boot, by_schema.sequence), (0xfeed_5eed, 12));
    let tag = &by_schema.packets[0];
    assert_eq!((tag.tag.as_str(), tag.number, tag.battery), ("T-1", 7, Some(0.75)));
    assert_eq!(tag.inertial_runs.len(), 1);
    assert_eq!(tag.inertial_runs[0].rate.len(), 300);
    assert_eq!((tag.ranges.len(), tag.signals.len(), tag.fixes.len()), (4, 1, 1));
    assert_eq!(by_schema.devices[0].device, "A-101");
    // And back: a field order of the schema's own encoder is read alike.
    assert_eq!(Batch::read(by_schema.encode_to_vec()).unwrap(), batch);
}

#[test]
fn what_is_no_packet_is_told_with_field_and_value() {
    let read = |packet: &message::TagPacket| {
        PacketReader::default().read(&packet.encode_to_vec().into()).unwrap_err().to_string()
    };
    let run = message::InertialRun {
        first: Some(crate::protobuf::timestamp(Time::ZERO)),
        interval_ns: 10_000_000,
        rate_resolution_rad_s: 1e-4,
        force_resolution_m_s2: 1e-3,
        rate: vec![1, 2, 3],
        force: vec![1, 2, 3],
    };
    let with = |run: message::InertialRun| message::TagPacket {
        tag: "T".into(),
        inertial_runs: vec![run],
        ..message::TagPacket::default()
    };
    let told = [
        read(&message::TagPacket::default()),
        read(&message::TagPacket { tag: "T".into(), battery: Some(80.0), ..Default::default() }),
        read(&with(message::InertialRun { interval_ns: 0, ..run.clone() })),
        read(&with(message::InertialRun { rate: vec![1, 2], ..run.clone() })),
        read(&with(message::InertialRun { force: vec![1, 2, 3, 4, 5, 6], ..run.clone() })),
        read(&with(message::InertialRun { rate_resolution_rad_s: f64::NAN, ..run.clone() })),
        read(&with(message::InertialRun { first: None, ..run })),
        Batch::read(Batch::new(1, 0).to_bytes()).unwrap_err().to_string(),
    ];
    assert_eq!(
        told,
        [
            "tag: found nothing, expected a value",
            "battery: found 80, expected 0 to 1",
            "inertial run: interval_ns: found 0, expected 1 to 10000000000",
            "inertial run: counts: found 2, expected three for each reading",
            "inertial run: counts of force: found 6, expected as many as of rate",
            "rate_resolution_rad_s: found NaN, expected a number above 0",
            "timestamp: found nothing, expected a value",
            "sequence: found 0, expected 1 or more",
        ]
    );
}

proptest! {
    #[test]
    fn no_bytes_make_it_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        let bytes = Bytes::from(bytes);
        if let Ok(batch) = Batch::read(bytes.clone()) {
            for packet in &batch.packets {
                let _ = PacketReader::default().read(packet);
            }
        }
        let _ = PacketReader::default().read(&bytes);
    }

    #[test]
    fn no_change_of_a_packet_makes_it_panic(at in any::<prop::sample::Index>(), to in any::<u8>()) {
        let mut bytes = second("T-1").to_bytes(&Resolution::default());
        let at = at.index(bytes.len());
        bytes[at] = to;
        let _ = PacketReader::default().read(&bytes.into());
    }
}
