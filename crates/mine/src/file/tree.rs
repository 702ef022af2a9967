//! A file as values that know where they stood.

use crate::finding::{Place, Step};

/// Characters of a name or a text that a message repeats.
const SHOWN: usize = 64;

/// The beginning of a text, for a message.
pub fn shown(text: &str) -> String {
    text.chars().take(SHOWN).collect()
}

/// A value and the byte at which it begins.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    pub at: usize,
    pub value: Value,
}

/// What a file can say, in any of its forms.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    Null,
    Bool(bool),
    Integer(i64),
    Float(f64),
    Text(String),
    List(Vec<Node>),
    Table(Vec<Entry>),
}

/// A key, the byte at which it begins, and its value.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    pub key: String,
    pub at: usize,
    pub node: Node,
}

impl Entry {
    pub fn new(key: &str, at: usize, node: Node) -> Self {
        Self { key: key.to_owned(), at, node }
    }
}

impl Node {
    pub fn new(at: usize, value: Value) -> Self {
        Self { at, value }
    }

    /// The value of a key, in a table.
    pub fn get(&self, key: &str) -> Option<&Self> {
        self.entries().iter().find(|entry| entry.key == key).map(|entry| &entry.node)
    }

    /// An element, in a list.
    pub fn entry(&self, index: usize) -> Option<&Self> {
        self.elements().get(index)
    }

    /// Keys and values; none when it is no table.
    pub fn entries(&self) -> &[Entry] {
        if let Value::Table(entries) = &self.value { entries } else { &[] }
    }

    /// Elements; none when it is no list.
    pub fn elements(&self) -> &[Self] {
        if let Value::List(elements) = &self.value { elements } else { &[] }
    }

    /// Its text, where it is one.
    pub fn text(&self) -> Option<&str> {
        if let Value::Text(text) = &self.value { Some(text) } else { None }
    }

    /// The byte where a place stands; of what is not there, that of what should hold it.
    pub fn find(&self, place: &Place) -> usize {
        let mut here = self;
        for step in &place.0 {
            let next = match step {
                Step::Key(key) => here.get(key),
                Step::Entry(index) => here.entry(*index),
            };
            match next {
                Some(next) => here = next,
                None => break,
            }
        }
        here.at
    }

    /// What it is, for messages.
    pub fn describe(&self) -> String {
        match &self.value {
            Value::Null => "nothing".to_owned(),
            Value::Bool(flag) => flag.to_string(),
            Value::Integer(number) => number.to_string(),
            Value::Float(number) => number.to_string(),
            Value::Text(text) => {
                let start = shown(text);
                let more = if start.len() < text.len() { "…" } else { "" };
                format!("\"{start}{more}\"")
            }
            Value::List(elements) => format!("a list of {}", elements.len()),
            Value::Table(_) => "a table".to_owned(),
        }
    }

    /// As serde knows it; nulls in tables are left out.
    pub fn to_json(&self) -> serde_json::Value {
        use serde_json::Value as Json;
        match &self.value {
            Value::Null => Json::Null,
            Value::Bool(flag) => Json::Bool(*flag),
            Value::Integer(number) => Json::from(*number),
            Value::Float(number) => Json::from(*number),
            Value::Text(text) => Json::String(text.clone()),
            Value::List(elements) => elements.iter().map(Self::to_json).collect(),
            Value::Table(entries) => entries
                .iter()
                .filter(|entry| entry.node.value != Value::Null)
                .map(|entry| (entry.key.clone(), entry.node.to_json()))
                .collect(),
        }
    }
}
