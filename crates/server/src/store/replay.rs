//! Everybody's tracks over a time at even steps, for a replay.

use crate::store::packed::{PackedFix, milliseconds, time_of_milliseconds};
use crate::store::record::FixRecord;
use crate::store::{Store, StoreError, TrackOf, TrackQuery};
use adit_core::time::Time;

/// Which part of the past, how finely.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReplayQuery {
    /// From this time on.
    pub from: Time,
    /// Before this time.
    pub until: Time,
    /// The first fix of each tag in each such step counts, ms.
    pub step_ms: u32,
    /// An answer has no more fixes.
    pub most: usize,
}

impl Store {
    /// The first fix of each tag in each step, by tag, then in order of time; `None` when there are more than asked for.
    pub async fn replay(&self, query: &ReplayQuery) -> Result<Option<Vec<FixRecord>>, StoreError> {
        let (from_ms, step_ms) = (milliseconds(query.from), i64::from(query.step_ms.max(1)));
        let mut thinned: Vec<PackedFix> = Vec::new();
        for tag in self.tags().await? {
            let mut part = TrackQuery { of: TrackOf::Tag(tag), from: query.from, until: query.until };
            let mut last_step = None;
            loop {
                let page = self.packed_page(&part).await?;
                for fix in page.fixes {
                    let step = (fix.time_ms - from_ms).div_euclid(step_ms);
                    if last_step != Some(step) {
                        last_step = Some(step);
                        thinned.push(fix);
                    }
                }
                if thinned.len() > query.most {
                    return Ok(None);
                }
                let Some(next) = page.next_ms else { break };
                part.from = time_of_milliseconds(next);
            }
        }
        let names = self.names_of(&thinned).await?;
        thinned.iter().map(|fix| self.record(fix, &names)).collect::<Result<_, _>>().map(Some)
    }
}
