//! All parts together: one process for one mine.

use crate::api::{self, ApiSettings, Context, Health, Metrics, TlsFiles};
use crate::auth::{Auth, AuthSettings, WallClock};
use crate::clock;
use crate::error::ServerError;
use crate::feed::{Feed, FeedSettings};
use crate::ingest::mqtt::{self, MqttSettings};
use crate::ingest::{Door, knocks};
use crate::journal::Committer;
use crate::pipeline::{Asked, Pipeline, PipelineSettings, Profiles, RoundOutcome, Started};
use crate::store::{Retention, Store};
use crate::writer;
use adit_mine::Mine;
use adit_tracking::Rules;
use std::net::{SocketAddr, TcpListener};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;
use std::sync::mpsc::{Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;
use tokio::sync::{mpsc, watch};
use tokio::time::MissedTickBehavior;

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
    /// Address of the API.
    pub listen: SocketAddr,
    /// Certificate and key of the API, where it speaks TLS itself.
    pub tls: Option<TlsFiles>,
    /// How the API behaves.
    pub api: ApiSettings,
    /// Sessions and log-ins.
    pub auth: AuthSettings,
    /// The live feed.
    pub feed: FeedSettings,
    /// The settings as they are shown to users; without secrets.
    pub shown: serde_json::Value,
}

/// So many requests of the API may wait for the journal.
const KNOCKS: usize = 4096;

/// A server at work.
pub struct Server {
    /// Where the API listens: the port that was given, or the one that was free.
    pub address: SocketAddr,
    /// Password of the user `admin`, at the first start only.
    pub first_password: Option<String>,
    stop: watch::Sender<bool>,
    served: tokio::task::JoinHandle<Result<(), ServerError>>,
    asked: Sender<Asked>,
    door: Door,
    store: Store,
    tasks: Vec<tokio::task::JoinHandle<()>>,
    threads: Vec<JoinHandle<()>>,
}

