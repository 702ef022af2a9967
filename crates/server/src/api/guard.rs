//! The one layer that every request passes: who asks, and may they? Denied unless the table of routes allows it.

use super::routes::{Access, AccessTable};
use super::{ApiError, Context, client};
use crate::auth::{Permission, Principal};
use axum::extract::{MatchedPath, Request, State};
use axum::http::request::Parts;
use axum::http::{HeaderMap, Method, header};
use axum::middleware::Next;
use axum::response::{IntoResponse as _, Response};
use std::sync::Arc;

/// Name of the cookie that holds a session.
pub(super) const COOKIE: &str = "adit_session";

/// What the layer asks.
#[derive(Clone)]
pub(super) struct Guard {
    pub context: Arc<Context>,
    pub table: Arc<AccessTable>,
}

pub(super) async fn guard(State(guard): State<Guard>, request: Request, next: Next) -> Response {
    let (mut parts, body) = request.into_parts();
    parts.extensions.insert(client::of(&guard.context.settings, &parts));
    match admit(&guard, &parts).await {
        Ok(principal) => {
            if let Some(principal) = principal {
                parts.extensions.insert(principal);
            }
            next.run(Request::from_parts(parts, body)).await
        }
        Err(error) => {
            metrics::counter!("adit_api_refused_total", "status" => error.status().as_u16().to_string())
                .increment(1);
            error.into_response()
        }
    }
}

async fn admit(guard: &Guard, request: &Parts) -> Result<Option<Principal>, ApiError> {
    let path = request.extensions.get::<MatchedPath>().map_or("", MatchedPath::as_str);
    let access = guard.table.of(&request.method, path);
    let upgrade = request.headers.contains_key(header::UPGRADE);
    if access == Some(Access::Page) {
        return Ok(None);
    }
    if access == Some(Access::Open) {
        return same_origin(&request.headers).map(|()| None);
    }
    if access == Some(Access::Needs(Permission::SeeLive))
        && path == "/metrics"
        && guard.context.settings.open_metrics
    {
        return Ok(None);
    }
    let principal = who(guard, request).await?;
    match (access, principal) {
        (Some(Access::NeedsInside(_)), principal) if upgrade => Ok(principal),
        (_, None) => Err(ApiError::unauthorised()),
        (Some(Access::Needs(permission) | Access::NeedsInside(permission)), Some(principal)) => {
            if principal.may(permission) { Ok(Some(principal)) } else { Err(refused(&principal, permission)) }
        }
        // No route: the fallbacks answer 404 and 405, to those who may know.
        (Some(Access::Open | Access::Page) | None, principal) => Ok(principal),
    }
}

/// Why a caller may not.
pub(super) fn refused(principal: &Principal, permission: Permission) -> ApiError {
    ApiError::forbidden(format!(
        "`{}` is {}; to {} needs the role {}",
        principal.name,
        principal.grant.name(),
        permission.description(),
        permission.least_role().name()
    ))
}

/// Whose request it is: by the header `Authorization: Bearer`, else by the cookie, which counts only for requests of our own pages.
async fn who(guard: &Guard, request: &Parts) -> Result<Option<Principal>, ApiError> {
    let headers = &request.headers;
    if let Some(secret) = bearer(headers) {
        return Ok(guard.context.auth.principal(secret).await?);
    }
    let Some(secret) = cookie(headers) else { return Ok(None) };
    let reads = matches!(request.method, Method::GET | Method::HEAD | Method::OPTIONS);
    if !reads || headers.contains_key(header::UPGRADE) {
        same_origin(headers)?;
    }
    Ok(guard.context.auth.principal(secret).await?)
}

fn bearer(headers: &HeaderMap) -> Option<&str> {
    let value = headers.get(header::AUTHORIZATION)?.to_str().ok()?;
    let (scheme, secret) = value.split_once(' ')?;
    scheme.eq_ignore_ascii_case("bearer").then(|| secret.trim())
}

fn cookie(headers: &HeaderMap) -> Option<&str> {
    let lines = headers.get_all(header::COOKIE).iter().filter_map(|line| line.to_str().ok());
    let mut pairs = lines.flat_map(|line| line.split(';')).filter_map(|pair| pair.trim().split_once('='));
    pairs.find(|(name, _)| *name == COOKIE).map(|(_, value)| value)
}

/// Refuses what a page of another origin made a browser send. Programs other than browsers send neither header.
fn same_origin(headers: &HeaderMap) -> Result<(), ApiError> {
    let text = |name: header::HeaderName| headers.get(name).map(|value| value.to_str().unwrap_or("?"));
    let foreign = match text(header::HeaderName::from_static("sec-fetch-site")) {
        Some(site) => !matches!(site, "same-origin" | "none"),
        None => match text(header::ORIGIN) {
            Some(origin) => origin.split_once("://").map(|(_, host)| host) != text(header::HOST),
            None => false,
        },
    };
    if foreign { Err(ApiError::forbidden("a request of a page of another origin")) } else { Ok(()) }
}
