//! Fences that clients have put, and who is in them: pure, without a clock.
//!
//! Somebody comes in when a location lies in the region, on its floor where it has one. They go out
//! - when they are farther out than `exit_tolerance` and stay out for `exit_delay` (−1: never by this; 0 where it is not given),
//! - when they stay between region and `exit_tolerance` for `tolerance_timeout` (never where it is not given or −1),
//! - when no location of theirs comes for `timeout` (never where it is not given or −1).
//!
//! Regions are judged level, on the mine's grid; the accuracy of a location does not count, as omlox has it.

use super::crs::{Crs, level_of};
use super::shelf::Object;
use crate::api::ApiError;
use adit_core::frames::{MineGrid, Position};
use adit_core::time::{Interval, Time};
use adit_mine::Mine;
use adit_mine::plan::{Zone, ZoneKind};
use adit_tracking::Subject;
use serde_json::Value;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Most corners of a region.
const CORNERS: usize = 10_000;
/// Longest tolerance, m.
const FARTHEST_M: f64 = 1e6;
/// Longest time, ms: thirty years.
const LONGEST_MS: f64 = 1e12;

/// Where a fence is.
#[derive(Debug, Clone)]
enum Region {
    Circle { centre_m: [f64; 2], radius_m: f64 },
    Polygon(Zone),
}

impl Region {
    /// How far outside a place is, m; 0 inside.
    fn distance_m(&self, [x, y]: [f64; 2]) -> f64 {
        match self {
            Self::Circle { centre_m, radius_m } => {
                ((x - centre_m[0]).hypot(y - centre_m[1]) - radius_m).max(0.0)
            }
            Self::Polygon(zone) => zone.distance_m(x, y),
        }
    }

    /// Lowest and highest corner of what holds it, m.
    fn bounds_m(&self) -> [[f64; 2]; 2] {
        match self {
            Self::Circle { centre_m: [x, y], radius_m: r } => [[x - r, y - r], [x + r, y + r]],
            Self::Polygon(zone) => {
                let mut bounds_m = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
                for at in &zone.outline_m {
                    for axis in 0..2 {
                        bounds_m[0][axis] = bounds_m[0][axis].min(at[axis]);
                        bounds_m[1][axis] = bounds_m[1][axis].max(at[axis]);
                    }
                }
                bounds_m
            }
        }
    }
}

/// What is told of a fence with each event.
#[derive(Debug, PartialEq)]
pub(super) struct Label {
    pub id: String,
    pub foreign_id: Option<String>,
    /// The region as the client has put it.
    pub region: Value,
}

/// A fence as it is watched.
#[derive(Debug, Clone)]
pub(super) struct Fence {
    label: Arc<Label>,
    region: Region,
    bounds_m: [[f64; 2]; 2],
    /// Id of the level; all where none.
    level: Option<String>,
    exit_tolerance_m: f64,
    /// `None` is never.
    exit_delay: Option<Interval>,
    tolerance_timeout: Option<Interval>,
    timeout: Option<Interval>,
}

/// A number of an object: what it is where it is not there, `None` where it is −1, which omlox takes for without end.
fn milliseconds(object: &Object, name: &str, absent: Option<f64>) -> Result<Option<Interval>, ApiError> {
    let given = match object.get(name) {
        None | Some(Value::Null) => absent,
        Some(value) => match value.as_f64() {
            Some(-1.0) => None,
            Some(ms) if (0.0..=LONGEST_MS).contains(&ms) => Some(ms),
            _ => {
                let what = format!("{name}: expected milliseconds from 0 to 10¹², or -1, found {value}");
                return Err(ApiError::invalid(what));
            }
        },
    };
    Ok(given.and_then(|ms| Interval::from_seconds(ms / 1000.0)))
}

