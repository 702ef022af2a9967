//! Has the tree the shape of a plan? Held against the JSON Schema that the types themselves give.

use super::Found;
use super::tree::{Node, Value, shown};
use crate::finding::Place;
use crate::plan::MinePlan;
use crate::problem::Problem;
use serde_json::Value as Json;
use std::sync::LazyLock;

/// Units at the end of names that people may write for ours.
const UNITS: [&str; 32] = [
    "m", "mm", "cm", "dm", "km", "ft", "in", "yd", "mi", "s", "ms", "us", "ns", "min", "h", "deg", "rad",
    "percent", "permille", "dbm", "db", "mw", "w", "pa", "hpa", "kpa", "mbar", "m_s", "km_h", "kmh", "mph",
    "ppm",
];
/// After so many problems of shape the file is another kind of file.
const ENOUGH: usize = 1000;
/// Names offered when none is near.
const OFFERED: usize = 12;

static SCHEMA: LazyLock<Json> = LazyLock::new(|| schemars::schema_for!(MinePlan).to_value());

/// The JSON Schema of a mine file in its TOML and JSON forms.
pub fn schema() -> &'static Json {
    &SCHEMA
}

/// Adds everything about the tree that is not as the schema says.
pub fn walk(tree: &Node, found: &mut Vec<Found>) {
    Walk { found }.node(tree, schema(), &Place::default(), "the file");
}

struct Walk<'f> {
    found: &'f mut Vec<Found>,
}

impl Walk<'_> {
    fn report(&mut self, at: usize, place: &Place, problem: Problem) {
        self.found.push(Found::new(at, place.clone(), problem));
    }

    fn wrong(&mut self, node: &Node, place: &Place, key: &str, expected: &str) {
        let (key, expected) = (key.to_owned(), expected.to_owned());
        self.report(node.at, place, Problem::WrongType { key, found: node.describe(), expected });
    }

    fn node(&mut self, node: &Node, schema: &Json, place: &Place, key: &str) {
        let schema = resolved(schema);
        if let Some(variants) = schema["oneOf"].as_array() {
            return self.one_of(node, variants, place, key);
        }
        if let Some(words) = schema["enum"].as_array() {
            let words: Vec<&str> = words.iter().filter_map(Json::as_str).collect();
            return self.word(node, &words, place, key);
        }
        match kind(schema) {
            Some("object") => self.table(node, schema, place, key),
            Some("array") => self.list(node, schema, place, key),
            Some("number") => match node.value {
                Value::Integer(_) => {}
                Value::Float(number) if number.is_finite() => {}
                Value::Float(number) => {
                    let problem = Problem::NotFinite { key: key.to_owned(), found: number.to_string() };
                    self.report(node.at, place, problem);
                }
                _ => self.wrong(node, place, key, "a number"),
            },
            Some("integer") => match node.value {
                Value::Integer(number) if u32::try_from(number).is_ok() => {}
                _ => self.wrong(node, place, key, "a whole number, 0 or more"),
            },
            Some("string") if node.text().is_none() => self.wrong(node, place, key, "text"),
            Some("boolean") if !matches!(node.value, Value::Bool(_)) => {
                self.wrong(node, place, key, "true or false");
            }
            _ => {}
        }
    }

    /// An enumeration of words, or of tables told apart by their `kind`.
    fn one_of(&mut self, node: &Node, variants: &[Json], place: &Place, key: &str) {
        let words: Vec<&str> = variants.iter().filter_map(|v| v["const"].as_str()).collect();
        if words.len() == variants.len() {
            return self.word(node, &words, place, key);
        }
        if !matches!(node.value, Value::Table(_)) {
            return self.wrong(node, place, key, "a table");
        }
        let tag = |variant: &Json| variant["properties"]["kind"]["const"].as_str().map(str::to_owned);
        let Some(chosen) = node.get("kind") else {
            return self.report(node.at, place, Problem::MissingKey { key: "kind".to_owned() });
        };
        if let Some(variant) = variants.iter().find(|variant| tag(variant).as_deref() == chosen.text()) {
            self.table(node, variant, place, key);
        } else {
            let words: Vec<String> = variants.iter().filter_map(tag).collect();
            let words: Vec<&str> = words.iter().map(String::as_str).collect();
            self.word(chosen, &words, &place.clone().at("kind"), "kind");
        }
    }

    fn word(&mut self, node: &Node, words: &[&str], place: &Place, key: &str) {
        match node.text() {
            None => self.wrong(node, place, key, &format!("one of {}", words.join(", "))),
            Some(word) if words.contains(&word) => {}
            Some(word) => {
                let found = shown(word);
                let expected = words.iter().map(|w| (*w).to_owned()).collect();
                self.report(node.at, place, Problem::UnknownWord { key: key.to_owned(), found, expected });
            }
        }
    }

    fn list(&mut self, node: &Node, schema: &Json, place: &Place, key: &str) {
        let Value::List(elements) = &node.value else { return self.wrong(node, place, key, "a list") };
        let limit = |name: &str| schema[name].as_u64().and_then(|n| usize::try_from(n).ok());
        // A fixed length is a point or a pair; what a line needs is for the checks to say.
        if let (Some(least), Some(most)) = (limit("minItems"), limit("maxItems"))
            && !(least..=most).contains(&elements.len())
        {
            return self.wrong(node, place, key, &format!("a list of {most}"));
        }
        for (index, element) in elements.iter().enumerate() {
            let key = format!("{key}[{index}]");
            self.node(element, &schema["items"], &place.clone().nth(index), &key);
        }
    }

    fn table(&mut self, node: &Node, schema: &Json, place: &Place, key: &str) {
        let Value::Table(entries) = &node.value else { return self.wrong(node, place, key, "a table") };
        let Some(properties) = schema["properties"].as_object() else { return };
        let mut meant: Vec<&str> = Vec::new();
        for entry in entries {
            if self.found.len() > ENOUGH {
                return;
            }
            let place = place.clone().at(entry.key.clone());
            if let Some(schema) = properties.get(&entry.key) {
                if entry.node.value != Value::Null || !nullable(schema) {
                    self.node(&entry.node, schema, &place, &entry.key);
                }
                continue;
            }
            let known: Vec<&str> = properties.keys().map(String::as_str).collect();
            let key = shown(&entry.key);
            let problem = if let Some(expected) = same_quantity(&entry.key, &known) {
                meant.push(expected);
                Problem::WrongUnit { key, expected: expected.to_owned() }
            } else if let Some(nearest) = nearest(&entry.key, &known) {
                meant.push(nearest);
                Problem::UnknownKey { key, expected: vec![nearest.to_owned()] }
            } else {
                let offered = if known.len() <= OFFERED { known } else { Vec::new() };
                Problem::UnknownKey { key, expected: offered.into_iter().map(str::to_owned).collect() }
            };
            self.report(entry.at, &place, problem);
        }
        let required = schema["required"].as_array().into_iter().flatten().filter_map(Json::as_str);
        for name in required.filter(|name| node.get(name).is_none() && !meant.contains(name)) {
            let top = place.0.is_empty();
            let problem = if top && name == "grid" {
                Problem::MissingGrid {}
            } else {
                Problem::MissingKey { key: name.to_owned() }
            };
            self.report(node.at, place, problem);
        }
    }
}

