//! `adit replay`: a recorded log into a running server, as a gateway sends it.

use crate::args::ReplayArgs;
use crate::interrupt;
use crate::log_stream::LogStream;
use crate::output;
use crate::progress::{self, Progress, Unit};
use adit_core::time::{Interval, Time};
use adit_observation::sidecar::Sidecar;
use adit_observation::wire::{Batch, Packet, Resolution};
use adit_observation::{DeviceId, Observation};
use anyhow::{Context, Result, bail};
use reqwest::StatusCode;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

const SECOND_NS: i64 = 1_000_000_000;
/// Before a batch is sent again: doubled each time, up to the second.
const RETRY: (Duration, Duration) = (Duration::from_millis(100), Duration::from_secs(5));
/// How long an answer may take.
const PATIENCE: Duration = Duration::from_secs(30);
/// Between two looks at Ctrl-C while it waits.
const PULSE: Duration = Duration::from_millis(100);

/// Sends the log and tells what came of it.
pub fn run(args: &ReplayArgs) -> Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().context("no runtime")?;
    let report = runtime.block_on(replay(args))?;
    if let Some(target) = &args.json {
        target.write(&(serde_json::to_string_pretty(&report)? + "\n"))?;
    }
    output::print(&report.to_string())?;
    match report.refused {
        0 => Ok(()),
        refused => bail!("{refused} batches were refused: {}", report.reason.as_deref().unwrap_or_default()),
    }
}

/// What came of it.
#[derive(Debug, Default, Serialize)]
struct ReplayReport {
    /// Batches made of the log, each of a second.
    batches: u64,
    observations: u64,
    acknowledged: u64,
    /// Acknowledged as known already: an earlier try had come through.
    repeated: u64,
    refused: u64,
    /// Why the last one was.
    reason: Option<String>,
    /// Tries that failed and were made again.
    failed_tries: u64,
    /// What was added to the times of the log, s.
    moved_s: f64,
    log_s: f64,
    elapsed_s: f64,
    /// Beyond what the speed asks for: how long the server held it up, s.
    behind_s: f64,
}

impl fmt::Display for ReplayReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { batches, observations, acknowledged, repeated, refused, failed_tries, .. } = self;
        let Self { moved_s, log_s, elapsed_s, behind_s, .. } = self;
        writeln!(
            f,
            "log           {log_s:.1} s, {observations} observations, times moved by {moved_s:.3} s"
        )?;
        writeln!(f, "sent          {batches} batches in {elapsed_s:.1} s, {behind_s:.1} s behind")?;
        writeln!(f, "acknowledged  {acknowledged}, of them known already {repeated}; refused {refused}")?;
        writeln!(f, "failed tries  {failed_tries}")
    }
}

/// First and last time of a log.
struct Span {
    first: Time,
    last: Time,
}

/// The log as it was recorded: what the profile of the server says of mounting and signs is not said twice.
fn open(args: &ReplayArgs) -> Result<LogStream> {
    LogStream::open_with(&args.logs, Some(&Sidecar::default()))
}

fn span(args: &ReplayArgs) -> Result<Span> {
    let mut log = open(args)?;
    let progress = Progress::new("reading", Unit::Bytes, log.bytes_total());
    let mut span: Option<Span> = None;
    let mut count = 0_u32;
    while let Some(observation) = log.next()? {
        let time = observation.time();
        span = Some(span.map_or(Span { first: time, last: time }, |span| Span {
            first: span.first.min(time),
            last: span.last.max(time),
        }));
        count = count.wrapping_add(1);
        if count.is_multiple_of(4096) {
            progress.at(log.bytes_read());
            interrupt::check()?;
        }
    }
    progress::warn(&log.warnings());
    span.with_context(|| format!("{}: no observations", log.name()))
}

