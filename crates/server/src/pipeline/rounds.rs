//! The thread that takes rounds.

use super::devices::Devices;
use super::follower::{Arrival, TagHealth};
use super::outcome::{RoundOutcome, TrackedFix};
use super::profile::Profiles;
use super::shard::{Job, Shard, Told, shard_of};
use super::snapshot::{Part, ServerState, Snapshots, Writing};
use crate::error::ServerError;
use crate::journal::{
    Committed, Committer, Gateways, Group, Journal, OutsidePosition, Position, Spans, What,
};
use adit_core::time::Time;
use adit_mine::Mine;
use adit_observation::wire::Batch;
use adit_tracking::{Command, Event, Fix, Input, Refused, Rules, Tracking};
use prost::bytes::Bytes;
use rayon::prelude::*;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Arc, PoisonError, RwLock};
use std::time::{Duration, Instant};
use tokio::sync::oneshot;

/// Entries of a round at most, so that a start after a crash takes memory for no more.
const MOST_ENTRIES: usize = 16_384;
/// How long the thread waits for entries before it looks for questions.
const PATIENCE: Duration = Duration::from_millis(20);

/// Tags copied at once for the last snapshot.
const TAGS_AT_THE_END: usize = 256;

/// How long the end waits for the store.
const STORE_PATIENCE: Duration = Duration::from_secs(10);

/// What a pipeline needs to know.
pub struct PipelineSettings {
    /// The mine.
    pub mine: Arc<Mine>,
    /// How tags are followed.
    pub profiles: Arc<Profiles>,
    /// Rules of the tracking at the first start; later starts keep those that they have.
    pub rules: Rules,
    /// Threads for estimators.
    pub shards: usize,
    /// Folder of the journal and the snapshots.
    pub folder: PathBuf,
    /// A snapshot is made this often.
    pub snapshot_every: Duration,
    /// The last entry of which the store has what came of it; whoever writes to the store says so. A snapshot counts only when the store
    /// is as far: what came of entries before it cannot be found again.
    pub stored: Arc<AtomicU64>,
}

/// A question to the thread.
pub enum Asked {
    /// How a tag is followed.
    Tag(String, oneshot::Sender<Option<TagHealth>>),
    /// The numbers of packets that came of each tag: first and last of each span.
    Packets(oneshot::Sender<Vec<(String, Spans)>>),
    /// The end: what has come is taken, a snapshot is made.
    Stop,
}

/// From entries to positions.
pub struct Pipeline {
    shards: Vec<Shard>,
    tracking: Arc<RwLock<Tracking>>,
    /// The last entry that the tracking has.
    position: Position,
    /// The last entry of which the store had what came of it at the start.
    told: Position,
    /// The same now.
    stored: Arc<AtomicU64>,
    snapshots: Snapshots,
    snapshot_every: Duration,
    running: Option<Running>,
    last_snapshot: Instant,
    devices: Devices,
}

/// A snapshot being made.
struct Running {
    writing: Writing,
    /// Tags a round.
    quota: usize,
    gateways: Option<oneshot::Receiver<(Position, Gateways)>>,
    /// Whether everything was handed to it.
    whole: bool,
}

/// A pipeline as the disk has it.
pub struct Started {
    /// It.
    pub pipeline: Pipeline,
    /// The journal, to be read from `from` on.
    pub journal: Journal,
    /// The first entry that somebody may not have.
    pub from: Position,
    /// What gateways had sent.
    pub gateways: (Position, Gateways),
}

impl Pipeline {
    /// As the newest snapshot has it; new, where there is none.
    pub fn open(settings: PipelineSettings) -> Result<Started, ServerError> {
        let PipelineSettings { mine, profiles, rules, shards, folder, snapshot_every, stored } = settings;
        let snapshots = Snapshots::open(&folder.join("snapshots"))?;
        let mut shards: Vec<_> = (0..shards.max(1)).map(|_| Shard::new(Arc::clone(&profiles))).collect();
        let (tracking, devices, position, gateways, from) = match snapshots.newest()? {
            None => (Tracking::new(mine, rules)?, Devices::default(), 0, (1, Gateways::default()), 1),
            Some(restored) => {
                let mut from = restored.server.position;
                for (tag, follower) in restored.tags {
                    from = from.min(follower.applied());
                    let shard = shard_of(&tag, shards.len());
                    shards[shard].restore(tag, follower);
                }
                let ServerState { position, mut tracking, devices, gateways } = restored.server;
                tracking.attach(mine);
                from = from.min(gateways.0.saturating_sub(1));
                (tracking, devices, position, gateways, from + 1)
            }
        };
        let journal = Journal::open(&folder.join("journal"), position + 1)?;
        let pipeline = Self {
            shards,
            tracking: Arc::new(RwLock::new(tracking)),
            position,
            told: stored.load(Ordering::Acquire),
            stored,
            snapshots,
            snapshot_every,
            running: None,
            last_snapshot: Instant::now(),
            devices,
        };
        Ok(Started { pipeline, journal, from, gateways })
    }