fn metres(object: &Object, name: &str) -> Result<Option<f64>, ApiError> {
    match object.get(name) {
        None | Some(Value::Null) => Ok(None),
        Some(value) => match value.as_f64() {
            Some(m) if (0.0..=FARTHEST_M).contains(&m) => Ok(Some(m)),
            _ => Err(ApiError::invalid(format!("{name}: expected metres from 0 to 10⁶, found {value}"))),
        },
    }
}

impl Fence {
    /// Reads a fence as a client has put it; its coordinates are those of `crs`, `EPSG:4326` where it names none.
    pub(super) fn read(id: &str, object: &Object, mine: &Mine) -> Result<Self, ApiError> {
        let level = match object.get("floor") {
            None | Some(Value::Null) => None,
            Some(floor) => {
                let level = floor.as_f64().and_then(|floor| level_of(mine, floor));
                Some(
                    level
                        .ok_or_else(|| ApiError::invalid(format!("floor: the mine has no floor {floor}")))?,
                )
            }
        };
        let crs = match object.get("crs") {
            None | Some(Value::Null) => "EPSG:4326",
            Some(crs) => crs.as_str().ok_or_else(|| ApiError::invalid("crs: expected a text"))?,
        };
        let crs = Crs::named(Some(crs), mine)?;
        // Where a place lies on the plan hardly depends on the height.
        let height_m = level.map_or(0.0, |level| level.elevation_m);
        let place = |at: &Value| -> Result<[f64; 2], ApiError> {
            let numbers: Option<Vec<f64>> =
                at.as_array().and_then(|numbers| numbers.iter().map(Value::as_f64).collect());
            let (Some(&x), Some(&y)) = (
                numbers.as_ref().and_then(|numbers| numbers.first()),
                numbers.as_ref().and_then(|numbers| numbers.get(1)),
            ) else {
                return Err(ApiError::invalid(format!("region: expected coordinates, found {at}")));
            };
            let read = crs.read([x, y, height_m]).map(|at| *at.raw());
            let read = read.filter(|at| at.x.abs() <= 1e7 && at.y.abs() <= 1e7);
            let at = read.ok_or_else(|| {
                ApiError::invalid(format!("region: {at} is outside of what the coordinate system reaches"))
            })?;
            Ok([at.x, at.y])
        };
        let region = object.get("region").unwrap_or(&Value::Null);
        let coordinates = region.get("coordinates").unwrap_or(&Value::Null);
        let region = match region.get("type").and_then(Value::as_str) {
            Some("Point") => {
                let radius_m = metres(object, "radius")?
                    .ok_or_else(|| ApiError::invalid("radius: a region that is a Point has one, m"))?;
                Region::Circle { centre_m: place(coordinates)?, radius_m }
            }
            Some("Polygon") => Region::Polygon(outline(coordinates, place)?),
            _ => return Err(ApiError::invalid("region: expected a Point or a Polygon of GeoJSON")),
        };
        let foreign_id = object.get("foreign_id").and_then(Value::as_str).map(str::to_owned);
        let told = object.get("region").cloned().unwrap_or_default();
        Ok(Self {
            label: Arc::new(Label { id: id.to_owned(), foreign_id, region: told }),
            bounds_m: region.bounds_m(),
            region,
            level: level.map(|level| level.id.clone()),
            exit_tolerance_m: metres(object, "exit_tolerance")?.unwrap_or(0.0),
            exit_delay: milliseconds(object, "exit_delay", Some(0.0))?,
            tolerance_timeout: milliseconds(object, "tolerance_timeout", None)?,
            timeout: milliseconds(object, "timeout", None)?,
        })
    }

    fn is_near(&self, at: [f64; 2]) -> bool {
        let [low, high] = self.bounds_m;
        (0..2).all(|axis| (low[axis]..=high[axis]).contains(&at[axis]))
    }

    /// How far outside somebody is, m; infinite on another level.
    fn distance_m(&self, place: &Place<'_>) -> f64 {
        if self.level.is_some() && self.level.as_deref() != place.level {
            return f64::INFINITY;
        }
        self.region.distance_m(place.at())
    }
}

