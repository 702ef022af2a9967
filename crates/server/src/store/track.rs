//! Reading tracks: packed and recent fixes as one, page by page.
//!
//! A page is read in one transaction, so that packing beside it neither hides nor doubles a fix; between pages nothing is held.

use crate::store::chunk::{self, ChunkRow};
use crate::store::decimate::Outline;
use crate::store::names::Names;
use crate::store::packed::{PackedFix, milliseconds, time_of_milliseconds};
use crate::store::record::FixRecord;
use crate::store::{Store, StoreError};
use adit_core::time::Time;
use sqlx::sqlite::SqliteRow;
use sqlx::{Row as _, SqliteConnection};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Chunks of one tag in a page.
const CHUNKS: i64 = 64;

/// Whose track.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TrackOf {
    /// That of a tag, whoever carried it.
    Tag(String),
    /// That of a person, by whichever tags.
    Person(String),
}

/// Which fixes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TrackQuery {
    /// Whose.
    pub of: TrackOf,
    /// From this time on.
    pub from: Time,
    /// Before this time.
    pub until: Time,
}

/// Fixes in order of time, and where to go on.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackPage {
    /// The fixes; a page may be empty and not the last.
    pub fixes: Vec<FixRecord>,
    /// [`TrackQuery::from`] of the next page; `None` at the end.
    pub next: Option<Time>,
}

/// A track for a map.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnTrack {
    /// The fixes that keep its shape, in order of time; the first and the last are among them.
    pub fixes: Vec<FixRecord>,
    /// How many there are in all.
    pub of: u64,
    /// No fix left out is farther than this from the line drawn (in space, m); the largest of all pages where the track was too long for one go.
    pub error_m: f64,
}

/// What a page is made of.
pub(super) struct Packed {
    pub fixes: Vec<PackedFix>,
    pub next_ms: Option<i64>,
}

/// A query in numbers of the store.
struct Numbers {
    tags: Vec<i64>,
    person: Option<i64>,
    from_ms: i64,
    until_ms: i64,
}

impl Store {
    /// The first fixes of a track, some ten thousand; go on with `from` = [`TrackPage::next`].
    pub async fn track_page(&self, query: &TrackQuery) -> Result<TrackPage, StoreError> {
        let page = self.packed_page(query).await?;
        let names = self.names_of(&page.fixes).await?;
        let fixes = page.fixes.iter().map(|fix| self.record(fix, &names)).collect::<Result<_, _>>()?;
        Ok(TrackPage { fixes, next: page.next_ms.map(time_of_milliseconds) })
    }

    /// A track in at most `points` fixes that keep its shape (Douglas & Peucker 1973, worst first), 2 or more.
    pub async fn track_drawn(&self, query: &TrackQuery, points: usize) -> Result<DrawnTrack, StoreError> {
        let mut outline = Outline::new(points.max(2));
        let mut query = query.clone();
        loop {
            let page = self.packed_page(&query).await?;
            outline.add(&page.fixes);
            let Some(next) = page.next_ms else { break };
            query.from = time_of_milliseconds(next);
        }
        let (fixes, of, error_m) = outline.finish();
        let names = self.names_of(&fixes).await?;
        Ok(DrawnTrack {
            fixes: fixes.iter().map(|fix| self.record(fix, &names)).collect::<Result<_, _>>()?,
            of,
            error_m,
        })
    }

    /// Ids of all tags that have fixes.
    pub async fn tags(&self) -> Result<Vec<String>, StoreError> {
        sqlx::query_scalar(
            "SELECT name FROM name WHERE id IN (SELECT tag FROM track_tag UNION SELECT tag FROM fix_recent) ORDER BY name",
        )
        .fetch_all(self.readers())
        .await
        .map_err(|error| self.failed(&error))
    }

