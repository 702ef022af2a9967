//! Tracks, events and alarms as files, streamed: no more than a page of the store is held.

use super::history::{ShiftPart, shifts};
use crate::api::extract::{Caller, Query};
use crate::api::{ApiError, Context, Timestamp};
use crate::auth::Principal;
use crate::export::{Export, Exported, Format, TracksQuery};
use crate::store::{LogQuery, TrackOf};
use axum::body::{Body, Bytes};
use axum::extract::State;
use axum::http::header;
use axum::response::{IntoResponse as _, Response};
use futures_util::stream;
use serde::Deserialize;
use serde_json::json;
use std::sync::Arc;
use utoipa::IntoParams;

/// What to export.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct Wanted {
    /// `csv`, `geojson` or `parquet`.
    #[param(pattern = "^(csv|geojson|parquet)$")]
    format: String,
    /// From this time on.
    from: Timestamp,
    /// Before this time.
    until: Timestamp,
    /// About the person (of tracks: theirs), tag, zone or device of this id; everything where it is not given.
    about: Option<String>,
    /// Of tracks: `about` is a tag, not a person.
    tag: Option<bool>,
}

impl Wanted {
    fn format(&self) -> Result<Format, ApiError> {
        if self.until < self.from {
            return Err(ApiError::invalid(format!(
                "until: expected a time after {}, found {}",
                self.from, self.until
            )));
        }
        let unknown = || {
            ApiError::invalid(format!("format: expected csv, geojson or parquet, found {:?}", self.format))
        };
        Format::named(&self.format).ok_or_else(unknown)
    }

    fn query(&self) -> LogQuery {
        LogQuery {
            from: Some(self.from.0),
            until: Some(self.until.0),
            subject: self.about.clone(),
            ..LogQuery::default()
        }
    }
}

/// Fixes as a file.
#[utoipa::path(get, path = "/api/v1/export/tracks", tag = "export", params(Wanted),
    responses((status = 200, description = "the file", content((String = "text/csv"), (serde_json::Value = "application/geo+json"), (Vec<u8> = "application/vnd.apache.parquet")))))]
pub(super) async fn tracks(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Query(wanted): Query<Wanted>,
) -> Result<Response, ApiError> {
    let format = wanted.format()?;
    let of = wanted
        .about
        .clone()
        .map(|id| if wanted.tag == Some(true) { TrackOf::Tag(id) } else { TrackOf::Person(id) });
    let query = TracksQuery { of, from: wanted.from.0, until: wanted.until.0 };
    let export = Export::tracks(context.store.clone(), query, format, context.mine.georeference());
    send(&context, &caller, "tracks", &wanted, format, export).await
}

/// Events as a file.
#[utoipa::path(get, path = "/api/v1/export/events", tag = "export", params(Wanted),
    responses((status = 200, description = "the file", content((String = "text/csv"), (serde_json::Value = "application/geo+json"), (Vec<u8> = "application/vnd.apache.parquet")))))]
pub(super) async fn events(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Query(wanted): Query<Wanted>,
) -> Result<Response, ApiError> {
    let format = wanted.format()?;
    let export = Export::events(context.store.clone(), wanted.query(), format, context.mine.georeference());
    send(&context, &caller, "events", &wanted, format, export).await
}

/// Alarms as a file.
#[utoipa::path(get, path = "/api/v1/export/alarms", tag = "export", params(Wanted),
    responses((status = 200, description = "the file", content((String = "text/csv"), (serde_json::Value = "application/geo+json"), (Vec<u8> = "application/vnd.apache.parquet")))))]
pub(super) async fn alarms(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Query(wanted): Query<Wanted>,
) -> Result<Response, ApiError> {
    let format = wanted.format()?;
    let export = Export::alarms(context.store.clone(), wanted.query(), format, context.mine.georeference());
    send(&context, &caller, "alarms", &wanted, format, export).await
}

/// Which shifts, in which form.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct WantedShifts {
    /// `csv`.
    #[param(pattern = "^csv$")]
    format: String,
    /// Who came out from this time on.
    from: Timestamp,
    /// Who came out before this time.
    until: Timestamp,
}

/// Attendance as a file: everybody who came out in a time, and who is below now.
#[utoipa::path(get, path = "/api/v1/export/attendance", tag = "export", params(WantedShifts),
    responses((status = 200, description = "the file", content_type = "text/csv", body = String)))]
pub(super) async fn attendance(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Query(wanted): Query<WantedShifts>,
) -> Result<Response, ApiError> {
    if wanted.format != Format::Csv.name() {
        return Err(ApiError::invalid(format!("format: expected csv, found {:?}", wanted.format)));
    }
    let part = ShiftPart { from: wanted.from, until: wanted.until };
    let shifts = shifts(&context, &part).await?;
    let mut file = csv::Writer::from_writer(Vec::new());
    let head = ["person", "name", "team", "tag", "went_below_utc", "came_out_utc", "hours"];
    let mut written = file.write_record(head);
    {
        let tracking = context.tracking();
        for shift in shifts {
            let person = shift.person.as_ref().and_then(|id| tracking.person(id)).map(|view| view.person);
            let (name, team) = person.map_or_else(Default::default, |p| (p.name, p.team.unwrap_or_default()));
            written = written.and_then(|()| {
                file.write_record([
                    shift.person.unwrap_or_default(),
                    name,
                    team,
                    shift.tag.unwrap_or_default(),
                    shift.went_below.to_string(),
                    shift.came_out.map(|time| time.to_string()).unwrap_or_default(),
                    format!("{:.3}", shift.hours),
                ])
            });
        }
    }
    written.map_err(|error| ApiError::internal(&error))?;
    let bytes = file.into_inner().map_err(|error| ApiError::internal(error.error()))?;
    let detail = json!({ "from": wanted.from, "until": wanted.until, "format": wanted.format });
    context.audit(&caller, "export.attendance", "done", detail).await?;
    Ok((headers("attendance", Format::Csv), bytes).into_response())
}

fn headers(what: &str, format: Format) -> [(header::HeaderName, String); 2] {
    let name = format!("attachment; filename=\"{what}.{}\"", format.name());
    [(header::CONTENT_TYPE, format.media_type().to_owned()), (header::CONTENT_DISPOSITION, name)]
}

/// The first bytes are made before the answer begins: what fails at once is told as such. What fails later breaks the connection.
async fn send<T: Exported>(
    context: &Context,
    caller: &Caller,
    what: &str,
    wanted: &Wanted,
    format: Format,
    export: Result<Export<T>, crate::ServerError>,
) -> Result<Response, ApiError>
where
    Export<T>: Send,
{
    let mut export = export.map_err(|error| ApiError::of_server(&error))?;
    let first = export.next().await.map_err(|error| ApiError::of_server(&error))?.unwrap_or_default();
    let Principal { name, .. } = &caller.principal;
    tracing::info!("{name} exports {what}");
    let detail =
        json!({ "from": wanted.from, "until": wanted.until, "about": wanted.about, "format": format.name() });
    context.audit(caller, &format!("export.{what}"), "done", detail).await?;
    let rest = stream::unfold(Some((Some(first), export)), |state| async {
        let (first, mut export) = state?;
        if let Some(first) = first {
            return Some((Ok(Bytes::from(first)), Some((None, export))));
        }
        match export.next().await {
            Ok(Some(bytes)) => Some((Ok(Bytes::from(bytes)), Some((None, export)))),
            Ok(None) => None,
            Err(error) => {
                tracing::error!("export: {error}");
                Some((Err(error), None))
            }
        }
    });
    Ok((headers(what, format), Body::from_stream(rest)).into_response())
}
