//! Where the rows of an export come from, page by page.

use crate::export::columns::{ALARM, Column, EVENT, FIX};
use crate::store::{AlarmRecord, EventRecord, FixRecord, LogQuery, Store, StoreError, TrackOf, TrackQuery};
use adit_core::time::Time;
use serde_json::Value;
use std::collections::VecDeque;

/// Rows that can be exported.
pub trait Exported: Sized + Send + 'static {
    /// What says which rows, and where to go on.
    type Query: Send;
    /// Its columns.
    const COLUMNS: &'static [Column<Self>];
    /// Where it was, on the mine's grid, m.
    fn place(&self) -> Option<[f64; 3]>;
    /// Some rows, and the query of those after them.
    fn page(store: &Store, query: Self::Query)
    -> impl Future<Output = Result<Page<Self>, StoreError>> + Send;
}

/// Rows, and the query of those after them.
pub(crate) type Page<T> = (Vec<T>, Option<<T as Exported>::Query>);

/// Whose fixes of what time.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TracksQuery {
    /// Whose; `None`: everybody's.
    pub of: Option<TrackOf>,
    /// From this time on.
    pub from: Time,
    /// Before this time.
    pub until: Time,
}

/// Tracks one after the other.
pub struct FixPages {
    query: TracksQuery,
    /// Those to come; `None`: not asked yet who there is.
    to_come: Option<VecDeque<TrackOf>>,
    /// From where on the first of them.
    from: Time,
}

impl FixPages {
    pub(crate) fn new(query: TracksQuery) -> Self {
        let to_come = query.of.clone().map(|of| VecDeque::from([of]));
        Self { from: query.from, query, to_come }
    }
}

impl Exported for FixRecord {
    type Query = FixPages;
    const COLUMNS: &'static [Column<Self>] = FIX;

    fn place(&self) -> Option<[f64; 3]> {
        Some(self.position_m)
    }

    async fn page(store: &Store, mut pages: FixPages) -> Result<Page<Self>, StoreError> {
        let mut to_come = match pages.to_come.take() {
            Some(to_come) => to_come,
            None => store.tags().await?.into_iter().map(TrackOf::Tag).collect(),
        };
        let Some(of) = to_come.front().cloned() else { return Ok((Vec::new(), None)) };
        let page = store.track_page(&TrackQuery { of, from: pages.from, until: pages.query.until }).await?;
        pages.from = page.next.unwrap_or(pages.query.from);
        if page.next.is_none() {
            to_come.pop_front();
        }
        pages.to_come = Some(to_come);
        let more = pages.to_come.as_ref().is_some_and(|left| !left.is_empty());
        Ok((page.fixes, more.then_some(pages)))
    }
}

impl Exported for EventRecord {
    type Query = LogQuery;
    const COLUMNS: &'static [Column<Self>] = EVENT;

    fn place(&self) -> Option<[f64; 3]> {
        place_in(&self.body).or_else(|| place_in(self.body.get("alarm")?))
    }

    async fn page(store: &Store, mut query: LogQuery) -> Result<Page<Self>, StoreError> {
        let page = store.events(&query).await?;
        query.after = page.next;
        Ok((page.rows, page.next.is_some().then_some(query)))
    }
}

impl Exported for AlarmRecord {
    type Query = LogQuery;
    const COLUMNS: &'static [Column<Self>] = ALARM;

    fn place(&self) -> Option<[f64; 3]> {
        place_in(&self.body)
    }

    async fn page(store: &Store, mut query: LogQuery) -> Result<Page<Self>, StoreError> {
        let page = store.alarms(&query).await?;
        query.after = page.next;
        Ok((page.rows, page.next.is_some().then_some(query)))
    }
}

/// `position_m` of an event or alarm of `adit_tracking`: three numbers.
fn place_in(body: &Value) -> Option<[f64; 3]> {
    let numbers: Vec<f64> = body.get("position_m")?.as_array()?.iter().filter_map(Value::as_f64).collect();
    numbers.try_into().ok()
}
