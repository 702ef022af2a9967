//! `adit simulate` of everybody in a mine: files, threads, what they are good for.
#![expect(clippy::unwrap_used, reason = "tests")]

use adit_observation::{LogWarning, Observation, ObservationKind, open, truth};
use assert_cmd::Command;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

const MINE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../mines/two-level.toml");

fn scenario(folder: &Path, rest: &str) -> PathBuf {
    let path = folder.join("scenario.toml");
    let text = format!(
        "kind = \"mine\"\nseed = 5\nsensor = \"mpu6050\"\nrate_hz = 100.0\n[mine]\nfile = \"{MINE}\"\nduration_s = 60.0\n\
         truth_hz = 10.0\n[mine.population]\npeople = 6\nshift = {{ spread_s = 0.0 }}\n[mine.tag]\nbarometer = \"bmp280\"\n\
         radio = {{ detail = \"impulse-response\" }}\n{rest}"
    );
    fs::write(&path, text).unwrap();
    path
}

fn simulate(scenario: &Path, out: &Path, threads: u32, more: &[&str]) -> String {
    let mut command = Command::cargo_bin("adit").unwrap();
    command.arg("simulate").arg(scenario).arg("-o").arg(out).args(more);
    let output = command.env("RAYON_NUM_THREADS", threads.to_string()).assert().success();
    String::from_utf8(output.get_output().stdout.clone()).unwrap()
}

/// Every file below a folder.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                found.insert(path.strip_prefix(folder).unwrap().to_path_buf(), fs::read(&path).unwrap());
            }
        }
    }
    found
}

#[test]
fn one_thread_and_two_write_the_same_bytes_and_so_does_one_person_alone() {
    let folder = tempfile::tempdir().unwrap();
    let late = "[mine.delivery.link]\nlost_good = 0.05\nduplicated = 0.05\nextra_delay_s = 0.3\n";
    let scenario = scenario(folder.path(), late);
    let [one, two, some] = ["one", "two", "some"].map(|name| folder.path().join(name));
    simulate(&scenario, &one, 1, &[]);
    simulate(&scenario, &two, 2, &[]);
    let told = simulate(&scenario, &some, 2, &["--people", "3-4"]);
    assert!(told.contains("2 people over 60.0 s, 12000 samples"), "{told}");

    let (one, two, some) = (files(&one), files(&two), files(&some));
    assert_eq!(one.len(), 6 * 5 + 2, "{:?}", one.keys());
    assert!(one == two, "threads change nothing");
    let logs: Vec<_> =
        some.iter().filter(|(path, _)| path.starts_with("p003") || path.starts_with("p004")).collect();
    assert_eq!(logs.len(), 10);
    assert!(logs.into_iter().all(|(path, bytes)| one[path] == *bytes), "others not written change nothing");
    assert_ne!(one[Path::new("p001/truth.tum")], one[Path::new("p002/truth.tum")]);
}

#[test]
fn a_log_opens_with_its_late_and_repeated_radio_and_its_truth_fits_it() {
    let folder = tempfile::tempdir().unwrap();
    let late = "[mine.delivery.link]\nduplicated = 0.05\nextra_delay_s = 0.3\n";
    let scenario = scenario(folder.path(), late);
    let out = folder.path().join("out");
    simulate(&scenario, &out, 2, &["--people", "1"]);
    let person = out.join("p001");

    let mut log = open(person.join("log.mcap")).unwrap();
    let observations: Vec<Observation> = log.by_ref().collect::<Result<_, _>>().unwrap();
    let warned = |wanted: fn(&LogWarning) -> bool| log.warnings().iter().any(wanted);
    assert!(warned(|w| matches!(w, LogWarning::Late { .. })), "{:?}", log.warnings());
    let of = |kind| observations.iter().filter(|o| o.kind() == kind).count();
    assert_eq!(of(ObservationKind::Imu), 6000);
    assert_eq!(of(ObservationKind::Pressure), 60 * 10);
    let ranges: Vec<_> = observations
        .iter()
        .filter_map(|o| if let Observation::Range(range) = o { Some(range) } else { None })
        .collect();
    assert!(ranges.len() > 600, "{}", ranges.len());
    assert!(ranges.iter().all(|range| {
        let response = range.reception.as_ref().unwrap().impulse_response.as_ref().unwrap();
        response.first_tap == 700 && response.taps.len() == 200
    }));

    // The truth of the ranges has a row for each, by stamp and anchor; most errors are decimetres.
    let table = fs::read_to_string(person.join("ranges_truth.csv")).unwrap();
    let truths: BTreeMap<(String, String), f64> = table
        .lines()
        .skip(1)
        .map(|row| {
            let cells: Vec<&str> = row.split(',').collect();
            ((cells[0].to_owned(), cells[1].to_owned()), cells[2].parse().unwrap())
        })
        .collect();
    let error = |range: &&adit_observation::RangeSample| {
        (range.range_m - truths[&(range.time.to_string(), range.anchor.to_string())]).abs()
    };
    let small = ranges.iter().filter(|range| error(range) < 0.5).count();
    assert!(small * 10 > ranges.len() * 7, "{small} of {}", ranges.len());

    let path = truth::read(person.join("truth.tum")).unwrap().trajectory;
    assert_eq!(path.poses().len(), 601, "the first, and ten a second");
}

#[test]
fn people_who_are_not_there_are_no_people() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = scenario(folder.path(), "");
    let run = |people: &str| {
        let mut command = Command::cargo_bin("adit").unwrap();
        command
            .arg("simulate")
            .arg(&scenario)
            .arg("-o")
            .arg(folder.path().join("x"))
            .args(["--people", people]);
        let output = command.output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let (code, told) = run("5-7");
    assert_eq!(code, Some(1));
    assert!(told.contains("--people 5-7: there are 6 people in this mine"), "{told}");
    assert_eq!(told.lines().count(), 1, "{told}");
    let (code, told) = run("7-5");
    assert_eq!(code, Some(2), "{told}");
    assert!(told.contains("7, 1-20"), "{told}");
}