/// The one ring of a polygon.
fn outline(
    coordinates: &Value,
    place: impl Fn(&Value) -> Result<[f64; 2], ApiError>,
) -> Result<Zone, ApiError> {
    let rings = coordinates.as_array().map(Vec::as_slice).unwrap_or_default();
    let [Value::Array(ring)] = rings else {
        let found = rings.len();
        return Err(ApiError::invalid(format!("region: expected a Polygon of one ring, found {found}")));
    };
    if ring.len() > CORNERS {
        return Err(ApiError::invalid(format!("region: expected at most {CORNERS} corners")));
    }
    let mut outline_m = ring.iter().map(place).collect::<Result<Vec<_>, _>>()?;
    if outline_m.len() > 1 && outline_m.first() == outline_m.last() {
        outline_m.pop();
    }
    if outline_m.len() < 3 {
        return Err(ApiError::invalid(format!(
            "region: expected three corners or more, found {}",
            outline_m.len()
        )));
    }
    Ok(Zone {
        id: String::new(),
        name: None,
        kind: ZoneKind::Key,
        level: String::new(),
        capacity: None,
        exit_tolerance_m: 0.0,
        exit_delay_s: 0.0,
        outline_m,
    })
}

/// Where somebody was seen.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place<'a> {
    pub position_m: &'a Position<MineGrid>,
    /// Id of the level.
    pub level: Option<&'a str>,
}

impl Place<'_> {
    fn at(&self) -> [f64; 2] {
        let at = self.position_m.raw();
        [at.x, at.y]
    }
}

/// Somebody in a fence.
#[derive(Debug, Clone, Copy)]
struct Stay {
    entered: Time,
    seen: Time,
    /// Since when between region and tolerance.
    beside: Option<Time>,
    /// Since when farther out.
    out: Option<Time>,
}

impl Stay {
    fn look(&mut self, fence: &Fence, distance_m: f64, time: Time) {
        self.seen = time;
        if distance_m <= 0.0 {
            (self.beside, self.out) = (None, None);
        } else if distance_m <= fence.exit_tolerance_m {
            self.out = None;
            self.beside.get_or_insert(time);
        } else {
            self.beside = None;
            self.out.get_or_insert(time);
        }
    }

    /// When they went out, as is known at a time.
    fn left(&self, fence: &Fence, now: Time) -> Option<Time> {
        let over = |since: Option<Time>, delay: Option<Interval>| {
            since.filter(|since| delay.is_some_and(|delay| now >= *since + delay))
        };
        let out = over(self.out, fence.exit_delay).or_else(|| over(self.beside, fence.tolerance_timeout));
        out.or_else(|| over(Some(self.seen), fence.timeout))
    }
}

/// Somebody came in or went out.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Crossing {
    pub fence: Arc<Label>,
    pub subject: Subject,
    pub entered: Time,
    /// When they were first seen outside, or last seen at all; none while they are in.
    pub left: Option<Time>,
}

struct Watched {
    fence: Fence,
    inside: BTreeMap<Subject, Stay>,
}

/// All fences that are watched.
#[derive(Default)]
pub(super) struct Fences(BTreeMap<String, Watched>);

impl Fences {
    /// Watches a fence. Who was in one of this id and is in its region as it is now stays, as long as they are seen there.
    pub(super) fn put(&mut self, fence: Fence) {
        let id = fence.label.id.clone();
        let inside = self.0.remove(&id).map(|watched| watched.inside).unwrap_or_default();
        self.0.insert(id, Watched { fence, inside });
    }

    /// Watches it no more.
    pub(super) fn remove(&mut self, id: &str) {
        self.0.remove(id);
    }

