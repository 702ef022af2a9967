//! Watches the fences that clients have put, while the server runs. Who is in them is not kept: after a restart those who are seen inside come in anew.

use super::fencing::{Crossing, Fence, Fences, Place};
use super::objects::of_adit;
use super::shelf::{self, Kind, Object};
use crate::api::{ApiError, Context};
use crate::feed::{Gone, Moved, News};
use adit_tracking::Subject;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use tokio::sync::broadcast;
use tokio::time::MissedTickBehavior;

/// Crossings kept for a socket that is slow.
const KEPT: usize = 4096;
/// How often time passes for who is not seen.
const BEAT: Duration = Duration::from_secs(1);
/// How long a store that does not answer is left alone.
const AGAIN: Duration = Duration::from_secs(5);

/// The fences of clients, and who is in them.
pub struct FenceWatch {
    fences: Mutex<Fences>,
    crossings: broadcast::Sender<Arc<Crossing>>,
}

impl Default for FenceWatch {
    fn default() -> Self {
        Self { fences: Mutex::default(), crossings: broadcast::channel(KEPT).0 }
    }
}

impl FenceWatch {
    fn fences(&self) -> MutexGuard<'_, Fences> {
        self.fences.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Crossings from now on.
    pub(super) fn crossings(&self) -> broadcast::Receiver<Arc<Crossing>> {
        self.crossings.subscribe()
    }

    /// Watches a fence from now on.
    pub(super) fn put(&self, fence: Fence) {
        self.fences().put(fence);
    }

    /// Watches it no more; nobody is told that they went out.
    pub(super) fn remove(&self, id: &str) {
        self.fences().remove(id);
    }

    /// Watches none.
    pub(super) fn clear(&self) {
        self.fences().clear();
    }

    /// Who is in a fence.
    pub(super) fn inside(&self, id: &str) -> Vec<Subject> {
        self.fences().inside(id)
    }

    /// Ids of the fences that somebody is in.
    pub(super) fn of(&self, subject: &Subject) -> Vec<String> {
        self.fences().of(subject)
    }

    fn see(&self, moved: &[Arc<Moved>]) {
        let mut fences = self.fences();
        if fences.is_empty() {
            return;
        }
        for moved in moved {
            let known = &moved.last_known;
            let place = Place { position_m: &known.position_m, level: known.level.as_deref() };
            self.tell(fences.see(&moved.subject, &place, known.time));
        }
    }

    fn tell(&self, crossings: Vec<Crossing>) {
        for crossing in crossings {
            // Nobody has subscribed.
            let _ = self.crossings.send(Arc::new(crossing));
        }
    }
}

/// A fence that is to be watched; none for the zones of adit, which the tracking watches, whatever is laid over them.
pub(super) fn watched(context: &Context, id: &str, object: &Object) -> Result<Option<Fence>, ApiError> {
    let fence = Fence::read(id, object, &context.mine)?;
    Ok((!of_adit(context, Kind::Fences).contains_key(id)).then_some(fence))
}

/// Watches for as long as the server runs.
pub(in crate::api) async fn watch(context: Arc<Context>) {
    let stored = loop {
        match shelf::all(&context, Kind::Fences).await {
            Ok(stored) => break stored,
            Err(error) => tracing::warn!("fences cannot be read: {}", error.problem().message),
        }
        tokio::time::sleep(AGAIN).await;
    };
    for (id, object) in stored {
        match watched(&context, &id, &object) {
            Ok(Some(fence)) => context.fences.put(fence),
            Ok(None) => {}
            Err(error) => tracing::warn!("the fence {id:?} is not watched: {}", error.problem().message),
        }
    }
    let mut beats = tokio::time::interval(BEAT);
    beats.set_missed_tick_behavior(MissedTickBehavior::Skip);
    let mut viewer = context.feed.listen();
    loop {
        tokio::select! {
            news = viewer.news() => match news {
                Ok(News::Tick(tick)) => context.fences.see(&tick.moved),
                Ok(News::Since { moved, .. }) => context.fences.see(&moved),
                Ok(News::Events(_)) => {}
                // Events are of no use here.
                Err(Gone::EventsMissed) => viewer = context.feed.listen(),
                Err(Gone::Stopping) => return,
            },
            _ = beats.tick() => {
                let passed = context.fences.fences().pass(context.clock.now());
                context.fences.tell(passed);
            }
        }
    }
}
