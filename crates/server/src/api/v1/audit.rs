//! Whether the audit log is what was written.

use crate::api::extract::Query;
use crate::api::{ApiError, Context};
use crate::store::AuditHead;
use axum::extract::State;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use utoipa::{IntoParams, ToSchema};

/// Against what the log is held.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct WrittenDown {
    /// Heads that were written down elsewhere, `NUMBER:HASH`, with commas between them.
    heads: Option<String>,
}

/// What the log looks like.
#[derive(Serialize, ToSchema)]
pub(super) struct Verification {
    /// Every row is as it was written.
    sound: bool,
    /// Rows that fit, from the first.
    rows: u64,
    /// On what the first row stands: number 0, or the last row that retention took away.
    anchor: String,
    /// The end of the chain. Written down elsewhere it shows, later, a log that was made anew.
    head: String,
    /// Heads given whose rows retention took away: nothing can be said of them.
    too_old: Vec<String>,
    /// The first thing that does not fit.
    broken: Option<String>,
}

/// Goes through the chain of the whole audit log.
#[utoipa::path(get, path = "/api/v1/audit/verification", tag = "audit", params(WrittenDown),
    responses((status = 200, description = "what was found", body = Verification)))]
pub(super) async fn verification(
    State(context): State<Arc<Context>>,
    Query(written): Query<WrittenDown>,
) -> Result<axum::Json<Verification>, ApiError> {
    let heads = written.heads.unwrap_or_default();
    let heads = heads.split(',').filter(|head| !head.is_empty()).map(str::parse);
    let heads: Vec<AuditHead> = heads
        .collect::<Result<_, crate::store::StoreError>>()
        .map_err(|error| ApiError::invalid(error.to_string()))?;
    let verdict = context.store.verify_audit(&heads).await.map_err(|error| ApiError::of_store(&error))?;
    Ok(axum::Json(Verification {
        sound: verdict.broken.is_none(),
        rows: verdict.rows,
        anchor: verdict.anchor.to_string(),
        head: verdict.head.to_string(),
        too_old: verdict.too_old.iter().map(ToString::to_string).collect(),
        broken: verdict.broken.map(|broken| broken.to_string()),
    }))
}
