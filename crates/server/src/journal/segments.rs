//! The files of the journal.

use super::Position;
use super::entry::Entry;
use crate::error::ServerError;
use prost::Message;
use prost::bytes::Bytes;
use std::fs::{self, File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// First bytes of each file.
pub const HEAD: &[u8; 8] = b"aditjnl1";
/// A file is closed when it is longer, bytes.
const SEGMENT_BYTES: u64 = 64 << 20;
/// No body is longer, bytes: the largest batch that is taken is a quarter of it.
const LARGEST_BODY: usize = 64 << 20;
/// Length and CRC.
const RECORD_HEAD: usize = 8;

/// The journal of one folder, open to append.
pub struct Journal {
    folder: PathBuf,
    /// First positions of the files, in order.
    segments: Vec<Position>,
    last: Option<Open>,
    next: Position,
    buffer: Vec<u8>,
}

struct Open {
    file: File,
    bytes: u64,
}

impl Journal {
    /// Opens the journal of the folder, which is made when it is not there; a record that was cut by a crash is cut off. `first` is the
    /// position at which an empty journal begins.
    pub fn open(folder: &Path, first: Position) -> Result<Self, ServerError> {
        fs::create_dir_all(folder).map_err(|source| ServerError::io(folder, source))?;
        let segments = listed(folder)?;
        let mut journal = Self {
            folder: folder.to_path_buf(),
            segments,
            last: None,
            next: first.max(1),
            buffer: Vec::new(),
        };
        if let Some(start) = journal.segments.last().copied() {
            let path = journal.path(start);
            let mut records = Records::open(&path, start, true)?;
            for record in records.by_ref() {
                record?;
            }
            let (good, next) = (records.at, records.position);
            let file = OpenOptions::new().write(true).open(&path).map_err(|e| ServerError::io(&path, e))?;
            let length = file.metadata().map_err(|e| ServerError::io(&path, e))?.len();
            if length > good {
                tracing::warn!(
                    "{}: {} bytes at the end are no whole record: cut off",
                    path.display(),
                    length - good
                );
                file.set_len(good).map_err(|e| ServerError::io(&path, e))?;
            }
            if next < journal.next || good == 0 {
                // A snapshot is ahead of what the disk kept, or the file was being made: what follows is a file of its own.
                journal.next = journal.next.max(next);
                journal.roll()?;
            } else {
                journal.next = next;
                let mut file = file;
                file.seek(SeekFrom::End(0)).map_err(|e| ServerError::io(&path, e))?;
                journal.last = Some(Open { file, bytes: good });
            }
        }
        Ok(journal)
    }

    /// Position of the next entry.
    pub fn next(&self) -> Position {
        self.next
    }

    /// Writes the entries and waits until the disk has them; returns the position of the first. When it fails, none counts: what was
    /// written is cut off again.
    pub fn append(&mut self, entries: &[Entry]) -> Result<Position, ServerError> {
        let full = self.last.as_ref().is_none_or(|open| open.bytes >= SEGMENT_BYTES);
        if full {
            self.roll()?;
        }
        self.buffer.clear();
        for (position, entry) in (self.next..).zip(entries) {
            let body = self.buffer.len() + RECORD_HEAD;
            self.buffer.extend_from_slice(&[0; RECORD_HEAD]);
            entry.encode_raw(&mut self.buffer);
            let crc = crc(position, &self.buffer[body..]);
            #[expect(clippy::cast_possible_truncation, reason = "what comes in is limited far below 4 GB")]
            let length = (self.buffer.len() - body) as u32;
            self.buffer[body - RECORD_HEAD..body - 4].copy_from_slice(&length.to_le_bytes());
            self.buffer[body - 4..body].copy_from_slice(&crc.to_le_bytes());
        }
        let segment = self.segments.last().copied().unwrap_or(self.next);
        let path = self.path(segment);
        let Some(open) = &mut self.last else { return Err(ServerError::NoSegment { path }) };
        let written = open.file.write_all(&self.buffer).and_then(|()| open.file.sync_data());
        if let Err(source) = written {
            // Half a record in the middle would be damage: back to where it was good. If that fails too, a new file begins.
            let back =
                open.file.set_len(open.bytes).and_then(|()| open.file.seek(SeekFrom::Start(open.bytes)));
            if back.is_err() {
                self.last = None;
            }
            return Err(ServerError::io(&path, source));
        }
        open.bytes += self.buffer.len() as u64;
        let first = self.next;
        self.next += entries.len() as u64;
        Ok(first)
    }

    /// The entries from this position on, in order.
    pub fn read_from(&self, position: Position) -> Result<Reader, ServerError> {
        let behind = self.segments.partition_point(|start| *start <= position);
        let wanted = &self.segments[behind.saturating_sub(1)..];
        let files = wanted.iter().rev().map(|start| (self.path(*start), *start)).collect();
        if let Some(oldest) = self.segments.first()
            && position < *oldest
        {
            return Err(ServerError::JournalGap { wanted: position, oldest: *oldest });
        }
        Ok(Reader { files, records: None, from: position })
    }

    /// Deletes the files whose entries are all before this position.
    pub fn trim(&mut self, before: Position) -> Result<(), ServerError> {
        while let [first, second, ..] = self.segments.as_slice()
            && *second <= before
        {
            let path = self.path(*first);
            fs::remove_file(&path).map_err(|source| ServerError::io(&path, source))?;
            self.segments.remove(0);
        }
        Ok(())
    }

    /// Bytes on disk.
    pub fn bytes(&self) -> u64 {
        let length = |start: &Position| fs::metadata(self.path(*start)).map_or(0, |file| file.len());
        self.segments.iter().map(length).sum()
    }

    /// Begins a new file.
    fn roll(&mut self) -> Result<(), ServerError> {
        let path = self.path(self.next);
        let io = |source| ServerError::io(&path, source);
        let mut file = OpenOptions::new().write(true).create(true).truncate(true).open(&path).map_err(io)?;
        file.write_all(HEAD).and_then(|()| file.sync_all()).map_err(io)?;
        // The name must be on disk too.
        File::open(&self.folder).and_then(|folder| folder.sync_all()).map_err(io)?;
        if self.segments.last() != Some(&self.next) {
            self.segments.push(self.next);
        }
        self.last = Some(Open { file, bytes: HEAD.len() as u64 });
        Ok(())
    }

    fn path(&self, start: Position) -> PathBuf {
        self.folder.join(format!("{start:020}.seg"))
    }
}

/// First positions of the files of a folder, in order.
fn listed(folder: &Path) -> Result<Vec<Position>, ServerError> {
    let mut segments = Vec::new();
    for file in fs::read_dir(folder).map_err(|source| ServerError::io(folder, source))? {
        let name = file.map_err(|source| ServerError::io(folder, source))?.file_name();
        let start = name
            .to_str()
            .and_then(|name| name.strip_suffix(".seg"))
            .and_then(|digits| digits.parse::<Position>().ok());
        segments.extend(start);
    }
    segments.sort_unstable();
    Ok(segments)
}

fn crc(position: Position, body: &[u8]) -> u32 {
    let mut crc = crc32fast::Hasher::new();
    crc.update(&position.to_le_bytes());
    crc.update(body);
    crc.finalize()
}

/// Entries of the journal from a position on.
pub struct Reader {
    /// Files still to read, the next last.
    files: Vec<(PathBuf, Position)>,
    records: Option<Records>,
    from: Position,
}

impl Iterator for Reader {
    type Item = Result<(Position, Entry), ServerError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(records) = &mut self.records {
                match records.next() {
                    Some(Ok((position, _))) if position < self.from => continue,
                    Some(Ok((position, body))) => {
                        let entry = Entry::decode(body)
                            .map_err(|error| records.damage(format!("an entry that is none: {error}")));
                        return Some(entry.map(|entry| (position, entry)));
                    }
                    Some(Err(error)) => return Some(Err(error)),
                    None => self.records = None,
                }
            }
            let (path, start) = self.files.pop()?;
            match Records::open(&path, start, self.files.is_empty()) {
                Ok(records) => self.records = Some(records),
                Err(error) => return Some(Err(error)),
            }
        }
    }
}