/// Follows references, and leaves `null` out of what may be left out.
fn resolved(schema: &Json) -> &Json {
    let mut schema = schema;
    loop {
        if let Some(reference) = schema["$ref"].as_str() {
            let name = reference.rsplit('/').next().unwrap_or_default();
            schema = &SCHEMA["$defs"][name];
        } else if let Some(choices) = schema["anyOf"].as_array()
            && let Some(choice) = choices.iter().find(|choice| choice["type"] != "null")
        {
            schema = choice;
        } else {
            return schema;
        }
    }
}

fn kind(schema: &Json) -> Option<&str> {
    match &schema["type"] {
        Json::String(kind) => Some(kind),
        Json::Array(kinds) => kinds.iter().filter_map(Json::as_str).find(|kind| *kind != "null"),
        _ => None,
    }
}

fn nullable(schema: &Json) -> bool {
    let null = |kind: &Json| kind == "null";
    schema["type"].as_array().is_some_and(|kinds| kinds.iter().any(null))
        || schema["anyOf"].as_array().is_some_and(|choices| choices.iter().any(|c| null(&c["type"])))
}

/// The known name of the same quantity in our unit.
fn same_quantity<'k>(key: &str, known: &[&'k str]) -> Option<&'k str> {
    known.iter().copied().find(|name| {
        UNITS.iter().filter_map(|unit| name.strip_suffix(unit)?.strip_suffix('_')).any(|stem| {
            let rest = key.strip_prefix(stem);
            rest.is_some_and(|rest| {
                rest.is_empty() || rest.strip_prefix('_').is_some_and(|u| UNITS.contains(&u))
            })
        })
    })
}

/// The known name that was probably meant.
fn nearest<'k>(key: &str, known: &[&'k str]) -> Option<&'k str> {
    // Longer than any name by far: not worth a comparison.
    if key.len() > 100 {
        return None;
    }
    let distance = |name: &str| strsim::damerau_levenshtein(key, name);
    let best = known.iter().copied().min_by_key(|name| distance(name))?;
    (distance(best) <= 2.max(best.len() / 4)).then_some(best)
}
