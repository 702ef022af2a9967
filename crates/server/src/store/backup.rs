//! A copy of the whole store while it is in use.

use crate::store::{Store, StoreError};
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{ConnectOptions as _, Connection as _};
use std::path::Path;

impl Store {
    /// Writes the store as it is now to `to`, which appears whole or not at all; what is there is an error. Readers and the writer go on
    /// meanwhile; the write-ahead log grows by what they write. To restore: stop adit, put the copy in the place of the store, without the
    /// `-wal` and `-shm` beside it, and start.
    pub async fn backup(&self, to: &Path) -> Result<(), StoreError> {
        let io = |error: std::io::Error| StoreError::Io { path: to.to_path_buf(), said: error.to_string() };
        let folder =
            to.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
        let part = tempfile::Builder::new().prefix(".adit-backup-").tempfile_in(folder).map_err(io)?;
        // VACUUM INTO takes an empty file.
        let name = part.path().to_str().ok_or_else(|| StoreError::Unusable {
            what: "path of a backup",
            found: part.path().display().to_string(),
            expected: "one of Unicode".to_owned(),
        })?;
        // A connection of its own: one that may only read refuses this, and the writer is not to wait.
        let mut connection = SqliteConnectOptions::new()
            .filename(self.path())
            .connect()
            .await
            .map_err(|error| self.failed(&error))?;
        sqlx::query("VACUUM INTO ?1")
            .bind(name)
            .execute(&mut connection)
            .await
            .map_err(|error| StoreError::of(to, &error))?;
        connection.close().await.map_err(|error| StoreError::of(to, &error))?;
        part.as_file().sync_all().map_err(io)?;
        part.persist_noclobber(to).map_err(|error| io(error.error))?;
        Ok(())
    }

    /// Reads the whole file for damage: pages, keys and rows as `SQLite` knows them, and every chunk of tracks. Says what is wrong; empty: nothing.
    pub async fn check(&self) -> Result<Vec<String>, StoreError> {
        use futures_util::TryStreamExt as _;
        let failed = |error: sqlx::Error| self.failed(&error);
        let mut wrong: Vec<String> =
            sqlx::query_scalar("PRAGMA integrity_check").fetch_all(self.readers()).await.map_err(failed)?;
        wrong.retain(|line| line != "ok");
        let mut rows = sqlx::query("SELECT id, tag, person, from_ms, count, columns FROM track_chunk")
            .fetch(self.readers());
        while let Some(row) = rows.try_next().await.map_err(failed)? {
            wrong.extend(crate::store::track::unpacked(&row).err());
        }
        Ok(wrong)
    }
}
