//! What is wrong with the file or the disk is told by type, and nothing half done stays.

use crate::common::{Site, at, audit, event, fix, raw, whole_track};
use adit_server::store::{LogQuery, Record, Store, StoreError};
use std::path::Path;
use std::time::Instant;

async fn refused(path: &Path) -> StoreError {
    Store::open(path).await.unwrap_err()
}

#[tokio::test]
async fn a_file_that_is_no_database_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("adit.db");
    let text = "time_s,x_m,y_m\n".repeat(1000);
    std::fs::write(&path, &text).unwrap();
    let error = refused(&path).await;
    assert!(matches!(error, StoreError::NotADatabase { .. }), "{error}");
    assert!(!error.may_be_tried_again());
    assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
}

#[tokio::test]
async fn the_database_of_another_program_is_left_alone() {
    let site = Site::new().await;
    let path = site.folder.path().join("other.db");
    let copy = {
        use sqlx::{ConnectOptions as _, Connection as _, sqlite::SqliteConnectOptions};
        let mut other =
            SqliteConnectOptions::new().filename(&path).create_if_missing(true).connect().await.unwrap();
        sqlx::raw_sql("CREATE TABLE moz_places (id INTEGER PRIMARY KEY)").execute(&mut other).await.unwrap();
        other.close().await.unwrap();
        std::fs::read(&path).unwrap()
    };
    let error = refused(&path).await;
    assert!(matches!(error, StoreError::Foreign { found: 0, .. }), "{error}");
    assert_eq!(std::fs::read(&path).unwrap(), copy);
}

#[tokio::test]
async fn a_store_of_a_newer_adit_is_refused() {
    let site = Site::new().await;
    site.store.close().await;
    sqlx::raw_sql("INSERT INTO _sqlx_migrations (version, description, success, checksum, execution_time) VALUES (9901, 'later', 1, x'00', 0)")
        .execute(&mut raw(&site).await)
        .await
        .unwrap();
    let error = refused(site.store.path()).await;
    assert!(matches!(error, StoreError::NewerSchema { found: 9901, .. }), "{error}");
    assert!(error.to_string().contains("newer adit"), "{error}");
}

#[tokio::test]
async fn a_folder_that_is_not_there_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let error = refused(&folder.path().join("nowhere/adit.db")).await;
    assert!(matches!(error, StoreError::Io { .. }), "{error}");
}

#[tokio::test]
async fn a_lock_of_another_process_is_waited_for_then_told_and_the_same_call_done_later() {
    let site = Site::new().await;
    site.store.commit(1, vec![Record::Fix(fix("t1", 1, 1.0))]).await.unwrap();
    let mut other = raw(&site).await;
    sqlx::raw_sql("BEGIN EXCLUSIVE").execute(&mut other).await.unwrap();
    let started = Instant::now();
    let error = site.store.commit(2, vec![Record::Fix(fix("t1", 2, 2.0))]).await.unwrap_err();
    assert!(matches!(error, StoreError::Locked { .. }) && error.may_be_tried_again(), "{error}");
    assert!((3.0..10.0).contains(&started.elapsed().as_secs_f64()), "waited {:?}", started.elapsed());
    // Whoever reads does not wait.
    assert_eq!(whole_track(&site.store, "t1").await.len(), 1);
    sqlx::raw_sql("COMMIT").execute(&mut other).await.unwrap();
    site.store.commit(2, vec![Record::Fix(fix("t1", 2, 2.0))]).await.unwrap();
    assert_eq!((whole_track(&site.store, "t1").await.len(), site.store.applied().await.unwrap()), (2, 2));
}

#[tokio::test]
async fn a_full_disk_is_told_leaves_nothing_half_done_and_goes_on_when_there_is_room() {
    let mut site = Site::new().await;
    site.store.commit(1, vec![Record::Event(event("start", 0, &["anna"]))]).await.unwrap();
    site.store.close().await;
    // SQLite's own disk of so many pages.
    let pages: i64 = sqlx::query_scalar("PRAGMA page_count").fetch_one(&mut raw(&site).await).await.unwrap();
    let path = site.folder.path().join("adit.db");
    site.store = Store::open_limited(&path, u32::try_from(pages).unwrap() + 20).await.unwrap();
    let many = |position: i64| -> Vec<Record> {
        (0..100)
            .flat_map(|at| {
                [
                    Record::Fix(fix("t1", position * 100 + at, 1.0)),
                    Record::Event(event("e", at, &["anna"])),
                    Record::Audit(audit("otto", at)),
                ]
            })
            .collect()
    };
    let mut position = 2_i64;
    let error = loop {
        assert!(position < 1000, "the disk never gets full");
        match site.store.commit(position.cast_unsigned(), many(position)).await {
            Ok(_) => position += 1,
            Err(error) => break error,
        }
    };
    assert!(matches!(error, StoreError::Full { .. }) && error.may_be_tried_again(), "{error}");
    let count = |site: &Site| {
        let store = site.store.clone();
        async move {
            let log = LogQuery { kinds: vec!["e".to_owned()], ..LogQuery::default() };
            (
                store.events(&log).await.unwrap().rows.len(),
                store.verify_audit(&[]).await.unwrap().rows,
                store.applied().await.unwrap(),
            )
        }
    };
    let whole = u64::try_from(position - 2).unwrap();
    assert_eq!(count(&site).await, (100 * usize::try_from(whole).unwrap(), 100 * whole, whole + 1));
    // Reading goes on, and so does the rest, time and again.
    for _ in 0..3 {
        let again = site.store.commit(position.cast_unsigned(), many(position)).await;
        assert!(matches!(again, Err(StoreError::Full { .. })), "{again:?}");
    }
    site.reopen().await;
    site.store.commit(position.cast_unsigned(), many(position)).await.unwrap();
    assert_eq!(count(&site).await, (100 * usize::try_from(whole + 1).unwrap(), 100 * (whole + 1), whole + 2));
    assert_eq!(site.store.verify_audit(&[]).await.unwrap().broken, None);
    assert_eq!(site.store.check().await.unwrap(), Vec::<String>::new());
}

