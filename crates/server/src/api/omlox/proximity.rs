//! Nearness that clients tell: somebody is near a reader or a beacon, which is a place with a radius.

use super::collections::{self, unknown};
use super::location::{Point, PutLocation};
use super::shelf::{self, Kind, Object};
use crate::api::extract::{Caller, Json, Path};
use crate::api::{ApiError, Context, Timestamp};
use crate::ingest::PositionReport;
use axum::extract::State;
use axum::http::StatusCode;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use std::sync::Arc;
use tokio::sync::broadcast;
use utoipa::ToSchema;

/// Told to those who have subscribed to `proximity_updates`, so many for one that is slow.
const KEPT: usize = 4096;

/// What clients of omlox tell of nearness, as it comes.
pub struct Proximities(broadcast::Sender<Arc<Value>>);

impl Default for Proximities {
    fn default() -> Self {
        Self(broadcast::channel(KEPT).0)
    }
}

impl Proximities {
    pub(super) fn subscribe(&self) -> broadcast::Receiver<Arc<Value>> {
        self.0.subscribe()
    }
}

/// Nearness as a client puts it; members that are not read are told on.
#[derive(Debug, Serialize, Deserialize, ToSchema)]
pub(super) struct PutProximity {
    /// What it is near: id or foreign id of a zone with `position` and `radius`, or the id of an anchor of the plan.
    source: String,
    provider_id: Option<String>,
    timestamp_generated: Option<Timestamp>,
    /// Radius that holds it with 95 %, m; that of the zone where it is not given.
    #[schema(minimum = 0)]
    accuracy: Option<f64>,
    #[serde(flatten)]
    #[schema(ignore)]
    rest: Map<String, Value>,
}

/// A zone that a client has put, by id or foreign id.
async fn zone(context: &Context, source: &str) -> Result<Option<Object>, ApiError> {
    let mut zones = shelf::all(context, Kind::Zones).await?;
    Ok(match zones.remove(source) {
        Some(zone) => Some(zone),
        None => zones.into_values().find(|zone| zone.get("foreign_id").is_some_and(|id| id == source)),
    })
}

/// Where somebody is who is near, as the journal takes it.
async fn report(context: &Context, near: &PutProximity, tag: &str) -> Result<PositionReport, ApiError> {
    let radius_m = |of_source: Option<f64>| {
        let needed = || ApiError::invalid("accuracy: is needed, since the source has no radius");
        near.accuracy.or(of_source).ok_or_else(needed)
    };
    if let Some(zone) = zone(context, &near.source).await? {
        let position = zone.get("position").cloned().unwrap_or_default();
        let position: Point = serde_json::from_value(position)
            .map_err(|_| ApiError::invalid(format!("source: the zone '{}' has no position", near.source)))?;
        let location = PutLocation {
            position,
            provider_id: None,
            timestamp_generated: near.timestamp_generated,
            crs: Some("EPSG:4326".into()),
            accuracy: Some(radius_m(zone.get("radius").and_then(Value::as_f64))?),
            floor: zone.get("floor").and_then(Value::as_f64),
            elevation_ref: None,
        };
        return location.report(&context.mine, tag);
    }
    let anchors = &context.mine.plan().anchors;
    let anchor = anchors.iter().find(|anchor| anchor.id.as_str() == near.source);
    let anchor = anchor.ok_or_else(|| unknown(Kind::Zones, &near.source))?;
    Ok(PositionReport {
        tag: tag.into(),
        time: near.timestamp_generated.map(|time| time.0),
        position_m: anchor.position_m,
        radius_95_m: Some(radius_m(None)?),
    })
}

async fn take(context: &Context, near: Vec<(String, PutProximity)>) -> Result<StatusCode, ApiError> {
    let mut reports = Vec::with_capacity(near.len());
    for (tag, near) in near {
        if let Some(other) = near.provider_id.as_deref().filter(|id| *id != tag) {
            return Err(ApiError::invalid(format!(
                "provider_id: expected '{tag}' as in the path, found '{other}'"
            )));
        }
        let report = report(context, &near, &tag).await?;
        let mut told = serde_json::to_value(&near).map_err(|error| ApiError::internal(&error))?;
        told["provider_id"] = tag.into();
        reports.push((report, Arc::new(told)));
    }
    for (report, told) in reports {
        context.door.position(report).await?;
        // Nobody has subscribed.
        let _ = context.proximities.0.send(told);
    }
    Ok(StatusCode::NO_CONTENT)
}

