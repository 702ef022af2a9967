//! Tampering with the audit log shows, and which row is the first that does not fit.

use crate::common::{Site, at, audit, raw};
use adit_server::store::{AuditBreak, AuditHead, AuditQuery, AuditVerdict, Record, Retention};
use sqlx::AssertSqlSafe;

const ROWS: u64 = 10;

async fn with_rows() -> Site {
    let site = Site::new().await;
    for row in 1..=ROWS {
        let entry = audit("otto", row.cast_signed());
        // Both ways in: with the journal, and without.
        if row % 2 == 0 {
            site.store.commit(row, vec![Record::Audit(entry)]).await.unwrap();
        } else {
            site.store.audit(&entry).await.unwrap();
        }
    }
    site
}

/// What `verify` finds after somebody did this to the file.
async fn verdict_after(statements: &[&str]) -> AuditVerdict {
    let site = with_rows().await;
    let mut file = raw(&site).await;
    for statement in statements {
        sqlx::raw_sql(AssertSqlSafe((*statement).to_owned())).execute(&mut file).await.unwrap();
    }
    site.store.verify_audit(&[]).await.unwrap()
}

#[tokio::test]
async fn an_untouched_log_is_whole() {
    let site = with_rows().await;
    let verdict = site.store.verify_audit(&[]).await.unwrap();
    assert_eq!((verdict.rows, verdict.head.number, &verdict.broken), (ROWS, ROWS, &None));
    assert_eq!(verdict.head, site.store.audit_head().await.unwrap());
    let rows = site
        .store
        .audit_rows(&AuditQuery { newest_first: true, limit: 3, ..AuditQuery::default() })
        .await
        .unwrap();
    assert_eq!(rows.iter().map(|row| row.number).collect::<Vec<_>>(), [10, 9, 8]);
    assert_eq!(rows[0].record, audit("otto", 10));
}

#[tokio::test]
async fn every_change_of_every_row_shows_there() {
    for change in [
        "time_ns = time_ns + 1",
        "who = 'Otto'",
        "what = 'tag.assigN'",
        "source = ''",
        "outcome = 'refused'",
        r#"detail = '{"tag":"t2"}'"#,
        "hash = zeroblob(32)",
        // The same bytes over all, shifted between two fields.
        "who = 'ottot', what = 'ag.assign'",
    ] {
        for row in [1, 5, ROWS] {
            let verdict = verdict_after(&[&format!("UPDATE audit SET {change} WHERE number = {row}")]).await;
            assert_eq!(verdict.broken, Some(AuditBreak::Changed { number: row }), "{change} of row {row}");
            assert_eq!(verdict.rows, row - 1);
        }
    }
}

#[tokio::test]
async fn rows_taken_out_put_in_moved_or_cut_off_show() {
    let out = verdict_after(&["DELETE FROM audit WHERE number = 4"]).await;
    assert_eq!(out.broken, Some(AuditBreak::Gap { after: 3, found: 5 }));
    let out_and_closed = verdict_after(&[
        "DELETE FROM audit WHERE number = 4",
        "UPDATE audit SET number = number - 1 WHERE number > 4",
        "UPDATE audit_end SET number = 9 WHERE id = 2",
    ])
    .await;
    assert_eq!(out_and_closed.broken, Some(AuditBreak::Changed { number: 4 }));
    let first = verdict_after(&["DELETE FROM audit WHERE number = 1"]).await;
    assert_eq!(first.broken, Some(AuditBreak::Gap { after: 0, found: 2 }));
    let moved = verdict_after(&[
        "UPDATE audit SET number = 100 WHERE number = 3",
        "UPDATE audit SET number = 3 WHERE number = 4",
        "UPDATE audit SET number = 4 WHERE number = 100",
    ])
    .await;
    assert_eq!(moved.broken, Some(AuditBreak::Changed { number: 3 }));
    let put_in = verdict_after(&["INSERT INTO audit SELECT 11, time_ns, who, what, source, outcome, detail, hash FROM audit WHERE number = 10"]).await;
    assert_eq!(put_in.broken, Some(AuditBreak::Changed { number: 11 }));
    let cut = verdict_after(&["DELETE FROM audit WHERE number > 7"]).await;
    assert_eq!(cut.broken, Some(AuditBreak::End { found: 7, expected: ROWS }));
    let emptied = verdict_after(&["DELETE FROM audit"]).await;
    assert_eq!(emptied.broken, Some(AuditBreak::End { found: 0, expected: ROWS }));
}

