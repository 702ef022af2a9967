//! The way from the API into the journal: what is asked for, and the answer when it is stored and applied.

use adit_core::frames::{MineGrid, Position};
use adit_core::time::Time;
use adit_tracking::{Command, Outcome, Refused};
use axum::body::Bytes;
use std::time::Duration;
use tokio::sync::{mpsc, oneshot};

/// How long the API waits for an answer.
const PATIENCE: Duration = Duration::from_secs(15);

/// Something to be stored and applied; whoever receives it answers.
#[derive(Debug)]
pub enum Knock {
    /// A batch of observations.
    Batch {
        /// Who sent it and in which form.
        from: Source,
        /// The body as it came.
        bytes: Bytes,
        /// The answer.
        answer: oneshot::Sender<Result<Receipt, DoorError>>,
    },
    /// A position that another system found.
    Position {
        /// The position.
        report: PositionReport,
        /// The answer.
        answer: oneshot::Sender<Result<Receipt, DoorError>>,
    },
    /// What a user wants.
    Command {
        /// Name of the user or token.
        actor: String,
        /// What.
        command: Box<Command>,
        /// The answer, when it was applied.
        answer: oneshot::Sender<Result<Outcome, CommandError>>,
    },
}

/// Who sent a batch, and in which form.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// Name of the token or user.
    pub name: String,
    /// `Content-Type` of the body, as it came.
    pub content_type: String,
}

/// What became of a batch or a position; it is on the disk.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Receipt {
    /// Entry of the journal that holds it; that of before when it came again.
    pub position: u64,
    /// It had come before.
    pub repeated: bool,
}

/// A position that another system found.
#[derive(Debug, Clone, PartialEq)]
pub struct PositionReport {
    /// The tag.
    pub tag: String,
    /// When it was there; now where nobody says.
    pub time: Option<Time>,
    /// Where, m.
    pub position_m: Position<MineGrid>,
    /// Radius of the horizontal circle that holds it with 95 %, m; unknown where nobody says.
    pub radius_95_m: Option<f64>,
}

/// Why nothing was stored.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DoorError {
    /// It cannot be read.
    #[error("{0}")]
    Malformed(String),
    /// Too much waits already: try again.
    #[error("too much waits already")]
    Busy,
    /// The journal cannot write.
    #[error("not stored: {0}")]
    NotStored(String),
    /// The server stops, or has not answered in time: it may have been stored.
    #[error("no answer within 15 s, or the server is stopping; it may have been done")]
    NoAnswer,
}

/// Why a command was not done.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CommandError {
    /// It cannot be.
    #[error(transparent)]
    Refused(#[from] Refused),
    /// It was not stored.
    #[error(transparent)]
    Door(#[from] DoorError),
}

/// The door; cheap to clone.
#[derive(Debug, Clone)]
pub struct Door {
    knocks: mpsc::Sender<Knock>,
}

impl Door {
    /// A door, and the other side of it. So many may wait; who comes then is told to come again.
    pub fn new(waiting: usize) -> (Self, mpsc::Receiver<Knock>) {
        let (knocks, heard) = mpsc::channel(waiting.max(1));
        (Self { knocks }, heard)
    }

    /// Stores a batch of observations.
    pub async fn batch(&self, from: Source, bytes: Bytes) -> Result<Receipt, DoorError> {
        self.knock(|answer| Knock::Batch { from, bytes, answer }).await?
    }

    /// Stores a position from outside.
    pub async fn position(&self, report: PositionReport) -> Result<Receipt, DoorError> {
        self.knock(|answer| Knock::Position { report, answer }).await?
    }

    /// Stores a command and waits until it was applied.
    pub async fn command(&self, actor: String, command: Command) -> Result<Outcome, CommandError> {
        let command = Box::new(command);
        self.knock(|answer| Knock::Command { actor, command, answer }).await?
    }

    async fn knock<T>(&self, of: impl FnOnce(oneshot::Sender<T>) -> Knock) -> Result<T, DoorError> {
        let (answer, answered) = oneshot::channel();
        self.knocks.try_send(of(answer)).map_err(|error| match error {
            mpsc::error::TrySendError::Full(_) => DoorError::Busy,
            mpsc::error::TrySendError::Closed(_) => DoorError::NoAnswer,
        })?;
        match tokio::time::timeout(PATIENCE, answered).await {
            Ok(Ok(answer)) => Ok(answer),
            Ok(Err(_)) | Err(_) => Err(DoorError::NoAnswer),
        }
    }
}
