//! Plan to text. A plan written and read again is the same plan, number for number.

use super::geojson::from_plan;
use crate::error::MineError;
use crate::plan::MinePlan;
use serde_json::{Map, Value as Json};
use std::fmt::Write as _;

/// Shorter values stay on one line, characters.
const ONE_LINE: usize = 100;

fn object(plan: &MinePlan) -> Result<Map<String, Json>, MineError> {
    match serde_json::to_value(plan) {
        Ok(Json::Object(object)) => Ok(object),
        Ok(_) => Err(MineError::CannotWrite { what: "a plan is a table".to_owned() }),
        Err(error) => Err(MineError::CannotWrite { what: error.to_string() }),
    }
}

/// As TOML, for people: a table for each entry, a line for each point of long lists.
pub fn to_toml(plan: &MinePlan) -> Result<String, MineError> {
    let mut text = String::new();
    let mut tables = String::new();
    for (key, value) in in_order(object(plan)?) {
        match &value {
            Json::Array(entries) if entries.first().is_some_and(Json::is_object) => {
                for entry in entries {
                    toml_table(&mut tables, &format!("[[{key}]]"), entry);
                }
            }
            Json::Object(_) => toml_table(&mut tables, &format!("[{key}]"), &value),
            _ => toml_pair(&mut text, &key, &value),
        }
    }
    Ok(text + &tables)
}

/// The keys of a plan in the order of its type, whatever order the map has.
fn in_order(mut object: Map<String, Json>) -> Vec<(String, Json)> {
    let order = [
        "format",
        "name",
        "snap_m",
        "grid",
        "levels",
        "roadways",
        "chambers",
        "junctions",
        "zones",
        "anchors",
        "access_points",
        "rfid_portals",
        "pillars",
        "doors",
        "conveyors",
        "vehicle_routes",
    ];
    let mut ordered: Vec<(String, Json)> = order.iter().filter_map(|key| object.remove_entry(*key)).collect();
    ordered.extend(object);
    ordered
}

fn toml_table(text: &mut String, header: &str, table: &Json) {
    // Writing to a String does not fail.
    let _ = writeln!(text, "\n{header}");
    let Some(table) = table.as_object() else { return };
    // What names an entry comes first, its geometry last.
    let rank = |key: &str| match key {
        "id" => 0,
        "name" => 1,
        "kind" => 2,
        "level" => 3,
        "points_m" | "outline_m" | "ends_m" | "points" => 5,
        _ => 4,
    };
    let mut pairs: Vec<(&String, &Json)> = table.iter().collect();
    pairs.sort_by_key(|(key, _)| rank(key));
    for (key, value) in pairs {
        toml_pair(text, key, value);
    }
}

fn toml_pair(text: &mut String, key: &str, value: &Json) {
    let short = toml_inline(value);
    match value {
        Json::Array(elements) if short.len() > ONE_LINE => {
            let _ = writeln!(text, "{key} = [");
            for element in elements {
                let _ = writeln!(text, "    {},", toml_inline(element));
            }
            text.push_str("]\n");
        }
        _ => {
            let _ = writeln!(text, "{key} = {short}");
        }
    }
}

fn toml_inline(value: &Json) -> String {
    match value {
        Json::Array(elements) => {
            format!("[{}]", elements.iter().map(toml_inline).collect::<Vec<_>>().join(", "))
        }
        Json::Object(table) => {
            let pairs: Vec<String> = table.iter().map(|(k, v)| format!("{k} = {}", toml_inline(v))).collect();
            format!("{{ {} }}", pairs.join(", "))
        }
        Json::String(text) => toml::Value::String(text.clone()).to_string(),
        // JSON's text of numbers and booleans is TOML's.
        other => other.to_string(),
    }
}

/// As JSON with the keys of the TOML form, a line for each entry.
pub fn to_json(plan: &MinePlan) -> Result<String, MineError> {
    let members: Vec<String> = in_order(object(plan)?)
        .into_iter()
        .map(|(key, value)| match &value {
            Json::Array(entries) => format!("  {}: {}", Json::from(key), lines(entries, 4)),
            _ => format!("  {}: {value}", Json::from(key)),
        })
        .collect();
    Ok(format!("{{\n{}\n}}\n", members.join(",\n")))
}

/// As `GeoJSON`, a line for each feature; outlines run counter-clockwise, as RFC 7946 wants them.
pub fn to_geojson(plan: &MinePlan) -> Result<String, MineError> {
    let (mine, features) = from_plan(object(&plan.clone().canonical())?);
    Ok(format!(
        "{{\n  \"type\": \"FeatureCollection\",\n  \"mine\": {mine},\n  \"features\": {}\n}}\n",
        lines(&features, 4)
    ))
}

fn lines(entries: &[Json], indent: usize) -> String {
    let inner: Vec<String> = entries.iter().map(|entry| format!("{:indent$}{entry}", "")).collect();
    format!("[\n{}\n{:outer$}]", inner.join(",\n"), "", outer = indent - 2)
}
