//! How tags are followed: why a position is where it is, and which packets came.

use crate::api::extract::Path;
use crate::api::{ApiError, Context};
use axum::extract::State;
use serde::Serialize;
use serde_json::Value;
use std::sync::Arc;
use utoipa::ToSchema;

/// How a tag is followed.
#[derive(Serialize, ToSchema)]
pub(super) struct Following {
    /// The tag.
    tag: String,
    /// Name of its profile in the settings.
    profile: String,
    /// Name of the method.
    method: String,
    /// What is added to the stamps of its clock, s.
    clock_shift_s: f64,
    /// Packets and observations: taken, repeated, late, refused; fixes told.
    counts: Value,
    /// The last error of the method.
    last_error: Option<String>,
    /// What the method says of its run: what it heard, innovations, warnings.
    method_report: Value,
}

/// How a tag is followed: method, clock, packets, innovations.
#[utoipa::path(get, path = "/api/v1/tags/{tag}/following", tag = "tags", params(("tag" = String, Path, description = "id of the tag")),
    responses((status = 200, description = "how", body = Following), (status = 404, description = "no packet of it came", body = crate::api::Problem)))]
pub(super) async fn of_tag(
    State(context): State<Arc<Context>>,
    Path(tag): Path<String>,
) -> Result<axum::Json<Following>, ApiError> {
    let health = context.door.following(tag.clone()).await;
    let health = health.ok_or_else(|| ApiError::not_found(format!("no packet of a tag \"{tag}\" came")))?;
    Ok(axum::Json(Following {
        tag: health.tag,
        profile: health.profile,
        method: health.method,
        clock_shift_s: health.clock_shift_s,
        counts: serde_json::to_value(health.counts).map_err(|error| ApiError::internal(&error))?,
        last_error: health.last_error,
        method_report: health.method_report,
    }))
}

/// Packets that came of a tag.
#[derive(Serialize, ToSchema)]
pub(super) struct Packets {
    /// The tag.
    tag: String,
    /// First and last of each span of its own packet numbers.
    numbers: Vec<[u64; 2]>,
}

/// The numbers of all packets that came, tag by tag: what a gateway or a load generator has sent and does not find here was lost.
#[utoipa::path(get, path = "/api/v1/packets", tag = "tags", responses((status = 200, description = "by tag", body = Vec<Packets>)))]
pub(super) async fn packets(
    State(context): State<Arc<Context>>,
) -> Result<axum::Json<Vec<Packets>>, ApiError> {
    let packets = context.door.packets().await.unwrap_or_default();
    let packets = packets.into_iter().map(|(tag, numbers)| Packets {
        tag,
        numbers: numbers.into_iter().map(|(first, last)| [first, last]).collect(),
    });
    Ok(axum::Json(packets.collect()))
}
