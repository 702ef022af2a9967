//! Locations: written from the last known position, read from what a client puts.

use super::crs::{Crs, floor_of, level_of};
use super::objects::{mine_id, trackable_of};
use crate::api::{ApiError, Context, Timestamp};
use crate::ingest::PositionReport;
use adit_core::frames::MineGrid;
use adit_core::frames::Vector;
use adit_mine::Mine;
use adit_tracking::Subject;
use adit_tracking::view::LastKnown;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use utoipa::ToSchema;

/// A point of `GeoJSON`: east or longitude, north or latitude, height.
#[derive(Debug, Clone, Serialize, Deserialize, ToSchema)]
pub(super) struct Point {
    #[serde(rename = "type")]
    #[schema(pattern = "^Point$")]
    kind: String,
    #[schema(min_items = 2, max_items = 3)]
    coordinates: Vec<f64>,
}

/// A location as a client puts it; `source`, `provider_type` and other members are taken and not read.
#[derive(Debug, Deserialize, ToSchema)]
#[schema(as = PutLocation)]
pub(super) struct PutLocation {
    pub position: Point,
    pub provider_id: Option<String>,
    pub timestamp_generated: Option<Timestamp>,
    /// `local` where it is not given.
    pub crs: Option<String>,
    /// Radius that holds it with 95 %, m.
    #[schema(minimum = 0)]
    pub accuracy: Option<f64>,
    /// 0 for the highest level, −1 for the one below.
    pub floor: Option<f64>,
    /// `floor`: the height counts from the floor of the level.
    #[schema(pattern = "^(floor|wgs84)$")]
    pub elevation_ref: Option<String>,
}

impl PutLocation {
    /// The provider that it names.
    pub(super) fn provider(&self) -> Option<&str> {
        self.provider_id.as_deref()
    }

    /// As the journal takes it.
    pub(super) fn report(self, mine: &Mine, tag: &str) -> Result<PositionReport, ApiError> {
        if self.position.kind != "Point" {
            return Err(ApiError::invalid(format!(
                "position: expected a Point, found {:?}",
                self.position.kind
            )));
        }
        if let Some(other) = self.provider_id.as_deref().filter(|id| *id != tag) {
            return Err(ApiError::invalid(format!(
                "provider_id: expected '{tag}' as in the path, found '{other}'"
            )));
        }
        if !matches!(self.elevation_ref.as_deref(), None | Some("floor" | "wgs84")) {
            return Err(ApiError::invalid("elevation_ref: expected `floor` or `wgs84`"));
        }
        let level = match self.floor {
            Some(floor) => Some(
                level_of(mine, floor)
                    .ok_or_else(|| ApiError::invalid(format!("floor: the mine has no floor {floor}")))?,
            ),
            None => match mine.plan().levels.as_slice() {
                [only] => Some(only),
                _ => None,
            },
        };
        let crs = Crs::named(self.crs.as_deref(), mine)?;
        let outside = || ApiError::invalid("position: outside of what the coordinate system reaches");
        let of_floor = self.elevation_ref.as_deref() == Some("floor");
        let position_m = match (self.position.coordinates.as_slice(), level) {
            (&[x, y, z], _) if !of_floor => crs.read([x, y, z]).ok_or_else(outside)?,
            (&[x, y, ref height @ ..], Some(level)) if height.len() <= 1 => {
                // The plan position hardly depends on the height; the height is the level's.
                let flat = *crs.read([x, y, 0.0]).ok_or_else(outside)?.raw();
                let above = height.first().filter(|_| of_floor).copied().unwrap_or_default();
                adit_core::frames::Position::new(flat.x, flat.y, level.elevation_m + above)
            }
            (&[_, _], None) => {
                return Err(ApiError::invalid("position: without a height, `floor` is needed"));
            }
            (&[_, _, _], None) => return Err(ApiError::invalid("elevation_ref `floor` needs `floor`")),
            (other, _) => {
                return Err(ApiError::invalid(format!(
                    "coordinates: expected 2 or 3 numbers, found {}",
                    other.len()
                )));
            }
        };
        let time = self.timestamp_generated.map(|time| time.0);
        Ok(PositionReport { tag: tag.into(), time, position_m, radius_95_m: self.accuracy })
    }
}

/// What a location is of.
pub(super) struct Of<'a> {
    pub subject: &'a Subject,
    pub last_known: &'a LastKnown,
}

/// A location; `None` where the coordinate system does not reach.
pub(super) fn location(context: &Context, crs: &Crs, of: &Of<'_>) -> Option<Value> {
    let known = of.last_known;
    let trackable = trackable_of(of.subject);
    let person = match of.subject {
        Subject::Person(id) => Some(id),
        Subject::Tag(_) => None,
    };
    let mut location = json!({
        "position": { "type": "Point", "coordinates": crs.write(&known.position_m)? },
        "source": mine_id(&context.mine), "provider_type": "virtual", "provider_id": known.tag, "crs": crs.name(),
        "accuracy": known.radius_95_m,
        "timestamp_generated": Timestamp(known.time), "timestamp_sent": Timestamp(context.clock.now()),
        "associated": trackable.is_some(), "trackables": trackable.into_iter().collect::<Vec<_>>(),
        "elevation_ref": "wgs84",
        "properties": {
            "person": person, "quality": crate::api::view::word(&known.quality), "method": &*known.method,
            "level": known.level, "radius_now_m": known.radius_now_m, "protection_level_m": known.protection_level_m,
        },
    });
    if let Some(floor) = known.level.as_ref().and_then(|level| floor_of(&context.mine, level)) {
        location["floor"] = floor.into();
    }
    if let Some((speed, course)) = known.velocity_m_s.as_ref().and_then(speed_and_course) {
        location["speed"] = speed.into();
        location["course"] = course.into();
    }
    if matches!(crs, Crs::Local)
        && let Some(location) = location.as_object_mut()
    {
        location.remove("elevation_ref");
    }
    Some(location)
}

/// Level speed, m/s, and course, degrees clockwise from grid north; none where nobody can tell.
fn speed_and_course(velocity_m_s: &Vector<MineGrid>) -> Option<(f64, f64)> {
    let velocity = velocity_m_s.raw();
    let speed = velocity.x.hypot(velocity.y);
    (speed > 0.0).then(|| (speed, velocity.x.atan2(velocity.y).to_degrees().rem_euclid(360.0)))
}

/// A location as a feature of `GeoJSON`.
pub(super) fn feature(mut location: Value) -> Value {
    let geometry = location.get_mut("position").map(Value::take);
    if let Some(location) = location.as_object_mut() {
        location.remove("position");
    }
    json!({ "type": "Feature", "geometry": geometry, "properties": location })
}

/// The motion of a trackable: its location with what it is.
pub(super) fn motion(context: &Context, crs: &Crs, of: &Of<'_>) -> Option<Value> {
    let id = trackable_of(of.subject)?;
    let Subject::Person(person) = of.subject else { return None };
    Some(
        json!({ "id": id, "name": person, "location": location(context, crs, of)?, "properties": { "person": person } }),
    )
}
