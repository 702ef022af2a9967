//! Zones, headcounts, gateways and anchors.

use crate::api::extract::{Caller, Json, Path};
use crate::api::view::{DeviceJson, HeadcountJson, ZoneJson};
use crate::api::{ApiError, Context};
use adit_mine::plan::{Zone, ZoneKind};
use adit_tracking::{Command, DeviceKind, LiveZone};
use axum::extract::State;
use axum::http::StatusCode;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::sync::Arc;
use utoipa::ToSchema;

/// A zone as it is watched.
#[derive(Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = Zone)]
pub(in crate::api) struct ZoneBody {
    #[schema(min_length = 1, max_length = 128)]
    id: String,
    name: Option<String>,
    #[schema(value_type = ZoneKindWord)]
    kind: ZoneKind,
    /// Id of the level it lies on.
    level: String,
    /// How many people it may hold.
    #[schema(value_type = Option<i64>, minimum = 0, maximum = 4_294_967_295_i64)]
    capacity: Option<u32>,
    /// Who was inside is outside only when this far from it, m.
    #[serde(default)]
    #[schema(minimum = 0)]
    exit_tolerance_m: f64,
    /// Who was inside is outside only after this long beyond the tolerance, s.
    #[serde(default)]
    #[schema(minimum = 0)]
    exit_delay_s: f64,
    /// Corners east, north, in order round the zone, the first not repeated, m.
    #[schema(min_items = 3)]
    outline_m: Vec<[f64; 2]>,
    /// Teams whose people may enter it when it is restricted.
    #[serde(default)]
    #[schema(value_type = Vec<String>)]
    allowed_teams: BTreeSet<String>,
}

/// What a zone means.
#[derive(ToSchema)]
#[schema(as = ZoneKind, rename_all = "kebab-case")]
#[expect(dead_code, reason = "the words of `ZoneKind`, for the file of the API")]
pub(in crate::api) enum ZoneKindWord {
    Restricted,
    Dangerous,
    Key,
    Refuge,
    Portal,
}

impl From<LiveZone> for ZoneBody {
    fn from(LiveZone { zone, allowed_teams }: LiveZone) -> Self {
        Self {
            id: zone.id,
            name: zone.name,
            kind: zone.kind,
            level: zone.level,
            capacity: zone.capacity,
            exit_tolerance_m: zone.exit_tolerance_m,
            exit_delay_s: zone.exit_delay_s,
            outline_m: zone.outline_m,
            allowed_teams,
        }
    }
}

impl From<ZoneBody> for LiveZone {
    fn from(body: ZoneBody) -> Self {
        let zone = Zone {
            id: body.id,
            name: body.name,
            kind: body.kind,
            level: body.level,
            capacity: body.capacity,
            exit_tolerance_m: body.exit_tolerance_m,
            exit_delay_s: body.exit_delay_s,
            outline_m: body.outline_m,
        };
        Self { zone, allowed_teams: body.allowed_teams }
    }
}

/// All zones, with who is in them.
#[utoipa::path(get, path = "/api/v1/zones", tag = "zones", responses((status = 200, description = "by id", body = Vec<ZoneJson>)))]
pub(super) async fn list(State(context): State<Arc<Context>>) -> axum::Json<Vec<ZoneJson>> {
    axum::Json(context.tracking().zones().into_iter().map(ZoneJson::from).collect())
}

/// Draws a zone.
#[utoipa::path(post, path = "/api/v1/zones", tag = "zones", request_body = ZoneBody,
    responses((status = 201, description = "drawn", body = ZoneJson)))]
pub(super) async fn add(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Json(body): Json<ZoneBody>,
) -> Result<(StatusCode, axum::Json<ZoneJson>), ApiError> {
    let id = body.id.clone();
    context.command(&caller, Command::CreateZone { zone: body.into() }).await?;
    Ok((StatusCode::CREATED, axum::Json(find(&context, &id)?)))
}

/// One zone, with who is in it.
#[utoipa::path(get, path = "/api/v1/zones/{id}", tag = "zones", responses((status = 200, description = "the zone", body = ZoneJson)))]
pub(super) async fn show(
    State(context): State<Arc<Context>>,
    Path(id): Path<String>,
) -> Result<axum::Json<ZoneJson>, ApiError> {
    Ok(axum::Json(find(&context, &id)?))
}

/// Replaces a zone; the id stays.
#[utoipa::path(put, path = "/api/v1/zones/{id}", tag = "zones", request_body = ZoneBody,
    responses((status = 200, description = "as it is now", body = ZoneJson)))]
pub(super) async fn change(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Path(id): Path<String>,
    Json(body): Json<ZoneBody>,
) -> Result<axum::Json<ZoneJson>, ApiError> {
    super::same_id(&id, &body.id)?;
    context.command(&caller, Command::ChangeZone { zone: body.into() }).await?;
    Ok(axum::Json(find(&context, &id)?))
}

/// Removes a zone.
#[utoipa::path(delete, path = "/api/v1/zones/{id}", tag = "zones", responses((status = 204, description = "removed")))]
pub(super) async fn remove(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Path(id): Path<String>,
) -> Result<StatusCode, ApiError> {
    context.command(&caller, Command::RemoveZone { zone: id }).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Takes the zones from the mine's plan again, in place of all that were edited.
#[utoipa::path(post, path = "/api/v1/zone-reset", tag = "zones", responses((status = 200, description = "the zones of the plan", body = Vec<ZoneJson>)))]
pub(super) async fn reset(
    State(context): State<Arc<Context>>,
    caller: Caller,
) -> Result<axum::Json<Vec<ZoneJson>>, ApiError> {
    context.command(&caller, Command::ResetZones).await?;
    Ok(list(State(context)).await)
}

fn find(context: &Context, id: &str) -> Result<ZoneJson, ApiError> {
    let zone = context.tracking().zone(id).map(ZoneJson::from);
    zone.ok_or_else(|| ApiError::not_found(format!("there is no zone '{id}'")))
}

/// How many are where.
#[utoipa::path(get, path = "/api/v1/headcount", tag = "live", responses((status = 200, description = "mine, levels, zones", body = HeadcountJson)))]
pub(super) async fn headcount(State(context): State<Arc<Context>>) -> axum::Json<HeadcountJson> {
    axum::Json(context.tracking().headcount().into())
}

/// Gateways and anchors that were ever heard of.
#[utoipa::path(get, path = "/api/v1/devices", tag = "live", responses((status = 200, description = "by kind and id", body = Vec<DeviceJson>)))]
pub(super) async fn devices(State(context): State<Arc<Context>>) -> axum::Json<Vec<DeviceJson>> {
    axum::Json(context.tracking().devices().map(DeviceJson::from).collect())
}

/// A gateway or an anchor was taken away for good.
#[utoipa::path(delete, path = "/api/v1/devices/{kind}/{id}", tag = "live",
    params(("kind" = String, Path, description = "`gateway` or `anchor`"), ("id" = String, Path)),
    responses((status = 204, description = "forgotten")))]
pub(super) async fn forget_device(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Path((kind, id)): Path<(String, String)>,
) -> Result<StatusCode, ApiError> {
    let kind = match kind.as_str() {
        "gateway" => DeviceKind::Gateway,
        "anchor" => DeviceKind::Anchor,
        other => {
            return Err(ApiError::not_found(format!("a device is a gateway or an anchor, found '{other}'")));
        }
    };
    context.command(&caller, Command::ForgetDevice { kind, id }).await?;
    Ok(StatusCode::NO_CONTENT)
}
