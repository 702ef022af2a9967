//! The one way in.

use crate::journal::{
    Appended, Committer, GatewayBatch, GatewayStatus, NotStored, Numbered, OutsidePosition, Position, Spans,
    UserCommand, What,
};
use crate::pipeline::{Asked, TagHealth};
use crate::seldom::Seldom;
use adit_core::frames::MineGrid;
use adit_core::time::Time;
use adit_observation::wire::{Batch, Packet, Resolution, WireError};
use adit_tracking::{Command, Outcome, Refused};
use prost::bytes::Bytes;
use serde::{Deserialize, Serialize};
use std::sync::mpsc::Sender;
use std::time::Duration;
use tokio::sync::oneshot;
use tokio::time::timeout;

/// A batch is no longer, bytes.
pub const LARGEST_BATCH: usize = 16 << 20;
/// How long somebody waits for the journal.
pub const PATIENCE: Duration = Duration::from_secs(5);
/// Names of gateways are no longer, bytes.
const LONGEST_NAME: usize = 128;

/// The one way in; cheap to clone.
#[derive(Clone)]
pub struct Door {
    committer: Committer,
    asked: Sender<Asked>,
}

/// What became of something; it is on the disk.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Receipt {
    /// Its place in the journal; `None` when it had come before.
    pub position: Option<Position>,
    /// It had come before.
    pub repeated: bool,
}

/// Who sent a batch, and in which form.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// Name of the gateway.
    pub name: String,
    /// The body is JSON ([`JsonBatch`]), not protobuf.
    pub json: bool,
}

