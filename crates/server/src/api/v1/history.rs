//! What was: tracks, events, alarms, attendance, the audit log.

use crate::api::extract::{Path, Query};
use crate::api::view::{AlarmJson, EventJson, who, word};
use crate::api::{ApiError, Context, Timestamp};
use crate::store::{AuditQuery, Cursor, LogQuery, TrackOf, TrackQuery};
use adit_core::time::Time;
use adit_tracking::view::Whereabouts;
use adit_tracking::{Alarm, Event};
use axum::extract::State;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::sync::Arc;
use utoipa::{IntoParams, ToSchema};

/// Fixes in an answer unless asked otherwise.
const POINTS: u32 = 2000;
/// Rows in an answer unless asked otherwise.
const ROWS: u32 = 500;

/// Which part of a track.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct TrackPart {
    /// From this time on.
    from: Timestamp,
    /// Before this time.
    until: Timestamp,
    /// At most so many fixes that keep the shape of the track (Douglas–Peucker); 2000 where it is not given.
    #[param(minimum = 2, maximum = 20000)]
    points: Option<u32>,
}

/// A track for a map.
#[derive(Serialize, ToSchema)]
pub(super) struct Track {
    /// In order of time; the first and the last are among them.
    fixes: Vec<TrackFix>,
    /// How many there are in all.
    of: u64,
    /// No fix left out is farther than this from the line drawn, m.
    error_m: f64,
}

/// A fix of a track.
#[derive(Serialize, ToSchema)]
pub(super) struct TrackFix {
    time: Timestamp,
    tag: String,
    person: Option<String>,
    position_m: [f64; 3],
    radius_95_m: f64,
    quality: String,
    level: Option<String>,
    zone: Option<String>,
}

/// The track of a person, by whichever tags.
#[utoipa::path(get, path = "/api/v1/people/{id}/track", tag = "history", params(("id" = String, Path), TrackPart),
    responses((status = 200, description = "the track; empty when nothing is known", body = Track)))]
pub(super) async fn track_of_person(
    State(context): State<Arc<Context>>,
    Path(id): Path<String>,
    Query(part): Query<TrackPart>,
) -> Result<axum::Json<Track>, ApiError> {
    track(&context, TrackOf::Person(id), &part).await
}

/// The track of a tag, whoever wore it.
#[utoipa::path(get, path = "/api/v1/tags/{id}/track", tag = "history", params(("id" = String, Path), TrackPart),
    responses((status = 200, description = "the track; empty when nothing is known", body = Track)))]
pub(super) async fn track_of_tag(
    State(context): State<Arc<Context>>,
    Path(id): Path<String>,
    Query(part): Query<TrackPart>,
) -> Result<axum::Json<Track>, ApiError> {
    track(&context, TrackOf::Tag(id), &part).await
}

async fn track(context: &Context, of: TrackOf, part: &TrackPart) -> Result<axum::Json<Track>, ApiError> {
    let points = part.points.unwrap_or(POINTS);
    if !(2..=20_000).contains(&points) {
        return Err(ApiError::invalid(format!("points: expected 2 to 20000, found {points}")));
    }
    in_order(Some(part.from), Some(part.until))?;
    let query = TrackQuery { of, from: part.from.0, until: part.until.0 };
    let drawn =
        context.store.track_drawn(&query, points as usize).await.map_err(|e| ApiError::of_store(&e))?;
    let fixes = drawn.fixes.into_iter().map(|fix| TrackFix {
        time: fix.time.into(),
        tag: fix.tag,
        person: fix.person,
        position_m: fix.position_m,
        radius_95_m: fix.radius_95_m,
        quality: word(&fix.quality),
        level: fix.level,
        zone: fix.zone,
    });
    Ok(axum::Json(Track { fixes: fixes.collect(), of: drawn.of, error_m: drawn.error_m }))
}

pub(super) fn in_order(from: Option<Timestamp>, until: Option<Timestamp>) -> Result<(), ApiError> {
    match (from, until) {
        (Some(from), Some(until)) if until < from => {
            Err(ApiError::invalid(format!("until: expected a time after {from}, found {until}")))
        }
        _ => Ok(()),
    }
}

