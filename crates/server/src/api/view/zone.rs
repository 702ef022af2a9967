//! Zones and how many are where.

use super::who;
use crate::api::v1::zones::ZoneBody;
use adit_tracking::view::{Count, Headcount, ZoneView};
use serde::Serialize;
use utoipa::ToSchema;

/// How many are in a place.
#[derive(Debug, Clone, Copy, Serialize, ToSchema)]
#[schema(as = Count)]
pub(in crate::api) struct CountJson {
    people: u32,
    /// Tags for people that nobody is known to wear.
    unassigned_tags: u32,
    vehicles: u32,
    assets: u32,
}

impl From<Count> for CountJson {
    fn from(count: Count) -> Self {
        Self {
            people: count.people,
            unassigned_tags: count.unassigned_tags,
            vehicles: count.vehicles,
            assets: count.assets,
        }
    }
}

/// A person, else a tag that nobody is known to wear.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Who)]
pub(in crate::api) struct WhoJson {
    person: Option<String>,
    tag: Option<String>,
}

/// A zone and who is in it.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = ZoneNow)]
pub(in crate::api) struct ZoneJson {
    /// The zone as it is watched.
    zone: ZoneBody,
    count: CountJson,
    inside: Vec<WhoJson>,
    /// Who may be in it: their last fix was too coarse to tell.
    possible: Vec<WhoJson>,
}

impl From<ZoneView> for ZoneJson {
    fn from(view: ZoneView) -> Self {
        let json = |subject| {
            let (person, tag) = who(subject);
            WhoJson { person, tag }
        };
        Self {
            inside: view.inside.iter().map(json).collect(),
            possible: view.possible.iter().map(json).collect(),
            count: view.count.into(),
            zone: view.live.into(),
        }
    }
}

/// How many are in one place.
#[derive(Debug, Serialize, ToSchema)]
pub(in crate::api) struct PlaceCount {
    id: String,
    count: CountJson,
}

/// How many are where.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Headcount)]
pub(in crate::api) struct HeadcountJson {
    /// Below.
    mine: CountJson,
    levels: Vec<PlaceCount>,
    zones: Vec<PlaceCount>,
    /// Below and not heard of: part of `mine`.
    out_of_contact: u32,
}

impl From<Headcount> for HeadcountJson {
    fn from(headcount: Headcount) -> Self {
        let places = |counts: Vec<(String, Count)>| {
            counts.into_iter().map(|(id, count)| PlaceCount { id, count: count.into() }).collect()
        };
        Self {
            mine: headcount.mine.into(),
            levels: places(headcount.levels),
            zones: places(headcount.zones),
            out_of_contact: headcount.out_of_contact,
        }
    }
}
