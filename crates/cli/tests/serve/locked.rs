//! Another process holds the store's file.

use crate::served::{Served, load, report};
use serde_json::json;
use sqlx::{ConnectOptions as _, Connection as _};
use std::time::{Duration, Instant};

#[tokio::test]
async fn while_the_store_is_locked_positions_go_on_and_afterwards_nothing_is_missing() {
    let locked_s: u64 = std::env::var("ADIT_STORE_LOCKED_S").ok().and_then(|s| s.parse().ok()).unwrap_or(12);
    let folder = tempfile::tempdir().unwrap();
    let served = Served::start(folder.path(), None, "127.0.0.1:0");
    let token = served.token().await;
    let seconds = (locked_s + 25).to_string();
    let load = load(&served.url, &token, &["--tags", "10", "--seconds", &seconds, "--per-gateway", "5"]);
    served.wait_for_positions(&token).await;
    let (tag, before) = served.positions(&token).await.pop_first().unwrap();

    let file = sqlx::sqlite::SqliteConnectOptions::new().filename(folder.path().join("adit.sqlite"));
    let mut other = file.busy_timeout(Duration::from_secs(10)).connect().await.unwrap();
    sqlx::raw_sql("BEGIN IMMEDIATE").execute(&mut other).await.unwrap();
    let begin = Instant::now();
    let (mut told, mut slowest) = (std::collections::BTreeSet::new(), Duration::ZERO);
    let mut failing = Vec::new();
    while begin.elapsed() < Duration::from_secs(locked_s) {
        let asked = Instant::now();
        told.extend(served.positions(&token).await.into_values().max());
        slowest = slowest.max(asked.elapsed());
        failing.extend(served.failing().await.1);
        tokio::time::sleep(Duration::from_millis(500)).await;
    }
    println!("locked for {locked_s} s: {} moments told, slowest answer {slowest:?}", told.len());
    // A fix a second; the first of them may be from before, and two cores are shared.
    assert!(told.len() as u64 > locked_s / 2, "live positions stood still: {told:?}");
    assert!(slowest < Duration::from_secs(3), "whoever reads waited for {slowest:?}");
    // SQLite waits for 5 s before it says so.
    assert!(failing.contains(&"store".to_owned()), "{failing:?}");
    // A command is done, and does not wait for the audit log for long.
    let asked = Instant::now();
    let person = json!({ "id": "p1", "name": "Ann" });
    let (status, answer) = served.ask("POST", "/api/v1/people", &token, Some(person)).await;
    assert_eq!(status, 201, "{answer}");
    assert!(asked.elapsed() < Duration::from_secs(4), "{:?}", asked.elapsed());
    // Who wants in must be written down: not now.
    let login = json!({ "name": "admin", "password": "wrong, but never looked at" });
    let (status, answer) = served.ask("POST", "/api/v1/session", "", Some(login)).await;
    assert_eq!((status, &answer["type"]), (503, &json!("unavailable")), "{answer}");
    other.close().await.unwrap();

    served.wait_for_health(200, Duration::from_secs(20)).await;
    let report = report(load);
    println!("{report}");
    assert_eq!((&report["lost_packets"], &report["failed_tries"]), (&json!(0), &json!(0)), "{report}");
    served.check_history(&token, &tag, before).await;
}