/// Records of one file.
struct Records {
    path: PathBuf,
    file: std::io::BufReader<File>,
    /// Bytes of whole records so far.
    at: u64,
    position: Position,
    /// Of the last file, the end may be cut.
    is_last: bool,
    ended: bool,
}

impl Records {
    fn open(path: &Path, start: Position, is_last: bool) -> Result<Self, ServerError> {
        let io = |source| ServerError::io(path, source);
        let file = File::open(path).map_err(io)?;
        let mut records = Self {
            path: path.to_path_buf(),
            file: std::io::BufReader::with_capacity(1 << 16, file),
            at: 0,
            position: start,
            is_last,
            ended: false,
        };
        let mut head = Vec::with_capacity(HEAD.len());
        records.file.by_ref().take(HEAD.len() as u64).read_to_end(&mut head).map_err(io)?;
        match head.as_slice() {
            whole if whole == HEAD => records.at = HEAD.len() as u64,
            // The power went while the file was made.
            cut if is_last && HEAD.starts_with(cut) => records.ended = true,
            _ => return Err(records.damage("no journal of adit".to_owned())),
        }
        Ok(records)
    }

    fn damage(&self, what: String) -> ServerError {
        ServerError::JournalDamage { path: self.path.clone(), byte: self.at, what }
    }

