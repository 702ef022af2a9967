//! One thread that writes what waits, syncs once, and acknowledges.

use super::entry::{Entry, GatewayBatch, What};
use super::seen::Seen;
use super::{Journal, Position};
use crate::api::{Health, Part};
use crate::error::ServerError;
use crate::seldom::Seldom;
use adit_core::time::Time;
use adit_tracking::{Outcome, Refused};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::Instant;
use tokio::sync::{mpsc, oneshot};

/// Entries that wait to be written; more hold up those who bring them.
const MOST_WAITING: usize = 8192;
/// Entries written together.
const MOST_TOGETHER: usize = 4096;
/// Groups that wait for the pipeline; more hold up the writing.
const MOST_GROUPS: usize = 32;

/// The batch of a gateway, by its own count.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Numbered {
    /// Drawn anew whenever the gateway starts.
    pub boot: u64,
    /// Its number since then.
    pub sequence: u64,
}

/// Where an entry went.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Appended {
    /// It is stored at this position.
    At(Position),
    /// It was stored before.
    Repeated,
}

/// An entry that is not stored: its sender keeps it and sends it again.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NotStored {
    /// The disk is full.
    #[error("not stored: the disk of the journal is full")]
    Full,
    /// The disk failed.
    #[error("not stored: {0}")]
    Failed(String),
    /// The server stops.
    #[error("not stored: the server stops")]
    Stopping,
}

/// What a pipeline takes: an entry, and who waits for what comes of it.
pub struct Committed {
    /// Its position; `None` when the disk would not take it. Positions go on then, but nobody was told that it is stored.
    pub position: Option<Position>,
    /// The entry.
    pub entry: Entry,
    /// Who waits for the outcome of a command.
    pub waiting: Option<Waiting>,
}

/// What was written together.
pub type Group = Vec<Committed>;

/// Where the outcome of a command goes: done, or why not.
pub type Waiting = oneshot::Sender<Result<Outcome, Refused>>;

/// What gateways have sent so far.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Gateways {
    by_name: BTreeMap<String, SeenOfGateway>,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct SeenOfGateway {
    /// Of the last starts, the newest last.
    boots: Vec<(u64, Seen)>,
}

/// Starts of a gateway remembered: what was sent before the last restarts may still come.
const MOST_BOOTS: usize = 4;

impl Gateways {
    fn has(&self, gateway: &str, number: &Numbered) -> bool {
        let seen = self.by_name.get(gateway).map_or([].as_slice(), |gateway| &gateway.boots);
        seen.iter().any(|(boot, seen)| *boot == number.boot && seen.has(number.sequence))
    }

    /// Remembers a batch.
    pub fn insert(&mut self, gateway: &str, number: &Numbered) {
        let boots = &mut self.by_name.entry(gateway.to_owned()).or_default().boots;
        if let Some((_, seen)) = boots.iter_mut().find(|(boot, _)| *boot == number.boot) {
            seen.insert(number.sequence);
            return;
        }
        if boots.len() == MOST_BOOTS {
            boots.remove(0);
        }
        let mut seen = Seen::default();
        seen.insert(number.sequence);
        boots.push((number.boot, seen));
    }

    fn forget(&mut self, gateway: &str, number: &Numbered) {
        let boots = self.by_name.get_mut(gateway).map(|gateway| &mut gateway.boots);
        let seen = boots.into_iter().flatten().find(|(boot, _)| *boot == number.boot);
        if let Some((_, seen)) = seen {
            seen.forget(number.sequence);
        }
    }

    /// Remembers the batch of an entry, where it is one.
    pub fn see(&mut self, entry: &Entry) {
        if let Some(What::Batch(GatewayBatch { gateway, batch })) = &entry.what
            && let Ok(batch) = adit_observation::wire::Batch::read(batch.clone())
        {
            self.insert(gateway, &Numbered { boot: batch.boot, sequence: batch.sequence });
        }
    }

    /// What has come of each start of a gateway: its number, and first and last of each span of batches.
    pub fn of(&self, gateway: &str) -> impl Iterator<Item = (u64, Vec<(u64, u64)>)> + '_ {
        let boots = self.by_name.get(gateway).into_iter().flat_map(|gateway| &gateway.boots);
        boots.map(|(boot, seen)| (*boot, seen.spans().collect()))
    }
}

enum Request {
    Append { what: What, number: Option<Numbered>, waiting: Option<Waiting>, reply: Option<Reply> },
    Gateways(oneshot::Sender<(Position, Gateways)>),
    Trim(Position),
}

type Reply = oneshot::Sender<Result<Appended, NotStored>>;

/// The way to the journal, for whoever brings something.
#[derive(Clone)]
pub struct Committer {
    requests: mpsc::Sender<Request>,
}

impl Committer {
    /// Starts the thread; it ends when the last `Committer` is gone. What is stored comes out of the receiver, in order.
    pub fn start(
        journal: Journal,
        gateways: Gateways,
        now: impl Fn() -> Time + Send + 'static,
        health: Arc<Health>,
    ) -> Result<(Self, Receiver<Group>, JoinHandle<()>), ServerError> {
        let (requests, inbox) = mpsc::channel(MOST_WAITING);
        let (groups, outbox) = sync_channel(MOST_GROUPS);
        let mut desk = Desk { journal, gateways, groups, now, health };
        let thread = std::thread::Builder::new().name("journal".to_owned()).spawn(move || desk.run(inbox));
        let thread = thread.map_err(|source| ServerError::Thread { name: "journal", source })?;
        Ok((Self { requests }, outbox, thread))
    }

