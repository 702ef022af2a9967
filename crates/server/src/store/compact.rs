//! Packing: rows of recent fixes become small chunks, small chunks become whole ones.
//!
//! First everything recent of a tag goes into one chunk (some dozen fixes, where this is done every minute); when the small chunks of a tag have
//! [`WHOLE`] fixes together, or are [`PARTS`], they become whole chunks. So the table of recent fixes stays short enough to be searched, and
//! each fix is packed twice in its life. Chunks of one tag never overlap in time: where a late fix falls into a chunk, that one is packed anew.

use crate::store::chunk::{self, Effort};
use crate::store::packed::{PackedFix, milliseconds};
use crate::store::track::{recent_fix, unpacked};
use crate::store::{Store, StoreError};
use adit_core::time::Time;
use futures_util::TryStreamExt as _;
use sqlx::{Row as _, SqliteConnection};
use std::collections::{BTreeMap, HashMap};
use std::time::Duration;

/// Fixes that make a chunk whole: twice as many are packed no better.
const WHOLE: u32 = 1024;
/// From so many on a chunk is left as it is.
const ENOUGH: usize = 512;
/// So many small chunks of one tag become one, however few fixes they have.
const PARTS: i64 = 64;
/// Nothing is packed before its oldest fix is so old, ms.
const SETTLED_MS: i64 = 30_000;
/// Recent fixes looked at together.
const AT_ONCE: i64 = 400_000;
/// About so many of them are packed in one transaction: those of some tags.
const SLICE: i64 = 20_000;
/// Between two transactions, so that live positions are not held up.
const BREATH: Duration = Duration::from_millis(100);
/// Tags whose small chunks are joined in one transaction.
const TAGS_AT_ONCE: u32 = 64;

/// What packing did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Compacted {
    /// Recent fixes packed.
    pub fixes: u64,
    /// Small chunks joined.
    pub joined: u64,
    /// Chunks written.
    pub chunks: u64,
}

/// A chunk to write.
struct NewChunk {
    tag: i64,
    person: i64,
    from_ms: i64,
    until_ms: i64,
    count: i64,
    whole: bool,
    columns: Vec<u8>,
}

impl Store {
    /// Packs what is there to pack; `now` is the time of the newest input. To be called every minute or so; each step holds the writer for
    /// less than a second. What is read is the same before, between and after.
    pub async fn compact(&self, now: Time) -> Result<Compacted, StoreError> {
        let _turn = self.maintenance().await;
        let mut done = Compacted::default();
        let oldest: Option<i64> = sqlx::query_scalar("SELECT min(time_ms) FROM fix_recent")
            .fetch_one(self.readers())
            .await
            .map_err(|error| self.failed(&error))?;
        if oldest.is_some_and(|oldest| oldest <= milliseconds(now).saturating_sub(SETTLED_MS)) {
            while self.pack_recent(&mut done).await? {}
        }
        while self.join_parts(&mut done).await? {
            tokio::time::sleep(BREATH).await;
        }
        Ok(done)
    }

    /// The oldest recent fixes into chunks, some tags after others; whether there are more.
    async fn pack_recent(&self, done: &mut Compacted) -> Result<bool, StoreError> {
        let (count, last): (i64, Option<i64>) = sqlx::query_as(
            "SELECT count(*), max(seq) FROM (SELECT seq FROM fix_recent ORDER BY seq LIMIT ?1)",
        )
        .bind(AT_ONCE)
        .fetch_one(self.readers())
        .await
        .map_err(|error| self.failed(&error))?;
        let Some(last) = last else { return Ok(false) };
        let slices = (count / SLICE).max(1);
        for slice in 0..slices {
            if slice > 0 {
                tokio::time::sleep(BREATH).await;
            }
            self.pack_slice((slice, slices), last, done).await?;
        }
        Ok(count == AT_ONCE)
    }

