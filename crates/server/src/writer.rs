//! What came of rounds, into the store: behind the live positions, never in their way.
//!
//! Rounds wait here while the store is locked or the disk is full, and are tried again. Past [`MOST_FIXES`] waiting fixes the oldest fixes
//! are given up, counted (`adit_fixes_given_up_total`) and logged: a track has a hole then. Events are kept.

use crate::api::{Health, Part};
use crate::pipeline::{RoundOutcome, TrackedFix};
use crate::store::{AlarmRecord, EventRecord, FixRecord, Record, Retention, Round, Store, StoreError};
use adit_core::time::Time;
use adit_mine::Mine;
use adit_tracking::{About, Alarm, Event, Subject};
use serde_json::Value;
use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;
use tokio::sync::mpsc;
use tokio::time::Instant;

/// Fixes that wait for the store at most.
pub const MOST_FIXES: usize = 1_000_000;
/// Before a store that failed is tried again: doubled each time, up to the second.
const RETRY: (Duration, Duration) = (Duration::from_millis(100), Duration::from_secs(5));
/// At most so often is anything written: each time waits for the disk, for which the journal waits too.
const PAUSE: Duration = Duration::from_millis(250);
/// Tracks are packed this often, and what is too old is deleted.
const MAINTENANCE: Duration = Duration::from_mins(1);

/// Writes until nobody tells any more.
pub async fn write(
    store: Store,
    mine: Arc<Mine>,
    retention: Retention,
    now: impl Fn() -> Time,
    stored: Arc<AtomicU64>,
    health: Arc<Health>,
    mut outcomes: mpsc::UnboundedReceiver<RoundOutcome>,
) {
    let (waiting, unplaced) = (VecDeque::new(), Vec::new());
    let mut desk = Desk { store, mine, waiting, unplaced, fixes: 0, retry: RETRY.0, stored };
    let mut maintenance = Instant::now() + MAINTENANCE;
    let mut upkeep = tokio::spawn(async {});
    let mut open = true;
    while open || !desk.waiting.is_empty() {
        if desk.waiting.is_empty() {
            let next = tokio::time::timeout_at(maintenance, outcomes.recv()).await;
            match next {
                Ok(Some(outcome)) => desk.add(&outcome),
                Ok(None) => open = false,
                Err(_) => {}
            }
        }
        while let Ok(outcome) = outcomes.try_recv() {
            desk.add(&outcome);
        }
        let writes = !desk.waiting.is_empty();
        if let Err(error) = desk.commit().await {
            metrics::counter!("adit_store_failures_total").increment(1);
            tracing::warn!("{error}; {} rounds wait", desk.waiting.len());
            health.tell(Part::Store, Err(error.to_string()));
            if !open {
                // What waits is in the journal, and is written at the next start.
                break;
            }
            tokio::time::sleep(desk.retry).await;
            desk.retry = (2 * desk.retry).min(RETRY.1);
            continue;
        }
        desk.retry = RETRY.0;
        health.tell(Part::Store, Ok(()));
        if Instant::now() >= maintenance {
            if upkeep.is_finished() {
                upkeep = tokio::spawn(maintain(desk.store.clone(), now(), retention));
            }
            maintenance = Instant::now() + MAINTENANCE;
        }
        if writes && open {
            tokio::time::sleep(PAUSE).await;
        }
    }
    upkeep.abort();
}

/// Packs tracks and deletes what is too old; what is cut off by the end of the server is done by the next.
async fn maintain(store: Store, now: Time, retention: Retention) {
    if let Err(error) = store.compact(now).await {
        tracing::warn!("{error}");
    }
    if let Err(error) = store.retain(now, &retention).await {
        tracing::warn!("{error}");
    }
}

struct Desk {
    store: Store,
    mine: Arc<Mine>,
    waiting: VecDeque<Round>,
    /// Of rounds that the journal does not have.
    unplaced: Vec<Record>,
    fixes: usize,
    retry: Duration,
    stored: Arc<AtomicU64>,
}

impl Desk {
    fn add(&mut self, outcome: &RoundOutcome) {
        let mut records = std::mem::take(&mut self.unplaced);
        records.extend(outcome.fixes.iter().map(|fix| Record::Fix(self.fix(fix))));
        for event in &outcome.events {
            records.extend(alarm(event).map(Record::Alarm));
            records.push(Record::Event(happened(event)));
        }
        let fixes = records.iter().filter(|record| matches!(record, Record::Fix(_))).count();
        // What the journal could not take was live all the same: it goes with the next round that has a place.
        let Some(position) = outcome.position else {
            if fixes > MOST_FIXES {
                metrics::counter!("adit_fixes_given_up_total").increment(fixes as u64);
                records.retain(|record| !matches!(record, Record::Fix(_)));
            }
            self.unplaced = records;
            return;
        };
        self.fixes += fixes;
        self.waiting.push_back(Round { position, records });
        if self.fixes > MOST_FIXES {
            self.give_up();
        }
    }

