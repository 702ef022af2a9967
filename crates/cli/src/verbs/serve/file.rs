//! The settings of a server: a TOML file, and the flags.

use crate::args::ServeArgs;
use crate::config;
use crate::judged_ranges;
use crate::method::{self, MethodName};
use crate::progress;
use crate::radio_site;
use adit_estimation::methods::MethodSettings;
use adit_estimation::radio::RadioSite;
use adit_observation::sidecar::{Location, Sidecar};
use adit_server::api::{ApiSettings, IpNet, TlsFiles};
use adit_server::auth::AuthSettings;
use adit_server::feed::FeedSettings;
use adit_server::ingest::mqtt::MqttSettings;
use adit_server::pipeline::{Profile, Profiles, Settings as EstimatorSettings};
use adit_server::store::Retention;
use adit_server::{Clock, FASTEST, Pace, Serving, Settings};
use adit_tracking::Rules;
use anyhow::{Context, Result, bail};
use serde::{Deserialize, Serialize};
use std::fs;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// The file.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct ServeFile {
    site: SitePart,
    api: ApiPart,
    #[serde(skip_serializing_if = "Option::is_none")]
    mqtt: Option<MqttPart>,
    pipeline: PipelinePart,
    retention: Retention,
    auth: AuthSettings,
    feed: FeedSettings,
    rules: Rules,
    profiles: Vec<ProfilePart>,
    /// Of a simulated shift.
    #[serde(skip_serializing_if = "Option::is_none")]
    clock: Option<Pace>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct SitePart {
    /// In topics, and for people.
    name: String,
    mine: Option<PathBuf>,
    data: PathBuf,
    /// Calibrations of the radio.
    radio: Vec<PathBuf>,
}

impl Default for SitePart {
    fn default() -> Self {
        Self { name: "mine".to_owned(), mine: None, data: PathBuf::from("adit-data"), radio: Vec::new() }
    }
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct ApiPart {
    listen: SocketAddr,
    certificate: Option<PathBuf>,
    key: Option<PathBuf>,
    open_metrics: bool,
    secure_cookies: bool,
    trusted_proxies: Vec<IpNet>,
}

impl Default for ApiPart {
    fn default() -> Self {
        Self {
            listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 8080)),
            certificate: None,
            key: None,
            open_metrics: false,
            secure_cookies: false,
            trusted_proxies: Vec::new(),
        }
    }
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct MqttPart {
    #[serde(default = "local")]
    host: String,
    #[serde(default = "mqtt_port")]
    port: u16,
    #[serde(default)]
    client_id: Option<String>,
    #[serde(default)]
    user: Option<String>,
    #[serde(default)]
    password_file: Option<PathBuf>,
    #[serde(default)]
    certificate_authority: Option<PathBuf>,
}

fn local() -> String {
    "localhost".to_owned()
}

