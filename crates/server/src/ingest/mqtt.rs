//! Gateways by MQTT: topics `adit/v1/<site>/<gateway>/obs` (protobuf batches, `QoS` 1) and `…/status` (retained, `online` or `offline`; the
//! gateway's last will says `offline`).
//!
//! A message is acknowledged to the broker when the journal has it, so that the broker keeps what the server did not store. The
//! session is kept by the broker (`clean_session = false`): what is sent while the server is away waits there. What is no batch is acknowledged and
//! counted: sent again it would be none either.

use super::door::{Door, DoorError, Source};
use crate::api::{Health, Part};
use crate::error::ServerError;
use rumqttc::{AsyncClient, ConnectionError, Event, EventLoop, MqttOptions, Packet, Publish, QoS, Transport};
use rustls::pki_types::CertificateDer;
use rustls::pki_types::pem::PemObject as _;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{Semaphore, watch};

/// Messages taken from the broker and not yet acknowledged, at most; MQTT's own limit is 65,535.
const MOST_IN_FLIGHT: u16 = 4096;
/// Before a broker that is away is tried again: doubled each time, up to the second.
const RETRY: (Duration, Duration) = (Duration::from_millis(250), Duration::from_secs(10));

/// Which broker, and how.
#[derive(Debug, Clone)]
pub struct MqttSettings {
    /// Name or address.
    pub host: String,
    /// Port.
    pub port: u16,
    /// Site in the topics.
    pub site: String,
    /// Name of the server's session at the broker: the same at each start.
    pub client_id: String,
    /// User and password.
    pub login: Option<(String, String)>,
    /// By TLS, with these roots.
    pub tls: Option<Arc<rustls::ClientConfig>>,
}

/// Listens until it is told to stop; never ends by an error of the broker or of a message.
pub async fn listen(
    settings: &MqttSettings,
    door: Door,
    health: Arc<Health>,
    mut stop: watch::Receiver<bool>,
) {
    let (client, mut events) = connect(settings);
    let places = Arc::new(Semaphore::new(MOST_IN_FLIGHT.into()));
    let (mut wait, mut connected) = (RETRY.0, false);
    loop {
        let event = tokio::select! {
            event = events.poll() => event,
            _ = stop.wait_for(|stop| *stop) => break,
        };
        match event {
            Ok(Event::Incoming(Packet::ConnAck(_))) => {
                wait = RETRY.0;
                health.tell(Part::Broker, Ok(()));
                connected = true;
                tracing::info!("broker {}:{}: connected", settings.host, settings.port);
                for topic in ["obs", "status"] {
                    let filter = format!("adit/v1/{}/+/{topic}", settings.site);
                    // The request is queued; it fails when the loop has ended.
                    let _ = client.subscribe(filter, QoS::AtLeastOnce).await;
                }
            }
            Ok(Event::Incoming(Packet::Publish(publish))) => {
                let Ok(place) = Arc::clone(&places).acquire_owned().await else { break };
                let (client, door) = (client.clone(), door.clone());
                tokio::spawn(async move {
                    take(&client, &door, publish).await;
                    drop(place);
                });
            }
            Ok(_) => {}
            Err(error) => {
                if std::mem::take(&mut connected) {
                    metrics::counter!("adit_broker_losses_total").increment(1);
                }
                tracing::warn!(
                    "broker {}:{}: {}; again in {wait:?}",
                    settings.host,
                    settings.port,
                    told(&error)
                );
                tokio::select! {
                    () = tokio::time::sleep(wait) => {}
                    _ = stop.wait_for(|stop| *stop) => break,
                }
                wait = (2 * wait).min(RETRY.1);
            }
        }
    }
    // The broker keeps the session.
    let _ = client.try_disconnect();
}

