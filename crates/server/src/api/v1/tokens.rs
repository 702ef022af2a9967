//! API tokens, for admins.

use crate::api::extract::{Caller, Json, Path};
use crate::api::{ApiError, Context, Timestamp};
use crate::auth::{ApiToken, Grant};
use axum::extract::State;
use axum::http::StatusCode;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::sync::Arc;
use utoipa::ToSchema;

/// An API token without its secret.
#[derive(Serialize, ToSchema)]
#[schema(as = Token)]
pub(super) struct TokenJson {
    id: String,
    name: String,
    /// How the secret begins.
    prefix: String,
    grant: Grant,
    created_by: String,
    created: Timestamp,
    /// When it ends; null for never.
    expires: Option<Timestamp>,
    /// When it was revoked.
    revoked: Option<Timestamp>,
}

impl From<ApiToken> for TokenJson {
    fn from(token: ApiToken) -> Self {
        Self {
            id: token.id,
            name: token.name,
            prefix: token.prefix,
            grant: token.grant,
            created_by: token.created_by,
            created: token.created.into(),
            expires: token.expires.map(Timestamp),
            revoked: token.revoked.map(Timestamp),
        }
    }
}

/// A token to be made.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = NewToken)]
pub(super) struct NewTokenJson {
    #[schema(pattern = "^[a-z0-9._@-]{1,64}$")]
    name: String,
    grant: Grant,
    /// When it ends; never where it is not given.
    expires: Option<Timestamp>,
}

/// A token just made, with its secret, which is told once.
#[derive(Serialize, ToSchema)]
pub(super) struct MadeToken {
    token: TokenJson,
    secret: String,
}

/// All tokens, revoked ones too.
#[utoipa::path(get, path = "/api/v1/tokens", tag = "tokens", responses((status = 200, description = "by name", body = Vec<TokenJson>)))]
pub(super) async fn list(
    State(context): State<Arc<Context>>,
) -> Result<axum::Json<Vec<TokenJson>>, ApiError> {
    Ok(axum::Json(context.auth.tokens().await?.into_iter().map(TokenJson::from).collect()))
}

/// Makes a token; its secret is told in this answer alone.
#[utoipa::path(post, path = "/api/v1/tokens", tag = "tokens", request_body = NewTokenJson,
    responses((status = 201, description = "made", body = MadeToken)))]
pub(super) async fn add(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Json(new): Json<NewTokenJson>,
) -> Result<(StatusCode, axum::Json<MadeToken>), ApiError> {
    let expires = new.expires.map(|time| time.0);
    let made = context.auth.add_token(&caller.principal.name, &new.name, new.grant, expires).await?;
    let detail = json!({ "id": made.token.id, "name": made.token.name, "grant": made.token.grant });
    context.audit(&caller, "token.add", "done", detail).await?;
    let secret = made.secret.expose().into();
    Ok((StatusCode::CREATED, axum::Json(MadeToken { token: made.token.into(), secret })))
}

/// Revokes a token; it stays in the list.
#[utoipa::path(delete, path = "/api/v1/tokens/{id}", tag = "tokens", responses((status = 200, description = "revoked", body = TokenJson)))]
pub(super) async fn revoke(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Path(id): Path<String>,
) -> Result<axum::Json<TokenJson>, ApiError> {
    let token = context.auth.revoke_token(&id).await?;
    context.audit(&caller, "token.revoke", "done", json!({ "id": id, "name": token.name })).await?;
    Ok(axum::Json(token.into()))
}
