//! The API: `/api/v1` of adit's own, `/v2` as omlox has it, `/metrics`, `/health`.
//!
//! Every request passes one layer (`guard`) that knows who asks and what the route needs ([`Access`]). Handlers read the live
//! state under its read lock and the store; what changes the live state goes through the [`Door`] into the journal and is answered
//! when it was applied. Whatever goes wrong is answered as [`Problem`] in JSON.

mod client;
mod error;
mod extract;
mod guard;
mod health;
mod metrics;
mod omlox;
mod openapi;
mod routes;
mod serve;
mod socket;
mod timestamp;
mod v1;
mod view;

pub use error::{ApiError, Problem};
pub use health::{Health, Part};
pub use ipnet::IpNet;
pub use metrics::Metrics;
pub use omlox::{FenceWatch, Proximities};
pub use openapi::document;
pub use routes::Access;
pub use serve::{TlsFiles, serve};
pub use timestamp::Timestamp;
pub use view::{AlarmJson, EventJson, LiveJson, WhereJson};

use crate::PlanDesk;
use crate::auth::{Auth, Permission};
use crate::clock::Clock;
use crate::console;
use crate::feed::Feed;
use crate::ingest::{CommandError, Door};
use crate::store::{AuditRecord, Store};
use adit_mine::Mine;
use adit_tracking::{Command, Outcome, Tracking};
use axum::Router;
use axum::extract::DefaultBodyLimit;
use axum::http::{HeaderValue, Method, header, request};
use routes::Routes;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard};
use std::time::Duration;
use tower_http::cors::{AllowOrigin, CorsLayer};
use tower_http::set_header::SetResponseHeaderLayer;
use utoipa_axum::routes;

/// Largest body of a request that is not a batch, bytes.
const BODY_LIMIT: usize = 256 * 1024;
/// How long the answer to a command that is done waits for the audit log.
const AUDIT_PATIENCE: Duration = Duration::from_secs(2);

/// How the API behaves.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ApiSettings {
    /// `/metrics` needs no token.
    pub open_metrics: bool,
    /// Cookies are sent over TLS only: set when a proxy in front does the TLS.
    pub secure_cookies: bool,
    /// Networks of proxies whose `X-Forwarded-For` says who asks, for limits and the audit log; nobody's counts where it is empty.
    pub trusted_proxies: Vec<IpNet>,
}

/// What the routes need.
pub struct Context {
    /// The mine.
    pub mine: Arc<Mine>,
    /// The live state; the pipeline writes it, nobody else.
    pub tracking: Arc<RwLock<Tracking>>,
    /// The way into the journal.
    pub door: Door,
    /// What happens.
    pub feed: Arc<Feed>,
    /// What was.
    pub store: Store,
    /// Who may.
    pub auth: Auth,
    /// How the parts are.
    pub health: Arc<Health>,
    /// What is counted.
    pub metrics: Metrics,
    /// How the API behaves.
    pub settings: ApiSettings,
    /// The settings in force, as `GET /api/v1/settings` shows them; without secrets.
    pub shown_settings: Value,
    /// The time of the mine.
    pub clock: Clock,
    /// Changes of the plan.
    pub plan: PlanDesk,
    /// The fences that clients of omlox have put.
    pub fences: FenceWatch,
    /// What clients of omlox tell of nearness.
    pub proximities: Proximities,
}

impl Context {
    /// The live state, to read from; never held over an `await`.
    fn tracking(&self) -> RwLockReadGuard<'_, Tracking> {
        self.tracking.read().unwrap_or_else(PoisonError::into_inner)
    }

    /// What a caller wants, through the journal; done or refused, it is in the audit log.
    async fn command(&self, caller: &extract::Caller, command: Command) -> Result<Outcome, ApiError> {
        let detail = serde_json::to_value(&command).map_err(|error| ApiError::internal(&error))?;
        let what = detail.get("command").and_then(Value::as_str).unwrap_or("command").to_owned();
        let outcome = self.door.command(caller.principal.name.clone(), command).await;
        let how = match &outcome {
            Ok(_) => "done".to_owned(),
            Err(CommandError::Refused(refused)) => format!("refused: {refused}"),
            Err(CommandError::Door(error)) => return Err(error.clone().into()),
        };
        // It is done whether the log can be written or not, and stands in the journal: nobody waits long for a store that is locked.
        let entry = self.entry(&caller.principal.name, caller.address, &what, &how, detail);
        let store = self.store.clone();
        let written = tokio::spawn(async move {
            if store.audit(&entry).await.is_err() {
                ::metrics::counter!("adit_audit_failures_total").increment(1);
            }
        });
        let _ = tokio::time::timeout(AUDIT_PATIENCE, written).await;
        Ok(outcome?)
    }

    /// Writes into the audit log what is not a command of the journal.
    async fn audit(
        &self,
        who: &extract::Caller,
        what: &str,
        outcome: &str,
        detail: Value,
    ) -> Result<(), ApiError> {
        self.audit_as(&who.principal.name, who.address, what, outcome, detail).await
    }

    async fn audit_as(
        &self,
        who: &str,
        address: std::net::IpAddr,
        what: &str,
        outcome: &str,
        detail: Value,
    ) -> Result<(), ApiError> {
        let entry = self.entry(who, address, what, outcome, detail);
        self.store.audit(&entry).await.map_err(|error| ApiError::of_store(&error)).map(drop)
    }

    fn entry(
        &self,
        who: &str,
        address: std::net::IpAddr,
        what: &str,
        outcome: &str,
        detail: Value,
    ) -> AuditRecord {
        AuditRecord {
            time: self.clock.now(),
            who: who.into(),
            what: what.into(),
            source: address.to_string(),
            outcome: outcome.into(),
            detail,
        }
    }
}

fn all_routes() -> Routes {
    let routes = Routes::new(openapi::frame())
        .open(routes!(health::readiness))
        .open(routes!(health::liveness))
        .needs(Permission::SeeLive, routes!(metrics::metrics))
        .needs(Permission::SeeLive, routes!(openapi::openapi));
    let routes = omlox::mount(v1::mount(routes));
    console::pages().iter().fold(routes, Routes::page)
}

/// Methods and paths of all routes that need nothing: of the API, then pages.
pub fn open_routes() -> Vec<String> {
    let (_, _, table) = all_routes().finish();
    table.open()
}

/// All routes behind the one layer.
pub fn router(context: Arc<Context>) -> Router {
    let (router, _, table) = all_routes().finish();
    let guard = guard::Guard { context: Arc::clone(&context), table: Arc::new(table) };
    let header = |name, value| SetResponseHeaderLayer::if_not_present(name, HeaderValue::from_static(value));
    router
        .fallback(serve::no_route)
        .method_not_allowed_fallback(serve::no_method)
        .layer(axum::middleware::from_fn_with_state(guard, guard::guard))
        .layer(DefaultBodyLimit::max(BODY_LIMIT))
        .layer(cors())
        .layer(header(header::X_CONTENT_TYPE_OPTIONS, "nosniff"))
        .layer(header(header::CACHE_CONTROL, "no-store"))
        .with_state(context)
}

/// Pages of other origins may use `/v2` with a token of their own; cookies are never sent there.
fn cors() -> CorsLayer {
    let of_v2 = |_: &HeaderValue, parts: &request::Parts| parts.uri.path().starts_with("/v2/");
    CorsLayer::new()
        .allow_origin(AllowOrigin::predicate(of_v2))
        .allow_methods([Method::GET, Method::PUT, Method::POST, Method::DELETE])
        .allow_headers([header::AUTHORIZATION, header::CONTENT_TYPE])
}