    /// The fixes up to row `last` of the tags of a slice into chunks.
    async fn pack_slice(
        &self,
        (slice, slices): (i64, i64),
        last: i64,
        done: &mut Compacted,
    ) -> Result<(), StoreError> {
        let failed = |error: sqlx::Error| self.failed(&error);
        let mut fixes: BTreeMap<i64, Vec<PackedFix>> = BTreeMap::new();
        let mut count = 0_u64;
        {
            let mut rows =
                sqlx::query("SELECT * FROM fix_recent WHERE seq <= ?1 AND tag % ?2 = ?3 ORDER BY seq")
                    .bind(last)
                    .bind(slices)
                    .bind(slice)
                    .fetch(self.readers());
            while let Some(row) = rows.try_next().await.map_err(failed)? {
                let fix = recent_fix(&row).map_err(failed)?;
                fixes.entry(fix.tag).or_default().push(fix);
                count += 1;
            }
        }
        if count == 0 {
            return Ok(());
        }
        let newest: HashMap<i64, i64> = sqlx::query_as(
            "SELECT tag, (SELECT until_ms FROM track_chunk WHERE tag = t.tag ORDER BY from_ms DESC, until_ms DESC LIMIT 1) AS until
             FROM track_tag t WHERE tag % ?1 = ?2 AND until IS NOT NULL",
        )
        .bind(slices)
        .bind(slice)
        .fetch_all(self.readers())
        .await
        .map_err(failed)?
        .into_iter()
        .collect();
        let mut replaced = Vec::new();
        for (tag, fixes) in &mut fixes {
            fixes.sort_by_key(|fix| fix.time_ms);
            let first_ms = fixes.first().map_or(i64::MAX, |fix| fix.time_ms);
            if newest.get(tag).is_some_and(|newest| *newest > first_ms) {
                self.take_overlapping(*tag, first_ms, fixes, &mut replaced).await?;
            }
        }
        let tags: Vec<i64> = fixes.keys().filter(|tag| !newest.contains_key(tag)).copied().collect();
        let chunks = self.packed_off_thread(fixes.into_values().collect(), false).await?;
        let mut transaction = self.write().await?;
        for tag in tags {
            sqlx::query("INSERT OR IGNORE INTO track_tag (tag) VALUES (?1)")
                .bind(tag)
                .execute(&mut *transaction)
                .await
                .map_err(failed)?;
        }
        replace(&replaced, &chunks, &mut transaction).await.map_err(failed)?;
        sqlx::query("DELETE FROM fix_recent WHERE seq <= ?1 AND tag % ?2 = ?3")
            .bind(last)
            .bind(slices)
            .bind(slice)
            .execute(&mut *transaction)
            .await
            .map_err(failed)?;
        transaction.commit().await?;
        done.fixes += count;
        done.chunks += chunks.len() as u64;
        Ok(())
    }

    /// Late fixes: the chunks that they fall into are taken with them.
    async fn take_overlapping(
        &self,
        tag: i64,
        first_ms: i64,
        fixes: &mut Vec<PackedFix>,
        replaced: &mut Vec<i64>,
    ) -> Result<(), StoreError> {
        let last_ms = fixes.last().map_or(first_ms, |fix| fix.time_ms);
        let rows = sqlx::query(
            "SELECT id, tag, person, from_ms, count, columns FROM track_chunk WHERE tag = ?1 AND until_ms > ?2 AND from_ms < ?3
               AND from_ms >= coalesce((SELECT max(from_ms) FROM track_chunk WHERE tag = ?1 AND from_ms <= ?2), ?2) ORDER BY from_ms, until_ms",
        )
        .bind(tag)
        .bind(first_ms)
        .bind(last_ms.max(first_ms.saturating_add(1)))
        .fetch_all(self.readers())
        .await
        .map_err(|error| self.failed(&error))?;
        let late = std::mem::take(fixes);
        for row in &rows {
            // What is damaged stays, for whoever mends it, and holds up nothing.
            let Some(chunk) = self.sound(unpacked(row)) else { continue };
            fixes.extend(chunk);
            replaced.push(row.try_get("id").map_err(|error| self.failed(&error))?);
        }
        fixes.extend(late);
        fixes.sort_by_key(|fix| fix.time_ms);
        Ok(())
    }