    /// Watches none.
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Somebody was seen; what was seen before is no news.
    pub(super) fn see(&mut self, subject: &Subject, place: &Place<'_>, time: Time) -> Vec<Crossing> {
        let mut crossings = Vec::new();
        for Watched { fence, inside } in self.0.values_mut() {
            let crossing = |entered, left| {
                let (fence, subject) = (Arc::clone(&fence.label), subject.clone());
                Crossing { fence, subject, entered, left }
            };
            if let Some(stay) = inside.get_mut(subject) {
                if time <= stay.seen {
                    continue;
                }
                stay.look(fence, fence.distance_m(place), time);
                let stay = *stay;
                if let Some(left) = stay.left(fence, time) {
                    inside.remove(subject);
                    crossings.push(crossing(stay.entered, Some(left)));
                }
            } else if fence.is_near(place.at()) && fence.distance_m(place) <= 0.0 {
                inside.insert(subject.clone(), Stay { entered: time, seen: time, beside: None, out: None });
                crossings.push(crossing(time, None));
            }
        }
        crossings
    }

    /// Time passes.
    pub(super) fn pass(&mut self, now: Time) -> Vec<Crossing> {
        let mut crossings = Vec::new();
        for Watched { fence, inside } in self.0.values_mut() {
            inside.retain(|subject, stay| match stay.left(fence, now) {
                Some(left) => {
                    let (fence, subject) = (Arc::clone(&fence.label), subject.clone());
                    crossings.push(Crossing { fence, subject, entered: stay.entered, left: Some(left) });
                    false
                }
                None => true,
            });
        }
        crossings
    }

    /// Who is in a fence.
    pub(super) fn inside(&self, id: &str) -> Vec<Subject> {
        self.0.get(id).map(|watched| watched.inside.keys().cloned().collect()).unwrap_or_default()
    }

