//! `adit load`: gateways and a viewer for a server, and the account of what came of what was sent.

mod gateway;
mod report;
mod viewer;
mod walks;

use crate::args::LoadArgs;
use crate::output;
use crate::progress::{self, Progress, Unit};
use anyhow::{Context, Result, bail};
use futures_util::StreamExt;
use gateway::{Gateway, Sender};
use report::{Account, LoadReport};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// How long the viewer waits for the last positions, and the generator for the last acknowledgements.
const PATIENCE: Duration = Duration::from_mins(1);

/// Tags entered at once.
const AT_ONCE: usize = 64;

/// Loads a server and tells what came of it.
pub fn run(args: &LoadArgs) -> Result<()> {
    let (mine, notices) = adit_mine::file::open(&args.mine)?;
    for notice in notices {
        progress::warn(&[notice]);
    }
    progress::note("simulating walks …");
    // A few seconds more than are sent: gateways do not begin together.
    let walks = walks::walks(&Arc::new(mine), args.walkers, args.seconds + 2, args.ranging_hz, args.seed)?;
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build().context("no runtime")?;
    let report = runtime.block_on(load(args, walks))?;
    if let Some(target) = &args.json {
        target.write(&(serde_json::to_string_pretty(&report)? + "\n"))?;
    }
    output::print(&report.summary())?;
    if report.lost_packets > 0 {
        bail!("{} acknowledged packets did not come", report.lost_packets);
    }
    Ok(())
}

async fn load(args: &LoadArgs, walks: Vec<Vec<walks::Template>>) -> Result<LoadReport> {
    let sender = Sender::new(args)?;
    register(args).await?;
    let account = Arc::new(Account::default());
    let viewer = viewer::Viewer::start(&args.url, &args.token, Arc::clone(&account)).await?;
    let walks = Arc::new(walks);
    let begin = SystemTime::now().duration_since(UNIX_EPOCH).context("the clock is before 1970")?;
    // The next whole second but one: everybody is ready by then.
    let begin_s = i64::try_from(begin.as_secs())? + 2;
    let clock = Clock::new(begin_s)?;
    let gateways = args.tags.div_ceil(args.per_gateway);
    let mut tasks = Vec::new();
    for index in 0..gateways {
        let first = index * args.per_gateway;
        let gateway = Gateway {
            name: format!("load-{index:05}"),
            boot: rand_boot(index),
            tags: first..args.tags.min(first + args.per_gateway),
            phase: f64::from(index) / f64::from(gateways),
            seconds: args.seconds,
        };
        let (sender, account, walks) = (sender.clone(), Arc::clone(&account), Arc::clone(&walks));
        tasks.push(tokio::spawn(gateway.run(sender, account, walks, clock)));
    }
    let progress = Progress::new("sending", Unit::Seconds, Some(args.seconds.into()));
    let ends = Instant::now() + Duration::from_secs(u64::from(args.seconds) + 3) + PATIENCE;
    for task in tasks {
        while !task.is_finished() && Instant::now() < ends {
            progress.at(clock.seconds_since().min(args.seconds.into()));
            tokio::time::sleep(Duration::from_millis(100)).await;
        }
        task.abort();
    }
    viewer.stop(Duration::from_secs(2)).await;
    let came = came(args).await?;
    Ok(LoadReport::new(args, &account, &came))
}

/// Enters the tags, as an administrator would; those that are there already stay.
async fn register(args: &LoadArgs) -> Result<()> {
    let client = reqwest::Client::new();
    let url = format!("{}/api/v1/tags", args.url);
    let progress = Progress::new("tags", Unit::Samples, Some(args.tags.into()));
    let enter = |tag: u32| {
        let body = serde_json::json!({ "id": format!("T{tag:06}"), "worn": "waist" });
        let request = client.post(&url).bearer_auth(&args.token).json(&body);
        let (url, progress) = (&url, &progress);
        async move {
            let answer = request.send().await.with_context(|| url.clone())?;
            progress.more(1);
            let status = answer.status();
            if status.is_success() || status == reqwest::StatusCode::CONFLICT {
                return Ok(());
            }
            bail!("{url}: {status}: {}", answer.text().await.unwrap_or_default())
        }
    };
    let mut entered = futures_util::stream::iter(0..args.tags).map(enter).buffer_unordered(AT_ONCE);
    while let Some(result) = entered.next().await {
        result?;
    }
    Ok(())
}

/// First and last of each span of packet numbers that came, by tag.
async fn came(args: &LoadArgs) -> Result<BTreeMap<String, Vec<[u64; 2]>>> {
    #[derive(serde::Deserialize)]
    struct Packets {
        tag: String,
        numbers: Vec<[u64; 2]>,
    }
    let url = format!("{}/api/v1/packets", args.url);
    let ends = Instant::now() + PATIENCE;
    loop {
        let asked = reqwest::Client::new().get(&url).bearer_auth(&args.token).send().await;
        match asked.and_then(reqwest::Response::error_for_status) {
            Ok(answer) => {
                let packets: Vec<Packets> = answer.json().await.with_context(|| url.clone())?;
                return Ok(packets.into_iter().map(|packets| (packets.tag, packets.numbers)).collect());
            }
            Err(error) if Instant::now() > ends => return Err(error).with_context(|| url.clone()),
            Err(_) => tokio::time::sleep(Duration::from_millis(500)).await,
        }
    }
}

/// A start of a gateway that no earlier run had.
fn rand_boot(index: u32) -> u64 {
    let nanos = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().subsec_nanos();
    (u64::from(std::process::id()) << 40) ^ (u64::from(nanos) << 8) ^ u64::from(index)
}

/// When the load begins.
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    /// As seconds since the Unix epoch.
    pub begin_s: i64,
    instant: Instant,
}

impl Clock {
    fn new(begin_s: i64) -> Result<Self> {
        let now = SystemTime::now().duration_since(UNIX_EPOCH)?;
        let until = Duration::from_secs(begin_s.unsigned_abs()).saturating_sub(now);
        Ok(Self { begin_s, instant: Instant::now() + until })
    }

    /// The moment so many seconds after the beginning.
    pub fn at(&self, seconds: f64) -> Instant {
        self.instant + Duration::from_secs_f64(seconds.max(0.0))
    }

    /// Whole seconds since the beginning.
    pub fn seconds_since(&self) -> u64 {
        Instant::now().saturating_duration_since(self.instant).as_secs()
    }
}
