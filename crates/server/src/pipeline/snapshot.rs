//! The state of everything, kept so that a start need not read the journal from its beginning.
//!
//! **A snapshot takes its time.** Ten thousand estimators are some hundred megabytes; writing them at once would hold up positions
//! for seconds. So copies of tags are taken a few at a time, round after round, each with the entry that it has come to; at the end, in one
//! round, what has to be of one moment: the tracking, at entry E, and the tags that came meanwhile. Every tag of the file has come to an entry
//! at or before E, and at or after the beginning of the snapshot. A thread of its own ([`Writing`]) turns the copies into bytes and waits for the
//! disk.
//!
//! **It counts only when the store is as far as E**: what came of entries before it cannot be found again.
//!
//! **A start** reads the journal from the oldest of these entries. What a tag has already it passes over; what others tell of entries up
//! to E the tracking has already; from there on all is as it was. Files before that are deleted only when the new one is on the disk.
//!
//! File: `snapshots/<E, 20 digits>.snap`; [`HEAD`], then records as in the journal (length, CRC-32, body in `MessagePack`), the tracking last.

use super::devices::Devices;
use super::follower::Follower;
use crate::error::ServerError;
use crate::journal::{Gateways, Position};
use adit_tracking::Tracking;
use serde::{Deserialize, Serialize};
use std::fs::{self, File};
use std::io::{BufReader, BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;
use tokio::sync::mpsc;

/// First bytes of a file.
pub const HEAD: &[u8; 8] = b"aditsnp1";
const ENDING: &str = "snap";
/// No record is larger, bytes.
const LARGEST: usize = 1 << 30;
/// Parts that wait to be written; while there are as many no further copies are taken.
const MOST_PARTS: usize = 2;
/// Bytes brought to the disk at once: more would hold up the journal, which waits for the same disk.
const SYNCED: usize = 8 << 20;
/// How often a snapshot that is written looks whether the store is as far.
const PATIENCE: Duration = Duration::from_millis(20);

/// The snapshots of one folder.
#[derive(Debug, Clone)]
pub struct Snapshots {
    folder: PathBuf,
}

/// One record of a file.
#[derive(Serialize, Deserialize)]
enum Record {
    Tag(String, Box<Follower>),
    Server(Box<ServerState>),
}

/// What is of one moment.
#[derive(Serialize, Deserialize)]
pub struct ServerState {
    /// The last entry that counts.
    pub position: Position,
    /// The tracking.
    pub tracking: Tracking,
    /// How gateways and anchors are.
    pub devices: Devices,
    /// What gateways have sent, and the first entry that is not in it.
    pub gateways: (Position, Gateways),
}

/// A snapshot that was read back.
pub struct Restored {
    /// What is of one moment.
    pub server: ServerState,
    /// The tags.
    pub tags: Vec<(String, Follower)>,
}

/// A snapshot being written by a thread; dropped before it is whole, it is given up.
pub struct Writing {
    parts: Option<mpsc::Sender<Part>>,
    thread: Option<JoinHandle<Result<Position, ServerError>>>,
}

/// What a snapshot is made of.
pub enum Part {
    /// Some tags.
    Tags(Vec<(String, Follower)>),
    /// What is of one moment: the last.
    Server(Box<ServerState>),
}

impl Snapshots {
    /// In this folder, which is made when it is not there.
    pub fn open(folder: &Path) -> Result<Self, ServerError> {
        fs::create_dir_all(folder).map_err(|source| ServerError::io(folder, source))?;
        Ok(Self { folder: folder.to_path_buf() })
    }

    /// The newest that is whole; a damaged one is passed over with a warning.
    pub fn newest(&self) -> Result<Option<Restored>, ServerError> {
        let mut files = self.files()?;
        files.sort();
        for path in files.into_iter().rev() {
            match read(&path) {
                Ok(restored) => return Ok(Some(restored)),
                Err(error) => tracing::warn!("{error}: passed over"),
            }
        }
        Ok(None)
    }

    /// Begins one; it becomes the newest when it is whole and `stored` has come to its entry.
    pub fn begin(&self, stored: &Arc<AtomicU64>) -> Result<Writing, ServerError> {
        let path = self.folder.join("running.part");
        let file = File::create(&path).map_err(|source| ServerError::io(&path, source))?;
        let file = BufWriter::with_capacity(1 << 18, file);
        let mut written = Written { file, path, oldest: None, body: Vec::new(), fresh: 0 };
        let (parts, mut inbox) = mpsc::channel(MOST_PARTS);
        let (snapshots, stored) = (self.clone(), Arc::clone(stored));
        let write = move || {
            let position = written.parts(&mut inbox)?;
            while stored.load(Ordering::Acquire) < position {
                if inbox.is_closed() {
                    return Err(ServerError::SnapshotGivenUp);
                }
                std::thread::sleep(PATIENCE);
            }
            snapshots.finish(written, position)
        };
        let thread = std::thread::Builder::new().name("snapshot".to_owned()).spawn(write);
        let thread = thread.map_err(|source| ServerError::Thread { name: "snapshot", source })?;
        Ok(Writing { parts: Some(parts), thread: Some(thread) })
    }

    /// Brings a whole one to the disk and deletes those before. Returns the oldest entry that is needed from now on.
    fn finish(&self, written: Written, position: Position) -> Result<Position, ServerError> {
        let Written { file, path, oldest, .. } = written;
        let io = |source| ServerError::io(&path, source);
        let file = file.into_inner().map_err(|error| io(error.into_error()))?;
        file.sync_all().map_err(io)?;
        let target = self.folder.join(format!("{position:020}.{ENDING}"));
        fs::rename(&path, &target).map_err(io)?;
        File::open(&self.folder).and_then(|folder| folder.sync_all()).map_err(io)?;
        for before in self.files()? {
            if before != target {
                fs::remove_file(&before).map_err(|source| ServerError::io(&before, source))?;
            }
        }
        Ok(oldest.unwrap_or(position).min(position) + 1)
    }

    fn files(&self) -> Result<Vec<PathBuf>, ServerError> {
        let io = |source| ServerError::io(&self.folder, source);
        let mut files = Vec::new();
        for file in fs::read_dir(&self.folder).map_err(io)? {
            let path = file.map_err(io)?.path();
            if path.extension().is_some_and(|ending| ending == ENDING) {
                files.push(path);
            }
        }
        Ok(files)
    }
}

impl Writing {
    /// A place for the next part, unless those before still wait.
    pub fn place(&self) -> Option<mpsc::Permit<'_, Part>> {
        self.parts.as_ref()?.try_reserve().ok()
    }

    /// Hands over a part; waits while those before are written.
    pub fn add(&self, part: Part) {
        if let Some(parts) = &self.parts {
            // A thread that ended says why when it is asked for the outcome.
            let _ = parts.blocking_send(part);
        }
    }

    /// Whether the thread has ended.
    pub fn ended(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// The oldest entry that is needed from now on; waits for the thread, which goes on until it is whole and the store is as far.
    pub fn outcome(mut self) -> Result<Position, ServerError> {
        let joined = self.thread.take().map(JoinHandle::join);
        joined.and_then(Result::ok).unwrap_or(Err(ServerError::Stopped))
    }
}

impl Drop for Writing {
    fn drop(&mut self) {
        self.parts = None;
        if let Some(thread) = self.thread.take() {
            // Nobody wants to know.
            let _ = thread.join();
        }
    }
}

/// What the thread has written.
struct Written {
    file: BufWriter<File>,
    path: PathBuf,
    /// The oldest entry that a tag of it has come to.
    oldest: Option<Position>,
    body: Vec<u8>,
    /// Bytes written since the last sync.
    fresh: usize,
}

impl Written {
    /// Writes what comes until it is whole; returns the entry of the tracking.
    fn parts(&mut self, inbox: &mut mpsc::Receiver<Part>) -> Result<Position, ServerError> {
        self.file.write_all(HEAD).map_err(|source| ServerError::io(&self.path, source))?;
        while let Some(part) = inbox.blocking_recv() {
            match part {
                Part::Tags(tags) => {
                    for (tag, follower) in tags {
                        let applied = follower.applied();
                        self.oldest = Some(self.oldest.map_or(applied, |oldest| oldest.min(applied)));
                        self.record(&Record::Tag(tag, Box::new(follower)))?;
                    }
                }
                Part::Server(server) => {
                    let position = server.position;
                    self.record(&Record::Server(server))?;
                    return Ok(position);
                }
            }
        }
        Err(ServerError::SnapshotGivenUp)
    }

    fn record(&mut self, record: &Record) -> Result<(), ServerError> {
        self.body.clear();
        let written = record.serialize(&mut rmp_serde::Serializer::new(&mut self.body).with_struct_map());
        written
            .map_err(|error| ServerError::Snapshot { path: self.path.clone(), what: error.to_string() })?;
        #[expect(clippy::cast_possible_truncation, reason = "a record of 4 GB is none")]
        let length = self.body.len() as u32;
        let crc = crc32fast::hash(&self.body);
        let file = &mut self.file;
        let written = file
            .write_all(&length.to_le_bytes())
            .and_then(|()| file.write_all(&crc.to_le_bytes()))
            .and_then(|()| file.write_all(&self.body));
        self.fresh += self.body.len();
        let written = written.and_then(|()| {
            if self.fresh < SYNCED {
                return Ok(());
            }
            self.fresh = 0;
            file.flush()?;
            file.get_ref().sync_data()
        });
        written.map_err(|source| ServerError::io(&self.path, source))
    }
}

fn read(path: &Path) -> Result<Restored, ServerError> {
    let io = |source| ServerError::io(path, source);
    let bad = |what: String| ServerError::Snapshot { path: path.to_path_buf(), what };
    let mut file = BufReader::with_capacity(1 << 18, File::open(path).map_err(io)?);
    let mut head = [0; HEAD.len()];
    file.read_exact(&mut head).map_err(io)?;
    if head != *HEAD {
        return Err(bad("no snapshot of adit".to_owned()));
    }
    let mut tags = Vec::new();
    let mut body = Vec::new();
    loop {
        let mut head = [0; 8];
        file.read_exact(&mut head).map_err(|_| bad("cut: the tracking at its end is missing".to_owned()))?;
        let [a, b, c, d, e, f, g, h] = head;
        let (length, crc) = (u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h]));
        if length as usize > LARGEST {
            return Err(bad(format!("a record of {length} bytes")));
        }
        body.clear();
        file.by_ref().take(length.into()).read_to_end(&mut body).map_err(io)?;
        if body.len() != length as usize || crc32fast::hash(&body) != crc {
            return Err(bad("a record does not fit its CRC".to_owned()));
        }
        match rmp_serde::from_slice(&body).map_err(|error| bad(error.to_string()))? {
            Record::Tag(tag, follower) => tags.push((tag, *follower)),
            Record::Server(server) => return Ok(Restored { server: *server, tags }),
        }
    }
}
