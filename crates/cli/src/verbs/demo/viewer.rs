//! Watches the server as the console does: alarms as they are raised, positions against the truth.

use super::crew::Truth;
use super::gateways::Target;
use super::score::Score;
use adit_core::time::Time;
use adit_mine::Mine;
use adit_server::api::Timestamp;
use anyhow::{Context as _, Result};
use futures_util::{SinkExt as _, StreamExt as _};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::tungstenite::client::IntoClientRequest as _;

/// Before a server that is away is tried again.
const RETRY: Duration = Duration::from_millis(100);

#[derive(Deserialize)]
struct Told {
    #[serde(default)]
    positions: Vec<Moved>,
    body: Option<Happened>,
}

#[derive(Deserialize)]
struct Moved {
    tag: String,
    time: String,
    position_m: [f64; 3],
    radius_95_m: f64,
    level: Option<String>,
}

#[derive(Deserialize)]
struct Happened {
    event: String,
    time: Option<String>,
    alarm: Option<Alarm>,
}

#[derive(Deserialize)]
struct Alarm {
    kind: String,
    severity: String,
    about_id: Option<String>,
    zone: Option<String>,
}

/// Something to be told.
pub struct Raised {
    /// When, by the clock of the mine.
    pub time: Time,
    /// What.
    pub kind: String,
    /// How bad.
    pub severity: String,
    /// About whom or what, and where.
    pub about: String,
}

/// What has been seen.
#[derive(Default)]
pub struct Seen {
    /// Positions against the truth.
    pub score: Score,
    /// Alarms that nobody has been told of.
    pub raised: Vec<Raised>,
    /// Tags of which a position has come since this was emptied.
    pub found: BTreeSet<usize>,
    /// Time of the newest position.
    pub newest: Option<Time>,
}

/// Somebody who watches.
pub struct Viewer {
    seen: Arc<Mutex<Seen>>,
}

/// What a viewer knows of the shift.
pub struct Roll {
    /// Numbers of tags.
    pub tags: BTreeMap<String, usize>,
    /// Names of people, by id.
    pub names: BTreeMap<String, String>,
    /// Where the tags are.
    pub truth: Truth,
    /// The mine.
    pub mine: Arc<Mine>,
}

impl Viewer {
    /// Begins to watch, on the current runtime.
    pub fn start(target: Target, roll: Roll) -> Self {
        let seen = Arc::<Mutex<Seen>>::default();
        let told = Arc::clone(&seen);
        tokio::spawn(async move {
            loop {
                if let Err(error) = watch(&target, &roll, &told).await {
                    tracing::debug!("{error:#}");
                }
                tokio::time::sleep(RETRY).await;
            }
        });
        Self { seen }
    }

    /// What has been seen so far.
    pub fn seen(&self) -> MutexGuard<'_, Seen> {
        lock(&self.seen)
    }
}

fn lock(seen: &Mutex<Seen>) -> MutexGuard<'_, Seen> {
    seen.lock().unwrap_or_else(PoisonError::into_inner)
}

async fn watch(target: &Target, roll: &Roll, seen: &Mutex<Seen>) -> Result<()> {
    let url = format!("{}/api/v1/live/socket", target.url.replacen("http", "ws", 1));
    let mut request = url.into_client_request()?;
    let bearer = format!("Bearer {}", target.token).parse().context("a token has no such characters")?;
    request.headers_mut().insert("authorization", bearer);
    let mut socket = tokio_tungstenite::connect_async(request).await?.0;
    while let Some(message) = socket.next().await {
        match message? {
            Message::Text(text) => {
                if let Ok(told) = serde_json::from_str::<Told>(&text) {
                    hear(told, roll, seen);
                }
            }
            Message::Ping(payload) => socket.send(Message::Pong(payload)).await?,
            _ => {}
        }
    }
    Ok(())
}

fn hear(told: Told, roll: &Roll, seen: &Mutex<Seen>) {
    let mut seen = lock(seen);
    for moved in told.positions {
        let (Some(wearer), Ok(Timestamp(time))) = (roll.tags.get(&moved.tag), moved.time.parse()) else {
            continue;
        };
        let Some(truth_m) = roll.truth.position_m(*wearer, time) else { continue };
        let [x, y, _] = moved.position_m;
        let level = roll.mine.level_at(truth_m.z).map(|level| level.id.as_str());
        let right = level == moved.level.as_deref();
        seen.score.add((x - truth_m.x).hypot(y - truth_m.y), moved.radius_95_m, right);
        seen.found.insert(*wearer);
        seen.newest = seen.newest.max(Some(time));
    }
    let Some(Happened { event, time: Some(time), alarm: Some(alarm) }) = told.body else { return };
    let (true, Ok(Timestamp(time))) = (event == "alarm-raised", time.parse()) else { return };
    let name = |id: &String| match roll.names.get(id) {
        Some(name) => format!("{name} ({id})"),
        None => id.clone(),
    };
    let who = alarm.about_id.as_ref().map_or_else(|| "the mine".to_owned(), name);
    let about = alarm.zone.map_or(who.clone(), |zone| format!("{who}, {zone}"));
    seen.raised.push(Raised { time, kind: alarm.kind, severity: alarm.severity, about });
}
