//! `adit demo` works anywhere and shows what it made.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use common::{adit, files};
use std::path::PathBuf;

#[test]
fn the_demo_makes_its_own_walk_and_figures() {
    let folder = tempfile::tempdir().unwrap();
    let outcome = adit(folder.path(), &["demo"]);
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
fn the_demo_goes_where_it_is_told_with_another_seed() {
    let folder = tempfile::tempdir().unwrap();
    let outcome = adit(folder.path(), &["demo", "--out", "here", "--seed", "7"]);
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    assert!(outcome.stdout.contains("seed 7"));
    assert_eq!(files(folder.path()), [PathBuf::from("here")]);
}
