//! `GeoJSON`: a feature for each entry of a plan that has a place, the rest in the member `mine`.
//!
//! | `feature` | geometry | key in a plan |
//! |---|---|---|
//! | `roadway`, `conveyor` | `LineString`, z | `points_m` |
//! | `door` | `LineString` of two points | `ends_m` |
//! | `chamber`, `zone`, `pillar` | `Polygon` of one ring | `outline_m` |
//! | `junction`, `anchor`, `access-point`, `rfid-portal` | `Point`, z | `position_m` |
//!
//! The feature's `id` is the entry's, its other keys are properties. Coordinates are those of the mine's grid, m, not
//! longitude and latitude: RFC 7946 (§4) leaves that to agreement, and the member `mine` is where it is written.

use super::Found;
use super::tree::{Entry, Node, Value, shown};
use crate::finding::Place;
use crate::problem::Problem;
use serde_json::{Map, Value as Json, json};

/// How an entry of a plan becomes a feature.
struct Kind {
    feature: &'static str,
    list: &'static str,
    key: &'static str,
    geometry: &'static str,
}

const fn kind(feature: &'static str, list: &'static str, key: &'static str, geometry: &'static str) -> Kind {
    Kind { feature, list, key, geometry }
}

const KINDS: [Kind; 10] = [
    kind("roadway", "roadways", "points_m", "LineString"),
    kind("chamber", "chambers", "outline_m", "Polygon"),
    kind("junction", "junctions", "position_m", "Point"),
    kind("zone", "zones", "outline_m", "Polygon"),
    kind("anchor", "anchors", "position_m", "Point"),
    kind("access-point", "access_points", "position_m", "Point"),
    kind("rfid-portal", "rfid_portals", "position_m", "Point"),
    kind("pillar", "pillars", "outline_m", "Polygon"),
    kind("door", "doors", "ends_m", "LineString"),
    kind("conveyor", "conveyors", "points_m", "LineString"),
];

/// Puts the features of a collection into the lists of a plan; every value keeps its place in the file.
pub fn to_plan(collection: Node, found: &mut Vec<Found>) -> Node {
    let mut plan: Vec<Entry> = Vec::new();
    let mut lists: Vec<(&Kind, Vec<Node>)> = KINDS.iter().map(|kind| (kind, Vec::new())).collect();
    let at = collection.at;
    let Value::Table(members) = collection.value else { return collection };
    for member in members {
        match (member.key.as_str(), member.node.value) {
            ("mine", Value::Table(entries)) => plan.extend(entries),
            ("features", Value::List(features)) => {
                for feature in &features {
                    match to_entry(feature) {
                        Ok((index, entry)) => lists[index].1.push(entry),
                        Err(what) => {
                            found.push(Found::new(
                                feature.at,
                                Place::default(),
                                Problem::BadFeature { what },
                            ));
                        }
                    }
                }
            }
            // Foreign members are free (RFC 7946, §6.1).
            _ => {}
        }
    }
    for (kind, entries) in lists {
        if let (Some(first), None) = (entries.first(), plan.iter().find(|entry| entry.key == kind.list)) {
            let first_at = first.at;
            plan.push(Entry::new(kind.list, first_at, Node::new(first_at, Value::List(entries))));
        }
    }
    Node::new(at, Value::Table(plan))
}

/// The entry that a feature stands for, and the place of its kind.
fn to_entry(feature: &Node) -> Result<(usize, Node), String> {
    let at = feature.at;
    let name = feature.get("properties").and_then(|p| p.get("feature")).and_then(Node::text);
    let known = || KINDS.map(|kind| kind.feature).join(", ");
    let name = name.ok_or_else(|| format!("property `feature` is missing, expected one of {}", known()))?;
    let index = KINDS.iter().position(|kind| kind.feature == name);
    let index = index.ok_or_else(|| format!("unknown \"{}\", expected one of {}", shown(name), known()))?;
    let kind = &KINDS[index];

    let geometry = feature.get("geometry");
    let found = geometry.and_then(|g| g.get("type")).and_then(Node::text).unwrap_or("no geometry");
    if found != kind.geometry {
        return Err(format!("found {}, expected a {} for a {name}", shown(found), kind.geometry));
    }
    let coordinates =
        geometry.and_then(|g| g.get("coordinates")).ok_or("a geometry without `coordinates`")?;
    let place = if kind.geometry == "Polygon" { ring(coordinates)? } else { coordinates.clone() };
    let place = Entry::new(kind.key, place.at, place);

    let mut entries = Vec::new();
    if let Some(id) = feature.get("id") {
        entries.push(Entry::new("id", id.at, id.clone()));
    }
    let properties = feature.get("properties").map_or(&[][..], Node::entries);
    // Programs with one table for all features write null for what a feature does not have.
    let own = properties.iter().filter(|entry| entry.key != "feature" && entry.node.value != Value::Null);
    for entry in own.cloned().chain([place]) {
        if ["id", kind.key].contains(&entry.key.as_str())
            && entries.iter().any(|known: &Entry| known.key == entry.key)
        {
            return Err(format!("`{}` stands in the properties and in the feature itself", entry.key));
        }
        entries.push(entry);
    }
    Ok((index, Node::new(at, Value::Table(entries))))
}

/// The outer ring of a polygon without the repeated corner.
fn ring(coordinates: &Node) -> Result<Node, String> {
    let [ring] = coordinates.elements() else {
        return Err(format!(
            "found {} rings, expected 1: an outline has no holes",
            coordinates.elements().len()
        ));
    };
    let corners = ring.elements();
    let [first, between @ .., last] = corners else { return Err("a ring without corners".to_owned()) };
    if first.to_json() != last.to_json() {
        return Err("the ring of a polygon must end where it begins".to_owned());
    }
    let open = std::iter::once(first).chain(between).cloned().collect();
    Ok(Node::new(ring.at, Value::List(open)))
}

/// The members of a collection: `mine` with what has no place, and the features.
pub fn from_plan(mut plan: Map<String, Json>) -> (Json, Vec<Json>) {
    let mut features = Vec::new();
    for kind in &KINDS {
        let Some(Json::Array(entries)) = plan.remove(kind.list) else { continue };
        for entry in entries {
            let Json::Object(mut entry) = entry else { continue };
            let id = entry.remove("id").unwrap_or_default();
            let mut coordinates = entry.remove(kind.key).unwrap_or_default();
            if kind.geometry == "Polygon" {
                let first = coordinates.get(0).cloned();
                if let (Json::Array(corners), Some(first)) = (&mut coordinates, first) {
                    corners.push(first);
                }
                coordinates = json!([coordinates]);
            }
            let mut properties = Map::new();
            properties.insert("feature".to_owned(), kind.feature.into());
            properties.append(&mut entry);
            features.push(json!({
                "type": "Feature",
                "id": id,
                "geometry": {"type": kind.geometry, "coordinates": coordinates},
                "properties": properties,
            }));
        }
    }
    (Json::Object(plan), features)
}