    /// The tracking, for readers.
    pub fn tracking(&self) -> Arc<RwLock<Tracking>> {
        Arc::clone(&self.tracking)
    }

    /// The last entry that the tracking has.
    pub fn position(&self) -> Position {
        self.position
    }

    /// How many tags are followed.
    pub fn tags(&self) -> usize {
        self.shards.iter().map(Shard::tags).sum()
    }

    /// Takes the journal from the snapshot on; what came of entries that the store does not have is told, as when it happened. `progress`
    /// hears of the entries taken.
    pub fn replay(
        &mut self,
        started: (&Journal, Position),
        gateways: &mut (Position, Gateways),
        mut outlet: impl FnMut(RoundOutcome),
        mut progress: impl FnMut(Position),
    ) -> Result<(), ServerError> {
        let (journal, from) = started;
        if from >= journal.next() {
            return Ok(());
        }
        let mut round = Vec::new();
        for entry in journal.read_from(from)? {
            let (position, entry) = entry?;
            if position >= gateways.0 {
                gateways.1.see(&entry);
                gateways.0 = position + 1;
            }
            round.push(Committed { position: Some(position), entry, waiting: None });
            if round.len() == MOST_ENTRIES {
                outlet(self.round(std::mem::take(&mut round)));
                progress(position);
            }
        }
        outlet(self.round(round));
        Ok(())
    }

    /// Takes what the journal writes until nobody writes any more, or it is asked to stop; a snapshot ends it.
    pub fn run(
        mut self,
        groups: &Receiver<Group>,
        asked: &Receiver<Asked>,
        committer: &Committer,
        mut outlet: impl FnMut(RoundOutcome),
    ) {
        loop {
            let mut round = match groups.recv_timeout(PATIENCE) {
                Ok(group) => group,
                Err(RecvTimeoutError::Timeout) => Vec::new(),
                Err(RecvTimeoutError::Disconnected) => break,
            };
            while round.len() < MOST_ENTRIES
                && let Ok(group) = groups.try_recv()
            {
                round.extend(group);
            }
            if !round.is_empty() {
                let started = Instant::now();
                let entries = round.len();
                let outcome = self.round(round);
                metrics::histogram!("adit_round_seconds").record(started.elapsed());
                metrics::counter!("adit_entries_total").increment(entries as u64);
                outlet(outcome);
            }
            let started = Instant::now();
            self.keep(committer);
            metrics::histogram!("adit_snapshot_step_seconds").record(started.elapsed());
            while let Ok(question) = asked.try_recv() {
                match question {
                    Asked::Tag(tag, answer) => {
                        // Whoever asked may have gone.
                        let _ = answer.send(self.health(&tag));
                    }
                    Asked::Packets(answer) => {
                        let _ = answer.send(self.shards.iter().flat_map(Shard::packets).collect());
                    }
                    Asked::Stop => return self.end(groups, committer, outlet),
                }
            }
        }
    }

    /// How a tag is followed.
    pub(super) fn health(&self, tag: &str) -> Option<TagHealth> {
        self.shards[shard_of(tag, self.shards.len())].health(tag)
    }

    /// Takes what is still there, and keeps everything.
    fn end(mut self, groups: &Receiver<Group>, committer: &Committer, mut outlet: impl FnMut(RoundOutcome)) {
        while let Ok(group) = groups.try_recv() {
            outlet(self.round(group));
        }
        let gateways = committer.ask_gateways().and_then(|asked| asked.blocking_recv().ok());
        let Some(gateways) = gateways else { return };
        let patience = Instant::now() + STORE_PATIENCE;
        while self.stored.load(Ordering::Acquire) < self.position {
            if Instant::now() > patience {
                tracing::warn!("the store is behind: no snapshot; the next start reads the journal instead");
                return;
            }
            std::thread::sleep(PATIENCE);
        }
        // One that is under way is older.
        self.running = None;
        let kept = self.snapshots.begin(&self.stored).and_then(|writing| {
            for shard in &mut self.shards {
                shard.begin_snapshot();
                loop {
                    let next = shard.next_kept(TAGS_AT_THE_END);
                    if next.is_empty() {
                        break;
                    }
                    writing.add(Part::Tags(next));
                }
            }
            writing.add(Part::Server(Box::new(self.state(gateways))));
            writing.outcome()
        });
        match kept {
            Ok(oldest) => committer.trim(oldest),
            Err(error) => tracing::error!("{error}: the next start reads the journal instead"),
        }
    }

