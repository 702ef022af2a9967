//! A server as somebody starts it, and a load.

use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

pub fn adit() -> Command {
    Command::new(env!("CARGO_BIN_EXE_adit"))
}

pub fn mine() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../mines/two-level.toml")
}

/// A server as somebody starts it.
pub struct Served {
    child: Child,
    pub url: String,
    password: Option<String>,
}

impl Served {
    /// Starts one on the folder; on a free port at first, then on the same.
    pub fn start(folder: &Path, config: Option<&Path>, listen: &str) -> Self {
        Self::run(adit(), folder, config, listen)
    }

    /// The same by another command that ends in `adit`.
    pub fn run(mut command: Command, folder: &Path, config: Option<&Path>, listen: &str) -> Self {
        command.arg("serve").arg("--listen").arg(listen).arg("--data").arg(folder);
        match config {
            Some(config) => command.arg("--config").arg(config),
            None => command.arg("--mine").arg(mine()),
        };
        let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
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

    /// Of the process.
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Memory in use, MB.
    pub fn memory_mb(&self) -> f64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.id())).unwrap();
        let line = status.lines().find(|line| line.starts_with("VmRSS:")).unwrap();
        line.split_whitespace().nth(1).unwrap().parse::<f64>().unwrap() / 1024.0
    }

    /// A counter of `/metrics`; 0 before the first is counted.
    pub async fn counter(&self, token: &str, name: &str) -> f64 {
        let request = Self::client().get(format!("{}/metrics", self.url)).bearer_auth(token);
        let text = request.send().await.unwrap().text().await.unwrap();
        let of = |line: &str| line.strip_prefix(name)?.trim().parse().ok();
        text.lines().find_map(of).unwrap_or_default()
    }

    /// Whether all parts work, and those that do not.
    pub async fn failing(&self) -> (u16, Vec<String>) {
        let (status, health) = self.ask("GET", "/health", "", None).await;
        let parts = health["parts"].as_array().unwrap().iter().filter(|part| part["ok"] == json!(false));
        (status, parts.map(|part| part["part"].as_str().unwrap().to_owned()).collect())
    }

    /// Waits until `/health` says so.
    pub async fn wait_for_health(&self, wanted: u16, within: Duration) -> Vec<String> {
        let begin = Instant::now();
        loop {
            let (status, parts) = self.failing().await;
            if status == wanted {
                return parts;
            }
            assert!(begin.elapsed() < within, "/health is {status} ({parts:?}) after {within:?}");
            tokio::time::sleep(Duration::from_millis(100)).await;
        }
    }

    /// When the live position of each tag is of.
    pub async fn positions(&self, token: &str) -> BTreeMap<String, jiff::Timestamp> {
        let (status, live) = self.ask("GET", "/api/v1/live", token, None).await;
        assert_eq!(status, 200, "{live}");
        let mut times = BTreeMap::new();
        collect(&live, &mut times);
        times
    }

    /// Waits until tags have positions.
    pub async fn wait_for_positions(&self, token: &str) {
        for _ in 0..1200 {
            if !self.positions(token).await.is_empty() {
                return;
            }
            tokio::time::sleep(Duration::from_millis(100)).await;
        }
        panic!("no position within 2 minutes");
    }

    /// The stored fixes of a tag: time, s, and position, m.
    pub async fn track(&self, token: &str, tag: &str) -> Vec<(f64, [f64; 3])> {
        let path = "/api/v1/export/tracks?format=csv&from=1970-01-01T00:00:00Z&until=2100-01-01T00:00:00Z";
        let request =
            Self::client().get(format!("{}{path}&tag=true&about={tag}", self.url)).bearer_auth(token);
        let text = request.send().await.unwrap().text().await.unwrap();
        let mut lines = text.lines();
        let head: Vec<&str> = lines.next().unwrap().split(',').collect();
        let column = |name: &str| head.iter().position(|column| *column == name).expect(name);
        let (time, x) = (column("time_s"), column("x_m"));
        let fix = |line: &str| {
            let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
            (cells[time], [cells[x], cells[x + 1], cells[x + 2]])
        };
        lines.map(fix).collect()
    }

    /// Checks that the history of a tag has no hole, from before a moment up to the live position, which may be on its way.
    pub async fn check_history(&self, token: &str, tag: &str, before: jiff::Timestamp) {
        let newest = self.positions(token).await[tag].as_millisecond() as f64 / 1e3;
        let mut times = Vec::new();
        for _ in 0..100 {
            times = self.track(token, tag).await.into_iter().map(|(time, _)| time).collect();
            times.sort_by(f64::total_cmp);
            if times.last().is_some_and(|last| *last > newest - 0.002) {
                break;
            }
            tokio::time::sleep(Duration::from_millis(100)).await;
        }
        let longest = times.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        let (first, last) = (times[0], times[times.len() - 1]);
        println!("{tag}: {} fixes in {:.1} s, the longest gap {longest:.1} s", times.len(), last - first);
        // Stored to the ms.
        assert!(
            last > newest - 0.002,
            "the last stored fix is {:.3} s older than the live one",
            newest - last
        );
        assert!(first < before.as_millisecond() as f64 / 1e3 + 0.002, "the history begins late");
        // A fix a second; a tag that stands still may have one in two.
        assert!(longest < 2.5, "a gap of {longest:.1} s");
    }

    /// The power goes.
    pub fn kill(mut self) -> String {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
        self.url.trim_start_matches("http://").to_owned()
    }

    pub fn client() -> reqwest::Client {
        reqwest::Client::builder().timeout(Duration::from_secs(20)).build().unwrap()
    }

    pub async fn ask(&self, method: &str, path: &str, token: &str, body: Option<Value>) -> (u16, Value) {
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
    pub async fn token(&self) -> String {
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
pub fn load(url: &str, token: &str, arguments: &[&str]) -> Child {
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

pub fn report(load: Child) -> Value {
    let output = load.wait_with_output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let mut values = serde_json::Deserializer::from_str(&text).into_iter::<Value>();
    let report = values.next().unwrap_or_else(|| panic!("no report: {text}")).unwrap();
    assert!(output.status.success(), "{report}");
    report
}

/// Every position in an answer.
fn collect(value: &Value, times: &mut BTreeMap<String, jiff::Timestamp>) {
    match value {
        Value::Object(members) => {
            let text = |name| members.get(name).and_then(Value::as_str);
            if let (Some(tag), Some(time), true) =
                (text("tag"), text("time"), members.contains_key("position_m"))
            {
                times.insert(tag.to_owned(), time.parse().unwrap());
            }
            members.values().for_each(|member| collect(member, times));
        }
        Value::Array(items) => items.iter().for_each(|item| collect(item, times)),
        _ => {}
    }
}