    fn give_up(&mut self) {
        for round in &mut self.waiting {
            let before = round.records.len();
            round.records.retain(|record| !matches!(record, Record::Fix(_)));
            let gone = before - round.records.len();
            self.fixes -= gone;
            metrics::counter!("adit_fixes_given_up_total").increment(gone as u64);
            if self.fixes <= MOST_FIXES / 2 {
                break;
            }
        }
        tracing::error!("the store has been behind for too long: the oldest waiting fixes are given up");
    }

    async fn commit(&mut self) -> Result<(), StoreError> {
        if self.waiting.is_empty() {
            return Ok(());
        }
        let started = Instant::now();
        let written = self.store.commit_rounds(self.waiting.make_contiguous()).await?;
        metrics::histogram!("adit_store_commit_seconds").record(started.elapsed());
        metrics::counter!("adit_stored_records_total").increment(written.written);
        self.stored.store(written.applied, Ordering::Release);
        self.waiting.clear();
        self.fixes = 0;
        Ok(())
    }

    fn fix(&self, tracked: &TrackedFix) -> FixRecord {
        let TrackedFix { fix, person, zone } = tracked;
        let position_m: [f64; 3] = (*fix.position_m.raw()).into();
        FixRecord {
            person: person.clone(),
            tag: fix.tag.clone(),
            time: fix.time,
            position_m,
            radius_95_m: fix.radius_95_m,
            quality: fix.quality,
            level: self.mine.level_at(position_m[2]).map(|level| level.id.clone()),
            zone: zone.clone(),
        }
    }
}

/// The record of an event.
fn happened(event: &Event) -> EventRecord {
    let body = serde_json::to_value(event).unwrap_or_default();
    let kind = body.get("event").and_then(Value::as_str).unwrap_or("unknown").to_owned();
    let (time, subjects) = of_event(event);
    EventRecord { time, kind, subjects, body }
}

fn id(subject: &Subject) -> String {
    match subject {
        Subject::Person(id) | Subject::Tag(id) => id.clone(),
    }
}

/// When it happened, and whom it is about.
fn of_event(event: &Event) -> (Time, Vec<String>) {
    match event {
        Event::ZoneEntered { zone, subject, time, .. } | Event::ZoneLeft { zone, subject, time, .. } => {
            (*time, vec![zone.clone(), id(subject)])
        }
        Event::LevelChanged { subject, from, to, time, .. } => {
            let levels = from.iter().chain(to).cloned();
            (*time, std::iter::once(id(subject)).chain(levels).collect())
        }
        Event::WentBelow { subject, time, .. }
        | Event::CameOut { subject, time, .. }
        | Event::ContactLost { subject, last_heard: time }
        | Event::ContactRegained { subject, time, .. } => (*time, vec![id(subject)]),
        Event::TagAppeared { tag, time } => (*time, vec![tag.clone()]),
        Event::TagAssigned { tag, person, time } | Event::TagReturned { tag, person, time } => {
            (*time, vec![tag.clone(), person.clone()])
        }
        Event::DeviceDown { id, time, .. } | Event::DeviceUp { id, time, .. } => (*time, vec![id.clone()]),
        Event::AlarmRaised { alarm }
        | Event::AlarmEscalated { alarm }
        | Event::AlarmAcknowledged { alarm }
        | Event::AlarmCleared { alarm } => (changed(alarm), about(alarm)),
        Event::AlarmCommented { note, .. } => (note.at, Vec::new()),
        Event::EvacuationStarted { time, .. } | Event::EvacuationStopped { time, .. } => (*time, Vec::new()),
    }
}

fn about(alarm: &Alarm) -> Vec<String> {
    let mut subjects = match &alarm.key.about {
        About::Person(id) | About::Tag(id) | About::Zone(id) | About::Gateway(id) | About::Anchor(id) => {
            vec![id.clone()]
        }
        About::Mine => Vec::new(),
    };
    subjects.extend(alarm.key.zone.clone());
    subjects
}

/// When an alarm changed last.
fn changed(alarm: &Alarm) -> Time {
    let deeds = alarm.acknowledged.iter().chain(&alarm.cleared).map(|deed| deed.at);
    deeds.chain(alarm.notes.iter().map(|note| note.at)).fold(alarm.raised_at, Time::max)
}

/// The record of the alarm that an event tells of.
fn alarm(event: &Event) -> Option<AlarmRecord> {
    let (Event::AlarmRaised { alarm }
    | Event::AlarmEscalated { alarm }
    | Event::AlarmAcknowledged { alarm }
    | Event::AlarmCleared { alarm }) = event
    else {
        return None;
    };
    let word = |value: serde_json::Result<Value>| match value {
        Ok(Value::String(word)) => word,
        _ => "unknown".to_owned(),
    };
    Some(AlarmRecord {
        id: alarm.id.to_string(),
        kind: word(serde_json::to_value(alarm.key.kind)),
        state: word(serde_json::to_value(alarm.state)),
        raised: alarm.raised_at,
        changed: changed(alarm),
        cleared: alarm.cleared.as_ref().map(|deed| deed.at),
        subjects: about(alarm),
        body: serde_json::to_value(alarm).unwrap_or_default(),
    })
}
