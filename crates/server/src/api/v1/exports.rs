//! Tracks, events and alarms as files, streamed: no more than a page of the store is held.

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
    responses((status = 200, description = "the file", content((Vec<u8> = "text/csv"), (Vec<u8> = "application/geo+json"), (Vec<u8> = "application/vnd.apache.parquet")))))]
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
    responses((status = 200, description = "the file", content((Vec<u8> = "text/csv"), (Vec<u8> = "application/geo+json"), (Vec<u8> = "application/vnd.apache.parquet")))))]
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
    responses((status = 200, description = "the file", content((Vec<u8> = "text/csv"), (Vec<u8> = "application/geo+json"), (Vec<u8> = "application/vnd.apache.parquet")))))]
pub(super) async fn alarms(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Query(wanted): Query<Wanted>,
) -> Result<Response, ApiError> {
    let format = wanted.format()?;
    let export = Export::alarms(context.store.clone(), wanted.query(), format, context.mine.georeference());
    send(&context, &caller, "alarms", &wanted, format, export).await
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
    let name = format!("attachment; filename=\"{what}.{}\"", format.name());
    let headers =
        [(header::CONTENT_TYPE, format.media_type().to_owned()), (header::CONTENT_DISPOSITION, name)];
    Ok((headers, Body::from_stream(rest)).into_response())
}
