//! A viewer of the live positions, as the console is one; it comes back when the server does.

use super::report::Account;
use anyhow::{Context, Result};
use futures_util::{SinkExt, StreamExt};
use serde::Deserialize;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;

/// Before a server that is away is tried again.
const RETRY: Duration = Duration::from_millis(500);

/// What a viewer hears, of what matters here.
#[derive(Deserialize)]
struct Heard {
    #[serde(default)]
    positions: Vec<Moved>,
}

#[derive(Deserialize)]
struct Moved {
    tag: String,
}

/// A viewer.
pub struct Viewer {
    task: tokio::task::JoinHandle<()>,
}

impl Viewer {
    /// Connects and listens.
    pub async fn start(url: &str, token: &str, account: Arc<Account>) -> Result<Self> {
        let url = format!("{}/api/v1/live/socket", url.replacen("http", "ws", 1));
        let mut socket = Some(connect(&url, token).await?);
        let token = token.to_owned();
        let task = tokio::spawn(async move {
            loop {
                let connected = match socket.take() {
                    Some(connected) => Ok(connected),
                    None => connect(&url, &token).await,
                };
                match connected {
                    Ok(connected) => listen(connected, &account).await,
                    Err(error) => tracing::debug!("{error:#}"),
                }
                account.viewer_lost();
                tokio::time::sleep(RETRY).await;
            }
        });
        Ok(Self { task })
    }

    /// Listens for so much longer.
    pub async fn stop(self, after: Duration) {
        tokio::time::sleep(after).await;
        self.task.abort();
    }
}

type Socket = tokio_tungstenite::WebSocketStream<tokio_tungstenite::MaybeTlsStream<tokio::net::TcpStream>>;

async fn connect(url: &str, token: &str) -> Result<Socket> {
    let mut request = url.into_client_request().with_context(|| url.to_owned())?;
    let bearer = format!("Bearer {token}").parse().context("a token has no such characters")?;
    request.headers_mut().insert("authorization", bearer);
    Ok(tokio_tungstenite::connect_async(request).await.with_context(|| url.to_owned())?.0)
}

async fn listen(mut socket: Socket, account: &Account) {
    while let Some(Ok(message)) = socket.next().await {
        let arrived = Instant::now();
        match message {
            Message::Text(text) => {
                if let Ok(heard) = serde_json::from_str::<Heard>(&text) {
                    for moved in heard.positions {
                        account.moved(&moved.tag, arrived);
                    }
                }
            }
            Message::Ping(payload) => {
                let _ = socket.send(Message::Pong(payload)).await;
            }
            _ => {}
        }
    }
}
