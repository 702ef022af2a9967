//! People: as entered, and as known now.

use crate::api::extract::{Caller, Json, Path};
use crate::api::view::{LiveJson, PersonJson};
use crate::api::{ApiError, Context};
use adit_tracking::{Command, Person};
use axum::extract::State;
use axum::http::StatusCode;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::sync::Arc;
use utoipa::ToSchema;

/// Somebody who may go below, as entered.
#[derive(Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = Person)]
pub(in crate::api) struct PersonBody {
    /// A number of the staff, say.
    #[schema(min_length = 1, max_length = 128)]
    id: String,
    #[schema(max_length = 256)]
    name: String,
    team: Option<String>,
    /// How to reach them or their next of kin.
    contact: Option<String>,
    /// The shift they work in, as the mine calls it.
    shift: Option<String>,
    /// How long they may be below, h; the rule's where it is not given.
    #[schema(minimum = 0)]
    shift_limit_h: Option<f64>,
    /// Ids of the restricted zones that they may enter.
    #[serde(default)]
    #[schema(value_type = Vec<String>)]
    allowed_zones: BTreeSet<String>,
}

impl From<Person> for PersonBody {
    fn from(person: Person) -> Self {
        Self {
            id: person.id,
            name: person.name,
            team: person.team,
            contact: person.contact,
            shift: person.shift,
            shift_limit_h: person.shift_limit_h,
            allowed_zones: person.allowed_zones,
        }
    }
}

impl From<PersonBody> for Person {
    fn from(body: PersonBody) -> Self {
        Self {
            id: body.id,
            name: body.name,
            team: body.team,
            contact: body.contact,
            shift: body.shift,
            shift_limit_h: body.shift_limit_h,
            allowed_zones: body.allowed_zones,
        }
    }
}

/// Everybody who is entered, with where they are.
#[utoipa::path(get, path = "/api/v1/people", tag = "people", responses((status = 200, description = "by id", body = Vec<PersonJson>)))]
pub(super) async fn list(State(context): State<Arc<Context>>) -> axum::Json<Vec<PersonJson>> {
    axum::Json(context.tracking().people().map(PersonJson::from).collect())
}

/// Enters a person.
#[utoipa::path(post, path = "/api/v1/people", tag = "people", request_body = PersonBody,
    responses((status = 201, description = "entered", body = PersonJson)))]
pub(super) async fn add(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Json(body): Json<PersonBody>,
) -> Result<(StatusCode, axum::Json<PersonJson>), ApiError> {
    let id = body.id.clone();
    context.command(&caller, Command::CreatePerson { person: body.into() }).await?;
    Ok((StatusCode::CREATED, axum::Json(find(&context, &id)?)))
}

/// One person with all that is known.
#[utoipa::path(get, path = "/api/v1/people/{id}", tag = "people", responses((status = 200, description = "the person", body = PersonJson)))]
pub(super) async fn show(
    State(context): State<Arc<Context>>,
    Path(id): Path<String>,
) -> Result<axum::Json<PersonJson>, ApiError> {
    Ok(axum::Json(find(&context, &id)?))
}

/// Replaces what is entered of a person; the id stays.
#[utoipa::path(put, path = "/api/v1/people/{id}", tag = "people", request_body = PersonBody,
    responses((status = 200, description = "as it is now", body = PersonJson)))]
pub(super) async fn change(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Path(id): Path<String>,
    Json(body): Json<PersonBody>,
) -> Result<axum::Json<PersonJson>, ApiError> {
    super::same_id(&id, &body.id)?;
    context.command(&caller, Command::ChangePerson { person: body.into() }).await?;
    Ok(axum::Json(find(&context, &id)?))
}

/// Removes a person who is not below and wears no tag.
#[utoipa::path(delete, path = "/api/v1/people/{id}", tag = "people", responses((status = 204, description = "removed")))]
pub(super) async fn remove(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Path(id): Path<String>,
) -> Result<StatusCode, ApiError> {
    context.command(&caller, Command::RemovePerson { person: id }).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// What somebody says to what they do.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::api) struct Remark {
    #[serde(default)]
    #[schema(max_length = 2000)]
    pub note: String,
}

/// The person was seen outside, whatever the tags say.
#[utoipa::path(post, path = "/api/v1/people/{id}/out", tag = "people", request_body = Remark,
    responses((status = 200, description = "out", body = PersonJson)))]
pub(super) async fn mark_out(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Path(id): Path<String>,
    Json(remark): Json<Remark>,
) -> Result<axum::Json<PersonJson>, ApiError> {
    context.command(&caller, Command::MarkOut { person: id.clone(), note: remark.note }).await?;
    Ok(axum::Json(find(&context, &id)?))
}

/// Everybody and everything that is below, people first: position, radius, quality, age, level, zones.
#[utoipa::path(get, path = "/api/v1/live", tag = "live", responses((status = 200, description = "who is below", body = Vec<LiveJson>)))]
pub(super) async fn below(State(context): State<Arc<Context>>) -> axum::Json<Vec<LiveJson>> {
    axum::Json(context.tracking().below().map(LiveJson::from).collect())
}

fn find(context: &Context, id: &str) -> Result<PersonJson, ApiError> {
    let person = context.tracking().person(id).map(PersonJson::from);
    person.ok_or_else(|| ApiError::not_found(format!("there is no person '{id}'")))
}