    /// Small chunks of some tags into whole ones; whether there are more.
    async fn join_parts(&self, done: &mut Compacted) -> Result<bool, StoreError> {
        let failed = |error: sqlx::Error| self.failed(&error);
        let tags: Vec<i64> = sqlx::query_scalar(
            "SELECT tag FROM track_chunk WHERE whole = 0 GROUP BY tag HAVING sum(count) >= ?1 OR count(*) >= ?2 LIMIT ?3",
        )
        .bind(WHOLE)
        .bind(PARTS)
        .bind(TAGS_AT_ONCE)
        .fetch_all(self.readers())
        .await
        .map_err(failed)?;
        let (mut runs, mut replaced, mut damaged) = (Vec::new(), Vec::new(), Vec::new());
        for &tag in &tags {
            let rows: Vec<(i64, bool)> = sqlx::query_as(
                "SELECT id, whole FROM track_chunk WHERE tag = ?1 AND from_ms >=
                   (SELECT min(from_ms) FROM track_chunk WHERE tag = ?1 AND whole = 0) ORDER BY from_ms, until_ms",
            )
            .bind(tag)
            .fetch_all(self.readers())
            .await
            .map_err(failed)?;
            // Only small chunks with no whole one between them may become one.
            for run in rows.split(|(_, whole)| *whole).filter(|run| !run.is_empty()) {
                let mut fixes = Vec::new();
                for (id, _) in run {
                    let row = sqlx::query(
                        "SELECT id, tag, person, from_ms, count, columns FROM track_chunk WHERE id = ?1",
                    )
                    .bind(id)
                    .fetch_one(self.readers())
                    .await
                    .map_err(failed)?;
                    if let Some(chunk) = self.sound(unpacked(&row)) {
                        fixes.extend(chunk);
                        replaced.push(*id);
                    } else {
                        damaged.push(*id);
                        runs.push(std::mem::take(&mut fixes));
                    }
                }
                runs.push(fixes);
            }
        }
        let chunks = self.packed_off_thread(runs, true).await?;
        if !tags.is_empty() {
            let mut transaction = self.write().await?;
            for id in damaged {
                sqlx::query("UPDATE track_chunk SET whole = 1 WHERE id = ?1")
                    .bind(id)
                    .execute(&mut *transaction)
                    .await
                    .map_err(failed)?;
            }
            replace(&replaced, &chunks, &mut transaction).await.map_err(failed)?;
            transaction.commit().await?;
        }
        done.joined += replaced.len() as u64;
        done.chunks += chunks.len() as u64;
        Ok(tags.len() == TAGS_AT_ONCE as usize)
    }

    async fn packed_off_thread(
        &self,
        runs: Vec<Vec<PackedFix>>,
        whole: bool,
    ) -> Result<Vec<NewChunk>, StoreError> {
        let packed = tokio::task::spawn_blocking(move || {
            let mut chunks = Vec::with_capacity(runs.len());
            for fixes in &runs {
                pack(fixes, whole, &mut chunks)?;
            }
            Ok::<_, String>(chunks)
        });
        match packed.await {
            Ok(Ok(chunks)) => Ok(chunks),
            Ok(Err(said)) => Err(self.corrupt(said)),
            Err(error) => {
                Err(StoreError::Database { path: self.path().to_path_buf(), said: error.to_string() })
            }
        }
    }
}

/// Fixes of one tag in order of time, into chunks: a new one where the person changes, where it would get too long, and evenly where there are
/// twice as many as make one whole.
fn pack(fixes: &[PackedFix], whole: bool, chunks: &mut Vec<NewChunk>) -> Result<(), String> {
    let mut left = fixes;
    while let Some(first) = left.first() {
        let same =
            |fix: &PackedFix| fix.person == first.person && fix.time_ms - first.time_ms <= chunk::LONGEST_MS;
        let (run, rest) = left.split_at(left.iter().position(|fix| !same(fix)).unwrap_or(left.len()));
        left = rest;
        let pieces = (run.len() / WHOLE as usize).max(1);
        for piece in run.chunks(run.len().div_ceil(pieces)) {
            let (Some(from), Some(until)) = (piece.first(), piece.last()) else { continue };
            let whole = whole || piece.len() >= ENOUGH;
            let effort = if whole { Effort::Small } else { Effort::Quick };
            chunks.push(NewChunk {
                tag: from.tag,
                person: from.person,
                from_ms: from.time_ms,
                until_ms: until.time_ms,
                count: (piece.len() as u64).cast_signed(),
                whole,
                columns: chunk::pack(piece, effort)?,
            });
        }
    }
    Ok(())
}

async fn replace(
    replaced: &[i64],
    chunks: &[NewChunk],
    connection: &mut SqliteConnection,
) -> Result<(), sqlx::Error> {
    for id in replaced {
        sqlx::query("DELETE FROM track_chunk WHERE id = ?1").bind(id).execute(&mut *connection).await?;
    }
    for chunk in chunks {
        sqlx::query("INSERT INTO track_chunk (tag, person, from_ms, until_ms, count, whole, columns) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)")
            .bind(chunk.tag)
            .bind(chunk.person)
            .bind(chunk.from_ms)
            .bind(chunk.until_ms)
            .bind(chunk.count)
            .bind(chunk.whole)
            .bind(chunk.columns.as_slice())
            .execute(&mut *connection)
            .await?;
    }
    Ok(())
}
