//! `adit serve` and `adit load`, as they are run: the real binary, a real broker, power cuts.
#![expect(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail by panicking")]

use serde_json::{Value, json};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

fn adit() -> Command {
    Command::new(env!("CARGO_BIN_EXE_adit"))
}

fn mine() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../mines/two-level.toml")
}

/// A server as somebody starts it.
struct Served {
    child: Child,
    url: String,
    password: Option<String>,
}

impl Served {
    /// Starts one on the folder; on a free port at first, then on the same.
    fn start(folder: &Path, config: Option<&Path>, listen: &str) -> Self {
        let mut command = adit();
        command.arg("serve").arg("--listen").arg(listen).arg("--data").arg(folder);
        match config {
            Some(config) => command.arg("--config").arg(config),
            None => command.arg("--mine").arg(mine()),
        };
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::inherit()).spawn().unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let first = lines.next().expect("a line with the address").unwrap();
        let url = first.split_whitespace().find(|word| word.starts_with("http")).unwrap().to_owned();
        // The password comes with the first line or not at all; the pipe is drained from here on.
        let password = folder.join("password");
        if !password.exists() {
            let line = lines.next().unwrap().unwrap();
            let word = line.split("password ").nth(1).unwrap().split(':').next().unwrap().to_owned();
            std::fs::write(&password, word).unwrap();
        }
        let password = std::fs::read_to_string(&password).ok();
        std::thread::spawn(move || lines.for_each(drop));
        Self { child, url, password }
    }

    /// The power goes.
    fn kill(mut self) -> String {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
        self.url.trim_start_matches("http://").to_owned()
    }

    fn client() -> reqwest::Client {
        reqwest::Client::builder().timeout(Duration::from_secs(20)).build().unwrap()
    }

    async fn ask(&self, method: &str, path: &str, token: &str, body: Option<Value>) -> (u16, Value) {
        let url = format!("{}{path}", self.url);
        let mut request = Self::client().request(method.parse().unwrap(), url).bearer_auth(token);
        if let Some(body) = body {
            request = request.json(&body);
        }
        let answer = request.send().await.unwrap();
        let status = answer.status().as_u16();
        (status, serde_json::from_str(&answer.text().await.unwrap()).unwrap_or_default())
    }

    /// A token of the administrator.
    async fn token(&self) -> String {
        let password = self.password.clone().unwrap();
        let body = json!({ "name": "admin", "password": password });
        let (status, answer) = self.ask("POST", "/api/v1/session", "", Some(body)).await;
        assert_eq!(status, 200, "{answer}");
        let session = answer["token"].as_str().unwrap_or_else(|| panic!("{answer}")).to_owned();
        let body = json!({ "name": "test", "grant": "admin" });
        let (status, answer) = self.ask("POST", "/api/v1/tokens", &session, Some(body)).await;
        assert!(status == 200 || status == 201, "{answer}");
        answer["secret"].as_str().unwrap_or_else(|| panic!("{answer}")).to_owned()
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A load that runs beside; its report.
fn load(url: &str, token: &str, arguments: &[&str]) -> Child {
    let mut command = adit();
    command
        .arg("load")
        .arg(url)
        .arg("--mine")
        .arg(mine())
        .args(["--json", "-", "--walkers", "2"])
        .args(arguments);
    command.env("ADIT_TOKEN", token).stdout(Stdio::piped()).stderr(Stdio::inherit());
    command.spawn().unwrap()
}

fn report(load: Child) -> Value {
    let output = load.wait_with_output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let mut values = serde_json::Deserializer::from_str(&text).into_iter::<Value>();
    let report = values.next().unwrap_or_else(|| panic!("no report: {text}")).unwrap();
    assert!(output.status.success(), "{report}");
    report
}

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

/// Mosquitto on a port of its own; what it holds is kept when it ends politely.
struct Broker {
    child: Child,
    port: u16,
    folder: tempfile::TempDir,
}

impl Broker {
    /// `None`, visibly, where there is none: `apt-get install mosquitto`.
    fn start() -> Option<Self> {
        let folder = tempfile::tempdir().unwrap();
        let port = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let kept = folder.path().display();
        let config = format!(
            "listener {port} 127.0.0.1\nallow_anonymous true\npersistence true\npersistence_location {kept}/\n\
             max_queued_messages 0\nmax_inflight_messages 4096\nuser root\n"
        );
        std::fs::write(folder.path().join("mosquitto.conf"), config).unwrap();
        let child = Self::spawn(folder.path());
        if child.is_none() {
            println!("SKIPPED (no test data): mosquitto (apt-get install mosquitto)");
        }
        child.map(|child| Self { child, port, folder })
    }

    fn spawn(folder: &Path) -> Option<Child> {
        let config = folder.join("mosquitto.conf");
        let started = |program: &str| {
            Command::new(program)
                .arg("-c")
                .arg(&config)
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()
                .ok()
        };
        started("mosquitto").or_else(|| started("/usr/sbin/mosquitto"))
    }

    /// Away for so long.
    async fn restart(&mut self, away: Duration) {
        let id = self.child.id().to_string();
        assert!(Command::new("kill").args(["-TERM", &id]).status().unwrap().success());
        self.child.wait().unwrap();
        tokio::time::sleep(away).await;
        self.child = Self::spawn(self.folder.path()).unwrap();
    }
}

impl Drop for Broker {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
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
