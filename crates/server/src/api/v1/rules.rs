//! The rules of alarms: from when on, how bad, how soon somebody must have seen them.

use crate::api::extract::{Caller, Json};
use crate::api::{ApiError, Context};
use adit_tracking::{Command, Rules};
use axum::extract::State;
use serde_json::{Map, Value};
use std::sync::Arc;

fn in_force(context: &Context) -> Result<axum::Json<Value>, ApiError> {
    let rules = serde_json::to_value(context.tracking().rules());
    rules.map(axum::Json).map_err(|error| ApiError::internal(&error))
}

/// The rules in force, all of them, by section (docs/live/tracking.md).
#[utoipa::path(get, path = "/api/v1/rules", tag = "alarms", responses((status = 200, description = "the rules", body = Object)))]
pub(super) async fn show(State(context): State<Arc<Context>>) -> Result<axum::Json<Value>, ApiError> {
    in_force(&context)
}

/// Puts rules in place of all that are in force, from now on and for good; a rule that is left out has its default. Answers with all of them.
#[utoipa::path(put, path = "/api/v1/rules", tag = "alarms", request_body = Object,
    responses((status = 200, description = "the rules now", body = Object)))]
pub(super) async fn put(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Json(sections): Json<Map<String, Value>>,
) -> Result<axum::Json<Value>, ApiError> {
    // A list would be read as a section's values in their order.
    if let Some((name, found)) = sections.iter().find(|(_, section)| !section.is_object()) {
        return Err(ApiError::invalid(format!("{name}: found {found}, expected an object")));
    }
    let rules: Rules = serde_json::from_value(Value::Object(sections))
        .map_err(|error| ApiError::invalid(error.to_string()))?;
    context.command(&caller, Command::SetRules { rules: Box::new(rules) }).await?;
    in_force(&context)
}