    /// The last fix of every tag at or before a time, however old, by tag.
    pub async fn last_fixes(&self, at: Time) -> Result<Vec<FixRecord>, StoreError> {
        let at_ms = milliseconds(at);
        let failed = |error: sqlx::Error| self.failed(&error);
        let mut transaction = self.readers().begin().await.map_err(failed)?;
        let rows = sqlx::query(
            "SELECT c.id, c.tag, c.person, c.from_ms, c.count, c.columns FROM track_tag t JOIN track_chunk c ON c.id =
               (SELECT id FROM track_chunk WHERE tag = t.tag AND from_ms <= ?1 ORDER BY from_ms DESC, until_ms DESC LIMIT 1)",
        )
        .bind(at_ms)
        .fetch_all(&mut *transaction)
        .await
        .map_err(failed)?;
        let recent = sqlx::query(
            "SELECT max(time_ms) AS time_ms, tag, person, x_cm, y_cm, z_cm, radius_cm, quality, level, zone FROM fix_recent WHERE time_ms <= ?1 GROUP BY tag",
        )
        .bind(at_ms)
        .fetch_all(&mut *transaction)
        .await
        .map_err(failed)?;
        transaction.commit().await.map_err(failed)?;
        let store = self.clone();
        let mut last = tokio::task::spawn_blocking(move || {
            let mut last: BTreeMap<i64, PackedFix> = BTreeMap::new();
            for row in rows {
                // Where everybody was must be told even if the file is damaged.
                let Some(fixes) = store.sound(unpacked(&row)) else { continue };
                if let Some(fix) = fixes.iter().rev().find(|fix| fix.time_ms <= at_ms) {
                    last.insert(fix.tag, *fix);
                }
            }
            last
        })
        .await
        .map_err(|error| StoreError::Database { path: self.path().to_path_buf(), said: error.to_string() })?;
        for row in &recent {
            let fix = recent_fix(row).map_err(|error| self.failed(&error))?;
            let known = last.entry(fix.tag).or_insert(fix);
            if known.time_ms <= fix.time_ms {
                *known = fix;
            }
        }
        let fixes: Vec<PackedFix> = last.into_values().collect();
        let names = self.names_of(&fixes).await?;
        let mut records = fixes.iter().map(|fix| self.record(fix, &names)).collect::<Result<Vec<_>, _>>()?;
        records.sort_by(|one, other| one.tag.cmp(&other.tag));
        Ok(records)
    }

    /// One page of a track, in order of time.
    pub(super) async fn packed_page(&self, query: &TrackQuery) -> Result<Packed, StoreError> {
        let failed = |error: sqlx::Error| self.failed(&error);
        let mut transaction = self.readers().begin().await.map_err(failed)?;
        let Some(numbers) = numbers(query, &mut transaction).await.map_err(failed)? else {
            return Ok(Packed { fixes: Vec::new(), next_ms: None });
        };
        let mut limit = CHUNKS;
        let (rows, end_ms) = loop {
            let (rows, end_ms) = chunks(&numbers, limit, &mut transaction).await.map_err(failed)?;
            // More chunks in one millisecond than a page has: a larger page.
            if end_ms > numbers.from_ms || numbers.from_ms >= numbers.until_ms {
                break (rows, end_ms);
            }
            limit = limit.saturating_mul(16);
        };
        let recent = recent(&numbers, end_ms, &mut transaction).await.map_err(failed)?;
        transaction.commit().await.map_err(failed)?;
        let mut fixes = Vec::new();
        for row in &rows {
            let chunk = unpacked(row).map_err(|said| self.corrupt(said))?;
            fixes.extend(chunk.into_iter().filter(|fix| (numbers.from_ms..end_ms).contains(&fix.time_ms)));
        }
        for row in &recent {
            fixes.push(recent_fix(row).map_err(failed)?);
        }
        fixes.sort_by_key(|fix| fix.time_ms);
        Ok(Packed { fixes, next_ms: (end_ms < numbers.until_ms).then_some(end_ms) })
    }

    /// Names for these fixes; reads the table again where another process has written.
    pub(crate) async fn names_of(&self, fixes: &[PackedFix]) -> Result<Arc<Names>, StoreError> {
        let names = self.names();
        let unknown = |fix: &PackedFix| {
            [fix.tag, fix.person, fix.level, fix.zone].into_iter().any(|number| names.lacks(number))
        };
        if fixes.iter().any(unknown) {
            let all = Names::read(self.readers()).await.map_err(|error| self.failed(&error))?;
            self.learn(all);
            return Ok(self.names());
        }
        Ok(names)
    }

    pub(crate) fn record(&self, fix: &PackedFix, names: &Names) -> Result<FixRecord, StoreError> {
        fix.record(names).ok_or_else(|| StoreError::Corrupt {
            path: self.path().to_path_buf(),
            said: format!("a fix of tag number {} with quality {}", fix.tag, fix.quality),
        })
    }
}

/// `None` where nobody of that name ever had a fix.
async fn numbers(
    query: &TrackQuery,
    connection: &mut SqliteConnection,
) -> Result<Option<Numbers>, sqlx::Error> {
    let name = match &query.of {
        TrackOf::Tag(name) | TrackOf::Person(name) => name,
    };
    let number: Option<i64> = sqlx::query_scalar("SELECT id FROM name WHERE name = ?1")
        .bind(name)
        .fetch_optional(&mut *connection)
        .await?;
    let Some(number) = number else { return Ok(None) };
    let (from_ms, until_ms) = (milliseconds(query.from), milliseconds(query.until));
    let (tags, person) = match &query.of {
        TrackOf::Tag(_) => (vec![number], None),
        TrackOf::Person(_) => {
            let tags = sqlx::query_scalar(
                "SELECT DISTINCT tag FROM track_chunk WHERE person = ?1 UNION SELECT DISTINCT tag FROM fix_recent WHERE person = ?1",
            )
            .bind(number)
            .fetch_all(connection)
            .await?;
            (tags, Some(number))
        }
    };
    Ok(Some(Numbers { tags, person, from_ms, until_ms }))
}

