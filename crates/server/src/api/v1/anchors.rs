//! The anchors of the plan, and changes of them.

use crate::api::extract::{Caller, Json, Path};
use crate::api::{ApiError, Context};
use crate::{AnchorChange, ServerError};
use adit_observation::DeviceId;
use axum::extract::State;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::collections::BTreeSet;
use std::sync::Arc;
use utoipa::ToSchema;

/// Names are no longer, bytes.
const LONGEST: usize = 256;

/// When a change is in force.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
enum InForce {
    /// As it stands.
    #[serde(rename = "now")]
    Now,
    /// When the server starts again.
    #[serde(rename = "at the next start")]
    NextStart,
}

/// An anchor of the plan.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Anchor)]
pub(super) struct AnchorJson {
    id: String,
    /// Its name for people.
    name: Option<String>,
    /// East, north, height, m; null when it is taken away.
    position_m: Option<[f64; 3]>,
    /// Where it is for the server as it runs; null where it is not known yet.
    position_now_m: Option<[f64; 3]>,
    in_force: InForce,
}

/// Where an anchor is.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = AnchorPlace)]
pub(super) struct AnchorBody {
    /// East, north, height, m.
    position_m: [f64; 3],
    /// Its name for people.
    #[schema(max_length = 256)]
    name: Option<String>,
}

fn now_m(context: &Context, id: &str) -> Option<[f64; 3]> {
    let anchor = context.mine.plan().anchors.iter().find(|anchor| anchor.id == id)?;
    Some((*anchor.position_m.raw()).into())
}

fn json_of(context: &Context, id: &str, change: Option<&AnchorChange>) -> AnchorJson {
    let position_now_m = now_m(context, id);
    let position_m = change.map_or(position_now_m, |change| change.position_m);
    let in_force = if position_m == position_now_m { InForce::Now } else { InForce::NextStart };
    let name = change.and_then(|change| change.name.clone());
    AnchorJson { id: id.to_owned(), name, position_m, position_now_m, in_force }
}

/// The anchors of the plan with the changes of them, by id.
#[utoipa::path(get, path = "/api/v1/mine/anchors", tag = "mine", responses((status = 200, description = "all", body = Vec<AnchorJson>)))]
pub(super) async fn list(State(context): State<Arc<Context>>) -> axum::Json<Vec<AnchorJson>> {
    let changes = context.plan.changes().await;
    let known = context.mine.plan().anchors.iter().map(|anchor| anchor.id.as_str());
    let ids: BTreeSet<&str> = known.chain(changes.anchors.keys().map(String::as_str)).collect();
    let anchors = ids.into_iter().map(|id| json_of(&context, id, changes.anchors.get(id)));
    // What was taken away and is gone needs no mention.
    let anchors = anchors.filter(|anchor| anchor.position_m.or(anchor.position_now_m).is_some());
    axum::Json(anchors.collect())
}

/// Puts an anchor somewhere, or another one into the plan; in force when the server starts again.
#[utoipa::path(put, path = "/api/v1/mine/anchors/{id}", tag = "mine", request_body = AnchorBody,
    responses((status = 200, description = "kept", body = AnchorJson)))]
pub(super) async fn put(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Path(id): Path<String>,
    Json(body): Json<AnchorBody>,
) -> Result<axum::Json<AnchorJson>, ApiError> {
    if DeviceId::new(&id).is_none() {
        return Err(ApiError::invalid(format!("id: found {id:?}, expected the id of a device")));
    }
    if let Some(name) = body.name.as_ref().filter(|name| name.len() > LONGEST) {
        return Err(ApiError::invalid(format!("name: {} bytes, expected at most {LONGEST}", name.len())));
    }
    let change = AnchorChange { position_m: Some(body.position_m), name: body.name };
    changed(&context, &caller, id, change).await
}

/// Takes an anchor out of the plan; in force when the server starts again.
#[utoipa::path(delete, path = "/api/v1/mine/anchors/{id}", tag = "mine",
    responses((status = 200, description = "kept", body = AnchorJson)))]
pub(super) async fn remove(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Path(id): Path<String>,
) -> Result<axum::Json<AnchorJson>, ApiError> {
    let changes = context.plan.changes().await;
    let there = changes.anchors.get(&id).map_or(now_m(&context, &id), |change| change.position_m);
    if there.is_none() {
        return Err(ApiError::not_found(format!("there is no anchor '{id}'")));
    }
    changed(&context, &caller, id, AnchorChange { position_m: None, name: None }).await
}

async fn changed(
    context: &Context,
    caller: &Caller,
    id: String,
    change: AnchorChange,
) -> Result<axum::Json<AnchorJson>, ApiError> {
    let answer = json_of(context, &id, Some(&change));
    let what = if change.position_m.is_some() { "anchor.put" } else { "anchor.remove" };
    let detail = json!({ "anchor": id, "position_m": change.position_m, "name": change.name });
    match context.plan.change(context.mine.plan(), id, change).await {
        Ok(()) => {}
        Err(ServerError::Plan { what: wrong, .. }) => {
            context.audit(caller, what, &format!("refused: {wrong}"), detail).await?;
            return Err(ApiError::invalid(wrong));
        }
        Err(error) => return Err(ApiError::of_server(&error)),
    }
    context.audit(caller, what, "done", detail).await?;
    Ok(axum::Json(answer))
}
