//! One transaction that writes.

use crate::store::{Store, StoreError};
use sqlx::pool::PoolConnection;
use sqlx::{Sqlite, SqliteConnection};
use std::ops::{Deref, DerefMut};

/// The writing connection within a transaction. Unless it is committed the connection is closed, which undoes everything: on a full disk `SQLite` ends
/// the transaction by itself, and sqlx's own transactions would not come back from that.
pub(crate) struct Writing {
    store: Store,
    connection: PoolConnection<Sqlite>,
    open: bool,
}

impl Store {
    /// Waits for its turn and begins to write. Hold it briefly: everybody who writes waits for it.
    pub(crate) async fn write(&self) -> Result<Writing, StoreError> {
        let mut connection = self.writer().acquire().await.map_err(|error| self.failed(&error))?;
        sqlx::raw_sql("BEGIN IMMEDIATE")
            .execute(&mut *connection)
            .await
            .map_err(|error| self.failed(&error))?;
        Ok(Writing { store: self.clone(), connection, open: true })
    }
}

impl Writing {
    /// Everything written is on the disk when it returns.
    pub(crate) async fn commit(mut self) -> Result<(), StoreError> {
        sqlx::raw_sql("COMMIT")
            .execute(&mut *self.connection)
            .await
            .map_err(|error| self.store.failed(&error))?;
        self.open = false;
        Ok(())
    }
}

impl Deref for Writing {
    type Target = SqliteConnection;
    fn deref(&self) -> &SqliteConnection {
        &self.connection
    }
}

impl DerefMut for Writing {
    fn deref_mut(&mut self) -> &mut SqliteConnection {
        &mut self.connection
    }
}

impl Drop for Writing {
    fn drop(&mut self) {
        if self.open {
            self.connection.close_on_drop();
        }
    }
}
