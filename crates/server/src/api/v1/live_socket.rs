//! The live state for the console: a snapshot, then what changes.

use crate::api::extract::{Caller, Query};
use crate::api::socket::{Closed, MESSAGE_LIMIT, Writer, checks, full, still};
use crate::api::view::{AlarmJson, EvacuationJson, EventJson, HeadcountJson, LiveJson, WhereJson, who};
use crate::api::{ApiError, Context, Timestamp};
use crate::auth::Principal;
use crate::feed::{Moved, Newest, News, Told, Viewer};
use axum::extract::State;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade, rejection::WebSocketUpgradeRejection};
use axum::response::Response;
use futures_util::StreamExt as _;
use futures_util::stream::SplitStream;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use utoipa::{IntoParams, ToSchema};

/// Form of the messages in [`Texts`](crate::feed::Texts).
const FORM: &str = "console";

/// Where to go on.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct Resume {
    /// `run` of the snapshot; of another run there is no going on.
    run: Option<String>,
    /// Number of the last event.
    event: Option<u64>,
    /// Number of the last tick.
    tick: Option<u64>,
}

/// A tag that has moved.
#[derive(Serialize, ToSchema)]
struct MovedJson {
    person: Option<String>,
    /// With `tag`, the tag that says so.
    #[serde(flatten)]
    place: WhereJson,
}

/// A message.
#[derive(Serialize)]
#[serde(tag = "type", rename_all = "kebab-case")]
#[expect(clippy::large_enum_variant, reason = "made, written and dropped at once")]
enum Live<'a> {
    /// All that is known now; first of all.
    Snapshot {
        run: &'a str,
        event: u64,
        tick: u64,
        time: Timestamp,
        clock_speed: f64,
        live: Vec<LiveJson>,
        alarms: Vec<AlarmJson>,
        headcount: HeadcountJson,
        evacuation: Option<EvacuationJson>,
    },
    /// What was missed follows, no snapshot; also when the clock begins to go at another speed.
    Resumed { run: &'a str, event: u64, tick: u64, time: Timestamp, clock_speed: f64 },
    /// Tags that have moved since the tick before.
    Positions { tick: u64, positions: Vec<MovedJson> },
    /// Something happened.
    Event { number: u64, body: EventJson },
}

impl Live<'_> {
    fn text(&self) -> String {
        // Its parts are numbers, texts and lists: nothing of it can fail to be written.
        serde_json::to_string(self).unwrap_or_default()
    }
}

/// WebSocket: first `snapshot` (or `resumed`), then `positions` every tick and `event`s in order with numbers; see docs/live/api.md.
#[utoipa::path(get, path = "/api/v1/live/socket", tag = "live", params(Resume),
    responses((status = 101, description = "a WebSocket"), (status = 400, description = "no WebSocket", body = crate::api::Problem)))]
pub(super) async fn watch(
    State(context): State<Arc<Context>>,
    caller: Caller,
    Query(resume): Query<Resume>,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Result<Response, ApiError> {
    let upgrade = upgrade.map_err(|rejection| ApiError::malformed(rejection.body_text()))?;
    let feed = Arc::clone(&context.feed);
    let newest = feed.newest();
    let place = resume.event.zip(resume.tick).map(|(event, tick)| Newest { tick, event });
    let place = place.filter(|at| {
        resume.run.as_deref() == Some(feed.run()) && at.event <= newest.event && at.tick <= newest.tick
    });
    let viewer = feed.watch(place.unwrap_or(newest)).ok_or_else(full)?;
    let upgrade = upgrade.max_message_size(MESSAGE_LIMIT).max_frame_size(MESSAGE_LIMIT);
    Ok(upgrade.on_upgrade(move |socket| async move {
        let timeout_s = context.feed.settings().write_timeout_s;
        let (sink, messages) = socket.split();
        let mut writer = Writer::new(sink, timeout_s);
        let resumed = place.is_some();
        if let Err(why) = run(&context, &caller.principal, viewer, resumed, &mut writer, messages).await {
            tracing::debug!("live view of {}: {why}", caller.principal.name);
            writer.close(&why).await;
        }
    }))
}

async fn run(
    context: &Context,
    principal: &Principal,
    mut viewer: Viewer,
    resumed: bool,
    writer: &mut Writer,
    mut messages: SplitStream<WebSocket>,
) -> Result<(), Closed> {
    let first = if resumed { resumed_at(context, viewer.told()) } else { snapshot(context, viewer.told()) };
    writer.text(first.into()).await?;
    let mut checks = checks();
    let mut paces = context.clock.changes();
    loop {
        tokio::select! {
            Ok(()) = paces.changed() => writer.text(resumed_at(context, viewer.told()).into()).await?,
            news = viewer.news() => tell(news?, writer).await?,
            message = messages.next() => match message {
                Some(Ok(Message::Close(_)) | Err(_)) | None => return Err(Closed::Left),
                // The console has nothing to say here.
                Some(Ok(_)) => {}
            },
            _ = checks.tick() => {
                still(context, principal).await?;
                writer.ping().await?;
            }
        }
    }
}

async fn tell(news: News, writer: &mut Writer) -> Result<(), Closed> {
    match news {
        News::Events(events) => {
            for told in events {
                writer.text(told.texts.get(FORM, || event(&told))).await?;
            }
        }
        News::Tick(tick) => {
            let text = tick.texts.get(FORM, || positions(tick.number, &tick.moved));
            writer.text(text).await?;
        }
        News::Since { tick, moved } => writer.text(positions(tick, &moved).into()).await?,
    }
    Ok(())
}

fn event(told: &Told) -> String {
    Live::Event { number: told.number, body: (&told.event).into() }.text()
}

fn positions(tick: u64, moved: &[Arc<Moved>]) -> String {
    let positions = moved.iter().map(|moved| {
        let (person, _) = who(&moved.subject);
        MovedJson { person, place: moved.last_known.clone().into() }
    });
    Live::Positions { tick, positions: positions.collect() }.text()
}

fn resumed_at(context: &Context, at: Newest) -> String {
    let (time, clock_speed) = (context.clock.now().into(), context.clock.pace().speed);
    Live::Resumed { run: context.feed.run(), event: at.event, tick: at.tick, time, clock_speed }.text()
}

/// The state is read after the numbers: what happens between is told twice, never not at all.
fn snapshot(context: &Context, at: Newest) -> String {
    let tracking = context.tracking();
    let snapshot = Live::Snapshot {
        run: context.feed.run(),
        event: at.event,
        tick: at.tick,
        time: context.clock.now().into(),
        clock_speed: context.clock.pace().speed,
        live: tracking.below().map(LiveJson::from).collect(),
        alarms: tracking.open_alarms().map(AlarmJson::from).collect(),
        headcount: tracking.headcount().into(),
        evacuation: tracking.evacuation().map(EvacuationJson::from),
    };
    drop(tracking);
    snapshot.text()
}
