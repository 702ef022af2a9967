//! Everybody over a time, for the replay of a console.

use super::history::in_order;
use crate::api::extract::Query;
use crate::api::view::word;
use crate::api::{ApiError, Context, Timestamp};
use crate::store::ReplayQuery;
use axum::extract::State;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use utoipa::{IntoParams, ToSchema};

/// An answer has no more fixes.
const MOST_FIXES: usize = 400_000;
/// … and is of no more time, h.
const MOST_H: f64 = 24.0;

/// Which part of the past.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct ReplayPart {
    /// From this time on.
    from: Timestamp,
    /// Before this time, at most 24 h later.
    until: Timestamp,
    /// The first fix of each tag in each such step, s; 1 where it is not given.
    #[param(minimum = 0.1, maximum = 3600)]
    step_s: Option<f64>,
}

/// Where everybody was.
#[derive(Serialize, ToSchema)]
pub(super) struct Replay {
    from: Timestamp,
    until: Timestamp,
    step_s: f64,
    /// One entry for each tag and person who wore it.
    people: Vec<ReplayTrack>,
}

/// Where somebody was: columns of the same length.
#[derive(Serialize, ToSchema)]
pub(super) struct ReplayTrack {
    /// Null while nobody wore the tag.
    person: Option<String>,
    tag: String,
    /// After `from`, rising, s.
    time_s: Vec<f64>,
    /// East, north, height, m.
    position_m: Vec<[f64; 3]>,
    radius_95_m: Vec<f64>,
    /// `fixed`, `dead-reckoning` or `lost`.
    quality: Vec<String>,
    /// Id of the level.
    level: Vec<Option<String>>,
}

/// Where everybody was, at most one fix for each tag and step. No more than 400,000 fixes: ask for less time or longer steps then.
#[utoipa::path(get, path = "/api/v1/history/positions", tag = "history", params(ReplayPart),
    responses((status = 200, description = "where everybody was", body = Replay)))]
pub(super) async fn positions(
    State(context): State<Arc<Context>>,
    Query(part): Query<ReplayPart>,
) -> Result<axum::Json<Replay>, ApiError> {
    in_order(Some(part.from), Some(part.until))?;
    let hours = (part.until.0 - part.from.0).seconds() / 3600.0;
    if hours > MOST_H {
        return Err(ApiError::invalid(format!(
            "until: expected at most {MOST_H} h after from, found {hours:.1} h"
        )));
    }
    let step_s = part.step_s.unwrap_or(1.0);
    if !(0.1..=3600.0).contains(&step_s) {
        return Err(ApiError::invalid(format!("step_s: expected 0.1 to 3600, found {step_s}")));
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most an hour")]
    let step_ms = (step_s * 1000.0).round() as u32;
    let query = ReplayQuery { from: part.from.0, until: part.until.0, step_ms, most: MOST_FIXES };
    let fixes = context.store.replay(&query).await.map_err(|error| ApiError::of_store(&error))?;
    let fixes = fixes.ok_or_else(|| {
        ApiError::invalid(format!("more than {MOST_FIXES} fixes: expected less time or longer steps"))
    })?;
    let mut people: Vec<ReplayTrack> = Vec::new();
    // Fixes come by tag, each in order of time; who gets a tag back goes on where they were.
    let mut first_of_tag = 0;
    for fix in fixes {
        if people.last().is_none_or(|track| track.tag != fix.tag) {
            first_of_tag = people.len();
        }
        let known = people.iter().skip(first_of_tag).position(|track| track.person == fix.person);
        let index = known.map_or(people.len(), |index| first_of_tag + index);
        if known.is_none() {
            people.push(ReplayTrack {
                person: fix.person,
                tag: fix.tag,
                time_s: Vec::new(),
                position_m: Vec::new(),
                radius_95_m: Vec::new(),
                quality: Vec::new(),
                level: Vec::new(),
            });
        }
        let track = &mut people[index];
        track.time_s.push((fix.time - part.from.0).seconds());
        track.position_m.push(fix.position_m);
        track.radius_95_m.push(fix.radius_95_m);
        track.quality.push(word(&fix.quality));
        track.level.push(fix.level);
    }
    Ok(axum::Json(Replay { from: part.from, until: part.until, step_s, people }))
}
