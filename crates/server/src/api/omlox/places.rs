//! Where providers and trackables are, and in which fences.

use super::collections::{self, unknown};
use super::crs::Crs;
use super::location::{Of, PutLocation, feature, location, motion};
use super::objects::{fence, fence_id, mine_id, uuid_of};
use super::shelf::{self, Kind};
use crate::api::extract::{Json, Path, Query};
use crate::api::{ApiError, Context};
use adit_tracking::Subject;
use adit_tracking::view::{LastKnown, ZoneView};
use axum::extract::State;
use axum::http::StatusCode;
use serde::Deserialize;
use serde_json::{Value, json};
use std::sync::Arc;
use utoipa::IntoParams;

/// How locations are wanted. Other parameters of omlox are taken and have no effect.
#[derive(Debug, Default, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct Wanted {
    /// `local` (the mine's grid) or `EPSG:` and a code.
    crs: Option<String>,
    /// Only in this zone: its id or foreign id.
    zone_id: Option<String>,
    /// As a feature collection of `GeoJSON`.
    geojson: Option<bool>,
}

/// Somebody with their last known position.
struct Found {
    subject: Subject,
    last_known: LastKnown,
}

impl Found {
    fn of(&self) -> Of<'_> {
        Of { subject: &self.subject, last_known: &self.last_known }
    }
}

impl Wanted {
    fn crs(&self, context: &Context) -> Result<Crs, ApiError> {
        Crs::named(self.crs.as_deref(), &context.mine)
    }

    /// There is one zone: the mine.
    fn is_elsewhere(&self, context: &Context) -> bool {
        self.zone_id
            .as_deref()
            .is_some_and(|id| id != mine_id(&context.mine).to_string() && id != context.mine.plan().name)
    }

    fn locations(&self, context: &Context, found: &[Found]) -> Result<axum::Json<Value>, ApiError> {
        let crs = self.crs(context)?;
        let found = if self.is_elsewhere(context) { &[] } else { found };
        let locations = found.iter().filter_map(|found| location(context, &crs, &found.of()));
        Ok(axum::Json(if self.geojson == Some(true) {
            json!({ "type": "FeatureCollection", "features": locations.map(feature).collect::<Vec<_>>() })
        } else {
            Value::Array(locations.collect())
        }))
    }

    fn motions(&self, context: &Context, found: &[Found]) -> Result<axum::Json<Value>, ApiError> {
        let crs = self.crs(context)?;
        let found = if self.is_elsewhere(context) { &[] } else { found };
        Ok(axum::Json(found.iter().filter_map(|found| motion(context, &crs, &found.of())).collect()))
    }

    fn location(
        &self,
        context: &Context,
        found: Option<Found>,
        what: &str,
    ) -> Result<axum::Json<Value>, ApiError> {
        let crs = self.crs(context)?;
        let nowhere = || ApiError::not_found(format!("no location of '{what}' is known"));
        let found = found.ok_or_else(nowhere)?;
        let location = location(context, &crs, &found.of()).ok_or_else(nowhere)?;
        Ok(axum::Json(if self.geojson == Some(true) { feature(location) } else { location }))
    }
}

fn subject_of(tag: &str, person: Option<String>) -> Subject {
    person.map_or_else(|| Subject::Tag(tag.to_owned()), Subject::Person)
}

fn of_provider(context: &Context, id: &str) -> Option<Found> {
    let view = context.tracking().tag(id)?;
    Some(Found { subject: subject_of(id, view.person), last_known: view.last_known? })
}

fn of_all_providers(context: &Context) -> Vec<Found> {
    let tracking = context.tracking();
    let found = tracking.tags().filter_map(|view| {
        Some(Found { subject: subject_of(&view.tag.id, view.person), last_known: view.last_known? })
    });
    found.collect()
}

/// The person that a trackable is.
fn person_of(context: &Context, id: &str) -> Option<adit_tracking::view::PersonView> {
    context.tracking().people().find(|view| uuid_of("person", &view.person.id).to_string() == id)
}

