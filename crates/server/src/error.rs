//! What can go wrong in the server.

use crate::journal::Position;
use std::path::{Path, PathBuf};

/// What can go wrong in the server, with what was found.
#[derive(Debug, thiserror::Error)]
pub enum ServerError {
    /// A file or folder could not be read or written.
    #[error("{path}: {source}")]
    Io {
        /// Of which file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Another process works on the folder.
    #[error("{folder}: another server works on this folder")]
    FolderTaken {
        /// Which folder.
        folder: PathBuf,
    },
    /// A file of the journal is damaged where no crash can have cut it.
    #[error("{path}: byte {byte}: {what}: the journal is damaged")]
    JournalDamage {
        /// Which file.
        path: PathBuf,
        /// Where the bad record begins.
        byte: u64,
        /// What is wrong with it.
        what: String,
    },
    /// Entries are asked for that are no longer there.
    #[error(
        "the journal begins at entry {oldest}, entry {wanted} is needed: a snapshot or files of the journal are missing"
    )]
    JournalGap {
        /// The first that is needed.
        wanted: Position,
        /// The first that is there.
        oldest: Position,
    },
    /// A snapshot cannot be used.
    #[error("{path}: {what}: the snapshot cannot be used")]
    Snapshot {
        /// Which file.
        path: PathBuf,
        /// Why.
        what: String,
    },
    /// The plan of the mine cannot be changed so.
    #[error("{path}: {what}")]
    Plan {
        /// Where changes stand.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// The rules of the tracking are none.
    #[error(transparent)]
    Rules(#[from] adit_tracking::RulesError),
    /// A thread could not be started.
    #[error("thread {name}: {source}")]
    Thread {
        /// Which.
        name: &'static str,
        /// What the system said.
        source: std::io::Error,
    },
    /// The start was interrupted.
    #[error("the start was interrupted")]
    Stopped,
    /// Nobody waits for the snapshot any more.
    #[error("a snapshot was given up before it was whole")]
    SnapshotGivenUp,
    /// No file is open to write to, after an earlier failure.
    #[error("{path}: cannot be made")]
    NoSegment {
        /// The file that should be there.
        path: PathBuf,
    },
    /// The store failed.
    #[error(transparent)]
    Store(#[from] crate::store::StoreError),
    /// An export could not be written in its format.
    #[error("export: {0}")]
    Export(String),
    /// A file of a certificate cannot be used.
    #[error("{path}: expected {expected}: {found}")]
    Tls {
        /// Which file.
        path: PathBuf,
        /// What it should hold.
        expected: &'static str,
        /// What was found.
        found: String,
    },
    /// The address of the API cannot be had.
    #[error("{address}: {source}")]
    Bind {
        /// Which.
        address: std::net::SocketAddr,
        /// What the system said.
        source: std::io::Error,
    },
    /// Users, sessions or tokens failed.
    #[error(transparent)]
    Auth(#[from] crate::auth::AuthError),
    /// The socket of the API failed.
    #[error("the socket of the API: {source}")]
    Listen {
        /// What the system said.
        source: std::io::Error,
    },
}

impl ServerError {
    /// Of a file.
    pub fn io(path: &Path, source: std::io::Error) -> Self {
        Self::Io { path: path.to_path_buf(), source }
    }

    /// Whether the disk is full.
    pub fn is_full(&self) -> bool {
        matches!(self, Self::Io { source, .. }
            if matches!(source.kind(), std::io::ErrorKind::StorageFull | std::io::ErrorKind::QuotaExceeded))
    }
}
