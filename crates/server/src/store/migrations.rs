//! The schema, step by step: SQL of `migrations/`, in this program. Numbers 01xx are the store's, 02xx users, sessions and tokens.

use crate::store::StoreError;
use sqlx::migrate::{MigrateError, Migration, MigrationType, Migrator};
use sqlx::{SqlSafeStr as _, SqliteConnection};
use std::path::Path;

/// Number, name and SQL, each run once, in this order. A step that has been released never changes: add another.
const STEPS: [(i64, &str, &str); 4] = [
    (101, "store", include_str!("../../migrations/0101_store.sql")),
    (102, "audit", include_str!("../../migrations/0102_audit.sql")),
    (201, "users", include_str!("../../migrations/0201_users.sql")),
    (202, "omlox", include_str!("../../migrations/0202_omlox.sql")),
];

/// `PRAGMA application_id` of a store of adit: "adit" in ASCII, as in `0101_store.sql`.
const APPLICATION_ID: i64 = 0x6164_6974;

/// Whether the file is adit's to open: new, or with its mark.
pub(crate) async fn check_owner(connection: &mut SqliteConnection, path: &Path) -> Result<(), StoreError> {
    let failed = |error: sqlx::Error| StoreError::of(path, &error);
    let (found,): (i64,) =
        sqlx::query_as("PRAGMA application_id").fetch_one(&mut *connection).await.map_err(failed)?;
    let (tables,): (i64,) =
        sqlx::query_as("SELECT count(*) FROM sqlite_schema WHERE name <> '_sqlx_migrations'")
            .fetch_one(connection)
            .await
            .map_err(failed)?;
    if found == APPLICATION_ID || (found == 0 && tables == 0) {
        return Ok(());
    }
    Err(StoreError::Foreign { path: path.to_path_buf(), found, expected: APPLICATION_ID })
}

/// Brings the schema up to date.
pub(crate) async fn run(connection: &mut SqliteConnection, path: &Path) -> Result<(), StoreError> {
    let steps = STEPS
        .iter()
        .map(|&(number, name, sql)| {
            Migration::new(number, name.into(), MigrationType::Simple, sql.into_sql_str(), false)
        })
        .collect();
    let outcome = Migrator::with_migrations(steps).run_direct(None, &mut *connection, false).await;
    match outcome {
        Ok(()) => Ok(()),
        Err(MigrateError::VersionMissing(_)) => {
            let (found,): (i64,) = sqlx::query_as("SELECT max(version) FROM _sqlx_migrations")
                .fetch_one(connection)
                .await
                .map_err(|error| StoreError::of(path, &error))?;
            let known = STEPS.iter().map(|step| step.0).max().unwrap_or(0);
            Err(StoreError::NewerSchema { path: path.to_path_buf(), found, known })
        }
        Err(MigrateError::Execute(error) | MigrateError::ExecuteMigration(error, _)) => {
            Err(StoreError::of(path, &error))
        }
        Err(other) => Err(StoreError::Schema { path: path.to_path_buf(), said: other.to_string() }),
    }
}
