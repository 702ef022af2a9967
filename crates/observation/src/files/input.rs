//! Bytes of a file or of any reader, gzip undone, progress counted.

use crate::error::{At, LogError, Place};
use flate2::read::MultiGzDecoder;
use std::fs::File;
use std::io::{self, BufReader, Cursor, Read};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// The longest line accepted in a text log, bytes; what is longer is not a log and must not fill the memory.
pub const LONGEST_LINE: usize = 1 << 16;

const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];
const BUFFER: usize = 1 << 16;
const PEEKED: usize = 8;

/// A source of bytes with a name. Gzip is recognised by its magic bytes, not by the name, and undone.
pub struct Input {
    /// Name for messages.
    pub file: Arc<Path>,
    /// First bytes (at most 8) after gzip is undone; they are still to come from [`Self::reader`].
    pub start: Vec<u8>,
    /// The bytes, gzip undone.
    pub reader: Box<dyn Read + Send>,
    /// True when gzip was undone.
    pub gzip: bool,
    read: Arc<AtomicU64>,
    total: Option<u64>,
}

impl Input {
    /// Opens a file.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, LogError> {
        let path = path.as_ref();
        let io = |doing, source| LogError::Io { file: path.to_path_buf(), doing, source };
        let file = File::open(path).map_err(|e| io("open it", e))?;
        let metadata = file.metadata().map_err(|e| io("open it", e))?;
        if metadata.is_dir() {
            return Err(io("read it", io::Error::from(io::ErrorKind::IsADirectory)));
        }
        let total = metadata.is_file().then_some(metadata.len());
        Self::new(Arc::from(path), Box::new(file), total)
    }

    /// From bytes in memory, under a name for messages.
    pub fn from_bytes(name: &str, bytes: &[u8]) -> Result<Self, LogError> {
        Self::new(Arc::from(Path::new(name)), Box::new(Cursor::new(bytes.to_vec())), Some(bytes.len() as u64))
    }

    /// From any reader, under a name for messages; `total` is its length where known.
    pub fn new(file: Arc<Path>, reader: Box<dyn Read + Send>, total: Option<u64>) -> Result<Self, LogError> {
        let read = Arc::new(AtomicU64::new(0));
        let counting: Box<dyn Read + Send> = Box::new(Counting { reader, read: Arc::clone(&read) });
        let fail = |gzip, source| read_error(Place::new(&file, At::Line(0)), gzip, source);
        let (start, plain) = peek(counting).map_err(|e| fail(false, e))?;
        let gzip = start.starts_with(&GZIP_MAGIC);
        let (start, reader) = if gzip {
            let unpacked = MultiGzDecoder::new(BufReader::with_capacity(BUFFER, plain));
            peek(Box::new(unpacked)).map_err(|e| fail(true, e))?
        } else {
            (start, plain)
        };
        Ok(Self { file, start, reader, gzip, read, total })
    }

    /// A handle that tells how many bytes of the file have been read so far, for a progress bar.
    pub fn progress(&self) -> (Arc<AtomicU64>, Option<u64>) {
        (Arc::clone(&self.read), self.total)
    }
}

struct Counting {
    reader: Box<dyn Read + Send>,
    read: Arc<AtomicU64>,
}

impl Read for Counting {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.reader.read(buffer)?;
        self.read.fetch_add(count as u64, Ordering::Relaxed);
        Ok(count)
    }
}

/// The first bytes, and a reader that still gives them.
fn peek(mut reader: Box<dyn Read + Send>) -> io::Result<(Vec<u8>, Box<dyn Read + Send>)> {
    let mut start = Vec::with_capacity(PEEKED);
    reader.by_ref().take(PEEKED as u64).read_to_end(&mut start)?;
    Ok((start.clone(), Box::new(Cursor::new(start).chain(reader))))
}

/// Turns an error of a reader made by [`Input`] into one with a place: the last line or record that was good.
pub(crate) fn read_error(place: Place, gzip: bool, source: io::Error) -> LogError {
    if source.get_ref().is_some_and(<dyn std::error::Error + Send + Sync>::is::<TooLong>) {
        return LogError::LineTooLong { place, limit: LONGEST_LINE };
    }
    match source.kind() {
        io::ErrorKind::UnexpectedEof if gzip => LogError::CutGzip { place },
        io::ErrorKind::InvalidInput | io::ErrorKind::InvalidData if gzip => {
            LogError::CorruptGzip { place, what: source.to_string() }
        }
        _ => LogError::Io { file: place.file.to_path_buf(), doing: "read it", source },
    }
}

#[derive(Debug, thiserror::Error)]
#[error("line too long")]
struct TooLong;

/// Passes bytes through and fails where a line grows past [`LONGEST_LINE`].
pub(crate) struct LineLimit {
    reader: Box<dyn Read + Send>,
    since_newline: usize,
}

impl LineLimit {
    pub(crate) fn new(reader: Box<dyn Read + Send>) -> Self {
        Self { reader, since_newline: 0 }
    }
}

impl Read for LineLimit {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        // A read is never longer than a line may be, so that looking for the last newline in it is enough.
        let limit = buffer.len().min(LONGEST_LINE);
        let count = self.reader.read(&mut buffer[..limit])?;
        match buffer[..count].iter().rposition(|b| *b == b'\n') {
            Some(last) => self.since_newline = count - 1 - last,
            None => self.since_newline += count,
        }
        if self.since_newline > LONGEST_LINE {
            return Err(io::Error::new(io::ErrorKind::InvalidData, TooLong));
        }
        Ok(count)
    }
}
