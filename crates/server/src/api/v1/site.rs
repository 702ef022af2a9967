//! The mine, the settings, the batches of gateways.

use crate::api::extract::Path;
use crate::api::{ApiError, Context};
use crate::ingest::Source;
use axum::body::Bytes;
use axum::extract::State;
use axum::http::{HeaderMap, header};
use axum::response::IntoResponse;
use serde::Serialize;
use serde_json::Value;
use std::sync::Arc;
use utoipa::ToSchema;

/// The mine's plan as its file has it (schema/mine.json).
#[utoipa::path(get, path = "/api/v1/mine", tag = "mine", responses((status = 200, description = "the plan", body = Value)))]
pub(super) async fn plan(State(context): State<Arc<Context>>) -> Result<axum::Json<Value>, ApiError> {
    let plan = serde_json::to_value(context.mine.plan());
    plan.map(axum::Json).map_err(|error| ApiError::internal(&error))
}

/// The mine's plan as `GeoJSON` on the mine's grid, a feature for each entry.
#[utoipa::path(get, path = "/api/v1/mine.geojson", tag = "mine", responses(
    (status = 200, description = "a feature collection", body = Value, content_type = "application/geo+json"),
))]
pub(super) async fn plan_geojson(State(context): State<Arc<Context>>) -> Result<impl IntoResponse, ApiError> {
    let text =
        adit_mine::file::to_geojson(context.mine.plan()).map_err(|error| ApiError::internal(&error))?;
    Ok(([(header::CONTENT_TYPE, "application/geo+json")], text))
}

/// The settings in force, without secrets.
#[utoipa::path(get, path = "/api/v1/settings", tag = "settings", responses((status = 200, description = "as configured", body = Value)))]
pub(super) async fn settings(State(context): State<Arc<Context>>) -> axum::Json<Value> {
    axum::Json(context.shown_settings.clone())
}

/// What became of a batch: it is on the disk.
#[derive(Serialize, ToSchema)]
pub(super) struct Stored {
    /// Entry of the journal that holds it; null when it had come before.
    position: Option<u64>,
    /// It had come before.
    repeated: bool,
}

/// A batch of observations of a gateway: protobuf `adit.v1.ObservationBatch` (`application/x-protobuf`) or the same in JSON
/// (`application/json`). The answer comes when it is on the disk.
#[utoipa::path(post, path = "/api/v1/gateways/{gateway}/observations", tag = "ingest",
    request_body(content((Vec<u8> = "application/x-protobuf"), (Value = "application/json"))),
    responses((status = 200, description = "stored", body = Stored)))]
pub(super) async fn observations(
    State(context): State<Arc<Context>>,
    Path(gateway): Path<String>,
    headers: HeaderMap,
    bytes: Bytes,
) -> Result<axum::Json<Stored>, ApiError> {
    let content_type = headers.get(header::CONTENT_TYPE).and_then(|value| value.to_str().ok());
    let content_type = content_type.and_then(|text| text.split(';').next()).unwrap_or_default().trim();
    if !matches!(content_type, "application/x-protobuf" | "application/json") {
        return Err(ApiError::unsupported_media_type(format!(
            "expected application/x-protobuf or application/json, found {content_type:?}"
        )));
    }
    let from = Source { name: gateway, json: content_type == "application/json" };
    let receipt = context.door.batch(from, bytes).await?;
    Ok(axum::Json(Stored { position: receipt.position, repeated: receipt.repeated }))
}