/// Tags of a trackable: of a person, or those that a client has put.
pub(super) async fn providers_of(context: &Context, id: &str) -> Result<Vec<String>, ApiError> {
    if let Some(view) = person_of(context, id) {
        return Ok(view.tags);
    }
    let trackables = collections::all(context, Kind::Trackables).await?;
    let body = trackables.get(id).ok_or_else(|| unknown(Kind::Trackables, id))?;
    let providers = body.get("location_providers").and_then(Value::as_array);
    Ok(providers.into_iter().flatten().filter_map(Value::as_str).map(str::to_owned).collect())
}

async fn of_trackable(context: &Context, id: &str) -> Result<Vec<Found>, ApiError> {
    let providers = providers_of(context, id).await?;
    let mut found: Vec<Found> = providers.iter().filter_map(|tag| of_provider(context, tag)).collect();
    found.sort_by_key(|found| std::cmp::Reverse(found.last_known.time));
    Ok(found)
}

fn zone_of(context: &Context, id: &str) -> Option<ZoneView> {
    context.tracking().zones().into_iter().find(|view| {
        let zone = &view.live.zone.id;
        zone == id || fence_id(zone).to_string() == id
    })
}

/// Who is in a fence.
async fn in_fence(context: &Context, id: &str) -> Result<Vec<Found>, ApiError> {
    let inside = match zone_of(context, id) {
        Some(zone) => zone.inside.into_iter().collect(),
        None if collections::all(context, Kind::Fences).await?.contains_key(id) => context.fences.inside(id),
        None => return Err(unknown(Kind::Fences, id)),
    };
    let tracking = context.tracking();
    let found = inside.into_iter().filter_map(|subject| {
        let last_known = tracking.live(&subject)?.last_known?;
        Some(Found { subject, last_known })
    });
    Ok(found.collect())
}

/// Fences that somebody is in.
async fn fences_of(context: &Context, subject: &Subject) -> Result<axum::Json<Value>, ApiError> {
    let zones = context.tracking().zones();
    let inside = zones.iter().filter(|view| view.inside.contains(subject));
    let mut fences: Vec<Value> = inside.map(|view| fence(&context.mine, &view.live)).collect();
    let of_clients = context.fences.of(subject);
    if !of_clients.is_empty() {
        let mut put = shelf::all(context, Kind::Fences).await?;
        fences.extend(of_clients.iter().filter_map(|id| put.remove(id)).map(Value::Object));
    }
    Ok(axum::Json(Value::Array(fences)))
}

/// The last location of a provider.
#[utoipa::path(get, path = "/v2/providers/{id}/location", tag = "omlox", params(("id" = String, Path), Wanted),
    responses((status = 200, description = "a Location", body = Object)))]
pub(super) async fn provider_location(
    State(context): State<Arc<Context>>,
    Path(id): Path<String>,
    Query(wanted): Query<Wanted>,
) -> Result<axum::Json<Value>, ApiError> {
    wanted.location(&context, of_provider(&context, &id), &id)
}

/// A location that another system has found; the answer comes when it is on the disk.
#[utoipa::path(put, path = "/v2/providers/{id}/location", tag = "omlox", request_body = PutLocation,
    responses((status = 204, description = "stored")))]
pub(super) async fn put_location(
    State(context): State<Arc<Context>>,
    Path(id): Path<String>,
    Json(body): Json<PutLocation>,
) -> Result<StatusCode, ApiError> {
    context.door.position(body.report(&context.mine, &id)?).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// The last locations of all providers.
#[utoipa::path(get, path = "/v2/providers/locations", tag = "omlox", params(Wanted),
    responses((status = 200, description = "Locations, or a feature collection", body = serde_json::Value)))]
pub(super) async fn provider_locations(
    State(context): State<Arc<Context>>,
    Query(wanted): Query<Wanted>,
) -> Result<axum::Json<Value>, ApiError> {
    wanted.locations(&context, &of_all_providers(&context))
}

/// Several locations; all are checked before the first is stored.
#[utoipa::path(put, path = "/v2/providers/locations", tag = "omlox", request_body = Vec<PutLocation>,
    responses((status = 204, description = "stored")))]
