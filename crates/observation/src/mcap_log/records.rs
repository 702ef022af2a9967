//! Records of an MCAP file one by one, chunks opened, in bounded memory.

use crate::error::{At, LogError, Place, on_one_line};
use crate::files::{Input, read_error};
use flate2::Crc;
use mcap::McapError;
use mcap::records::{ChunkHeader, Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use std::io::Read;
use std::path::Path;
use std::sync::Arc;

/// The longest record or unpacked chunk accepted, bytes (MCAP writers make chunks of about 1 MiB).
pub const LARGEST_RECORD: usize = 1 << 25;

const READ_AT_ONCE: usize = 1 << 16;
/// Operation code (1 byte) and length (8 bytes) before each record.
const RECORD_HEAD: usize = 9;

/// The records of a file, also those inside chunks.
pub(super) struct Records {
    file: Arc<Path>,
    gzip: bool,
    input: Box<dyn Read + Send>,
    machine: LinearReader,
    /// Records read so far, those inside chunks too.
    number: u64,
    /// Offset of the record being read, and of the one after it.
    offset: u64,
    next_offset: u64,
    /// The open chunk, unpacked, and how much of it has been given out.
    chunk: Vec<u8>,
    given: usize,
    /// A record outside chunks.
    outer: Vec<u8>,
}

impl Records {
    pub(super) fn new(input: Input) -> Self {
        let Input { file, reader, gzip, .. } = input;
        let options = LinearReaderOptions::default()
            .with_emit_chunks(true)
            .with_record_length_limit(LARGEST_RECORD)
            .with_check_finishes_after_end_magic(true);
        let magic = super::MAGIC.len() as u64;
        Self {
            file,
            gzip,
            input: reader,
            machine: LinearReader::new_with_options(options),
            number: 0,
            offset: 0,
            next_offset: magic,
            chunk: Vec::new(),
            given: 0,
            outer: Vec::new(),
        }
    }

    pub(super) fn file(&self) -> &Arc<Path> {
        &self.file
    }

    pub(super) fn at(&self) -> At {
        At::Record { number: self.number, byte: self.offset }
    }

    pub(super) fn place(&self) -> Place {
        Place::new(&self.file, self.at())
    }

    pub(super) fn corrupt(&self, what: impl Into<String>) -> LogError {
        LogError::CorruptMcap { place: self.place(), what: on_one_line(&what.into()) }
    }

    /// The next record's operation code and body; `None` after the end mark.
    pub(super) fn next(&mut self) -> Result<Option<(u8, &[u8])>, LogError> {
        loop {
            if self.given < self.chunk.len() {
                let (opcode, start, end) = self.next_in_chunk()?;
                return Ok(Some((opcode, &self.chunk[start..end])));
            }
            match self.next_outside()? {
                None => return Ok(None),
                Some(op::CHUNK) => self.open_chunk()?,
                Some(opcode) => return Ok(Some((opcode, &self.outer))),
            }
        }
    }

    fn next_in_chunk(&mut self) -> Result<(u8, usize, usize), LogError> {
        self.number += 1;
        let rest = &self.chunk[self.given..];
        let record = rest.split_first_chunk::<RECORD_HEAD>().and_then(|(head, body)| {
            let [opcode, length @ ..] = *head;
            let length = usize::try_from(u64::from_le_bytes(length)).ok()?;
            (length <= body.len()).then_some((opcode, length))
        });
        let Some((opcode, length)) = record else {
            self.given = self.chunk.len();
            return Err(self.corrupt("the chunk ends inside this record"));
        };
        let start = self.given + RECORD_HEAD;
        self.given = start + length;
        Ok((opcode, start, self.given))
    }

    /// Fills `outer` with the next record outside chunks.
    fn next_outside(&mut self) -> Result<Option<u8>, LogError> {
        self.offset = self.next_offset;
        loop {
            match self.machine.next_event() {
                None => return Ok(None),
                Some(Ok(LinearReadEvent::ReadRequest(wanted))) => {
                    // In small steps: a length in a damaged file must not decide how much memory is taken.
                    let space = self.machine.insert(wanted.clamp(1, READ_AT_ONCE));
                    let read = loop {
                        match self.input.read(space) {
                            Err(e) if e.kind() == std::io::ErrorKind::Interrupted => {}
                            other => break other,
                        }
                    };
                    match read {
                        Ok(count) => self.machine.notify_read(count),
                        Err(source) => return Err(self.failed_read(source)),
                    }
                }
                Some(Ok(LinearReadEvent::Record { data, opcode })) => {
                    self.outer.clear();
                    self.outer.extend_from_slice(data);
                    self.number += 1;
                    self.next_offset = self.offset + (RECORD_HEAD + data.len()) as u64;
                    return Ok(Some(opcode));
                }
                Some(Err(error)) => return Err(self.explain(error)),
            }
        }
    }

    fn failed_read(&mut self, source: std::io::Error) -> LogError {
        self.number += 1;
        read_error(self.place(), self.gzip, source)
    }

    fn explain(&mut self, error: McapError) -> LogError {
        self.number += 1;
        let place = self.place();
        match error {
            McapError::UnexpectedEof => LogError::CutMcap { place },
            McapError::Io(source) => LogError::CorruptMcap { place, what: on_one_line(&source.to_string()) },
            other => LogError::CorruptMcap { place, what: on_one_line(&other.to_string()) },
        }
    }

    fn open_chunk(&mut self) -> Result<(), LogError> {
        let outer = std::mem::take(&mut self.outer);
        let unpacked = self.unpack(&outer);
        self.outer = outer;
        unpacked
    }

    fn unpack(&mut self, body: &[u8]) -> Result<(), LogError> {
        let (header, packed) = match mcap::parse_record(op::CHUNK, body) {
            Ok(Record::Chunk { header, data }) => (header, data),
            Ok(_) => return Err(self.corrupt("not a chunk")),
            Err(error) => return Err(self.corrupt(format!("chunk: {error}"))),
        };
        let claimed = usize::try_from(header.uncompressed_size).ok().filter(|size| *size <= LARGEST_RECORD);
        let Some(size) = claimed else {
            let size = header.uncompressed_size;
            return Err(self.corrupt(format!("chunk of {size} bytes, at most {LARGEST_RECORD} expected")));
        };
        self.chunk.clear();
        self.given = 0;
        if header.compression.is_empty() {
            self.chunk.extend_from_slice(&packed);
        } else {
            decompress(&header, body, size, &mut self.chunk)
                .map_err(|error| self.corrupt(format!("chunk: {error}")))?;
        }
        if self.chunk.len() != size {
            let found = self.chunk.len();
            return Err(self.corrupt(format!("chunk of {found} bytes, {size} expected")));
        }
        if header.uncompressed_crc != 0 {
            let mut crc = Crc::new();
            crc.update(&self.chunk);
            if crc.sum() != header.uncompressed_crc {
                let (found, expected) = (crc.sum(), header.uncompressed_crc);
                self.chunk.clear();
                return Err(self.corrupt(format!("chunk checksum {found:08x}, {expected:08x} expected")));
            }
        }
        Ok(())
    }
}

/// Unpacks a compressed chunk record through a second state machine.
///
/// Only compressed chunks take this way: on a plain chunk with a wrong length inside, mcap 0.26 computes a negative
/// remainder and panics.
fn decompress(
    header: &ChunkHeader,
    body: &[u8],
    size: usize,
    unpacked: &mut Vec<u8>,
) -> Result<(), McapError> {
    if header.compressed_size == 0 {
        return Ok(());
    }
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_record_length_limit(size.max(body.len()));
    let mut machine = LinearReader::new_with_options(options);
    let length = (body.len() as u64).to_le_bytes();
    let mut input = [op::CHUNK].as_slice().chain(length.as_slice()).chain(body);
    while let Some(event) = machine.next_event() {
        match event? {
            LinearReadEvent::ReadRequest(wanted) => {
                let count = input.read(machine.insert(wanted.clamp(1, READ_AT_ONCE)))?;
                machine.notify_read(count);
            }
            LinearReadEvent::Record { data, opcode } => {
                unpacked.push(opcode);
                unpacked.extend_from_slice(&(data.len() as u64).to_le_bytes());
                unpacked.extend_from_slice(data);
            }
        }
    }
    Ok(())
}
