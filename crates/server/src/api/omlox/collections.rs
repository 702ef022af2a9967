//! Zones, trackables, providers, fences: listed, put, removed, all four alike.

use super::fence_watch;
use super::objects::{mine_id, of_adit};
use super::shelf::{self, Kind, Object};
use crate::api::extract::Caller;
use crate::api::{ApiError, Context};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// All of a kind: what adit has, with what clients have put laid over it.
pub(super) async fn all(context: &Context, kind: Kind) -> Result<BTreeMap<String, Object>, ApiError> {
    let put = shelf::all(context, kind).await?;
    let mut objects = of_adit(context, kind);
    for (id, body) in put {
        objects.entry(id).or_default().extend(body);
    }
    Ok(objects)
}

pub(super) async fn one(context: &Context, kind: Kind, id: &str) -> Result<Value, ApiError> {
    let mut objects = all(context, kind).await?;
    let id = known_as(&objects, id).unwrap_or_else(|| id.to_owned());
    objects.remove(&id).map(Value::Object).ok_or_else(|| unknown(kind, &id))
}

/// The id as it is kept: MAC addresses with and without colons are the same.
fn known_as(objects: &BTreeMap<String, Object>, id: &str) -> Option<String> {
    let plain = |id: &str| id.replace([':', '-'], "").to_lowercase();
    if objects.contains_key(id) {
        return Some(id.to_owned());
    }
    let asked = plain(id);
    objects.keys().find(|known| plain(known) == asked).cloned()
}

pub(super) fn unknown(kind: Kind, id: &str) -> ApiError {
    ApiError::not_found(format!("no such object in {}: '{id}'", kind.name()))
}

/// Checks what an object must have, and gives it the id.
fn checked(
    context: &Context,
    kind: Kind,
    id: Option<&str>,
    mut body: Object,
) -> Result<(String, Object), ApiError> {
    let given = match body.get("id") {
        None => None,
        Some(Value::String(given)) if (1..=256).contains(&given.len()) => Some(given.clone()),
        Some(other) => {
            return Err(ApiError::invalid(format!("id: expected a text of 1 to 256 bytes, found {other}")));
        }
    };
    let id = match (id, given) {
        (Some(path), Some(given)) if path != given => {
            return Err(ApiError::invalid(format!("id: expected '{path}' as in the path, found '{given}'")));
        }
        (Some(path), _) => path.to_owned(),
        (None, Some(given)) => given,
        (None, None) if kind == Kind::Providers => return Err(ApiError::invalid("id: a provider has one")),
        (None, None) => uuid::Uuid::new_v4().to_string(),
    };
    if kind == Kind::Fences {
        let local = body.get("crs").and_then(Value::as_str) == Some("local");
        if local && !body.contains_key("zone_id") {
            body.insert("zone_id".into(), json!(mine_id(&context.mine)));
        }
    } else if !body.get("type").is_some_and(Value::is_string) {
        return Err(ApiError::invalid("type: expected a text"));
    }
    if body.get("properties").is_some_and(|properties| !properties.is_object()) {
        return Err(ApiError::invalid("properties: expected an object"));
    }
    body.insert("id".into(), id.clone().into());
    Ok((id, body))
}

async fn store(
    context: &Context,
    caller: &Caller,
    kind: Kind,
    id: Option<&str>,
    body: Value,
) -> Result<Object, ApiError> {
    let Value::Object(body) = body else {
        return Err(ApiError::invalid("expected an object"));
    };
    let (id, body) = checked(context, kind, id, body)?;
    let fence = match kind {
        Kind::Fences => fence_watch::watched(context, &id, &body)?,
        _ => None,
    };
    let replaced = shelf::put(context, kind, &id, &body).await?;
    if let Some(fence) = fence {
        context.fences.put(fence);
    }
    let what = format!("omlox.{}.put", kind.name());
    context.audit(caller, &what, "done", json!({ "id": id, "replaced": replaced })).await?;
    Ok(body)
}

async fn take(context: &Context, caller: &Caller, kind: Kind, id: &str) -> Result<(), ApiError> {
    if !shelf::remove(context, kind, id).await? {
        return Err(if of_adit(context, kind).contains_key(id) {
            ApiError::conflict(format!("'{id}' is kept by adit: remove it by /api/v1"))
        } else {
            unknown(kind, id)
        });
    }
    if kind == Kind::Fences {
        context.fences.remove(id);
    }
    context.audit(caller, &format!("omlox.{}.remove", kind.name()), "done", json!({ "id": id })).await
}

async fn take_all(context: &Context, caller: &Caller, kind: Kind) -> Result<(), ApiError> {
    let count = shelf::clear(context, kind).await?;
    if kind == Kind::Fences {
        context.fences.clear();
    }
    context.audit(caller, &format!("omlox.{}.clear", kind.name()), "done", json!({ "count": count })).await
}