    /// What is of this moment.
    fn state(&self, gateways: (Position, Gateways)) -> ServerState {
        let tracking = self.tracking.read().unwrap_or_else(PoisonError::into_inner).clone();
        ServerState { position: self.position, tracking, devices: self.devices.clone(), gateways }
    }

    /// Takes a round.
    pub fn round(&mut self, round: Group) -> RoundOutcome {
        let mut jobs: Vec<Vec<Job>> = self.shards.iter().map(|_| Vec::new()).collect();
        let mut order = 0;
        let mut heard = Vec::with_capacity(round.len());
        for committed in round {
            let first = order;
            let mut devices = Vec::new();
            if let Some(What::Batch(batch)) = &committed.entry.what {
                let gateway: Arc<str> = batch.gateway.as_str().into();
                match Batch::read(batch.batch.clone()) {
                    Ok(read) => {
                        let (arrived, position) = (committed.entry.arrived(), committed.position);
                        for packet in read.packets {
                            let shard = shard_of(&tag_of(&packet), jobs.len());
                            let arrival = Arrival { arrived, position, gateway: Arc::clone(&gateway) };
                            jobs[shard].push(Job { order, arrival, packet });
                            order += 1;
                        }
                        devices = read.devices;
                    }
                    Err(error) => {
                        metrics::counter!("adit_bad_batches_total").increment(1);
                        tracing::warn!("gateway {gateway}: a batch that is none: {error}");
                    }
                }
            }
            heard.push((committed, first..order, devices));
        }
        let shards = self.shards.par_iter_mut().zip(jobs);
        let mut told: Vec<Told> = shards.flat_map_iter(|(shard, jobs)| shard.take(jobs)).collect();
        told.sort_unstable_by_key(|told| told.order);

        let mut outcome = RoundOutcome::default();
        let tracking = Arc::clone(&self.tracking);
        let mut tracking = tracking.write().unwrap_or_else(PoisonError::into_inner);
        let mut told = told.into_iter().peekable();
        for (Committed { position, entry, waiting }, packets, devices) in heard {
            let known = position.is_some_and(|position| position <= self.position);
            let now = entry.arrived();
            while let Some(packet) = told.next_if(|told| packets.contains(&told.order)) {
                for input in packet.inputs {
                    if !known {
                        hear(&mut tracking, now, input, &mut outcome);
                    }
                }
            }
            if known {
                continue;
            }
            let known = &mut self.devices;
            let mut changed: Vec<_> = devices
                .iter()
                .filter_map(|status| known.anchor(status.device.as_str(), status.up, now))
                .collect();
            match entry.what {
                Some(What::Batch(batch)) => changed.extend(known.gateway(&batch.gateway, true, now)),
                Some(What::Gateway(status)) => changed.extend(known.gateway(&status.gateway, status.up, now)),
                Some(What::Position(outside)) => {
                    hear(&mut tracking, now, Input::Fix(of_outside(&outside, now)), &mut outcome);
                }
                Some(What::Tick(())) => {
                    changed.extend(known.silent(now));
                    hear(&mut tracking, now, Input::Tick, &mut outcome);
                }
                Some(What::Command(command)) => {
                    let answer =
                        obey(&mut tracking, now, command.actor, &command.command, &mut outcome.events);
                    if let (Some(waiting), Some(answer)) = (waiting, answer) {
                        // Whoever asked may have gone.
                        let _ = waiting.send(answer);
                    }
                }
                None => {}
            }
            for device in changed {
                hear(&mut tracking, now, Input::Device(device), &mut outcome);
            }
            outcome.arrived = now;
            if position.is_some_and(|position| position <= self.told) {
                outcome.fixes.clear();
                outcome.events.clear();
            }
            if let Some(position) = position {
                self.position = position;
                outcome.position = Some(position);
            }
        }
        outcome
    }

    /// Goes on with the running snapshot, or begins one.
    pub(super) fn keep(&mut self, committer: &Committer) {
        if self.running.is_none() && self.last_snapshot.elapsed() < self.snapshot_every {
            return;
        }
        if let Err(error) = self.keep_some(committer) {
            metrics::counter!("adit_snapshot_failures_total").increment(1);
            tracing::error!("{error}: the next snapshot is tried in {} s", self.snapshot_every.as_secs());
            self.running = None;
            self.last_snapshot = Instant::now();
        }
    }