#[tokio::test]
async fn a_log_cut_together_with_its_end_shows_by_a_head_kept_elsewhere() {
    let site = with_rows().await;
    let kept: AuditHead = site.store.audit_head().await.unwrap().to_string().parse().unwrap();
    let earlier = {
        let mut file = raw(&site).await;
        sqlx::raw_sql(
            "DELETE FROM audit WHERE number > 7;
             UPDATE audit_end SET number = 7, hash = (SELECT hash FROM audit WHERE number = 7) WHERE id = 2",
        )
        .execute(&mut file)
        .await
        .unwrap();
        site.store.audit_head().await.unwrap()
    };
    // The limit of a chain without a witness: it looks whole.
    assert_eq!(site.store.verify_audit(&[]).await.unwrap().broken, None);
    assert_eq!(
        site.store.verify_audit(&[kept]).await.unwrap().broken,
        Some(AuditBreak::OtherHead { number: ROWS })
    );
    // And so does one that went on elsewhere from there.
    for row in 0..5 {
        site.store.audit(&audit("mallory", row)).await.unwrap();
    }
    assert_eq!(site.store.verify_audit(&[]).await.unwrap().broken, None);
    assert_eq!(site.store.verify_audit(&[earlier]).await.unwrap().broken, None);
    assert_eq!(
        site.store.verify_audit(&[earlier, kept]).await.unwrap().broken,
        Some(AuditBreak::OtherHead { number: ROWS })
    );
}

#[tokio::test]
async fn a_chain_whose_beginning_retention_took_away_still_stands() {
    let site = Site::new().await;
    let mut heads = Vec::new();
    for day in 0..10 {
        heads.push(site.store.audit(&audit("otto", day * 86_400)).await.unwrap());
    }
    let keep = Retention { audit_days: Some(3), ..Retention::default() };
    // Twice: the second cut stands on the first.
    assert_eq!(site.store.retain(at(7 * 86_400), &keep).await.unwrap().audit_rows, 4);
    assert_eq!(site.store.retain(at(9 * 86_400), &keep).await.unwrap().audit_rows, 2);
    assert_eq!(site.store.retain(at(9 * 86_400), &keep).await.unwrap().audit_rows, 0);
    let verdict = site.store.verify_audit(&heads).await.unwrap();
    // Rows 7 to 10, and the two that tell the cuts.
    assert_eq!(
        (verdict.rows, verdict.anchor, verdict.head.number, &verdict.broken),
        (6, heads[5], 12, &None)
    );
    assert_eq!(verdict.too_old, heads[..5]);
    let mut file = raw(&site).await;
    sqlx::raw_sql(
        "UPDATE audit_end SET number = 8, hash = (SELECT hash FROM audit WHERE number = 8) WHERE id = 1; DELETE FROM audit WHERE number <= 8",
    )
    .execute(&mut file)
    .await
    .unwrap();
    assert_eq!(site.store.verify_audit(&[]).await.unwrap().broken, Some(AuditBreak::Beginning { anchor: 8 }));
}

/// Written by `tests/reference/audit_chain.py`, which knows the rule from the documentation alone.
#[tokio::test]
async fn the_hash_is_what_the_documentation_says() {
    let site = Site::new().await;
    site.store.audit(&audit("otto", 1)).await.unwrap();
    let head = site.store.audit(&audit("jörg", 2)).await.unwrap();
    assert_eq!(head.to_string(), include_str!("../reference/audit_chain.txt").trim());
}
