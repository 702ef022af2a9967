//! All parts together: one process for one mine.

use crate::api::{self, ApiSettings, Context, FenceWatch, Metrics, Proximities, TlsFiles};
use crate::auth::{Auth, AuthSettings, WallClock};
use crate::clock::now;
use crate::error::ServerError;
use crate::feed::{Feed, FeedSettings};
use crate::plan_changes::PlanDesk;
use crate::run::{self, Parts, Settings};
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;
use tokio::sync::oneshot;

/// How the API is served.
pub struct Serving {
    /// Its address; port 0 is any that is free.
    pub listen: SocketAddr,
    /// Certificate and key, where it speaks TLS itself.
    pub tls: Option<TlsFiles>,
    /// How it behaves.
    pub api: ApiSettings,
    /// Sessions and log-ins.
    pub auth: AuthSettings,
    /// The live feed.
    pub feed: FeedSettings,
    /// The settings as they are shown to users; without secrets.
    pub shown: serde_json::Value,
}

/// A server at work.
pub struct Server {
    /// Where the API listens: the port that was given, or the one that was free.
    pub address: SocketAddr,
    /// Password of the user `admin`, at the first start only.
    pub first_password: Option<String>,
    parts: Parts,
    stop: oneshot::Sender<()>,
    served: tokio::task::JoinHandle<Result<(), ServerError>>,
}

impl Server {
    /// Starts everything: reads what is kept, takes the journal from there on, then listens.
    pub async fn start(settings: Settings, serving: Serving) -> Result<Self, ServerError> {
        let Serving { listen, tls, api, auth, feed, shown } = serving;
        // Before anything is read: a port that is taken is told at once.
        let listener =
            TcpListener::bind(listen).map_err(|source| ServerError::Bind { address: listen, source })?;
        let address = listener.local_addr().map_err(|source| ServerError::Listen { source })?;
        let tls = tls.as_ref().map(TlsFiles::read).transpose()?;
        let api = ApiSettings { secure_cookies: api.secure_cookies || tls.is_some(), ..api };
        let metrics = Metrics::of_process();
        let mine = Arc::clone(&settings.mine);
        let data = settings.data.clone();
        let feed = Feed::new(feed);
        let clock = settings.clock.clone();
        let viewers = Arc::clone(&feed);
        let parts = run::start(settings, move |outcome, _| {
            viewers.tell(outcome.fixes.iter().map(|tracked| &tracked.fix), &outcome.events);
        })
        .await?;
        feed.start(Arc::clone(&parts.tracking));
        let wall: WallClock = Arc::new(now);
        let auth = Auth::open(parts.store.clone(), auth, wall).await?;
        let first_password = auth.first_admin().await?;
        let context = Arc::new(Context {
            mine,
            tracking: Arc::clone(&parts.tracking),
            door: parts.door.clone(),
            feed,
            store: parts.store.clone(),
            auth,
            health: Arc::clone(&parts.health),
            metrics,
            settings: api,
            shown_settings: shown,
            clock,
            plan: PlanDesk::open(&data)?,
            fences: FenceWatch::default(),
            proximities: Proximities::default(),
        });
        let (stop, stopped) = oneshot::channel::<()>();
        let end = async move {
            // The sender is gone when the server is.
            let _ = stopped.await;
        };
        let served = tokio::spawn(api::serve(context, listener, tls, end));
        Ok(Self { address, first_password, parts, stop, served })
    }

    /// Waits until the API ends by itself, which it does by an error only.
    pub async fn served(&mut self) -> Result<(), ServerError> {
        (&mut self.served).await.unwrap_or(Err(ServerError::Stopped))
    }

    /// Ends everything: answers under way may end, what has come is taken, stored and kept.
    pub async fn stop(self) {
        let Self { parts, stop, served, .. } = self;
        // Nobody listens when everybody has ended already.
        let _ = stop.send(());
        if !served.is_finished() && !matches!(served.await, Ok(Ok(()))) {
            tracing::error!("the API has not ended well");
        }
        parts.stop().await;
    }
}
