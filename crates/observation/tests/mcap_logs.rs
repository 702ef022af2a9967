//! MCAP logs: what was written comes back bit for bit, what is cut or damaged is a clear error.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use adit_core::nalgebra::Vector3;
use adit_core::time::Time;
use adit_observation::csv_log::{CsvLogWriter, Sensors};
use adit_observation::mcap_log::{McapLogWriter, Packing};
use adit_observation::{ImuSample, LogKind, Observation, open};
use common::{csv_log, data_set, error_of, files_with, mcap, read_all};
use std::path::Path;

fn observations(rows: usize) -> Vec<Observation> {
    read_all("made.csv", csv_log(rows).as_bytes()).unwrap().0
}

#[test]
fn csv_to_mcap_to_csv_changes_no_byte() {
    let text = csv_log(3000).replace("\n0.000,", "\n0,");
    // As adit writes times: no trailing zeros.
    let text: String = text
        .lines()
        .map(|line| match line.split_once(',') {
            Some((time, rest)) if time.contains('.') => {
                format!("{},{rest}\n", time.trim_end_matches('0').trim_end_matches('.'))
            }
            _ => format!("{line}\n"),
        })
        .collect::<String>()
        .replace(",-0.0,", ",-0,");
    round_trip(&text, Sensors::ImuMagnetic);
}

#[test]
fn recorded_logs_survive_csv_to_mcap_to_csv() {
    for (set, sensors) in [("foot-hallway", Sensors::ImuMagnetic), ("foot-loops", Sensors::Imu)] {
        let Some(folder) = data_set(set) else { continue };
        let part = if sensors == Sensors::Imu { "_walk_imu.csv" } else { "_imu.csv" };
        for path in files_with(&folder, part) {
            let mut text = String::new();
            let mut input = adit_observation::files::Input::open(&path).unwrap();
            std::io::Read::read_to_string(&mut input.reader, &mut text).unwrap();
            round_trip(&text, sensors);
        }
    }
}

fn round_trip(text: &str, sensors: Sensors) {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("a.csv"), text).unwrap();
    for packing in [Packing::Lz4, Packing::Plain] {
        let mut to_mcap = McapLogWriter::create(at("b.mcap"), packing).unwrap();
        for observation in open(at("a.csv")).unwrap() {
            to_mcap.push(&observation.unwrap()).unwrap();
        }
        to_mcap.finish().unwrap();

        let log = open(at("b.mcap")).unwrap();
        assert_eq!(log.kind(), LogKind::Mcap);
        let mut to_csv = CsvLogWriter::create(at("c.csv"), sensors).unwrap();
        for observation in log {
            to_csv.push(&observation.unwrap()).unwrap();
        }
        to_csv.finish().unwrap();
        assert!(std::fs::read_to_string(at("c.csv")).unwrap() == text);
    }
}

#[test]
fn times_before_the_origin_and_negative_zero_survive() {
    let sample = |nanos, x| {
        Observation::Imu(ImuSample {
            time: Time::from_nanos(nanos),
            angular_rate_rad_s: Vector3::new(-0.0, x, f64::MIN_POSITIVE),
            specific_force_m_s2: Vector3::new(0.1 + 0.2, -9.8, 5e-324),
        })
    };
    let written =
        [sample(i64::MIN, 1.0), sample(-1, 2.0), sample(0, 3.0), sample(1, 4.0), sample(i64::MAX, 5.0)];
    let (read, _) = read_all("a.mcap", &mcap(&written, Packing::Lz4)).unwrap();
    assert_eq!(format!("{read:?}"), format!("{written:?}"));
}

#[test]
fn a_cut_file_is_an_error_wherever_it_is_cut() {
    for packing in [Packing::Lz4, Packing::Plain] {
        let whole = mcap(&observations(300), packing);
        for length in (8..whole.len()).step_by(61).chain([whole.len() - 1]) {
            let error = error_of("cut.mcap", &whole[..length]);
            assert!(error.starts_with("cut.mcap: record "), "{length}: {error}");
            assert!(error.contains("the MCAP file is cut"), "{length} of {}: {error}", whole.len());
        }
    }
}

#[test]
fn a_cut_file_gives_its_complete_chunks_first() {
    let many = observations(40_000);
    let whole = mcap(&many, Packing::Plain);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.mcap");
    std::fs::write(&path, &whole[..whole.len() * 2 / 3]).unwrap();
    let (good, bad): (Vec<_>, Vec<_>) = open(&path).unwrap().partition(Result::is_ok);
    assert!(good.len() > many.len() / 4, "{}", good.len());
    assert_eq!(bad.len(), 1);
}

