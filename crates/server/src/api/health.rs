//! Is the server alive, and can it do its work?

use super::Context;
use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use utoipa::ToSchema;

/// A part of the server that can fail by itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Part {
    /// What is heard is written and acknowledged.
    Journal,
    /// What was is written.
    Store,
    /// The connection to the broker of the gateways.
    Broker,
}

/// How the parts are; each tells when it fails and when it works again.
#[derive(Debug, Default)]
pub struct Health {
    failing: Mutex<BTreeMap<Part, Option<String>>>,
}

impl Health {
    /// A part works, or says why it does not. A part that has never told anything is not used.
    pub fn tell(&self, part: Part, state: Result<(), String>) {
        self.failing.lock().unwrap_or_else(PoisonError::into_inner).insert(part, state.err());
    }

    fn parts(&self) -> Vec<PartHealth> {
        let parts = self.failing.lock().unwrap_or_else(PoisonError::into_inner);
        parts.iter().map(|(part, failing)| PartHealth { part: *part, ok: failing.is_none() }).collect()
    }

    /// Why parts do not work.
    pub fn failing(&self) -> Vec<(Part, String)> {
        let parts = self.failing.lock().unwrap_or_else(PoisonError::into_inner);
        parts.iter().filter_map(|(part, failing)| Some((*part, failing.clone()?))).collect()
    }
}

/// How one part is.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct PartHealth {
    part: Part,
    ok: bool,
}

/// How the server is.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct HealthReport {
    /// All parts that are used work.
    ready: bool,
    parts: Vec<PartHealth>,
}

/// Readiness: 200 when all parts that are used work, else 503. Why one does not, the log and the metrics tell, not this open route.
#[utoipa::path(get, path = "/health", tag = "health", responses(
    (status = 200, description = "all parts work", body = HealthReport),
    (status = 503, description = "a part does not", body = HealthReport),
))]
pub(super) async fn readiness(State(context): State<Arc<Context>>) -> (StatusCode, Json<HealthReport>) {
    let parts = context.health.parts();
    let ready = parts.iter().all(|part| part.ok);
    let status = if ready { StatusCode::OK } else { StatusCode::SERVICE_UNAVAILABLE };
    (status, Json(HealthReport { ready, parts }))
}

/// Liveness: the server answers.
#[utoipa::path(get, path = "/health/live", tag = "health", responses((status = 204, description = "it does")))]
pub(super) async fn liveness() -> StatusCode {
    StatusCode::NO_CONTENT
}
