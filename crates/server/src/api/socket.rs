//! What the sockets of viewers have in common: writing with a limit of time, and asking again who watches.

use super::{ApiError, Context};
use crate::auth::{Permission, Principal};
use crate::feed::Gone;
use axum::extract::ws::{CloseFrame, Message, Utf8Bytes, WebSocket, close_code};
use futures_util::SinkExt as _;
use futures_util::stream::SplitSink;
use std::time::Duration;
use tokio::time::{Interval, MissedTickBehavior};

/// A ping is sent and the right to watch is checked so often.
const CHECK: Duration = Duration::from_secs(30);

/// Largest message of a client, bytes.
pub(super) const MESSAGE_LIMIT: usize = 256 * 1024;

/// Why a socket is closed.
#[derive(Debug, thiserror::Error)]
pub(super) enum Closed {
    /// The client went.
    #[error("the client went")]
    Left,
    /// A message could not be written in time.
    #[error("too slow: a message could not be written within {0} s")]
    NotReading(u64),
    /// The feed cannot go on.
    #[error(transparent)]
    Feed(#[from] Gone),
    /// The session or token has ended.
    #[error("the session or token has ended")]
    NoLonger,
    /// Nobody said who watches.
    #[error("nobody said who watches")]
    Nobody,
}

impl Closed {
    const fn reason(&self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::NotReading(_) => "not-reading",
            Self::Feed(Gone::EventsMissed) => "events-missed",
            Self::Feed(Gone::Stopping) => "stopping",
            Self::NoLonger => "no-longer-allowed",
            Self::Nobody => "unauthenticated",
        }
    }
}

/// The writing half of a socket.
pub(super) struct Writer {
    sink: SplitSink<WebSocket, Message>,
    timeout_s: u64,
}

impl Writer {
    pub(super) fn new(sink: SplitSink<WebSocket, Message>, timeout_s: u64) -> Self {
        Self { sink, timeout_s }
    }

    /// Writes a message, or gives up on the client.
    pub(super) async fn text(&mut self, text: Utf8Bytes) -> Result<(), Closed> {
        metrics::counter!("adit_feed_messages_total").increment(1);
        self.message(Message::Text(text)).await
    }

    /// Asks whether the client is there.
    pub(super) async fn ping(&mut self) -> Result<(), Closed> {
        self.message(Message::Ping(axum::body::Bytes::new())).await
    }

    async fn message(&mut self, message: Message) -> Result<(), Closed> {
        let limit = Duration::from_secs(self.timeout_s);
        match tokio::time::timeout(limit, self.sink.send(message)).await {
            Ok(Ok(())) => Ok(()),
            Ok(Err(_)) => Err(Closed::Left),
            Err(_) => Err(Closed::NotReading(self.timeout_s)),
        }
    }

    /// Says why, as far as the client listens, and ends.
    pub(super) async fn close(mut self, why: &Closed) {
        metrics::counter!("adit_feed_closed_total", "reason" => why.reason()).increment(1);
        if matches!(why, Closed::Left | Closed::NotReading(_)) {
            return;
        }
        let frame = CloseFrame { code: close_code::POLICY, reason: why.to_string().into() };
        let _ =
            tokio::time::timeout(Duration::from_secs(1), self.sink.send(Message::Close(Some(frame)))).await;
    }
}

/// When to check.
pub(super) fn checks() -> Interval {
    let mut interval = tokio::time::interval_at(tokio::time::Instant::now() + CHECK, CHECK);
    interval.set_missed_tick_behavior(MissedTickBehavior::Delay);
    interval
}

/// May who watches still watch? A store that does not answer shuts nobody out.
pub(super) async fn still(context: &Context, principal: &Principal) -> Result<(), Closed> {
    match context.auth.again(principal).await {
        Ok(Some(principal)) if principal.may(Permission::SeeLive) => Ok(()),
        Ok(_) => Err(Closed::NoLonger),
        Err(error) => {
            tracing::warn!("who watches cannot be checked: {error}");
            Ok(())
        }
    }
}

/// Too many watch.
pub(super) fn full() -> ApiError {
    ApiError::unavailable("as many watch as may", 10)
}
