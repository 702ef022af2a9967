//! Stores and records to try.

use adit_core::solution::Quality;
use adit_core::time::Time;
use adit_server::store::{
    AlarmRecord, AuditRecord, EventRecord, FixRecord, Record, Round, Store, TrackOf, TrackQuery,
};
use serde_json::json;
use tempfile::TempDir;

/// 2026-11-22T06:00:00Z.
pub const MORNING: i64 = 1_795_327_200_000_000_000;
pub const SECOND: i64 = 1_000_000_000;

pub struct Site {
    pub store: Store,
    pub folder: TempDir,
}

impl Site {
    pub async fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(&folder.path().join("adit.db")).await.unwrap();
        Self { store, folder }
    }

    pub async fn reopen(&mut self) {
        self.store.close().await;
        self.store = Store::open(&self.folder.path().join("adit.db")).await.unwrap();
    }
}

pub fn at(seconds: i64) -> Time {
    Time::from_nanos(MORNING + seconds * SECOND)
}

pub fn fix(tag: &str, seconds: i64, x_m: f64) -> FixRecord {
    FixRecord {
        person: Some(format!("person of {tag}")),
        tag: tag.to_owned(),
        time: at(seconds),
        position_m: [x_m, -3.25, 1200.5],
        radius_95_m: 0.32,
        quality: Quality::Fixed,
        level: Some("L1".to_owned()),
        zone: None,
    }
}

pub fn event(kind: &str, seconds: i64, subjects: &[&str]) -> EventRecord {
    EventRecord {
        time: at(seconds),
        kind: kind.to_owned(),
        subjects: subjects.iter().map(|&subject| subject.to_owned()).collect(),
        body: json!({ "kind": kind, "of": subjects, "second": seconds }),
    }
}

pub fn alarm(id: &str, state: &str, raised: i64, cleared: Option<i64>) -> AlarmRecord {
    AlarmRecord {
        id: id.to_owned(),
        kind: "overtime".to_owned(),
        state: state.to_owned(),
        raised: at(raised),
        changed: at(cleared.unwrap_or(raised)),
        cleared: cleared.map(at),
        subjects: vec!["anna".to_owned()],
        body: json!({ "id": id, "state": state }),
    }
}

pub fn audit(who: &str, seconds: i64) -> AuditRecord {
    AuditRecord {
        time: at(seconds),
        who: who.to_owned(),
        what: "tag.assign".to_owned(),
        source: "127.0.0.1".to_owned(),
        outcome: "done".to_owned(),
        detail: json!({ "tag": "t1" }),
    }
}

pub fn round(position: u64, records: Vec<Record>) -> Round {
    Round { position, records }
}

/// All of a track, page by page.
pub async fn track(store: &Store, of: TrackOf, from: Time, until: Time) -> Vec<FixRecord> {
    let mut query = TrackQuery { of, from, until };
    let mut fixes = Vec::new();
    loop {
        let page = store.track_page(&query).await.unwrap();
        fixes.extend(page.fixes);
        match page.next {
            Some(next) => {
                assert!(next > query.from, "a page must get on");
                query.from = next;
            }
            None => return fixes,
        }
    }
}

pub async fn whole_track(store: &Store, tag: &str) -> Vec<FixRecord> {
    track(store, TrackOf::Tag(tag.to_owned()), at(-400 * 86_400), at(400 * 86_400)).await
}

/// The file as another program would open it.
pub async fn raw(site: &Site) -> sqlx::SqliteConnection {
    use sqlx::{ConnectOptions as _, sqlite::SqliteConnectOptions};
    SqliteConnectOptions::new().filename(site.folder.path().join("adit.db")).connect().await.unwrap()
}