/// The next chunks of every tag, and the time before which nothing is missing.
async fn chunks(
    numbers: &Numbers,
    limit: i64,
    connection: &mut SqliteConnection,
) -> Result<(Vec<SqliteRow>, i64), sqlx::Error> {
    let mut all = Vec::new();
    let mut end_ms = numbers.until_ms;
    for &tag in &numbers.tags {
        // Chunks of a tag do not overlap: only the last that begins earlier can reach into the span.
        let statement = match numbers.person {
            None => {
                "SELECT id, tag, person, from_ms, count, columns FROM track_chunk WHERE tag = ?1 AND from_ms < ?3 AND from_ms >=
                   coalesce((SELECT max(from_ms) FROM track_chunk WHERE tag = ?1 AND from_ms < ?2), ?2)
                 ORDER BY from_ms, id LIMIT ?4"
            }
            Some(_) => {
                "SELECT id, tag, person, from_ms, count, columns FROM track_chunk WHERE person = ?5 AND tag = ?1 AND from_ms < ?3 AND from_ms >=
                   coalesce((SELECT max(from_ms) FROM track_chunk WHERE person = ?5 AND tag = ?1 AND from_ms < ?2), ?2)
                 ORDER BY from_ms, id LIMIT ?4"
            }
        };
        let mut query =
            sqlx::query(statement).bind(tag).bind(numbers.from_ms).bind(numbers.until_ms).bind(limit + 1);
        if let Some(person) = numbers.person {
            query = query.bind(person);
        }
        let mut rows = query.fetch_all(&mut *connection).await?;
        if (rows.len() as u64).cast_signed() > limit
            && let Some(beyond) = rows.pop()
        {
            end_ms = end_ms.min(beyond.try_get("from_ms")?);
        }
        all.extend(rows);
    }
    Ok((all, end_ms))
}

async fn recent(
    numbers: &Numbers,
    end_ms: i64,
    connection: &mut SqliteConnection,
) -> Result<Vec<SqliteRow>, sqlx::Error> {
    let statement = match numbers.person {
        None => {
            "SELECT * FROM fix_recent WHERE time_ms >= ?2 AND time_ms < ?3 AND tag = ?1 ORDER BY time_ms, seq"
        }
        Some(_) => {
            "SELECT * FROM fix_recent WHERE time_ms >= ?2 AND time_ms < ?3 AND person = ?1 ORDER BY time_ms, seq"
        }
    };
    sqlx::query(statement)
        .bind(numbers.person.or_else(|| numbers.tags.first().copied()))
        .bind(numbers.from_ms)
        .bind(end_ms)
        .fetch_all(connection)
        .await
}

/// A row of `fix_recent`.
pub(crate) fn recent_fix(row: &SqliteRow) -> Result<PackedFix, sqlx::Error> {
    Ok(PackedFix {
        time_ms: row.try_get("time_ms")?,
        tag: row.try_get("tag")?,
        person: row.try_get("person")?,
        position_cm: [row.try_get("x_cm")?, row.try_get("y_cm")?, row.try_get("z_cm")?],
        radius_cm: row.try_get("radius_cm")?,
        quality: row.try_get("quality")?,
        level: row.try_get("level")?,
        zone: row.try_get("zone")?,
    })
}

/// The fixes of a row of `track_chunk`; says what is wrong with it.
pub(crate) fn unpacked(row: &SqliteRow) -> Result<Vec<PackedFix>, String> {
    let told = |error: sqlx::Error| error.to_string();
    let chunk = ChunkRow {
        id: row.try_get("id").map_err(told)?,
        tag: row.try_get("tag").map_err(told)?,
        person: row.try_get("person").map_err(told)?,
        from_ms: row.try_get("from_ms").map_err(told)?,
    };
    let count: i64 = row.try_get("count").map_err(told)?;
    let count = usize::try_from(count)
        .ok()
        .filter(|count| *count <= chunk::MOST)
        .ok_or_else(|| format!("track_chunk {}: {count} fixes", chunk.id))?;
    chunk::unpack(&chunk, count, row.try_get("columns").map_err(told)?)
}