#[tokio::test]
async fn a_damaged_chunk_is_named_and_holds_up_nobody_else() {
    let site = Site::new().await;
    for (position, tag) in [(1, "t1"), (2, "t2")] {
        site.store
            .commit(position, (0..600).map(|second| Record::Fix(fix(tag, second, second as f64))).collect())
            .await
            .unwrap();
    }
    site.store.compact(at(1000)).await.unwrap();
    let mut file = raw(&site).await;
    let id: i64 = sqlx::query_scalar(
        "UPDATE track_chunk SET columns = CAST(substr(columns, 1, 40) || x'ff' || substr(columns, 42) AS BLOB)
         WHERE tag = (SELECT id FROM name WHERE name = 't1') RETURNING id",
    )
    .fetch_one(&mut file)
    .await
    .unwrap();
    let query = adit_server::store::TrackQuery {
        of: adit_server::store::TrackOf::Tag("t1".to_owned()),
        from: at(0),
        until: at(1000),
    };
    let error = site.store.track_page(&query).await.unwrap_err();
    assert!(
        matches!(&error, StoreError::Corrupt { said, .. } if said.contains(&format!("track_chunk {id}: CRC-32"))),
        "{error}"
    );
    assert_eq!(whole_track(&site.store, "t2").await.len(), 600);
    assert_eq!(site.store.last_fixes(at(1000)).await.unwrap().len(), 1);
    let wrong = site.store.check().await.unwrap();
    assert_eq!(wrong.len(), 1, "{wrong:?}");
    // Late fixes beside it are packed all the same.
    site.store
        .commit(3, vec![Record::Fix(fix("t1", 300, 0.0)), Record::Fix(fix("t2", 700, 0.0))])
        .await
        .unwrap();
    assert_eq!(site.store.compact(at(2000)).await.unwrap().fixes, 2);
    assert_eq!(whole_track(&site.store, "t2").await.len(), 601);
}

#[tokio::test]
async fn a_backup_of_a_store_in_use_is_the_store_as_it_was() {
    let site = Site::new().await;
    site.store
        .commit(1, (0..3000).map(|second| Record::Fix(fix("t1", second, second as f64))).collect())
        .await
        .unwrap();
    site.store.compact(at(5000)).await.unwrap();
    site.store
        .commit(2, vec![Record::Fix(fix("t1", 3000, 1.0)), Record::Audit(audit("otto", 1))])
        .await
        .unwrap();
    let copy = site.folder.path().join("backup.db");
    site.store.backup(&copy).await.unwrap();
    site.store.commit(3, vec![Record::Fix(fix("t1", 3001, 1.0))]).await.unwrap();
    let taken = site.store.backup(&copy).await.unwrap_err();
    assert!(matches!(taken, StoreError::Io { .. }), "{taken}");
    // Restored: the copy in the place of the store, which goes on from there by replaying the journal.
    let place = site.folder.path().join("restored").join("adit.db");
    std::fs::create_dir(place.parent().unwrap()).unwrap();
    std::fs::copy(&copy, &place).unwrap();
    let restored = Store::open(&place).await.unwrap();
    assert_eq!((restored.applied().await.unwrap(), whole_track(&restored, "t1").await.len()), (2, 3001));
    restored.commit(3, vec![Record::Fix(fix("t1", 3001, 1.0))]).await.unwrap();
    assert_eq!(whole_track(&restored, "t1").await, whole_track(&site.store, "t1").await);
    assert_eq!(restored.verify_audit(&[site.store.audit_head().await.unwrap()]).await.unwrap().broken, None);
    let left: Vec<_> =
        std::fs::read_dir(site.folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(!left.iter().any(|name| name.to_string_lossy().starts_with(".adit-backup")), "{left:?}");
}
