//! Tags, and who wears which.

use crate::api::extract::{Caller, Json, Path};
use crate::api::view::TagJson;
use crate::api::{ApiError, Context, Timestamp};
use adit_tracking::{Command, Tag, TagKind, Worn};
use axum::extract::State;
use axum::http::StatusCode;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use utoipa::ToSchema;

/// A tag as entered.
#[derive(Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = Tag)]
pub(in crate::api) struct TagBody {
    /// As the tag sends it.
    #[schema(min_length = 1, max_length = 128)]
    id: String,
    /// What it is for; people where it is not given.
    #[serde(default)]
    #[schema(value_type = TagKindWord)]
    kind: TagKind,
    /// Where it is worn.
    #[schema(value_type = Option<WornWord>)]
    worn: Option<Worn>,
    /// Name for people: the number of a vehicle, say.
    name: Option<String>,
}

/// What a tag is for.
#[derive(ToSchema)]
#[schema(as = TagKind, rename_all = "kebab-case")]
#[expect(dead_code, reason = "the words of `TagKind`, for the file of the API")]
pub(in crate::api) enum TagKindWord {
    Person,
    Vehicle,
    Asset,
}

/// Where a tag is worn.
#[derive(ToSchema)]
#[schema(as = Worn, rename_all = "kebab-case")]
#[expect(dead_code, reason = "the words of `Worn`, for the file of the API")]
pub(in crate::api) enum WornWord {
    Foot,
    Waist,
    Helmet,
    Chest,
    Wrist,
    Pocket,
}

impl From<Tag> for TagBody {
    fn from(tag: Tag) -> Self {
        Self { id: tag.id, kind: tag.kind, worn: tag.worn, name: tag.name }
    }
}

impl From<TagBody> for Tag {
    fn from(body: TagBody) -> Self {
        Self { id: body.id, kind: body.kind, worn: body.worn, name: body.name }
    }
}

/// All tags that were entered or heard.
#[utoipa::path(get, path = "/api/v1/tags", tag = "tags", responses((status = 200, description = "by id", body = Vec<TagJson>)))]
pub(super) async fn list(State(context): State<Arc<Context>>) -> axum::Json<Vec<TagJson>> {
    axum::Json(context.tracking().tags().map(TagJson::from).collect())
}

/// Enters a tag; one that was heard before becomes registered.
#[utoipa::path(post, path = "/api/v1/tags", tag = "tags", request_body = TagBody,
    responses((status = 201, description = "entered", body = TagJson)))]
pub(super) async fn add(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Json(body): Json<TagBody>,
) -> Result<(StatusCode, axum::Json<TagJson>), ApiError> {
    let id = body.id.clone();
    context.command(&caller, Command::CreateTag { tag: body.into() }).await?;
    Ok((StatusCode::CREATED, axum::Json(find(&context, &id)?)))
}

/// One tag with all that is known.
#[utoipa::path(get, path = "/api/v1/tags/{id}", tag = "tags", responses((status = 200, description = "the tag", body = TagJson)))]
pub(super) async fn show(
    State(context): State<Arc<Context>>,
    Path(id): Path<String>,
) -> Result<axum::Json<TagJson>, ApiError> {
    Ok(axum::Json(find(&context, &id)?))
}

/// Replaces what is entered of a tag; the id stays.
#[utoipa::path(put, path = "/api/v1/tags/{id}", tag = "tags", request_body = TagBody,
    responses((status = 200, description = "as it is now", body = TagJson)))]
pub(super) async fn change(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Path(id): Path<String>,
    Json(body): Json<TagBody>,
) -> Result<axum::Json<TagJson>, ApiError> {
    super::same_id(&id, &body.id)?;
    context.command(&caller, Command::ChangeTag { tag: body.into() }).await?;
    Ok(axum::Json(find(&context, &id)?))
}

/// Removes a tag that nobody wears.
#[utoipa::path(delete, path = "/api/v1/tags/{id}", tag = "tags", responses((status = 204, description = "removed")))]
pub(super) async fn remove(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Path(id): Path<String>,
) -> Result<StatusCode, ApiError> {
    context.command(&caller, Command::RemoveTag { tag: id }).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Who is to wear a tag.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Assign {
    /// Id of the person.
    person: String,
    /// From when; from now on where it is not given or past.
    from: Option<Timestamp>,
    /// Until when; for good where it is not given.
    until: Option<Timestamp>,
}

/// Gives a tag to a person.
#[utoipa::path(post, path = "/api/v1/tags/{id}/assignments", tag = "tags", request_body = Assign,
    responses((status = 201, description = "given", body = TagJson)))]
pub(super) async fn assign(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Path(id): Path<String>,
    Json(body): Json<Assign>,
) -> Result<(StatusCode, axum::Json<TagJson>), ApiError> {
    let (from, until) = (body.from.map(|time| time.0), body.until.map(|time| time.0));
    context.command(&caller, Command::Assign { tag: id.clone(), person: body.person, from, until }).await?;
    Ok((StatusCode::CREATED, axum::Json(find(&context, &id)?)))
}

/// Takes a tag back now, and forgets assignments to come.
#[utoipa::path(delete, path = "/api/v1/tags/{id}/assignments", tag = "tags", responses((status = 200, description = "taken back", body = TagJson)))]
pub(super) async fn unassign(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Path(id): Path<String>,
) -> Result<axum::Json<TagJson>, ApiError> {
    context.command(&caller, Command::Unassign { tag: id.clone() }).await?;
    Ok(axum::Json(find(&context, &id)?))
}

fn find(context: &Context, id: &str) -> Result<TagJson, ApiError> {
    let tag = context.tracking().tag(id).map(TagJson::from);
    tag.ok_or_else(|| ApiError::not_found(format!("there is no tag '{id}'")))
}
