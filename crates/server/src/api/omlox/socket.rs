//! The WebSocket of omlox.
//!
//! Who watches is told by the header `Authorization` or by `token` in the query when it opens, or by `token` in the `params` of a message. A socket whose
//! client has not said who it is within [`WHO`] is closed. `collision_events` can be subscribed to; adit makes none.

use super::crs::Crs;
use super::fence_event;
use super::fencing::Crossing;
use super::location::{Of, PutLocation, feature, location, motion};
use crate::api::extract::Query;
use crate::api::socket::{Closed, MESSAGE_LIMIT, Writer, checks, full, still};
use crate::api::{ApiError, Context};
use crate::auth::{Permission, Principal};
use crate::feed::{Gone, Moved, News, Viewer};
use adit_tracking::Event;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade, rejection::WebSocketUpgradeRejection};
use axum::extract::{Extension, State};
use axum::response::Response;
use futures_util::StreamExt as _;
use serde::Deserialize;
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::broadcast::error::RecvError;
use utoipa::IntoParams;

/// How long a client has to say who it is.
const WHO: Duration = Duration::from_secs(15);
/// Most subscriptions of a socket.
const MOST: usize = 32;

const UNKNOWN_EVENT: u32 = 10_000;
const UNKNOWN_TOPIC: u32 = 10_001;
const NOT_SUBSCRIBED: u32 = 10_002;
const NOT_UNSUBSCRIBED: u32 = 10_003;
const NOT_AUTHORISED: u32 = 10_004;
const BAD_DATA: u32 = 10_005;
const NOT_AUTHENTICATED: u32 = 10_006;

/// Who watches, when the header cannot say it.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct Knocking {
    /// A token or the secret of a session.
    token: Option<String>,
}

/// WebSocket of omlox: `subscribe`, `unsubscribe`, `message`.
#[utoipa::path(get, path = "/v2/ws/socket", tag = "omlox", params(Knocking),
    responses((status = 101, description = "a WebSocket"), (status = 400, description = "no WebSocket", body = crate::api::Problem)))]