/// Which rows of a log.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct LogPart {
    /// From this time on.
    from: Option<Timestamp>,
    /// Before this time.
    until: Option<Timestamp>,
    /// Of this kind.
    kind: Option<String>,
    /// About the person, tag, zone or device of this id.
    about: Option<String>,
    /// `next` of the page before.
    after: Option<String>,
    /// At most so many rows; 500 where it is not given.
    #[param(minimum = 1, maximum = 10000)]
    limit: Option<u32>,
}

impl LogPart {
    fn query(self) -> Result<LogQuery, ApiError> {
        in_order(self.from, self.until)?;
        let after: Option<Cursor> = self
            .after
            .map(|after| after.parse())
            .transpose()
            .map_err(|error: crate::store::StoreError| ApiError::malformed(error.to_string()))?;
        Ok(LogQuery {
            from: self.from.map(|time| time.0),
            until: self.until.map(|time| time.0),
            kinds: self.kind.into_iter().collect(),
            subject: self.about,
            newest_first: true,
            after,
            limit: limit(self.limit)?,
            ..LogQuery::default()
        })
    }
}

fn limit(asked: Option<u32>) -> Result<u32, ApiError> {
    match asked.unwrap_or(ROWS) {
        limit @ 1..=10_000 => Ok(limit),
        other => Err(ApiError::invalid(format!("limit: expected 1 to 10000, found {other}"))),
    }
}

/// Events, newest first.
#[derive(Serialize, ToSchema)]
pub(super) struct EventPage {
    rows: Vec<EventJson>,
    /// `after` for the next page; null at the end.
    next: Option<String>,
}

/// Alarms, the last raised first.
#[derive(Serialize, ToSchema)]
pub(super) struct AlarmPage {
    rows: Vec<AlarmJson>,
    /// `after` for the next page; null at the end.
    next: Option<String>,
}

/// What was stored, as it was; of another version of adit it may be unreadable, which is told in the log.
fn read<T: DeserializeOwned>(body: Value) -> Option<T> {
    serde_json::from_value(body)
        .inspect_err(|error| tracing::warn!("history: a row cannot be read: {error}"))
        .ok()
}

/// What happened, newest first.
#[utoipa::path(get, path = "/api/v1/history/events", tag = "history", params(LogPart),
    responses((status = 200, description = "a page", body = EventPage)))]
pub(super) async fn events(
    State(context): State<Arc<Context>>,
    Query(part): Query<LogPart>,
) -> Result<axum::Json<EventPage>, ApiError> {
    let page = context.store.events(&part.query()?).await.map_err(|error| ApiError::of_store(&error))?;
    let events = page.rows.into_iter().filter_map(|row| read::<Event>(row.body));
    let rows = events.map(|event| EventJson::from(&event)).collect();
    Ok(axum::Json(EventPage { rows, next: page.next.map(|cursor| cursor.to_string()) }))
}

/// Alarms of the past and open ones, the last raised first.
#[utoipa::path(get, path = "/api/v1/history/alarms", tag = "history", params(LogPart),
    responses((status = 200, description = "a page", body = AlarmPage)))]
pub(super) async fn alarms(
    State(context): State<Arc<Context>>,
    Query(part): Query<LogPart>,
) -> Result<axum::Json<AlarmPage>, ApiError> {
    let page = context.store.alarms(&part.query()?).await.map_err(|error| ApiError::of_store(&error))?;
    let alarms = page.rows.into_iter().filter_map(|row| read::<Alarm>(row.body));
    let rows = alarms.map(|alarm| AlarmJson::from(&alarm)).collect();
    Ok(axum::Json(AlarmPage { rows, next: page.next.map(|cursor| cursor.to_string()) }))
}

/// Which rows of the audit log.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct AuditPart {
    /// From this time on.
    from: Option<Timestamp>,
    /// Before this time.
    until: Option<Timestamp>,
    /// Of this user or token.
    who: Option<String>,
    /// Of this kind: `session.login`, say.
    what: Option<String>,
    /// After the row with this number.
    after: Option<u64>,
    /// At most so many rows; 500 where it is not given.
    #[param(minimum = 1, maximum = 10000)]
    limit: Option<u32>,
}