#[test]
fn every_flipped_bit_in_a_chunk_is_found_by_its_checksum() {
    let whole = mcap(&observations(200), Packing::Plain);
    let error = error_of("a.mcap", &{
        let mut flipped = whole.clone();
        flipped[whole.len() / 3] ^= 0x10;
        flipped
    });
    assert!(error.contains("chunk checksum"), "{error}");
}

#[test]
fn what_a_library_says_of_a_file_stays_on_one_line() {
    let whole = mcap(&observations(200), Packing::Lz4);
    let at = whole.windows(3).position(|window| window == b"lz4").unwrap();
    let mut broken = whole;
    broken[at + 2] = b'\n';
    let error = error_of("a.mcap", &broken);
    assert!(error.contains("lz\\n"), "{error}");
    assert_eq!(error.lines().count(), 1, "{error}");
}

#[test]
fn a_huge_length_does_not_fill_the_memory() {
    let mut bytes = mcap(&observations(10), Packing::Plain);
    // The length of the header record, right after magic and operation code.
    bytes[9..17].copy_from_slice(&u64::MAX.to_le_bytes());
    let error = error_of("a.mcap", &bytes);
    assert!(error.contains("record 1 at byte 8") && error.contains("exceeds limit"), "{error}");
}

#[test]
fn channels_of_others_are_ignored_with_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    write_with_topics(&path, &["/chat"], "other.Message");
    let mut log = open(&path).unwrap();
    assert_eq!(log.by_ref().flatten().count(), 1);
    let warnings: Vec<String> = log.warnings().iter().map(ToString::to_string).collect();
    assert_eq!(warnings, [format!("{}: ignored topics that are not known: /chat", path.display())]);
}

#[test]
fn two_topics_of_one_kind_must_be_chosen_from() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    write_with_topics(&path, &["/left"], "adit.v1.ImuSample");
    let error = open(&path).unwrap().find_map(Result::err).unwrap().to_string();
    assert!(
        error.contains("adit.v1.ImuSample observations on several topics: /imu, /left; choose one"),
        "{error}"
    );
    let options = adit_observation::ReadOptions { topics: vec!["/imu".to_owned()], ..Default::default() };
    assert_eq!(adit_observation::open_with(&path, &options).unwrap().count(), 1);
}

/// One inertial message on `/imu`, and further channels with an empty message each.
fn write_with_topics(path: &Path, topics: &[&str], schema_name: &str) {
    let imu = mcap(&observations(1)[..1], Packing::Plain);
    let (mut message, mut schema_data) = (Vec::new(), Vec::new());
    for entry in mcap::MessageStream::new(&imu).unwrap() {
        let entry = entry.unwrap();
        message = entry.data.to_vec();
        schema_data = entry.channel.schema.as_ref().unwrap().data.to_vec();
    }
    let mut writer = mcap::Writer::new(std::fs::File::create(path).unwrap()).unwrap();
    let none = std::collections::BTreeMap::new();
    let schema = writer.add_schema("adit.v1.ImuSample", "protobuf", &schema_data).unwrap();
    let channel = writer.add_channel(schema, "/imu", "protobuf", &none).unwrap();
    let header =
        |channel_id| mcap::records::MessageHeader { channel_id, sequence: 0, log_time: 0, publish_time: 0 };
    writer.write_to_known_channel(&header(channel), &message).unwrap();
    for topic in topics {
        let schema = writer.add_schema(schema_name, "protobuf", b"").unwrap_or(schema);
        let channel = writer.add_channel(schema, topic, "protobuf", &none).unwrap();
        writer.write_to_known_channel(&header(channel), &[]).unwrap();
    }
    writer.finish().unwrap();
}

#[test]
fn the_file_carries_its_schemas_for_other_tools() {
    use prost::Message;
    let bytes = mcap(&observations(2), Packing::Lz4);
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let mut topics: Vec<(String, String)> = Vec::new();
    for channel in summary.channels.values() {
        let schema = channel.schema.as_ref().unwrap();
        assert_eq!((schema.encoding.as_str(), channel.message_encoding.as_str()), ("protobuf", "protobuf"));
        let set = prost_types::FileDescriptorSet::decode(&*schema.data).unwrap();
        let names: Vec<&str> = set.file.iter().map(prost_types::FileDescriptorProto::name).collect();
        assert!(names.contains(&"google/protobuf/timestamp.proto"), "imports are there too: {names:?}");
        topics.push((channel.topic.clone(), schema.name.clone()));
    }
    topics.sort();
    assert_eq!(
        topics,
        [
            ("/imu".to_owned(), "adit.v1.ImuSample".to_owned()),
            ("/magnetic".to_owned(), "adit.v1.MagneticSample".to_owned())
        ]
    );
}
