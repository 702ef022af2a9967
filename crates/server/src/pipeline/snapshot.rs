//! The state of everything, kept so that a start need not read the journal from its beginning.
//!
//! **A snapshot takes its time.** Ten thousand estimators are some hundred megabytes; writing them at once would hold up positions
//! for a second. So tags are written a few at a time, round after round, each with the entry that it has come to; at the end, in one
//! round, what has to be of one moment: the tracking, at entry E, and the tags that came meanwhile. Every tag of the file has come to an entry
//! at or before E, and at or after the beginning of the snapshot.
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

/// First bytes of a file.
pub const HEAD: &[u8; 8] = b"aditsnp1";
const ENDING: &str = "snap";
/// No record is larger, bytes.
const LARGEST: usize = 1 << 30;

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

/// A snapshot being written.
pub struct Writing {
    file: BufWriter<File>,
    path: PathBuf,
    /// The oldest entry that a tag of it has come to.
    oldest: Option<Position>,
    body: Vec<u8>,
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

    /// Begins one.
    pub fn begin(&self) -> Result<Writing, ServerError> {
        let path = self.folder.join("running.part");
        let file = File::create(&path).map_err(|source| ServerError::io(&path, source))?;
        let mut file = BufWriter::with_capacity(1 << 18, file);
        file.write_all(HEAD).map_err(|source| ServerError::io(&path, source))?;
        Ok(Writing { file, path, oldest: None, body: Vec::new() })
    }

    /// Brings a whole one to the disk and deletes those before; may take as long as the disk does. Returns the oldest entry that is needed from now on.
    pub fn finish(&self, writing: Writing, position: Position) -> Result<Position, ServerError> {
        let Writing { file, path, oldest, .. } = writing;
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
    /// Adds a tag.
    pub fn tag(&mut self, tag: String, follower: Follower) -> Result<(), ServerError> {
        let applied = follower.applied();
        self.oldest = Some(self.oldest.map_or(applied, |oldest| oldest.min(applied)));
        self.record(&Record::Tag(tag, Box::new(follower)))
    }

    /// Adds what is of one moment: the last.
    pub fn server(&mut self, server: ServerState) -> Result<(), ServerError> {
        self.record(&Record::Server(Box::new(server)))
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