async fn replay(args: &ReplayArgs) -> Result<ReplayReport> {
    let tag = DeviceId::new(&args.tag).with_context(|| format!("--tag: \"{}\"", args.tag))?;
    let Span { first, last } = span(args)?;
    let since = SystemTime::now().duration_since(UNIX_EPOCH).context("the clock is before 1970")?;
    let now = Time::from_nanos(i64::try_from(since.as_nanos())?);
    let length = last - first;
    let shift = if args.keep_times {
        Interval::ZERO
    } else if args.speed > 1.0 {
        now + Interval::from_seconds(length.seconds() / args.speed).unwrap_or(length) - last
    } else {
        now - first
    };
    // Numbers that no earlier replay had.
    let boot = u64::try_from(since.as_micros())?;
    let sender = Sender::new(args)?;
    let mut report = ReplayReport { moved_s: shift.seconds(), log_s: length.seconds(), ..Default::default() };
    let mut log = open(args)?;
    let progress =
        Progress::new("sending", Unit::Seconds, u64::try_from(length.nanos() / SECOND_NS + 1).ok());
    let begin = Instant::now();
    let mut next = log.next()?;
    while let Some(observation) = next.take() {
        let second = second_of(&observation, first);
        let mut observations = vec![observation.clone().at(observation.time() + shift)];
        loop {
            next = log.next()?;
            match &next {
                Some(following) if second_of(following, first) <= second => {
                    observations.push(following.clone().at(following.time() + shift));
                }
                _ => break,
            }
        }
        let due = (second + 1) as f64 / args.speed;
        wait_until(begin + Duration::from_secs_f64(due.max(0.0))).await?;
        report.batches += 1;
        report.observations += observations.len() as u64;
        let packet = Packet {
            tag: tag.clone(),
            number: boot + report.batches,
            battery: None,
            distress: false,
            observations,
        };
        let batch = Batch::new(boot, report.batches).with_packet(&packet, &Resolution::default());
        sender.send(batch.to_bytes(), &mut report).await?;
        progress.at(u64::try_from(second + 1).unwrap_or_default());
    }
    report.elapsed_s = begin.elapsed().as_secs_f64();
    report.behind_s = (report.elapsed_s - (length.seconds() / args.speed).ceil()).max(0.0);
    Ok(report)
}

/// In which second of the log an observation falls; what came by radio late stays with its neighbours.
fn second_of(observation: &Observation, first: Time) -> i64 {
    (observation.time() - first).nanos().div_euclid(SECOND_NS)
}

async fn wait_until(due: Instant) -> Result<()> {
    loop {
        interrupt::check()?;
        let left = due.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Ok(());
        }
        tokio::time::sleep(left.min(PULSE)).await;
    }
}

/// The way to the server.
struct Sender {
    client: reqwest::Client,
    url: String,
    token: String,
}

/// What the server says of a batch that it has stored.
#[derive(Deserialize)]
struct Stored {
    repeated: bool,
}

impl Sender {
    fn new(args: &ReplayArgs) -> Result<Self> {
        let mut url = reqwest::Url::parse(&args.to).with_context(|| format!("--to: \"{}\"", args.to))?;
        match url.path_segments_mut() {
            Ok(mut path) => {
                path.pop_if_empty().extend(["api", "v1", "gateways", &args.gateway, "observations"]);
            }
            Err(()) => bail!("--to: \"{}\": expected http://HOST:PORT", args.to),
        }
        let client = reqwest::Client::builder().timeout(PATIENCE).build()?;
        Ok(Self { client, url: url.to_string(), token: args.token.clone() })
    }

    /// Sends a batch until it is acknowledged or refused.
    async fn send(&self, batch: Vec<u8>, report: &mut ReplayReport) -> Result<()> {
        let mut wait = RETRY.0;
        loop {
            let request = self.client.post(&self.url).bearer_auth(&self.token);
            let request = request.header("content-type", "application/x-protobuf").body(batch.clone());
            let failed = match request.send().await {
                Ok(answer) => {
                    let status = answer.status();
                    let text = answer.text().await.unwrap_or_default();
                    match status {
                        status if status.is_success() => {
                            let stored: Stored =
                                serde_json::from_str(&text).with_context(|| self.url.clone())?;
                            report.acknowledged += 1;
                            report.repeated += u64::from(stored.repeated);
                            return Ok(());
                        }
                        // The next batch would fare no better.
                        StatusCode::UNAUTHORIZED | StatusCode::FORBIDDEN | StatusCode::NOT_FOUND => {
                            bail!("{}: {status}: {text}", self.url);
                        }
                        status if status.is_client_error() && status != StatusCode::TOO_MANY_REQUESTS => {
                            report.refused += 1;
                            report.reason = Some(format!("{status}: {text}"));
                            return Ok(());
                        }
                        status => format!("{status}: {text}"),
                    }
                }
                Err(error) => error.to_string(),
            };
            tracing::info!("{}: {failed}; again in {wait:?}", self.url);
            report.failed_tries += 1;
            wait_until(Instant::now() + wait).await?;
            wait = (2 * wait).min(RETRY.1);
        }
    }
}
