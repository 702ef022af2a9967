//! A server to ask: journal, pipeline, store and routes as `adit serve` has them, on a free port and in a folder of its own.

use adit_core::frames::Position;
use adit_estimation::methods::fused::FusedParams;
use adit_observation::sidecar::Sidecar;
use adit_server::api::{ApiSettings, Context, FenceWatch, Health, Metrics, Part, Proximities, serve};
use adit_server::auth::{Auth, AuthSettings, Grant, Role, WallClock};
use adit_server::feed::{Feed, FeedSettings};
use adit_server::ingest::PositionReport;
use adit_server::now;
use adit_server::pipeline::{Profile, Profiles};
use adit_server::store::Retention;
use adit_server::{Clock, Parts, PlanDesk, Settings};
use adit_tracking::Rules;
use futures_util::StreamExt as _;
use std::collections::BTreeMap;
use std::net::{SocketAddr, TcpListener};
use std::num::NonZeroU32;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::TcpStream;
use tokio::sync::oneshot;
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::tungstenite::client::IntoClientRequest as _;
use tokio_tungstenite::{MaybeTlsStream, WebSocketStream, connect_async};

pub type Socket = WebSocketStream<MaybeTlsStream<TcpStream>>;

pub type Tested<T = ()> = Result<T, Box<dyn std::error::Error + Send + Sync>>;

pub const PASSWORD: &str = "correct horse battery staple";

pub struct House {
    pub address: SocketAddr,
    pub context: Arc<Context>,
    tokens: BTreeMap<&'static str, String>,
    _parts: Parts,
    _stop: oneshot::Sender<()>,
    folder: tempfile::TempDir,
}

impl House {
    pub async fn new() -> Tested<Self> {
        Self::with(ApiSettings::default(), FeedSettings::default()).await
    }

    pub async fn with(settings: ApiSettings, feed: FeedSettings) -> Tested<Self> {
        let folder = tempfile::tempdir()?;
        let mine = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../mines/two-level.toml");
        let mine = Arc::new(adit_mine::file::open(&mine)?.0);
        let fused = FusedParams::default();
        let profile = Profile::new("all", vec!["*".into()], Sidecar::default(), fused.into());
        let server = Settings {
            site: "test".into(),
            mine: Arc::clone(&mine),
            profiles: Arc::new(Profiles::new(vec![profile])?),
            rules: Rules::default(),
            data: folder.path().to_path_buf(),
            shards: 1,
            snapshot_every: Duration::from_mins(10),
            retention: Retention::default(),
            mqtt: None,
            clock: Clock::default(),
        };
        let clock = server.clock.clone();
        let feed = Feed::new(feed);
        let told = Arc::clone(&feed);
        let parts = adit_server::start(server, move |outcome, _| {
            told.tell(outcome.fixes.iter().map(|tracked| &tracked.fix), &outcome.events);
        });
        let parts = parts.await?;
        feed.start(Arc::clone(&parts.tracking));
        let store = parts.store.clone();
        let wall: WallClock = Arc::new(now);
        let often = NonZeroU32::new(10_000).ok_or("no")?;
        let auth_settings = AuthSettings {
            logins_per_address_per_minute: often,
            logins_per_name_per_minute: often,
            ..AuthSettings::default()
        };
        let auth = Auth::open(store.clone(), auth_settings, wall).await?;
        auth.add_user("boss", Role::Admin, PASSWORD.into()).await?;
        let mut tokens = BTreeMap::new();
        for grant in [Grant::Viewer, Grant::Dispatcher, Grant::SafetyOfficer, Grant::Admin, Grant::Ingest] {
            let token = auth.add_token("boss", grant.name(), grant, None).await?;
            tokens.insert(grant.name(), token.secret.expose().to_owned());
        }
        let health = Arc::new(Health::default());
        health.tell(Part::Store, Ok(()));
        let context = Arc::new(Context {
            mine,
            tracking: Arc::clone(&parts.tracking),
            door: parts.door.clone(),
            feed,
            store,
            auth,
            health,
            metrics: Metrics::of_process(),
            settings,
            shown_settings: serde_json::json!({ "site": "test" }),
            clock,
            plan: PlanDesk::open(folder.path())?,
            fences: FenceWatch::default(),
            proximities: Proximities::default(),
        });
        let listener = TcpListener::bind("127.0.0.1:0")?;
        let address = listener.local_addr()?;
        let (stop, stopped) = oneshot::channel::<()>();
        let serving = serve(Arc::clone(&context), listener, None, async move {
            let _ = stopped.await;
        });
        tokio::spawn(serving);
        Ok(Self { address, context, tokens, _parts: parts, _stop: stop, folder })
    }

    /// Where it keeps everything.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    pub fn url(&self, path: &str) -> String {
        format!("http://{}{path}", self.address)
    }

    /// The token of a role, or that of gateways.
    pub fn token(&self, grant: &str) -> &str {
        self.tokens.get(grant).map_or("", String::as_str)
    }

    /// A tag is somewhere, as a system from outside says; told when it is on the disk.
    pub async fn walk(&self, tag: &str, position_m: [f64; 3]) -> Tested {
        let [x, y, z] = position_m;
        let position_m = Position::new(x, y, z);
        let report = PositionReport { tag: tag.into(), time: None, position_m, radius_95_m: Some(2.0) };
        self.context.door.position(report).await?;
        Ok(())
    }

    /// Asks until the answer fits: what is written behind the live state comes a moment later.
    pub async fn until(
        &self,
        path: &str,
        grant: &str,
        fits: impl Fn(&serde_json::Value) -> bool,
    ) -> Tested<Answer> {
        for _ in 0..200 {
            let answer = self.ask("GET", path, self.token(grant), None).await?;
            if fits(&answer.json) {
                return Ok(answer);
            }
            tokio::time::sleep(Duration::from_millis(50)).await;
        }
        Err(format!("{path}: not within 10 s").into())
    }

    pub async fn ask(
        &self,
        method: &str,
        path: &str,
        token: &str,
        body: Option<serde_json::Value>,
    ) -> Tested<Answer> {
        let client = reqwest::Client::new();
        let mut request = client.request(method.parse()?, self.url(path));
        if !token.is_empty() {
            request = request.bearer_auth(token);
        }
        if let Some(body) = body {
            request = request.json(&body);
        }
        let response = request.send().await?;
        let status = response.status().as_u16();
        let headers = response.headers().clone();
        let text = response.text().await?;
        Ok(Answer { status, headers, json: serde_json::from_str(&text).unwrap_or_default(), text })
    }
}

#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    pub headers: reqwest::header::HeaderMap,
    pub json: serde_json::Value,
    pub text: String,
}

pub async fn watch(house: &House, path: &str, token: &str) -> Tested<Socket> {
    let mut request = format!("ws://{}{path}", house.address).into_client_request()?;
    request.headers_mut().insert("authorization", format!("Bearer {token}").parse()?);
    Ok(connect_async(request).await?.0)
}

pub async fn next(socket: &mut Socket) -> Tested<serde_json::Value> {
    loop {
        let message = tokio::time::timeout(std::time::Duration::from_secs(20), socket.next()).await?;
        match message.ok_or("the socket ended")?? {
            Message::Text(text) => return Ok(serde_json::from_str(&text)?),
            Message::Close(frame) => return Err(format!("closed: {frame:?}").into()),
            _ => {}
        }
    }
}
