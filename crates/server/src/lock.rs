//! One server for each data folder.

use crate::error::ServerError;
use std::fs::{File, OpenOptions, TryLockError};
use std::path::Path;

/// Name of the file that is locked.
const NAME: &str = "lock";

/// Held while a server works on a folder; the system lets it go when the process ends, however it ends. The file stays.
#[derive(Debug)]
pub(crate) struct FolderLock {
    _file: File,
}

impl FolderLock {
    /// Takes the folder, or says that another process has it.
    pub fn take(folder: &Path) -> Result<Self, ServerError> {
        let path = folder.join(NAME);
        let io = |source| ServerError::io(&path, source);
        let file = OpenOptions::new().write(true).create(true).truncate(false).open(&path).map_err(io)?;
        match file.try_lock() {
            Ok(()) => Ok(Self { _file: file }),
            Err(TryLockError::WouldBlock) => Err(ServerError::FolderTaken { folder: folder.to_path_buf() }),
            Err(TryLockError::Error(source)) => Err(io(source)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Tested = Result<(), Box<dyn std::error::Error>>;

    #[test]
    fn a_folder_is_held_by_one_at_a_time() -> Tested {
        let folder = tempfile::tempdir()?;
        let held = FolderLock::take(folder.path())?;
        let told = FolderLock::take(folder.path()).err().ok_or("taken twice")?.to_string();
        assert_eq!(told, format!("{}: another server works on this folder", folder.path().display()));
        drop(held);
        FolderLock::take(folder.path())?;
        Ok(())
    }
}