fn mqtt_port() -> u16 {
    1883
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct PipelinePart {
    /// As many as the machine has cores, where it is not given.
    threads: Option<usize>,
    snapshot_s: f64,
}

impl Default for PipelinePart {
    fn default() -> Self {
        Self { threads: None, snapshot_s: 30.0 }
    }
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ProfilePart {
    name: String,
    tags: Vec<String>,
    #[serde(default = "fused")]
    method: String,
    #[serde(default)]
    config: Option<PathBuf>,
    #[serde(default)]
    sidecar: Option<PathBuf>,
    #[serde(default)]
    location: Option<Location>,
    #[serde(default)]
    nlos: Option<String>,
}

fn fused() -> String {
    "fused".to_owned()
}

/// Settings of the flags and of the file; paths in the file are beside it.
pub fn settings(args: &ServeArgs) -> Result<(Settings, Serving)> {
    let (mut file, folder) = match &args.config {
        None => (ServeFile::default(), PathBuf::new()),
        Some(path) => {
            let file: ServeFile = config::parse(path, &config::text(path)?)?;
            (file, path.parent().unwrap_or(Path::new("")).to_path_buf())
        }
    };
    let beside = |path: &Path| folder.join(path);
    if let Some(listen) = args.listen {
        file.api.listen = listen;
    }
    let data = args.data.clone().unwrap_or_else(|| beside(&file.site.data));
    let Some(mine_path) = args.mine.clone().or_else(|| file.site.mine.as_deref().map(beside)) else {
        bail!("no mine: give --mine or [site] mine = \"FILE\"");
    };
    let (mine, notices) = adit_mine::file::open(&mine_path)?;
    for notice in notices {
        progress::warn(&[notice]);
    }
    let radio: Vec<_> = file.site.radio.iter().map(|path| beside(path)).collect();
    let mine = adit_server::with_changes(mine, &data)?;
    let site = radio_site::of(&mine, &mine_path, &radio)?;
    let profiles = profiles(&file.profiles, &folder, &site)?;
    let shown = serde_json::to_value(&file).context("the settings cannot be shown")?;
    let snapshot_s = file.pipeline.snapshot_s;
    if !(1.0..=3600.0).contains(&snapshot_s) {
        bail!("[pipeline] snapshot_s: found {snapshot_s}, expected 1 to 3600");
    }
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let serving = Serving {
        listen: file.api.listen,
        tls: tls(&file.api, &folder)?,
        api: ApiSettings {
            open_metrics: file.api.open_metrics,
            secure_cookies: file.api.secure_cookies,
            trusted_proxies: file.api.trusted_proxies,
        },
        auth: file.auth,
        feed: file.feed,
        shown,
    };
    let settings = Settings {
        mqtt: file.mqtt.as_ref().map(|mqtt| broker(mqtt, &file.site.name, &folder)).transpose()?,
        site: file.site.name,
        mine: Arc::new(mine),
        profiles: Arc::new(profiles),
        rules: file.rules,
        data,
        shards: file.pipeline.threads.unwrap_or_else(cores).clamp(1, 256),
        snapshot_every: Duration::from_secs_f64(snapshot_s),
        retention: file.retention,
        clock: clock(file.clock)?,
    };
    Ok((settings, serving))
}

fn clock(pace: Option<Pace>) -> Result<Clock> {
    match pace {
        None => Ok(Clock::default()),
        Some(pace) if pace.speed > 0.0 && pace.speed <= FASTEST => Ok(Clock::simulated(pace)),
        Some(Pace { speed, .. }) => bail!("[clock] speed: found {speed}, expected more than 0, to {FASTEST}"),
    }
}

fn tls(api: &ApiPart, folder: &Path) -> Result<Option<TlsFiles>> {
    match (&api.certificate, &api.key) {
        (Some(certificate), Some(key)) => {
            Ok(Some(TlsFiles { certificate: folder.join(certificate), key: folder.join(key) }))
        }
        (None, None) => Ok(None),
        _ => bail!("[api] certificate and key: expected both or none"),
    }
}

fn broker(mqtt: &MqttPart, site: &str, folder: &Path) -> Result<MqttSettings> {
    if site.is_empty() || site.contains(['/', '+', '#']) {
        bail!("[site] name: found \"{site}\", expected a name without '/', '+' and '#': it stands in topics");
    }
    let login = match (&mqtt.user, &mqtt.password_file) {
        (Some(user), Some(file)) => {
            let path = folder.join(file);
            let password =
                fs::read_to_string(&path).with_context(|| format!("{}: cannot read it", path.display()))?;
            Some((user.clone(), password.trim_end_matches(['\r', '\n']).to_owned()))
        }
        (None, None) => None,
        _ => bail!("[mqtt] user and password_file: expected both or none"),
    };
    let tls = mqtt.certificate_authority.as_ref().map(|file| {
        let path = folder.join(file);
        adit_server::ingest::mqtt::trusting(&path)
    });
    Ok(MqttSettings {
        host: mqtt.host.clone(),
        port: mqtt.port,
        site: site.to_owned(),
        client_id: mqtt.client_id.clone().unwrap_or_else(|| format!("adit-{site}")),
        login,
        tls: tls.transpose()?,
    })
}

/// The profiles of the file; without any, `fused` on the body for everybody.
fn profiles(parts: &[ProfilePart], folder: &Path, site: &Arc<RadioSite>) -> Result<Profiles> {
    let everybody = ProfilePart {
        name: "everybody".to_owned(),
        tags: vec!["*".to_owned()],
        method: fused(),
        config: None,
        sidecar: None,
        location: Some(Location::Waist),
        nlos: None,
    };
    let parts = if parts.is_empty() { std::slice::from_ref(&everybody) } else { parts };
    let profiles = parts
        .iter()
        .map(|part| profile(part, folder, site).with_context(|| format!("profile \"{}\"", part.name)));
    Ok(Profiles::new(profiles.collect::<Result<_>>()?)?)
}

fn profile(part: &ProfilePart, folder: &Path, site: &Arc<RadioSite>) -> Result<Profile> {
    let mut sidecar = match &part.sidecar {
        None => Sidecar::default(),
        Some(path) => Sidecar::read(&folder.join(path))?,
    };
    sidecar.mounting.location = part.location.or(sidecar.mounting.location);
    let name = <MethodName as clap::ValueEnum>::from_str(&part.method, false);
    let name = name
        .map_err(|_| anyhow::anyhow!("method: found \"{}\", expected a name of adit track", part.method))?;
    if let Some(objection) = name.objection(&sidecar) {
        bail!("{objection}");
    }
    let config = part.config.as_ref().map(|path| folder.join(path));
    let settings = estimator(name, &sidecar, config.as_deref(), site)?;
    let profile = Profile::new(&part.name, part.tags.clone(), sidecar, settings);
    match &part.nlos {
        None => Ok(profile),
        Some(model) => Ok(profile.judging(judged_ranges::model(model, folder)?)),
    }
}

/// The settings of a method that can follow a tag: one that needs no start pose and finds a position.
fn estimator(
    name: MethodName,
    sidecar: &Sidecar,
    config: Option<&Path>,
    site: &Arc<RadioSite>,
) -> Result<EstimatorSettings> {
    fn of<S: MethodSettings + Into<EstimatorSettings>>(
        sidecar: &Sidecar,
        config: Option<&Path>,
        site: &Arc<RadioSite>,
    ) -> Result<EstimatorSettings> {
        Ok(method::settings::<S>(Some(sidecar), config)?.at_site(site).into())
    }
    use adit_estimation::methods as m;
    let settings = match name {
        MethodName::Fused => of::<m::fused::FusedParams>,
        MethodName::FootIns => of::<m::foot_ins::FootInsParams>,
        MethodName::MargIns => of::<m::marg_ins::MargInsParams>,
        MethodName::Pdr => of::<m::pdr::PdrParams>,
        MethodName::Wifi => of::<m::wifi::WifiParams>,
        MethodName::PdrWifi => of::<m::pdr_wifi::PdrWifiParams>,
        MethodName::UwbLs => of::<m::uwb_ls::UwbLsParams>,
        MethodName::UwbPdr => of::<m::uwb_pdr::UwbPdrParams>,
        MethodName::UwbEkf => of::<m::uwb_filter::UwbEkfParams>,
        MethodName::UwbRkf => of::<m::uwb_filter::UwbRkfParams>,
        MethodName::UwbAekf => of::<m::uwb_filter::UwbAekfParams>,
        MethodName::ReducedInsWifi | MethodName::FullInsWifi | MethodName::Ahrs => {
            bail!(
                "method {}: cannot follow a tag live: it needs a start pose, or finds no position",
                name.name()
            )
        }
    };
    settings(sidecar, config, site)
}
