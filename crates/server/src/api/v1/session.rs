//! Logging in and out, one's own password.

use crate::api::extract::{Caller, From, Json};
use crate::api::guard::COOKIE;
use crate::api::{ApiError, Context, Problem, Timestamp};
use crate::auth::{AuthError, Grant, Permission, Role};
use axum::extract::State;
use axum::http::{StatusCode, header};
use axum::response::IntoResponse;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::sync::Arc;
use utoipa::ToSchema;

/// Who wants in.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Login {
    #[schema(max_length = 64, example = "admin")]
    name: String,
    #[schema(max_length = 128, format = Password)]
    password: String,
}

/// A session begun.
#[derive(Serialize, ToSchema)]
pub(super) struct LoggedIn {
    name: String,
    role: Role,
    /// To be sent as `Authorization: Bearer …` by programs; browsers have it in the cookie.
    token: String,
    /// When the session ends at the latest.
    expires: Timestamp,
}

/// Logs in: the session comes as a cookie and as a token.
#[utoipa::path(post, path = "/api/v1/session", tag = "session", request_body = Login, responses(
    (status = 200, description = "in", body = LoggedIn),
    (status = 401, description = "wrong name or password, or locked", body = Problem),
    (status = 429, description = "too many tries; `Retry-After` says how long to wait", body = Problem),
))]
pub(super) async fn login(
    State(context): State<Arc<Context>>,
    From(address): From,
    Json(login): Json<Login>,
) -> Result<impl IntoResponse, ApiError> {
    let outcome = context.auth.login(address, &login.name, login.password).await;
    if matches!(outcome, Ok(_) | Err(AuthError::WrongCredentials)) {
        let name: String = login.name.chars().take(64).collect();
        let how = if outcome.is_ok() { "done" } else { "refused" };
        context.audit_as(&name, address, "session.login", how, json!({})).await?;
    }
    let session = outcome?;
    let cookie = cookie(&context, session.secret.expose(), context.auth.settings().session_s);
    let body = LoggedIn {
        name: session.name,
        role: session.role,
        token: session.secret.expose().into(),
        expires: session.expires.into(),
    };
    Ok(([(header::SET_COOKIE, cookie)], axum::Json(body)))
}

fn cookie(context: &Context, secret: &str, seconds: u32) -> String {
    let secure = if context.settings.secure_cookies { "; Secure" } else { "" };
    format!("{COOKIE}={secret}; Path=/; Max-Age={seconds}; HttpOnly; SameSite=Strict{secure}")
}

/// Who one is.
#[derive(Serialize, ToSchema)]
pub(super) struct Me {
    name: String,
    grant: Grant,
    /// What one may do.
    permissions: Vec<String>,
    /// When session or token ends if nothing more is asked.
    expires: Option<Timestamp>,
}

/// Who one is and what one may do.
#[utoipa::path(get, path = "/api/v1/session", tag = "session", responses((status = 200, description = "oneself", body = Me)))]
pub(super) async fn me(caller: Caller) -> axum::Json<Me> {
    let principal = caller.principal;
    let may = Permission::ALL.into_iter().filter(|permission| principal.may(*permission));
    axum::Json(Me {
        permissions: may.map(|permission| permission.name().into()).collect(),
        grant: principal.grant,
        expires: principal.expires.map(Timestamp),
        name: principal.name,
    })
}

/// Logs out. A token stays valid.
#[utoipa::path(delete, path = "/api/v1/session", tag = "session", responses((status = 204, description = "out")))]
pub(super) async fn logout(
    State(context): State<Arc<Context>>,
    caller: Caller,
) -> Result<impl IntoResponse, ApiError> {
    context.auth.logout(&caller.principal).await?;
    if caller.principal.user().is_some() {
        context.audit(&caller, "session.logout", "done", json!({})).await?;
    }
    Ok((StatusCode::NO_CONTENT, [(header::SET_COOKIE, cookie(&context, "", 0))]))
}

/// The old and the new password.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct PasswordChange {
    #[schema(max_length = 128, format = Password)]
    old: String,
    #[schema(min_length = 12, max_length = 128, format = Password)]
    new: String,
}

/// Changes one's own password and ends all other sessions of the user. A token has no password.
#[utoipa::path(put, path = "/api/v1/session/password", tag = "session", request_body = PasswordChange,
    responses((status = 204, description = "changed")))]
pub(super) async fn change_password(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Json(change): Json<PasswordChange>,
) -> Result<StatusCode, ApiError> {
    if caller.principal.user().is_none() {
        return Err(ApiError::conflict("a token has no password; log in with name and password"));
    }
    let changed =
        context.auth.change_password(caller.address, &caller.principal, change.old, change.new).await;
    let how = if changed.is_ok() { "done" } else { "refused" };
    context.audit(&caller, "session.password", how, json!({})).await?;
    changed?;
    Ok(StatusCode::NO_CONTENT)
}
