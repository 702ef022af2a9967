//! Copies of the store, made while it is in use, in the folder `backups` beside it.

use crate::api::extract::Caller;
use crate::api::{ApiError, Context, Timestamp};
use crate::now;
use crate::store::StoreError;
use adit_core::time::Time;
use axum::extract::State;
use axum::http::StatusCode;
use jiff::tz::TimeZone;
use serde::Serialize;
use serde_json::json;
use std::fs::Metadata;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::UNIX_EPOCH;
use tokio::sync::Mutex;
use utoipa::ToSchema;

/// One at a time: each reads and writes the whole store.
static UNDER_WAY: Mutex<()> = Mutex::const_new(());

/// A copy of the store.
#[derive(Serialize, ToSchema)]
pub(super) struct Backup {
    /// Its file, in `backups` of the data folder.
    name: String,
    bytes: u64,
    /// When it was done.
    time: Timestamp,
}

impl Backup {
    fn new(name: String, file: &Metadata) -> io::Result<Self> {
        let since = file.modified()?.duration_since(UNIX_EPOCH).unwrap_or_default();
        let time = Time::from_nanos(i64::try_from(since.as_nanos()).unwrap_or(i64::MAX));
        Ok(Self { name, bytes: file.len(), time: time.into() })
    }
}

fn folder(context: &Context) -> PathBuf {
    context.store.path().parent().unwrap_or(Path::new("")).join("backups")
}

fn failed(path: &Path, error: &io::Error) -> ApiError {
    ApiError::of_store(&StoreError::Io { path: path.to_path_buf(), said: error.to_string() })
}

/// Copies that are there, the newest first.
#[utoipa::path(get, path = "/api/v1/backups", tag = "settings", responses((status = 200, description = "copies", body = Vec<Backup>)))]
pub(super) async fn list(State(context): State<Arc<Context>>) -> Result<axum::Json<Vec<Backup>>, ApiError> {
    let folder = folder(&context);
    let files = match std::fs::read_dir(&folder) {
        Ok(files) => files,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(axum::Json(Vec::new())),
        Err(error) => return Err(failed(&folder, &error)),
    };
    let mut backups = Vec::new();
    for file in files {
        let file = file.map_err(|error| failed(&folder, &error))?;
        let name = file.file_name().to_string_lossy().into_owned();
        // What is still being written has another name.
        if name.ends_with(".sqlite") {
            let backup = file.metadata().and_then(|file| Backup::new(name, &file));
            backups.push(backup.map_err(|error| failed(&folder, &error))?);
        }
    }
    backups.sort_by(|a, b| b.name.cmp(&a.name));
    Ok(axum::Json(backups))
}

/// Copies the store as it is now; the server goes on meanwhile. The answer comes when the copy is on the disk.
#[utoipa::path(post, path = "/api/v1/backups", tag = "settings", responses((status = 201, description = "copied", body = Backup)))]
pub(super) async fn make(
    State(context): State<Arc<Context>>,
    caller: Caller,
) -> Result<(StatusCode, axum::Json<Backup>), ApiError> {
    // Who asked may go; the copy is made all the same, once.
    let made = tokio::spawn(async move {
        let Ok(_one) = UNDER_WAY.try_lock() else {
            return Err(ApiError::conflict("a backup is being made"));
        };
        let made = copy(&context).await;
        let (how, name) = match &made {
            Ok(backup) => ("done", Some(backup.name.clone())),
            Err(_) => ("failed", None),
        };
        context.audit(&caller, "backup", how, json!({ "name": name })).await?;
        made
    });
    let made = made.await.map_err(|error| ApiError::internal(&error))??;
    Ok((StatusCode::CREATED, axum::Json(made)))
}

async fn copy(context: &Context) -> Result<Backup, ApiError> {
    let folder = folder(context);
    std::fs::create_dir_all(&folder).map_err(|error| failed(&folder, &error))?;
    let stamp = jiff::Timestamp::from_nanosecond(now().nanos().into());
    let stamp = stamp.map_err(|error| ApiError::internal(&error))?.to_zoned(TimeZone::UTC);
    let name = format!("adit-{}.sqlite", stamp.strftime("%Y%m%dT%H%M%S%3fZ"));
    let path = folder.join(&name);
    context.store.backup(&path).await.map_err(|error| ApiError::of_store(&error))?;
    let file = std::fs::metadata(&path).map_err(|error| failed(&path, &error))?;
    Backup::new(name, &file).map_err(|error| failed(&path, &error))
}