/// Why something was not taken.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DoorError {
    /// It is no batch.
    #[error(transparent)]
    Bad(#[from] WireError),
    /// It is no JSON of a batch.
    #[error("{0}")]
    Json(String),
    /// A name that is none.
    #[error("{what} {found:?}: expected 1 to 128 bytes without '/', '+', '#' and control characters")]
    Name {
        /// Of what.
        what: &'static str,
        /// The name.
        found: String,
    },
    /// Too long.
    #[error("{found} bytes: a batch has at most {LARGEST_BATCH}")]
    TooLong {
        /// How long it is.
        found: usize,
    },
    /// A number that is none.
    #[error("{what}: found {found}, expected {expected}")]
    Number {
        /// Which.
        what: &'static str,
        /// Its value.
        found: f64,
        /// What it should be.
        expected: &'static str,
    },
    /// The server stops, or has not answered in time.
    #[error("stored, but no answer within 5 s: it may not have been applied yet")]
    NoAnswer,
    /// The journal is behind.
    #[error("the server is behind: send it again in a few seconds")]
    Busy,
    /// The journal did not take it.
    #[error(transparent)]
    NotStored(#[from] NotStored),
}

impl DoorError {
    /// Sent again it would be refused again.
    pub const fn is_senders_fault(&self) -> bool {
        !matches!(self, Self::Busy | Self::NoAnswer | Self::NotStored(_))
    }
}

/// Why a command was not done.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CommandError {
    /// It was refused, with the reason.
    #[error(transparent)]
    Refused(#[from] Refused),
    /// It did not get through.
    #[error(transparent)]
    Door(#[from] DoorError),
}

/// A position that another system found.
#[derive(Debug, Clone, PartialEq)]
pub struct PositionReport {
    /// The tag.
    pub tag: String,
    /// When it was there; now where nobody says.
    pub time: Option<Time>,
    /// Where, m.
    pub position_m: adit_core::frames::Position<MineGrid>,
    /// Radius of the horizontal circle that holds it with 95 %, m; [`UNKNOWN_RADIUS_M`] where nobody says.
    pub radius_95_m: Option<f64>,
}

/// Radius of a position of which nobody says how good it is, m: by a gate or a beacon, the worst that is sold as positioning.
pub const UNKNOWN_RADIUS_M: f64 = 25.0;

/// A batch as JSON: the same as the protobuf message, single readings only.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct JsonBatch {
    /// Drawn at random each time the gateway starts.
    pub boot: u64,
    /// Number of the batch since then, from 1.
    pub sequence: u64,
    /// Packets of tags.
    #[serde(default)]
    pub packets: Vec<Packet>,
}

impl Door {
    /// In front of this journal and the pipeline behind it.
    pub fn new(committer: Committer, asked: Sender<Asked>) -> Self {
        Self { committer, asked }
    }

    /// How a tag is followed; nothing of a tag that no packet came of.
    pub async fn following(&self, tag: String) -> Option<TagHealth> {
        let (answer, told) = oneshot::channel();
        self.asked.send(Asked::Tag(tag, answer)).ok()?;
        timeout(PATIENCE, told).await.ok()?.ok()?
    }

    /// The numbers of packets that came of each tag: first and last of each span.
    pub async fn packets(&self) -> Option<Vec<(String, Spans)>> {
        let (answer, told) = oneshot::channel();
        self.asked.send(Asked::Packets(answer)).ok()?;
        timeout(PATIENCE, told).await.ok()?.ok()
    }

    /// Stores the batch of a gateway. One that is none is counted.
    pub async fn batch(&self, from: Source, bytes: Bytes) -> Result<Receipt, DoorError> {
        static BAD: Seldom = Seldom::new();
        let gateway = from.name.clone();
        let taken = self.take(from, bytes).await;
        if let Err(error) = &taken
            && error.is_senders_fault()
        {
            metrics::counter!("adit_bad_batches_total").increment(1);
            BAD.warn(format_args!("gateway {gateway:?}: a batch that is none: {error}"));
        }
        taken
    }

    async fn take(&self, from: Source, bytes: Bytes) -> Result<Receipt, DoorError> {
        named("gateway", &from.name)?;
        if bytes.len() > LARGEST_BATCH {
            return Err(DoorError::TooLong { found: bytes.len() });
        }
        let bytes = if from.json { of_json(&bytes)? } else { bytes };
        let Batch { boot, sequence, .. } = Batch::read(bytes.clone())?;
        let what = What::Batch(GatewayBatch { gateway: from.name, batch: bytes });
        self.store(what, Some(Numbered { boot, sequence })).await
    }

    /// Stores that a gateway came or went.
    pub async fn gateway(&self, gateway: &str, up: bool) -> Result<Receipt, DoorError> {
        named("gateway", gateway)?;
        self.store(What::Gateway(GatewayStatus { gateway: gateway.to_owned(), up }), None).await
    }

    /// Stores a position that somebody else has found.
    pub async fn position(&self, report: PositionReport) -> Result<Receipt, DoorError> {
        named("tag", &report.tag)?;
        let [x_m, y_m, z_m] = (*report.position_m.raw()).into();
        if let Some(found) = [x_m, y_m, z_m].into_iter().find(|v: &f64| v.is_nan() || v.abs() > 1e7) {
            return Err(DoorError::Number { what: "position", found, expected: "at most 10,000 km" });
        }
        let radius_95_m = report.radius_95_m.unwrap_or(UNKNOWN_RADIUS_M);
        if !(0.0..=1e5).contains(&radius_95_m) {
            return Err(DoorError::Number { what: "accuracy", found: radius_95_m, expected: "0 to 100 km" });
        }
        let time_ns = report.time.map(Time::nanos);
        let what = What::Position(OutsidePosition { tag: report.tag, time_ns, x_m, y_m, z_m, radius_95_m });
        self.store(what, None).await
    }

    /// Stores a command and waits until it was applied.
    pub async fn command(&self, actor: String, command: Command) -> Result<Outcome, CommandError> {
        let json = serde_json::to_string(&command).map_err(|error| DoorError::Json(error.to_string()))?;
        let what = What::Command(UserCommand { actor, command: json });
        let (waiting, outcome) = oneshot::channel();
        let stored = timeout(PATIENCE, self.committer.append_command(what, waiting)).await;
        stored.map_err(|_| DoorError::Busy)?.map_err(DoorError::from)?;
        let outcome = timeout(PATIENCE, outcome).await.map_err(|_| DoorError::NoAnswer)?;
        Ok(outcome.map_err(|_| DoorError::NoAnswer)??)
    }

    /// A second has passed.
    pub async fn tick(&self) -> Result<Receipt, DoorError> {
        self.store(What::Tick(()), None).await
    }

    async fn store(&self, what: What, number: Option<Numbered>) -> Result<Receipt, DoorError> {
        let stored =
            timeout(PATIENCE, self.committer.append(what, number)).await.map_err(|_| DoorError::Busy)?;
        Ok(match stored? {
            Appended::At(position) => Receipt { position: Some(position), repeated: false },
            Appended::Repeated => Receipt { position: None, repeated: true },
        })
    }
}

/// A batch in JSON as protobuf. Readings at even times become counts, to half of which they are rounded: finer than any sensor.
fn of_json(bytes: &[u8]) -> Result<Bytes, DoorError> {
    let batch: JsonBatch =
        serde_json::from_slice(bytes).map_err(|error| DoorError::Json(error.to_string()))?;
    let mut wire = Batch::new(batch.boot, batch.sequence);
    for packet in &batch.packets {
        wire = wire.with_packet(packet, &Resolution::default());
    }
    Ok(wire.to_bytes().into())
}

fn named(what: &'static str, name: &str) -> Result<(), DoorError> {
    let fits = (1..=LONGEST_NAME).contains(&name.len());
    if fits && !name.chars().any(|c| c.is_control() || matches!(c, '/' | '+' | '#')) {
        return Ok(());
    }
    Err(DoorError::Name { what, found: name.chars().take(LONGEST_NAME).collect() })
}
