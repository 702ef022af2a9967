//! What happens, told to all who watch.
//!
//! The pipeline tells each round's fixes and events ([`Feed::tell`]); it never waits for anybody. Positions are gathered, one for each tag, and
//! told every [`FeedSettings::tick_ms`]; events are told at once, in order. A message is written once for each form that anybody watches
//! ([`Texts`]) and shared by all who watch it.
//!
//! **Who is slow.** Nothing is queued for a viewer. Events stand in one ring for all ([`FeedSettings::events_kept`]); each viewer has a place in
//! it. Of positions a viewer remembers the last tick it was told; if it missed some, it is told the last position of all tags that have moved since.
//! A viewer whose place has left the ring, or to whom a message could not be written in [`FeedSettings::write_timeout_s`], is sent away with
//! the reason: no event is left out silently. So memory does not depend on how many are slow.

mod texts;
mod viewer;

pub use texts::Texts;
pub use viewer::{Gone, News, Viewer};

use adit_tracking::view::LastKnown;
use adit_tracking::{Event, Fix, Subject, Tracking};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock};
use std::time::{Duration, Instant};
use tokio::sync::watch;

/// How the feed behaves.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FeedSettings {
    /// Positions are told so often, ms.
    pub tick_ms: u64,
    /// So many events are kept for those who are slow or come back.
    pub events_kept: usize,
    /// A viewer that takes longer to read a message is sent away, s.
    pub write_timeout_s: u64,
    /// So many may watch at once.
    pub viewers: usize,
}

impl Default for FeedSettings {
    fn default() -> Self {
        Self { tick_ms: 100, events_kept: 8192, write_timeout_s: 10, viewers: 2000 }
    }
}

/// Where a tag is, with who wears it.
#[derive(Debug, Clone)]
pub struct Moved {
    /// The tag.
    pub tag: Arc<str>,
    /// Who is followed by it.
    pub subject: Subject,
    /// Where.
    pub last_known: LastKnown,
}

/// The tags that have moved in a tick.
#[derive(Debug)]
pub struct Tick {
    /// Its number, from 1.
    pub number: u64,
    /// Where they are.
    pub moved: Vec<Arc<Moved>>,
    /// The same, written.
    pub texts: Texts,
}

/// An event with its number.
#[derive(Debug)]
pub struct Told {
    /// Its number, from 1 without gaps.
    pub number: u64,
    /// What happened.
    pub event: Event,
    /// The same, written.
    pub texts: Texts,
}

/// The newest numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Newest {
    /// Of the last tick.
    pub tick: u64,
    /// Of the last event.
    pub event: u64,
}

#[derive(Default)]
struct Board {
    newest: Newest,
    /// Tags that have moved since the last tick.
    dirty: BTreeSet<Arc<str>>,
    /// The tick in which each tag moved last.
    last: BTreeMap<Arc<str>, (u64, Arc<Moved>)>,
    tick: Option<Arc<Tick>>,
    events: VecDeque<Arc<Told>>,
}

/// The feed.
pub struct Feed {
    settings: FeedSettings,
    board: Mutex<Board>,
    newest: watch::Sender<Newest>,
    viewers: AtomicUsize,
    run: String,
}

impl Feed {
    /// A feed that is told of rounds, but does not tell of positions before [`Feed::start`].
    pub fn new(settings: FeedSettings) -> Arc<Self> {
        let run = uuid::Uuid::new_v4().simple().to_string();
        Arc::new(Self {
            settings,
            board: Mutex::default(),
            newest: watch::Sender::new(Newest::default()),
            viewers: AtomicUsize::new(0),
            run,
        })
    }

    /// Begins to tell where tags are, on the current tokio runtime, for as long as somebody holds the feed.
    pub fn start(self: &Arc<Self>, tracking: Arc<RwLock<Tracking>>) {
        let period = Duration::from_millis(self.settings.tick_ms.max(1));
        let ticking = Arc::downgrade(self);
        tokio::spawn(async move {
            let mut interval = tokio::time::interval(period);
            interval.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
            loop {
                interval.tick().await;
                let Some(feed) = ticking.upgrade() else { break };
                let started = Instant::now();
                feed.tick(&tracking);
                metrics::histogram!("adit_feed_tick_seconds").record(started.elapsed());
            }
        });
    }

    /// What a round came to. Does not wait.
    pub fn tell<'a>(&self, fixes: impl IntoIterator<Item = &'a Fix>, events: &[Event]) {
        let mut board = self.board();
        for fix in fixes {
            if !board.dirty.contains(fix.tag.as_str()) {
                board.dirty.insert(fix.tag.as_str().into());
            }
        }
        if events.is_empty() {
            return;
        }
        for event in events {
            board.newest.event += 1;
            let told = Told { number: board.newest.event, event: event.clone(), texts: Texts::default() };
            board.events.push_back(Arc::new(told));
            if board.events.len() > self.settings.events_kept.max(1) {
                board.events.pop_front();
            }
        }
        self.newest.send_replace(board.newest);
    }

    fn tick(&self, tracking: &RwLock<Tracking>) {
        let dirty = std::mem::take(&mut self.board().dirty);
        if dirty.is_empty() {
            return;
        }
        let moved = moved(tracking, dirty);
        let mut board = self.board();
        board.newest.tick += 1;
        let number = board.newest.tick;
        for moved in &moved {
            board.last.insert(Arc::clone(&moved.tag), (number, Arc::clone(moved)));
        }
        board.tick = Some(Arc::new(Tick { number, moved, texts: Texts::default() }));
        self.newest.send_replace(board.newest);
    }

    /// The newest numbers.
    pub fn newest(&self) -> Newest {
        self.board().newest
    }

    /// What tells this run of the server from others: numbers of ticks and events begin anew with each.
    pub fn run(&self) -> &str {
        &self.run
    }

    /// How it behaves.
    pub fn settings(&self) -> &FeedSettings {
        &self.settings
    }

    /// How many watch.
    pub fn viewers(&self) -> usize {
        self.viewers.load(Ordering::Relaxed)
    }

    /// Somebody begins to watch after these numbers; `None` when too many watch.
    pub fn watch(self: &Arc<Self>, after: Newest) -> Option<Viewer> {
        let mut watching = self.viewers.load(Ordering::Relaxed);
        loop {
            if watching >= self.settings.viewers {
                return None;
            }
            match self.viewers.compare_exchange(watching, watching + 1, Ordering::Relaxed, Ordering::Relaxed)
            {
                Ok(_) => break,
                Err(now) => watching = now,
            }
        }
        metrics::gauge!("adit_feed_viewers").increment(1.0);
        Some(Viewer::new(Arc::clone(self), self.newest.subscribe(), after, true))
    }

    /// A part of the server begins to watch, from now on; it is not among the viewers.
    pub fn listen(self: &Arc<Self>) -> Viewer {
        Viewer::new(Arc::clone(self), self.newest.subscribe(), self.newest(), false)
    }

    fn board(&self) -> MutexGuard<'_, Board> {
        self.board.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn moved(tracking: &RwLock<Tracking>, tags: BTreeSet<Arc<str>>) -> Vec<Arc<Moved>> {
    let tracking = tracking.read().unwrap_or_else(PoisonError::into_inner);
    let moved = tags.into_iter().filter_map(|tag| {
        let view = tracking.tag(&tag)?;
        let subject = match view.person {
            Some(person) => Subject::Person(person),
            None => Subject::Tag(tag.to_string()),
        };
        Some(Arc::new(Moved { tag, subject, last_known: view.last_known? }))
    });
    moved.collect()
}
