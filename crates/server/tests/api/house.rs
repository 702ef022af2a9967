//! A server to ask: the real routes on a free port, a store of its own, and behind the door what a pipeline does, without a journal.

use adit_core::frames::Position;
use adit_core::solution::Quality;
use adit_core::time::Time;
use adit_server::api::{
    ApiSettings, CommandError, Context, Door, DoorError, EventJson, Health, Knock, Metrics, Part, Receipt,
    serve,
};
use adit_server::auth::{Auth, AuthSettings, Grant, Role, WallClock};
use adit_server::feed::{Feed, FeedSettings};
use adit_server::store::{EventRecord, Record, Store};
use adit_tracking::{Event, Fix, Input, Rules, Tracking};
use std::collections::BTreeMap;
use std::net::{SocketAddr, TcpListener};
use std::num::NonZeroU32;
use std::path::Path;
use std::sync::{Arc, PoisonError, RwLock};
use std::time::{SystemTime, UNIX_EPOCH};
use tokio::sync::{mpsc, oneshot};

pub type Tested<T = ()> = Result<T, Box<dyn std::error::Error + Send + Sync>>;

pub const PASSWORD: &str = "correct horse battery staple";

pub struct House {
    pub address: SocketAddr,
    pub context: Arc<Context>,
    tokens: BTreeMap<&'static str, String>,
    knocks: Door,
    _stop: oneshot::Sender<()>,
    folder: tempfile::TempDir,
}

pub fn now() -> Time {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    Time::from_nanos(i64::try_from(since.as_nanos()).unwrap_or(i64::MAX))
}

impl House {
    pub async fn new() -> Tested<Self> {
        Self::with(ApiSettings::default(), FeedSettings::default()).await
    }

    pub async fn with(settings: ApiSettings, feed: FeedSettings) -> Tested<Self> {
        let folder = tempfile::tempdir()?;
        let store = Store::open(&folder.path().join("adit.db")).await?;
        let clock: WallClock = Arc::new(now);
        let often = NonZeroU32::new(10_000).ok_or("no")?;
        let auth_settings = AuthSettings {
            logins_per_address_per_minute: often,
            logins_per_name_per_minute: often,
            ..AuthSettings::default()
        };
        let auth = Auth::open(store.clone(), auth_settings, Arc::clone(&clock)).await?;
        auth.add_user("boss", Role::Admin, PASSWORD.into()).await?;
        let mut tokens = BTreeMap::new();
        for grant in [Grant::Viewer, Grant::Dispatcher, Grant::SafetyOfficer, Grant::Admin, Grant::Ingest] {
            let token = auth.add_token("boss", grant.name(), grant, None).await?;
            tokens.insert(grant.name(), token.secret.expose().to_owned());
        }
        let mine = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../mines/two-level.toml");
        let mine = Arc::new(adit_mine::file::open(&mine)?.0);
        let tracking = Arc::new(RwLock::new(Tracking::new(Arc::clone(&mine), Rules::default())?));
        let feed = Feed::new(feed, Arc::clone(&tracking));
        let (door, knocks) = Door::new(1000);
        let health = Arc::new(Health::default());
        health.tell(Part::Store, Ok(()));
        let context = Arc::new(Context {
            mine,
            tracking: Arc::clone(&tracking),
            door: door.clone(),
            feed: Arc::clone(&feed),
            store: store.clone(),
            auth,
            health,
            metrics: Metrics::of_process(),
            settings,
            shown_settings: serde_json::json!({ "site": "test" }),
            clock,
        });
        tokio::spawn(answer(knocks, Arc::clone(&tracking), feed, store));
        let listener = TcpListener::bind("127.0.0.1:0")?;
        let address = listener.local_addr()?;
        let (stop, stopped) = oneshot::channel::<()>();
        let serving = serve(Arc::clone(&context), listener, None, async move {
            let _ = stopped.await;
        });
        tokio::spawn(serving);
        Ok(Self { address, context, tokens, knocks: door, _stop: stop, folder })
    }

    pub fn url(&self, path: &str) -> String {
        format!("http://{}{path}", self.address)
    }

    /// The token of a role, or that of gateways.
    pub fn token(&self, grant: &str) -> &str {
        self.tokens.get(grant).map_or("", String::as_str)
    }

    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// A tag is somewhere, as a pipeline would find.
    pub fn walk(&self, tag: &str, position_m: [f64; 3]) {
        let [x, y, z] = position_m;
        let fix = Fix {
            tag: tag.into(),
            time: now(),
            position_m: Position::new(x, y, z),
            velocity_m_s: None,
            radius_95_m: 2.0,
            protection_level_m: 6.0,
            quality: Quality::Fixed,
            moving: Some(true),
            method: "fused".into(),
        };
        let mut events = Vec::new();
        let heard = hear(&self.context.tracking, &Input::Fix(fix.clone()), &mut events);
        if heard.is_ok() {
            self.context.feed.tell(&[fix], &events);
        }
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

    pub fn door(&self) -> &Door {
        &self.knocks
    }
}

#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    pub headers: reqwest::header::HeaderMap,
    pub json: serde_json::Value,
    pub text: String,
}

fn hear(
    tracking: &RwLock<Tracking>,
    input: &Input,
    events: &mut Vec<Event>,
) -> Result<adit_tracking::Outcome, adit_tracking::Refused> {
    tracking.write().unwrap_or_else(PoisonError::into_inner).hear(now(), input, events)
}

async fn answer(
    mut knocks: mpsc::Receiver<Knock>,
    tracking: Arc<RwLock<Tracking>>,
    feed: Arc<Feed>,
    store: Store,
) {
    let mut position = 0;
    while let Some(knock) = knocks.recv().await {
        position += 1;
        let mut events = Vec::new();
        let mut fixes = Vec::new();
        match knock {
            Knock::Batch { bytes, answer, .. } => {
                let empty = bytes.is_empty() || bytes.starts_with(b"\xff");
                let malformed = DoorError::Malformed("not a batch".into());
                let _ = answer.send(if empty {
                    Err(malformed)
                } else {
                    Ok(Receipt { position, repeated: false })
                });
            }
            Knock::Position { report, answer } => {
                let radius_95_m = report.radius_95_m.unwrap_or(5.0);
                let fix = Fix {
                    tag: report.tag,
                    time: report.time.unwrap_or_else(now),
                    position_m: report.position_m,
                    velocity_m_s: None,
                    radius_95_m,
                    protection_level_m: 3.0 * radius_95_m,
                    quality: Quality::Fixed,
                    moving: None,
                    method: "outside".into(),
                };
                if hear(&tracking, &Input::Fix(fix.clone()), &mut events).is_ok() {
                    fixes.push(fix);
                }
                let _ = answer.send(Ok(Receipt { position, repeated: false }));
            }
            Knock::Command { actor, command, answer } => {
                let input = Input::Command { by: actor, command: *command };
                let _ = answer.send(hear(&tracking, &input, &mut events).map_err(CommandError::from));
            }
        }
        let records = events.iter().map(|event| {
            let json = EventJson::from(event);
            let time = json.time.map_or_else(now, |time| time.0);
            let subjects = [&json.person, &json.tag, &json.zone].into_iter().flatten().cloned().collect();
            let body = serde_json::to_value(&json).unwrap_or_default();
            Record::Event(EventRecord { time, kind: json.event.into(), subjects, body })
        });
        let records: Vec<Record> = records.collect();
        feed.tell(&fixes, &events);
        if store.commit(position, records).await.is_err() {
            return;
        }
    }
}