/// TLS that trusts the certificates of a PEM file.
pub fn trusting(path: &Path) -> Result<Arc<rustls::ClientConfig>, ServerError> {
    let found = |found: &dyn std::fmt::Display| ServerError::Tls {
        path: path.to_path_buf(),
        expected: "PEM certificates",
        found: found.to_string(),
    };
    let pem = std::fs::read(path).map_err(|source| ServerError::io(path, source))?;
    let mut roots = rustls::RootCertStore::empty();
    for certificate in CertificateDer::pem_slice_iter(&pem) {
        roots.add(certificate.map_err(|error| found(&error))?).map_err(|error| found(&error))?;
    }
    if roots.is_empty() {
        return Err(found(&"none"));
    }
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let config = rustls::ClientConfig::builder_with_provider(provider)
        .with_safe_default_protocol_versions()
        .map_err(|error| found(&error))?;
    Ok(Arc::new(config.with_root_certificates(roots).with_no_client_auth()))
}

fn connect(settings: &MqttSettings) -> (AsyncClient, EventLoop) {
    let mut options = MqttOptions::new(&settings.client_id, &settings.host, settings.port);
    options
        .set_clean_session(false)
        .set_manual_acks(true)
        .set_inflight(MOST_IN_FLIGHT)
        .set_keep_alive(Duration::from_secs(15))
        .set_max_packet_size(super::LARGEST_BATCH + 1024, super::LARGEST_BATCH + 1024);
    if let Some((user, password)) = &settings.login {
        options.set_credentials(user, password);
    }
    if let Some(tls) = &settings.tls {
        options.set_transport(Transport::tls_with_config(tls.as_ref().clone().into()));
    }
    AsyncClient::new(options, MOST_IN_FLIGHT.into())
}

/// Takes one message; acknowledges it unless it was not stored.
async fn take(client: &AsyncClient, door: &Door, publish: Publish) {
    let taken = match route(&publish.topic) {
        Some((gateway, Kind::Observations)) => {
            let from = Source { name: gateway.to_owned(), json: false };
            store(|| door.batch(from.clone(), publish.payload.clone())).await
        }
        Some((gateway, Kind::Status)) => {
            let up = publish.payload.as_ref() == b"online";
            store(|| door.gateway(gateway, up)).await
        }
        None => Ok(()),
    };
    match taken {
        Ok(()) => {}
        Err(error) if error.is_senders_fault() => {}
        // Not acknowledged: the broker gives it again after the next connection.
        Err(error) => {
            tracing::warn!("{}: {error}", publish.topic);
            return;
        }
    }
    // It fails when the connection is gone: the broker gives the message again, and it is known then.
    let _ = client.ack(&publish).await;
}

/// Tries until it is stored or can never be; the broker is not told meanwhile and holds back.
async fn store<F: Future<Output = Result<super::Receipt, DoorError>>>(
    once: impl Fn() -> F,
) -> Result<(), DoorError> {
    let mut wait = RETRY.0;
    loop {
        match once().await {
            Ok(_) => return Ok(()),
            Err(error @ DoorError::NotStored(crate::journal::NotStored::Stopping)) => return Err(error),
            Err(error) if error.is_senders_fault() => return Err(error),
            Err(_) => {
                tokio::time::sleep(wait).await;
                wait = (2 * wait).min(RETRY.1);
            }
        }
    }
}

enum Kind {
    Observations,
    Status,
}

/// Gateway and kind of a topic `adit/v1/<site>/<gateway>/<kind>`.
fn route(topic: &str) -> Option<(&str, Kind)> {
    let mut levels = topic.split('/');
    let (Some("adit"), Some("v1"), Some(_site), Some(gateway), Some(kind), None) =
        (levels.next(), levels.next(), levels.next(), levels.next(), levels.next(), levels.next())
    else {
        return None;
    };
    let kind = match kind {
        "obs" => Kind::Observations,
        "status" => Kind::Status,
        _ => return None,
    };
    Some((gateway, kind))
}

/// On one line.
fn told(error: &ConnectionError) -> String {
    error.to_string().lines().collect::<Vec<_>>().join(" ")
}
