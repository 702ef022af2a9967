//! What can go wrong in the server.

/// What can go wrong in the server, with what was found.
#[derive(Debug, thiserror::Error)]
pub enum ServerError {
    /// A file or folder could not be read or written.
    #[error("{path}: {source}")]
    Io {
        /// Of which file.
        path: std::path::PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The store failed.
    #[error(transparent)]
    Store(#[from] crate::store::StoreError),
}
