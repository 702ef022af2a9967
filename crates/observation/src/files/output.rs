//! Files that appear whole or not at all.

use crate::error::LogError;
use flate2::Compression;
use flate2::write::GzEncoder;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::TempPath;

/// A file under construction: bytes go to a temporary file in the same directory, and [`AtomicFile::finish`] renames it to its
/// name. Dropped before that, it leaves nothing behind, and a file of that name stays as it was.
///
/// A name that ends in `.gz` is compressed. What is not a regular file (a pipe, `/dev/stdout`) is written directly.
pub struct AtomicFile {
    target: PathBuf,
    sink: Sink,
    temporary: Option<TempPath>,
}

enum Sink {
    Plain(BufWriter<File>),
    Gzip(GzEncoder<BufWriter<File>>),
}

impl AtomicFile {
    /// Starts the file that will be called `path`.
    pub fn create(path: impl AsRef<Path>) -> Result<Self, LogError> {
        let target = path.as_ref().to_path_buf();
        let io = |source| LogError::Io { file: target.clone(), doing: "create it", source };
        let special = target.metadata().is_ok_and(|m| !m.is_file());
        let (file, temporary) = if special {
            (File::options().write(true).open(&target).map_err(io)?, None)
        } else {
            let directory = match target.parent() {
                Some(parent) if !parent.as_os_str().is_empty() => parent,
                _ => Path::new("."),
            };
            let mut builder = tempfile::Builder::new();
            builder.prefix(".adit-").suffix(".part");
            #[cfg(unix)]
            {
                use std::os::unix::fs::PermissionsExt;
                // The usual mode of a new file: the process's umask takes its share off.
                builder.permissions(std::fs::Permissions::from_mode(0o666));
            }
            let (file, temporary) = builder.tempfile_in(directory).map_err(io)?.into_parts();
            (file, Some(temporary))
        };
        let buffered = BufWriter::with_capacity(1 << 16, file);
        let sink = if target.extension().is_some_and(|e| e == "gz") {
            Sink::Gzip(GzEncoder::new(buffered, Compression::default()))
        } else {
            Sink::Plain(buffered)
        };
        Ok(Self { target, sink, temporary })
    }

    /// The name it will have.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Completes the file, puts it on the disk and gives it its name.
    pub fn finish(self) -> Result<(), LogError> {
        let Self { target, sink, temporary } = self;
        let io = |source| LogError::Io { file: target.clone(), doing: "write it", source };
        let buffered = match sink {
            Sink::Plain(buffered) => buffered,
            Sink::Gzip(encoder) => encoder.finish().map_err(io)?,
        };
        let file = buffered.into_inner().map_err(|e| io(e.into_error()))?;
        if let Some(temporary) = temporary {
            file.sync_all().map_err(io)?;
            drop(file);
            temporary.persist(&target).map_err(|e| io(e.error))?;
        }
        Ok(())
    }

    /// The error for a failed write.
    pub(crate) fn error(&self, source: io::Error) -> LogError {
        LogError::Io { file: self.target.clone(), doing: "write it", source }
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.sink {
            Sink::Plain(sink) => sink.write(bytes),
            Sink::Gzip(sink) => sink.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.sink {
            Sink::Plain(sink) => sink.flush(),
            Sink::Gzip(sink) => sink.flush(),
        }
    }
}
