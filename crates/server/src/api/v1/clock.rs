//! The time of the mine, and how fast it goes.

use crate::api::extract::Json;
use crate::api::{ApiError, Context, Timestamp};
use crate::clock::FASTEST;
use axum::extract::State;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use utoipa::ToSchema;

/// The time of the mine.
#[derive(Serialize, ToSchema)]
#[schema(as = Clock)]
pub(super) struct ClockJson {
    /// Now.
    time: Timestamp,
    /// Seconds of the mine in a second of the wall: 1, but for a simulated shift.
    clock_speed: f64,
    /// The shift is simulated.
    simulated: bool,
}

/// Another speed.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SetClock {
    /// Above 0, to 100.
    #[schema(exclusive_minimum = 0, maximum = 100)]
    clock_speed: f64,
}

/// What time it is in the mine.
#[utoipa::path(get, path = "/api/v1/clock", tag = "settings", responses((status = 200, description = "now", body = ClockJson)))]
pub(super) async fn now(State(context): State<Arc<Context>>) -> axum::Json<ClockJson> {
    let clock = &context.clock;
    let (time, clock_speed) = (clock.now().into(), clock.pace().speed);
    axum::Json(ClockJson { time, clock_speed, simulated: clock.is_simulated() })
}

/// The clock of a simulated shift goes on at another speed; that of a real mine cannot be set.
#[utoipa::path(put, path = "/api/v1/clock", tag = "settings", request_body = SetClock,
    responses((status = 200, description = "now", body = ClockJson)))]
pub(super) async fn set(
    State(context): State<Arc<Context>>,
    Json(SetClock { clock_speed }): Json<SetClock>,
) -> Result<axum::Json<ClockJson>, ApiError> {
    if !(clock_speed > 0.0 && clock_speed <= FASTEST) {
        let message = format!("clock_speed: found {clock_speed}, expected more than 0, to {FASTEST}");
        return Err(ApiError::invalid(message));
    }
    if !context.clock.is_simulated() {
        return Err(ApiError::conflict("the clock of a real mine cannot be set"));
    }
    context.clock.set_speed(clock_speed);
    Ok(now(State(context)).await)
}
