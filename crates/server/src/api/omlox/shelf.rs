//! Objects that clients have put, as they gave them.

use crate::api::{ApiError, Context};
use crate::store::{StoreError, Writing};
use serde_json::{Map, Value};
use sqlx::Row as _;
use std::collections::BTreeMap;
use std::path::Path;

/// Most objects of a kind.
const MOST: i64 = 20_000;

/// A kind of object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Zones,
    Trackables,
    Providers,
    Fences,
}

impl Kind {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Zones => "zones",
            Self::Trackables => "trackables",
            Self::Providers => "providers",
            Self::Fences => "fences",
        }
    }
}

/// An object.
pub(super) type Object = Map<String, Value>;

fn failed(error: &sqlx::Error) -> ApiError {
    ApiError::of_store(&StoreError::of(Path::new("omlox"), error))
}

async fn write(context: &Context) -> Result<Writing, ApiError> {
    context.store.write().await.map_err(|error| ApiError::of_store(&error))
}

async fn commit(transaction: Writing) -> Result<(), ApiError> {
    transaction.commit().await.map_err(|error| ApiError::of_store(&error))
}

/// All of a kind, by id.
pub(super) async fn all(context: &Context, kind: Kind) -> Result<BTreeMap<String, Object>, ApiError> {
    let query = sqlx::query("SELECT id, body FROM omlox_objects WHERE collection = ?").bind(kind.name());
    let rows = query.fetch_all(context.store.readers()).await.map_err(|error| failed(&error))?;
    let object = |row: &sqlx::sqlite::SqliteRow| -> Result<(String, Object), sqlx::Error> {
        let body: String = row.try_get("body")?;
        let body = serde_json::from_str(&body).map_err(|error| sqlx::Error::Decode(error.into()))?;
        Ok((row.try_get("id")?, body))
    };
    rows.iter().map(object).collect::<Result<_, _>>().map_err(|error| failed(&error))
}

/// Puts one in the place of what was there; false when there was none.
pub(super) async fn put(context: &Context, kind: Kind, id: &str, body: &Object) -> Result<bool, ApiError> {
    let text = serde_json::to_string(body).map_err(|error| ApiError::internal(&error))?;
    let mut transaction = write(context).await?;
    let there =
        sqlx::query("SELECT 1 FROM omlox_objects WHERE collection = ? AND id = ?").bind(kind.name()).bind(id);
    let there = there.fetch_optional(&mut *transaction).await.map_err(|error| failed(&error))?.is_some();
    let count: i64 = sqlx::query_scalar("SELECT count(*) FROM omlox_objects WHERE collection = ?")
        .bind(kind.name())
        .fetch_one(&mut *transaction)
        .await
        .map_err(|error| failed(&error))?;
    if !there && count >= MOST {
        return Err(ApiError::conflict(format!("there are {MOST} {} already", kind.name())));
    }
    let put = sqlx::query("INSERT OR REPLACE INTO omlox_objects (collection, id, body) VALUES (?, ?, ?)");
    put.bind(kind.name())
        .bind(id)
        .bind(text)
        .execute(&mut *transaction)
        .await
        .map_err(|error| failed(&error))?;
    commit(transaction).await?;
    Ok(there)
}

/// Takes one away; false when there was none.
pub(super) async fn remove(context: &Context, kind: Kind, id: &str) -> Result<bool, ApiError> {
    let remove =
        sqlx::query("DELETE FROM omlox_objects WHERE collection = ? AND id = ?").bind(kind.name()).bind(id);
    let mut transaction = write(context).await?;
    let gone = remove.execute(&mut *transaction).await.map_err(|error| failed(&error))?.rows_affected();
    commit(transaction).await?;
    Ok(gone > 0)
}

/// Takes all of a kind away.
pub(super) async fn clear(context: &Context, kind: Kind) -> Result<u64, ApiError> {
    let clear = sqlx::query("DELETE FROM omlox_objects WHERE collection = ?").bind(kind.name());
    let mut transaction = write(context).await?;
    let gone = clear.execute(&mut *transaction).await.map_err(|error| failed(&error))?.rows_affected();
    commit(transaction).await?;
    Ok(gone)
}
