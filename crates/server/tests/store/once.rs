//! A replayed journal writes nothing twice.

use crate::common::{Site, alarm, at, audit, event, fix, round};
use adit_server::store::{AuditQuery, LogQuery, Record, Round, StoreError, TrackOf, TrackQuery};

const ROUNDS: u64 = 12;

fn rounds() -> Vec<Round> {
    (1..=ROUNDS)
        .map(|position| {
            let second = position.cast_signed();
            let mut records = vec![
                Record::Fix(fix("t1", second, 10.0 + second as f64)),
                Record::Fix(fix("t2", second, 20.0)),
                Record::Event(event("zone-entered", second, &["anna", "z1"])),
                Record::Audit(audit("otto", second)),
            ];
            records.push(Record::Alarm(alarm(
                "a1",
                if position < 6 { "raised" } else { "cleared" },
                1,
                (position >= 6).then_some(second),
            )));
            round(position, records)
        })
        .collect()
}

/// Everything that the store tells.
async fn told(site: &Site) -> Vec<String> {
    let mut told = Vec::new();
    for tag in site.store.tags().await.unwrap() {
        let query = TrackQuery { of: TrackOf::Tag(tag), from: at(0), until: at(1000) };
        told.push(format!("{:?}", site.store.track_page(&query).await.unwrap()));
    }
    told.push(format!("{:?}", site.store.events(&LogQuery::default()).await.unwrap()));
    told.push(format!("{:?}", site.store.alarms(&LogQuery::default()).await.unwrap()));
    told.push(format!("{:?}", site.store.audit_rows(&AuditQuery::default()).await.unwrap()));
    told.push(format!("{:?}", site.store.verify_audit(&[]).await.unwrap()));
    told.push(format!("{:?}", site.store.applied().await.unwrap()));
    told
}

#[tokio::test]
async fn a_replay_from_any_point_to_any_point_writes_nothing_twice() {
    let whole = Site::new().await;
    let outcome = whole.store.commit_rounds(&rounds()).await.unwrap();
    assert_eq!((outcome.applied, outcome.written, outcome.repeated), (ROUNDS, 5 * ROUNDS, 0));
    let expected = told(&whole).await;
    for cut in 0..=rounds().len() {
        for again_from in 0..=cut {
            let mut site = Site::new().await;
            site.store.commit_rounds(&rounds()[..cut]).await.unwrap();
            site.reopen().await;
            // The journal is replayed from a checkpoint before the cut, grouped otherwise.
            for some in rounds()[again_from..].chunks(5) {
                site.store.commit_rounds(some).await.unwrap();
            }
            assert_eq!(told(&site).await, expected, "cut after {cut}, replayed from {again_from}");
        }
    }
}

#[tokio::test]
async fn rounds_must_rise() {
    let site = Site::new().await;
    let failed = site.store.commit_rounds(&[round(2, vec![]), round(2, vec![])]).await.unwrap_err();
    assert!(matches!(failed, StoreError::OutOfOrder { found: 2, after: 2 }), "{failed}");
    assert_eq!(site.store.applied().await.unwrap(), 0);
}

#[tokio::test]
async fn a_fix_that_no_column_holds_is_counted_and_keeps_nothing_back() {
    let site = Site::new().await;
    let mut nowhere = fix("t1", 1, f64::NAN);
    let mut records = vec![Record::Fix(nowhere.clone())];
    nowhere.position_m[0] = 1e9;
    records.push(Record::Fix(nowhere));
    records.push(Record::Fix(fix("t1", 2, 1.0)));
    let outcome = site.store.commit(7, records).await.unwrap();
    assert_eq!((outcome.written, outcome.refused, outcome.applied), (1, 2, 7));
}
