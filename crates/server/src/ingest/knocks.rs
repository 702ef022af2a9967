//! Whoever knocks at the API is let in by the door of the journal.

use super::door::{self, Door, Source};
use crate::api::{CommandError, DoorError, Knock, PositionReport, Receipt};
use tokio::sync::mpsc;

/// Lets in whoever knocks, each by itself, until nobody can any more.
pub async fn answer(door: Door, mut knocks: mpsc::Receiver<Knock>) {
    while let Some(knock) = knocks.recv().await {
        let door = door.clone();
        tokio::spawn(async move { one(&door, knock).await });
    }
}

/// Whoever knocked may have gone: nobody is told then.
async fn one(door: &Door, knock: Knock) {
    match knock {
        Knock::Batch { from, bytes, answer } => {
            let json = from.content_type.starts_with("application/json");
            let stored = door.batch(Source { name: from.name, json }, bytes).await;
            let _ = answer.send(stored.map(receipt).map_err(|error| told(&error)));
        }
        Knock::Position { report, answer } => {
            let PositionReport { tag, time, position_m, radius_95_m } = report;
            let report = door::PositionReport { tag, time, position_m, radius_95_m };
            let stored = door.position(report).await;
            let _ = answer.send(stored.map(receipt).map_err(|error| told(&error)));
        }
        Knock::Command { actor, command, answer } => {
            let done = door.command(actor, *command).await.map_err(|error| match error {
                door::CommandError::Refused(refused) => CommandError::Refused(refused),
                door::CommandError::Door(error) => CommandError::Door(told(&error)),
            });
            let _ = answer.send(done);
        }
    }
}

fn receipt(receipt: door::Receipt) -> Receipt {
    Receipt { position: receipt.position.unwrap_or_default(), repeated: receipt.repeated }
}

fn told(error: &door::DoorError) -> DoorError {
    match error {
        door::DoorError::Busy => DoorError::Busy,
        door::DoorError::NoAnswer => DoorError::NoAnswer,
        door::DoorError::NotStored(why) => DoorError::NotStored(why.to_string()),
        _ => DoorError::Malformed(error.to_string()),
    }
}
