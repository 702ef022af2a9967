use crate::error::LogError;
use crate::files::AtomicFile;
use adit_core::time::Time;
use adit_core::trajectory::{Pose, Trajectory};
use std::io::Write;
use std::path::Path;

/// Writes a TUM file pose by pose; the file appears at [`TumWriter::finish`], and not at all when dropped before.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("walk.tum");
/// use adit_core::{nalgebra::Vector3, time::Time, trajectory::Pose, attitude::Attitude};
/// use adit_observation::tum::{self, TumWriter};
///
/// let mut file = TumWriter::create(&path)?;
/// file.push(&Pose { time: Time::ZERO, position_m: Vector3::zeros(), attitude: Attitude::identity() })?;
/// file.finish()?;
/// assert_eq!(tum::read(&path)?.len(), 1);
/// # Ok(())
/// # }
/// ```
pub struct TumWriter {
    file: AtomicFile,
    latest: Option<Time>,
}

impl TumWriter {
    /// Starts a file; `.gz` at the end of the name compresses it.
    pub fn create(path: impl AsRef<Path>) -> Result<Self, LogError> {
        let mut file = AtomicFile::create(path)?;
        writeln!(file, "# time_s x_m y_m z_m qx qy qz qw").map_err(|e| file.error(e))?;
        Ok(Self { file, latest: None })
    }

    /// Writes one pose; its time must come after the one before and its numbers must be finite.
    pub fn push(&mut self, pose: &Pose) -> Result<(), LogError> {
        let Pose { time, position_m: p, attitude } = pose;
        let q = attitude.coords;
        let refuse = |what| Err(LogError::CannotWrite { file: self.file.target().to_path_buf(), what });
        if let Some(before) = self.latest
            && *time <= before
        {
            return refuse(format!("a pose at {time} s after one at {before} s"));
        }
        if !p.iter().chain(q.iter()).all(|v| v.is_finite()) {
            return refuse(format!("the pose at {time} s has a component that is not a finite number"));
        }
        self.latest = Some(*time);
        writeln!(self.file, "{time} {} {} {} {} {} {} {}", p.x, p.y, p.z, q.x, q.y, q.z, q.w)
            .map_err(|e| self.file.error(e))
    }

    /// Completes the file and gives it its name.
    pub fn finish(self) -> Result<(), LogError> {
        self.file.finish()
    }
}

/// Writes a whole trajectory.
pub fn write(path: impl AsRef<Path>, trajectory: &Trajectory) -> Result<(), LogError> {
    let mut file = TumWriter::create(path)?;
    for pose in trajectory.poses() {
        file.push(pose)?;
    }
    file.finish()
}