    /// Stores an entry and says where; waits while the journal is behind.
    pub async fn append(&self, what: What, number: Option<Numbered>) -> Result<Appended, NotStored> {
        let (reply, stored) = oneshot::channel();
        let request = Request::Append { what, number, waiting: None, reply: Some(reply) };
        self.requests.send(request).await.map_err(|_| NotStored::Stopping)?;
        stored.await.map_err(|_| NotStored::Stopping)?
    }

    /// Stores a command; its outcome goes to `waiting` when it is applied.
    pub async fn append_command(&self, what: What, waiting: Waiting) -> Result<Appended, NotStored> {
        let (reply, stored) = oneshot::channel();
        let request = Request::Append { what, number: None, waiting: Some(waiting), reply: Some(reply) };
        self.requests.send(request).await.map_err(|_| NotStored::Stopping)?;
        stored.await.map_err(|_| NotStored::Stopping)?
    }

    /// What gateways have sent, and the position up to which that counts.
    pub async fn gateways(&self) -> Option<(Position, Gateways)> {
        let (reply, told) = oneshot::channel();
        self.requests.send(Request::Gateways(reply)).await.ok()?;
        told.await.ok()
    }

    /// Entries before this position are not needed any more.
    pub fn trim(&self, before: Position) {
        // Next time, if it is behind now.
        let _ = self.requests.try_send(Request::Trim(before));
    }

    /// The same as [`Self::gateways`], for a thread: asks now, answers later.
    pub fn ask_gateways(&self) -> Option<oneshot::Receiver<(Position, Gateways)>> {
        let (reply, told) = oneshot::channel();
        self.requests.try_send(Request::Gateways(reply)).ok()?;
        Some(told)
    }
}

struct Desk<Now> {
    journal: Journal,
    gateways: Gateways,
    groups: SyncSender<Group>,
    now: Now,
    health: Arc<Health>,
}

impl<Now: Fn() -> Time> Desk<Now> {
    fn run(&mut self, mut inbox: mpsc::Receiver<Request>) {
        let mut requests = Vec::with_capacity(MOST_TOGETHER);
        loop {
            requests.clear();
            if inbox.blocking_recv_many(&mut requests, MOST_TOGETHER) == 0 {
                return;
            }
            if !self.group(&mut requests) {
                return;
            }
        }
    }

    /// Writes a group; `false` when nobody takes what is stored any more.
    fn group(&mut self, requests: &mut Vec<Request>) -> bool {
        static FAILED: Seldom = Seldom::new();
        let arrived = (self.now)();
        let (mut entries, mut waiting, mut replies) = (Vec::new(), Vec::new(), Vec::new());
        let mut repeated = Vec::new();
        let mut asked = Vec::new();
        for request in requests.drain(..) {
            match request {
                Request::Append { what, number, waiting: outcome, reply } => {
                    if let (Some(number), What::Batch(batch)) = (&number, &what) {
                        if self.gateways.has(&batch.gateway, number) {
                            repeated.extend(reply);
                            continue;
                        }
                        self.gateways.insert(&batch.gateway, number);
                    }
                    entries.push(Entry::new(arrived, what));
                    waiting.push(outcome);
                    replies.push((reply, number));
                }
                Request::Gateways(reply) => asked.push(reply),
                Request::Trim(before) => {
                    if let Err(error) = self.journal.trim(before) {
                        tracing::warn!("{error}");
                    }
                }
            }
        }
        let started = Instant::now();
        let written =
            if entries.is_empty() { Ok(self.journal.next()) } else { self.journal.append(&entries) };
        metrics::histogram!("adit_journal_append_seconds").record(started.elapsed());
        let first = match written {
            Ok(first) => {
                self.health.tell(Part::Journal, Ok(()));
                for (position, (reply, _)) in (first..).zip(replies) {
                    answer(reply, Ok(Appended::At(position)));
                }
                for reply in repeated {
                    answer(Some(reply), Ok(Appended::Repeated));
                }
                Some(first)
            }
            Err(error) => {
                FAILED.warn(&error);
                self.health.tell(Part::Journal, Err(error.to_string()));
                metrics::counter!("adit_journal_failures_total").increment(1);
                let not_stored =
                    if error.is_full() { NotStored::Full } else { NotStored::Failed(error.to_string()) };
                for ((reply, number), entry) in replies.into_iter().zip(&entries) {
                    if let (Some(number), Some(What::Batch(batch))) = (number, &entry.what) {
                        self.gateways.forget(&batch.gateway, &number);
                    }
                    answer(reply, Err(not_stored.clone()));
                }
                // What they repeat may be what was just not stored.
                for reply in repeated {
                    answer(Some(reply), Err(not_stored.clone()));
                }
                None
            }
        };
        for reply in asked {
            let _ = reply.send((self.journal.next(), self.gateways.clone()));
        }
        if entries.is_empty() {
            return true;
        }
        // Live positions go on when the disk does not.
        let started = Instant::now();
        let group = (0_u64..).zip(entries).zip(waiting).map(|((index, entry), waiting)| Committed {
            position: first.map(|first| first + index),
            entry,
            waiting,
        });
        let taken = self.groups.send(group.collect()).is_ok();
        metrics::histogram!("adit_pipeline_wait_seconds").record(started.elapsed());
        taken
    }
}

/// Whoever does not wait any more need not be told.
fn answer(reply: Option<Reply>, with: Result<Appended, NotStored>) {
    if let Some(reply) = reply {
        let _ = reply.send(with);
    }
}
