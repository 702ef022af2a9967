//! What is too old goes, in steps that hold the writer briefly, and its space goes back to the disk.

use crate::store::chunk::{self, Effort};
use crate::store::packed::milliseconds;
use crate::store::track::unpacked;
use crate::store::{Store, StoreError, audit};
use adit_core::time::Time;
use serde::{Deserialize, Serialize};
use sqlx::{AssertSqlSafe, Row as _};

const NANOS_PER_HOUR: i64 = 3_600_000_000_000;
const NANOS_PER_DAY: i64 = 86_400_000_000_000;
/// Rows taken away in one transaction.
const AT_ONCE: u32 = 1000;
/// Pages given back in one transaction: 8 MB.
const PAGES: i64 = 2000;

/// For how many days what is kept; `None`: for ever.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Retention {
    /// Fixes, from their time.
    pub tracks_days: Option<u32>,
    /// Events, from their time.
    pub events_days: Option<u32>,
    /// Alarms, from when they were cleared; one that is not stays.
    pub alarms_days: Option<u32>,
    /// Rows of the audit log, from their time.
    pub audit_days: Option<u32>,
}

/// What was taken away.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Retained {
    /// Fixes.
    pub fixes: u64,
    /// Events.
    pub events: u64,
    /// Alarms.
    pub alarms: u64,
    /// Rows of the audit log.
    pub audit_rows: u64,
    /// Bytes given back to the disk (once the write-ahead log has gone into the file).
    pub bytes: u64,
}

impl Store {
    /// Takes away what is older than it may be at `now`, in whole hours: a chunk that reaches over the limit is packed anew. Each step holds the writer
    /// for some 10 ms.
    pub async fn retain(&self, now: Time, retention: &Retention) -> Result<Retained, StoreError> {
        let _turn = self.maintenance().await;
        let before = |days: u32| {
            let limit = now.nanos().saturating_sub(NANOS_PER_DAY.saturating_mul(i64::from(days)));
            Time::from_nanos(limit.div_euclid(NANOS_PER_HOUR).saturating_mul(NANOS_PER_HOUR))
        };
        let mut gone = Retained::default();
        if let Some(days) = retention.tracks_days {
            gone.fixes = self.forget_tracks(milliseconds(before(days))).await?;
        }
        if let Some(days) = retention.events_days {
            gone.events = self.forget_log(&EVENTS, before(days)).await?;
        }
        if let Some(days) = retention.alarms_days {
            gone.alarms = self.forget_log(&ALARMS, before(days)).await?;
        }
        if let Some(days) = retention.audit_days {
            gone.audit_rows = audit::cut(self, now, before(days)).await?;
        }
        gone.bytes = self.give_back().await?;
        Ok(gone)
    }

    async fn forget_tracks(&self, limit_ms: i64) -> Result<u64, StoreError> {
        let failed = |error: sqlx::Error| self.failed(&error);
        let mut fixes = 0;
        loop {
            let counts: Vec<i64> = sqlx::query_scalar(
                "DELETE FROM track_chunk WHERE id IN (SELECT id FROM track_chunk WHERE until_ms < ?1 ORDER BY until_ms LIMIT ?2) RETURNING count",
            )
            .bind(limit_ms)
            .bind(AT_ONCE)
            .fetch_all(self.writer())
            .await
            .map_err(failed)?;
            fixes += counts.iter().sum::<i64>();
            if (counts.len() as u64) < u64::from(AT_ONCE) {
                break;
            }
        }
        loop {
            let gone = sqlx::query("DELETE FROM fix_recent WHERE seq IN (SELECT seq FROM fix_recent WHERE time_ms < ?1 LIMIT ?2)")
                .bind(limit_ms)
                .bind(AT_ONCE)
                .execute(self.writer())
                .await
                .map_err(failed)?
                .rows_affected();
            fixes += gone.cast_signed();
            if gone < u64::from(AT_ONCE) {
                break;
            }
        }
        fixes += self.trim_chunks(limit_ms).await?;
        sqlx::query(
            "DELETE FROM track_tag WHERE NOT EXISTS (SELECT 1 FROM track_chunk WHERE tag = track_tag.tag)",
        )
        .execute(self.writer())
        .await
        .map_err(failed)?;
        Ok(fixes.cast_unsigned())
    }

