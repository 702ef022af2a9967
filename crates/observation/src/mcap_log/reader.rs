use super::records::Records;
use crate::error::{At, LogError, shown};
use crate::files::Input;
use crate::observation::{Observation, ObservationKind};
use crate::protobuf::schema::{PROTOBUF, schema_name};
use crate::protobuf::{BadMessage, Messages};
use crate::source::LogSource;
use crate::warning::{LogWarning, Warnings};
use mcap::records::{Record, op};
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// Ignored topics listed by name; more are left out.
const TOPICS_LISTED: usize = 20;

/// Observations of an MCAP log; order and units are not checked here (see [`crate::open`]).
pub struct McapLog {
    records: Records,
    messages: Messages,
    topics: Vec<String>,
    schemas: HashMap<u16, Option<ObservationKind>>,
    channels: HashMap<u16, Option<ObservationKind>>,
    /// The topic from which each kind is taken.
    chosen: [Option<String>; ObservationKind::COUNT],
    ignored: Vec<String>,
}

impl McapLog {
    /// Reads from bytes that start with the MCAP magic; `topics` restricts what is read, empty means all.
    pub fn new(input: Input, topics: &[String]) -> Self {
        Self {
            records: Records::new(input),
            messages: Messages::default(),
            topics: topics.to_vec(),
            schemas: HashMap::new(),
            channels: HashMap::new(),
            chosen: [const { None }; ObservationKind::COUNT],
            ignored: Vec::new(),
        }
    }

    fn declare(&mut self, record: Declaration) -> Result<(), LogError> {
        match record {
            Declaration::Schema { id, name, encoding } => {
                let known = |kind: &ObservationKind| schema_name(*kind) == name && encoding == PROTOBUF;
                let kind = ObservationKind::ALL.into_iter().find(known);
                self.schemas.insert(id, kind);
            }
            Declaration::Channel { id, schema_id, topic, encoding } => {
                let schema = self.schemas.get(&schema_id).copied().flatten();
                let wanted = self.topics.is_empty() || self.topics.contains(&topic);
                let kind = schema.filter(|_| wanted && encoding == PROTOBUF);
                self.channels.insert(id, kind);
                match kind {
                    Some(kind) => self.choose(kind, topic)?,
                    None if wanted && self.ignored.len() < TOPICS_LISTED => {
                        let topic = shown(topic.as_bytes());
                        if !self.ignored.contains(&topic) {
                            self.ignored.push(topic);
                        }
                    }
                    None => {}
                }
            }
        }
        Ok(())
    }

    fn choose(&mut self, kind: ObservationKind, topic: String) -> Result<(), LogError> {
        match &self.chosen[kind as usize] {
            Some(first) if *first != topic => Err(LogError::AmbiguousTopic {
                place: self.records.place(),
                kind: schema_name(kind),
                topics: vec![shown(first.as_bytes()), shown(topic.as_bytes())],
            }),
            Some(_) => Ok(()),
            None => {
                self.chosen[kind as usize] = Some(topic);
                Ok(())
            }
        }
    }

    fn bad(&self, kind: ObservationKind, bad: BadMessage) -> LogError {
        let (what, found, expected) = bad.told(schema_name(kind));
        LogError::BadValue { place: self.records.place(), what, found, expected }
    }
}

/// What a schema or channel record says, of what matters here.
enum Declaration {
    Schema { id: u16, name: String, encoding: String },
    Channel { id: u16, schema_id: u16, topic: String, encoding: String },
}

enum Step {
    Declared(Declaration),
    Message(u16, Result<Observation, BadMessage>),
    Nothing,
    Corrupt(String),
}

impl LogSource for McapLog {
    fn next_observation(&mut self, warnings: &mut Warnings) -> Result<Option<(Observation, At)>, LogError> {
        loop {
            let Some((opcode, body)) = self.records.next()? else {
                if !self.ignored.is_empty() {
                    let place = crate::error::Place::new(self.records.file(), At::File);
                    let topics = std::mem::take(&mut self.ignored);
                    warnings.push(LogWarning::IgnoredTopics { place, topics });
                }
                return Ok(None);
            };
            match step(opcode, body, &self.channels, &mut self.messages) {
                Step::Nothing => {}
                Step::Declared(declaration) => self.declare(declaration)?,
                Step::Message(_, Ok(observation)) => return Ok(Some((observation, self.records.at()))),
                Step::Message(channel, Err(bad)) => {
                    let kind = self.channels.get(&channel).copied().flatten().unwrap_or(ObservationKind::Imu);
                    return Err(self.bad(kind, bad));
                }
                Step::Corrupt(what) => return Err(self.records.corrupt(what)),
            }
        }
    }

    fn file(&self) -> &Arc<Path> {
        self.records.file()
    }
}

fn step(
    opcode: u8,
    body: &[u8],
    channels: &HashMap<u16, Option<ObservationKind>>,
    messages: &mut Messages,
) -> Step {
    if !matches!(opcode, op::SCHEMA | op::CHANNEL | op::MESSAGE) {
        return Step::Nothing;
    }
    match mcap::parse_record(opcode, body) {
        Ok(Record::Schema { header, .. }) => Step::Declared(Declaration::Schema {
            id: header.id,
            name: header.name,
            encoding: header.encoding,
        }),
        Ok(Record::Channel(channel)) => Step::Declared(Declaration::Channel {
            id: channel.id,
            schema_id: channel.schema_id,
            topic: channel.topic,
            encoding: channel.message_encoding,
        }),
        Ok(Record::Message { header, data }) => match channels.get(&header.channel_id) {
            Some(Some(kind)) => Step::Message(header.channel_id, messages.decode(*kind, &data)),
            Some(None) => Step::Nothing,
            None => Step::Corrupt(format!("message on channel {}, which is not declared", header.channel_id)),
        },
        Ok(_) => Step::Nothing,
        Err(error) => Step::Corrupt(error.to_string()),
    }
}
