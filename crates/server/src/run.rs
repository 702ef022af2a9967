//! The parts that work, without the API: journal, pipeline, store, broker.

use crate::api::Health;
use crate::clock::{Clock, Pace};
use crate::error::ServerError;
use crate::ingest::Door;
use crate::ingest::mqtt::{self, MqttSettings};
use crate::journal::Committer;
use crate::lock::FolderLock;
use crate::pipeline::{Asked, Pipeline, PipelineSettings, Profiles, RoundOutcome, Started};
use crate::store::{Retention, Store};
use crate::writer;
use adit_mine::Mine;
use adit_tracking::{Rules, Tracking};
use std::path::PathBuf;
use std::sync::atomic::AtomicU64;
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, RwLock};
use std::thread::JoinHandle;
use std::time::Duration;
use tokio::sync::{mpsc, watch};
use tokio::time::{Interval, MissedTickBehavior};

/// What a server needs to know.
pub struct Settings {
    /// Name of the site, as in topics.
    pub site: String,
    /// The mine.
    pub mine: Arc<Mine>,
    /// How tags are followed.
    pub profiles: Arc<Profiles>,
    /// Rules of the tracking at the first start.
    pub rules: Rules,
    /// Folder of everything that is kept.
    pub data: PathBuf,
    /// Threads for estimators.
    pub shards: usize,
    /// A snapshot is made this often.
    pub snapshot_every: Duration,
    /// How long history is kept.
    pub retention: Retention,
    /// The broker of the gateways, where there is one.
    pub mqtt: Option<MqttSettings>,
    /// The time of the mine.
    pub clock: Clock,
}

/// The parts that work, for whoever serves the API.
pub struct Parts {
    /// The way in.
    pub door: Door,
    /// The live state.
    pub tracking: Arc<RwLock<Tracking>>,
    /// History.
    pub store: Store,
    asked: Sender<Asked>,
    /// How the parts are.
    pub health: Arc<Health>,
    stop: watch::Sender<bool>,
    tasks: Vec<tokio::task::JoinHandle<()>>,
    threads: Vec<JoinHandle<()>>,
    lock: FolderLock,
}

/// Starts everything but the API: reads what is kept, takes the journal from there on, then listens. `told` hears of each round.
pub async fn start(
    settings: Settings,
    mut told: impl FnMut(&RoundOutcome, &RwLock<Tracking>) + Send + 'static,
) -> Result<Parts, ServerError> {
    let Settings { mine, profiles, rules, data, shards, snapshot_every, retention, mqtt, clock, .. } =
        settings;
    std::fs::create_dir_all(&data).map_err(|source| ServerError::io(&data, source))?;
    let lock = FolderLock::take(&data)?;
    let store = Store::open(&data.join("adit.sqlite")).await?;
    let stored = Arc::new(AtomicU64::new(store.applied().await?));
    let (writing, outcomes) = mpsc::unbounded_channel();
    let mut tasks = Vec::new();
    let health = Arc::new(Health::default());
    let written = Arc::clone(&stored);
    let of_store = clock.clone();
    tasks.push(tokio::spawn(writer::write(
        store.clone(),
        Arc::clone(&mine),
        retention,
        move || of_store.now(),
        written,
        Arc::clone(&health),
        outcomes,
    )));

    let folder = data.clone();
    let opened = tokio::task::spawn_blocking(move || {
        let settings = PipelineSettings { mine, profiles, rules, shards, folder, snapshot_every, stored };
        let Started { mut pipeline, journal, from, mut gateways } = Pipeline::open(settings)?;
        let end = journal.next();
        if from < end {
            tracing::info!("taking entries {from} to {} of the journal again", end - 1);
        }
        let tracking = pipeline.tracking();
        let mut outlet = move |outcome: RoundOutcome| {
            told(&outcome, &tracking);
            // The writer ends after everybody who tells it.
            let _ = writing.send(outcome);
        };
        pipeline.replay((&journal, from), &mut gateways, &mut outlet, |position| {
            tracing::info!("entry {position} of {}", end - 1);
        })?;
        Ok::<_, ServerError>((pipeline, journal, gateways.1, outlet))
    });
    let (pipeline, journal, gateways, outlet) = opened.await.map_err(|_| ServerError::Stopped)??;
    let tracking = pipeline.tracking();

    let of_journal = clock.clone();
    let (committer, groups, journal_thread) =
        Committer::start(journal, gateways, move || of_journal.now(), Arc::clone(&health))?;
    let (asked, questions) = channel();
    let trimmer = committer.clone();
    let pipeline_thread = std::thread::Builder::new()
        .name("pipeline".to_owned())
        .spawn(move || pipeline.run(&groups, &questions, &trimmer, outlet))
        .map_err(|source| ServerError::Thread { name: "pipeline", source })?;

    let door = Door::new(committer, asked.clone());
    let (stop, stopped) = watch::channel(false);
    tasks.push(tokio::spawn(tick(door.clone(), clock, stopped.clone())));
    if let Some(mqtt) = mqtt {
        let (door, health) = (door.clone(), Arc::clone(&health));
        tasks.push(tokio::spawn(async move { mqtt::listen(&mqtt, door, health, stopped).await }));
    }
    let threads = vec![pipeline_thread, journal_thread];
    Ok(Parts { door, tracking, store, asked, health, stop, tasks, threads, lock })
}

impl Parts {
    /// Ends everything: what has come is taken, stored and kept.
    pub async fn stop(self) {
        let Self { door, store, asked, stop, tasks, threads, lock, .. } = self;
        // Nobody listens when everybody has ended already.
        let _ = stop.send(true);
        let _ = asked.send(Asked::Stop);
        drop((door, asked));
        // Threads first: they tell the writer.
        let joined =
            tokio::task::spawn_blocking(move || threads.into_iter().all(|thread| thread.join().is_ok()))
                .await;
        if !joined.unwrap_or(false) {
            tracing::error!("a thread has ended by a panic");
        }
        for task in tasks {
            if task.await.is_err() {
                tracing::error!("a task has ended by a panic");
            }
        }
        store.close().await;
        drop(lock);
    }
}

/// A tick each second of the mine, until told to stop.
async fn tick(door: Door, clock: Clock, mut stop: watch::Receiver<bool>) {
    let mut changes = clock.changes();
    let mut seconds = beats(clock.pace());
    loop {
        tokio::select! {
            _ = seconds.tick() => {}
            Ok(()) = changes.changed() => {
                seconds = beats(clock.pace());
                continue;
            }
            _ = stop.wait_for(|stop| *stop) => return,
        }
        if let Err(error) = door.tick().await {
            tracing::debug!("{error}");
        }
    }
}

fn beats(pace: Pace) -> Interval {
    let mut seconds = tokio::time::interval(Duration::from_secs_f64(1.0 / pace.speed));
    seconds.set_missed_tick_behavior(MissedTickBehavior::Skip);
    seconds
}
