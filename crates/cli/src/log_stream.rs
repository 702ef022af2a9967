//! Several logs as one stream in order of time.
//!
//! Logs on one clock are merged by time: consecutive parts of a recording, in whatever order they were named, or one file per
//! sensor. What cannot be one person's log is an error: inertial samples of two logs that overlap in time. What comes by radio may
//! be late or ahead ([`adit_observation::order`]): it keeps its place among the sensors of its own log.
//! Memory: the read-ahead of each reader.

use crate::mounting::{Finding, MountingCheck};
use adit_core::time::Time;
use adit_observation::order::DEFAULT_GAP_LIMIT;
use adit_observation::sidecar::Sidecar;
use adit_observation::{ImuSample, LogReader, LogWarning, Observation, open};
use anyhow::{Result, bail};
use std::path::{Path, PathBuf};

/// Logs being read as one.
pub struct LogStream {
    parts: Vec<Part>,
    /// The log that gave the last inertial sample, and its time.
    inertial: Option<(usize, Time)>,
    warnings: Vec<String>,
}

struct Part {
    reader: LogReader,
    next: Option<Observation>,
    /// The last time of the tag's own sensors in this log.
    clock: Option<Time>,
    /// Gravity against the mounting that its sidecar declares.
    mounting: Option<MountingCheck>,
    /// Another log has taken over the inertial samples from this one.
    superseded: bool,
}

impl Part {
    /// When its next observation is due: at its time, but what is heard ahead of this log's own sensors must not hold them up.
    fn turn(&self) -> Option<Time> {
        let observation = self.next.as_ref()?;
        let time = observation.time();
        match self.clock {
            Some(clock) if !observation.kind().is_wired() => Some(time.min(clock)),
            _ => Some(time),
        }
    }
}

impl LogStream {
    /// Opens all logs and reads their headers and first samples.
    pub fn open(paths: &[PathBuf]) -> Result<Self> {
        Self::open_with(paths, None)
    }

    /// The same with this sidecar in place of those beside the logs, where there is one.
    pub fn open_with(paths: &[PathBuf], sidecar: Option<&Sidecar>) -> Result<Self> {
        let part = |path: &PathBuf| -> Result<Part> {
            let mut reader = open(path)?;
            if let Some(sidecar) = sidecar {
                reader = reader.with_sidecar(path.clone(), sidecar.clone());
            }
            tracing::info!("reading {} as {:?}", path.display(), reader.kind());
            let next = reader.next().transpose()?;
            let mounting = reader.sidecar().and_then(MountingCheck::of);
            Ok(Part { reader, next, clock: None, mounting, superseded: false })
        };
        let parts = paths.iter().map(part).collect::<Result<Vec<_>>>()?;
        Ok(Self { parts, inertial: None, warnings: Vec::new() })
    }

    /// The next observation of all logs; the log named first goes first where times are equal.
    pub fn next(&mut self) -> Result<Option<Observation>> {
        while let Some((index, observation)) = self.take_earliest()? {
            if matches!(observation, Observation::Imu(_) | Observation::Acceleration(_))
                && self.repeats(index, observation.time())?
            {
                continue;
            }
            if let Observation::Imu(sample) = &observation {
                self.check_mounting(index, sample)?;
            }
            return Ok(Some(observation));
        }
        Ok(None)
    }

    fn take_earliest(&mut self) -> Result<Option<(usize, Observation)>> {
        let earliest = (0..self.parts.len())
            .filter_map(|index| Some((self.parts[index].turn()?, index)))
            .min()
            .map(|(_, index)| index);
        let Some(index) = earliest else { return Ok(None) };
        let part = &mut self.parts[index];
        if let Some(observation) = &part.next
            && observation.kind().is_wired()
        {
            part.clock = Some(observation.time());
        }
        let following = part.reader.next().transpose()?;
        Ok(std::mem::replace(&mut part.next, following).map(|observation| (index, observation)))
    }

    /// Checks an inertial sample against those of other logs; true when it repeats the time of the one before.
    fn repeats(&mut self, index: usize, time: Time) -> Result<bool> {
        let Some((before_index, before)) = self.inertial.replace((index, time)) else { return Ok(false) };
        if before_index == index {
            return Ok(false);
        }
        self.parts[before_index].superseded = true;
        let (from, to) = (self.file(before_index).display(), self.file(index).display());
        if self.parts[index].superseded {
            bail!(
                "{to}: an inertial sample at {time} s lies between those of {from}, expected logs that do not overlap \
                 (parts of one recording, on one clock)"
            );
        }
        let gap = time - before;
        if gap > DEFAULT_GAP_LIMIT {
            let gap_s = gap.seconds();
            let text = format!(
                "{to}: no inertial sample for {gap_s} s since the end of {from} ({before} s to {time} s)"
            );
            self.warnings.push(text);
        }
        Ok(time == before)
    }

    fn check_mounting(&mut self, index: usize, sample: &ImuSample) -> Result<()> {
        let part = &mut self.parts[index];
        let Some(check) = &mut part.mounting else { return Ok(()) };
        match check.observe(sample) {
            Finding::Fits => Ok(()),
            Finding::Refused(why) => bail!("{}: {why}", part.reader.file().display()),
            Finding::TurnedOver(how) => {
                self.warnings.push(format!("{}: {how}", part.reader.file().display()));
                Ok(())
            }
        }
    }

    fn file(&self, index: usize) -> &Path {
        self.parts[index].reader.file()
    }

    /// Everything that was odd so far; complete at the end of the stream.
    pub fn warnings(&self) -> Vec<String> {
        let of_parts =
            self.parts.iter().flat_map(|part| part.reader.warnings().iter().map(LogWarning::to_string));
        of_parts.chain(self.warnings.iter().cloned()).collect()
    }

    /// What is known beside the numbers: the sidecar of the first log that has one.
    pub fn sidecar(&self) -> Option<&Sidecar> {
        self.parts.iter().find_map(|part| part.reader.sidecar())
    }

    /// Names of the logs, for messages.
    pub fn name(&self) -> String {
        let names: Vec<String> = self.parts.iter().map(|p| p.reader.file().display().to_string()).collect();
        names.join(", ")
    }

    /// Bytes read so far of all files.
    pub fn bytes_read(&self) -> u64 {
        self.parts.iter().map(|part| part.reader.bytes_read()).sum()
    }

    /// Length of all files; `None` when one is a pipe.
    pub fn bytes_total(&self) -> Option<u64> {
        self.parts.iter().map(|part| part.reader.bytes_total()).sum()
    }
}
