//! Events of fences as omlox has them: of adit's zones, and of what clients have put.

use super::fencing::Crossing;
use super::objects::{fence, fence_id, trackable_of, uuid_of};
use crate::api::{Context, Timestamp};
use crate::feed::Told;
use adit_core::time::Time;
use adit_tracking::{Event, Subject};
use serde_json::{Value, json};
use uuid::Uuid;

/// Who came in or went out, where and when.
struct Passage<'a> {
    id: Uuid,
    fence: Value,
    foreign_id: Option<&'a str>,
    subject: &'a Subject,
    entered: Time,
    left: Option<Time>,
}

impl Passage<'_> {
    fn write(&self) -> Value {
        let event_type = if self.left.is_none() { "region_entry" } else { "region_exit" };
        let mut body = json!({
            "id": self.id, "fence_id": self.fence, "foreign_id": self.foreign_id, "event_type": event_type,
            "entry_time": Timestamp(self.entered), "properties": {},
        });
        match (self.subject, trackable_of(self.subject)) {
            (Subject::Person(person), Some(trackable)) => {
                body["trackable_id"] = json!(trackable);
                body["properties"]["person"] = json!(person);
            }
            (Subject::Tag(tag) | Subject::Person(tag), _) => body["provider_id"] = json!(tag),
        }
        if let Some(left) = self.left {
            body["exit_time"] = json!(Timestamp(left));
        }
        body
    }
}

fn feature(geometry: &Value, body: &Value) -> Value {
    json!({ "type": "Feature", "geometry": geometry, "properties": body })
}

/// Of a zone of adit; `None` for events of something else.
pub(super) fn of_zone(context: &Context, told: &Told, geojson: bool) -> Option<Value> {
    let (zone, subject, entered, left) = match &told.event {
        Event::ZoneEntered { zone, subject, time, .. } => (zone, subject, *time, None),
        Event::ZoneLeft { zone, subject, entered, time, .. } => (zone, subject, *entered, Some(*time)),
        _ => return None,
    };
    let id = uuid_of("event", &format!("{}:{}", context.feed.run(), told.number));
    let passage =
        Passage { id, fence: json!(fence_id(zone)), foreign_id: Some(zone), subject, entered, left };
    let mut body = passage.write();
    body["properties"]["zone"] = json!(zone);
    Some(if geojson {
        let view = context.tracking().zone(zone);
        let region = view.map(|view| fence(&context.mine, &view.live)["region"].take());
        feature(&region.unwrap_or_default(), &body)
    } else {
        body
    })
}

/// Of a fence that a client has put.
pub(super) fn of_client(crossing: &Crossing, geojson: bool) -> Value {
    let Crossing { fence, subject, entered, left } = crossing;
    let (kind, edge) = left.map_or(("in", *entered), |left| ("out", left));
    let id = uuid_of("crossing", &format!("{}:{subject:?}:{kind}:{}", fence.id, edge.nanos()));
    let foreign_id = fence.foreign_id.as_deref();
    let passage = Passage { id, fence: json!(fence.id), foreign_id, subject, entered: *entered, left: *left };
    let body = passage.write();
    if geojson { feature(&fence.region, &body) } else { body }
}
