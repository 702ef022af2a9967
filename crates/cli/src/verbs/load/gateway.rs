//! A gateway: each second a batch of its tags' packets, sent until it is acknowledged.

use super::Clock;
use super::report::Account;
use super::walks::{FIRST_NUMBER, Template};
use crate::args::LoadArgs;
use adit_observation::wire::Batch;
use anyhow::{Context, Result};
use rumqttc::{AsyncClient, Event, MqttOptions, Outgoing, Packet, QoS};
use std::collections::{BTreeMap, VecDeque};
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::oneshot;

/// Before a batch is sent again: doubled each time, up to the second.
const RETRY: (Duration, Duration) = (Duration::from_millis(100), Duration::from_secs(2));

/// A gateway.
pub struct Gateway {
    /// Its name.
    pub name: String,
    /// Number of its start.
    pub boot: u64,
    /// Its tags.
    pub tags: Range<u32>,
    /// When in the second it sends, 0 to 1.
    pub phase: f64,
    /// For how long.
    pub seconds: u32,
}

/// How batches go to the server.
#[derive(Clone)]
pub enum Sender {
    /// By HTTP.
    Http {
        /// Keeps its connections.
        client: reqwest::Client,
        /// The server.
        url: String,
        /// Its token.
        token: String,
    },
    /// By a broker.
    Mqtt {
        /// One connection for all gateways.
        client: AsyncClient,
        /// Site in the topics.
        site: String,
        /// Who waits for which acknowledgement.
        waiting: Arc<Mutex<Waiting>>,
    },
}

/// Who waits for the acknowledgement of the broker.
#[derive(Default)]
pub struct Waiting {
    /// Handed to the client, not yet sent; in order.
    handed: VecDeque<oneshot::Sender<()>>,
    /// Sent, by the number of the packet.
    sent: BTreeMap<u16, oneshot::Sender<()>>,
}

impl Sender {
    /// As the flags say.
    pub fn new(args: &LoadArgs) -> Result<Self> {
        let Some(broker) = &args.mqtt else {
            let client = reqwest::Client::builder().timeout(Duration::from_secs(30)).build()?;
            return Ok(Self::Http { client, url: args.url.clone(), token: args.token.clone() });
        };
        let (host, port) = broker.rsplit_once(':').context("--mqtt: expected HOST:PORT")?;
        let port = port.parse().with_context(|| format!("--mqtt: port \"{port}\""))?;
        let mut options = MqttOptions::new(format!("adit-load-{}", std::process::id()), host, port);
        // The broker keeps what it has acknowledged, and the client what it has not.
        options.set_clean_session(false).set_inflight(1000).set_max_packet_size(32 << 20, 32 << 20);
        let (client, mut events) = AsyncClient::new(options, 10);
        let waiting = Arc::new(Mutex::new(Waiting::default()));
        let acknowledged = Arc::clone(&waiting);
        tokio::spawn(async move {
            loop {
                let event = events.poll().await;
                let mut waiting = acknowledged.lock().unwrap_or_else(PoisonError::into_inner);
                match event {
                    Ok(Event::Outgoing(Outgoing::Publish(id))) => {
                        // One that is known is sent again after the connection was lost.
                        if !waiting.sent.contains_key(&id)
                            && let Some(who) = waiting.handed.pop_front()
                        {
                            waiting.sent.insert(id, who);
                        }
                    }
                    Ok(Event::Incoming(Packet::PubAck(ack))) => {
                        if let Some(who) = waiting.sent.remove(&ack.pkid) {
                            // Whoever waited may have given up.
                            let _ = who.send(());
                        }
                    }
                    Ok(_) => {}
                    Err(error) => {
                        drop(waiting);
                        tracing::warn!("{error}");
                        tokio::time::sleep(RETRY.0).await;
                    }
                }
            }
        });
        Ok(Self::Mqtt { client, site: args.site.clone(), waiting })
    }

    /// Sends a batch and waits until it is acknowledged.
    async fn send(&self, gateway: &str, batch: Vec<u8>) -> Result<()> {
        match self {
            Self::Http { client, url, token } => {
                let url = format!("{url}/api/v1/gateways/{gateway}/observations");
                let request =
                    client.post(&url).bearer_auth(token).header("content-type", "application/x-protobuf");
                let answer = request.body(batch).send().await?;
                if !answer.status().is_success() {
                    anyhow::bail!("{url}: {}: {}", answer.status(), answer.text().await.unwrap_or_default());
                }
                Ok(())
            }
            Self::Mqtt { client, site, waiting } => {
                let (who, acknowledged) = oneshot::channel();
                waiting.lock().unwrap_or_else(PoisonError::into_inner).handed.push_back(who);
                let topic = format!("adit/v1/{site}/{gateway}/obs");
                client.publish(topic, QoS::AtLeastOnce, false, batch).await?;
                acknowledged.await.context("the connection to the broker was lost")
            }
        }
    }
}

impl Gateway {
    /// Sends until the end.
    pub async fn run(
        self,
        sender: Sender,
        account: Arc<Account>,
        walks: Arc<Vec<Vec<Template>>>,
        clock: Clock,
    ) {
        for second in 0..self.seconds {
            // What was measured in a second is there when it is over.
            let due = clock.at(f64::from(second) + 1.0 + self.phase);
            tokio::time::sleep_until(due.into()).await;
            let (batch, observations) = self.batch(second, &walks, clock.begin_s);
            let handed = Instant::now();
            account.sent(&self.tags, handed, batch.len(), observations);
            let mut wait = RETRY.0;
            while let Err(error) = sender.send(&self.name, batch.clone()).await {
                account.failed();
                tracing::debug!("{}: {error:#}", self.name);
                tokio::time::sleep(wait).await;
                wait = (2 * wait).min(RETRY.1);
            }
            account.acknowledged(&self.tags, second, handed.elapsed());
        }
    }

    fn batch(&self, second: u32, walks: &[Vec<Template>], begin_s: i64) -> (Vec<u8>, u64) {
        let mut batch = Batch::new(self.boot, u64::from(second) + 1);
        let mut observations = 0;
        for tag in self.tags.clone() {
            let walk = &walks[tag as usize % walks.len()];
            let Some(template) = walk.get(second as usize) else { continue };
            observations += template.observations as u64;
            let packet = template.packet(tag, FIRST_NUMBER + u64::from(second), begin_s + i64::from(second));
            batch.packets.push(packet.into());
        }
        (batch.to_bytes(), observations)
    }
}
