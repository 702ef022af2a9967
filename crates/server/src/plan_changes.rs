//! What users have changed in the plan of the mine: anchors put, moved and taken away.
//!
//! The mine's file stays as it is. Changes stand beside the data, in `plan-changes.json`, and are in force from the next start on:
//! estimators know their anchors from the beginning, and what the journal holds is taken again with those that it was measured with.

use crate::error::ServerError;
use adit_core::frames::Position;
use adit_mine::Mine;
use adit_mine::plan::{Anchor, MinePlan};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use tokio::sync::Mutex;

/// Name of the file.
const NAME: &str = "plan-changes.json";

/// What becomes of an anchor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AnchorChange {
    /// Where it is: east, north, height, m; nowhere any more when missing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_m: Option<[f64; 3]>,
    /// Its name for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
}

/// All changes of a plan.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanChanges {
    /// By the id of the anchor.
    pub anchors: BTreeMap<String, AnchorChange>,
}

impl PlanChanges {
    /// Those of a data folder; none where there is no file.
    pub fn read(folder: &Path) -> Result<Self, ServerError> {
        let path = folder.join(NAME);
        let text = match std::fs::read(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Self::default()),
            Err(source) => return Err(ServerError::io(&path, source)),
        };
        serde_json::from_slice(&text).map_err(|error| ServerError::Plan { path, what: error.to_string() })
    }

    /// The file is there whole, or as it was.
    fn write(&self, folder: &Path) -> Result<(), ServerError> {
        let path = folder.join(NAME);
        let io = |source| ServerError::io(&path, source);
        let mut file = tempfile::NamedTempFile::new_in(folder).map_err(io)?;
        serde_json::to_writer_pretty(&mut file, self).map_err(|error| io(error.into()))?;
        file.flush().and_then(|()| file.as_file().sync_all()).map_err(io)?;
        file.persist(&path).map(drop).map_err(|error| io(error.error))
    }

    /// The plan with the changes. An anchor that is moved keeps what was calibrated.
    pub fn applied(&self, plan: &MinePlan) -> MinePlan {
        let mut plan = plan.clone();
        for (id, change) in &self.anchors {
            let known = plan.anchors.iter().position(|anchor| anchor.id == *id);
            match (known, change.position_m) {
                (Some(index), Some([x, y, z])) => plan.anchors[index].position_m = Position::new(x, y, z),
                (Some(index), None) => drop(plan.anchors.remove(index)),
                (None, Some([x, y, z])) => plan.anchors.push(Anchor {
                    id: id.clone(),
                    position_m: Position::new(x, y, z),
                    range_offset_m: None,
                    antenna_delay_ns: None,
                    tx_power_dbm: None,
                }),
                (None, None) => {}
            }
        }
        plan
    }
}

/// A mine with the changes that stand in a data folder.
pub fn with_changes(mine: Mine, folder: &Path) -> Result<Mine, ServerError> {
    let changes = PlanChanges::read(folder)?;
    if changes == PlanChanges::default() {
        return Ok(mine);
    }
    let path = folder.join(NAME);
    Mine::new(changes.applied(mine.plan()))
        .map_err(|error| ServerError::Plan { path, what: error.to_string() })
}

/// Who writes the changes of a data folder.
#[derive(Debug)]
pub struct PlanDesk {
    folder: PathBuf,
    changes: Mutex<PlanChanges>,
}

impl PlanDesk {
    /// Of a folder.
    pub fn open(folder: &Path) -> Result<Self, ServerError> {
        Ok(Self { folder: folder.to_path_buf(), changes: Mutex::new(PlanChanges::read(folder)?) })
    }

    /// The changes so far.
    pub async fn changes(&self) -> PlanChanges {
        self.changes.lock().await.clone()
    }

    /// Changes an anchor, where the plan stays sound; when it is back, the change is on the disk.
    pub async fn change(&self, plan: &MinePlan, id: String, change: AnchorChange) -> Result<(), ServerError> {
        let mut changes = self.changes.lock().await;
        let mut changed = changes.clone();
        changed.anchors.insert(id, change);
        let (plan, folder) = (changed.applied(plan), self.folder.clone());
        let path = folder.join(NAME);
        // Checking a plan and waiting for a disk are no work for a thread that answers others.
        let written = tokio::task::spawn_blocking(move || {
            Mine::new(plan).map_err(|error| ServerError::Plan { path, what: error.to_string() })?;
            changed.write(&folder)?;
            Ok::<_, ServerError>(changed)
        });
        *changes = written.await.map_err(|_| ServerError::Stopped)??;
        Ok(())
    }
}