    /// What is no record: the end, where the end may be cut.
    fn bad(&mut self, what: &str) -> Option<Result<(Position, Bytes), ServerError>> {
        self.ended = true;
        (!self.is_last).then(|| Err(self.damage(what.to_owned())))
    }

    fn read(&mut self, bytes: u64) -> Result<Vec<u8>, ServerError> {
        let mut read = Vec::new();
        let file = self.file.by_ref();
        file.take(bytes).read_to_end(&mut read).map_err(|source| ServerError::io(&self.path, source))?;
        Ok(read)
    }
}

impl Iterator for Records {
    type Item = Result<(Position, Bytes), ServerError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let head = match self.read(RECORD_HEAD as u64) {
            Ok(head) => head,
            Err(error) => {
                self.ended = true;
                return Some(Err(error));
            }
        };
        let [a, b, c, d, e, f, g, h] = *head.as_slice() else {
            return if head.is_empty() {
                self.ended = true;
                None
            } else {
                self.bad("a record cut in its head")
            };
        };
        let (length, expected) = (u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h]));
        if length as usize > LARGEST_BODY {
            return self.bad("a record of an impossible length");
        }
        let body = match self.read(length.into()) {
            Ok(body) => body,
            Err(error) => {
                self.ended = true;
                return Some(Err(error));
            }
        };
        if body.len() != length as usize {
            return self.bad("a record cut in its body");
        }
        if crc(self.position, &body) != expected {
            return self.bad("a record that does not fit its CRC");
        }
        let position = self.position;
        self.position += 1;
        self.at += (RECORD_HEAD + body.len()) as u64;
        Some(Ok((position, body.into())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::journal::What;
    use adit_core::time::Time;

    type Tested = Result<(), Box<dyn std::error::Error>>;

    /// A file of three entries, and one of three more behind it.
    fn two_files(folder: &Path) -> Result<(PathBuf, PathBuf), ServerError> {
        let mut journal = Journal::open(folder, 1)?;
        let entries: Vec<_> = (0..3).map(|n| Entry::new(Time::from_nanos(1 + n), What::Tick(()))).collect();
        journal.append(&entries)?;
        journal.roll()?;
        journal.append(&entries)?;
        Ok((journal.path(1), journal.path(4)))
    }

    fn flip(path: &Path, byte: usize) -> std::io::Result<()> {
        let mut bytes = fs::read(path)?;
        bytes[byte] ^= 0x10;
        fs::write(path, bytes)
    }

    #[test]
    fn damage_before_the_last_file_is_named_with_file_and_byte() -> Tested {
        let folder = tempfile::tempdir()?;
        let (first, _) = two_files(folder.path())?;
        let record = (fs::metadata(&first)?.len() - HEAD.len() as u64) / 3;
        let second = HEAD.len() as u64 + record;
        flip(&first, usize::try_from(second)? + RECORD_HEAD)?;
        let read: Vec<_> = Journal::open(folder.path(), 1)?.read_from(1)?.take(3).collect();
        assert!(read[0].is_ok());
        let told = read[1].as_ref().err().ok_or("read")?.to_string();
        let expected = "a record that does not fit its CRC: the journal is damaged";
        assert_eq!(told, format!("{}: byte {second}: {expected}", first.display()));
        Ok(())
    }

    #[test]
    fn the_last_file_is_cut_before_the_first_record_that_is_none() -> Tested {
        let folder = tempfile::tempdir()?;
        let (_, last) = two_files(folder.path())?;
        let length = fs::metadata(&last)?.len();
        flip(&last, usize::try_from(length)? - 1)?;
        let journal = Journal::open(folder.path(), 1)?;
        assert_eq!((journal.next(), journal.read_from(1)?.count()), (6, 5));
        assert_eq!(fs::metadata(&last)?.len(), length - (length - HEAD.len() as u64) / 3);
        Ok(())
    }
}