pub(super) async fn watch(
    State(context): State<Arc<Context>>,
    principal: Option<Extension<Principal>>,
    Query(knocking): Query<Knocking>,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Result<Response, ApiError> {
    let upgrade = upgrade.map_err(|rejection| ApiError::malformed(rejection.body_text()))?;
    let principal = match (principal, knocking.token) {
        (Some(Extension(principal)), _) => Some(principal),
        (None, Some(token)) => context.auth.principal(&token).await?,
        (None, None) => None,
    };
    let viewer = context.feed.watch(context.feed.newest()).ok_or_else(full)?;
    let upgrade = upgrade.max_message_size(MESSAGE_LIMIT).max_frame_size(MESSAGE_LIMIT);
    Ok(upgrade.on_upgrade(move |socket| async move {
        let client = Client { context: Arc::clone(&context), principal, subscriptions: Vec::new(), next: 1 };
        client.run(viewer, socket).await;
    }))
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Topic {
    Locations,
    Fences,
    Motions,
    Proximities,
    /// Told by nobody in adit.
    Silent,
}

struct Subscription {
    id: u64,
    /// As asked for, with `:geojson` where wanted.
    name: String,
    topic: Topic,
    geojson: bool,
    crs: Crs,
    form: String,
}

/// A message of a client.
#[derive(Deserialize)]
struct Asked {
    event: String,
    topic: Option<String>,
    subscription_id: Option<u64>,
    #[serde(default)]
    params: Value,
    #[serde(default)]
    payload: Value,
}

/// What is said to be wrong.
struct Wrong(u32, String);

struct Client {
    context: Arc<Context>,
    principal: Option<Principal>,
    subscriptions: Vec<Subscription>,
    next: u64,
}

impl Client {
    async fn run(mut self, mut viewer: Viewer, socket: WebSocket) {
        let (sink, mut messages) = socket.split();
        let mut writer = Writer::new(sink, self.context.feed.settings().write_timeout_s);
        let mut checks = checks();
        let (mut crossings, mut proximities) =
            (self.context.fences.crossings(), self.context.proximities.subscribe());
        let who = tokio::time::sleep(WHO);
        tokio::pin!(who);
        let why = loop {
            let step = tokio::select! {
                news = viewer.news() => match news {
                    Ok(news) => self.tell(&news, &mut writer).await,
                    Err(gone) => Err(gone.into()),
                },
                crossing = crossings.recv() => match crossing {
                    Ok(crossing) => self.tell_crossing(&crossing, &mut writer).await,
                    Err(missed) => Err(gone(&missed)),
                },
                proximity = proximities.recv() => match proximity {
                    Ok(proximity) => self.tell_proximity(&proximity, &mut writer).await,
                    Err(missed) => Err(gone(&missed)),
                },
                message = messages.next() => match message {
                    Some(Ok(Message::Text(text))) => {
                        let answer = self.hear(&text).await;
                        match answer {
                            Some(answer) => writer.text(answer.to_string().into()).await,
                            None => Ok(()),
                        }
                    }
                    Some(Ok(Message::Close(_)) | Err(_)) | None => Err(Closed::Left),
                    Some(Ok(_)) => Ok(()),
                },
                () = &mut who, if self.principal.is_none() => Err(Closed::Nobody),
                _ = checks.tick() => match &self.principal {
                    Some(principal) => match still(&self.context, principal).await {
                        Ok(()) => writer.ping().await,
                        ended => ended,
                    },
                    None => Ok(()),
                },
            };
            if let Err(why) = step {
                break why;
            }
        };
        writer.close(&why).await;
    }

    /// What a client says, and the answer.
    async fn hear(&mut self, text: &str) -> Option<Value> {
        let answer = match serde_json::from_str::<Asked>(text) {
            Ok(asked) => self.answer(asked).await,
            Err(error) => Err(Wrong(BAD_DATA, error.to_string())),
        };
        answer.unwrap_or_else(|Wrong(code, description)| {
            Some(json!({ "event": "error", "code": code, "description": description }))
        })
    }

    async fn answer(&mut self, asked: Asked) -> Result<Option<Value>, Wrong> {
        if let Some(token) = asked.params.get("token").and_then(Value::as_str) {
            let token = token.strip_prefix("Bearer ").unwrap_or(token);
            let principal = self.context.auth.principal(token).await;
            self.principal = principal.map_err(|error| Wrong(NOT_SUBSCRIBED, error.to_string()))?;
        }
        let Some(principal) = &self.principal else {
            return Err(Wrong(NOT_AUTHENTICATED, "no valid token: send it as `token` in `params`".into()));
        };
        match asked.event.as_str() {
            "subscribe" => {
                allowed(principal, Permission::SeeLive)?;
                self.subscribe(&asked).map(Some)
            }
            "unsubscribe" => self.unsubscribe(&asked).map(Some),
            "message" => {
                allowed(principal, Permission::Ingest)?;
                self.publish(asked).await.map(|()| None)
            }
            other => Err(Wrong(
                UNKNOWN_EVENT,
                format!("expected subscribe, unsubscribe or message, found {other:?}"),
            )),
        }
    }

    fn subscribe(&mut self, asked: &Asked) -> Result<Value, Wrong> {
        let name = asked.topic.clone().unwrap_or_default();
        let (topic, geojson) = topic(&name)?;
        let crs = asked.params.get("crs").and_then(Value::as_str);
        let crs = Crs::named(crs, &self.context.mine);
        let crs = crs.map_err(|error| Wrong(NOT_SUBSCRIBED, error.problem().message))?;
        if self.subscriptions.len() >= MOST {
            return Err(Wrong(NOT_SUBSCRIBED, format!("a socket has at most {MOST} subscriptions")));
        }
        let id = self.next;
        self.next += 1;
        let form = format!("{name} {}", crs.name());
        self.subscriptions.push(Subscription { id, name: name.clone(), topic, geojson, crs, form });
        Ok(json!({ "event": "subscribed", "topic": name, "subscription_id": id }))
    }

    fn unsubscribe(&mut self, asked: &Asked) -> Result<Value, Wrong> {
        let is = |subscription: &Subscription| match (asked.subscription_id, &asked.topic) {
            (Some(id), _) => subscription.id == id,
            (None, Some(topic)) => subscription.name == *topic,
            (None, None) => false,
        };
        let Some(at) = self.subscriptions.iter().position(is) else {
            return Err(Wrong(NOT_UNSUBSCRIBED, "no such subscription".into()));
        };
        let gone = self.subscriptions.remove(at);
        Ok(json!({ "event": "unsubscribed", "topic": gone.name, "subscription_id": gone.id }))
    }

    /// Locations that a client tells by the socket.
    async fn publish(&self, asked: Asked) -> Result<(), Wrong> {
        let bad = |error: ApiError| Wrong(BAD_DATA, error.problem().message);
        match topic(asked.topic.as_deref().unwrap_or_default())? {
            (Topic::Locations, false) => {}
            _ => return Err(Wrong(UNKNOWN_TOPIC, "clients may tell location_updates".into())),
        }
        let locations: Vec<PutLocation> =
            serde_json::from_value(asked.payload).map_err(|error| Wrong(BAD_DATA, error.to_string()))?;
        for body in locations {
            let tag = body.provider().map(str::to_owned);
            let tag = tag.ok_or_else(|| Wrong(BAD_DATA, "provider_id: is needed".into()))?;
            let report = body.report(&self.context.mine, &tag).map_err(bad)?;
            self.context.door.position(report).await.map_err(|error| bad(error.into()))?;
        }
        Ok(())
    }

    async fn tell(&self, news: &News, writer: &mut Writer) -> Result<(), Closed> {
        for subscription in &self.subscriptions {
            match news {
                News::Events(events) if subscription.topic == Topic::Fences => {
                    for told in events.iter().filter(|told| is_of_fences(&told.event)) {
                        let text = told.texts.get(&subscription.form, || {
                            let event = fence_event::of_zone(&self.context, told, subscription.geojson);
                            message(&subscription.name, event.as_slice())
                        });
                        writer.text(text).await?;
                    }
                }
                News::Tick(tick) if subscription.tells_places() => {
                    let text = tick.texts.get(&subscription.form, || self.places(subscription, &tick.moved));
                    writer.text(text).await?;
                }
                News::Since { moved, .. } if subscription.tells_places() => {
                    writer.text(self.places(subscription, moved).into()).await?;
                }
                _ => {}
            }
        }
        Ok(())
    }

    async fn tell_crossing(&self, crossing: &Crossing, writer: &mut Writer) -> Result<(), Closed> {
        for subscription in self.subscriptions.iter().filter(|it| it.topic == Topic::Fences) {
            let event = fence_event::of_client(crossing, subscription.geojson);
            writer.text(message(&subscription.name, &[event]).into()).await?;
        }
        Ok(())
    }

    async fn tell_proximity(&self, proximity: &Value, writer: &mut Writer) -> Result<(), Closed> {
        for subscription in self.subscriptions.iter().filter(|it| it.topic == Topic::Proximities) {
            writer.text(message(&subscription.name, std::slice::from_ref(proximity)).into()).await?;
        }
        Ok(())
    }

    fn places(&self, subscription: &Subscription, moved: &[Arc<Moved>]) -> String {
        let objects = moved.iter().filter_map(|moved| {
            let of = Of { subject: &moved.subject, last_known: &moved.last_known };
            if subscription.topic == Topic::Motions {
                return motion(&self.context, &subscription.crs, &of);
            }
            let location = location(&self.context, &subscription.crs, &of)?;
            Some(if subscription.geojson { feature(location) } else { location })
        });
        message(&subscription.name, &objects.collect::<Vec<_>>())
    }
}

impl Subscription {
    fn tells_places(&self) -> bool {
        matches!(self.topic, Topic::Locations | Topic::Motions)
    }
}

fn allowed(principal: &Principal, permission: Permission) -> Result<(), Wrong> {
    if principal.may(permission) {
        Ok(())
    } else {
        Err(Wrong(NOT_AUTHORISED, format!("`{}` may not {}", principal.name, permission.description())))
    }
}

fn topic(name: &str) -> Result<(Topic, bool), Wrong> {
    match name {
        "location_updates" => Ok((Topic::Locations, false)),
        "location_updates:geojson" => Ok((Topic::Locations, true)),
        "fence_events" => Ok((Topic::Fences, false)),
        "fence_events:geojson" => Ok((Topic::Fences, true)),
        "trackable_motions" => Ok((Topic::Motions, false)),
        "proximity_updates" => Ok((Topic::Proximities, false)),
        "collision_events" => Ok((Topic::Silent, false)),
        other => Err(Wrong(UNKNOWN_TOPIC, format!("no topic {other:?}"))),
    }
}

/// A client that is so slow that something was left out is sent away.
fn gone(missed: &RecvError) -> Closed {
    Closed::Feed(match missed {
        RecvError::Lagged(_) => Gone::EventsMissed,
        RecvError::Closed => Gone::Stopping,
    })
}

fn is_of_fences(event: &Event) -> bool {
    matches!(event, Event::ZoneEntered { .. } | Event::ZoneLeft { .. })
}

/// Without `subscription_id`: a known client drops messages whose id it does not expect.
fn message(topic: &str, payload: &[Value]) -> String {
    json!({ "event": "message", "topic": topic, "payload": payload }).to_string()
}
