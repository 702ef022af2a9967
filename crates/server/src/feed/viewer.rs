//! Somebody who watches.

use super::{Feed, Moved, Newest, Tick, Told};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use tokio::sync::watch;

/// What is new for a viewer.
#[derive(Debug)]
pub enum News {
    /// Events, in order, none left out.
    Events(Vec<Arc<Told>>),
    /// The tick that follows the last one.
    Tick(Arc<Tick>),
    /// Ticks were missed: the last position of all that have moved since.
    Since {
        /// Number of the newest tick in it.
        tick: u64,
        /// Where they are.
        moved: Vec<Arc<Moved>>,
    },
}

/// Why a viewer cannot go on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Gone {
    /// Events that it has not been told are no longer there.
    #[error("too slow: events were missed; ask again from a snapshot")]
    EventsMissed,
    /// The server stops.
    #[error("the server stops")]
    Stopping,
}

/// Somebody who watches; counted until dropped, if at all.
pub struct Viewer {
    counted: bool,
    feed: Arc<Feed>,
    newest: watch::Receiver<Newest>,
    told: Newest,
}

/// Events told at once.
const AT_ONCE: usize = 64;

impl Viewer {
    pub(super) fn new(
        feed: Arc<Feed>,
        mut newest: watch::Receiver<Newest>,
        after: Newest,
        counted: bool,
    ) -> Self {
        newest.mark_changed();
        Self { counted, feed, newest, told: after }
    }

    /// What has been told.
    pub fn told(&self) -> Newest {
        self.told
    }

    /// Waits for news. Events come first. May be dropped while it waits without losing anything.
    pub async fn news(&mut self) -> Result<News, Gone> {
        loop {
            if let Some(news) = self.next()? {
                return Ok(news);
            }
            self.newest.changed().await.map_err(|_| Gone::Stopping)?;
        }
    }

    fn next(&mut self) -> Result<Option<News>, Gone> {
        let board = self.feed.board();
        let newest = board.newest;
        if newest.event > self.told.event {
            let oldest = board.events.front().map_or(newest.event + 1, |told| told.number);
            let Some(place) = (self.told.event + 1).checked_sub(oldest) else {
                return Err(Gone::EventsMissed);
            };
            let place = usize::try_from(place).map_err(|_| Gone::EventsMissed)?;
            let events: Vec<_> = board.events.iter().skip(place).take(AT_ONCE).cloned().collect();
            self.told.event += events.len() as u64;
            return Ok(Some(News::Events(events)));
        }
        if newest.tick <= self.told.tick {
            return Ok(None);
        }
        let missed = newest.tick - self.told.tick - 1;
        let since = std::mem::replace(&mut self.told.tick, newest.tick);
        match &board.tick {
            Some(tick) if missed == 0 => Ok(Some(News::Tick(Arc::clone(tick)))),
            _ => {
                metrics::counter!("adit_feed_ticks_skipped_total").increment(missed);
                let later = board.last.values().filter(|(tick, _)| *tick > since);
                let moved = later.map(|(_, moved)| Arc::clone(moved)).collect();
                Ok(Some(News::Since { tick: newest.tick, moved }))
            }
        }
    }
}

impl Drop for Viewer {
    fn drop(&mut self) {
        if !self.counted {
            return;
        }
        self.feed.viewers.fetch_sub(1, Ordering::Relaxed);
        metrics::gauge!("adit_feed_viewers").decrement(1.0);
    }
}