pub(super) async fn put_locations(
    State(context): State<Arc<Context>>,
    Json(bodies): Json<Vec<PutLocation>>,
) -> Result<StatusCode, ApiError> {
    let mut reports = Vec::new();
    for body in bodies {
        let tag = body.provider().ok_or_else(|| ApiError::invalid("provider_id: is needed"))?.to_owned();
        reports.push(body.report(&context.mine, &tag)?);
    }
    for report in reports {
        context.door.position(report).await?;
    }
    Ok(StatusCode::NO_CONTENT)
}

/// The fences that a provider is in.
#[utoipa::path(get, path = "/v2/providers/{id}/fences", tag = "omlox",
    responses((status = 200, description = "Fences", body = Vec<Object>)))]
pub(super) async fn provider_fences(
    State(context): State<Arc<Context>>,
    Path(id): Path<String>,
) -> Result<axum::Json<Value>, ApiError> {
    let view = context.tracking().tag(&id).ok_or_else(|| unknown(Kind::Providers, &id))?;
    fences_of(&context, &subject_of(&id, view.person)).await
}

/// The trackables that a provider is of.
#[utoipa::path(get, path = "/v2/providers/{id}/trackables", tag = "omlox",
    responses((status = 200, description = "Trackables", body = Vec<Object>)))]
pub(super) async fn provider_trackables(
    State(context): State<Arc<Context>>,
    Path(id): Path<String>,
) -> Result<axum::Json<Value>, ApiError> {
    let trackables = collections::all(&context, Kind::Trackables).await?;
    let of = |body: &super::shelf::Object| {
        let providers = body.get("location_providers").and_then(Value::as_array);
        providers.is_some_and(|providers| providers.iter().any(|provider| provider == &id))
    };
    Ok(axum::Json(trackables.into_values().filter(of).map(Value::Object).collect()))
}

/// The newest location of a trackable.
#[utoipa::path(get, path = "/v2/trackables/{id}/location", tag = "omlox", params(("id" = String, Path), Wanted),
    responses((status = 200, description = "a Location", body = Object)))]
pub(super) async fn trackable_location(
    State(context): State<Arc<Context>>,
    Path(id): Path<String>,
    Query(wanted): Query<Wanted>,
) -> Result<axum::Json<Value>, ApiError> {
    let newest = of_trackable(&context, &id).await?.into_iter().next();
    wanted.location(&context, newest, &id)
}

/// The locations of all providers of a trackable, the newest first.
#[utoipa::path(get, path = "/v2/trackables/{id}/locations", tag = "omlox", params(("id" = String, Path), Wanted),
    responses((status = 200, description = "Locations, or a feature collection", body = serde_json::Value)))]
pub(super) async fn trackable_locations(
    State(context): State<Arc<Context>>,
    Path(id): Path<String>,
    Query(wanted): Query<Wanted>,
) -> Result<axum::Json<Value>, ApiError> {
    wanted.locations(&context, &of_trackable(&context, &id).await?)
}

/// The motion of a trackable that is a person.
#[utoipa::path(get, path = "/v2/trackables/{id}/motion", tag = "omlox", params(("id" = String, Path), Wanted),
    responses((status = 200, description = "a TrackableMotion", body = Object)))]
pub(super) async fn trackable_motion(
    State(context): State<Arc<Context>>,
    Path(id): Path<String>,
    Query(wanted): Query<Wanted>,
) -> Result<axum::Json<Value>, ApiError> {
    let found = of_trackable(&context, &id).await?;
    let nowhere = || ApiError::not_found(format!("no motion of '{id}' is known"));
    let crs = wanted.crs(&context)?;
    let motion = found.first().and_then(|found| motion(&context, &crs, &found.of()));
    motion.map(axum::Json).ok_or_else(nowhere)
}

/// The motions of all persons.
#[utoipa::path(get, path = "/v2/trackables/motions", tag = "omlox", params(Wanted),
    responses((status = 200, description = "TrackableMotions", body = Vec<Object>)))]
