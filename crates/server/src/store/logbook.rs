//! Reading events and alarms: by time, kind and whom they are about, page by page.

use crate::store::record::{AlarmRecord, EventRecord};
use crate::store::{Store, StoreError};
use adit_core::time::Time;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sqlx::sqlite::SqliteRow;
use sqlx::{QueryBuilder, Row as _, Sqlite};
use std::fmt;
use std::str::FromStr;

/// Most rows of one page.
const MOST: u32 = 10_000;

/// Where a page ended: time (ns) and number of its last row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Cursor {
    time_ns: i64,
    id: i64,
}

impl fmt::Display for Cursor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}", self.time_ns, self.id)
    }
}

impl From<Cursor> for String {
    fn from(cursor: Cursor) -> Self {
        cursor.to_string()
    }
}

impl TryFrom<String> for Cursor {
    type Error = StoreError;
    fn try_from(text: String) -> Result<Self, StoreError> {
        text.parse()
    }
}

impl FromStr for Cursor {
    type Err = StoreError;
    fn from_str(text: &str) -> Result<Self, StoreError> {
        let parsed = text
            .split_once('.')
            .and_then(|(time, id)| Some(Self { time_ns: time.parse().ok()?, id: id.parse().ok()? }));
        parsed.ok_or_else(|| StoreError::Unusable {
            what: "cursor",
            found: text.to_owned(),
            expected: "one that a page gave".to_owned(),
        })
    }
}

/// Which events or alarms; everything that is left open does not matter.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct LogQuery {
    /// From this time on (of an alarm: when it was raised).
    pub from: Option<Time>,
    /// Before this time.
    pub until: Option<Time>,
    /// Of one of these kinds; empty: of any.
    pub kinds: Vec<String>,
    /// About this person, tag, zone or device.
    pub subject: Option<String>,
    /// Alarms only: in one of these states; empty: in any.
    pub states: Vec<String>,
    /// Alarms only: not cleared.
    pub open: bool,
    /// Newest first; else oldest first.
    pub newest_first: bool,
    /// After the page that ended here.
    pub after: Option<Cursor>,
    /// At most so many, 1 to 10,000; 0: 10,000.
    pub limit: u32,
}

/// Rows and where to go on.
#[derive(Debug, Clone, PartialEq)]
pub struct LogPage<T> {
    /// The rows.
    pub rows: Vec<T>,
    /// [`LogQuery::after`] of the next page; `None` at the end.
    pub next: Option<Cursor>,
}

impl Store {
    /// Events in order of time.
    pub async fn events(&self, query: &LogQuery) -> Result<LogPage<EventRecord>, StoreError> {
        let mut sql = QueryBuilder::new(
            "SELECT e.id, e.time_ns AS at_ns, (SELECT name FROM name WHERE id = e.kind) AS kind, e.body,
               (SELECT json_group_array(n.name ORDER BY s.place) FROM event_subject s JOIN name n ON n.id = s.subject WHERE s.event = e.id) AS subjects FROM event e",
        );
        if let Some(subject) = &query.subject {
            sql.push(
                " JOIN event_subject w ON w.event = e.id AND w.subject = (SELECT id FROM name WHERE name = ",
            );
            sql.push_bind(subject.clone()).push(")");
        }
        // The time of the subject's own table, so that its key gives the order.
        let time = if query.subject.is_some() { "w.time_ns" } else { "e.time_ns" };
        let id = if query.subject.is_some() { "w.event" } else { "e.id" };
        conditions(&mut sql, query, time, id);
        order(&mut sql, query, time, id);
        self.page(sql, query, event).await
    }

    /// Alarms in order of being raised.
    pub async fn alarms(&self, query: &LogQuery) -> Result<LogPage<AlarmRecord>, StoreError> {
        let mut sql = QueryBuilder::new(
            "SELECT a.id, a.alarm, a.raised_ns AS at_ns, a.changed_ns, a.cleared_ns, (SELECT name FROM name WHERE id = a.kind) AS kind,
               (SELECT name FROM name WHERE id = a.state) AS state, a.body,
               (SELECT json_group_array(n.name ORDER BY s.place) FROM alarm_subject s JOIN name n ON n.id = s.subject WHERE s.alarm = a.id) AS subjects FROM alarm a",
        );
        if let Some(subject) = &query.subject {
            sql.push(
                " JOIN alarm_subject w ON w.alarm = a.id AND w.subject = (SELECT id FROM name WHERE name = ",
            );
            sql.push_bind(subject.clone()).push(")");
        }
        conditions(&mut sql, query, "a.raised_ns", "a.id");
        names(&mut sql, "a.state", &query.states);
        if query.open {
            sql.push(" AND a.cleared_ns IS NULL");
        }
        order(&mut sql, query, "a.raised_ns", "a.id");
        self.page(sql, query, alarm).await
    }

