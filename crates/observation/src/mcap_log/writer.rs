use crate::error::LogError;
use crate::files::AtomicFile;
use crate::observation::{Observation, ObservationKind};
use crate::protobuf::Messages;
use crate::protobuf::schema::{DESCRIPTORS, PROTOBUF, schema_name, topic};
use mcap::records::MessageHeader;
use mcap::write::NoSeek;
use mcap::{Compression, McapError, WriteOptions, Writer};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const CHUNK: u64 = 1 << 20;

/// Whether chunks are compressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Packing {
    /// By lz4: about half the size, read by every MCAP tool.
    #[default]
    Lz4,
    /// Not at all.
    Plain,
}

/// Writes an MCAP log observation by observation, in bounded memory; the file appears at [`McapLogWriter::finish`], and not
/// at all when dropped before.
pub struct McapLogWriter {
    writer: Writer<NoSeek<AtomicFile>>,
    target: PathBuf,
    channels: [Option<Channel>; ObservationKind::COUNT],
    messages: Messages,
    message: Vec<u8>,
}

#[derive(Clone, Copy)]
struct Channel {
    id: u16,
    sequence: u32,
}

impl McapLogWriter {
    /// Starts a file.
    pub fn create(path: impl AsRef<Path>, packing: Packing) -> Result<Self, LogError> {
        let target = path.as_ref().to_path_buf();
        let compression = match packing {
            Packing::Lz4 => Some(Compression::Lz4),
            Packing::Plain => None,
        };
        let writer = WriteOptions::new()
            .compression(compression)
            .chunk_size(Some(CHUNK))
            .library(concat!("adit/", env!("CARGO_PKG_VERSION")))
            .disable_seeking(true)
            .create(NoSeek::new(AtomicFile::create(&target)?))
            .map_err(|e| failed(&target, e))?;
        let channels = [None; ObservationKind::COUNT];
        Ok(Self { writer, target, channels, messages: Messages::default(), message: Vec::new() })
    }

    /// Writes one observation; one that could not be read back ([`Observation::fault`]) is refused.
    pub fn push(&mut self, observation: &Observation) -> Result<(), LogError> {
        if let Some((name, found, expected)) = observation.fault() {
            let time = observation.time();
            let what =
                format!("{:?} at {time} s: {name} is {found}, expected {expected}", observation.kind());
            return Err(LogError::CannotWrite { file: self.target.clone(), what });
        }
        self.message.clear();
        self.messages.encode(observation, &mut self.message);
        let channel = self.channel(observation.kind())?;
        // MCAP's own clock has no time before its origin; the message carries the exact one.
        let log_time = u64::try_from(observation.time().nanos()).unwrap_or(0);
        let header = MessageHeader {
            channel_id: channel.id,
            sequence: channel.sequence,
            log_time,
            publish_time: log_time,
        };
        self.writer.write_to_known_channel(&header, &self.message).map_err(|e| failed(&self.target, e))
    }

    fn channel(&mut self, kind: ObservationKind) -> Result<Channel, LogError> {
        let channel = if let Some(Channel { id, sequence }) = self.channels[kind as usize] {
            Channel { id, sequence: sequence.wrapping_add(1) }
        } else {
            let id = self
                .writer
                .add_schema(schema_name(kind), PROTOBUF, DESCRIPTORS)
                .and_then(|schema| self.writer.add_channel(schema, topic(kind), PROTOBUF, &BTreeMap::new()))
                .map_err(|e| failed(&self.target, e))?;
            Channel { id, sequence: 0 }
        };
        self.channels[kind as usize] = Some(channel);
        Ok(channel)
    }

    /// Completes the file and gives it its name.
    pub fn finish(mut self) -> Result<(), LogError> {
        self.writer.finish().map_err(|e| failed(&self.target, e))?;
        self.writer.into_inner().into_inner().finish()
    }
}

fn failed(target: &Path, error: McapError) -> LogError {
    match error {
        McapError::Io(source) => LogError::Io { file: target.to_path_buf(), doing: "write it", source },
        other => LogError::CannotWrite { file: target.to_path_buf(), what: other.to_string() },
    }
}
