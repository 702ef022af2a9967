//! How tags are followed: why a position is where it is, whom a tag hears, and which packets came.

use crate::api::extract::Path;
use crate::api::{ApiError, Context, Timestamp};
use crate::pipeline::{BIN_S, HearingReport, NisBin, Source};
use adit_estimation::weighed::{Weighed, WeighedKind};
use adit_mine::plan::MinePlan;
use adit_observation::ObservationKind;
use axum::extract::State;
use serde::Serialize;
use serde_json::Value;
use std::sync::Arc;
use utoipa::ToSchema;

/// How a tag is followed.
#[derive(Serialize, ToSchema)]
pub(super) struct Following {
    /// The tag.
    tag: String,
    /// Name of its profile in the settings.
    profile: String,
    /// Name of the method.
    method: String,
    /// What is added to the stamps of its clock, s.
    clock_shift_s: f64,
    /// Packets and observations: taken, repeated, late, refused; fixes told.
    counts: Value,
    /// The last error of the method.
    last_error: Option<String>,
    /// What the method says of its run: what it heard, innovations, warnings.
    method_report: Value,
    /// Whether ranges are judged for line of sight, as its profile has it.
    judged: bool,
    /// What the tag sends.
    sensors: Vec<SensorRate>,
    /// Whom the tag heard in its last minute, or who heard it, by name; at most 16.
    heard: Vec<HeardSource>,
    /// The last ten minutes; null where the method has weighed nothing yet.
    innovations: Option<Innovations>,
}

/// A kind of observations that a tag sends.
#[derive(Serialize, ToSchema)]
struct SensorRate {
    /// `imu` (gyro and accelerometer), `acceleration`, `magnetic`, `pressure`, `fix`, `signal`, `range`, `sighting`.
    #[schema(value_type = String)]
    kind: ObservationKind,
    /// How many a second, over its last 10 to 20 s.
    per_s: f64,
}

/// The last that an anchor or access point told of a tag.
#[derive(Serialize, ToSchema)]
struct HeardSource {
    /// Its name as the tag has it: an id, or a MAC address.
    source: String,
    /// Id of the anchor or access point of the plan that it is; null where the plan has none.
    anchor: Option<String>,
    /// `range` or `signal`.
    kind: &'static str,
    /// When, by the server's clock.
    time: Timestamp,
    /// The distance as measured, m.
    range_m: Option<f64>,
    /// The signal strength, dBm.
    rssi_dbm: Option<f64>,
    /// Probability that the signal came straight, as judged live; null where nothing judged it.
    line_of_sight: Option<f64>,
    /// What the method made of it; null where it holds no single ranges or signals, or does not know the anchor.
    innovation: Option<Innovation>,
}

/// What a method made of a range or a signal strength.
#[derive(Serialize, ToSchema)]
struct Innovation {
    /// Of which time.
    time: Timestamp,
    /// Measured less expected: m of a range, dB of a signal strength.
    residual: f64,
    /// The same squared over its predicted variance; 1 in the mean where the method knows its errors.
    nis: f64,
    /// Whether it counted in full: was neither refused nor weighed down.
    believed: bool,
}

/// Normalised innovations squared in bins of time.
#[derive(Serialize, ToSchema)]
struct Innovations {
    /// End of the last bin, by the tag's time.
    until: Timestamp,
    /// Length of a bin, s.
    bin_s: i64,
    /// Oldest first, 60.
    bins: Vec<InnovationBin>,
}

/// Innovations of ten seconds.
#[derive(Serialize, ToSchema)]
struct InnovationBin {
    /// Mean for each degree of freedom, of what counted in full; null where nothing did.
    mean_nis: Option<f64>,
    /// Degrees of freedom in that mean.
    count: u64,
    /// Measurements that did not count in full.
    outliers: u64,
}

