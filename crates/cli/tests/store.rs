//! `adit audit verify` and `adit store` on a store that a server has written.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use adit_core::solution::Quality;
use adit_core::time::Time;
use adit_server::store::{AuditRecord, FixRecord, Record, Store};
use common::adit;
use std::path::Path;

const MORNING_S: i64 = 1_795_327_200;

/// A store with ten fixes and three rows of the audit log.
fn store(folder: &Path) {
    let time = |second: i64| Time::from_nanos((MORNING_S + second) * 1_000_000_000);
    let fix = |second| {
        Record::Fix(FixRecord {
            person: Some("anna".to_owned()),
            tag: "t1".to_owned(),
            time: time(second),
            position_m: [4700.0, 2800.0, 415.2],
            radius_95_m: 0.5,
            quality: Quality::Fixed,
            level: None,
            zone: None,
        })
    };
    let deed = |second| {
        Record::Audit(AuditRecord {
            time: time(second),
            who: "otto".to_owned(),
            what: "tag.assign".to_owned(),
            source: "127.0.0.1".to_owned(),
            outcome: "done".to_owned(),
            detail: serde_json::json!({ "tag": "t1" }),
        })
    };
    tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap().block_on(async {
        let store = Store::open(&folder.join("adit.sqlite")).await.unwrap();
        store.commit(1, (0..10).map(fix).chain((0..3).map(deed)).collect()).await.unwrap();
        store.close().await;
    });
}

#[test]
fn an_audit_log_is_verified_and_its_head_told() {
    let folder = tempfile::tempdir().unwrap();
    store(folder.path());
    let whole = adit(folder.path(), &["audit", "verify", "adit.sqlite"]);
    assert_eq!(whole.code, 0, "{}", whole.stderr);
    let head = whole.stdout.lines().find_map(|line| line.strip_prefix("head ")).unwrap();
    assert!(whole.stdout.starts_with("3 rows, all as they were written\nhead 3:"), "{}", whole.stdout);
    assert_eq!(adit(folder.path(), &["audit", "verify", "adit.sqlite", "--head", head]).code, 0);
    let other = head.replace("3:", "2:");
    let made_anew = adit(folder.path(), &["audit", "verify", "adit.sqlite", "--head", &other, "--json"]);
    assert_eq!(made_anew.code, 1);
    assert!(
        made_anew.stderr.contains("row 2 is not the one whose head was written down"),
        "{}",
        made_anew.stderr
    );
    assert!(made_anew.stdout.contains("\"other_head\""), "{}", made_anew.stdout);
    assert_eq!(adit(folder.path(), &["audit", "verify", "adit.sqlite", "--head", "3:xy"]).code, 2);
}

#[test]
fn a_store_that_is_not_there_is_not_made() {
    let folder = tempfile::tempdir().unwrap();
    for verb in [&["audit", "verify", "none.sqlite"][..], &["store", "check", "none.sqlite"]] {
        let outcome = adit(folder.path(), verb);
        assert_eq!(outcome.code, 1);
        assert!(outcome.stderr.contains("none.sqlite: no such file"), "{}", outcome.stderr);
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_store_is_copied_checked_and_exported() {
    let folder = tempfile::tempdir().unwrap();
    store(folder.path());
    let run = |args: &[&str]| {
        let outcome = adit(folder.path(), args);
        assert_eq!(outcome.code, 0, "{args:?}: {}", outcome.stderr);
        outcome.stdout
    };
    run(&["store", "backup", "adit.sqlite", "-o", "copy.sqlite"]);
    assert_eq!(run(&["store", "check", "copy.sqlite"]), "no damage\n");
    run(&["store", "export", "copy.sqlite", "tracks", "--from", "2026-11-22T06:00:03Z", "-o", "tracks.csv"]);
    let tracks = std::fs::read_to_string(folder.path().join("tracks.csv")).unwrap();
    assert_eq!(tracks.lines().count(), 1 + 7, "{tracks}");
    let mine = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../mines/two-level.toml");
    let mine = mine.to_str().unwrap();
    run(&[
        "store",
        "export",
        "copy.sqlite",
        "tracks",
        "--person",
        "anna",
        "--mine",
        mine,
        "-o",
        "anna.geojson",
    ]);
    let earth = std::fs::read_to_string(folder.path().join("anna.geojson")).unwrap();
    assert!(earth.contains("WGS-84") && earth.contains("[13.329"), "{earth}");
    run(&["store", "export", "copy.sqlite", "events", "-o", "events.parquet"]);
    assert!(std::fs::read(folder.path().join("events.parquet")).unwrap().starts_with(b"PAR1"));
    let unknown = adit(folder.path(), &["store", "export", "copy.sqlite", "alarms", "-o", "alarms.xlsx"]);
    assert!(
        unknown.code == 1 && unknown.stderr.contains("expected .csv, .geojson or .parquet"),
        "{}",
        unknown.stderr
    );
}
