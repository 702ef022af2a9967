//! What is too old is gone, what is not is all there, and the space is given back.

use crate::common::{Site, alarm, at, event, fix, raw, whole_track};
use crate::walk::shift;
use adit_server::store::{LogQuery, Record, Retained, Retention};

const DAY_S: i64 = 86_400;

#[tokio::test]
async fn tracks_events_and_cleared_alarms_go_to_the_second() {
    let site = Site::new().await;
    let mut records: Vec<Record> = Vec::new();
    for hour in 0..10 * 24 {
        records.push(Record::Fix(fix("t1", hour * 3600, hour as f64)));
        records.push(Record::Event(event("tick", hour * 3600, &["anna"])));
    }
    records.push(Record::Fix(fix("t2", 0, 0.0)));
    records.push(Record::Alarm(alarm("old and cleared", "cleared", 0, Some(DAY_S))));
    records.push(Record::Alarm(alarm("old and open", "raised", 0, None)));
    records.push(Record::Alarm(alarm("cleared lately", "cleared", 0, Some(8 * DAY_S))));
    site.store.commit(1, records).await.unwrap();
    site.store.compact(at(10 * DAY_S)).await.unwrap();
    // Some beside the chunks.
    site.store
        .commit(2, vec![Record::Fix(fix("t1", 1, 0.0)), Record::Fix(fix("t1", 10 * DAY_S, 0.0))])
        .await
        .unwrap();
    let everything = Retention::default();
    // Space is given back all the same: that of rows packed.
    let nothing = |gone: Retained| Retained { bytes: 0, ..gone } == Retained::default();
    assert!(nothing(site.store.retain(at(10 * DAY_S), &everything).await.unwrap()));
    let keep =
        Retention { tracks_days: Some(3), events_days: Some(5), alarms_days: Some(4), audit_days: None };
    let gone = site.store.retain(at(10 * DAY_S), &keep).await.unwrap();
    assert_eq!((gone.fixes, gone.events, gone.alarms), (7 * 24 + 2, 5 * 24, 1));
    let fixes = whole_track(&site.store, "t1").await;
    assert_eq!((fixes.len(), fixes[0].time), (3 * 24 + 1, at(7 * DAY_S)));
    assert_eq!(site.store.tags().await.unwrap(), ["t1"]);
    for subject in [None, Some("anna".to_owned())] {
        let events = site.store.events(&LogQuery { subject, ..LogQuery::default() }).await.unwrap().rows;
        assert_eq!((events.len(), events[0].time), (5 * 24, at(5 * DAY_S)));
    }
    let alarms = site.store.alarms(&LogQuery::default()).await.unwrap().rows;
    assert_eq!(
        alarms.iter().map(|alarm| alarm.id.as_str()).collect::<Vec<_>>(),
        ["old and open", "cleared lately"]
    );
    let mut file = raw(&site).await;
    for (table, left) in [("event_subject", 2 * 5 * 24 / 2), ("alarm_subject", 2)] {
        let rows: i64 = sqlx::query_scalar(sqlx::AssertSqlSafe(format!("SELECT count(*) FROM {table}")))
            .fetch_one(&mut file)
            .await
            .unwrap();
        assert_eq!(rows, left, "{table}");
    }
    assert!(nothing(site.store.retain(at(10 * DAY_S), &keep).await.unwrap()));
    assert_eq!(site.store.check().await.unwrap(), Vec::<String>::new());
}

#[tokio::test]
async fn the_space_is_given_back() {
    let mut site = Site::new().await;
    let events: Vec<_> =
        (0..20_000).map(|second| Record::Event(event("tick", second, &["anna", "bert"]))).collect();
    site.store.commit(1, events).await.unwrap();
    site.store.commit(2, shift("t1", 50_000, 1).into_iter().map(Record::Fix).collect()).await.unwrap();
    site.store.compact(at(60_000)).await.unwrap();
    site.reopen().await;
    let size = |site: &Site| std::fs::metadata(site.folder.path().join("adit.db")).unwrap().len();
    let before = size(&site);
    let keep = Retention { tracks_days: Some(1), events_days: Some(1), ..Retention::default() };
    let gone = site.store.retain(at(3 * DAY_S), &keep).await.unwrap();
    assert_eq!((gone.fixes, gone.events), (50_000, 20_000));
    // While the store is in use, not only when it is opened again.
    let after = size(&site);
    println!("{before} bytes before, {after} after retention, {} told", gone.bytes);
    assert!(after < before / 10 && gone.bytes > before / 2);
}