impl Server {
    /// Starts everything: reads what is kept, takes the journal from there on, then listens.
    pub async fn start(settings: Settings) -> Result<Self, ServerError> {
        let Settings { mine, profiles, rules, data, shards, snapshot_every, retention, mqtt, .. } = settings;
        std::fs::create_dir_all(&data).map_err(|source| ServerError::io(&data, source))?;
        // Before anything is read: a port that is taken is told at once.
        let listener = TcpListener::bind(settings.listen)
            .map_err(|source| ServerError::Bind { address: settings.listen, source })?;
        let address = listener.local_addr().map_err(|source| ServerError::Listen { source })?;
        let tls = settings.tls.as_ref().map(TlsFiles::read).transpose()?;
        let metrics = Metrics::of_process();
        let store = Store::open(&data.join("adit.sqlite")).await?;
        let wall: WallClock = Arc::new(clock::now);
        let auth = Auth::open(store.clone(), settings.auth, Arc::clone(&wall)).await?;
        let first_password = auth.first_admin().await?;

        let stored = Arc::new(AtomicU64::new(store.applied().await?));
        let (writing, outcomes) = mpsc::unbounded_channel();
        let written = Arc::clone(&stored);
        let health = Arc::new(Health::default());
        let writer =
            writer::write(store.clone(), Arc::clone(&mine), retention, clock::now, written, Arc::clone(&health), outcomes);
        let mut tasks = vec![tokio::spawn(writer)];

        let (folder, plan) = (data.clone(), Arc::clone(&mine));
        let feed_settings = settings.feed;
        let opened = tokio::task::spawn_blocking(move || {
            let settings = PipelineSettings { mine: plan, profiles, rules, shards, folder, snapshot_every, stored };
            let Started { mut pipeline, journal, from, mut gateways } = Pipeline::open(settings)?;
            let end = journal.next();
            if from < end {
                tracing::info!("taking entries {from} to {} of the journal again", end - 1);
            }
            let feed = Feed::new(feed_settings, pipeline.tracking());
            let viewers = Arc::clone(&feed);
            let mut outlet = move |outcome: RoundOutcome| {
                viewers.tell(outcome.fixes.iter().map(|tracked| tracked.fix.tag.as_str()), &outcome.events);
                // The writer ends after everybody who tells it.
                let _ = writing.send(outcome);
            };
            pipeline.replay((&journal, from), &mut gateways, &mut outlet, |position| {
                tracing::info!("entry {position} of {}", end - 1);
            })?;
            Ok::<_, ServerError>((pipeline, journal, gateways.1, feed, outlet))
        });
        let (pipeline, journal, gateways, feed, outlet) = opened.await.map_err(|_| ServerError::Stopped)??;
        let tracking = pipeline.tracking();

        let (committer, groups, journal_thread) =
            Committer::start(journal, gateways, clock::now, Arc::clone(&health))?;
        let (asked, questions) = channel();
        let trimmer = committer.clone();
        let pipeline_thread = std::thread::Builder::new()
            .name("pipeline".to_owned())
            .spawn(move || pipeline.run(&groups, &questions, &trimmer, outlet))
            .map_err(|source| ServerError::Thread { name: "pipeline", source })?;

        let door = Door::new(committer);
        let (stop, stopped) = watch::channel(false);
        tasks.push(tokio::spawn(tick(door.clone(), stopped.clone())));
        let (api_door, knocks) = api::Door::new(KNOCKS);
        tasks.push(tokio::spawn(knocks::answer(door.clone(), knocks)));
        if let Some(mqtt) = mqtt {
            let (door, health, stopped) = (door.clone(), Arc::clone(&health), stopped.clone());
            tasks.push(tokio::spawn(async move { mqtt::listen(&mqtt, door, health, stopped).await }));
        }
        let context = Arc::new(Context {
            mine,
            door: api_door,
            tracking,
            feed,
            store: store.clone(),
            auth,
            health,
            metrics,
            settings: settings.api,
            shown_settings: settings.shown,
            clock: wall,
        });
        let mut until = stopped;
        let end = async move {
            // The sender is gone when the server is.
            let _ = until.wait_for(|stop| *stop).await;
        };
        let served = tokio::spawn(api::serve(context, listener, tls, end));
        let threads = vec![pipeline_thread, journal_thread];
        Ok(Self { address, first_password, stop, served, asked, door, store, tasks, threads })
    }

    /// Waits until the API ends by itself, which it does by an error only.
    pub async fn served(&mut self) -> Result<(), ServerError> {
        (&mut self.served).await.unwrap_or(Err(ServerError::Stopped))
    }

    /// Ends everything: answers under way may end, what has come is taken, stored and kept.
    pub async fn stop(self) {
        let Self { stop, served, asked, door, store, tasks, threads, .. } = self;
        // Nobody listens when everybody has ended already.
        let _ = stop.send(true);
        if !served.is_finished() && !matches!(served.await, Ok(Ok(()))) {
            tracing::error!("the API has not ended well");
        }
        let _ = asked.send(Asked::Stop);
        drop((door, asked));
        // Threads first: they tell the writer.
        let joined =
            tokio::task::spawn_blocking(move || threads.into_iter().all(|thread| thread.join().is_ok())).await;
        if !joined.unwrap_or(false) {
            tracing::error!("a thread has ended by a panic");
        }
        for task in tasks {
            if task.await.is_err() {
                tracing::error!("a task has ended by a panic");
            }
        }
        store.close().await;
    }
}

/// A tick each second, until told to stop.
async fn tick(door: Door, mut stop: watch::Receiver<bool>) {
    let mut seconds = tokio::time::interval(Duration::from_secs(1));
    seconds.set_missed_tick_behavior(MissedTickBehavior::Skip);
    loop {
        tokio::select! {
            _ = seconds.tick() => {}
            _ = stop.wait_for(|stop| *stop) => return,
        }
        if let Err(error) = door.tick().await {
            tracing::debug!("{error}");
        }
    }
}