pub(super) async fn trackable_motions(
    State(context): State<Arc<Context>>,
    Query(wanted): Query<Wanted>,
) -> Result<axum::Json<Value>, ApiError> {
    let tracking = context.tracking();
    let found = tracking.people().filter_map(|view| {
        Some(Found { subject: Subject::Person(view.person.id), last_known: view.live.last_known? })
    });
    let found: Vec<Found> = found.collect();
    drop(tracking);
    wanted.motions(&context, &found)
}

/// The providers of a trackable.
#[utoipa::path(get, path = "/v2/trackables/{id}/providers", tag = "omlox",
    responses((status = 200, description = "LocationProviders", body = Vec<Object>)))]
pub(super) async fn trackable_providers(
    State(context): State<Arc<Context>>,
    Path(id): Path<String>,
) -> Result<axum::Json<Value>, ApiError> {
    let of = providers_of(&context, &id).await?;
    let providers = collections::all(&context, Kind::Providers).await?;
    let objects =
        providers.into_iter().filter(|(id, _)| of.contains(id)).map(|(_, body)| Value::Object(body));
    Ok(axum::Json(objects.collect()))
}

/// The fences that a trackable is in.
#[utoipa::path(get, path = "/v2/trackables/{id}/fences", tag = "omlox",
    responses((status = 200, description = "Fences", body = Vec<Object>)))]
pub(super) async fn trackable_fences(
    State(context): State<Arc<Context>>,
    Path(id): Path<String>,
) -> Result<axum::Json<Value>, ApiError> {
    let newest = of_trackable(&context, &id).await?.into_iter().next();
    match newest {
        Some(found) => fences_of(&context, &found.subject).await,
        None => Ok(axum::Json(json!([]))),
    }
}

/// The locations of all who are in a fence.
#[utoipa::path(get, path = "/v2/fences/{id}/locations", tag = "omlox", params(("id" = String, Path), Wanted),
    responses((status = 200, description = "Locations, or a feature collection", body = serde_json::Value)))]
pub(super) async fn fence_locations(
    State(context): State<Arc<Context>>,
    Path(id): Path<String>,
    Query(wanted): Query<Wanted>,
) -> Result<axum::Json<Value>, ApiError> {
    wanted.locations(&context, &in_fence(&context, &id).await?)
}

/// The providers that are in a fence.
#[utoipa::path(get, path = "/v2/fences/{id}/providers", tag = "omlox",
    responses((status = 200, description = "LocationProviders", body = Vec<Object>)))]
pub(super) async fn fence_providers(
    State(context): State<Arc<Context>>,
    Path(id): Path<String>,
) -> Result<axum::Json<Value>, ApiError> {
    let inside = in_fence(&context, &id).await?;
    let mut providers = collections::all(&context, Kind::Providers).await?;
    let objects =
        inside.iter().filter_map(|found| providers.remove(&found.last_known.tag)).map(Value::Object);
    Ok(axum::Json(objects.collect()))
}

/// The trackables that are in a fence.
#[utoipa::path(get, path = "/v2/fences/{id}/trackables", tag = "omlox",
    responses((status = 200, description = "Trackables", body = Vec<Object>)))]
pub(super) async fn fence_trackables(
    State(context): State<Arc<Context>>,
    Path(id): Path<String>,
) -> Result<axum::Json<Value>, ApiError> {
    let inside = in_fence(&context, &id).await?;
    let mut trackables = collections::all(&context, Kind::Trackables).await?;
    let ids = inside.iter().filter_map(|found| super::objects::trackable_of(&found.subject));
    Ok(axum::Json(ids.filter_map(|id| trackables.remove(&id.to_string())).map(Value::Object).collect()))
}

/// The motions of all who are in a fence.
#[utoipa::path(get, path = "/v2/fences/{id}/motions", tag = "omlox", params(("id" = String, Path), Wanted),
    responses((status = 200, description = "TrackableMotions", body = Vec<Object>)))]
pub(super) async fn fence_motions(
    State(context): State<Arc<Context>>,
    Path(id): Path<String>,
    Query(wanted): Query<Wanted>,
) -> Result<axum::Json<Value>, ApiError> {
    wanted.motions(&context, &in_fence(&context, &id).await?)
}
