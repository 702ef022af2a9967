//! The server of the shift: `adit serve` in a process of its own, so that its power can be cut.

use super::gateways::Target;
use crate::output::write_file;
use adit_server::Pace;
use adit_tracking::rules::ContactRules;
use anyhow::{Context, Result, bail};
use serde_json::{Value, json};
use std::io::{BufRead as _, BufReader};
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// How long a request may take.
const PATIENCE: Duration = Duration::from_secs(20);
/// How long a server may take to end.
const END: Duration = Duration::from_secs(15);

/// The mine, and what the tags are.
const MINE: &str = include_str!("../../../../../mines/demo.toml");

/// A server.
pub struct Host {
    child: Child,
    config: PathBuf,
    /// Its address.
    pub address: SocketAddr,
    /// Of the user `admin`.
    pub password: String,
}

/// Nothing from anywhere for so long, of the wall, is silence: at ten times real time a busy machine is late by many seconds of the mine.
const SILENCE_WALL_S: f64 = 15.0;

/// Writes mine, sidecar and settings; the path of the mine.
pub fn write_mine(folder: &Path) -> Result<PathBuf> {
    let mine = folder.join("mine.toml");
    write_file(&mine, MINE)?;
    Ok(mine)
}

fn write_settings(config: &Path, listen: SocketAddr, pace: Pace, sidecar: &str) -> Result<()> {
    let folder = config.parent().unwrap_or(Path::new(""));
    write_file(&folder.join("lamp.toml"), sidecar)?;
    let Pace { wall_ns, world_ns, speed } = pace;
    let silence_s = (SILENCE_WALL_S * speed).max(ContactRules::default().silence_after_s);
    write_file(
        config,
        &format!(
            "[site]\nname = \"demo\"\nmine = \"mine.toml\"\ndata = \"data\"\n\n\
             [api]\nlisten = \"{listen}\"\n\n\
             [pipeline]\nsnapshot_s = 10.0\n\n\
             [[profiles]]\nname = \"lamps\"\ntags = [\"*\"]\nmethod = \"fused\"\nsidecar = \"lamp.toml\"\n\n\
             [rules.contact]\nsilence_after_s = {silence_s:?}\n\n\
             [clock]\nwall_ns = {wall_ns}\nworld_ns = {world_ns}\nspeed = {speed:?}\n"
        ),
    )
}

impl Host {
    /// Starts one in a folder; its settings stand in `adit.toml` there.
    pub fn start(folder: &Path, listen: SocketAddr, pace: Pace, sidecar: &str) -> Result<Self> {
        let config = folder.join("adit.toml");
        write_settings(&config, listen, pace, sidecar)?;
        let (child, address, password) = spawn(&config)?;
        let password = password.context("the server has a data folder already: --out needs a new one")?;
        Ok(Self { child, config, address, password })
    }

    /// The power goes: nothing is stored, said or closed any more.
    pub fn cut_power(&mut self) -> Result<()> {
        self.child.kill().context("the server cannot be killed")?;
        self.child.wait().context("the server has not ended")?;
        Ok(())
    }

    /// The power is back: the same server on the same data, its clock as `pace` has it.
    pub fn restart(&mut self, pace: Pace, sidecar: &str) -> Result<()> {
        write_settings(&self.config, self.address, pace, sidecar)?;
        let (child, _, _) = spawn(&self.config)?;
        self.child = child;
        Ok(())
    }

    /// Whether it has ended by itself.
    pub fn has_ended(&mut self) -> bool {
        matches!(self.child.try_wait(), Ok(Some(_)) | Err(_))
    }

    /// Ends it: what has come is stored.
    pub fn stop(mut self) {
        drop(self.child.stdin.take());
        let until = Instant::now() + END;
        while Instant::now() < until {
            if self.has_ended() {
                return;
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Logs in.
    pub async fn log_in(&self) -> Result<Target> {
        let client = reqwest::Client::builder().timeout(PATIENCE).build()?;
        let url = format!("http://{}", self.address);
        let target = Target { client, url, token: String::new() };
        let body = json!({ "name": "admin", "password": self.password });
        let answer = target.ask("POST", "/api/v1/session", Some(body)).await?;
        let token = answer["token"].as_str().context("a log-in without a token")?.to_owned();
        Ok(Target { token, ..target })
    }
}

impl Drop for Host {
    fn drop(&mut self) {
        // It has ended, or nobody needs it any more.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Starts the server and reads what it says: its address, and the password at its first start.
fn spawn(config: &Path) -> Result<(Child, SocketAddr, Option<String>)> {
    let program = std::env::current_exe().context("where this program is")?;
    let mut child = Command::new(program)
        .args(["serve", "--while-stdin", "--config"])
        .arg(config)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .context("the server cannot be started")?;
    let stdout = child.stdout.take().context("the server has no stdout")?;
    let fresh = !config.with_file_name("data").join("adit.sqlite").exists();
    let mut lines = BufReader::new(stdout).lines();
    let Some(first) = lines.next().transpose()? else {
        let _ = child.wait();
        bail!("the server did not start: what it says stands above");
    };
    let address = first.split("http://").nth(1).and_then(|rest| rest.split_whitespace().next());
    let address =
        address.and_then(|text| text.parse().ok()).context("the server does not say its address")?;
    let password = if fresh { lines.next().transpose()? } else { None };
    let password =
        password.and_then(|line| Some(line.split("password ").nth(1)?.split(':').next()?.to_owned()));
    // Whoever writes must not wait for somebody to read.
    std::thread::spawn(move || lines.for_each(drop));
    Ok((child, address, password))
}

impl Target {
    /// Asks; what is not done is an error.
    pub async fn ask(&self, method: &str, path: &str, body: Option<Value>) -> Result<Value> {
        let url = format!("{}{path}", self.url);
        let mut request = self.client.request(method.parse()?, &url);
        if !self.token.is_empty() {
            request = request.bearer_auth(&self.token);
        }
        if let Some(body) = body {
            request = request.json(&body);
        }
        let answer = request.send().await.with_context(|| url.clone())?;
        let status = answer.status();
        let text = answer.text().await.unwrap_or_default();
        if !status.is_success() {
            bail!("{method} {url}: {status}: {text}");
        }
        Ok(serde_json::from_str(&text).unwrap_or_default())
    }
}