/// The anchor or access point of the plan that goes by this name, by id or MAC address with and without colons.
fn of_plan<'a>(plan: &'a MinePlan, name: &str) -> Option<&'a str> {
    let plain = |mac: &str| mac.replace([':', '-'], "").to_ascii_lowercase();
    let mut anchors = plan.anchors.iter().map(|anchor| anchor.id.as_str());
    let points = || plan.access_points.iter();
    anchors
        .find(|id| *id == name)
        .or_else(|| points().map(|point| point.id.as_str()).find(|id| *id == name))
        .or_else(|| {
            let known = |mac: &&str| plain(mac) == plain(name);
            points()
                .find(|point| point.mac.as_deref().as_ref().is_some_and(known))
                .map(|point| point.id.as_str())
        })
}

fn heard_source(plan: &MinePlan, source: &Source, weighed: Option<Weighed>) -> HeardSource {
    let id = source.id.as_str();
    let (value, is_range) = (f64::from(source.value), source.kind == WeighedKind::Range);
    HeardSource {
        source: id.to_owned(),
        anchor: of_plan(plan, id).map(ToOwned::to_owned),
        kind: if is_range { "range" } else { "signal" },
        time: source.time.into(),
        range_m: is_range.then_some(value),
        rssi_dbm: (!is_range).then_some(value),
        line_of_sight: source.line_of_sight.map(f64::from),
        innovation: weighed.map(|weighed| Innovation {
            time: weighed.time.into(),
            residual: weighed.residual.into(),
            nis: weighed.nis.into(),
            believed: weighed.believed,
        }),
    }
}

fn innovations(heard: &HearingReport) -> Option<Innovations> {
    let bin = |bin: &NisBin| InnovationBin { mean_nis: bin.mean, count: bin.count, outliers: bin.outliers };
    let bins = heard.course.iter().map(bin).collect();
    Some(Innovations { until: heard.until?.into(), bin_s: BIN_S, bins })
}

/// How a tag is followed: method, clock, packets; what it sends, whom it hears, line of sight, innovations.
#[utoipa::path(get, path = "/api/v1/tags/{tag}/following", tag = "tags", params(("tag" = String, Path, description = "id of the tag")),
    responses((status = 200, description = "how", body = Following), (status = 404, description = "no packet of it came", body = crate::api::Problem)))]
pub(super) async fn of_tag(
    State(context): State<Arc<Context>>,
    Path(tag): Path<String>,
) -> Result<axum::Json<Following>, ApiError> {
    let health = context.door.following(tag.clone()).await;
    let health = health.ok_or_else(|| ApiError::not_found(format!("no packet of a tag \"{tag}\" came")))?;
    let sensors = health.heard.sensors.iter();
    let sensors = sensors.map(|rate| SensorRate { kind: rate.kind, per_s: rate.per_s });
    let (sensors, innovations) = (sensors.collect(), innovations(&health.heard));
    let heard = health.heard.sources.iter();
    let heard = heard.map(|(source, weighed)| heard_source(context.mine.plan(), source, *weighed)).collect();
    Ok(axum::Json(Following {
        tag: health.tag,
        profile: health.profile,
        method: health.method,
        clock_shift_s: health.clock_shift_s,
        counts: serde_json::to_value(health.counts).map_err(|error| ApiError::internal(&error))?,
        last_error: health.last_error,
        method_report: health.method_report,
        judged: health.judged,
        sensors,
        heard,
        innovations,
    }))
}

/// Packets that came of a tag.
#[derive(Serialize, ToSchema)]
pub(super) struct Packets {
    /// The tag.
    tag: String,
    /// First and last of each span of its own packet numbers.
    numbers: Vec<[u64; 2]>,
}

/// The numbers of all packets that came, tag by tag: what a gateway or a load generator has sent and does not find here was lost.
#[utoipa::path(get, path = "/api/v1/packets", tag = "tags", responses((status = 200, description = "by tag", body = Vec<Packets>)))]
pub(super) async fn packets(
    State(context): State<Arc<Context>>,
) -> Result<axum::Json<Vec<Packets>>, ApiError> {
    let packets = context.door.packets().await.unwrap_or_default();
    let packets = packets.into_iter().map(|(tag, numbers)| Packets {
        tag,
        numbers: numbers.into_iter().map(|(first, last)| [first, last]).collect(),
    });
    Ok(axum::Json(packets.collect()))
}
