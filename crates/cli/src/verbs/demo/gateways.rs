//! The gateways of the shift: each keeps what it hears until the server has acknowledged it.

use super::crew::GATEWAYS;
use adit_core::time::Time;
use adit_observation::DeviceId;
use adit_observation::wire::{Batch, DeviceStatus};
use adit_server::Clock;
use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;
use tokio::sync::mpsc;

/// Before a batch is sent again: doubled each time, up to the second.
const RETRY: (Duration, Duration) = (Duration::from_millis(50), Duration::from_millis(500));
/// Seconds that go in one batch at most, when there is something to catch up with.
const MOST_SECONDS: usize = 20;

/// What a gateway hears in a second.
#[derive(Debug, Clone, Default)]
pub struct Heard {
    /// Packets.
    pub packets: Vec<Vec<u8>>,
    /// An anchor that answers, or does not any more.
    pub anchor: Option<(&'static str, bool)>,
    /// Not sent before: the gateway is cut off.
    pub not_before: Option<Time>,
}

/// What has become of the packets.
#[derive(Debug, Default)]
pub struct Account {
    /// Handed to gateways.
    pub handed: AtomicU64,
    /// Acknowledged: on the disk of the server.
    pub acknowledged: AtomicU64,
    /// Batches that had to be sent again.
    pub repeated: AtomicU64,
}

impl Account {
    /// Packets under way.
    pub fn waiting(&self) -> u64 {
        self.handed.load(Ordering::Relaxed).saturating_sub(self.acknowledged.load(Ordering::Relaxed))
    }
}

/// Where gateways send to.
#[derive(Clone)]
pub struct Target {
    /// Keeps connections.
    pub client: reqwest::Client,
    /// The server.
    pub url: String,
    /// A session or token that may.
    pub token: String,
}

/// All gateways.
pub struct Gateways {
    queues: Vec<mpsc::UnboundedSender<Heard>>,
    /// What has become of the packets.
    pub account: Arc<Account>,
}

impl Gateways {
    /// Starts them, on the current runtime.
    pub fn start(target: &Target, clock: &Clock, boot: u64) -> Self {
        let account = Arc::new(Account::default());
        let queues = GATEWAYS.iter().map(|name| {
            let (queue, inbox) = mpsc::unbounded_channel();
            tokio::spawn(send(name, target.clone(), clock.clone(), boot, Arc::clone(&account), inbox));
            queue
        });
        Self { queues: queues.collect(), account }
    }

    /// Gives a gateway what it hears.
    pub fn hear(&self, gateway: usize, heard: Heard) {
        self.account.handed.fetch_add(heard.packets.len() as u64, Ordering::Relaxed);
        if let Some(queue) = self.queues.get(gateway) {
            // A gateway ends with the demo alone.
            let _ = queue.send(heard);
        }
    }
}

async fn send(
    name: &'static str,
    target: Target,
    clock: Clock,
    boot: u64,
    account: Arc<Account>,
    mut inbox: mpsc::UnboundedReceiver<Heard>,
) {
    let url = format!("{}/api/v1/gateways/{name}/observations", target.url);
    let mut kept: VecDeque<Heard> = VecDeque::new();
    let mut sequence = 0;
    loop {
        if kept.is_empty() {
            let Some(heard) = inbox.recv().await else { return };
            kept.push_back(heard);
        }
        while let Ok(heard) = inbox.try_recv() {
            kept.push_back(heard);
        }
        if kept.front().and_then(|heard| heard.not_before).is_some_and(|until| clock.now() < until) {
            tokio::time::sleep(RETRY.0).await;
            continue;
        }
        sequence += 1;
        let mut batch = Batch::new(boot, sequence);
        for heard in kept.drain(..kept.len().min(MOST_SECONDS)) {
            batch.packets.extend(heard.packets.into_iter().map(Into::into));
            let devices = heard
                .anchor
                .and_then(|(id, up)| Some(DeviceStatus { device: DeviceId::new(id)?, up, battery: None }));
            batch.devices.extend(devices);
        }
        let count = batch.packets.len() as u64;
        let bytes = batch.to_bytes();
        let mut wait = RETRY.0;
        loop {
            let request = target.client.post(&url).bearer_auth(&target.token);
            let request = request.header("content-type", "application/x-protobuf").body(bytes.clone());
            match request.send().await.and_then(reqwest::Response::error_for_status) {
                Ok(_) => break,
                Err(error) => {
                    tracing::debug!("{name}: {error}");
                    account.repeated.fetch_add(1, Ordering::Relaxed);
                    tokio::time::sleep(wait).await;
                    wait = (2 * wait).min(RETRY.1);
                }
            }
        }
        account.acknowledged.fetch_add(count, Ordering::Relaxed);
    }
}
