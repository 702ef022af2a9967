//! An evacuation as it stands.

use super::{WhereJson, who, word};
use crate::api::Timestamp;
use adit_tracking::evacuation::{EvacuationSummary, EvacuationView, Evacuee, Way};
use serde::Serialize;
use utoipa::ToSchema;

/// How many stand how.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(as = EvacuationSummary)]
pub struct SummaryJson {
    out: u32,
    other_level: u32,
    in_refuge: u32,
    moving_out: u32,
    not_moving: u32,
    unknown: u32,
    /// Of the last three: expected to be safe by now.
    missing: u32,
}

impl From<EvacuationSummary> for SummaryJson {
    fn from(summary: EvacuationSummary) -> Self {
        Self {
            out: summary.out,
            other_level: summary.other_level,
            in_refuge: summary.in_refuge,
            moving_out: summary.moving_out,
            not_moving: summary.not_moving,
            unknown: summary.unknown,
            missing: summary.missing,
        }
    }
}

/// The shortest way on foot.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Way)]
pub(in crate::api) struct WayJson {
    /// Zone where it ends.
    zone: String,
    /// Along the roadways from the last known position, m.
    length_m: f64,
}

impl From<Way> for WayJson {
    fn from(way: Way) -> Self {
        Self { zone: way.zone, length_m: way.length_m }
    }
}

/// Somebody who was below when the evacuation began, or since.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Evacuee)]
pub(in crate::api) struct EvacueeJson {
    person: Option<String>,
    tag: Option<String>,
    /// `out`, `other-level`, `in-refuge`, `moving-out`, `not-moving` or `unknown`.
    status: String,
    since: Timestamp,
    /// Expected to be safe by now.
    missing: bool,
    /// Last known position, with the radius that grows.
    last_known: Option<WhereJson>,
    to_refuge: Option<WayJson>,
    to_portal: Option<WayJson>,
    /// By how much the way has become shorter since the evacuation began, m.
    nearer_by_m: Option<f64>,
}

impl From<Evacuee> for EvacueeJson {
    fn from(evacuee: Evacuee) -> Self {
        let (person, tag) = who(&evacuee.subject);
        Self {
            person,
            tag,
            status: word(&evacuee.status),
            since: evacuee.since.into(),
            missing: evacuee.missing,
            last_known: evacuee.last_known.map(WhereJson::from),
            to_refuge: evacuee.to_refuge.map(WayJson::from),
            to_portal: evacuee.to_portal.map(WayJson::from),
            nearer_by_m: evacuee.nearer_by_m,
        }
    }
}

/// An evacuation as it stands.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Evacuation)]
pub(in crate::api) struct EvacuationJson {
    id: u64,
    since: Timestamp,
    /// For how long it runs, s.
    running_s: f64,
    by: String,
    note: String,
    /// Levels to leave; the whole mine where it is empty.
    levels: Vec<String>,
    summary: SummaryJson,
    people: Vec<EvacueeJson>,
}

impl From<EvacuationView> for EvacuationJson {
    fn from(view: EvacuationView) -> Self {
        Self {
            id: view.id,
            since: view.since.into(),
            running_s: view.running.seconds(),
            by: view.by,
            note: view.note,
            levels: view.levels.into_iter().collect(),
            summary: view.summary.into(),
            people: view.people.into_iter().map(EvacueeJson::from).collect(),
        }
    }
}
