//! `adit demo` works anywhere: a shift is followed live through all that happens in it, a walk is tracked and judged.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{adit, files};
use std::path::PathBuf;

#[test]
fn the_walk_makes_its_own_log_and_figures() {
    let folder = tempfile::tempdir().unwrap();
    let outcome = adit(folder.path(), &["demo", "--walk"]);
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    for word in ["distance", "end error", "2D RMSE", "% of the distance", "Now try", "out/demo/path.svg"] {
        assert!(outcome.stdout.contains(word), "{word}: {}", outcome.stdout);
    }
    let made = folder.path().join("out/demo");
    let expected = [
        "estimate.csv",
        "estimate.tum",
        "evaluation.svg",
        "filter.toml",
        "log.mcap",
        "log.toml",
        "path.svg",
        "truth.tum",
    ];
    assert_eq!(files(&made), expected.map(PathBuf::from));
    for figure in ["path.svg", "evaluation.svg"] {
        let text = std::fs::read_to_string(made.join(figure)).unwrap();
        assert!(text.starts_with("<svg") && text.trim_end().ends_with("</svg>"), "{figure}");
    }
}

#[test]
fn the_walk_goes_where_it_is_told_with_another_seed() {
    let folder = tempfile::tempdir().unwrap();
    let outcome = adit(folder.path(), &["demo", "--walk", "--out", "here", "--seed", "7"]);
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    assert!(outcome.stdout.contains("seed 7"));
    assert_eq!(files(folder.path()), [PathBuf::from("here")]);
}

/// Twelve people, four minutes, twenty times as fast: the same story as in the long shift, through a power cut.
#[test]
fn a_short_shift_raises_the_alarms_of_its_story_and_finds_everybody_after_the_power_cut() {
    let folder = tempfile::tempdir().unwrap();
    let flags =
        ["--people", "12", "--minutes", "4", "--speed", "20", "--no-browser", "--listen", "127.0.0.1:0"];
    let outcome = adit(folder.path(), &[&["demo", "--out", "here"], &flags[..]].concat());
    let told = format!("{}\n{}", outcome.stdout, outcome.stderr);
    assert_eq!(outcome.code, 0, "{told}");
    for line in [
        "man-down: Anna Adler (p001)",
        "distress: Maria Dahl (p004)",
        "restricted-zone: Li Wei Berg (p002), l360-magazine",
        "gateway-down: gw-l360-east",
        "anchor-down: a-l300-haulage-8",
        "low-battery: T003",
        "power is back",
        "people whose tags send are found again",
        "evacuation: everybody",
    ] {
        assert!(outcome.stdout.contains(line), "{line}:\n{told}");
    }
    let counted = outcome.stdout.lines().find(|line| line.contains("packets acknowledged")).unwrap();
    let numbers: Vec<u64> = counted.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    assert!(numbers[1] > 2000 && numbers[2] == numbers[1], "all that was acknowledged is there: {counted}");
    let score = outcome.stdout.lines().find(|line| line.contains("the whole shift")).unwrap();
    let median = score.split("median ").nth(1).unwrap().split(' ').next().unwrap().parse::<f64>().unwrap();
    // People keep 0.8 m and more to the right of the centre line that holds them, ranges are good to some decimetres.
    assert!(median < 2.0, "{score}");
    // A second shift needs a folder of its own: nothing that was kept is written over.
    let again = adit(folder.path(), &[&["demo", "--out", "here"], &flags[..]].concat());
    assert!(again.code == 1 && again.stderr.contains("there is a shift already"), "{}", again.stderr);
}
