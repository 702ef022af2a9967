//! Junk by the thousands beside good packets.

use crate::broker::Broker;
use crate::served::{Served, adit, load, mine, report};
use adit_observation::wire::Batch;
use rumqttc::{AsyncClient, MqttOptions, QoS};
use serde_json::json;
use std::fs::File;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

const FLOOD: Duration = Duration::from_secs(12);

/// A batch with a packet that is none, under a number of its own.
fn hollow(sequence: u64) -> Vec<u8> {
    let mut batch = Batch::new(0xbad, sequence);
    // A field of 100 bytes of which three are there.
    batch.packets.push(vec![0x0a, 100, b'x', b'y', b'z'].into());
    batch.to_bytes()
}

/// Junk of four kinds: no protobuf, half a batch, a batch of no packets' worth, a gateway that cannot be one.
fn junk(number: u64) -> (&'static str, Vec<u8>, u16) {
    let whole = hollow(number);
    match number % 4 {
        0 => ("junk", vec![0xff; 300], 422),
        1 => ("junk", whole[..whole.len() - 2].to_vec(), 422),
        2 => ("junk", whole, 200),
        _ => ("a%2Bb", hollow(number), 422),
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_flood_of_junk_is_counted_and_good_packets_come_through() {
    let broker = Broker::start();
    let folder = tempfile::tempdir().unwrap();
    let config = folder.path().join("adit.toml");
    let mqtt = broker.as_ref().map(|broker| format!("[mqtt]\nport = {}\n", broker.port)).unwrap_or_default();
    std::fs::write(&config, format!("[site]\nname = \"north\"\nmine = \"{}\"\n{mqtt}", mine().display()))
        .unwrap();
    let log = folder.path().join("log");
    let mut command = adit();
    command.stderr(File::create(&log).unwrap());
    let served = Served::run(command, folder.path(), Some(&config), "127.0.0.1:0");
    let token = served.token().await;
    let load = load(&served.url, &token, &["--tags", "20", "--seconds", "35", "--per-gateway", "5"]);
    served.wait_for_positions(&token).await;
    tokio::time::sleep(Duration::from_secs(5)).await;
    let (before_mb, begin) = (served.memory_mb(), Instant::now());

    let sent = Arc::new([const { AtomicU64::new(0) }; 2]);
    let mut floods = Vec::new();
    for first in 0..4_u64 {
        let (url, token, sent) = (served.url.clone(), token.clone(), Arc::clone(&sent));
        floods.push(tokio::spawn(async move {
            let client = reqwest::Client::new();
            for number in
                (first + 1..).step_by(4).map(|n| n * 5 + n / 4).take_while(|_| begin.elapsed() < FLOOD)
            {
                let (gateway, body, expected) = junk(number);
                let url = format!("{url}/api/v1/gateways/{gateway}/observations");
                let request =
                    client.post(url).bearer_auth(&token).header("content-type", "application/x-protobuf");
                let answer = request.body(body).send().await.unwrap();
                assert_eq!(answer.status().as_u16(), expected, "{}", answer.text().await.unwrap());
                sent[0].fetch_add(1, Ordering::Relaxed);
            }
        }));
    }
    if let Some(broker) = &broker {
        let sent = Arc::clone(&sent);
        let mut options = MqttOptions::new("flood", "127.0.0.1", broker.port);
        options.set_inflight(500);
        let (client, mut events) = AsyncClient::new(options, 100);
        let polling = tokio::spawn(async move { while events.poll().await.is_ok() {} });
        floods.push(tokio::spawn(async move {
            for number in (1_u64 << 40..).take_while(|_| begin.elapsed() < FLOOD) {
                let (gateway, body, _) = junk(number);
                let topic = format!("adit/v1/north/{gateway}/obs");
                client.publish(topic, QoS::AtLeastOnce, false, body).await.unwrap();
                sent[1].fetch_add(1, Ordering::Relaxed);
            }
            // What is handed over is sent.
            tokio::time::sleep(Duration::from_secs(2)).await;
            polling.abort();
        }));
    }
    for flood in floods {
        flood.await.unwrap();
    }
    let report = report(load);
    println!("{report}");
    let [by_http, by_mqtt] = [0, 1].map(|way| sent[way].load(Ordering::Relaxed));
    let per_s = (by_http + by_mqtt) / FLOOD.as_secs();
    let after_mb = served.memory_mb();
    let (batches, packets) = (
        served.counter(&token, "adit_bad_batches_total").await,
        served.counter(&token, "adit_bad_packets_total").await,
    );
    let log_bytes = std::fs::metadata(&log).unwrap().len();
    println!(
        "junk: {by_http} by HTTP, {by_mqtt} by MQTT, {per_s}/s; counted: {batches} batches, {packets} packets; \
         memory {before_mb:.0} MB before, {after_mb:.0} MB after; log {log_bytes} bytes"
    );
    assert_eq!((&report["lost_packets"], &report["packets"]), (&json!(0), &json!(700)), "{report}");
    assert!(report["position"]["count"].as_u64().unwrap() > 200, "{report}");
    // "Thousands a second" on a machine of its own; on two cores shared with others it may be fewer.
    assert!(per_s > 300, "{per_s}/s is no flood");
    // By HTTP every answer was seen. What the broker still held when the flood ended may be missing.
    assert!(batches + packets >= by_http as f64, "{batches} and {packets} of {by_http} and {by_mqtt}");
    // One line in 5 s of each kind, a few kinds, 150 bytes.
    assert!(log_bytes < 20_000, "{log_bytes} bytes of log: {}", std::fs::read_to_string(&log).unwrap());
    // Nothing is kept of junk. What waits is bounded: 4096 messages of the broker and 8192 entries for the journal, below 1 kB each, and
    // what the allocator keeps of them.
    assert!(after_mb - before_mb < 48.0, "{before_mb:.0} MB before, {after_mb:.0} MB after");
    assert_eq!(served.failing().await.0, 200);
}
