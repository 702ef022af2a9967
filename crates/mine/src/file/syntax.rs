//! Text to tree: TOML, JSON and CSV, with everything that is wrong as text.

use super::tree::{Entry, Node, Value, shown};
use super::{Form, Found, anchors_csv};
use crate::finding::Place;
use crate::problem::Problem;
use jsonc_parser::{CollectOptions, ParseOptions, ast, parse_to_ast};
use std::collections::BTreeSet;
use toml::de::{DeTable, DeValue};

/// Syntax errors told of one file.
const MOST: usize = 20;

/// The tree of a file; problems are added to `found`.
pub fn read(form: Form, bytes: &[u8], found: &mut Vec<Found>) -> Option<Node> {
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => text,
        Err(error) => {
            found.push(syntax(error.valid_up_to(), "not UTF-8 text"));
            return None;
        }
    };
    match form {
        Form::Toml => toml(text, found),
        Form::Json | Form::GeoJson => json(text, found),
        Form::AnchorsCsv => anchors_csv::read(text, found),
    }
}

/// Is this JSON text a `GeoJSON` feature collection?
pub fn is_feature_collection(bytes: &[u8]) -> bool {
    std::str::from_utf8(bytes)
        .ok()
        .and_then(|text| json(text, &mut Vec::new()))
        .is_some_and(|tree| tree.get("type").and_then(Node::text) == Some("FeatureCollection"))
}

pub fn syntax(at: usize, what: impl Into<String>) -> Found {
    // One line: parsers add hints on lines of their own.
    let what = what.into().lines().map(str::trim).collect::<Vec<_>>().join("; ");
    Found::new(at, Place::default(), Problem::Syntax { what })
}

fn toml(text: &str, found: &mut Vec<Found>) -> Option<Node> {
    let bare = text.strip_prefix('\u{feff}').unwrap_or(text);
    let shift = text.len() - bare.len();
    let (table, errors) = DeTable::parse_recoverable(bare);
    let mut last_line = None;
    for error in errors.iter().take(MOST) {
        let at = error.span().map_or(bare.len(), |span| span.start);
        // After the first on a line the parser gropes for its way back.
        let line = bare.bytes().take(at).filter(|byte| *byte == b'\n').count();
        if last_line.replace(line) != Some(line) {
            found.push(syntax(shift + at, error.message()));
        }
    }
    let tree = toml_table(table.get_ref(), 0, shift);
    found.is_empty().then_some(tree)
}

fn toml_table(table: &DeTable<'_>, at: usize, shift: usize) -> Node {
    let mut entries: Vec<Entry> = table
        .iter()
        .map(|(key, value)| {
            let node = toml_value(value.get_ref(), shift + value.span().start, shift);
            Entry::new(key.get_ref(), shift + key.span().start, node)
        })
        .collect();
    entries.sort_by_key(|entry| entry.at);
    Node::new(at, Value::Table(entries))
}

fn toml_value(value: &DeValue<'_>, at: usize, shift: usize) -> Node {
    let value = match value {
        DeValue::String(text) => Value::Text(text.to_string()),
        DeValue::Boolean(flag) => Value::Bool(*flag),
        DeValue::Integer(number) => i64::from_str_radix(number.as_str(), number.radix())
            .map_or_else(|_| Value::Text(number.as_str().to_owned()), Value::Integer),
        DeValue::Float(number) => {
            number.as_str().parse().map_or_else(|_| Value::Text(number.as_str().to_owned()), Value::Float)
        }
        DeValue::Datetime(time) => Value::Text(time.to_string()),
        DeValue::Array(values) => Value::List(
            values.iter().map(|v| toml_value(v.get_ref(), shift + v.span().start, shift)).collect(),
        ),
        DeValue::Table(table) => return toml_table(table, at, shift),
    };
    Node::new(at, value)
}

fn json(text: &str, found: &mut Vec<Found>) -> Option<Node> {
    let strict = ParseOptions {
        allow_comments: false,
        allow_loose_object_property_names: false,
        allow_trailing_commas: false,
        allow_missing_commas: false,
        allow_single_quoted_strings: false,
        allow_hexadecimal_numbers: false,
        allow_unary_plus_numbers: false,
        allow_bare_decimal_point_numbers: false,
        allow_non_finite_numbers: false,
        allow_extended_string_escapes: false,
    };
    let parsed = parse_to_ast(text, &CollectOptions::default(), &strict);
    let problem = match parsed.map(|parsed| parsed.value) {
        Ok(Some(value)) => {
            let tree = json_value(&value, found);
            return found.is_empty().then_some(tree);
        }
        Ok(None) => syntax(text.len(), "the file is empty"),
        Err(error) => syntax(error.range().start, error.kind().to_string()),
    };
    found.push(problem);
    None
}

fn json_value(value: &ast::Value<'_>, found: &mut Vec<Found>) -> Node {
    match value {
        ast::Value::NullKeyword(null) => Node::new(null.range.start, Value::Null),
        ast::Value::BooleanLit(flag) => Node::new(flag.range.start, Value::Bool(flag.value)),
        ast::Value::StringLit(text) => Node::new(text.range.start, Value::Text(text.value.to_string())),
        ast::Value::NumberLit(number) => {
            let integer = number.value.parse().map(Value::Integer);
            let value = integer.or_else(|_| number.value.parse().map(Value::Float));
            let value = value.unwrap_or_else(|_| Value::Text(number.value.to_owned()));
            Node::new(number.range.start, value)
        }
        ast::Value::Array(list) => {
            let elements = list.elements.iter().map(|element| json_value(element, found)).collect();
            Node::new(list.range.start, Value::List(elements))
        }
        ast::Value::Object(object) => {
            let mut entries: Vec<Entry> = Vec::with_capacity(object.properties.len());
            let mut known = BTreeSet::new();
            for property in &object.properties {
                let key = property.name.as_str();
                if !known.insert(key) {
                    let problem = Problem::RepeatedKey { key: shown(key) };
                    found.push(Found::new(property.range.start, Place::default(), problem));
                    continue;
                }
                let node = json_value(&property.value, found);
                entries.push(Entry::new(key, property.range.start, node));
            }
            Node::new(object.range.start, Value::Table(entries))
        }
    }
}
