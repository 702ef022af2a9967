//! What a mine's life leaves behind: tracks, events, alarms and who changed what, in one `SQLite` file.
//!
//! [`Store::open`] makes or opens the file and brings its schema up to date. [`Store::commit`] writes rounds of [`Record`]s in one
//! transaction together with the position of the journal, so that a journal replayed after a crash writes nothing twice. One connection
//! writes, a few read; a reader never waits for the writer (write-ahead log).
//!
//! `synchronous = FULL`: a commit is on the disk when it returns. `NORMAL` would be enough for what the journal can bring again, but
//! users, tokens and refused log-ins are not in it, and the journal could be cut only after a checkpoint; the price is one `fsync` a commit.
//!
//! Units: times in ms (tracks) and ns, lengths in cm, on the mine's grid. docs/live/store.md tells tables, sizes and limits.

mod audit;
mod backup;
mod chunk;
mod commit;
mod compact;
mod decimate;
mod error;
mod logbook;
mod migrations;
mod names;
mod packed;
mod record;
mod replay;
mod retention;
mod track;
mod verify;
mod writing;

pub use audit::{AuditHead, AuditRow};
pub use compact::Compacted;
pub use error::StoreError;
pub use logbook::{Cursor, LogPage, LogQuery};
pub use record::{AlarmRecord, AuditRecord, Committed, EventRecord, FixRecord, Record, Round};
pub use replay::ReplayQuery;
pub use retention::{Retained, Retention};
pub use track::{DrawnTrack, TrackOf, TrackPage, TrackQuery};
pub use verify::{AuditBreak, AuditQuery, AuditVerdict};
pub(crate) use writing::Writing;

use names::Names;
use sqlx::sqlite::{
    SqliteAutoVacuum, SqliteConnectOptions, SqliteJournalMode, SqlitePool, SqlitePoolOptions,
    SqliteSynchronous,
};
use std::path::{Path, PathBuf};
use std::sync::{Arc, PoisonError, RwLock};
use std::time::Duration;

/// How long a call waits for another process's lock.
const BUSY: Duration = Duration::from_secs(5);
/// How long a call waits for its turn at the writer, which a step of packing or of retention may hold.
const TURN: Duration = Duration::from_secs(15);
/// Readers at once; the next one waits for its turn.
const READERS: u32 = 4;

/// The store; cheap to clone, all clones are the same store.
#[derive(Debug, Clone)]
pub struct Store {
    inner: Arc<Inner>,
}

#[derive(Debug)]
struct Inner {
    path: PathBuf,
    writer: SqlitePool,
    readers: SqlitePool,
    names: RwLock<Arc<Names>>,
    maintenance: tokio::sync::Mutex<()>,
}

impl Store {
    /// Opens the store at `path`; makes it where there is none, and brings its schema up to date.
    ///
    /// # Errors
    /// [`StoreError::NotADatabase`], [`StoreError::Foreign`], [`StoreError::NewerSchema`] leave the file as it was;
    /// [`StoreError::Locked`], [`StoreError::Full`], [`StoreError::Io`], [`StoreError::Corrupt`].
    pub async fn open(path: &Path) -> Result<Self, StoreError> {
        Self::open_limited(path, u32::MAX - 1).await
    }

    /// The same, for a file that shall not grow past so many pages of 4096 bytes: then it is [`StoreError::Full`].
    pub async fn open_limited(path: &Path, pages: u32) -> Result<Self, StoreError> {
        let failed = |error: sqlx::Error| StoreError::of(path, &error);
        let file = SqliteConnectOptions::new().filename(path).busy_timeout(BUSY).create_if_missing(true);
        {
            // As it is, before anything is set: the file of another program stays untouched.
            use sqlx::{ConnectOptions as _, Connection as _};
            let mut connection = file.clone().connect().await.map_err(failed)?;
            migrations::check_owner(&mut connection, path).await?;
            connection.close().await.map_err(failed)?;
        }
        let file = file
            .auto_vacuum(SqliteAutoVacuum::Incremental)
            .journal_mode(SqliteJournalMode::Wal)
            .synchronous(SqliteSynchronous::Full)
            // What is taken away is overwritten where that costs no further writing.
            .pragma("secure_delete", "fast")
            .pragma("max_page_count", pages.to_string());
        let writer = SqlitePoolOptions::new()
            .max_connections(1)
            .min_connections(1)
            .acquire_timeout(TURN)
            .idle_timeout(None)
            .max_lifetime(None)
            // On a full disk SQLite ends a transaction by itself, and sqlx counts it as open for ever: such a connection goes.
            .after_release(|connection, _| {
                Box::pin(async move { Ok(!sqlx::Connection::is_in_transaction(connection)) })
            })
            .connect_with(file.clone())
            .await
            .map_err(failed)?;
        migrations::run(&mut *writer.acquire().await.map_err(failed)?, path).await?;
        let readers = SqlitePoolOptions::new()
            .max_connections(READERS)
            .acquire_timeout(TURN)
            .connect_with(file.pragma("query_only", "on"))
            .await
            .map_err(failed)?;
        let names = Names::read(&readers).await.map_err(failed)?;
        Ok(Self {
            inner: Arc::new(Inner {
                path: path.to_path_buf(),
                writer,
                readers,
                names: RwLock::new(Arc::new(names)),
                maintenance: tokio::sync::Mutex::new(()),
            }),
        })
    }

    /// Where the file is.
    pub fn path(&self) -> &Path {
        &self.inner.path
    }

    /// Ends the connections; the write-ahead log goes into the file.
    pub async fn close(&self) {
        self.inner.readers.close().await;
        self.inner.writer.close().await;
    }

    /// The one connection that writes, for tables of other parts of the server. Hold it briefly: everything waits for it.
    pub(crate) fn writer(&self) -> &SqlitePool {
        &self.inner.writer
    }

    /// Connections that only read.
    pub(crate) fn readers(&self) -> &SqlitePool {
        &self.inner.readers
    }

    /// An error of the database, with the path of the store.
    pub(crate) fn failed(&self, error: &sqlx::Error) -> StoreError {
        StoreError::of(self.path(), error)
    }

    /// Damage, with the path of the store.
    pub(crate) fn corrupt(&self, said: String) -> StoreError {
        StoreError::Corrupt { path: self.path().to_path_buf(), said }
    }

    /// What is sound; what is not is told in the log and left out.
    pub(crate) fn sound<T>(&self, found: Result<T, String>) -> Option<T> {
        found
            .inspect_err(|said| tracing::error!(path = %self.path().display(), "damaged, left out: {said}"))
            .ok()
    }

    /// Packing and retention one after the other: each expects that chunks stay while it reads them.
    async fn maintenance(&self) -> tokio::sync::MutexGuard<'_, ()> {
        self.inner.maintenance.lock().await
    }

    /// Names as known now.
    fn names(&self) -> Arc<Names> {
        Arc::clone(&self.inner.names.read().unwrap_or_else(PoisonError::into_inner))
    }

    fn learn(&self, added: Names) {
        if !added.is_empty() {
            Arc::make_mut(&mut self.inner.names.write().unwrap_or_else(PoisonError::into_inner))
                .extend(added);
        }
    }
}