    /// Chunks that reach over the limit: of a tag at most one, since they do not overlap.
    async fn trim_chunks(&self, limit_ms: i64) -> Result<i64, StoreError> {
        let failed = |error: sqlx::Error| self.failed(&error);
        let over: Vec<i64> = sqlx::query_scalar(
            "SELECT c.id FROM track_tag t JOIN track_chunk c ON c.id =
               (SELECT id FROM track_chunk WHERE tag = t.tag AND from_ms < ?1 ORDER BY from_ms DESC, until_ms DESC LIMIT 1)",
        )
        .bind(limit_ms)
        .fetch_all(self.readers())
        .await
        .map_err(failed)?;
        let mut gone = 0;
        for id in over {
            let row =
                sqlx::query("SELECT id, tag, person, from_ms, count, columns FROM track_chunk WHERE id = ?1")
                    .bind(id)
                    .fetch_one(self.readers())
                    .await
                    .map_err(failed)?;
            let Some(mut fixes) = self.sound(unpacked(&row)) else { continue };
            let before = fixes.len();
            fixes.retain(|fix| fix.time_ms >= limit_ms);
            let Some(first) = fixes.first() else { continue };
            let columns = chunk::pack(&fixes, Effort::Small).map_err(|said| self.corrupt(said))?;
            sqlx::query("UPDATE track_chunk SET from_ms = ?2, count = ?3, columns = ?4 WHERE id = ?1")
                .bind(id)
                .bind(first.time_ms)
                .bind((fixes.len() as u64).cast_signed())
                .bind(columns)
                .execute(self.writer())
                .await
                .map_err(failed)?;
            gone += ((before - fixes.len()) as u64).cast_signed();
        }
        Ok(gone)
    }

    async fn forget_log(&self, log: &Log, limit: Time) -> Result<u64, StoreError> {
        let failed = |error: sqlx::Error| self.failed(&error);
        let mut gone = 0;
        loop {
            let mut transaction = self.write().await?;
            let ids: Vec<i64> = sqlx::query_scalar(log.old)
                .bind(limit.nanos())
                .bind(AT_ONCE)
                .fetch_all(&mut *transaction)
                .await
                .map_err(failed)?;
            // Numbers of rows of our own, no text from outside.
            let list = ids.iter().map(i64::to_string).collect::<Vec<_>>().join(",");
            for (table, column) in [(log.subjects, log.column), (log.column, "id")] {
                let statement = format!("DELETE FROM {table} WHERE {column} IN ({list})");
                sqlx::raw_sql(AssertSqlSafe(statement)).execute(&mut *transaction).await.map_err(failed)?;
            }
            transaction.commit().await?;
            gone += ids.len() as u64;
            if (ids.len() as u64) < u64::from(AT_ONCE) {
                return Ok(gone);
            }
        }
    }

    /// Free pages go back to the disk, once they are a quarter of the file: below that they are soon used again.
    async fn give_back(&self) -> Result<u64, StoreError> {
        let failed = |error: sqlx::Error| self.failed(&error);
        let mut connection = self.writer().acquire().await.map_err(failed)?;
        let size: i64 =
            sqlx::query_scalar("PRAGMA page_size").fetch_one(&mut *connection).await.map_err(failed)?;
        let free = "PRAGMA freelist_count";
        let at_first: i64 = sqlx::query_scalar(free).fetch_one(&mut *connection).await.map_err(failed)?;
        let pages: i64 =
            sqlx::query_scalar("PRAGMA page_count").fetch_one(&mut *connection).await.map_err(failed)?;
        let mut left = at_first;
        drop(connection);
        if at_first < pages / 4 {
            return Ok(0);
        }
        while left > 0 {
            // Acquired anew for each step: others may write between.
            let mut connection = self.writer().acquire().await.map_err(failed)?;
            sqlx::raw_sql(AssertSqlSafe(format!("PRAGMA incremental_vacuum({PAGES})")))
                .execute(&mut *connection)
                .await
                .map_err(failed)?;
            let now: i64 = sqlx::query_scalar(free).fetch_one(&mut *connection).await.map_err(failed)?;
            if now >= left {
                break;
            }
            left = now;
        }
        let mut connection = self.writer().acquire().await.map_err(failed)?;
        let row = sqlx::query("PRAGMA wal_checkpoint(PASSIVE)")
            .fetch_one(&mut *connection)
            .await
            .map_err(failed)?;
        let (log, moved): (i64, i64) = (row.try_get(1).map_err(failed)?, row.try_get(2).map_err(failed)?);
        tracing::debug!(log, moved, "checkpoint of the store");
        Ok(((at_first - left) * size).cast_unsigned())
    }
}

/// A table with its subjects beside it.
struct Log {
    /// The rows that are too old, ?2 of them at most.
    old: &'static str,
    subjects: &'static str,
    /// The table, which is also the column of `subjects` that points to it.
    column: &'static str,
}

const EVENTS: Log = Log {
    old: "SELECT id FROM event WHERE time_ns < ?1 ORDER BY time_ns LIMIT ?2",
    subjects: "event_subject",
    column: "event",
};

const ALARMS: Log = Log {
    old: "SELECT id FROM alarm WHERE cleared_ns < ?1 ORDER BY cleared_ns LIMIT ?2",
    subjects: "alarm_subject",
    column: "alarm",
};
