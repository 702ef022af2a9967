//! Alarms and evacuation.

use super::people::Remark;
use crate::api::extract::{Caller, Json, Path};
use crate::api::view::{AlarmJson, EvacuationJson};
use crate::api::{ApiError, Context};
use adit_tracking::{AlarmId, Command};
use axum::extract::State;
use axum::http::StatusCode;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::sync::Arc;
use utoipa::ToSchema;

/// Alarms as they stand.
#[derive(Serialize, ToSchema)]
pub(super) struct Alarms {
    /// In the order in which they were raised.
    open: Vec<AlarmJson>,
    /// The last thousand that were cleared, the latest last. Older ones: `/api/v1/history/alarms`.
    cleared: Vec<AlarmJson>,
}

/// Open alarms and the last cleared ones.
#[utoipa::path(get, path = "/api/v1/alarms", tag = "alarms", responses((status = 200, description = "as they stand", body = Alarms)))]
pub(super) async fn list(State(context): State<Arc<Context>>) -> axum::Json<Alarms> {
    let tracking = context.tracking();
    let open = tracking.open_alarms().map(AlarmJson::from).collect();
    let cleared = tracking.cleared_alarms().map(AlarmJson::from).collect();
    axum::Json(Alarms { open, cleared })
}

/// One alarm.
#[utoipa::path(get, path = "/api/v1/alarms/{id}", tag = "alarms", responses((status = 200, description = "the alarm", body = AlarmJson)))]
pub(super) async fn show(
    State(context): State<Arc<Context>>,
    Path(id): Path<u64>,
) -> Result<axum::Json<AlarmJson>, ApiError> {
    Ok(axum::Json(find(&context, id)?))
}

/// Somebody has seen the alarm and takes care of it; its escalation ends.
#[utoipa::path(post, path = "/api/v1/alarms/{id}/acknowledge", tag = "alarms", request_body = Remark,
    responses((status = 200, description = "acknowledged", body = AlarmJson)))]
pub(super) async fn acknowledge(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Path(id): Path<u64>,
    Json(remark): Json<Remark>,
) -> Result<axum::Json<AlarmJson>, ApiError> {
    context.command(&caller, Command::Acknowledge { alarm: AlarmId(id), note: remark.note }).await?;
    Ok(axum::Json(find(&context, id)?))
}

/// Clears an alarm whose end nobody but a human can tell (distress, man down).
#[utoipa::path(post, path = "/api/v1/alarms/{id}/clear", tag = "alarms", request_body = Remark,
    responses((status = 200, description = "cleared", body = AlarmJson)))]
pub(super) async fn clear(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Path(id): Path<u64>,
    Json(remark): Json<Remark>,
) -> Result<axum::Json<AlarmJson>, ApiError> {
    context.command(&caller, Command::Clear { alarm: AlarmId(id), note: remark.note }).await?;
    Ok(axum::Json(find(&context, id)?))
}

/// What is to be said to an alarm.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Comment {
    #[schema(min_length = 1, max_length = 2000)]
    text: String,
}

/// Says something to an alarm.
#[utoipa::path(post, path = "/api/v1/alarms/{id}/comments", tag = "alarms", request_body = Comment,
    responses((status = 201, description = "said", body = AlarmJson)))]
pub(super) async fn comment(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Path(id): Path<u64>,
    Json(comment): Json<Comment>,
) -> Result<(StatusCode, axum::Json<AlarmJson>), ApiError> {
    context.command(&caller, Command::Comment { alarm: AlarmId(id), text: comment.text }).await?;
    Ok((StatusCode::CREATED, axum::Json(find(&context, id)?)))
}

fn find(context: &Context, id: u64) -> Result<AlarmJson, ApiError> {
    let alarm = context.tracking().alarm(AlarmId(id)).map(AlarmJson::from);
    alarm.ok_or_else(|| {
        ApiError::not_found(format!("there is no alarm {id} among the open and the last cleared ones"))
    })
}

/// The evacuation that runs, if any.
#[derive(Serialize, ToSchema)]
pub(super) struct Board {
    evacuation: Option<EvacuationJson>,
}

/// The board: who is out, in a refuge, on the way, not moving, not heard of, with last known positions and their growing radius.
#[utoipa::path(get, path = "/api/v1/evacuation", tag = "evacuation", responses((status = 200, description = "as it stands; null when none runs", body = Board)))]
pub(super) async fn board(State(context): State<Arc<Context>>) -> axum::Json<Board> {
    axum::Json(Board { evacuation: context.tracking().evacuation().map(EvacuationJson::from) })
}

/// Which levels, and why.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct StartEvacuation {
    /// Ids of the levels to leave; the whole mine where it is empty.
    #[serde(default)]
    #[schema(value_type = Vec<String>)]
    levels: BTreeSet<String>,
    #[serde(default)]
    #[schema(max_length = 2000)]
    note: String,
}

/// Everybody out.
#[utoipa::path(post, path = "/api/v1/evacuation", tag = "evacuation", request_body = StartEvacuation,
    responses((status = 201, description = "started", body = Board)))]
pub(super) async fn start(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Json(body): Json<StartEvacuation>,
) -> Result<(StatusCode, axum::Json<Board>), ApiError> {
    context.command(&caller, Command::StartEvacuation { levels: body.levels, note: body.note }).await?;
    Ok((StatusCode::CREATED, board(State(context)).await))
}

/// The evacuation is over.
#[utoipa::path(post, path = "/api/v1/evacuation/stop", tag = "evacuation", request_body = Remark,
    responses((status = 200, description = "over", body = Board)))]
pub(super) async fn stop(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Json(remark): Json<Remark>,
) -> Result<axum::Json<Board>, ApiError> {
    context.command(&caller, Command::StopEvacuation { note: remark.note }).await?;
    Ok(board(State(context)).await)
}