    /// One alarm by its id.
    pub async fn alarm(&self, id: &str) -> Result<Option<AlarmRecord>, StoreError> {
        let failed = |error: sqlx::Error| self.failed(&error);
        let row = sqlx::query(
            "SELECT a.id, a.alarm, a.raised_ns AS at_ns, a.changed_ns, a.cleared_ns, (SELECT name FROM name WHERE id = a.kind) AS kind,
               (SELECT name FROM name WHERE id = a.state) AS state, a.body,
               (SELECT json_group_array(n.name ORDER BY s.place) FROM alarm_subject s JOIN name n ON n.id = s.subject WHERE s.alarm = a.id) AS subjects
             FROM alarm a WHERE a.alarm = ?1",
        )
        .bind(id)
        .fetch_optional(self.readers())
        .await
        .map_err(failed)?;
        row.map(|row| alarm(&row).map_err(failed)).transpose()
    }

    async fn page<T>(
        &self,
        mut sql: QueryBuilder<Sqlite>,
        query: &LogQuery,
        read: impl Fn(&SqliteRow) -> Result<T, sqlx::Error>,
    ) -> Result<LogPage<T>, StoreError> {
        let failed = |error: sqlx::Error| self.failed(&error);
        let limit = if query.limit == 0 { MOST } else { query.limit.min(MOST) };
        sql.push(" LIMIT ").push_bind(limit + 1);
        let mut found = sql.build().fetch_all(self.readers()).await.map_err(failed)?;
        let more = found.len() > limit as usize;
        found.truncate(limit as usize);
        let cursor = |row: &SqliteRow| Ok(Cursor { time_ns: row.try_get("at_ns")?, id: row.try_get("id")? });
        let next = if more { found.last().map(cursor).transpose().map_err(failed)? } else { None };
        Ok(LogPage { rows: found.iter().map(read).collect::<Result<_, _>>().map_err(failed)?, next })
    }
}

/// What events and alarms are chosen by.
fn conditions(sql: &mut QueryBuilder<Sqlite>, query: &LogQuery, time: &str, id: &str) {
    sql.push(" WHERE true");
    if let Some(from) = query.from {
        sql.push(format!(" AND {time} >= ")).push_bind(from.nanos());
    }
    if let Some(until) = query.until {
        sql.push(format!(" AND {time} < ")).push_bind(until.nanos());
    }
    names(sql, "kind", &query.kinds);
    if let Some(after) = query.after {
        let beyond = if query.newest_first { "<" } else { ">" };
        sql.push(format!(" AND ({time}, {id}) {beyond} ("));
        sql.push_bind(after.time_ns).push(", ").push_bind(after.id).push(")");
    }
}

/// One of these names, if there are any.
fn names(sql: &mut QueryBuilder<Sqlite>, column: &str, names: &[String]) {
    if names.is_empty() {
        return;
    }
    sql.push(format!(" AND {column} IN (SELECT id FROM name WHERE name IN ("));
    let mut list = sql.separated(", ");
    for name in names {
        list.push_bind(name.clone());
    }
    sql.push("))");
}

fn order(sql: &mut QueryBuilder<Sqlite>, query: &LogQuery, time: &str, id: &str) {
    let order = if query.newest_first { "DESC" } else { "ASC" };
    sql.push(format!(" ORDER BY {time} {order}, {id} {order}"));
}

fn event(row: &SqliteRow) -> Result<EventRecord, sqlx::Error> {
    Ok(EventRecord {
        time: Time::from_nanos(row.try_get("at_ns")?),
        kind: row.try_get("kind")?,
        subjects: json(row, "subjects")?,
        body: json::<Value>(row, "body")?,
    })
}

fn alarm(row: &SqliteRow) -> Result<AlarmRecord, sqlx::Error> {
    let cleared: Option<i64> = row.try_get("cleared_ns")?;
    Ok(AlarmRecord {
        id: row.try_get("alarm")?,
        kind: row.try_get("kind")?,
        state: row.try_get("state")?,
        raised: Time::from_nanos(row.try_get("at_ns")?),
        changed: Time::from_nanos(row.try_get("changed_ns")?),
        cleared: cleared.map(Time::from_nanos),
        subjects: json(row, "subjects")?,
        body: json::<Value>(row, "body")?,
    })
}

fn json<T: serde::de::DeserializeOwned>(row: &SqliteRow, column: &str) -> Result<T, sqlx::Error> {
    let text: &str = row.try_get(column)?;
    serde_json::from_str(text).map_err(|error| sqlx::Error::Decode(error.into()))
}
