//! The server's clock.

use adit_core::time::Time;
use std::time::{SystemTime, UNIX_EPOCH};

/// Now, since the Unix epoch.
pub fn now() -> Time {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    Time::from_nanos(i64::try_from(since.as_nanos()).unwrap_or(i64::MAX))
}