/// A row of the audit log.
#[derive(Serialize, ToSchema)]
#[schema(as = AuditRow)]
pub(super) struct AuditRowJson {
    number: u64,
    time: Timestamp,
    who: String,
    what: String,
    source: String,
    outcome: String,
    detail: Value,
}

/// Who did what, newest first.
#[utoipa::path(get, path = "/api/v1/audit", tag = "audit", params(AuditPart),
    responses((status = 200, description = "a page", body = Vec<AuditRowJson>)))]
pub(super) async fn audit(
    State(context): State<Arc<Context>>,
    Query(part): Query<AuditPart>,
) -> Result<axum::Json<Vec<AuditRowJson>>, ApiError> {
    in_order(part.from, part.until)?;
    if let Some(after) = part.after.filter(|after| i64::try_from(*after).is_err()) {
        return Err(ApiError::invalid(format!("after: expected the number of a row, found {after}")));
    }
    let query = AuditQuery {
        from: part.from.map(|time| time.0),
        until: part.until.map(|time| time.0),
        who: part.who,
        what: part.what,
        newest_first: true,
        after: part.after,
        limit: limit(part.limit)?,
    };
    let rows = context.store.audit_rows(&query).await.map_err(|error| ApiError::of_store(&error))?;
    let json = rows.into_iter().map(|row| AuditRowJson {
        number: row.number,
        time: row.record.time.into(),
        who: row.record.who,
        what: row.record.what,
        source: row.record.source,
        outcome: row.record.outcome,
        detail: row.record.detail,
    });
    Ok(axum::Json(json.collect()))
}

/// Which shifts.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct ShiftPart {
    /// Who came out from this time on.
    pub from: Timestamp,
    /// Who came out before this time.
    pub until: Timestamp,
}

/// A shift of somebody.
#[derive(Serialize, ToSchema)]
pub(super) struct Shift {
    pub person: Option<String>,
    pub tag: Option<String>,
    pub went_below: Timestamp,
    /// Null for who is below.
    pub came_out: Option<Timestamp>,
    pub hours: f64,
}

/// Attendance: everybody who came out in a time, and who is below now.
#[utoipa::path(get, path = "/api/v1/attendance", tag = "history", params(ShiftPart),
    responses((status = 200, description = "those below first", body = Vec<Shift>)))]
pub(super) async fn attendance(
    State(context): State<Arc<Context>>,
    Query(part): Query<ShiftPart>,
) -> Result<axum::Json<Vec<Shift>>, ApiError> {
    shifts(&context, &part).await.map(axum::Json)
}

/// Everybody who came out in a time, and who is below now.
pub(super) async fn shifts(context: &Context, part: &ShiftPart) -> Result<Vec<Shift>, ApiError> {
    in_order(Some(part.from), Some(part.until))?;
    let mut shifts: Vec<Shift> = {
        let tracking = context.tracking();
        let now = tracking.now();
        let below = tracking.below().filter_map(|view| match view.whereabouts {
            Whereabouts::Below { shift_since } => {
                let (person, tag) = who(&view.subject);
                Some(shift(person, tag, shift_since, None, now))
            }
            _ => None,
        });
        below.collect()
    };
    let mut query = LogQuery {
        from: Some(part.from.0),
        until: Some(part.until.0),
        kinds: vec!["came-out".into()],
        newest_first: true,
        ..LogQuery::default()
    };
    loop {
        let page = context.store.events(&query).await.map_err(|error| ApiError::of_store(&error))?;
        for row in page.rows {
            if let Some(Event::CameOut { subject, time, shift_since, .. }) = read(row.body) {
                let (person, tag) = who(&subject);
                shifts.push(shift(person, tag, shift_since, Some(time), time));
            }
        }
        query.after = page.next;
        if query.after.is_none() || shifts.len() > 100_000 {
            break;
        }
    }
    Ok(shifts)
}

fn shift(person: Option<String>, tag: Option<String>, since: Time, out: Option<Time>, until: Time) -> Shift {
    let hours = until.since(since).seconds() / 3600.0;
    Shift { person, tag, went_below: since.into(), came_out: out.map(Timestamp), hours }
}
