//! Users, for admins.

use crate::api::extract::{Caller, Json, Path};
use crate::api::{ApiError, Context, Timestamp};
use crate::auth::{Role, User, UserChange};
use axum::extract::State;
use axum::http::StatusCode;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::sync::Arc;
use utoipa::ToSchema;

/// A user.
#[derive(Serialize, ToSchema)]
#[schema(as = User)]
pub(super) struct UserJson {
    name: String,
    role: Role,
    /// May not log in.
    disabled: bool,
    /// Locked after wrong passwords until then.
    locked_until: Option<Timestamp>,
    created: Timestamp,
}

impl From<User> for UserJson {
    fn from(user: User) -> Self {
        let locked_until = user.locked_until.map(Timestamp);
        Self {
            name: user.name,
            role: user.role,
            disabled: user.disabled,
            locked_until,
            created: user.created.into(),
        }
    }
}

/// A user to be added.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct NewUser {
    #[schema(pattern = "^[a-z0-9._@-]{1,64}$")]
    name: String,
    role: Role,
    #[schema(min_length = 12, max_length = 128, format = Password)]
    password: String,
}

/// What is to be changed; what is missing stays.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct UserChangeJson {
    role: Option<Role>,
    /// A new password; it also unlocks.
    #[schema(min_length = 12, max_length = 128, format = Password)]
    password: Option<String>,
    disabled: Option<bool>,
}

/// All users.
#[utoipa::path(get, path = "/api/v1/users", tag = "users", responses((status = 200, description = "by name", body = Vec<UserJson>)))]
pub(super) async fn list(State(context): State<Arc<Context>>) -> Result<axum::Json<Vec<UserJson>>, ApiError> {
    Ok(axum::Json(context.auth.users().await?.into_iter().map(UserJson::from).collect()))
}

/// Adds a user.
#[utoipa::path(post, path = "/api/v1/users", tag = "users", request_body = NewUser,
    responses((status = 201, description = "added", body = UserJson)))]
pub(super) async fn add(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Json(new): Json<NewUser>,
) -> Result<(StatusCode, axum::Json<UserJson>), ApiError> {
    let user = context.auth.add_user(&new.name, new.role, new.password).await?;
    let detail = json!({ "name": user.name, "role": user.role });
    context.audit(&caller, "user.add", "done", detail).await?;
    Ok((StatusCode::CREATED, axum::Json(user.into())))
}

/// One user.
#[utoipa::path(get, path = "/api/v1/users/{name}", tag = "users", responses((status = 200, description = "the user", body = UserJson)))]
pub(super) async fn show(
    State(context): State<Arc<Context>>,
    Path(name): Path<String>,
) -> Result<axum::Json<UserJson>, ApiError> {
    Ok(axum::Json(context.auth.user(&name).await?.into()))
}

/// Changes role, password or whether the user may log in. A new role or password ends the user's sessions.
#[utoipa::path(patch, path = "/api/v1/users/{name}", tag = "users", request_body = UserChangeJson,
    responses((status = 200, description = "as it is now", body = UserJson)))]
pub(super) async fn change(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Path(name): Path<String>,
    Json(change): Json<UserChangeJson>,
) -> Result<axum::Json<UserJson>, ApiError> {
    let detail = json!({ "name": name, "role": change.role, "disabled": change.disabled, "password": change.password.is_some() });
    let change = UserChange { role: change.role, password: change.password, disabled: change.disabled };
    let user = context.auth.change_user(&name, change).await?;
    context.audit(&caller, "user.change", "done", detail).await?;
    Ok(axum::Json(user.into()))
}

/// Removes a user and ends their sessions.
#[utoipa::path(delete, path = "/api/v1/users/{name}", tag = "users", responses((status = 204, description = "removed")))]
pub(super) async fn remove(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Path(name): Path<String>,
) -> Result<StatusCode, ApiError> {
    context.auth.remove_user(&name).await?;
    context.audit(&caller, "user.remove", "done", json!({ "name": name })).await?;
    Ok(StatusCode::NO_CONTENT)
}