    fn keep_some(&mut self, committer: &Committer) -> Result<(), ServerError> {
        let mut running = if let Some(running) = self.running.take() {
            running
        } else {
            for shard in &mut self.shards {
                shard.begin_snapshot();
            }
            // A round lasts for some tens of ms under load: the whole in a quarter of the time between snapshots.
            let rounds = (4 * self.snapshot_every.as_millis() / PATIENCE.as_millis() / 16).max(1);
            let quota = self.tags() / usize::try_from(rounds).unwrap_or(1) / self.shards.len() + 1;
            Running { writing: self.snapshots.begin(&self.stored)?, quota, gateways: None, whole: false }
        };
        if running.writing.ended() {
            committer.trim(running.writing.outcome()?);
            self.last_snapshot = Instant::now();
            return Ok(());
        }
        if !running.whole {
            self.keep_more(&mut running, committer);
        }
        self.running = Some(running);
        Ok(())
    }

    /// Some more tags; when there are none, what is of one moment.
    fn keep_more(&mut self, running: &mut Running, committer: &Committer) {
        let Some(place) = running.writing.place() else { return };
        let quota = running.quota;
        let next: Vec<_> = self.shards.par_iter_mut().flat_map_iter(|shard| shard.next_kept(quota)).collect();
        if !next.is_empty() {
            place.send(Part::Tags(next));
            return;
        }
        drop(place);
        // What gateways have sent is asked of the journal's thread, which must not be waited for.
        let Some(asked) = &mut running.gateways else {
            running.gateways = committer.ask_gateways();
            return;
        };
        let gateways = match asked.try_recv() {
            Ok(gateways) => gateways,
            Err(oneshot::error::TryRecvError::Empty) => return,
            Err(oneshot::error::TryRecvError::Closed) => {
                running.gateways = None;
                return;
            }
        };
        running.writing.add(Part::Tags(self.shards.iter_mut().flat_map(Shard::not_kept).collect()));
        running.writing.add(Part::Server(Box::new(self.state(gateways))));
        running.whole = true;
    }
}

/// Tells the tracking; what it took is part of the outcome.
fn hear(tracking: &mut Tracking, now: Time, input: Input, outcome: &mut RoundOutcome) {
    match tracking.hear(now, &input, &mut outcome.events) {
        Ok(adit_tracking::Outcome::Done) => {
            if let Input::Fix(fix) = input {
                let person = tracking.wearer(&fix.tag).map(ToOwned::to_owned);
                let zone = tracking.zone_of(&fix.tag).map(ToOwned::to_owned);
                outcome.fixes.push(TrackedFix { fix, person, zone });
            }
        }
        Ok(adit_tracking::Outcome::Ignored(why)) => {
            metrics::counter!("adit_ignored_inputs_total", "why" => format!("{why:?}")).increment(1);
        }
        // Only commands are refused.
        Err(refused) => tracing::warn!("{refused}"),
    }
}

/// Does what a user wants; nothing where the journal has a command of a later version.
fn obey(
    tracking: &mut Tracking,
    now: Time,
    by: String,
    command: &str,
    events: &mut Vec<Event>,
) -> Option<Result<adit_tracking::Outcome, Refused>> {
    match serde_json::from_str::<Command>(command) {
        Ok(command) => Some(tracking.hear(now, &Input::Command { by, command }, events)),
        Err(error) => {
            tracing::error!("a command in the journal that is none: {error}");
            None
        }
    }
}

fn of_outside(outside: &OutsidePosition, now: Time) -> Fix {
    let position_m = adit_core::frames::Position::new(outside.x_m, outside.y_m, outside.z_m);
    Fix {
        tag: outside.tag.clone(),
        time: outside.time_ns.map_or(now, Time::from_nanos),
        position_m,
        velocity_m_s: None,
        radius_95_m: outside.radius_95_m,
        // Nothing is known of the tails of somebody else's errors: as ours.
        protection_level_m: 3.0 * outside.radius_95_m,
        quality: adit_core::solution::Quality::Fixed,
        moving: None,
        method: "outside".into(),
    }
}

/// The tag of a packet, whatever else is in it; a packet that is none has the empty name, and says so when it is read.
fn tag_of(packet: &Bytes) -> String {
    adit_observation::wire::Packet::tag_of(packet).unwrap_or_default()
}
