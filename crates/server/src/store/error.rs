//! What can go wrong in the store, told so that the writer can decide: wait, call somebody, or stop.

use std::path::{Path, PathBuf};

/// Why the store could not do it.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// Another process holds the file for longer than the time to wait: try again.
    #[error("{path}: locked by another process: {said}")]
    Locked {
        /// The store.
        path: PathBuf,
        /// What `SQLite` said.
        said: String,
    },
    /// No space is left: nothing of the transaction is in the file; it may be tried again when there is.
    #[error("{path}: no space left to write: {said}")]
    Full {
        /// The store.
        path: PathBuf,
        /// What `SQLite` said.
        said: String,
    },
    /// The file cannot be opened, read or written.
    #[error("{path}: {said}")]
    Io {
        /// The store.
        path: PathBuf,
        /// What `SQLite` or the system said.
        said: String,
    },
    /// The file is no `SQLite` database.
    #[error("{path}: not a database of adit: {said}")]
    NotADatabase {
        /// The store.
        path: PathBuf,
        /// What `SQLite` said.
        said: String,
    },
    /// A `SQLite` database, but of another program.
    #[error("{path}: a database of another program: application id {found}, expected {expected}")]
    Foreign {
        /// The store.
        path: PathBuf,
        /// Application id in the file.
        found: i64,
        /// That of adit.
        expected: i64,
    },
    /// Written by a newer adit.
    #[error(
        "{path}: written by a newer adit: it has schema {found}, this adit knows up to {known}; update adit, or restore a backup of this version"
    )]
    NewerSchema {
        /// The store.
        path: PathBuf,
        /// Newest migration in the file.
        found: i64,
        /// Newest migration known.
        known: i64,
    },
    /// The schema could not be brought up to date.
    #[error("{path}: schema not brought up to date: {said}")]
    Schema {
        /// The store.
        path: PathBuf,
        /// What was found.
        said: String,
    },
    /// The file is damaged: restore a backup.
    #[error("{path}: damaged: {said}")]
    Corrupt {
        /// The store.
        path: PathBuf,
        /// What was found, and where.
        said: String,
    },
    /// Rounds out of order.
    #[error("round at journal position {found} after position {after}: positions must rise")]
    OutOfOrder {
        /// Position found.
        found: u64,
        /// Position before it.
        after: u64,
    },
    /// What was asked for cannot be.
    #[error("{what}: found {found}, expected {expected}")]
    Unusable {
        /// Of what.
        what: &'static str,
        /// Value found.
        found: String,
        /// Values that can be.
        expected: String,
    },
    /// Anything else that the database said: an error of adit itself.
    #[error("{path}: {said}")]
    Database {
        /// The store.
        path: PathBuf,
        /// What it said.
        said: String,
    },
}

impl StoreError {
    /// Whether the same call may succeed later without anybody doing anything to the file's contents.
    pub const fn may_be_tried_again(&self) -> bool {
        matches!(self, Self::Locked { .. } | Self::Full { .. } | Self::Io { .. })
    }

    /// From what sqlx said about the store at `path`.
    pub(crate) fn of(path: &Path, error: &sqlx::Error) -> Self {
        let path = path.to_path_buf();
        let said = match error {
            sqlx::Error::Database(from_sqlite) => from_sqlite.message().to_owned(),
            other => other.to_string(),
        };
        match error {
            sqlx::Error::PoolTimedOut => Self::Locked { path, said: "no connection came free".to_owned() },
            sqlx::Error::Io(_) => Self::Io { path, said },
            sqlx::Error::ColumnDecode { .. } | sqlx::Error::Decode(_) => Self::Corrupt { path, said },
            sqlx::Error::Database(from_sqlite) => {
                let code: i64 = from_sqlite.code().and_then(|code| code.parse().ok()).unwrap_or(1);
                // Primary result code: the low byte (sqlite.org/rescode.html).
                match code & 0xff {
                    5 | 6 => Self::Locked { path, said },
                    13 => Self::Full { path, said },
                    8 | 10 | 14 | 23 => Self::Io { path, said },
                    11 => Self::Corrupt { path, said },
                    26 => Self::NotADatabase { path, said },
                    _ => Self::Database { path, said },
                }
            }
            _ => Self::Database { path, said },
        }
    }
}
