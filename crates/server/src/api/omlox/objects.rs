//! What adit itself has, as objects of omlox.

use super::crs::{Crs, floor_of};
use super::shelf::{Kind, Object};
use crate::api::Context;
use adit_mine::Mine;
use adit_mine::plan::Grid;
use adit_tracking::{LiveZone, Person, Subject, TagKind, Tracking};
use serde_json::{Value, json};
use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;
use uuid::{Builder, Uuid};

/// The id in omlox of something of adit: the same for the same thing, in every mine of that name.
pub(super) fn uuid_of(kind: &str, id: &str) -> Uuid {
    let digest: [u8; 32] = Sha256::digest(format!("adit:{kind}:{id}")).into();
    let mut bytes = [0; 16];
    bytes.copy_from_slice(&digest[..16]);
    Builder::from_custom_bytes(bytes).into_uuid()
}

/// The trackable of whom a tag is of; none for a tag that nobody is known to wear.
pub(super) fn trackable_of(subject: &Subject) -> Option<Uuid> {
    match subject {
        Subject::Person(id) => Some(uuid_of("person", id)),
        Subject::Tag(_) => None,
    }
}

/// The omlox zone that is the mine.
pub(super) fn mine_id(mine: &Mine) -> Uuid {
    uuid_of("mine", &mine.plan().name)
}

/// All of a kind that adit has, by id.
pub(super) fn of_adit(context: &Context, kind: Kind) -> BTreeMap<String, Object> {
    let mine = &context.mine;
    let tracking = context.tracking();
    let objects: Vec<Value> = match kind {
        Kind::Zones => vec![zone_of_mine(mine)],
        Kind::Trackables => tracking.people().map(|view| trackable(&view.person, &view.tags)).collect(),
        Kind::Providers => providers(&tracking),
        Kind::Fences => tracking.zones().into_iter().map(|view| fence(mine, &view.live)).collect(),
    };
    let object = |value| match value {
        Value::Object(object) => {
            let id = object.get("id").and_then(Value::as_str)?.to_owned();
            Some((id, object))
        }
        _ => None,
    };
    objects.into_iter().filter_map(object).collect()
}

fn zone_of_mine(mine: &Mine) -> Value {
    let plan = mine.plan();
    let points: Vec<[f64; 2]> = match &plan.grid {
        Grid::ControlPoints { points, .. } => points
            .iter()
            .flat_map(|p| [[p.longitude_deg, p.latitude_deg], [p.grid_m.raw().x, p.grid_m.raw().y]])
            .collect(),
        _ => Vec::new(),
    };
    json!({
        "id": mine_id(mine), "type": "uwb", "foreign_id": plan.name, "name": plan.name,
        "incomplete_configuration": mine.georeference().is_none(), "ground_control_points": points,
        "properties": { "levels": plan.levels.iter().map(|level| json!({
            "id": level.id, "floor": floor_of(mine, &level.id), "elevation_m": level.elevation_m,
        })).collect::<Vec<_>>() },
    })
}

fn trackable(person: &Person, tags: &[String]) -> Value {
    json!({
        "id": uuid_of("person", &person.id), "type": "omlox", "name": person.name, "location_providers": tags,
        "properties": { "person": person.id, "team": person.team, "shift": person.shift },
    })
}

fn providers(tracking: &Tracking) -> Vec<Value> {
    let provider = |view: adit_tracking::view::TagView| {
        let kind = match view.tag.kind {
            TagKind::Person => "person",
            TagKind::Vehicle => "vehicle",
            TagKind::Asset => "asset",
        };
        json!({
            "id": view.tag.id, "type": "virtual", "name": view.tag.name.as_ref().unwrap_or(&view.tag.id),
            "properties": { "kind": kind, "registered": view.registered, "person": view.person },
        })
    };
    tracking.tags().map(provider).collect()
}

/// A zone of adit as a fence on the mine's grid.
pub(super) fn fence(mine: &Mine, live: &LiveZone) -> Value {
    let zone = &live.zone;
    let corners: Vec<[f64; 2]> = zone.outline_m.iter().chain(zone.outline_m.first()).copied().collect();
    json!({
        "id": fence_id(&zone.id), "foreign_id": zone.id, "name": zone.name.as_ref().unwrap_or(&zone.id),
        "region": { "type": "Polygon", "coordinates": [corners] }, "crs": Crs::Local.name(), "zone_id": mine_id(mine),
        "floor": floor_of(mine, &zone.level), "exit_tolerance": zone.exit_tolerance_m,
        "exit_delay": zone.exit_delay_s * 1000.0,
        "properties": { "zone": zone.id, "kind": crate::api::view::word(&zone.kind), "level": zone.level, "capacity": zone.capacity },
    })
}

/// The id of the fence that is a zone of adit.
pub(super) fn fence_id(zone: &str) -> Uuid {
    uuid_of("zone", zone)
}