macro_rules! collection {
    ($name:ident, $kind:expr, $put:expr, $put_status:literal, $all:literal, $summary:literal, $one:literal) => {
        #[doc = concat!("The routes of `", $all, "`.")]
        pub(super) mod $name {
            use super::{all, one, store, take, take_all};
            use crate::api::extract::{Caller, Json, Path};
            use crate::api::omlox::shelf::Kind;
            use crate::api::{ApiError, Context};
            use axum::extract::State;
            use axum::http::StatusCode;
            use serde_json::Value;
            use std::sync::Arc;

            const KIND: Kind = $kind;

            /// Ids of all.
            #[utoipa::path(get, path = $all, tag = "omlox",
                responses((status = 200, description = "ids", body = Vec<String>)))]
            pub(in crate::api::omlox) async fn ids(
                State(context): State<Arc<Context>>,
            ) -> Result<axum::Json<Vec<String>>, ApiError> {
                Ok(axum::Json(all(&context, KIND).await?.into_keys().collect()))
            }

            /// Adds one.
            #[utoipa::path(post, path = $all, tag = "omlox",
                request_body = Object, responses((status = 201, description = "added", body = Object)))]
            pub(in crate::api::omlox) async fn add(
                State(context): State<Arc<Context>>,
                caller: Caller,
                Json(body): Json<Value>,
            ) -> Result<(StatusCode, axum::Json<Value>), ApiError> {
                let added = store(&context, &caller, KIND, None, body).await?;
                Ok((StatusCode::CREATED, axum::Json(Value::Object(added))))
            }

            /// Removes all that clients have put; what adit itself has stays.
            #[utoipa::path(delete, path = $all, tag = "omlox",
                responses((status = 204, description = "removed")))]
            pub(in crate::api::omlox) async fn clear(
                State(context): State<Arc<Context>>,
                caller: Caller,
            ) -> Result<StatusCode, ApiError> {
                take_all(&context, &caller, KIND).await.map(|()| StatusCode::NO_CONTENT)
            }

            /// All objects.
            #[utoipa::path(get, path = $summary, tag = "omlox",
                responses((status = 200, description = "objects", body = Vec<Object>)))]
            pub(in crate::api::omlox) async fn summary(
                State(context): State<Arc<Context>>,
            ) -> Result<axum::Json<Vec<Value>>, ApiError> {
                Ok(axum::Json(all(&context, KIND).await?.into_values().map(Value::Object).collect()))
            }

            /// One object.
            #[utoipa::path(get, path = $one, tag = "omlox",
                responses((status = 200, description = "the object", body = Object)))]
            pub(in crate::api::omlox) async fn show(
                State(context): State<Arc<Context>>,
                Path(id): Path<String>,
            ) -> Result<axum::Json<Value>, ApiError> {
                one(&context, KIND, &id).await.map(axum::Json)
            }

            /// Puts one, in the place of what was put before.
            #[utoipa::path(put, path = $one, tag = "omlox",
                request_body = Object, responses((status = $put_status, description = "put")))]
            pub(in crate::api::omlox) async fn put(
                State(context): State<Arc<Context>>,
                caller: Caller,
                Path(id): Path<String>,
                Json(body): Json<Value>,
            ) -> Result<axum::response::Response, ApiError> {
                let body = store(&context, &caller, KIND, Some(&id), body).await?;
                Ok($put(body))
            }

            /// Removes one that a client has put.
            #[utoipa::path(delete, path = $one, tag = "omlox",
                responses((status = 204, description = "removed")))]
            pub(in crate::api::omlox) async fn remove(
                State(context): State<Arc<Context>>,
                caller: Caller,
                Path(id): Path<String>,
            ) -> Result<StatusCode, ApiError> {
                take(&context, &caller, KIND, &id).await.map(|()| StatusCode::NO_CONTENT)
            }
        }
    };
}

fn nothing(_: Object) -> axum::response::Response {
    use axum::response::IntoResponse as _;
    axum::http::StatusCode::NO_CONTENT.into_response()
}

fn the_object(body: Object) -> axum::response::Response {
    use axum::response::IntoResponse as _;
    axum::Json(Value::Object(body)).into_response()
}

collection!(zones, Kind::Zones, super::nothing, 204, "/v2/zones", "/v2/zones/summary", "/v2/zones/{id}");
collection!(
    trackables,
    Kind::Trackables,
    super::the_object,
    200,
    "/v2/trackables",
    "/v2/trackables/summary",
    "/v2/trackables/{id}"
);
collection!(
    providers,
    Kind::Providers,
    super::nothing,
    204,
    "/v2/providers",
    "/v2/providers/summary",
    "/v2/providers/{id}"
);
collection!(fences, Kind::Fences, super::nothing, 204, "/v2/fences", "/v2/fences/summary", "/v2/fences/{id}");