/// Somebody is near something: their position is that of the zone or anchor, within its radius. The answer comes when it is on the disk.
#[utoipa::path(put, path = "/v2/providers/{id}/proximity", tag = "omlox", operation_id = "put_proximity", request_body = PutProximity,
    params(("id" = String, Path)), responses((status = 204, description = "stored")))]
pub(super) async fn put_proximity(
    State(context): State<Arc<Context>>,
    Path(id): Path<String>,
    Json(near): Json<PutProximity>,
) -> Result<StatusCode, ApiError> {
    take(&context, vec![(id, near)]).await
}

/// Several; all are checked before the first is stored.
#[utoipa::path(put, path = "/v2/providers/proximities", tag = "omlox", operation_id = "put_proximities", request_body = Vec<PutProximity>,
    responses((status = 204, description = "stored")))]
pub(super) async fn put_proximities(
    State(context): State<Arc<Context>>,
    Json(near): Json<Vec<PutProximity>>,
) -> Result<StatusCode, ApiError> {
    let of = |near: PutProximity| {
        let tag = near.provider_id.clone().ok_or_else(|| ApiError::invalid("provider_id: is needed"))?;
        Ok((tag, near))
    };
    take(&context, near.into_iter().map(of).collect::<Result<_, ApiError>>()?).await
}

/// What the sensors of a provider say, as a client has put it.
#[utoipa::path(get, path = "/v2/providers/{id}/sensors", tag = "omlox", operation_id = "provider_sensors", params(("id" = String, Path)),
    responses((status = 200, description = "by name", body = Object)))]
pub(super) async fn provider_sensors(
    State(context): State<Arc<Context>>,
    Path(id): Path<String>,
) -> Result<axum::Json<Value>, ApiError> {
    Ok(axum::Json(sensors(collections::one(&context, Kind::Providers, &id).await?)))
}

fn sensors(mut provider: Value) -> Value {
    match provider.get_mut("sensors").map(Value::take) {
        Some(sensors @ Value::Object(_)) => sensors,
        _ => json!({}),
    }
}

/// Puts what the sensors of a provider say; those that are not named stay.
#[utoipa::path(put, path = "/v2/providers/{id}/sensors", tag = "omlox", operation_id = "put_sensors", request_body = Object,
    params(("id" = String, Path)), responses((status = 204, description = "put")))]
pub(super) async fn put_sensors(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Path(id): Path<String>,
    Json(said): Json<Map<String, Value>>,
) -> Result<StatusCode, ApiError> {
    let Value::Object(provider) = collections::one(&context, Kind::Providers, &id).await? else {
        return Err(unknown(Kind::Providers, &id));
    };
    let id = provider.get("id").and_then(Value::as_str).unwrap_or(&id).to_owned();
    let mut put = shelf::all(&context, Kind::Providers).await?.remove(&id).unwrap_or_default();
    put.insert("id".into(), id.clone().into());
    let mut all = match put.remove("sensors") {
        Some(Value::Object(sensors)) => sensors,
        _ => Map::new(),
    };
    all.extend(said);
    put.insert("sensors".into(), Value::Object(all));
    shelf::put(&context, Kind::Providers, &id, &put).await?;
    context.audit(&caller, "omlox.sensors.put", "done", json!({ "id": id })).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// What the sensors of a trackable's providers say, by provider.
#[utoipa::path(get, path = "/v2/trackables/{id}/sensors", tag = "omlox", operation_id = "trackable_sensors", params(("id" = String, Path)),
    responses((status = 200, description = "by provider", body = Object)))]
pub(super) async fn trackable_sensors(
    State(context): State<Arc<Context>>,
    Path(id): Path<String>,
) -> Result<axum::Json<Value>, ApiError> {
    let mut providers = collections::all(&context, Kind::Providers).await?;
    let of = super::places::providers_of(&context, &id).await?;
    let of = of.into_iter().filter_map(|id| Some((providers.remove(&id).map(Value::Object)?, id)));
    Ok(axum::Json(Value::Object(of.map(|(provider, id)| (id, sensors(provider))).collect())))
}
