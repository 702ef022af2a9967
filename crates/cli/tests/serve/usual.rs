//! Load, power cuts, a broker that goes away, settings.

use crate::broker::Broker;
use crate::served::{Served, adit, load, mine, report};
use serde_json::json;
use std::time::{Duration, Instant};

#[tokio::test]
async fn a_load_comes_through_and_nothing_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    let served = Served::start(folder.path(), None, "127.0.0.1:0");
    let token = served.token().await;
    let report =
        report(load(&served.url, &token, &["--tags", "20", "--seconds", "15", "--per-gateway", "5"]));
    assert_eq!((&report["packets"], &report["lost_packets"]), (&json!(300), &json!(0)), "{report}");
    assert_eq!(report["failed_tries"], json!(0), "{report}");
    assert!(report["position"]["count"].as_u64().unwrap() > 50, "{report}");
    let (status, following) = served.ask("GET", "/api/v1/tags/T000003/following", &token, None).await;
    assert_eq!((status, &following["method"]), (200, &json!("fused")), "{following}");
    assert_eq!(following["counts"]["packets"], json!(15), "{following}");
    let (_, people) = served.ask("GET", "/api/v1/live", &token, None).await;
    assert!(people.to_string().contains("T000003"), "{people}");
}

#[tokio::test]
async fn after_power_cuts_nothing_that_was_acknowledged_is_missing() {
    let cuts: u32 = std::env::var("ADIT_POWER_CUTS").ok().and_then(|n| n.parse().ok()).unwrap_or(4);
    let folder = tempfile::tempdir().unwrap();
    let mut served = Served::start(folder.path(), None, "127.0.0.1:0");
    let token = served.token().await;
    let seconds = (cuts * 5 + 10).to_string();
    let load = load(&served.url, &token, &["--tags", "40", "--seconds", &seconds, "--per-gateway", "4"]);
    // The walks are simulated first.
    for _ in 0..600 {
        let (_, packets) = served.ask("GET", "/api/v1/packets", &token, None).await;
        if packets.as_array().is_some_and(|packets| !packets.is_empty()) {
            break;
        }
        tokio::time::sleep(Duration::from_millis(100)).await;
    }
    for cut in 0..cuts {
        // Anywhere in a second, in a write, in a snapshot: the same moments in each run.
        let wait = 2500 + u64::from(cut.wrapping_mul(2_654_435_761) >> 20) % 2000;
        tokio::time::sleep(Duration::from_millis(wait)).await;
        let address = served.kill();
        let started = Instant::now();
        served = Served::start(folder.path(), None, &address);
        println!("cut {cut}: up again after {:.1} s", started.elapsed().as_secs_f64());
    }
    let report = report(load);
    println!("{report}");
    assert!(report["failed_tries"].as_u64().unwrap() > 0, "no cut was felt: {report}");
    assert_eq!(report["lost_packets"], json!(0), "{report}");
    assert_eq!(report["packets"], json!(40 * seconds.parse::<u64>().unwrap()), "{report}");
    // Estimators went on from their snapshots: none began anew.
    let (_, following) = served.ask("GET", "/api/v1/tags/T000007/following", &token, None).await;
    assert_eq!(following["counts"]["restarts"], json!(0), "{following}");
}

#[tokio::test]
async fn by_a_broker_that_goes_away_nothing_is_lost() {
    let away: u64 = std::env::var("ADIT_BROKER_AWAY_S").ok().and_then(|s| s.parse().ok()).unwrap_or(5);
    let Some(mut broker) = Broker::start() else { return };
    let folder = tempfile::tempdir().unwrap();
    let config = folder.path().join("adit.toml");
    let text = format!(
        "[site]\nname = \"north\"\nmine = \"{}\"\n[mqtt]\nport = {}\n",
        mine().display(),
        broker.port
    );
    std::fs::write(&config, text).unwrap();
    let served = Served::start(folder.path(), Some(&config), "127.0.0.1:0");
    let token = served.token().await;
    let (seconds, address) = ((away + 15).to_string(), format!("127.0.0.1:{}", broker.port));
    let arguments =
        ["--tags", "20", "--seconds", &seconds, "--per-gateway", "5", "--mqtt", &address, "--site", "north"];
    let load = load(&served.url, &token, &arguments);
    tokio::time::sleep(Duration::from_secs(8)).await;
    broker.restart(Duration::from_secs(away)).await;
    let report = report(load);
    println!("{report}");
    assert_eq!(report["lost_packets"], json!(0), "{report}");
    assert_eq!(report["packets"], json!(20 * (away + 15)), "{report}");
    let (status, health) = served.ask("GET", "/health", "", None).await;
    assert_eq!((status, &health["ready"]), (200, &json!(true)), "{health}");
}

#[test]
fn what_is_no_configuration_is_told_with_file_and_line() {
    let folder = tempfile::tempdir().unwrap();
    let config = folder.path().join("adit.toml");
    let told = |text: &str| {
        std::fs::write(&config, text).unwrap();
        let output = adit().arg("serve").arg("--config").arg(&config).output().unwrap();
        assert_eq!(output.status.code(), Some(1));
        let told = String::from_utf8(output.stderr).unwrap();
        told.replace(&format!("{}/", folder.path().display()), "").trim_end().to_owned()
    };
    assert_eq!(told("[site]\nname = \"north\"\n"), "adit: no mine: give --mine or [site] mine = \"FILE\"");
    let typo = told("[site]\nmien = \"m.toml\"\n");
    assert!(typo.starts_with("adit: adit.toml:2: unknown field `mien`"), "{typo}");
    let half = told(&format!("[site]\nmine = \"{}\"\n[api]\nkey = \"k.pem\"\n", mine().display()));
    assert_eq!(half, "adit: [api] certificate and key: expected both or none");
}