    /// Ids of the fences that somebody is in.
    pub(super) fn of(&self, subject: &Subject) -> Vec<String> {
        let holds = self.0.iter().filter(|(_, watched)| watched.inside.contains_key(subject));
        holds.map(|(id, _)| id.clone()).collect()
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use serde_json::json;

    fn mine() -> Mine {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../mines/two-level.toml");
        adit_mine::file::open(std::path::Path::new(file)).unwrap().0
    }

    fn read(body: Value) -> Result<Fence, ApiError> {
        let Value::Object(object) = body else { unreachable!("an object") };
        Fence::read("f", &object, &mine())
    }

    fn at(x: f64) -> Position<MineGrid> {
        Position::new(x, 0.0, 0.0)
    }

    fn s(seconds: f64) -> Time {
        Time::from_seconds(seconds).unwrap()
    }

    /// A fence from −10 to 10 m, and what each (time, place) brings: times of entry and exit.
    fn walk(timing: &Value, way: &[(f64, f64)]) -> Vec<(f64, Option<f64>)> {
        let mut body = json!({ "crs": "local",
            "region": { "type": "Polygon", "coordinates": [[[-10, -10], [10, -10], [10, 10], [-10, 10], [-10, -10]]] } });
        body.as_object_mut().unwrap().extend(timing.as_object().unwrap().clone());
        let mut fences = Fences::default();
        fences.put(read(body).unwrap());
        let who = Subject::Tag("t".into());
        let mut told = Vec::new();
        for &(time, x) in way {
            let crossings = if x.is_finite() {
                fences.see(&who, &Place { position_m: &at(x), level: None }, s(time))
            } else {
                fences.pass(s(time))
            };
            told.extend(crossings.iter().map(|it| (it.entered.seconds(), it.left.map(Time::seconds))));
        }
        assert_eq!(fences.inside("f").is_empty(), told.len() % 2 == 0, "{told:?}");
        told
    }

    #[test]
    fn who_comes_in_and_goes_out_is_told_once() {
        let way = [(0.0, 30.0), (1.0, 10.0), (2.0, 0.0), (3.0, 10.1), (4.0, 30.0), (5.0, 5.0)];
        assert_eq!(walk(&json!({}), &way), [(1.0, None), (1.0, Some(3.0)), (5.0, None)]);
        // What comes late changes nothing.
        assert_eq!(walk(&json!({}), &[(1.0, 0.0), (1.0, 30.0), (0.5, 30.0)]), [(1.0, None)]);
    }

    #[test]
    fn tolerance_delay_and_timeouts_hold_an_exit_back() {
        let tolerant = json!({ "exit_tolerance": 5.0 });
        assert_eq!(walk(&tolerant, &[(0.0, 0.0), (1.0, 14.9), (99.0, 14.9)]), [(0.0, None)]);
        let tolerant = json!({ "exit_tolerance": 5.0, "tolerance_timeout": 2000 });
        assert_eq!(
            walk(&tolerant, &[(0.0, 0.0), (1.0, 14.9), (2.0, 14.9), (3.0, 14.9)]),
            [(0.0, None), (0.0, Some(1.0))]
        );
        let delayed = json!({ "exit_delay": 3000 });
        let way = [(0.0, 0.0), (1.0, 20.0), (3.0, 0.0), (4.0, 20.0), (6.9, 20.0), (7.0, f64::NAN)];
        assert_eq!(walk(&delayed, &way), [(0.0, None), (0.0, Some(4.0))]);
        assert_eq!(
            walk(&json!({ "exit_delay": -1 }), &[(0.0, 0.0), (1.0, 20.0), (1e6, 20.0)]),
            [(0.0, None)]
        );
        let silent = json!({ "timeout": 5000 });
        assert_eq!(
            walk(&silent, &[(0.0, 0.0), (4.9, f64::NAN), (5.0, f64::NAN)]),
            [(0.0, None), (0.0, Some(0.0))]
        );
    }

    #[test]
    fn a_floor_and_a_circle_hold_who_is_there() {
        let mine = mine();
        let level = mine.plan().levels[0].id.clone();
        let floor = super::super::crs::floor_of(&mine, &level).unwrap();
        let circle = json!({ "crs": "local", "region": { "type": "Point", "coordinates": [0, 0] }, "radius": 3.0, "floor": floor });
        let mut fences = Fences::default();
        fences.put(read(circle).unwrap());
        let who = Subject::Person("p".into());
        let place = at(2.9);
        assert!(fences.see(&who, &Place { position_m: &place, level: Some("elsewhere") }, s(0.0)).is_empty());
        let entered = fences.see(&who, &Place { position_m: &place, level: Some(&level) }, s(1.0));
        assert_eq!((entered.len(), fences.of(&who)), (1, vec!["f".to_owned()]));
        let left = fences.see(&who, &Place { position_m: &place, level: Some("elsewhere") }, s(2.0));
        assert_eq!((left[0].left, fences.of(&who).len()), (Some(s(2.0)), 0));
    }

    #[test]
    fn what_is_no_fence_is_refused_with_its_name() {
        let ring = json!([[0, 0], [1, 0], [1, 1], [0, 0]]);
        let polygon = |rings: Value| json!({ "type": "Polygon", "coordinates": rings });
        for (bad, what) in [
            (json!({ "crs": "local" }), "region"),
            (json!({ "crs": "local", "region": { "type": "Point", "coordinates": [0, 0] } }), "radius"),
            (json!({ "crs": "local", "region": polygon(json!([ring, ring])) }), "one ring"),
            (
                json!({ "crs": "local", "region": polygon(json!([[[0, 0], [1, 0], [0, 0]]])) }),
                "three corners",
            ),
            (json!({ "crs": "local", "region": polygon(json!([[[0, 0], [1e300, 0], [1, 1]]])) }), "outside"),
            (json!({ "crs": "local", "region": polygon(json!([[[0], [1, 0], [1, 1]]])) }), "coordinates"),
            (json!({ "crs": "local", "region": polygon(json!([ring])), "floor": 99 }), "floor"),
            (json!({ "crs": "local", "region": polygon(json!([ring])), "exit_delay": -2 }), "exit_delay"),
            (json!({ "crs": "EPSG:1", "region": polygon(json!([ring])) }), "crs"),
        ] {
            let error = read(bad).unwrap_err().problem().message;
            assert!(error.contains(what), "{what}: {error}");
        }
    }
}
